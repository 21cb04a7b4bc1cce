use super::*;
use crate::archive::{Array, Persist};

/// Best at (0.3, 0.3, …).
fn valley(x: &[f64]) -> f64 {
    -x.iter().map(|x| (x - 0.3).powi(2)).sum::<f64>()
}

fn generations(bo: &mut Bo, count: usize) {
    for _ in 0..count {
        let scores: Vec<f64> = bo.ask().iter().map(|x| valley(x)).collect();
        bo.tell(&scores).unwrap();
    }
}

#[test]
fn begins_with_the_start_and_points_all_over() {
    let mut bo = search(&[0.9, 0.1, 0.5], 7);
    let mut first = Vec::new();
    // 2·3 + 2 points.
    for _ in 0..2 {
        let asked = bo.ask();
        bo.tell(&[0.0, 1.0, 0.5, 0.2]).unwrap();
        first.extend(asked);
    }
    assert_eq!(first[0], [0.9, 0.1, 0.5]);
    for i in 0..3 {
        let mut parts: Vec<usize> = first[1..].iter().map(|p| (p[i] * 7.0) as usize).collect();
        parts.sort_unstable();
        assert_eq!(parts, [0, 1, 2, 3, 4, 5, 6]);
    }
}

#[test]
fn goes_on_from_what_was_saved() {
    let mut bo = search(&[0.9, 0.9], 3);
    for generation in 0..5 {
        let asked = bo.ask();
        assert_eq!(bo.ask(), asked);
        assert!(asked.iter().flatten().all(|x| (0.0..=1.0).contains(x)));
        let mut again = search(&[0.9, 0.9], 3);
        again.load(&bo.save().unwrap()).unwrap();
        assert_eq!((again.ask(), again.center(), again.generation()), (asked, bo.center(), generation));
        assert_ne!(search(&[0.9, 0.9], 4).ask(), again.ask());
        generations(&mut bo, 1);
        generations(&mut again, 1);
        assert_eq!((again.save(), again.ask()), (bo.save(), bo.ask()));
    }
}

/// Candidates left of a half fail: the best of the others is at (0.5, 0.3), beside them.
#[test]
fn failed_candidates_are_left_behind() {
    let told = |failed: f64| {
        let mut bo = search(&[0.9, 0.9], 1);
        let mut asked = Vec::new();
        for _ in 0..8 {
            asked = bo.ask();
            let scores: Vec<f64> = asked.iter().map(|x| if x[0] < 0.5 { failed } else { valley(x) }).collect();
            bo.tell(&scores).unwrap();
        }
        (bo.center(), asked)
    };
    let (center, asked) = told(f64::NAN);
    assert_eq!((center.clone(), asked.clone()), told(f64::NEG_INFINITY));
    assert!((0.5..0.6).contains(&center[0]) && (center[1] - 0.3).abs() < 0.1, "{center:?}");
    assert!(asked.iter().filter(|x| x[0] < 0.5).count() <= 2, "{asked:?}");
    assert_ne!(told(-1e6).1, asked);
}

#[test]
fn refuses_what_is_no_generation() {
    let mut bo = search(&[0.5], 1);
    assert_eq!(bo.tell(&[0.0; 5]), Err(SearchError::Scores { found: 5, expected: 4 }));
    assert_eq!(bo.tell(&[f64::NAN; 4]), Err(SearchError::AllFailed { candidates: 4, generation: 0 }));
    assert_eq!((bo.generation(), bo.center()), (0, vec![0.5]));
    bo.tell(&[1.0, f64::NAN, 0.5, 0.0]).unwrap();
    // A failed generation is no end where something was scored, and the last may be of fewer.
    bo.tell(&[f64::NAN; 4]).unwrap();
    bo.tell(&[2.0]).unwrap();
    assert_eq!((bo.generation(), bo.points.len()), (3, 9));
    let refused = |config, start: f64| Bo::new(config, vec![start], 1).err().unwrap().to_string();
    assert_eq!(refused(BoConfig { popsize: 0, initial_points: 0 }, 0.5), "popsize = 0 is not at least 1");
    assert_eq!(refused(BoConfig::default(), f64::NAN), "start = NaN is not within [0, 1]");
}

#[test]
fn refuses_states_that_cannot_be() {
    let mut bo = search(&[0.5, 0.5], 1);
    generations(&mut bo, 2);
    let saved = bo.save().unwrap();
    let told = |name: &str, array: Array| {
        let mut archive = saved.clone();
        archive.insert(name.to_owned(), array);
        search(&[0.5, 0.5], 1).load(&archive).unwrap_err().to_string()
    };
    assert_eq!(
        told("generation", Array::U64(vec![1])),
        "`scores` of the saved state is 8, which is not as many as the generations have candidates, at most 2000"
    );
    assert_eq!(told("points", Array::F64(vec![0.5; 15])), "`points` of the saved state has 15 elements instead of 16");
    assert_eq!(
        told("points", Array::F64(vec![1.5; 16])),
        "`points` of the saved state is 1.5, which is not within [0, 1]"
    );
    // The largest numbers there are leave a model.
    let mut archive = saved;
    archive.insert("scores".to_owned(), Array::F64([f64::MAX, f64::MIN, -1e300, 0.0].repeat(2)));
    let mut extreme = search(&[0.5, 0.5], 1);
    extreme.load(&archive).unwrap();
    assert!(extreme.ask().iter().flatten().all(|x| (0.0..=1.0).contains(x)));
}
