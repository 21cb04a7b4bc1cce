//! Arguments that are wrong in themselves.

use crate::sandbox::Sandbox;

#[test]
fn numbers_that_are_none_or_outside_of_their_limits() {
    let refused = Sandbox::new("numbers").refused(&[
        "train reach --seed abc",
        "train reach --seed 99999999999999999999",
        "train reach --seed 0.5",
        "train reach --threads 1000000",
        "train reach --env-steps 0",
        "train reach --env-steps -5",
        "train reach --env-steps nan",
        "eval run --episodes 0",
        "eval run --episodes 1e12",
        "eval run --seed x",
        "play run --episodes 0",
        "play run --episodes 65",
        "play run --first -1",
        "play run --width 100",
        "play run --height 641",
    ]);
    insta::assert_snapshot!(refused);
}

#[test]
fn a_refused_training_leaves_nothing_behind() {
    let sandbox = Sandbox::new("nothing-behind");
    sandbox.refused(&["train reach --set ppo.clip_ratio=7 --out run", "train reach --env-steps 100"]);
    assert_eq!(std::fs::read_dir(sandbox.path("")).unwrap().count(), 0);
}

#[test]
fn counts_are_read_as_in_experiment_files() {
    let sandbox = Sandbox::new("counts");
    for steps in ["2400", "2_400", "2.4e3"] {
        let line = format!("train reach --env-steps {steps} --set train.evaluation_episodes=2 --quiet --out {steps}");
        assert!(sandbox.run(&line).status.success(), "{line}");
        let summary: serde_json::Value =
            serde_json::from_slice(&sandbox.read(&format!("{steps}/summary.json"))).unwrap();
        assert_eq!(summary["env_steps"], 2400, "{steps}");
    }
}
