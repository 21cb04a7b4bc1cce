//! The driver's own program, in computed time: no sockets, no clock of this machine.

use std::time::Duration;

use hwasp_drivers::ur::registers::{self as r, Command, Doing};
use hwasp_drivers::ur::{Payload, UrSettings, program};
use hwasp_drivers::{Pose, ur};

use super::controller::Controller;
use super::settings::{Generation, UrEmulatorSettings};

struct Bench {
    controller: Controller,
    settings: ur::UrSettings,
    generation: Generation,
}

impl Bench {
    fn new(generation: Generation) -> Self {
        let controller = Controller::new(UrEmulatorSettings::new(generation));
        Self { controller, settings: UrSettings::new("computed"), generation }
    }

    fn start(&mut self) {
        let period = if self.generation == Generation::Cb3 { 0.008 } else { 0.002 };
        self.controller.start(&program(&self.settings, period));
    }

    fn order(&mut self, command: Command, number: i32, beat: i32, target: &Pose, speed: f64) {
        let inputs = &mut self.controller.inputs;
        inputs.wholes[usize::from(r::COMMAND)] = command as i32;
        inputs.wholes[usize::from(r::NUMBER)] = number;
        inputs.wholes[usize::from(r::BEAT)] = beat;
        for axis in 0..3 {
            inputs.reals[usize::from(r::TARGET) + axis] = target.position[axis];
            inputs.reals[usize::from(r::TARGET) + 3 + axis] = target.rotation[axis];
        }
        inputs.reals[usize::from(r::SPEED)] = speed;
    }

    fn run(&mut self, milliseconds: usize) {
        for _ in 0..milliseconds {
            self.controller.millisecond();
        }
        assert_eq!(self.controller.log, [""; 0], "nothing is wrong with the program");
    }

    fn output(&self, register: u8) -> i32 {
        self.controller.outputs.wholes[usize::from(register)]
    }

    fn doing(&self) -> Option<Doing> {
        Doing::of(self.output(r::DOING))
    }

    fn tool(&self) -> Pose {
        super::pose_of(&self.controller.frame())
    }
}

fn shifted(pose: &Pose, x: f64, z: f64) -> Pose {
    let mut shifted = *pose;
    shifted.position[0] += x;
    shifted.position[2] += z;
    shifted
}

#[test]
fn what_stands_in_the_registers_at_its_start_is_old() {
    for generation in [Generation::Cb3, Generation::ESeries] {
        let mut bench = Bench::new(generation);
        let before = bench.tool();
        bench.order(Command::Follow, 7, 3, &shifted(&before, 0.02, 0.0), 0.0);
        bench.start();
        bench.run(500);
        assert_eq!(bench.doing(), Some(Doing::Standing));
        assert_eq!((bench.output(r::TAKEN), bench.output(r::PROGRAM)), (7, r::VERSION));
        assert_eq!(bench.tool().distance(&before), 0.0, "it stands");
        assert_eq!(bench.controller.runtime_state(), 2, "and waits as long as it has to");
    }
}

#[test]
fn it_follows_while_its_heart_beats_and_stands_in_the_stated_time_after() {
    for (generation, period) in [(Generation::Cb3, 8), (Generation::ESeries, 2)] {
        let mut bench = Bench::new(generation);
        bench.start();
        bench.run(50);
        let start = bench.tool();
        let (mut beat, mut target) = (0, start);
        // 0.1 m/s, as fast as the limits let it.
        for _ in 0..40 {
            beat += 1;
            target = shifted(&target, 0.001, 0.0);
            bench.order(Command::Follow, 1, beat, &target, 0.0);
            bench.run(10);
        }
        assert_eq!(bench.doing(), Some(Doing::Following));
        assert!((bench.controller.speed() - 0.1).abs() < 0.01, "{} m/s", bench.controller.speed());
        // It lags by the time that it looks ahead.
        let behind = bench.tool().distance(&target);
        assert!(behind > 0.002 && behind < 0.1 * (bench.settings.lookahead + 0.01), "{behind} m behind");
        // The heart stops. Watchdog, two periods to see it, and the way to rest from what is left of its speed.
        bench.run(100 + 2 * period + 12);
        assert_eq!(bench.controller.speed(), 0.0, "it stands");
        bench.run(2 * period);
        assert_eq!(bench.doing(), Some(Doing::Deserted));
        assert_eq!(bench.controller.runtime_state(), 1, "the program has ended");
        // Whoever comes back is not followed.
        let rest = bench.tool();
        bench.order(Command::Follow, 2, beat + 1, &shifted(&rest, 0.02, 0.0), 0.0);
        bench.run(300);
        assert_eq!(bench.tool().distance(&rest), 0.0);
    }
}

#[test]
fn a_straight_move_is_straight_and_is_stopped_by_a_silent_heart_too() {
    let mut bench = Bench::new(Generation::Cb3);
    bench.start();
    bench.run(50);
    let start = bench.tool();
    let target = shifted(&start, 0.06, -0.08);
    let mut fastest: f64 = 0.0;
    for beat in 1..400 {
        bench.order(Command::Move, 1, beat, &target, 0.05);
        bench.run(10);
        fastest = fastest.max(bench.controller.speed());
        let at = bench.tool();
        // The distance from the line between both ends.
        let along = (at.position[0] - start.position[0]) * 0.6 - (at.position[2] - start.position[2]) * 0.8;
        let off = at.distance(&shifted(&start, 0.6 * along, -0.8 * along));
        assert!(off < 1e-9, "{off} m off the line");
    }
    assert_eq!(bench.doing(), Some(Doing::Standing));
    assert!(bench.tool().distance(&target) < 1e-9);
    assert!((fastest - 0.05).abs() < 1e-4, "{fastest} m/s");
    // Back, and the heart stops under way.
    for beat in 400..450 {
        bench.order(Command::Move, 2, beat, &start, 0.05);
        bench.run(10);
    }
    assert!(bench.controller.speed() > 0.049);
    bench.run(100 + 16 + 110);
    assert_eq!(bench.controller.speed(), 0.0, "0.05 m/s end in 0.1 s at 0.5 m/s²");
    bench.run(16);
    assert_eq!(bench.doing(), Some(Doing::Deserted));
    assert!(bench.tool().distance(&start) > 0.05);
}

#[test]
fn orders_stop_it_and_end_it() {
    let mut bench = Bench::new(Generation::ESeries);
    bench.settings.watchdog = Duration::from_millis(200);
    bench.start();
    bench.run(20);
    let start = bench.tool();
    for beat in 1..20 {
        bench.order(Command::Follow, 1, beat, &shifted(&start, 0.001 * f64::from(beat), 0.0), 0.0);
        bench.run(10);
    }
    bench.order(Command::Stand, 2, 20, &start, 0.0);
    bench.run(30);
    assert_eq!((bench.controller.speed(), bench.doing()), (0.0, Some(Doing::Standing)));
    let rest = bench.tool();
    bench.run(1000);
    assert_eq!(bench.tool(), rest, "standing needs no heart");
    bench.order(Command::Move, 3, 21, &shifted(&rest, 0.05, 0.0), 0.05);
    bench.run(150);
    bench.order(Command::Stand, 4, 22, &start, 0.0);
    bench.run(150);
    assert_eq!((bench.controller.speed(), bench.doing()), (0.0, Some(Doing::Standing)));
    assert!(bench.tool().distance(&rest) < 0.02, "it did not go on");
    bench.order(Command::End, 5, 23, &start, 0.0);
    bench.run(10);
    assert_eq!((bench.controller.runtime_state(), bench.doing()), (1, Some(Doing::Ended)));
}

#[test]
fn tool_and_payload_are_set_before_anything_moves() {
    let mut bench = Bench::new(Generation::Cb3);
    bench.settings.tcp = Some(Pose { position: [0.0, 0.0, 0.12], rotation: [0.0, 0.0, 0.5] });
    bench.settings.payload = Some(Payload { mass: 0.62, center: [0.0, 0.01, 0.04] });
    let flange = bench.tool();
    bench.start();
    bench.run(50);
    assert_eq!(bench.controller.payload, (0.62, [0.0, 0.01, 0.04]));
    assert!((bench.tool().distance(&flange) - 0.12).abs() < 1e-9);
    assert!((bench.tool().turn(&flange) - 0.5).abs() < 1e-6);
}

#[test]
fn a_target_out_of_reach_ends_the_program_and_nothing_moves() {
    let mut bench = Bench::new(Generation::Cb3);
    bench.start();
    bench.run(50);
    let start = bench.tool();
    bench.order(Command::Follow, 1, 1, &shifted(&start, 3.0, 0.0), 0.0);
    for _ in 0..100 {
        bench.controller.millisecond();
    }
    assert_eq!(bench.controller.runtime_state(), 1);
    assert!(
        bench.controller.log[0].contains("get_inverse_kin: the pose is out of reach"),
        "{:?}",
        bench.controller.log
    );
    assert_eq!(bench.tool(), start);
}
