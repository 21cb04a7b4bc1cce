use hwasp_training::{MetricsRow, ObserverError};

use super::*;

/// Writes down what it hears.
#[derive(Default)]
struct Notes(Vec<String>);

impl Observer for Notes {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        self.0.push(match event {
            Event::Started { resumed, .. } => format!("started {resumed:?}"),
            Event::Iteration(row) => format!("row {}", row.iteration),
            Event::Checkpoint(checkpoint) => format!("checkpoint {}", checkpoint.iteration),
            other => format!("{other:?}"),
        });
        Ok(())
    }
}

fn started() -> Told {
    Told::Started { env_steps: 9, learner: vec!["kl".into()], terms: vec![], totals: vec![] }
}

fn row(iteration: u64) -> Told {
    Told::Iteration(Box::new(MetricsRow { iteration, env_steps: 10 * iteration, ..MetricsRow::default() }))
}

fn checkpoint(iteration: u64) -> Vec<u8> {
    pack(&Checkpoint { iteration, ..Checkpoint::default() }).unwrap()
}

/// The second worker begins at a state from before the last news of the first.
#[test]
fn news_of_several_workers_are_those_of_one() {
    let mut observer = Notes::default();
    let mut heard = Heard { iteration: 0, env_steps: 0, resumed: None, begun: false, observer: &mut observer };
    for told in [started(), row(0), row(1)] {
        heard.hear(&told).unwrap();
    }
    heard.checkpoint(2, &checkpoint(2)).unwrap();
    heard.hear(&row(2)).unwrap();
    // Here the first one is killed.
    for told in [started(), row(2), row(3)] {
        heard.hear(&told).unwrap();
    }
    // One that was left behind, and one of the future, whose rows are not known.
    heard.checkpoint(3, &checkpoint(3)).unwrap();
    heard.checkpoint(9, &checkpoint(9)).unwrap();
    heard.checkpoint(4, &checkpoint(4)).unwrap();
    heard.hear(&Told::Evaluating).unwrap();
    let wanted = ["started None", "row 0", "row 1", "checkpoint 2", "row 2", "row 3", "checkpoint 4", "Evaluating"];
    assert_eq!(observer.0, wanted);
}

/// The log of the first worker tells more than the folder of whoever goes on has.
#[test]
fn whoever_goes_on_hears_what_its_folder_does_not_have() {
    let mut observer = Notes::default();
    let mut heard = Heard { iteration: 2, env_steps: 20, resumed: Some(20), begun: false, observer: &mut observer };
    for told in [started(), row(0), row(1), row(2), started(), row(2), row(3)] {
        heard.hear(&told).unwrap();
    }
    assert_eq!(observer.0, ["started Some(20)", "row 2", "row 3"]);
}
