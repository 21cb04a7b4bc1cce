//! `hwasp play`.

use std::fs;
use std::path::{Path, PathBuf};

use hwasp_experiment::Catalogue;
use hwasp_report::play::{self, Format, PlayError, PlayOptions, Played};
use hwasp_runs::SavedRun;

use super::{saved_run, stand_in};
use crate::args::PlayArgs;
use crate::{output, report};
use hwasp_session::Failure;

pub(crate) fn run(args: &PlayArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let saved = saved_run(&args.run, &args.set, catalogue)?;
    let params = saved.params().map_err(Failure::input)?;
    let spec = saved.assembly().experiment();
    let nearer = stand_in(&args.nearer, saved.assembly())?;
    let options = PlayOptions {
        first: args.first,
        episodes: args.episodes,
        seed: args.seed.unwrap_or(spec.train.evaluation_seed),
        native: nearer.is_some(),
        size: [args.width as usize, args.height as usize],
    };
    let mut title = format!("{} · {} · held-out starts of seed {}", spec.name, spec.method.name(), options.seed);
    if let Some(kind) = nearer {
        title.push_str(" · ");
        title.push_str(report::world(Some(kind)));
    }
    let under = report::under(&args.set);
    if !under.is_empty() {
        title.push_str(" · ");
        title.push_str(under.trim().trim_end_matches(':'));
        output::print(&under)?;
    }
    let takes = play::record(saved.assembly(), &params, &options).map_err(|error| match error {
        error @ PlayError::Unseen { .. } => {
            Failure::input(error).hint("write the method `look` of its task, as docs/own_mechanism.md shows")
        }
        error @ PlayError::Assemble(_) => Failure::input(error),
        error => error.into(),
    })?;
    let out = args.out.clone().unwrap_or_else(|| args.run.join("play"));
    let pages = [
        ("scene.html", play::scene_page(&takes, &title)),
        ("film.html", play::film_page(saved.assembly(), &takes, options.seed, &title)),
    ];
    for (name, page) in pages {
        let path = out.join(name);
        let written = fs::create_dir_all(&out).and_then(|()| fs::write(&path, page));
        written.map_err(|source| PlayError::Write { path: path.clone(), source })?;
        output::print(&format!("  {}\n", path.display()))?;
    }
    if args.html {
        return Ok(());
    }
    let mut told = Ok(());
    let mut tell = |played: &Played| {
        let verdict = played.success.map_or("", |success| if success { "success" } else { "failure" });
        let line =
            format!("  episode {:<4} {:<10} {verdict:<7}  {}\n", played.index, played.kind, played.path.display());
        if told.is_ok() {
            told = output::print(&line);
        }
    };
    let (format, place) = (args.format.into(), (&title[..], out.as_path()));
    let rendered = rendered(&saved, &params, &options, format, place, &mut tell);
    let drawn = rendered.and_then(|sheet| match sheet {
        Some(sheet) => Ok(sheet),
        None => play::sketch(&takes, &options, format, place, &mut tell),
    });
    let sheet = drawn.map_err(|error| match error {
        error @ PlayError::NoEncoder => Failure::from(error).hint(
            "install it (Debian, Ubuntu: `apt install ffmpeg`; macOS: `brew install ffmpeg`), or take --format gif",
        ),
        error => error.into(),
    })?;
    told?;
    Ok(output::print(&format!("  {}\n", sheet.display()))?)
}

/// Films of grasps, rendered by the engine; none of other problems, and where nothing can be rendered.
#[cfg(not(feature = "renderer"))]
#[allow(clippy::unnecessary_wraps, reason = "as the one that renders")]
fn rendered(
    _: &SavedRun,
    _: &[f32],
    _: &PlayOptions,
    _: Format,
    _: (&str, &Path),
    _: &mut dyn FnMut(&Played),
) -> Result<Option<PathBuf>, PlayError> {
    Ok(None)
}

/// Films of grasps, rendered by the engine; none of other problems, and where nothing can be rendered.
#[cfg(feature = "renderer")]
fn rendered(
    saved: &SavedRun,
    params: &[f32],
    options: &PlayOptions,
    format: Format,
    place: (&str, &Path),
    told: &mut dyn FnMut(&Played),
) -> Result<Option<PathBuf>, PlayError> {
    if play::check(saved.assembly()).is_err() {
        return Ok(None);
    }
    match play::render(saved.assembly(), params, options, format, place, told) {
        Err(error) if error.is_without_renderer() => {
            output::remark(&format!("note: {error}; the films are drawings"));
            Ok(None)
        }
        rendered => rendered.map(Some),
    }
}
