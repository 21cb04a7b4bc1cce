//! The hot loops allocate nothing: a step of an episode, a row of inference, a minibatch of an update.
//!
//! What an episode, an update or a pass sets up once is allowed; so the loops are run for twice as long, and the number of
//! allocations may not change.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use allocation_counter::measure;
use common::Case;
use hwasp_algos::{BaselineConfig, Learner, MlpBaselineConfig, Ppo, PpoConfig, PpoSettings};
use hwasp_core::{
    Actor, Batch, EpisodeKind, Episodes, MakeEnvironment, Placement, Policy, Purpose, Sampler, Serial, stream,
};
use hwasp_tasks::mass_spring::{Interface, MassSpring, MassSpringSettings};
use hwasp_tasks::pendulum::{Pendulum, PendulumSettings};
use hwasp_tasks::reach::{Reach, ReachSettings};

const PLACES: [Placement; 4] = [Placement::Graph, Placement::Action, Placement::Episode, Placement::Fixed(1.0)];

#[test]
fn environment_steps_do_not_allocate() {
    let springs = MassSpring::stiffness(MassSpringSettings::default()).unwrap();
    let soft = MassSpring::bar(MassSpringSettings::default(), Interface::Soft).unwrap();
    let rigid = MassSpring::bar(MassSpringSettings::default(), Interface::Rigid).unwrap();
    let pendulum = Pendulum::new(&PendulumSettings::default()).unwrap();
    let reach = Reach::new(ReachSettings::default()).unwrap();
    let worlds: [(&str, &dyn MakeEnvironment); 5] =
        [("springs", &springs), ("soft bar", &soft), ("rigid bar", &rigid), ("pendulum", &pendulum), ("reach", &reach)];
    for (name, make) in worlds {
        let mut environment = make.make(None);
        let spec = environment.spec().clone();
        let (effort, command) = (vec![0.1; spec.effort.len()], vec![0.1; spec.command.len()]);
        let (mut seen, mut state) = (vec![0.0; spec.observation.len()], vec![0.0; spec.state.len()]);
        let counted = measure(|| {
            environment.reset(&mut stream(1, Purpose::Check, 0, 0));
            for _ in 0..20 {
                environment.step(&effort, &command);
                environment.observe(&mut seen);
                environment.state(&mut state);
            }
        });
        assert_eq!(counted.count_total, 0, "{name}: {counted:?}");
    }
}

#[test]
fn actions_do_not_allocate() {
    for place in PLACES {
        let case = Case::mass_spring(place);
        let policy = case.sampler.policy();
        let params = policy.init(1, case.output_gain);
        for rows in [1, 32] {
            let mut actor = Actor::new(policy, &params, 0.0, rows);
            let (obs, state) = (vec![0.1; rows * policy.obs_dim()], vec![0.1; rows * policy.state_dim()]);
            let mut noise: Vec<_> = (0..rows as u64).map(|i| stream(1, Purpose::Check, 0, i)).collect();
            let counted = measure(|| {
                for _ in 0..20 {
                    actor.act(&obs, &state, rows, None);
                    actor.act(&obs, &state, rows, Some(&mut noise));
                }
            });
            assert_eq!(counted.count_total, 0, "{place:?}, {rows} rows: {counted:?}");
        }
    }
}

fn collect(case: &Case, make: &MassSpring, horizon: usize) -> Batch {
    let sampler = Sampler::new(case.sampler.policy().clone(), std::sync::Arc::new(make.clone()), Some(horizon));
    let params = sampler.policy().init(1, case.output_gain);
    let asked = Episodes { seed: 1, iteration: 0, indices: 0..8, progress: 0.0, kind: EpisodeKind::Training };
    sampler.collect(&Serial, &params, &asked).unwrap()
}

#[test]
fn longer_episodes_allocate_no_more_often() {
    let problem = MassSpring::stiffness(MassSpringSettings::default()).unwrap();
    for place in PLACES {
        let case = Case::mass_spring(place);
        let count = |horizon| measure(|| drop(collect(&case, &problem, horizon))).count_total;
        assert_eq!(count(50), count(400), "{place:?}");
    }
}

#[test]
fn more_minibatches_allocate_no_more_often() {
    let problem = MassSpring::stiffness(MassSpringSettings::default()).unwrap();
    for place in PLACES {
        let case = Case::mass_spring(place);
        let batch = collect(&case, &problem, 100);
        let policy = case.sampler.policy();
        // Whole batches are gathered once, minibatches in every epoch.
        for minibatch_rows in [0, 100] {
            let count = |epochs| {
                let ppo = PpoConfig { epochs, minibatch_rows, ..PpoConfig::default() };
                let value = MlpBaselineConfig { epochs, minibatch_rows: 100, ..MlpBaselineConfig::default() };
                let settings = PpoSettings { ppo, baseline: BaselineConfig::Mlp(value) };
                let mut learner = Ppo::new(&settings, policy.clone(), policy.init(1, case.output_gain), 1);
                learner.update(&Serial, &batch, 0.0, 0).unwrap();
                measure(|| _ = learner.update(&Serial, &batch, 0.0, 1).unwrap()).count_total
            };
            assert_eq!(count(1), count(5), "{place:?}, {minibatch_rows} rows");
        }
    }
}

/// An evaluation held all rows of all its episodes at once. What is held of an episode now is less than 100 bytes, and no
/// more where its steps are twice as many.
#[test]
fn more_episodes_are_no_more_rows() {
    let case = Case::reach(Placement::Graph);
    let params = case.sampler.policy().init(1, case.output_gain);
    let peak = |episodes, horizon| {
        let make = std::sync::Arc::new(Reach::new(ReachSettings::default()).unwrap());
        let sampler = Sampler::new(case.sampler.policy().clone(), make, Some(horizon));
        let asked =
            Episodes { seed: 1, iteration: 0, indices: 0..episodes, progress: 1.0, kind: EpisodeKind::Evaluation };
        measure(|| drop(sampler.outcomes(&Serial, &params, &asked, 0.95).unwrap())).bytes_max
    };
    for horizon in [20, 40] {
        let (few, many) = (peak(200, horizon), peak(20_000, horizon));
        assert!(many - few < 100 * 19_800, "{few} bytes for 200 episodes, {many} for 20,000 of {horizon} steps");
    }
}
