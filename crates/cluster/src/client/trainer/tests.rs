use hwasp_training::MetricsRow;

use super::*;

fn started() -> Told {
    Told::Started { env_steps: 9, learner: vec!["kl".into()], terms: vec![], totals: vec![] }
}

fn row(iteration: u64) -> Told {
    Told::Iteration(Box::new(MetricsRow { iteration, ..MetricsRow::default() }))
}

fn checkpoint(iteration: u64) -> Told {
    Told::Checkpoint { iteration, state: Payload::Here(vec![]) }
}

/// What is new of this, in words.
fn new(mut known: u64, told: Vec<Told>) -> Vec<String> {
    let word = |told: Told| match told {
        Told::Iteration(row) => format!("row {}", row.iteration),
        Told::Checkpoint { iteration, .. } => format!("checkpoint {iteration}"),
        other => format!("{other:?}").split(' ').next().unwrap().to_owned(),
    };
    told.into_iter().filter(|told| is_new(told, &mut known)).map(word).collect()
}

/// The second worker begins at a state from before the last news of the first, who may not know yet that it was left behind.
#[test]
fn news_of_several_workers_are_those_of_one() {
    let first = vec![started(), row(0), row(1), checkpoint(2), row(2)];
    let second = vec![started(), row(2), row(3), checkpoint(3), checkpoint(9), checkpoint(4), Told::Evaluating];
    let told = new(0, first.into_iter().chain(second).collect());
    let wanted =
        ["Started", "row 0", "row 1", "checkpoint 2", "row 2", "Started", "row 3", "checkpoint 4", "Evaluating"];
    assert_eq!(told, wanted);
}

/// The first worker told more than the folder of whoever goes on has.
#[test]
fn whoever_goes_on_hears_what_its_folder_does_not_have() {
    let told = new(2, vec![started(), row(0), row(1), checkpoint(2), row(2), started(), row(2), row(3)]);
    assert_eq!(told, ["Started", "checkpoint 2", "row 2", "Started", "row 3"]);
}
