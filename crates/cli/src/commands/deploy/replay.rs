//! `hwasp deploy replay`.

use std::fmt::Write;
use std::path::Path;

use hwasp_deploy::log::{Logged, read};
use hwasp_deploy::replay::{Compared, replay};
use hwasp_experiment::Catalogue;
use hwasp_export::Deployed;

use super::super::write_out;
use super::deployed;
use crate::args::DeployReplayArgs;
use crate::output;
use hwasp_session::Failure;

pub(crate) fn run(args: &DeployReplayArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let logged = read(&args.log).map_err(Failure::input)?;
    let deployed = of_log(&logged, args.run.as_deref(), catalogue)?;
    let compared = replay(&logged, &deployed).map_err(Failure::input)?;
    let mut text = "  episode   steps   wound, mm: mean, worst at           current, A: mean, worst at\n".to_owned();
    for Compared { episode, pairs, wound, worst_wound, current, worst_current } in &compared {
        let _ = writeln!(
            text,
            "  {episode:>7}   {:>5}   {:>6.2}   {:>6.2} at {:>6.2} s      {:>6.3}   {:>6.3} at {:>6.2} s",
            pairs.len(),
            1e3 * wound,
            1e3 * worst_wound.0,
            worst_wound.1,
            current,
            worst_current.0,
            worst_current.1
        );
    }
    if let Some(out) = &args.out {
        let table: String = compared.iter().map(Compared::csv).collect();
        write_out(out, &format!("{}{table}", Compared::COLUMNS))?;
        let _ = writeln!(text, "\n  {}", out.display());
    }
    Ok(output::print(&text)?)
}

/// The run of a log: the one that is named, or the one that it names.
pub(super) fn of_log(logged: &Logged, run: Option<&Path>, catalogue: &Catalogue) -> Result<Deployed, Failure> {
    deployed(run.unwrap_or(Path::new(&logged.about.run)), catalogue)
}
