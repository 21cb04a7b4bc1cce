//! Budgets: what trainings take of them.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_testing::{layers, resolve, run, small, told};
use hwasp_training::{Assembly, Trained};

/// On the reach problem, whose episodes have 30 steps and whose iterations have 40 episodes.
fn trained(method: &'static str, env_steps: &str) -> (Assembly, Trained) {
    let layers = [("train.env_steps", env_steps), ("train.evaluation_episodes", "4")]
        .iter()
        .fold(layers("reach"), |layers, (k, v)| layers.with_override(k, v));
    let assembly = Assembly::new(&resolve(layers, Some(method)).unwrap()).unwrap();
    let trained = run(&assembly, None, 1).0;
    (assembly, trained)
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
