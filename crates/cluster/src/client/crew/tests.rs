use super::*;
use crate::worker::Card;

fn card(name: &str, identity: &Identity, threads: usize, jobs: &[&str], draining: bool) -> Card {
    let at_work = |job: &&str| crate::worker::AtWork {
        job: (*job).to_owned(),
        run: "r".into(),
        kind: "episodes".into(),
        seconds: 1.0,
    };
    Card {
        name: name.into(),
        identity: identity.clone(),
        threads,
        up_s: 1.0,
        jobs: 0,
        busy_s: 0.0,
        draining,
        at_work: jobs.iter().map(at_work).collect(),
    }
}

#[test]
fn only_those_who_give_the_same_bits_are_counted() {
    let same = Identity::new(hwasp_testing::catalogue(), None).unwrap();
    assert_eq!(same, Identity::new(hwasp_testing::catalogue(), None).unwrap());
    let other = Identity { engine: "MuJoCo 0.1".into(), ..same.clone() };
    assert_ne!(same.digest(), other.digest());
    let cards = [
        card("a", &same, 4, &["one"], false),
        card("b", &same, 2, &["two", "three"], true),
        card("c", &other, 8, &[], false),
    ];
    let crew = Crew::of(&cards, &same, "r");
    assert_eq!((crew.workers, crew.slots, crew.idle), (1, 4, 3));
    // What somebody is at who takes no further jobs is not lost.
    assert_eq!(crew.at_work.iter().map(String::as_str).collect::<Vec<_>>(), ["one", "three", "two"]);
    assert_eq!(crew.refused, [("c".to_owned(), "engine MuJoCo 0.1 instead of none".to_owned())]);
}
