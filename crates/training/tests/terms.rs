//! The terms of a reward, each by itself: in the rows of a training and in evaluations.

#![allow(clippy::unwrap_used)]

use std::sync::atomic::AtomicBool;

use hwasp_core::Serial;
use hwasp_testing::{Keeper, executor, layers, resolve};
use hwasp_training::{Assembly, Event, Observer, ObserverError, Trained, evaluate, train};

/// Keeps rows and the names of terms.
#[derive(Default)]
struct Named(Keeper, Vec<String>);

impl Observer for Named {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        if let Event::Started { terms, .. } = event {
            self.1 = terms.to_vec();
        }
        self.0.on(event)
    }
}

fn run(method: &str, settings: &[(&str, &str)], threads: usize) -> (Named, Trained) {
    let few = [("train.env_steps", "6000"), ("train.evaluation_episodes", "5"), ("search.inner_env_steps", "1000")];
    let few = few.iter().chain(&[("cmaes.popsize", "4"), ("train.episodes_per_iteration", "7")]);
    let layers = few.chain(settings).fold(layers("balanced-arm"), |layers, (k, v)| layers.with_override(k, v));
    let assembly = Assembly::new(&resolve(layers, Some(method)).unwrap()).unwrap();
    let mut named = Named::default();
    let trained = train(&assembly, &*executor(threads), &mut named, &AtomicBool::new(false)).unwrap();
    (named, trained)
}

/// Whoever runs the episodes, and however they are counted.
#[test]
fn terms_add_up_to_the_return_on_any_number_of_threads() {
    let searches: &[(&str, &str)] =
        &[("search.episodes", "2"), ("ars.variant", "v2-t"), ("ars.directions", "2"), ("ars.top", "2")];
    let lanes: &[(&str, &str)] = &[("train.steps_per_iteration", "1000"), ("train.reward_scaling", "true")];
    for (method, settings) in [("hwasp", &[][..]), ("hwasp", lanes), ("cmaes", searches), ("ars", searches)] {
        let ((one, trained), (four, again)) = (run(method, settings, 1), run(method, settings, 4));
        assert_eq!(one.1, ["effort", "place"]);
        assert!(one.0.rows.len() > 1 && one.0.rows == four.0.rows, "{method}");
        for row in &one.0.rows {
            let (sum, whole) = (row.terms.iter().sum::<f64>(), row.undiscounted_return);
            assert!((sum - whole).abs() <= 1e-9 * whole.abs(), "{method}: {row:?}");
            assert!(row.terms.len() == 2 && row.terms.iter().all(|term| *term < 0.0), "{method}: {row:?}");
        }
        let evaluation = &trained.evaluation;
        assert_eq!((evaluation.terms.len(), evaluation), (2, &again.evaluation), "{method}");
        let (sum, whole) = (evaluation.terms.values().sum::<f64>(), evaluation.undiscounted_return.mean);
        assert!((sum - whole).abs() <= 1e-9 * whole.abs(), "{method}: {evaluation:?}");
    }
}

/// A reward beyond single precision ended a training with "an advantage is not finite": nothing named the reward.
#[test]
fn a_reward_that_is_too_large_is_named() {
    let settings = [("task.reward.place", "\"-1e60\""), ("train.env_steps", "6000")];
    let layers = settings.iter().fold(layers("balanced-arm"), |layers, (k, v)| layers.with_override(k, v));
    let assembly = Assembly::new(&resolve(layers, None).unwrap()).unwrap();
    let error = train(&assembly, &Serial, &mut (), &AtomicBool::new(false)).unwrap_err().to_string();
    let start = "the reward is too large to learn from: up to 1.0e60 in a step of iteration 0, most of it from the term `place`";
    assert!(error.starts_with(start) && error.contains("train.reward_scaling = true"), "{error}");
}

/// Every evaluation tells how long its episodes were, and by which of the task's conditions they ended.
#[test]
fn ends_of_episodes_are_counted_by_name() {
    let ends = |settings: &[(&str, &str)]| {
        let layers = settings.iter().fold(layers("balanced-arm"), |layers, (k, v)| layers.with_override(k, v));
        let assembly = Assembly::new(&resolve(layers, None).unwrap()).unwrap();
        evaluate(&assembly, &assembly.init(), (6, 1), &Serial).unwrap().ends.unwrap()
    };
    let horizon = ("task.horizon", "50");
    let to_the_end = ends(&[horizon]);
    assert_eq!((to_the_end.mean_steps, to_the_end.time_limit, to_the_end.before), (50.0, 6, 0));
    let early = ends(&[horizon, ("task.ends", "{ late = \"step >= 20\", later = \"step >= 20\", never = 0 }")]);
    assert_eq!((early.mean_steps, early.time_limit, early.before), (20.0, 0, 6));
    // Of several at once the first by name.
    assert_eq!(early.named, [("late".to_owned(), 6)].into());
    assert!((early.mean_s / to_the_end.mean_s - 0.4).abs() < 1e-12);
    let unnamed = ends(&[horizon, ("task.ends", "\"step >= 20\"")]);
    assert_eq!((unnamed.before, unnamed.named.len()), (6, 0));
}

/// Of trainings inside of a search only the returns come back; the evaluation has its terms.
#[test]
fn a_search_that_trains_its_candidates_has_no_terms_in_its_rows() {
    let (named, trained) = run("cmaes-rl", &[("train.env_steps", "12000")], 2);
    assert!(named.1.is_empty() && !named.0.rows.is_empty() && named.0.rows.iter().all(|row| row.terms.is_empty()));
    assert_eq!(trained.evaluation.terms.len(), 2);
}
