//! An emulated arm and the driver before it.

use std::time::Duration;

use hwasp_drivers::ur::{UrArm, UrSettings};
use hwasp_drivers::{Arm, ArmState, DriverError, Pose};
use hwasp_emulators::ur::{Alone, Generation, UrEmulatorSettings};

/// Patient enough for a busy machine; what is stated of times is told against these.
pub(crate) fn start(generation: Generation) -> (Alone, UrSettings) {
    let alone = Alone::start(&UrEmulatorSettings::new(generation)).expect("free ports");
    let ports = alone.emulator().ports();
    let mut settings = UrSettings::new("127.0.0.1");
    (settings.rtde_port, settings.dashboard_port, settings.script_port) = (ports.rtde, ports.dashboard, ports.script);
    settings.frequency = if generation == Generation::Cb3 { 125.0 } else { 500.0 };
    settings.answer = Duration::from_secs(10);
    settings.oldest = Duration::from_millis(400);
    settings.watchdog = Duration::from_millis(500);
    (alone, settings)
}

pub(crate) fn driven(settings: &UrSettings) -> UrArm {
    let mut arm = UrArm::connect(settings).expect("an arm");
    arm.start().expect("its program");
    arm
}

pub(crate) fn shifted(pose: &Pose, x: f64, z: f64) -> Pose {
    let mut shifted = *pose;
    shifted.position[0] += x;
    shifted.position[2] += z;
    shifted
}

pub(crate) fn pause(milliseconds: u64) {
    std::thread::sleep(Duration::from_millis(milliseconds));
}

/// Asks for the state until it is as expected, for 10 s at most. Says how long that took by the emulator's clock, s.
pub(crate) fn until(
    alone: &Alone,
    arm: &mut UrArm,
    what: &str,
    expected: impl Fn(&Result<ArmState, DriverError>) -> bool,
) -> f64 {
    let since = alone.emulator().clock();
    loop {
        let state = arm.state();
        let took = alone.emulator().clock() - since;
        if expected(&state) {
            return took;
        }
        assert!(took < 10.0, "{what}: after {took:.1} s the state is still {state:?}");
        pause(2);
    }
}
