//! `hwasp init` with a robot's model.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::Path;

use hwasp_experiment::{Catalogue, Folder, Layers, resolve};

use crate::args::InitArgs;
use crate::output;
use hwasp_session::{Failure, OTHER_FILE};

/// Whether a path names a model, by its ending.
pub(super) fn is_model(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    ["xml", "mjcf", "urdf"].iter().any(|known| ending.eq_ignore_ascii_case(known))
}

pub(super) fn run(args: &InitArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let model = &args.what;
    if args.template.is_some() || args.path.is_some() {
        let message = format!("--template and --path are for a project, and {} is a model", model.display());
        return Err(Failure::input(message).hint("leave them out"));
    }
    let out = args.out.clone().unwrap_or_else(|| model.with_extension("toml"));
    let there = || {
        let error = Failure::input(format!("{} is there already, and was left as it is", out.display()));
        error.hint("name another experiment with --out, or remove it")
    };
    if out.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("toml")) {
        return Err(Failure::input(format!("`{}` is no name for an experiment: end it in .toml", out.display())));
    }
    if out.exists() {
        return Err(there());
    }
    let (folder, file) = places(model, &out)?;
    let stem = |path: &Path| path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let name = args.name.clone().unwrap_or_else(|| stem(&out));
    let mut begun = catalogue.problems().iter().filter_map(|problem| problem.begin(&folder, &file, &name));
    let Some(text) = begun.next() else {
        let hint = "build it with the feature `mujoco`, which it has by default";
        return Err(Failure::input("no problem of this program begins with a model").hint(hint));
    };
    let text = text.map_err(|error| Failure::input(error.to_string()))?;
    // What is written trains as it is.
    let layers = Layers::from_text(&out.display().to_string(), &text).map_err(Failure::input)?;
    let experiment = resolve(layers.with_folder(folder), None, catalogue).map_err(|faults| {
        let hint = "nothing was written: docs/own_robot.md shows how to write an experiment by hand";
        Failure::input(faults).hint(hint)
    })?;
    let unwritten = |error| Failure::from(error).hint(OTHER_FILE);
    match OpenOptions::new().write(true).create_new(true).open(&out) {
        Ok(mut file) => file.write_all(text.as_bytes()).map_err(unwritten)?,
        Err(error) if error.kind() == ErrorKind::AlreadyExists => return Err(there()),
        Err(error) => return Err(unwritten(error)),
    }
    let env = &experiment.task.built().training.env;
    let commands: Vec<&str> = env.command.iter().map(|port| port.name.as_str()).collect();
    let told = format!(
        "{} is an experiment for {}: {}\n\n  {} observations, commands: {}\n  a step takes {} ms, an episode {} steps\n\n\
         Next:\n  hwasp check {}\n  hwasp train {}\n",
        out.display(),
        model.display(),
        experiment.description,
        env.observation.len(),
        commands.join(", "),
        (1e6 * env.time_step).round() / 1e3,
        experiment.task.horizon,
        output::shell(&out),
        output::shell(&out),
    );
    Ok(output::print(&told)?)
}

/// The folder of the experiment, and the model's path in it.
fn places(model: &Path, out: &Path) -> Result<(Folder, String), Failure> {
    let folder = out.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let real = |path: &Path, what: &str| {
        path.canonicalize().map_err(|error| {
            let message = format!("{what} {} cannot be read: {error}", path.display());
            Failure::input(message).hint("see that it is there, and that you may read it")
        })
    };
    let (inside, around) = (real(model, "the model")?, real(folder, "the folder")?);
    let relative = inside.strip_prefix(&around).ok().and_then(Path::to_str);
    let Some(file) = relative else {
        let message = format!("{} does not lie in the folder of the experiment, {}", model.display(), folder.display());
        let hint = "an experiment reads what lies in its folder or below: let --out name a file beside the model";
        return Err(Failure::input(message).hint(hint));
    };
    Ok((Folder::Disk(folder.to_owned()), file.replace('\\', "/")))
}
