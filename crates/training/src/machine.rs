//! Whether two experiments are about the same machine: one that was trained, and the same in another world.

use std::sync::Arc;

use hwasp_core::{CommandPort, DesignGroup, EnvSpec, Law, PolicySpec};
use hwasp_problem::World;

use crate::assemble::Assembly;

/// Where between their limits designs are built to compare what laws say is to be built.
const SHARES: [f64; 3] = [0.1, 0.5, 0.9];

impl Assembly {
    /// What of the machine is another one in `other`: its design, its law, its ports or its controller. None where at most the
    /// world, the starts, the rewards or the training differ, so that what was trained in one can be judged in the other.
    pub fn other_machine(&self, other: &Self) -> Option<&'static str> {
        let worlds = |assembly: &Self| [assembly.worlds.training.clone(), assembly.worlds.deployment.clone()];
        if self.experiment().task.name() != other.experiment().task.name() {
            return Some("the problem");
        }
        let pairs = worlds(self).into_iter().zip(worlds(other));
        let world = pairs.into_iter().find_map(|(one, other)| other_world(&one, &other));
        world.or_else(|| other_policy(self.policy.spec(), other.policy.spec()))
    }

    /// What was trained here, in the worlds of `other`, which is no [other machine](Self::other_machine).
    #[must_use]
    pub fn judged_in(&self, other: &Self) -> Self {
        let mut judged = other.clone();
        judged.policy = Arc::clone(&self.policy);
        judged
    }
}

fn other_world(one: &World, other: &World) -> Option<&'static str> {
    let limits = |law: &Law| -> Vec<DesignGroup> {
        // Where a design begins does not matter to one that is trained.
        let initial = hwasp_core::Initial::Value(0.0);
        law.design().groups().iter().map(|group| DesignGroup { initial, ..group.clone() }).collect()
    };
    // Whether plant or task read a command as well says how training samples it, and nothing of what is built.
    let motors = |env: &EnvSpec| -> Vec<CommandPort> {
        env.command.iter().map(|port| CommandPort { direct: true, ..port.clone() }).collect()
    };
    let ports = |env: &EnvSpec| (env.observation.clone(), env.state.clone(), env.effort.clone());
    if limits(&one.law) != limits(&other.law) {
        Some("the design's parameters or their limits")
    } else if motors(&one.env) != motors(&other.env) {
        Some("the motors or their limits")
    } else if one.law.ports() != other.law.ports() || ports(&one.env) != ports(&other.env) {
        Some("what goes into the controller and the law and what comes out")
    } else if one.env.shaped_by != other.env.shaped_by {
        Some("what of the design the world's model is made from")
    } else if one.law.program() != other.law.program() || !builds_alike(&one.law, &other.law) {
        Some("the law")
    } else {
        None
    }
}

/// Whether two laws of the same design have the same things built of it.
fn builds_alike(one: &Law, other: &Law) -> bool {
    SHARES.iter().all(|share| {
        let groups = one.design().groups().iter();
        let design: Vec<f64> = groups.flat_map(|g| vec![g.lo + share * (g.hi - g.lo); g.count]).collect();
        one.as_built(&design) == other.as_built(&design)
    })
}

fn other_policy(one: &PolicySpec, other: &PolicySpec) -> Option<&'static str> {
    let network = |spec: &PolicySpec| (spec.hidden.clone(), spec.activation, spec.squash);
    let scaling = |spec: &PolicySpec| (spec.observation_center.clone(), spec.observation_scale.clone(), spec.normalize);
    if network(one) != network(other) {
        Some("the controller's network")
    } else if scaling(one) != scaling(other) {
        Some("how the controller sees what it observes")
    } else if one.sees_design != other.sees_design {
        Some("whether the controller sees the design")
    } else if one.placements != other.placements {
        Some("where the design's parameters sit, or the values of those that are fixed")
    } else if one.noise.train != other.noise.train {
        Some("which parameters the policy has")
    } else {
        None
    }
}
