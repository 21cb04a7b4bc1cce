//! `hwasp init`.

use std::fmt::Write;
use std::path::Path;

use hwasp_experiment::Catalogue;
use hwasp_settings::text::printable;

use super::begin;
use crate::args::{InitArgs, TemplateArg};
use crate::output;
use crate::project::{Lock, Project, ProjectError, Template};
use hwasp_session::Failure;

pub(crate) fn run(args: &InitArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    if begin::is_model(&args.what) {
        return begin::run(args, catalogue);
    }
    if let Some(out) = &args.out {
        let (out, what) = (out.display(), args.what.display());
        let message = format!("--out {out} names the experiment of a model, and {what} is none");
        return Err(
            Failure::input(message).hint("a model ends in .xml, .mjcf or .urdf; a project has a folder and no --out")
        );
    }
    let template = match args.template {
        None | Some(TemplateArg::Plant) => Template::Plant,
        Some(TemplateArg::Mjcf) => Template::Mjcf,
    };
    let project = Project::new(&args.what, args.name.as_deref(), template, args.path.as_deref()).map_err(failed)?;
    if project.write().map_err(failed)? == Lock::FirstBuild {
        output::remark("note: Cargo could not be asked about Cargo.lock: the first build writes it anew");
    }
    Ok(output::print(&next(&project, &args.what, template))?)
}

/// What was made, and what to do with it.
fn next(project: &Project, folder: &Path, template: Template) -> String {
    let checkout = printable(&project.checkout().display().to_string());
    let mut files = vec![
        ("src/spring.rs", "the law: a spring that should carry a lamp; write yours here"),
        ("src/arm.rs", "the plant: the arm that it carries"),
        ("src/hold.rs", "the task: bring the lamp to an angle and hold it"),
        ("src/tests.rs", "derivatives, environment, a short training: they hold for any problem"),
        ("experiment.toml", "the training"),
    ];
    if template == Template::Mjcf {
        files.insert(1, ("mechanism.xml", "the arm's physics, in MuJoCo"));
    }
    let mut text =
        format!("{} is a project in {}, built with the checkout {checkout}\n\n", project.name(), folder.display());
    for (file, what) in files {
        let _ = writeln!(text, "  {file:<16} {what}");
    }
    let _ = writeln!(
        text,
        "\nNext (the first build takes minutes; README.md goes on from there):\n  cd {}\n  cargo test\n  cargo hwasp train \
         experiment.toml",
        output::shell(folder)
    );
    text
}

/// What is wrong, and the way out.
fn failed(error: ProjectError) -> Failure {
    let hint = match error {
        ProjectError::NotEmpty { .. } | ProjectError::File { .. } => {
            "nothing was written; name a folder that is empty, or one that does not exist"
        }
        ProjectError::Name { .. } => "name it with --name, such as --name lamp-arm",
        ProjectError::NoCheckout { .. } => "name the folder that holds hwasp's Cargo.lock",
        ProjectError::NoSources => "name a checkout with --path, such as --path ../hwasp",
        ProjectError::Io { action: "create", .. } => {
            "name a folder that is there and may be written, or a new one in such"
        }
        ProjectError::Io { .. } => return Failure::from(error).hint("make room there, or name another folder"),
    };
    Failure::input(error).hint(hint)
}
