//! `hwasp play`.

use hwasp_experiment::Catalogue;
use hwasp_report::play;
use hwasp_runs::SavedRun;

use super::saved_run;
use crate::args::PlayArgs;
use crate::failure::Failure;

pub(crate) fn run(args: &PlayArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let saved = saved_run(&args.run, &args.set, catalogue)?;
    let params = saved.params().map_err(Failure::input)?;
    play::check(saved.assembly()).map_err(Failure::input)?;
    draw(args, &saved, &params)
}

#[cfg(not(feature = "renderer"))]
fn draw(_: &PlayArgs, _: &SavedRun, _: &[f32]) -> Result<(), Failure> {
    Err(Failure::input(
        "this program was built without the renderer and can draw no episodes\n  = hint: build it with the feature \
         `renderer`: cargo run --release --features renderer -- play RUN",
    ))
}

#[cfg(feature = "renderer")]
fn draw(args: &PlayArgs, saved: &SavedRun, params: &[f32]) -> Result<(), Failure> {
    use crate::{output, report};

    let spec = saved.assembly().experiment();
    let options = play::PlayOptions {
        first: args.first,
        episodes: args.episodes,
        seed: args.seed.unwrap_or(spec.train.evaluation_seed),
        native: args.native_tendons,
        size: [args.width as usize, args.height as usize],
    };
    let mut title = format!("{} · {} · held-out starts of seed {}", spec.name, spec.method.name(), options.seed);
    if options.native {
        title.push_str(" · native tendons");
    }
    let under = report::under(&args.set);
    if !under.is_empty() {
        title.push_str(" · ");
        title.push_str(under.trim().trim_end_matches(':'));
        output::print(&under)?;
    }
    let out = args.out.clone().unwrap_or_else(|| args.run.join("play"));
    let mut told = Ok(());
    let sheet = play::play(saved.assembly(), params, &options, (&title, &out), &mut |played| {
        let verdict = if played.success { "success" } else { "failure" };
        let line = format!("  episode {:<4} {:<10} {verdict}  {}\n", played.index, played.shape, played.path.display());
        if told.is_ok() {
            told = output::print(&line);
        }
    })?;
    told?;
    Ok(output::print(&format!("  {}\n", sheet.display()))?)
}
