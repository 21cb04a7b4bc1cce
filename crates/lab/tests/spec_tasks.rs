//! What a spec says of its task, so that files can be checked without one, is what the task itself says.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_lab::Assembly;
use hwasp_lab::spec::{EXPERIMENTS, Method, load, resolve};

#[test]
fn groups_efforts_and_observations_are_those_of_the_task() {
    for (name, _) in EXPERIMENTS {
        for (method, _) in Method::ALL {
            let spec = resolve(load(name).unwrap(), Some(method)).unwrap();
            let (group, world) = (spec.task.group(), Assembly::new(&spec).unwrap().problem.training);
            let [real] = world.law.design().groups() else { panic!("{name}: one group of parameters") };
            assert_eq!(group.name, real.name, "{name}");
            assert_eq!((group.dimension, group.count), (real.dimension, real.count), "{name}");
            assert_eq!((group.lo, group.hi), (real.lo, real.hi), "{name}");

            let robot = world.make.make(None).spec().clone();
            assert_eq!(robot.horizon, spec.task.horizon, "{name}");
            assert_eq!(robot.observation.len(), spec.task.observations(), "{name}");
            assert!(robot.effort.iter().all(|port| port.dimension == spec.task.effort_dimension()), "{name} {method}");
        }
    }
}
