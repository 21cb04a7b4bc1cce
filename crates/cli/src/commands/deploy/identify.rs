//! `hwasp deploy identify`.

use std::num::NonZeroUsize;
use std::path::Path;

use hwasp_deploy::identify::{experiment, identify};
use hwasp_deploy::log::{Logged, read};
use hwasp_experiment::Catalogue;

use super::super::{executor, writable, write_out};
use super::replay::of_log;
use crate::args::DeployIdentifyArgs;
use crate::output;
use crate::progress::Counter;
use hwasp_session::{Failure, OTHER_FILE};

/// Generations of the search, at most.
const GENERATIONS: u32 = 150;

pub(crate) fn run(args: &DeployIdentifyArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    if args.out.exists() {
        let error = format!("{} is there already, and was left as it is", args.out.display());
        return Err(Failure::input(error).hint(OTHER_FILE));
    }
    writable(&args.out)?;
    let logs: Vec<Logged> =
        args.logs.iter().map(|path| read(path)).collect::<Result<_, _>>().map_err(Failure::input)?;
    let deployed = of_log(&logs[0], args.run.as_deref(), catalogue)?;
    let threads = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let executor = executor(threads)?;
    let mut counter = Counter::new("generations");
    let found = identify(&logs, &deployed, GENERATIONS, &*executor, &mut |done, _| {
        counter.tell(done as usize, GENERATIONS as usize);
    });
    counter.finish();
    let found = found.map_err(Failure::input)?;
    // What the logs were calibrated with, as a multiple of the data sheet's.
    let sheet = hwasp_deploy::controller::hand(deployed.spec()).map_err(Failure::input)?.transmission.torque_constant;
    let calibrated = logs[0].about.torque_per_current / sheet;
    let text = experiment(&deployed, &found, calibrated)?;
    write_out(&args.out, &text)?;
    let [wound, current] = found.left;
    let [wound_before, current_before] = found.before;
    output::print(&format!(
        "  torque per current   {:.3} of the data sheet's\n  tendon stiffness     {:.2} N/mm\n  friction             {:.1} N·mm\n  \
         delay                {:.1} ms\n  slack                {:.2} mm\n\n  left: {:.3} mm (before {:.3}), {:.4} A (before {:.4})\n  {}\n",
        found.torque_gain,
        1e-3 * found.tendon_stiffness,
        1e3 * found.friction,
        1e3 * found.delay,
        1e3 * found.slack,
        1e3 * wound,
        1e3 * wound_before,
        current,
        current_before,
        args.out.display()
    ))?;
    if !found.gain_is_told {
        output::remark(
            "note: these logs do not tell torque per current from stiffness and friction, for the springs of this hand hardly pull: the \
             calibrated torque is taken for right; measure it with `hwasp deploy calibrate --weight`",
        );
    }
    let run = args.run.as_deref().unwrap_or(Path::new(&logs[0].about.run));
    let (experiment, run) = (output::shell(&args.out), output::shell(run));
    output::remark(&format!("to train further with it: hwasp train {experiment} --from {run} --env-steps 1e6"));
    Ok(())
}
