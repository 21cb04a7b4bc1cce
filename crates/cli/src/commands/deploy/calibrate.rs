//! `hwasp deploy calibrate`.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use hwasp_deploy::DeployError;
use hwasp_deploy::calibrate::{Calibration, find, stands, weigh};
use hwasp_deploy::clock::SystemClock;
use hwasp_deploy::controller::{Spool, hand};
use hwasp_deploy::drive::{Bench, Drive, Manner};
use hwasp_deploy::record::NoSink;
use hwasp_deploy::{date, devices};
use hwasp_drivers::Motor;
use hwasp_experiment::Catalogue;

use super::super::writable;
use super::answers::Answers;
use super::{deployed, interrupts, rig};
use crate::args::DeployCalibrateArgs;
use crate::output;
use hwasp_session::Failure;

/// What is taken to be wound when it begins, m: there is room to pay out and to wind.
const MIDDLE: f64 = 0.020;

pub(crate) fn run(args: &DeployCalibrateArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let (rig, deployed) = (rig(&args.rig)?, deployed(&args.run, catalogue)?);
    let hand = hand(deployed.spec()).map_err(Failure::input)?;
    stands(hand, deployed.design()).map_err(Failure::input)?;
    if let Some(mass) = args.weight.filter(|mass| !(0.05..=5.0).contains(mass)) {
        let limits = "0.05 to 5 kg: heavy enough to be felt, light enough to be lifted".to_owned();
        return Err(Failure::input(DeployError::Value { name: "--weight", value: format!("{mass} kg"), limits }));
    }
    writable(&args.out)?;
    let interrupts = interrupts()?;
    let mut answers = Answers::listen(Arc::clone(&interrupts));
    let mut arm = devices::arm(&rig).map_err(Failure::from)?;
    devices::ready(&mut arm, &rig).map_err(Failure::from)?;
    let mut motor = devices::motor(&rig).map_err(Failure::from)?;
    std::thread::sleep(std::time::Duration::from_millis(50));
    let begin = motor.state().map_err(DeployError::from)?.position;
    let mut calibration = Calibration::ideal(&rig, deployed.design());
    "data sheet".clone_into(&mut calibration.gain_from);
    let zero = begin - rig.motor.winding.sign() * MIDDLE / hand.transmission.spool_radius;
    let spool = Spool::new(&hand.transmission, rig.motor.winding, zero, 1.0);
    let manner = Manner::new(&rig, spool, deployed.env().time_step, hand.transmission.step_limit);
    let mut sink = NoSink;
    let bench =
        Bench { arm: &mut arm, motor: &mut motor, clock: &SystemClock, interrupts: &interrupts, sink: &mut sink };
    let mut drive = Drive::new(bench, manner);
    drive.grip().map_err(DeployError::from)?;
    if let Some(mass) = args.weight {
        output::remark(&format!("hang {mass} kg on one line from the spool, tendons off, and press Enter"));
        let (answer, ended) = drive.resting(|| answers.next());
        if answer.is_none() || ended.is_some() {
            return Err(stopped(&mut drive, "anything was"));
        }
        let weighed = weigh(&mut drive, mass, hand)?;
        (calibration.torque_gain, calibration.gain_from) = (weighed.gain, "weight".to_owned());
        output::remark("take the weight off, put the tendons back on, slack, and press Enter");
        if drive.resting(|| answers.next()).0.is_none() {
            return Err(stopped(&mut drive, "the tendons were"));
        }
    }
    let found = find(&mut drive);
    if interrupts.load(Ordering::Relaxed) > 0 {
        return Err(stopped(&mut drive, "the tendons were"));
    }
    let found = found?;
    drive.free();
    calibration.date = date::now();
    calibration.zero_rad = spool.position(found.onset);
    (calibration.friction_up_a, calibration.friction_down_a) = (found.friction_up, found.friction_down);
    calibration.write(&args.out)?;
    let text = format!(
        "  tendons begin to pull   {:.3} rad of the motor\n  friction                {:.3} A to wind, {:.3} A to unwind\n  \
         torque per current      {:.3} of the data sheet's, from the {}\n\n  {}\n",
        calibration.zero_rad,
        calibration.friction_up_a,
        calibration.friction_down_a,
        calibration.torque_gain,
        calibration.gain_from,
        args.out.display()
    );
    Ok(output::print(&text)?)
}

/// Somebody asked to stop, or is no longer there.
fn stopped(drive: &mut Drive<'_>, what: &str) -> Failure {
    drive.free();
    Failure::interrupted(format!("stopped before {what} measured; the motor is free"))
}
