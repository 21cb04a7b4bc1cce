//! What a spec says of its task, so that files can be checked without one, is what the task itself says.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_experiment::{Method, load, resolve};
use hwasp_training::Assembly;

#[test]
fn groups_efforts_and_observations_are_those_of_the_task() {
    let catalogue = hwasp_builtin::catalogue();
    for name in catalogue.presets().iter().map(|preset| preset.name) {
        for (method, _) in Method::ALL {
            // Some trainings are shorter than a generation of some searches.
            let layers = load(name, &catalogue).unwrap().with_override("train.env_steps", "1e8");
            let spec = resolve(layers, Some(method), &catalogue).unwrap();
            if name.ends_with("-grasp") && !cfg!(feature = "mujoco") {
                let error = Assembly::new(&spec).err().unwrap().to_string();
                assert!(error.starts_with(&format!("{name} needs the MuJoCo engine")), "{error}");
                continue;
            }
            let world = Assembly::new(&spec).unwrap().worlds.training;
            let (said, real) = (spec.task.groups(), world.law.design().groups());
            assert_eq!(said.len(), real.len(), "{name}");
            let mut first = 0;
            for (said, real) in said.iter().zip(real) {
                assert_eq!((&*said.name, said.first), (&*real.name, first), "{name}");
                assert_eq!((said.dimension, said.count), (real.dimension, real.count), "{name}");
                assert_eq!((said.lo, said.hi), (real.lo, real.hi), "{name}");
                first += real.count;
            }

            let robot = world.make.make(None).spec().clone();
            assert_eq!(robot.horizon, spec.task.horizon, "{name}");
            assert_eq!(robot.observation.len(), spec.task.observations(), "{name}");
            assert_eq!(robot.effort, spec.task.efforts(), "{name} {method}");
        }
    }
}
