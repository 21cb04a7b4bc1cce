//! Episodes to look at: what is played is what is evaluated, and what is drawn is where it belongs.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::path::Path;

use hwasp_report::play::{Caption, Format, Picture, PlayOptions, Row, label, record, sheet, sketch};
use hwasp_training::Assembly;
use resvg::tiny_skia::Pixmap;

fn plain(width: usize, height: usize, colour: [u8; 3]) -> Picture {
    Picture { width, height, rgb: colour.repeat(width * height) }
}

/// Whether a region (from column and row, to column and row) has pixels of other colours than its upper left corner.
fn drawn(rgb: impl Fn(usize, usize) -> [u8; 3], [left, top, right, bottom]: [usize; 4]) -> bool {
    (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y))).any(|(x, y)| rgb(x, y) != rgb(left, top))
}

#[test]
fn captions_stand_in_the_four_corners_and_nowhere_else() {
    let picture = plain(320, 240, [90, 120, 150]);
    let caption = |success| Caption {
        object: "sphere · 310 g".into(),
        success: Some(success),
        time: "1.25 s · step 125/500".into(),
        episode: "seed 7 · episode 3".into(),
    };
    let (good, bad) = (caption(true), caption(false));
    let labelled = label([(&picture, &good), (&picture, &bad)]).unwrap();
    let at = |n: usize| {
        let picture = &labelled[n];
        move |x: usize, y: usize| <[u8; 3]>::try_from(&picture.rgb[3 * (y * picture.width + x)..][..3]).unwrap()
    };
    for corner in [[2, 0, 110, 20], [220, 0, 318, 20], [2, 222, 150, 240], [170, 222, 318, 240]] {
        assert!(drawn(at(0), corner), "{corner:?}");
    }
    assert!(!drawn(at(0), [0, 22, 320, 218]) && at(0)(160, 120) == [90, 120, 150], "the middle is the picture's own");
    // The two differ in how they end, and there alone.
    let differ = |x: usize, y: usize| at(0)(x, y) != at(1)(x, y);
    assert!((0..320).any(|x| (0..20).any(|y| differ(x, y))));
    assert!(!(0..320).any(|x| (20..240).any(|y| differ(x, y))) && !(0..160).any(|x| (0..20).any(|y| differ(x, y))));
}

#[test]
fn a_sheet_has_a_row_for_each_episode() {
    let row = |red: u8, success| Row {
        lines: vec!["episode 0".into(), "sphere".into()],
        success: Some(success),
        cells: (0..3_u8).map(|i| (plain(40, 30, [red, 0, 10 * i]), "start".to_owned())).collect(),
    };
    let png = sheet("z-grasp", &[row(200, true), row(100, false)]).unwrap();
    let pixels = Pixmap::decode_png(&png).unwrap();
    let rgb = |x: usize, y: usize| {
        let colour = pixels.pixel(x as u32, y as u32).unwrap().demultiply();
        [colour.red(), colour.green(), colour.blue()]
    };
    // 200 pixels of text, then 40 and a gap of 8 for each picture; 44 of title, then 30 and 26 of text for each row.
    assert_eq!((pixels.width(), pixels.height()), (200 + 3 * 48, 44 + 2 * 56 + 8));
    for (row, red) in [(0, 200), (1, 100)] {
        for column in 0..3 {
            let (x, y) = (200 + 48 * column, 44 + 56 * row);
            assert_eq!([rgb(x, y), rgb(x + 39, y + 29)], [[red, 0, 10 * column as u8]; 2]);
            assert_eq!(rgb(x + 40, y), [255; 3], "the gap");
            assert!(drawn(rgb, [x, y + 31, x + 40, y + 56]), "what stands below");
        }
    }
    assert!(drawn(rgb, [0, 0, 200, 40]) && drawn(rgb, [0, 44, 200, 100]));
    let mut odd = row(0, true);
    odd.cells[1].0 = plain(41, 30, [0; 3]);
    assert!(sheet("", &[odd]).unwrap_err().to_string().contains("41 × 30"));
}

/// A problem in Rust, without the engine: every moment is a picture with what is to be seen, and a film plays as long as the episode.
#[test]
fn films_are_drawn() {
    let assembly = Assembly::new(&hwasp_testing::resolve(hwasp_testing::layers("reach"), None).unwrap()).unwrap();
    let options = PlayOptions { first: 2, episodes: 2, seed: 5, native: false, size: [200, 160] };
    let takes = record(&assembly, &assembly.init(), &options).unwrap();
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("drawn");
    let _ = std::fs::remove_dir_all(&out);
    let mut told = Vec::new();
    let sheet =
        sketch(&takes, &options, Format::Gif, ("reach", &out), &mut |played| told.push(played.clone())).unwrap();
    assert_eq!(told.iter().map(|played| played.index).collect::<Vec<_>>(), [2, 3]);
    let mut film = gif::DecodeOptions::new();
    film.set_color_output(gif::ColorOutput::RGBA);
    let mut film = film.read_info(std::fs::File::open(out.join("episode-2.gif")).unwrap()).unwrap();
    assert_eq!((film.width(), film.height()), (200, 160));
    let mut hundredths = 0;
    let mut frames = 0;
    while let Some(frame) = film.read_next_frame().unwrap() {
        if frames == 0 {
            // What the design shapes is orange, below the text.
            let orange = frame.buffer.chunks_exact(4).filter(|p| p[0] > 180 && p[2] < 60).count();
            assert!(orange > 50, "{orange}");
        }
        hundredths += u64::from(frame.delay);
        frames += 1;
    }
    assert_eq!(frames, takes[0].moments.len());
    let seconds = takes[0].time_step * takes[0].result.steps as f64 + 1.5;
    assert!((hundredths as f64 / 100.0 - seconds).abs() < 0.06, "{hundredths} for {seconds} s");
    assert!(Pixmap::decode_png(&std::fs::read(sheet).unwrap()).unwrap().width() > 200);
}

#[cfg(feature = "mujoco")]
mod grasps {
    use std::path::Path;

    use hwasp_core::Serial;
    use hwasp_report::play::{MOMENTS, PlayOptions, check, film, moments};
    use hwasp_runs::SavedRun;
    use hwasp_training::{Assembly, evaluate, evaluate_native};

    fn trained() -> SavedRun {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results/z-grasp");
        SavedRun::open(&folder, hwasp_testing::catalogue()).unwrap()
    }

    fn options(first: u64, episodes: u64, native: bool) -> PlayOptions {
        PlayOptions { first, episodes, seed: 1_000_003, native, size: [160, 160] }
    }

    #[test]
    fn what_is_played_is_what_is_evaluated() {
        let run = trained();
        let (assembly, params) = (run.assembly(), run.params().unwrap());
        for native in [false, true] {
            let takes = film(assembly, &params, &options(0, 4, native)).unwrap();
            let asked = (4, 1_000_003);
            let evaluation = if native {
                evaluate_native(assembly, &params, asked, &Serial)
            } else {
                evaluate(assembly, &params, asked, &Serial)
            }
            .unwrap();
            for rate in &evaluation.success {
                let of_kind = || takes.iter().filter(|t| rate.kind == "all" || rate.kind == t.object.kind.name());
                let successes = of_kind().filter(|t| t.success).count() as u64;
                assert_eq!(
                    (rate.successes, rate.episodes),
                    (successes, of_kind().count() as u64),
                    "{native} {}",
                    rate.kind
                );
            }
            let mean = takes.iter().map(|t| t.undiscounted_return).sum::<f64>() / 4.0;
            assert!((mean - evaluation.undiscounted_return.mean).abs() < 1e-9 * mean.abs(), "{native}");
            // An episode is the same wherever the first one is.
            assert_eq!(film(assembly, &params, &options(3, 1, native)).unwrap(), takes[3..], "{native}");
        }
    }

    #[test]
    fn a_film_shows_the_whole_grasp() {
        let run = trained();
        let takes = film(run.assembly(), &run.params().unwrap(), &options(0, 3, false)).unwrap();
        assert!(takes.iter().any(|take| take.success), "the hand is trained");
        for take in &takes {
            let stills = &take.film.stills;
            assert_eq!(stills.len(), 501);
            assert!(!stills[0].touches && stills[0].clearance.abs() < 1e-9, "the object lies on the floor");
            assert!(!take.success || stills[401..].iter().all(|still| still.clearance >= 0.1));
            let chosen = moments(stills);
            assert!(chosen.len() == MOMENTS && chosen.windows(2).all(|pair| pair[0].step < pair[1].step), "{chosen:?}");
        }
    }

    #[test]
    fn other_problems_have_nothing_to_look_at() {
        let assembly = Assembly::new(&hwasp_testing::resolve(hwasp_testing::layers("reach"), None).unwrap()).unwrap();
        let error = check(&assembly).unwrap_err().to_string();
        assert_eq!(error, "reach has no grasps to look at; z-grasp and 3d-grasp have");
        assert_eq!(film(&assembly, &assembly.init(), &options(0, 1, false)).unwrap_err().to_string(), error);
    }

    #[cfg(feature = "renderer")]
    #[test]
    #[allow(clippy::print_stderr)] // says what is left out
    fn pictures_are_written() {
        use hwasp_mujoco::engine::PictureError;
        use hwasp_report::play::{Format, PlayError, render};

        let run = trained();
        let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("play");
        let _ = std::fs::remove_dir_all(&out);
        let mut told = Vec::new();
        let played = render(
            run.assembly(),
            &run.params().unwrap(),
            &options(0, 1, false),
            Format::Gif,
            ("a trained hand", &out),
            &mut |played| told.push(played.clone()),
        );
        let sheet = match played {
            Err(PlayError::Picture(error @ PictureError::NoContext(_))) => return eprintln!("left out: {error}"),
            sheet => sheet.unwrap(),
        };
        assert_eq!(told.len(), 1);
        let film = std::fs::read(&told[0].path).unwrap();
        assert!(film.starts_with(b"GIF89a") && film[6..10] == [160, 0, 160, 0], "{:?}", &film[..10]);
        let pixels = resvg::tiny_skia::Pixmap::decode_png(&std::fs::read(&sheet).unwrap()).unwrap();
        assert_eq!(pixels.width(), 200 + 6 * 168);
        // Something orange lies in the middle of the first picture.
        let orange = pixels.pixels().iter().filter(|p| p.red() > 150 && p.blue() < 90 && p.green() < 170).count();
        assert!(orange > 500, "{orange}");
    }
}
