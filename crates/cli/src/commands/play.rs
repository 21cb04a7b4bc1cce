//! `hwasp play`.

use std::fs;
use std::path::Path;

use hwasp_experiment::Catalogue;
use hwasp_report::play::{self, PlayError, PlayOptions};
use hwasp_runs::SavedRun;

use super::{saved_run, stand_in};
use crate::args::PlayArgs;
use crate::failure::Failure;
use crate::{output, report};

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
    // What grasps is rendered as well.
    if play::check(saved.assembly()).is_ok() { draw(&saved, &params, &options, (&title, &out)) } else { Ok(()) }
}

#[cfg(not(feature = "renderer"))]
#[allow(clippy::unnecessary_wraps, reason = "as the one that draws")]
fn draw(_: &SavedRun, _: &[f32], _: &PlayOptions, _: (&str, &Path)) -> Result<(), Failure> {
    output::remark("note: this program was built without the feature `renderer`, and renders no GIF");
    Ok(())
}

#[cfg(feature = "renderer")]
fn draw(saved: &SavedRun, params: &[f32], options: &PlayOptions, place: (&str, &Path)) -> Result<(), Failure> {
    let mut told = Ok(());
    let sheet = play::play(saved.assembly(), params, options, place, &mut |played| {
        let verdict = if played.success { "success" } else { "failure" };
        let line = format!("  episode {:<4} {:<10} {verdict}  {}\n", played.index, played.shape, played.path.display());
        if told.is_ok() {
            told = output::print(&line);
        }
    });
    told?;
    match sheet {
        Ok(sheet) => Ok(output::print(&format!("  {}\n", sheet.display()))?),
        Err(error) if error.is_without_renderer() => {
            output::remark(&format!("note: {error}; the film above needs none of it"));
            Ok(())
        }
        Err(error) => Err(error.into()),
    }
}
