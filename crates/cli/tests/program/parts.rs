//! Parts and tolerances.

use crate::sandbox::{Sandbox, without_figures};

#[test]
fn tolerances_of_a_gear() {
    let sandbox = Sandbox::with_run("tolerances-gear");
    let lines = ["tolerances run --episodes 4 --error gear=0.1", "tolerances run --episodes 4 --threads 2 --out again"];
    insta::assert_snapshot!(without_times(&without_figures(&sandbox.transcript(&lines))));
    for name in ["run/build/tolerances.json", "run/build/tolerances.svg", "again/tolerances.png"] {
        assert!(sandbox.path(name).is_file(), "{name}");
    }
}

/// How long is left is chance.
fn without_times(text: &str) -> String {
    let line = |line: &str| line.split_once(", ").map_or(line.to_owned(), |(before, _)| format!("{before}, … left\n"));
    let pieces = text.split_inclusive('\n').map(|l| if l.ends_with(" left\n") { line(l) } else { l.to_owned() });
    pieces.collect()
}

#[test]
fn tolerances_and_parts_that_cannot_be() {
    let sandbox = Sandbox::with_run("parts-refused");
    sandbox.write("mine.csv", "part,wire_mm,outer_mm,turns,leg_angle_deg,leg_mm\na,0.4,5.3,8.25,90\nb,4,5.3,8,90,10\n");
    insta::assert_snapshot!(sandbox.refused(&[
        "tolerances nowhere",
        "tolerances run --error geer=5%",
        "tolerances run --error gear=0",
        "parts run",
        "parts nowhere",
        "parts run --catalogue nowhere.csv",
        "parts run --catalogue mine.csv",
        "parts run --bench axel=3",
    ]));
    assert!(!sandbox.path("run/build").exists());
}

/// A trained hand, its parts, and its controller trained further; a second time, that is there.
#[cfg(feature = "mujoco")]
#[test]
fn parts_of_a_hand() {
    let sandbox = Sandbox::new("parts-hand");
    let small = "--set task.horizon=40 --set train.episode_steps=40 --set train.episodes_per_iteration=4 --set \
                 controller.hidden=[8] --set ppo.minibatch_rows=40 --set baseline.minibatch_rows=40 --set train.evaluation_episodes=2 --set design.logit_half_width=0.5";
    let trained = sandbox.run(&format!("train z-grasp --env-steps 160 {small} --quiet --out hand"));
    assert!(trained.status.success(), "{}", String::from_utf8_lossy(&trained.stderr));
    insta::assert_snapshot!(sandbox.refused(&["parts hand --fine-tune 100", "parts hand --bench axle=\"12mm\""]));

    let line = "parts hand --episodes 3 --fine-tune 320 --threads 2";
    let first = sandbox.run(line);
    let told = String::from_utf8_lossy(&first.stdout).into_owned();
    assert!(first.status.success(), "{told}{}", String::from_utf8_lossy(&first.stderr));
    assert!(told.contains("parts of the catalogue `built in`") && told.contains("trained further"), "{told}");
    let (json, sheet) = (sandbox.read("hand/build/parts.json"), sandbox.read("hand/build/parts.md"));
    assert!(String::from_utf8(sheet).unwrap().contains("## Thumb proximal"));
    assert!(sandbox.run("eval hand/build/tuned").status.success());
    assert!(!sandbox.path("hand/build/tuned/checkpoints").join("iteration-00000002.safetensors").exists());

    let second = sandbox.run(line);
    assert_eq!(
        (String::from_utf8_lossy(&second.stdout).into_owned(), sandbox.read("hand/build/parts.json")),
        (told, json)
    );
    assert!(String::from_utf8_lossy(&second.stderr).contains("hand/build/tuned holds this training already"));

    let longer = sandbox.refused(&["parts hand --episodes 3 --fine-tune 480"]);
    assert!(longer.contains("hand/build/tuned exists already"), "{longer}");
    // It simulated for half a minute, could not write then, and printed nothing. The folder is tried first.
    sandbox.write("file", "");
    let blocked = sandbox.run("parts hand --episodes 2 --out file");
    let errors = String::from_utf8_lossy(&blocked.stderr).into_owned();
    assert!(blocked.status.code() == Some(1) && errors.contains("hint: name another folder with --out"), "{errors}");
    assert!(blocked.stdout.is_empty() && !errors.contains("simulating the hand"), "{errors}");
    // A file that cannot be written afterwards keeps nobody from what was found.
    std::fs::create_dir_all(sandbox.path("taken/parts.json")).unwrap();
    let late = sandbox.run("parts hand --episodes 2 --out taken");
    let (found, errors) = (String::from_utf8_lossy(&late.stdout), String::from_utf8_lossy(&late.stderr));
    assert!(found.contains("parts of the catalogue `built in`") && found.contains("on these parts"), "{found}");
    assert!(late.status.code() == Some(1) && errors.contains("simulating the hand"), "{errors}");
    assert!(errors.contains("taken/parts.json"), "{errors}");
}

/// `tolerances` simulated, could not write then, and printed nothing. The folder is tried first, and what was found is printed even
/// if a file cannot be written afterwards.
#[test]
fn what_was_found_is_told_even_if_it_cannot_be_written() {
    let sandbox = Sandbox::with_run("parts-unwritable");
    sandbox.write("file", "");
    let line = "tolerances run --episodes 4 --out";
    let blocked = sandbox.run(&format!("{line} file"));
    let told = String::from_utf8_lossy(&blocked.stderr).into_owned();
    assert!(blocked.status.code() == Some(1) && blocked.stdout.is_empty(), "{told}");
    assert!(told.contains("file") && !told.contains("designs simulated"), "{told}");

    std::fs::create_dir_all(sandbox.path("taken/tolerances.json")).unwrap();
    let late = sandbox.run(&format!("{line} taken"));
    let (found, told) = (String::from_utf8_lossy(&late.stdout), String::from_utf8_lossy(&late.stderr));
    assert!(found.contains("change of return") && found.contains("gear"), "{found}");
    assert!(late.status.code() == Some(1) && told.contains("tolerances.json"), "{told}");
}
