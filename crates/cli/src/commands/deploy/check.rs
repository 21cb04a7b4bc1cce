//! `hwasp deploy check`.

use std::fmt::Write;

use hwasp_deploy::check::{Mark, check};

use super::rig;
use crate::args::DeployCheckArgs;
use crate::output;
use hwasp_session::Failure;

pub(crate) fn run(args: &DeployCheckArgs) -> Result<(), Failure> {
    let looks = check(&rig(&args.rig)?);
    let mut text = String::new();
    for look in &looks {
        let mark = match look.mark {
            Mark::Good => "ok  ",
            Mark::Odd => "look",
            Mark::Bad => "BAD ",
        };
        let _ = writeln!(text, "{mark}  {:<15} {}", look.what, look.found);
    }
    output::print(&text)?;
    let bad = looks.iter().filter(|look| look.mark == Mark::Bad).count();
    if bad > 0 {
        return Err(Failure::input(format!(
            "{bad} of {} looks are bad: nothing should move before they are mended",
            looks.len()
        )));
    }
    Ok(())
}
