//! Every way in which an experiment can be wrong, as it is told.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_experiment::{Catalogue, LONGEST_FILE, Layers, load};
use hwasp_testing::{catalogue, layers, resolve};

/// The faults of a text that is not what it should be.
fn faults(text: &str, method: Option<&str>) -> String {
    match Layers::from_text("my.toml", text) {
        Ok(layers) => resolve(layers, method).expect_err("this has to be refused").to_string(),
        Err(errors) => errors.to_string(),
    }
}

/// The faults of an experiment that is right, with options that are not.
fn option_faults(experiment: &str, options: &[&str]) -> String {
    let layers = layers(experiment);
    let layers = options.iter().fold(layers, |layers, option| layers.with_assignment(option));
    resolve(layers, None).expect_err("this has to be refused").to_string()
}

/// One snapshot per wrong file: the two lines every file needs, and the ones that are wrong.
macro_rules! wrong_files {
    ($($name:ident: $text:expr;)+) => {$(
        #[test]
        fn $name() {
            let text = format!("name = \"my\"\ntask = {{ problem = \"stiffness\" }}\n{}", $text);
            insta::assert_snapshot!(stringify!($name), faults(&text, None));
        }
    )+};
}

wrong_files! {
    misspelt_key: "[ppo]\nclip_raito = 0.2\n";
    key_of_another_table: "[train]\nclip_ratio = 0.2\n";
    rows_of_the_curvature: "[trpo]\nfisher_rows = 1.5\nmax_kl = 0\n[baseline]\nminibatch_rows = 5000\n";
    near_a_key_of_another_table: "[train]\nlearning_rat = 0.2\n";
    key_nobody_knows: "[design]\nwarmth = 3\n";
    misspelt_table: "[contoller]\nhidden = [8]\n";
    table_that_is_a_number: "ppo = 3\n";
    number_out_of_range: "[ppo]\nclip_ratio = 2\ngae_lambda = -1e-9\nlearning_rate = nan\n";
    integer_out_of_range: "[ppo]\nepochs = 0\n[train]\nenv_steps = -5\nevaluation_episodes = 99999999999999999999\n";
    wrong_types: "seed = \"three\"\n[ppo]\nclip_ratio = \"small\"\nepochs = 2.5\nbootstrap_truncated = 1\n[controller]\nhidden = 32\nactivation = 3\n";
    misspelt_choice: "[controller]\nactivation = \"tahn\"\n[baseline]\nkind = \"forest\"\n";
    wrong_lists: "[controller]\nhidden = [32, 0, 5000]\nobservation_scale = [1.0]\nobservation_center = [0.1, \"x\"]\n";
    too_many_layers: "[controller]\nhidden = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17]\n";
    missing_unit: "[noise]\neffort = 3\neffort_final = \"0.3\"\n";
    wrong_unit: "[noise]\neffort = \"3 m\"\n";
    unknown_unit: "[noise]\neffort = \"3 lbf\"\n";
    no_quantity: "[noise]\neffort = \"strong\"\n";
    anneal_backwards: "[noise]\nanneal = [0.75, 0.25]\n";
    noise_of_commands: "[noise]\ncommand = [0.3, 0.2]\ncommand_final = \"small\"\n";
    initial_outside: "[design]\ninitial = \"10 N/m\"\n";
    initial_misspelt: "[design]\ninitial = \"midle\"\n";
    placements_beyond: "[design.placements]\n\"stiffness[10]\" = \"action\"\n\"length[0]\" = \"action\"\n\"stiffness[3..3]\" = \"fixed\"\n\"stiffness[1]\" = \"grpah\"\n";
    placements_twice: "[design.placements]\n\"stiffness[2..5]\" = \"action\"\n\"stiffness[4]\" = \"fixed\"\n";
    placements_too_few: "[design]\nplacements = [\"graph\", \"action\"]\n";
    rows_and_steps: "[train]\nepisodes_per_iteration = 4\nepisode_steps = 1200\nenv_steps = 1000\n[ppo]\nminibatch_rows = 9000\n";
    too_many_rows: "[train]\nepisodes_per_iteration = 100000\nepisode_steps = 1000\nenv_steps = 1e9\n";
    scaled_twice: "[controller]\nnormalize_observations = true\nobservation_scale = [0.1, 0.5]\n";
    statistics_of_a_search: "method = \"ars\"\n[controller]\nnormalize_observations = true\n[methods.cmaes-rl.controller]\nnormalize_observations = true\n";
    experience_measured_anew: "[learner]\nalgorithm = \"td3\"\n[controller]\nnormalize_observations = true\n[train]\nreward_scaling = true\n";
    replays_that_hold_too_little: "[learner]\nalgorithm = 'td3'\n[td3]\nreplay_frames = 900\n[train]\nepisodes_per_iteration = 4\n";
    designs_that_two_things_move: "[learner]\nalgorithm = 'sac'\n[sac]\ndesign_returns = 60\ndesign_search = 5000\n";
    too_few_returns: "[learner]\nalgorithm = 'sac'\n[sac]\ndesign_returns = 9\n";
    returns_that_no_replay_holds: "[learner]\nalgorithm = 'sac'\n[sac]\ndesign_returns = 6000\nreplay_frames = 10000\n";
    polish_out_of_range: "[polish]\nshare = 0.95\nworld = \"real\"\nprogress_start = -1\n";
    polish_of_less_than_an_iteration: "[train]\nenv_steps = 40000\n[polish]\nshare = 0.09\n";
    polish_that_leaves_too_little: "[train]\nenv_steps = 8000\n[polish]\nshare = 0.6\n";
    polish_in_a_world_that_is_not_there: "[polish]\nshare = 0.2\nworld = \"native\"\n";
    fewer_steps_than_lanes: "[train]\nsteps_per_iteration = 3\nepisodes_per_iteration = 4\n[ppo]\nminibatch_rows = 30\n";
    unknown_method: "[methods.hwsap.ppo]\nepochs = 3\n";
    fault_in_the_tables_of_another_method: "[methods.minimal.ppo]\nepohcs = 3\nclip_ratio = 7\n[methods]\nfixed = 1\n";
    several_sorted_by_line: "[train]\nepisode_steps = 0\n[ppo]\nclip_ratio = 7\nepcohs = 2\n[design]\nplacement = \"grahp\"\n";
    syntax_errors: "[ppo]\nclip_ratio = \nepochs = 4\n[train\nenv_steps = 4 4\n";
    key_twice: "[ppo]\nepochs = 4\nepochs = 5\n";
    escapes_do_not_reach_the_terminal: "[controller]\nactivation = \"\\u001b[31mred\"\n";
}

#[test]
fn keys_of_another_problem() {
    let told = [
        "name = 'my'\n[task]\nproblem = 'stiffness'\ninterface = 'rigid'\nspring = '20 N/m'\n",
        "name = 'my'\n[task]\nproblem = 'bar-length'\nbar = '0.1 m'\ninterface = 'rigid'\neffort_clip = '5 N'\n",
        "name = 'my'\n[task]\nproblem = 'reach'\nsegments = 3\n",
        "name = 'my'\n[task]\nproblem = 'pendulum'\nspring = '20 N/m'\ngoal = '0.2 m'\n[noise]\neffort = '3 N'\n",
        "name = 'my'\n[task]\nproblem = 'bar-length'\ninterface = 'rigid'\n[noise]\neffort = '3 N'\n",
    ]
    .map(|text| faults(text, None));
    insta::assert_snapshot!("keys_of_another_problem", told.join("\n\n-----\n\n"));
}

#[test]
fn nothing_at_all() {
    insta::assert_snapshot!("empty_file", faults("", None));
    insta::assert_snapshot!("empty_name", faults("name = ''\ntask = { problem = 'stifness' }", None));
    // What does not depend on the missing problem is told all the same.
    insta::assert_snapshot!("no_problem", faults("name = 'my'\n[ppo]\nclip_ratio = 3\n[task]\nsegments = 4\n", None));
}

/// A catalogue without learners ended in a panic.
#[test]
fn a_catalogue_without_learners() {
    let layers = Layers::from_text("my.toml", "name = 'my'\ntask = { problem = 'reach' }").unwrap();
    let told = hwasp_experiment::resolve(layers, None, &Catalogue::default()).unwrap_err().to_string();
    assert!(told.contains("it has no learner to train with") && told.contains("with_learner"), "{told}");
}

#[test]
fn too_large() {
    let text = "#".repeat(LONGEST_FILE + 1);
    insta::assert_snapshot!("too_large", faults(&text, None));
    let long_line = format!("name = 'my'\nx = '{0}' bad '{0}'", "x".repeat(1000));
    insta::assert_snapshot!("long_line", faults(&long_line, None));
}

#[test]
fn too_many() {
    let text: String = (0..5000).map(|i| i.to_string()).fold(String::new(), |text, i| text + "key_" + &i + " = 1\n");
    let told = faults(&text, None);
    assert!(told.ends_with("5002 faults, the first 30 of which are shown"), "{told}");
}

#[test]
fn methods() {
    let text = "name = 'my'\nmethod = 'hwasp'\ntask = { problem = 'stiffness' }";
    insta::assert_snapshot!("method_of_an_option", faults(text, Some("minimum")));
    insta::assert_snapshot!("method_of_a_file", faults(&text.replace("'hwasp'", "'cma-es'"), None));
}

#[test]
fn options() {
    let told = option_faults(
        "mass-spring",
        &[
            "ppo.clip_ratio=2",
            "ppo.clip_raito=0.2",
            "noise.effort=3",
            "task.horizon=100",
            "seed=-1",
            "train",
            "=3",
            "ppo..epochs=3",
            "a.b.c.d.e.f.g.h.i=3",
            "controller.hidden=[32,",
            "controller=wide",
            "methods.minimal.ppo.epochs=3",
        ],
    );
    insta::assert_snapshot!("options", told);
}

#[test]
fn hints_name_the_keys_of_this_problem_alone() {
    let told = option_faults("pendulum", &["task.warmth=3"]);
    assert!(told.ends_with("the keys here are `problem`, `horizon`"), "{told}");
}

#[test]
fn names_and_paths() {
    let folder = std::env::temp_dir().join(format!("hwasp-spec-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let latin = folder.join("latin.toml");
    std::fs::write(&latin, b"name = 'my'\n# caf\xe9\n").unwrap();
    let large = folder.join("large.toml");
    std::fs::write(&large, vec![b'#'; LONGEST_FILE + 7]).unwrap();
    let told = |path: &str| {
        let errors = load(path, catalogue()).expect_err("this has to be refused");
        errors.to_string().replace(&folder.display().to_string(), "FOLDER")
    };
    let told = [
        told("mas-spring"),
        told("cartpole"),
        told(&folder.join("absent.toml").display().to_string()),
        told(&latin.display().to_string()),
        told(&large.display().to_string()),
    ];
    std::fs::remove_dir_all(&folder).unwrap();
    insta::assert_snapshot!("names_and_paths", told.join("\n\n"));
}

#[test]
fn a_file_is_read_from_its_path() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../experiments/paper/mass-spring.toml");
    let from_path = resolve(layers(path), None).unwrap();
    assert_eq!(from_path, resolve(layers("paper/mass-spring"), None).unwrap());
}

#[test]
fn lines_are_those_of_the_file() {
    let text = "name = 'my'\r\n\r\n[task]\r\nproblem = 'stiffness'\r\n\thorizon = 'é' # ü\r\n";
    let layers = Layers::from_text("my.toml", text).unwrap();
    let errors = resolve(layers, None).unwrap_err();
    let [fault] = errors.faults() else { panic!("{errors}") };
    assert_eq!((fault.line, fault.key.as_str()), (Some(5), "task.horizon"));
    let excerpt = fault.excerpt.as_ref().unwrap();
    assert_eq!((excerpt.text.as_str(), excerpt.start, excerpt.width), (" horizon = 'é' # ü", 11, 3));
}
