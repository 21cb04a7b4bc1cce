//! What was found in logs, as an experiment.

use hwasp_deploy::identify::{Identified, experiment};
use hwasp_experiment::{Layers, resolve};
use hwasp_tasks::grasp::GraspTaskSettings;

use crate::grasps::deployed;

/// The experiment that is written is sound, has the values that were found, and begins where all schedules have ended.
#[test]
fn what_was_found_can_be_trained_with() {
    let found = Identified {
        torque_gain: 0.8,
        tendon_stiffness: 4100.0,
        friction: 0.03,
        delay: 0.03,
        slack: 0.001,
        left: [0.0; 2],
        before: [0.0; 2],
        gain_is_told: true,
    };
    let text = experiment(&deployed("z-grasp"), &found, 1.0).unwrap();
    let layers = Layers::from_text("identified.toml", &text).unwrap();
    let spec = resolve(layers, None, &hwasp_builtin::catalogue()).unwrap();
    let task = spec.task.settings::<GraspTaskSettings>().unwrap();
    let around = |[low, high]: [f64; 2], value: f64| {
        assert!((low / value - 0.9).abs() < 1e-3 && (high / value - 1.1).abs() < 1e-3, "[{low}, {high}], not {value}");
    };
    around(task.bench.torque_gain, 1.25);
    around(task.bench.limit_gain, 0.8);
    around(task.bench.motor_friction, 0.03);
    around(task.bench.delay, 0.03);
    around(task.bench.slack, 0.001);
    assert_eq!((task.tendon_stiffness, task.hand().transmission.tendon_stiffness), (4100.0, 4100.0));
    assert_eq!(spec.train.progress_start, 1.0);
}
