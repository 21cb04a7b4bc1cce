//! Many requests at once.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;

use hwasp_testing::{layers, resolve};

use crate::client::{ask, empty, get, serve, trained, trained_as};

/// Simulations wait in a short queue, and beyond it nothing piles up.
#[test]
fn more_simulations_than_can_wait_are_put_off() {
    let folder = empty("queue");
    // A simulation of it takes twenty thousand steps.
    let few = [("train.env_steps", "8000"), ("train.evaluation_episodes", "4")];
    let layers = few.iter().fold(layers("mass-spring"), |layers, (key, value)| layers.with_override(key, value));
    trained_as(&folder.join("run"), &resolve(layers, None).unwrap());
    let server = serve(&[folder]);
    let detail = get(&server, "/api/runs/0").json();
    let group = &detail["design"][0];
    let (name, low) = (group["parameters"][0].as_str().unwrap(), group["limits"][0].as_f64().unwrap());
    let high = group["limits"][1].as_f64().unwrap();
    let statuses: Vec<u16> = thread::scope(|scope| {
        let ask = |i: u32| {
            let value = low + (high - low) * f64::from(i) / 100.0;
            let (server, path) = (&server, format!("/api/runs/0/cost/last?{name}={value}"));
            scope.spawn(move || ask(server, "GET", &path, &[]).status)
        };
        let asked: Vec<_> = (0..60).map(ask).collect();
        asked.into_iter().map(|asked| asked.join().unwrap()).collect()
    });
    let many = |status| statuses.iter().filter(|found| **found == status).count();
    assert!(many(200) >= 4 && many(503) > 0 && many(200) + many(503) == 60, "{statuses:?}");
    assert_eq!(get(&server, &format!("/api/runs/0/cost/last?{name}={low}")).status, 200);
}

/// A training that everybody looks at comes to the same bits.
#[test]
fn a_flood_of_requests_changes_nothing_of_a_training() {
    let folder = empty("flood");
    let alone = trained(&folder.join("alone"));
    let server = serve(&[folder.join("watched")]);
    let (over, answered) = (AtomicBool::new(false), AtomicU64::new(0));
    let watched = thread::scope(|scope| {
        for paths in [["/api/runs", "/api/runs/0"], ["/api/runs/0/episode", "/"], ["/api/runs/0", "/api/runs"]] {
            let (server, over, answered) = (&server, &over, &answered);
            scope.spawn(move || {
                while !over.load(Ordering::Relaxed) {
                    for path in paths {
                        let status = get(server, path).status;
                        assert!([200, 404, 409, 503].contains(&status), "{path}: {status}");
                        answered.fetch_add(1, Ordering::Relaxed);
                    }
                }
            });
        }
        // It begins under way.
        while answered.load(Ordering::Relaxed) < 20 {
            thread::yield_now();
        }
        let watched = trained(&folder.join("watched"));
        let seen = answered.load(Ordering::Relaxed);
        while answered.load(Ordering::Relaxed) < seen + 20 {
            thread::yield_now();
        }
        over.store(true, Ordering::Relaxed);
        watched
    });
    assert_eq!(watched, alone);
}
