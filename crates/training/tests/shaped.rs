//! A problem whose world is made from a part of its design, with efforts of two dimensions and a command for the law alone.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::sync::atomic::AtomicBool;

use hwasp_core::{
    CommandPort, DesignGroup, DesignSpace, Dimension, EnvSpec, Environment, Initial, Law, Placement, Plant, Policy,
    Port, Ports, Robot, Serial, Stream, Task, check_env,
};
use hwasp_diff::Program;
use hwasp_experiment::{Catalogue, Experiment, Faults, Layers, resolve};
use hwasp_problem::{AnyError, Built, Problem};
use hwasp_training::{Assembly, Trained, train};
use rand::RngExt;

/// How long the shank is at best, m.
const BEST: f64 = 0.4;

/// A weight on a shank that is pulled to where it should be.
#[derive(Clone)]
struct Leg {
    shank: f64,
    x: f64,
}

impl Plant for Leg {
    fn set_design(&mut self, design: &[f64]) {
        self.shank = design[1];
    }
    fn advance(&mut self, effort: &[f64], command: &[f64]) {
        // A torque at the shank's end, a force, and a brake that the law does not know.
        self.x += 0.1 * (effort[0] / self.shank + effort[1]) - 0.05 * command[1] * self.x;
    }
    fn state(&self, out: &mut [f64]) {
        out[0] = self.x;
    }
}

/// Stay in the middle, on a shank that is neither short nor long.
struct Stand;

impl Task for Stand {
    type Plant = Leg;

    fn spec(&self) -> EnvSpec {
        let port = |name: &str, dimension| Port { name: name.into(), dimension };
        let motor = |name: &str, direct| CommandPort {
            name: name.into(),
            dimension: Dimension::None,
            lo: -1.0,
            hi: 1.0,
            direct,
        };
        EnvSpec {
            observation: vec![port("x", Dimension::Length)],
            state: vec![port("x", Dimension::Length)],
            context: vec![],
            effort: vec![port("knee", Dimension::Torque), port("pull", Dimension::Force)],
            command: vec![motor("motor", false), motor("brake", true)],
            horizon: 20,
            time_step: 0.1,
            shaped_by: vec!["shank".into()],
            terms: vec![],
        }
    }
    fn reset(&mut self, plant: &mut Leg, rng: &mut Stream) {
        plant.x = rng.random::<f64>() - 0.5;
    }
    fn observe(&self, plant: &Leg, out: &mut [f64]) {
        out[0] = plant.x;
    }
    fn reward(&mut self, plant: &Leg, _command: &[f64]) -> f64 {
        -plant.x.powi(2).min(4.0) - 20.0 * (plant.shank - BEST).powi(2)
    }
}

fn make(horizon: Option<usize>) -> Box<dyn Environment> {
    Box::new(Robot::new(Leg { shank: 0.5, x: 0.0 }, Stand, horizon))
}

fn law() -> Law {
    let group = |name: &str, dimension, lo, hi, initial| {
        let (name, initial) = (name.into(), Initial::Value(initial));
        DesignGroup { name, dimension, lo, hi, count: 1, initial }
    };
    let design = DesignSpace::new(vec![
        group("gear", Dimension::None, 0.1, 2.0, 1.0),
        group("shank", Dimension::Length, 0.1, 0.9, 0.7),
        group("spring", Dimension::Stiffness, 0.0, 10.0, 5.0),
    ]);
    let ports =
        Ports { command: vec!["motor".into()], state: vec!["x".into()], effort: vec!["knee".into(), "pull".into()] };
    let program = Program::trace(&["gear", "shank", "spring"], &["motor", "x"], |u, c| {
        vec![("knee".into(), c[0] * u[0]), ("pull".into(), u[2] * c[1] * -1.0)]
    });
    Law::from_program(program, design.unwrap(), ports).unwrap()
}

struct Shank;

impl Problem for Shank {
    type Settings = ();

    fn name(&self) -> &'static str {
        "shank"
    }
    fn defaults(&self) {}
    fn build(&self, (): &()) -> Result<Built, AnyError> {
        Ok(Built::new(law(), make))
    }
}

fn catalogue() -> Catalogue {
    hwasp_testing::catalogue().clone().with(Shank).unwrap()
}

const FILE: &str = "name = \"shank\"\ntask = { problem = \"shank\" }\n[train]\nepisode_steps = 20\nenv_steps = 40_000\n\
                    evaluation_episodes = 20\n";

fn resolved(more: &str, method: &str) -> Result<Experiment, Faults> {
    resolve(Layers::from_text("shank.toml", &format!("{FILE}{more}")).unwrap(), Some(method), &catalogue())
}

fn told(more: &str) -> String {
    resolved(more, "hwasp").unwrap_err().to_string()
}

/// The environment keeps what it promises, in worlds of all designs.
#[test]
fn the_world_is_sound() {
    assert_eq!(check_env(&make, &law(), false), Ok(()));
}

/// What the world is made from is drawn once an episode where the method has other parameters in the graph or in the action,
/// searches included; the text of the resolved experiment says the same again.
#[test]
fn what_shapes_the_world_finds_its_place() {
    use Placement::{Action, Episode, Fixed, Graph};
    let given = "[design.placements]\nspring = \"fixed\"\n";
    for (method, more, places) in [
        ("hwasp", "", [Graph, Episode, Graph]),
        ("hwasp", given, [Graph, Episode, Fixed(5.0)]),
        ("minimal", "", [Action, Episode, Action]),
        ("episode", "", [Episode; 3]),
        ("fixed", "", [Fixed(1.0), Fixed(0.7), Fixed(5.0)]),
        ("cmaes", "", [Action, Episode, Action]),
        (
            "hwasp",
            "[design]\nplacement = \"fixed\"\nplacements = { shank = \"episode\" }\n",
            [Fixed(1.0), Episode, Fixed(5.0)],
        ),
    ] {
        let experiment = resolved(more, method).unwrap();
        assert_eq!(Assembly::new(&experiment).unwrap().policy.spec().placements, places, "{method} {more}");
        let again = Layers::from_text("again.toml", &experiment.to_toml().unwrap()).unwrap();
        assert_eq!(resolve(again, None, &catalogue()).unwrap(), experiment, "{method} {more}");
    }
}

/// It cannot be put where it would change within an episode, and the fault says what to do.
#[test]
fn what_shapes_the_world_cannot_change_within_an_episode() {
    for place in ["graph", "action"] {
        let found = told(&format!("[design.placements]\nshank = \"{place}\"\n"));
        assert!(found.contains(&format!(
            "design.placements.\"shank\" = \"{place}\" is impossible: the world's model is made from"
        )));
        assert!(found.contains("shank.toml:8:9") && found.contains("write \"episode\""), "{found}");
    }
    let found = told("[design]\nplacements = [\"graph\", \"graph\", \"graph\"]\n");
    assert!(found.contains("design.placements[1] = \"graph\" is impossible"), "{found}");
}

/// A problem cannot say that its world is made from what is no part of the design.
#[test]
fn the_world_is_made_from_the_design() {
    struct Stranger;
    impl Problem for Stranger {
        type Settings = ();
        fn name(&self) -> &'static str {
            "stranger"
        }
        fn defaults(&self) {}
        fn build(&self, (): &()) -> Result<Built, AnyError> {
            let mut built = Built::new(law(), make);
            built.deployment.env.shaped_by = vec!["shin".into()];
            Ok(built)
        }
    }
    let found = catalogue().with(Stranger).unwrap_err().to_string();
    assert!(found.contains("made from `shin`, which is no group of the design: `gear`, `shank`, `spring`"), "{found}");
}

/// Efforts of two dimensions were refused, as they had one exploration.
#[test]
fn each_effort_is_explored_by_its_own() {
    let std = |more: &str| {
        let assembly = Assembly::new(&resolved(more, "hwasp").unwrap()).unwrap();
        // The draw of the shank, both efforts, and the brake; only the law reads the motor.
        assert_eq!(assembly.policy.action_names(), ["shank", "knee", "pull", "brake"]);
        let mut log_std = [0.0; 4];
        let mut at = |progress| {
            assembly.policy.log_std(&assembly.init(), progress, &mut log_std);
            [1, 2].map(|j| f64::from(log_std[j].exp()))
        };
        [at(0.0), at(1.0)]
    };
    let close = |found: [[f64; 2]; 2], wanted: [[f64; 2]; 2]| {
        let pairs = found.iter().flatten().zip(wanted.iter().flatten());
        assert!(pairs.clone().all(|(a, b)| (a / b - 1.0).abs() < 1e-5), "{found:?} is not {wanted:?}");
    };
    close(std(""), [[0.5, 3.0]; 2]);
    close(std("[noise]\neffort = { knee = \"0.2 N*m\" }\n"), [[0.2, 3.0]; 2]);
    close(
        std("[noise]\neffort = [\"0.2 N*m\", \"1 N\"]\neffort_final = { pull = \"10 mN\" }\n"),
        [[0.2, 1.0], [0.2, 0.01]],
    );
    close(std("[noise]\neffort_final = [\"0.1 N*m\", \"1 N\"]\n"), [[0.5, 3.0], [0.1, 1.0]]);

    // They come back from the resolved text.
    let experiment =
        resolved("[noise]\neffort = { knee = \"0.2 N*m\" }\neffort_final = { pull = \"10 mN\" }\n", "hwasp").unwrap();
    let again = Layers::from_text("again.toml", &experiment.to_toml().unwrap()).unwrap();
    assert_eq!(resolve(again, None, &catalogue()).unwrap(), experiment);

    for (more, what, hint) in [
        (
            "effort = \"3 N\"",
            "noise.effort = \"3 N\" is one quantity for efforts that measure different things",
            "write it like { knee = \"0.5 N·m\", pull = \"3 N\" }",
        ),
        ("effort = [\"3 N\"]", "has 1 items, but the law has 2 efforts", "write it like"),
        ("effort = { knee = \"3 N\" }", "noise.effort.knee = \"3 N\" has a unit that measures something else", "N·m"),
        (
            "effort = { knea = \"3 N*m\" }",
            "noise.effort.knea is none of the law's efforts: `knee`, `pull`",
            "did you mean `knee`?",
        ),
        (
            "effort_final = \"3 N\"",
            "noise.effort_final = \"3 N\" is one quantity",
            "{ knee = \"0.005 N·m\", pull = \"0.03 N\" }",
        ),
        ("effort = { pull = \"0 N\" }", "noise.effort.pull = \"0 N\" is outside", ""),
    ] {
        let found = told(&format!("[noise]\n{more}\n"));
        assert!(found.contains(what) && found.contains(hint) && found.matches("error:").count() == 1, "{found}");
    }
    // Where efforts are not sampled the keys may be there for other methods, and have to be quantities.
    assert!(resolved("[noise]\neffort = { knee = \"0.5 N*m\", pull = \"3 N\" }\n", "minimal").is_ok());
    let found = resolved("[noise]\neffort = { knee = 3 }\n", "minimal").unwrap_err().to_string();
    assert!(found.contains("is not a quantity"), "{found}");
}

fn trained(more: &str, method: &str) -> (Assembly, Trained) {
    let assembly = Assembly::new(&resolved(more, method).unwrap()).unwrap();
    let trained = train(&assembly, &Serial, &mut (), &AtomicBool::new(false)).unwrap();
    (assembly, trained)
}

/// 40,000 steps: the shank goes from 0.7 m to where it is best, 0.4 m, by every method that moves it, with the others in the
/// graph, in the action, drawn as well, or searched for; and with a controller that sees all of it.
#[test]
fn the_shape_of_the_world_is_learned() {
    let ppo = "[design]\nlearning_rate_scale = 20\n[noise]\ndesign = 0.1\ndesign_final = 0.01\n";
    for (method, more) in [
        ("hwasp", ppo.to_owned()),
        ("minimal", ppo.to_owned()),
        ("episode", ppo.to_owned()),
        ("hwasp", format!("{ppo}[controller]\nsees_design = true\n")),
        (
            "cmaes",
            "[cmaes]\nseparable = true\nsigma = 0.2\n[search]\nepisodes = 2\n[controller]\nhidden = [4]\n".to_owned(),
        ),
    ] {
        let (assembly, trained) = trained(&more, method);
        let shank = assembly.policy.design(&trained.params)[1];
        println!("{method}: {shank} m, {:?}", trained.evaluation.discounted_return);
        assert!((shank - BEST).abs() < 0.05, "{method}: {shank} m");
        assert!(trained.evaluation.discounted_return.mean > -1.5, "{method}: {:?}", trained.evaluation);
    }
}
