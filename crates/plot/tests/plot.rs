//! Pictures: what they say, how many lines they draw, and that no run is too odd to be drawn.

#![allow(clippy::unwrap_used)]

use hwasp_plot::{
    Band, Curve, DISCOUNTED, Note, PanelText, PlotError, PlotOptions, Theme, XAxis, curves, render_png, write_plot,
};
use hwasp_runs::metrics::MetricsTable;
use hwasp_training::MetricsRow;
use resvg::{tiny_skia::Pixmap, usvg::roxmltree};

/// A run of `rows` rows that learns; `shift` tells runs apart.
fn run(label: &str, rows: u32, shift: f64) -> Curve {
    let wave = |i: u32| f64::from(i % 5) * 10.0;
    Curve {
        terms: vec![],
        label: label.to_owned(),
        x: (1..=rows).map(|i| f64::from(i) * 40_000.0).collect(),
        undiscounted_return: vec![],
        discounted_return: (0..rows).map(|i| -1100.0 + f64::from(i) * 6.0 + wave(i) + shift).collect(),
        totals: vec![("stiffness_total".to_owned(), (0..rows).map(|i| 60.0 - 0.4 * f64::from(i) + shift).collect())],
    }
}

fn options() -> PlotOptions {
    let text = |column: &str, label: &str, unit: &str, optimum| PanelText {
        column: column.to_owned(),
        label: label.to_owned(),
        unit: unit.to_owned(),
        optimum,
    };
    PlotOptions {
        title: "mass-spring".to_owned(),
        panels: vec![text("stiffness_total", "total stiffness", "N/m", Some(19.6))],
        ..PlotOptions::default()
    }
}

fn svg(runs: &[Curve]) -> String {
    curves(runs, &options()).unwrap().svg
}

/// How many elements of this name the picture has; fails where the picture is no XML.
fn count(svg: &str, name: &str) -> usize {
    let document = roxmltree::Document::parse(svg).unwrap();
    document.descendants().filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", name))).count()
}

fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    document
        .descendants()
        .filter(|n| n.tag_name().name() == "text")
        .filter_map(|n| n.text().map(str::to_owned))
        .collect()
}

fn has_text(svg: &str, text: &str) -> bool {
    texts(svg).iter().any(|t| t == text)
}

/// The points of the polylines in order.
fn polylines(svg: &str) -> Vec<Vec<(f64, f64)>> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let point = |text: &str| text.split_once(',').map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap())).unwrap();
    let of_node = |n: roxmltree::Node<'_, '_>| n.attribute("points").map(|p| p.split(' ').map(point).collect());
    document.descendants().filter(|n| n.tag_name().name() == "polyline").filter_map(of_node).collect()
}

#[test]
fn a_single_run_has_its_return_twice_and_its_design_once() {
    let picture = svg(&[run("HWasP", 100, 0.0)]);
    assert_eq!(count(&picture, "polyline"), 3);
    assert_eq!(count(&picture, "polygon"), 0);
    for text in
        ["mass-spring", "HWasP", "optimum", "19.6", "total stiffness (N/m)", "discounted return", "4M", "\u{2212}1000"]
    {
        assert!(has_text(&picture, text), "`{text}` is not among {:?}", texts(&picture));
    }
    assert!(texts(&picture).iter().any(|t| t.contains("mean of the last 11")));
}

#[test]
fn runs_that_share_a_label_are_one_line_and_a_band() {
    let runs: Vec<Curve> = (0..4)
        .map(|i| run(if i % 2 == 0 { "HWasP" } else { "HWasP-Minimal" }, 100, f64::from(i)))
        .chain([run("alone", 100, 9.0)])
        .collect();
    let picture = svg(&runs);
    // Two panels of two means and a lone run, and that run's return as logged.
    assert_eq!(count(&picture, "polyline"), 7);
    // Two panels of two bands, and two in the legend.
    assert_eq!(count(&picture, "polygon"), 6);
    assert!(has_text(&picture, "HWasP (2 runs)") && has_text(&picture, "HWasP-Minimal (2 runs)"));
    assert!(has_text(&picture, "alone"));
}

/// Where two of five seeds had failed, the legend counted three runs as if nobody had asked for more.
#[test]
fn a_legend_says_how_many_runs_there_should_be() {
    let runs: Vec<Curve> = (0..3).map(|i| run("HWasP", 20, f64::from(i))).chain([run("ARS", 20, 5.0)]).collect();
    let asked = [("HWasP", 5), ("ARS", 2), ("CMA-ES", 5)].map(|(label, runs)| (label.to_owned(), runs)).to_vec();
    let picture = curves(&runs, &PlotOptions { asked, ..options() }).unwrap().svg;
    assert!(has_text(&picture, "HWasP (3 of 5 runs)") && has_text(&picture, "ARS (1 of 2 runs)"), "{picture}");
    assert!(texts(&picture).iter().any(|text| text.contains("no run finished of CMA-ES")), "{:?}", texts(&picture));
    let whole = svg(&runs);
    assert!(has_text(&whole, "HWasP (3 runs)") && has_text(&whole, "ARS"), "{:?}", texts(&whole));
}

/// Two runs had a band that was called a 95 % interval: the range from the one to the other, which holds the truth in half of all
/// cases.
#[test]
fn up_to_three_runs_have_no_band_of_a_bootstrap() {
    for (runs, polygons) in [(2, 0), (3, 0), (4, 3)] {
        let curves_of: Vec<Curve> = (0..runs).map(|i| run("HWasP", 60, 20.0 * f64::from(i))).collect();
        let options = PlotOptions { band: Band::Bootstrap, ..options() };
        let picture = curves(&curves_of, &options).unwrap().svg;
        // One in each of two panels, and one in the legend.
        assert_eq!(count(&picture, "polygon"), polygons, "{runs} runs");
        assert_eq!(texts(&picture).iter().any(|text| text.contains("bootstrap interval")), polygons > 0, "{runs} runs");
    }
}

/// Four runs at heights 0, 1, 2 and 30 over the base: the interquartile mean is 1.5, the mean would be 8.25. The same
/// picture with a single run at 1.5 beside them shows that both lie on one line.
#[test]
fn the_line_of_several_runs_is_their_interquartile_mean() {
    let mut runs: Vec<Curve> = [0.0, 1.0, 2.0, 30.0].map(|shift| run("four", 100, shift)).to_vec();
    runs.push(run("one", 100, 1.5));
    let lines = polylines(&svg(&runs));
    // In order: the return of `one` as logged, of `four`, of `one`; the design of `four`, of `one`.
    let (four, one) = (&lines[3], &lines[4]);
    for end in [0, usize::MAX] {
        let (a, b) = (four[end.min(four.len() - 1)], one[end.min(one.len() - 1)]);
        assert!((a.0 - b.0).abs() < 0.02 && (a.1 - b.1).abs() < 0.02, "{a:?} is not {b:?}");
    }
}

#[test]
fn a_bootstrap_band_is_narrower_than_the_extremes_and_always_the_same() {
    let runs: Vec<Curve> = (0..5).map(|i| run("HWasP", 60, 20.0 * f64::from(i))).collect();
    let draw = |band| curves(&runs, &PlotOptions { band, ..options() }).unwrap().svg;
    let (extremes, bootstrap) = (draw(Band::MinMax), draw(Band::Bootstrap));
    assert_ne!(extremes, bootstrap);
    assert_eq!(bootstrap, draw(Band::Bootstrap));
    assert!(texts(&bootstrap).iter().any(|t| t.contains("bootstrap interval")));
}

#[test]
fn only_steps_that_all_runs_reached_are_summarised() {
    let plot = curves(&[run("HWasP", 100, 0.0), run("HWasP", 50, 1.0)], &options()).unwrap();
    let series = DISCOUNTED.to_owned();
    let note = Note::Shortened { label: "HWasP".to_owned(), series, shown: 2e6, longest: 4e6 };
    assert!(plot.notes.contains(&note), "{:?}", plot.notes);
    assert!(has_text(&plot.svg, "2.0M") && !has_text(&plot.svg, "4M"), "{:?}", texts(&plot.svg));
    let apart = curves(&[run("HWasP", 1, 0.0), run("HWasP", 50, 1.0)], &options()).unwrap();
    assert!(matches!(apart.notes[0], Note::Apart { .. }), "{:?}", apart.notes);
    assert_eq!((count(&apart.svg, "polyline"), count(&apart.svg, "circle")), (2, 2));
}

#[test]
fn rows_that_are_no_numbers_are_skipped_and_reported() {
    let mut odd = run("HWasP", 100, 0.0);
    (odd.discounted_return[10], odd.discounted_return[11], odd.discounted_return[12]) =
        (f64::NAN, f64::INFINITY, 1e200);
    odd.x[20] = 0.0;
    let plot = curves(&[odd], &options()).unwrap();
    let note = |series: &str, rows| Note::Skipped { label: "HWasP".to_owned(), series: series.to_owned(), rows };
    assert_eq!(plot.notes, [note(DISCOUNTED, 4), note("stiffness_total", 1)]);
    assert_eq!(polylines(&plot.svg).iter().map(Vec::len).collect::<Vec<_>>(), [96, 96, 99]);
    assert!(!plot.svg.contains("NaN") && !plot.svg.contains("inf"));
    assert!(plot.notes[0].to_string().contains("without 4 of its rows"), "{}", plot.notes[0]);
}

#[test]
fn runs_with_hardly_any_rows_are_drawn() {
    let empty = curves(&[run("empty", 0, 0.0)], &options()).unwrap();
    assert!(has_text(&empty.svg, "no rows to draw"));
    // One for the run: thirteen of them, one for each panel of a hand's, said the same.
    assert_eq!(empty.notes, [Note::Empty { label: "empty".to_owned() }]);
    let single = curves(&[run("one row", 1, 0.0)], &options()).unwrap();
    assert!(count(&single.svg, "circle") >= 2 && single.notes.is_empty());
    assert!(render_png(&empty, 1.0).is_ok() && render_png(&single, 1.0).is_ok());
    let same = Curve { x: vec![0.0; 5], discounted_return: vec![-3.0; 5], ..Curve::default() };
    assert!(render_png(&curves(&[same], &options()).unwrap(), 1.0).is_ok());
}

/// Where the widest label of a tick begins, and where the text of the axis stands, px from the left.
fn left_of_axes(svg: &str) -> (f64, f64) {
    let document = roxmltree::Document::parse(svg).unwrap();
    let nodes = || document.descendants().filter(|n| n.tag_name().name() == "text");
    let number = |text: &str| text.parse::<f64>().unwrap();
    // Ticks end before the axis; digits of the font are 0.64 of its size wide.
    let ticks = nodes().filter(|n| n.attribute("text-anchor") == Some("end"));
    let labels =
        ticks.map(|n| number(n.attribute("x").unwrap()) - 0.64 * 11.0 * n.text().unwrap().chars().count() as f64);
    let upward = nodes().filter_map(|n| n.attribute("transform").and_then(|t| t.strip_prefix("translate(")));
    let texts = upward.map(|t| number(t.split(' ').next().unwrap()));
    (labels.fold(f64::INFINITY, f64::min), texts.fold(f64::INFINITY, f64::min))
}

#[test]
fn wide_labels_do_not_reach_the_text_of_the_axis() {
    let mut fine = run("HWasP", 30, 0.0);
    fine.discounted_return.iter_mut().enumerate().for_each(|(i, value)| *value = -0.01 - 2e-6 * i as f64);
    let picture = curves(&[Curve { totals: Vec::new(), ..fine }], &options()).unwrap().svg;
    assert!(has_text(&picture, "\u{2212}0.01005"), "{:?}", texts(&picture));
    let (labels, text) = left_of_axes(&picture);
    assert!(text > 8.0 && labels > text + 3.0, "labels begin at {labels}, the text stands at {text}");
}

#[test]
fn designs_are_drawn_in_the_unit_that_is_asked_for() {
    let radius = |i: u32| 0.004 + 0.0001 * f64::from(i);
    let run = Curve { totals: vec![("radius".into(), (0..20).map(radius).collect())], ..run("HWasP", 20, 0.0) };
    let panel = PanelText { column: "radius".into(), label: "radius".into(), unit: "mm".into(), optimum: Some(0.005) };
    let picture = curves(&[run], &PlotOptions { panels: vec![panel], ..options() }).unwrap().svg;
    for text in ["radius (mm)", "4.5", "5"] {
        assert!(has_text(&picture, text), "`{text}` is not among {:?}", texts(&picture));
    }
}

#[test]
fn long_runs_stay_small() {
    let picture = svg(&[run("long", 200_000, 0.0)]);
    assert!(picture.len() < 200_000, "{} bytes", picture.len());
}

#[test]
fn labels_from_outside_cannot_break_the_picture() {
    let mut hostile = run("</text><script>alert(1)</script>&\u{1b}\u{0}\"", 20, 0.0);
    hostile.totals[0].0 = "<total>".to_owned();
    let long = run(&"long ".repeat(10_000), 20, 0.0);
    let plot = curves(&[hostile, long], &PlotOptions { title: "a < b & c".repeat(99), ..options() }).unwrap();
    assert_eq!(count(&plot.svg, "script"), 0);
    assert!(plot.svg.len() < 60_000, "{} bytes", plot.svg.len());
    assert!(render_png(&plot, 1.0).is_ok());
}

#[test]
fn a_png_has_the_size_of_the_picture_and_its_colours() {
    let plot = curves(&[run("HWasP", 100, 0.0)], &options()).unwrap();
    let decode = |scale| Pixmap::decode_png(&render_png(&plot, scale).unwrap()).unwrap();
    let (small, large) = (decode(1.0), decode(2.0));
    assert_eq!((large.width(), large.height()), (2 * small.width(), 2 * small.height()));
    assert_eq!(small.width(), 968);
    let pixels = |colour: [u8; 3]| large.pixels().iter().filter(|p| [p.red(), p.green(), p.blue()] == colour).count();
    assert!(pixels([0x00, 0x72, 0xb2]) > 1000, "no curve");
    // The frame alone is a hair of ink; letters make up the rest.
    assert!(pixels([0x26, 0x26, 0x26]) > 3000, "no text: {}", pixels([0x26, 0x26, 0x26]));
    assert!(pixels([0xff, 0xff, 0xff]) > large.pixels().len() / 2, "no page");
    assert!(matches!(render_png(&plot, 1e6), Err(PlotError::Render(_))));
    assert!(matches!(render_png(&plot, f32::NAN), Err(PlotError::Render(_))));
}

#[test]
fn the_files_name_chooses_the_format() {
    let folder = std::env::temp_dir().join(format!("hwasp-plot-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let plot = curves(&[run("HWasP", 10, 0.0)], &options()).unwrap();
    let (vector, pixels) = (folder.join("curves.svg"), folder.join("curves.PNG"));
    write_plot(&vector, &plot).unwrap();
    write_plot(&pixels, &plot).unwrap();
    assert_eq!(std::fs::read_to_string(&vector).unwrap(), plot.svg);
    assert!(std::fs::read(&pixels).unwrap().starts_with(b"\x89PNG"));
    assert!(matches!(write_plot(&folder.join("curves.pdf"), &plot), Err(PlotError::Extension { .. })));
    assert!(matches!(write_plot(&folder.join("none/curves.svg"), &plot), Err(PlotError::Write { .. })));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    assert!(matches!(curves(&[], &options()), Err(PlotError::NoRuns)));
    let of = |runs: &[Curve], window| curves(runs, &PlotOptions { window, ..options() }).unwrap_err();
    assert!(matches!(of(&[run("a", 5, 0.0)], 0), PlotError::Window(0)));
    let mut uneven = run("a", 5, 0.0);
    uneven.totals[0].1.pop();
    assert_eq!(of(&[uneven], 11).to_string(), "`a` has 5 rows of steps or times but 4 of stiffness_total");
}

/// A run with more design groups than a picture has panels was trained, and then could not be finished: its `curves.svg` was an
/// error.
#[test]
fn more_totals_than_panels_are_left_out() {
    let totals = (0..30).map(|i| (format!("total_{i}"), vec![1.0; 5])).collect();
    let plot = curves(&[Curve { totals, ..run("a", 5, 0.0) }], &options()).unwrap();
    // The return has a panel, too.
    assert_eq!(plot.notes, [Note::Panels { left_out: 7 }]);
    assert!(has_text(&plot.svg, "total 22") && !has_text(&plot.svg, "total 23"), "{:?}", texts(&plot.svg));
    assert!(plot.notes[0].to_string().starts_with("7 columns are left out"), "{}", plot.notes[0]);
}

#[test]
fn a_table_becomes_a_curve() {
    let row = |i: u64| MetricsRow {
        iteration: i,
        env_steps: 100 * i,
        wall_s: 0.5 * i as f64,
        discounted_return: -(i as f64),
        undiscounted_return: -2.0 * i as f64,
        design_totals: vec![5.0, i as f64],
        ..MetricsRow::default()
    };
    let design_totals = vec!["a_total".to_owned(), "b_total".to_owned()];
    let table = MetricsTable { design_totals, rows: (0..3).map(row).collect(), ..MetricsTable::default() };
    let x = |axis| Curve::from_table("HWasP", &table, axis, 50).x;
    assert_eq!(x(XAxis::WallClock), [0.0, 0.5, 1.0]);
    assert_eq!(x(XAxis::Nominal), [50.0, 100.0, 150.0]);
    let curve = Curve::from_table("HWasP", &table, XAxis::EnvSteps, 50);
    assert_eq!((&*curve.x, &*curve.discounted_return), (&[0.0, 100.0, 200.0][..], &[-0.0, -1.0, -2.0][..]));
    assert_eq!(curve.undiscounted_return, [-0.0, -2.0, -4.0]);
    // Both have panels of their names, unless the discounted one is what is judged.
    let named = |curve: Curve| texts(&curves(&[curve], &PlotOptions::default()).unwrap().svg);
    let both = named(curve.clone());
    assert!(["return", "discounted return"].iter().all(|name| both.iter().any(|text| text == name)), "{both:?}");
    assert!(named(curve.clone().judged()).iter().all(|text| text != "return"));
    assert_eq!(curve.totals, [("a_total".to_owned(), vec![5.0; 3]), ("b_total".to_owned(), vec![0.0, 1.0, 2.0])]);
}

/// A picture of three panels was 1,410 pixels wide: on a page of 170 mm its texts had less than 4 points.
#[test]
fn pictures_for_print_are_as_wide_as_a_page_and_legible_on_it() {
    let runs = ["a", "b", "c"].map(|label| run(label, 60, 10.0));
    let of = |panels: u32, theme| {
        let total = |i: u32| (format!("total_{i}"), vec![f64::from(i); 60]);
        let runs = runs.clone().map(|run| Curve { totals: (1..panels).map(total).collect(), ..run });
        curves(&runs, &PlotOptions { theme, ..options() }).unwrap()
    };
    for panels in [1, 2, 3, 5, 14] {
        let plot = of(panels, Theme::Print);
        let document = roxmltree::Document::parse(&plot.svg).unwrap();
        let root = document.root_element();
        assert_eq!(root.attribute("width"), Some("170mm"), "{panels}");
        let width: f64 = root.attribute("viewBox").unwrap().split(' ').nth(2).unwrap().parse().unwrap();
        let points = |pixels: &str| pixels.parse::<f64>().unwrap() * 170.0 / 25.4 * 72.0 / width;
        let numbers =
            |name: &str| document.descendants().filter_map(|n| n.attribute(name)).map(points).collect::<Vec<_>>();
        assert!(numbers("font-size").iter().all(|&size| size > 7.4), "{panels}: {:?}", numbers("font-size"));
        assert!(numbers("stroke-width").iter().all(|&line| line > 0.5), "{panels}");
        let high: f64 = root.attribute("height").unwrap().strip_suffix("mm").unwrap().parse().unwrap();
        assert!(high < 240.0, "{panels} panels are {high} mm high");
        // Three colours, three kinds of dashes.
        let dashes: std::collections::BTreeSet<_> = document
            .descendants()
            .filter(|n| {
                n.has_tag_name(("http://www.w3.org/2000/svg", "polyline")) && n.attribute("stroke-width") == Some("1.8")
            })
            .map(|n| n.attribute("stroke-dasharray"))
            .collect();
        assert_eq!(dashes.len(), 3, "{panels}: {dashes:?}");
        if panels == 2 {
            let size = &render_png(&plot, 300.0 / 96.0).unwrap()[16..20];
            assert_eq!(u32::from_be_bytes(size.try_into().unwrap()), 2008);
        }
    }
    assert!(!of(3, Theme::Screen).svg.contains("mm"));
}
