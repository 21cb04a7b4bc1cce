//! Budgets: what trainings take of them.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::sync::Arc;

use hwasp_core::{End, Environment, Step, Stream, Watch, Watched};
use hwasp_testing::{layers, resolve, run, small, told};
use hwasp_training::{Assembly, Trained};

/// The reach problem, whose episodes have 30 steps and whose iterations have 40 episodes.
fn assembly(method: &'static str, env_steps: &str) -> Assembly {
    let layers = [("train.env_steps", env_steps), ("train.evaluation_episodes", "4")]
        .iter()
        .fold(layers("reach"), |layers, (k, v)| layers.with_override(k, v));
    Assembly::new(&resolve(layers, Some(method)).unwrap()).unwrap()
}

fn trained(method: &'static str, env_steps: &str) -> (Assembly, Trained) {
    let assembly = assembly(method, env_steps);
    let trained = run(&assembly, None, 1).0;
    (assembly, trained)
}

/// Ends episodes after so many steps.
struct Short {
    most: usize,
    step: usize,
}

impl Watch for Short {
    fn reset(&mut self, inner: &mut dyn Environment, rng: &mut Stream) {
        self.step = 0;
        inner.reset(rng);
    }

    fn step(&mut self, inner: &mut dyn Environment, effort: &[f64], command: &[f64]) -> Step {
        self.step += 1;
        let step = inner.step(effort, command);
        if self.step == self.most { Step { end: Some(End::Terminated), ..step } } else { step }
    }
}

/// The same problem, whose episodes end after so many of their 30 steps.
fn shortened(mut assembly: Assembly, most: usize) -> Assembly {
    let whole = Arc::clone(&assembly.worlds.training.make);
    assembly.worlds.training.make = Arc::new(move |horizon| {
        Box::new(Watched::new(whole.make(horizon), Short { most, step: 0 })) as Box<dyn Environment>
    });
    assembly
}

/// With 21,000 steps given, gradient methods took 24,000: an iteration was begun as long as a single step was left.
#[test]
fn a_training_takes_its_budget_to_within_an_episode_and_never_more() {
    // An iteration takes 1200 steps: budgets of one; one and less than a half; one and a half; two and most of a third.
    for (given, taken, iterations, last) in
        [("1200", 1200, 1, 40), ("1799", 1770, 1, 59), ("1800", 1800, 2, 20), ("3500", 3480, 3, 36)]
    {
        let (assembly, trained) = trained("hwasp", given);
        assert_eq!((trained.env_steps, trained.iterations), (taken, iterations), "{given}");
        assert_eq!(assembly.iterations(), (iterations, last), "{given}");
        assert!(assembly.experiment().train.env_steps - taken < assembly.piece().env_steps, "{given}");
    }
}

/// The training of a candidate ended with a whole iteration, too, and so cost more than the experiment said.
#[test]
fn a_training_inside_of_a_search_takes_its_budget_too() {
    let settings = &[("search.inner_env_steps", "2000"), ("cmaes.popsize", "4"), ("train.env_steps", "9000")];
    let assembly = Assembly::new(&small("cmaes-rl", settings)).unwrap();
    assert_eq!((assembly.generation(), assembly.piece().what), (Some((4, 2000)), "generation"));
    // 2000 steps are 66 episodes: an iteration of 40 and one of 26.
    assert_eq!(run(&assembly, None, 1).0.env_steps, 4 * 66 * 30);
}

/// What was learned before the last iteration does not depend on it; and a last iteration of its own size has the same bits
/// when it is resumed.
#[test]
fn a_last_iteration_of_another_size_resumes_to_the_same_bits() {
    let (assembly, whole) = trained("hwasp", "3500");
    let (_, keeper) = run(&assembly, None, 1);
    for checkpoint in &keeper.checkpoints {
        assert_eq!(told(&run(&assembly, Some(checkpoint), 2).0), told(&whole));
    }
}

/// Where episodes ended early, a training left up to half an iteration of its budget, and the tables said that it leaves less than
/// an episode. Smaller and smaller iterations would spend it too, and end with gradients of one episode.
#[test]
fn episodes_that_end_early_leave_less_than_an_episode() {
    let assembly = shortened(assembly("hwasp", "3500"), 10);
    let (whole, keeper) = run(&assembly, None, 1);
    // Of 10 steps each: five iterations of 40 episodes, one of 50 and one of 33 leave 670 steps, room for 22 whole episodes. Those
    // leave 450, less than half an iteration: so 15 more, and then 10, 6, 4, 3, 2, and three times one.
    let episodes = [40, 40, 40, 40, 40, 50, 33, 22 + 15 + 10 + 6 + 4 + 3 + 2 + 3];
    let mut taken = 0;
    let expected = episodes.map(|episodes| {
        taken += 10 * episodes;
        taken
    });
    assert_eq!(keeper.rows.iter().map(|row| row.env_steps).collect::<Vec<_>>(), expected);
    assert_eq!((whole.env_steps, whole.iterations), (3480, 8));
    // The same bits for any number of threads, and from every checkpoint, the one before the last iteration among them.
    assert_eq!(told(&run(&assembly, None, 2).0), told(&whole));
    for checkpoint in &keeper.checkpoints {
        assert_eq!(told(&run(&assembly, Some(checkpoint), 2).0), told(&whole));
    }
    for (most, given) in [(1, "1200"), (7, "4321"), (29, "2999")] {
        let assembly = shortened(self::assembly("hwasp", given), most);
        let left = assembly.experiment().train.env_steps - run(&assembly, None, 2).0.env_steps;
        assert!(left < assembly.piece().env_steps, "{given} steps, episodes of {most}: {left} are left");
    }
}
