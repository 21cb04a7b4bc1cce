//! Arguments that are wrong in themselves.

use crate::sandbox::Sandbox;

#[test]
fn commands_and_arguments_that_do_not_exist() {
    let refused = Sandbox::new("unknown-arguments").refused(&[
        "trian reach",
        "train",
        "train reach --sed 3",
        "train reach --method foo",
        "train reach mass-spring",
        "eval",
        "play",
        "plot",
    ]);
    insta::assert_snapshot!(refused);
}

#[test]
fn numbers_that_are_none_or_outside_of_their_limits() {
    let refused = Sandbox::new("numbers").refused(&[
        "train reach --seed abc",
        "train reach --seed -1",
        "train reach --seed 99999999999999999999",
        "train reach --seed 0.5",
        "train reach --threads 0",
        "train reach --threads 1000000",
        "train reach --env-steps 0",
        "train reach --env-steps -5",
        "train reach --env-steps 1e99",
        "train reach --env-steps nan",
        "train reach --env-steps 100",
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
fn settings_that_set_nothing_or_the_wrong_thing() {
    let sandbox = Sandbox::new("settings");
    insta::assert_snapshot!(sandbox.refused(&[
        "check reach --set ppo.clip_ratio",
        "check reach --set =3",
        "check reach --set ppo.clip_ration=0.1",
        "check reach --set ppo.clip_ratio=7",
        "check reach --set ppo.clip_ratio=much",
        "check reach --set noise.effort=3",
        "check reach --set ppo.clip_ratio=7 --set sed=1 --set train.env_steps=0",
    ]));
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
