//! What a new problem takes: this file. It defines one, and trains, judges, draws, reports, exports and compares it, without a change
//! anywhere else. Should one be needed, a test fails here and not at somebody's desk: a new problem once touched eighteen files.
//!
//! The program of these tests is this one: it has the problem in its catalogue, as a project of a user's has.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use hwasp_core::{
    CommandPort, DesignGroup, DesignSpace, Dimension, EnvSpec, Environment, Hardware, Initial, Law, Plant, Port, Ports,
    Robot, Stream, Task, check_env,
};
use hwasp_diff::{GradCheckSettings, Program, Scalar, gradcheck};
use hwasp_problem::{AnyError, Built, Problem, Role, Words};
use hwasp_settings::{Fields, Settings};
use rand::RngExt;

/// In the environment of this program where it is to be `hwasp`.
const PROGRAM: &str = "HWASP_NEW_PROBLEM";

/// A winch pulls a sled along a rail; the radius of its drum is the design.
struct Winch;

#[derive(Clone, Debug, PartialEq)]
struct WinchSettings {
    /// Where the sled has to be, m.
    goal: f64,
}

impl Settings for WinchSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.quantity("goal", &mut self.goal, Dimension::Length, 0.1..=1.0, "where the sled has to be");
    }
}

impl Problem for Winch {
    type Settings = WinchSettings;

    fn name(&self) -> &'static str {
        "winch"
    }

    fn defaults(&self) -> WinchSettings {
        WinchSettings { goal: 0.5 }
    }

    fn build(&self, settings: &WinchSettings) -> Result<Built, AnyError> {
        let (law, goal) = (Law::new(Drum::new()?), settings.goal);
        let make =
            move |horizon| -> Box<dyn Environment> { Box::new(Robot::new(Sled::default(), Haul { goal }, horizon)) };
        let words =
            Words::about("A winch pulls a sled along a rail.").with(Role::Observation, &[("place", "of the sled")]);
        Ok(Built { words, ..Built::new(law, make) })
    }
}

struct Drum {
    design: DesignSpace,
}

impl Drum {
    fn new() -> Result<Self, AnyError> {
        let radius = DesignGroup {
            name: "radius".into(),
            dimension: Dimension::Length,
            lo: 0.01,
            hi: 0.2,
            count: 1,
            initial: Initial::Value(0.05),
        };
        Ok(Self { design: DesignSpace::new(vec![radius])? })
    }
}

impl Hardware for Drum {
    fn design(&self) -> &DesignSpace {
        &self.design
    }

    fn ports(&self) -> Ports {
        Ports { command: vec!["turn".into()], state: vec!["place".into()], effort: vec!["speed".into()] }
    }

    fn effort<T: Scalar>(&self, design: &[T], command: &[T], _state: &[T], effort: &mut [T]) {
        effort[0] = design[0] * command[0];
    }
}

/// A law that branched on a value got the compiler's advice, `T: PartialOrd`, which leads nowhere. The template of `hwasp init` says
/// what to write instead; here each of its rows is a law.
struct Advice;

const FRICTION: f64 = 0.3;
const LIMIT: f64 = 0.5;
const STOP: f64 = 100.0;

impl Advice {
    fn rows<T: Scalar>(force: T, motor: T, speed: T, angle: T, [here, there]: [T; 2]) -> [T; 5] {
        [
            force.max(T::constant(0.0)),
            motor.clamp(-5.0, 5.0),
            -(speed * 50.0).tanh() * FRICTION,
            -(angle - LIMIT).max(T::constant(0.0)) * STOP,
            here + ((angle - LIMIT) * 50.0).sigmoid() * (there - here),
        ]
    }

    fn is_right() {
        let template = include_str!("../../../templates/plant/src/spring.rs");
        let (_, rows) = template.split_once("    /// |---|---|\n").unwrap();
        let rows: Vec<&str> = rows.lines().map_while(|row| row.trim().strip_prefix("/// |")).collect();
        assert_eq!(rows.len(), 5, "{rows:?}");
        for row in rows {
            let code = row.split('`').rev().nth(1).unwrap();
            assert!(
                include_str!("new_problem.rs").contains(&format!("            {code},\n")),
                "not tried here: {code}"
            );
        }
        // Force, motor, speed, angle, the formula below the limit and the one above: on both sides of every limit.
        let names = ["force", "motor", "speed", "angle", "here", "there"];
        let program = Program::trace(&[] as &[&str], &names, |_, c| {
            let rows = Self::rows(c[0], c[1], c[2], c[3], [c[4], c[5]]);
            rows.into_iter().enumerate().map(|(i, row)| (format!("row {i}"), row)).collect()
        });
        for (at, expected) in [
            ([-2.0, -9.0, -1.0, 0.2, 3.0, 7.0], [0.0, -5.0, FRICTION, 0.0, 3.0]),
            ([2.0, 4.0, 1.0, 0.8, 3.0, 7.0], [2.0, 4.0, -FRICTION, -0.3 * STOP, 7.0]),
        ] {
            let [force, motor, speed, angle, here, there] = at;
            let found = Self::rows(force, motor, speed, angle, [here, there]);
            assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-5), "{found:?} is not {expected:?}");
            gradcheck(&program, &[], &at, &GradCheckSettings::default()).unwrap();
        }
    }
}

#[derive(Clone, Debug, Default)]
struct Sled {
    place: f64,
}

impl Plant for Sled {
    fn advance(&mut self, effort: &[f64], _command: &[f64]) {
        self.place += 0.1 * effort[0];
    }

    fn state(&self, out: &mut [f64]) {
        out[0] = self.place;
    }
}

#[derive(Clone, Copy, Debug)]
struct Haul {
    goal: f64,
}

impl Task for Haul {
    type Plant = Sled;

    fn spec(&self) -> EnvSpec {
        let port = |name: &str, dimension| Port { name: name.to_owned(), dimension };
        EnvSpec {
            observation: vec![port("place", Dimension::Length)],
            state: vec![port("place", Dimension::Length)],
            context: Vec::new(),
            effort: vec![port("speed", Dimension::Speed)],
            command: vec![CommandPort {
                name: "turn".into(),
                dimension: Dimension::AngularSpeed,
                lo: -5.0,
                hi: 5.0,
                direct: true,
            }],
            horizon: 20,
            time_step: 0.1,
            shaped_by: vec![],
            terms: vec![],
        }
    }

    fn reset(&mut self, sled: &mut Sled, rng: &mut Stream) {
        sled.place = 0.1 * rng.random::<f64>();
    }

    fn observe(&self, sled: &Sled, out: &mut [f64]) {
        out[0] = sled.place;
    }

    fn reward(&mut self, sled: &Sled, _command: &[f64]) -> f64 {
        -(sled.place - self.goal).powi(2)
    }
}

const EXPERIMENT: &str = r#"
name = "winch"
[task]
problem = "winch"
goal = "40 cm"
[ppo]
minibatch_rows = 200
[train]
env_steps = 2400
episodes_per_iteration = 20
episode_steps = 20
evaluation_episodes = 20
"#;

fn main() -> ExitCode {
    if std::env::var_os(PROGRAM).is_some() {
        return hwasp_cli::run(&hwasp_builtin::catalogue().with(Winch).unwrap());
    }
    Advice::is_right();
    let built = Winch.build(&Winch.defaults()).unwrap();
    gradcheck(built.training.law.program(), &[0.1], &[2.0, 0.3], &GradCheckSettings::default()).unwrap();
    check_env(&*built.training.make, &built.training.law, false).unwrap();

    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("new-problem");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("winch.toml"), EXPERIMENT).unwrap();
    every_command_works(&folder);
    ExitCode::SUCCESS
}

fn every_command_works(folder: &Path) {
    let run = |line: &str| {
        let mut program = Command::new(std::env::current_exe().unwrap());
        program.args(line.split(' ')).current_dir(folder).env(PROGRAM, "1").output().unwrap()
    };
    let hwasp = |line: &str| {
        let output = run(line);
        let (told, wrong) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
        assert!(output.status.success(), "{line}: {wrong}");
        told
    };
    let has = |files: &[&str]| {
        for file in files {
            let path: PathBuf = folder.join(file);
            assert!(path.metadata().is_ok_and(|file| file.len() > 0), "{}", path.display());
        }
    };
    assert!(hwasp("list").contains("winch"));
    assert!(hwasp("schema").contains("\"winch\""));
    assert!(hwasp("check winch.toml").contains("1 design parameter"));
    assert!(hwasp("graph winch.toml").contains("radius"));
    assert!(hwasp("train winch.toml --out run --tensorboard").contains("radius"));
    has(&["run/summary.json", "run/policy.safetensors", "run/design.toml", "run/curves.svg", "run/tensorboard"]);
    assert!(hwasp("eval run --episodes 10").contains("discounted return"));
    assert!(hwasp("eval run --episodes 10 --set task.goal=\"50cm\"").starts_with("  under task.goal = 50cm:"));
    assert!(hwasp("design run").contains("radius"));
    hwasp("plot run --out curves.svg");
    hwasp("tolerances run --episodes 4");
    hwasp("report run --out run.html");
    let page = fs::read_to_string(folder.join("run.html")).unwrap();
    assert!(page.contains("A winch pulls a sled along a rail."));
    // Its task does not say how it looks.
    let refused = run("play run");
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(refused.status.code() == Some(2) && told.contains("nothing is to be seen of winch"), "{told}");
    assert!(!folder.join("run/play").exists());
    hwasp("export run --out export");
    has(&["export/policy.onnx", "export/controller.safetensors", "export/contract.json"]);
    let contract = fs::read_to_string(folder.join("export/contract.json")).unwrap();
    assert!(contract.contains("of the sled"));
    hwasp("compare winch.toml --methods hwasp,minimal --seeds 2 --out compared --quiet");
    has(&["compared/table.md", "compared/comparison.json", "compared/curves.svg"]);
    hwasp("report compared");
    has(&["compared/report.html"]);
    for method in ["fixed", "cmaes", "ars"] {
        hwasp(&format!("check winch.toml --method {method} --set train.env_steps=1e6"));
    }
}
