//! Comparisons that fail in part, are stopped, or run twice at once.

use std::process::Stdio;

use crate::sandbox::{Sandbox, TINY};

const DIVERGES: &str = "compare reach --methods hwasp,minimal --seeds 5 --env-steps 36000 --threads 2 \
                        --set train.evaluation_episodes=5 --set ppo.learning_rate=0.05 --set ppo.max_grad_norm=0 \
                        --set noise.learning_rate_scale=100 --out both";

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Seven of ten trainings diverged; the table had the other three alone, and the program promised that the same command
/// goes on with what fails every time.
#[test]
fn failed_trainings_are_told_and_not_promised_to_go_on() {
    let sandbox = Sandbox::new("compare-failed");
    let (first, again) = (sandbox.run(DIVERGES), sandbox.run(DIVERGES));
    for output in [&first, &again] {
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let (out, told) = (text(&output.stdout), text(&output.stderr));
        assert!(out.contains(" of 5 |") && out.contains("failed: "), "{out}");
        assert!(told.contains("of 10 trainings failed; both/table.md says why"), "{told}");
        assert!(told.contains("remove a cell's folder, both/cells/") && !told.contains("goes on"), "{told}");
    }
    assert!(text(&again.stderr).contains("failed before, and is not repeated"));
    assert!(sandbox.run("report both").status.success());
    let html = text(&sandbox.read("both/report.html"));
    assert!(html.contains("Seeds that did not finish") && !html.contains("nothing else was trained"), "{html}");
}

/// With one seed, the table said `[-8.5, -8.5]` and the page "better in 100 % of all pairs"; an evaluation of one episode,
/// a training, tolerances alike.
#[test]
fn nothing_is_certain_from_one_seed_or_episode() {
    let sandbox = Sandbox::with_run("certain");
    let line =
        "compare reach --methods hwasp,minimal --seeds 1 --env-steps 2400 --set train.evaluation_episodes=1 --out both";
    let table = text(&sandbox.run(line).stdout);
    assert!(table.contains("(1 seed)") && !table.contains('['), "{table}");
    assert!(sandbox.run("report both").status.success());
    let html = text(&sandbox.read("both/report.html"));
    assert!(
        html.contains("So few seeds do not tell the two apart") && !html.contains("of all pairs of seeds,"),
        "{html}"
    );
    for line in
        ["eval run --episodes 3", "tolerances run --episodes 3", &format!("{TINY} --set train.evaluation_episodes=3")]
    {
        let told = text(&sandbox.run(line).stdout);
        assert!(told.contains("no interval") && !told.contains("[-"), "{line}\n{told}");
    }
}

/// Three episodes, none of whose changes had an interval, ended in "To be made precisely first: gear."
#[test]
fn no_part_is_named_from_few_episodes() {
    let sandbox = Sandbox::with_run("precise-by-chance");
    for (episodes, told) in [(1, "1 episode does not tell which part"), (3, "3 episodes do not tell which part")] {
        let found = text(&sandbox.run(&format!("tolerances run --episodes {episodes} --out {episodes}")).stdout);
        assert!(found.contains(told), "{found}");
        assert!(!found.contains("precisely first") && !found.contains("local optimum"), "{found}");
    }
}

/// Where all seeds of a method had failed, the page said "nothing else was trained".
#[test]
fn a_method_that_failed_altogether_is_on_the_page() {
    let sandbox = Sandbox::new("compare-one-failed");
    // The settings of PPO, which CMA-ES does not read, let every update diverge.
    let line = "compare reach --methods hwasp,cmaes --seeds 2 --env-steps 36000 --threads 2 --set train.evaluation_episodes=5 \
                --set ppo.learning_rate=1 --set ppo.max_grad_norm=0 --set noise.learning_rate_scale=100 --out both";
    let output = sandbox.run(line);
    let table = text(&output.stdout);
    assert!(table.contains("| hwasp | 0 of 2 |") && table.contains("| cmaes | 2 of 2 |"), "{table}");
    assert!(sandbox.run("report both").status.success());
    let html = text(&sandbox.read("both/report.html"));
    assert!(html.contains("no seed of hwasp finished") && !html.contains("nothing else was trained"), "{html}");
}

/// A table that could not be written was not printed either, after all trainings.
#[test]
fn a_table_that_cannot_be_written_is_printed() {
    let sandbox = Sandbox::new("compare-unwritable");
    std::fs::create_dir_all(sandbox.path("both/cells")).unwrap();
    std::fs::create_dir(sandbox.path("both/table.md")).unwrap();
    let line = "compare reach --methods hwasp --seeds 1 --env-steps 2400 --set train.evaluation_episodes=5 --out both";
    let output = sandbox.run(line);
    let (found, told) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(found.contains("| hwasp | 1 of 1 |") && told.contains("cannot write both/table.md"), "{found}{told}");
    assert!(sandbox.run(&format!("{line} --quiet")).stdout.is_empty());
}

#[test]
fn seeds_begin_where_they_are_asked_to() {
    let sandbox = Sandbox::new("compare-first-seed");
    let line = "compare reach --methods hwasp --seeds 2 --first-seed 7 --env-steps 2400 --set train.evaluation_episodes=5 --out both";
    assert!(sandbox.run(line).status.success());
    let seeds = [6, 7, 8, 9].map(|seed| sandbox.path(&format!("both/cells/hwasp-seed{seed}")).is_dir());
    assert_eq!(seeds, [false, true, true, false]);
}

/// `compare` with the methods that it has by itself was refused, for some of them search a design.
#[test]
#[cfg(feature = "mujoco")]
fn a_robot_without_a_design_is_compared_too() {
    let sandbox = Sandbox::new("compare-undesigned");
    sandbox.write(
        "rod.xml",
        "<mujoco><worldbody><body><joint name='hinge'/><geom size='0.1'/></body></worldbody>\
        <actuator><motor name='turn' joint='hinge' ctrlrange='-1 1'/></actuator></mujoco>",
    );
    sandbox.write(
        "rod.toml",
        "name = \"rod\"\n[task]\nproblem = \"model\"\nmodel = \"rod.xml\"\nhorizon = 20\n\
        [task.reward]\nstill = \"-joint.hinge.vel^2\"\n[train]\nepisode_steps = 20\nevaluation_episodes = 2\n",
    );
    let output = sandbox.run("compare rod.toml --seeds 1 --env-steps 10000 --out all");
    let table = text(&output.stdout);
    assert!(
        ["fixed", "cmaes", "ars"].iter().all(|method| table.contains(&format!("| {method} | 1 of 1 |"))),
        "{output:?}"
    );
}

/// A second comparison on the same folder ended both of them with `is in use`.
#[test]
fn a_second_comparison_joins_the_first() {
    let sandbox = Sandbox::new("compare-twice");
    let line = "compare reach --methods hwasp --seeds 4 --env-steps 60000 --threads 1 --out both";
    let begin = || sandbox.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let both = [begin(), begin()].map(|child| child.wait_with_output().unwrap());
    for output in &both {
        assert!(output.status.success() && text(&output.stdout).contains("| hwasp | 4 of 4 |"), "{output:?}");
    }
    assert_eq!(text(&both[0].stdout), text(&both[1].stdout));
    assert!(both.iter().any(|output| text(&output.stderr).contains("waiting for it")), "{both:?}");
}

/// The experiment of a finished run was edited, and its figures were told as if they were of the new one.
#[test]
fn an_experiment_that_was_changed_after_its_training_is_refused() {
    let sandbox = Sandbox::with_run("edited");
    sandbox.replace("run/experiment.toml", "clip_ratio = 0.2", "clip_ratio = 0.20 # the same");
    assert!(sandbox.run("eval run").status.success(), "the same values");
    sandbox.replace("run/experiment.toml", "clip_ratio = 0.20", "clip_ratio = 0.3");
    for line in ["eval run", "report run"] {
        let output = sandbox.run(line);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(text(&output.stderr).contains("run/experiment.toml was changed after the training"), "{output:?}");
    }
}
