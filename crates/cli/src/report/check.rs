//! A sound experiment as text: what is in it, and what a trial of its world has shown.

use std::fmt::Write;

use hwasp_core::{Dimension, EnvFault, EnvSpec, MADE_FROM, Policy, Port};
use hwasp_experiment::Experiment;
use hwasp_problem::{Role, Words};
use hwasp_runs::text::{ReadableUnit, grouped};
use hwasp_training::{AT_ONCE, Assembly, Trial};

/// The most ports that are told.
const MOST_PORTS: usize = 12;
/// Columns before what a line says.
const INDENT: usize = 14;

/// What is in an experiment, how its training is parted, and what was measured.
pub(crate) fn experiment(spec: &Experiment, assembly: &Assembly, trial: &Trial) -> String {
    let policy = &assembly.policy;
    let design = policy.space().names().len();
    let drawn = match policy.drawn_actions() {
        0 => String::new(),
        drawn if drawn == design => ", drawn once an episode".to_owned(),
        drawn => format!(", {drawn} of them drawn once an episode"),
    };
    let mut text = format!(
        "{} ({}) is sound\n  problem     {}, {design} design parameter{}{drawn}\n  policy      {} parameters; {} {}\n  \
         training    {} steps: {}\n",
        spec.name,
        spec.method.name(),
        spec.task.name(),
        if design == 1 { "" } else { "s" },
        policy.param_count(),
        if assembly.generation().is_some() { "it gives" } else { "training varies" },
        varied(policy.action_names(), &assembly.worlds.training.env, &policy.space().names()),
        grouped(spec.train.env_steps),
        training(assembly, trial),
    );
    world(&mut text, &assembly.worlds.training.env, &spec.task.built().words, assembly);
    tried(&mut text, assembly, trial);
    text
}

/// What the controller sees and gives, what is designed and what is rewarded.
fn world(text: &mut String, env: &EnvSpec, words: &Words, assembly: &Assembly) {
    let named = |port: &Port| with_unit(&port.name, port.dimension.si());
    line(text, "observed", &format!("{}: {}", env.observation.len(), listed(&together(&env.observation))));
    let command = |port: &hwasp_core::CommandPort| {
        let unit = port.dimension.si();
        format!("{} {} to {} {unit}", port.name, short(port.lo), short(port.hi)).trim_end().to_owned()
    };
    let commands: Vec<String> = env.command.iter().map(command).collect();
    line(text, "commands", &listed(&commands));
    if !env.effort.is_empty() {
        line(text, "efforts", &listed(&env.effort.iter().map(named).collect::<Vec<_>>()));
    }
    let law = &assembly.worlds.training.law;
    let first = assembly.policy.design(&assembly.init());
    let mut at = 0;
    for group in law.design().groups() {
        let unit = readable(group.dimension, group.lo, group.hi);
        let many = if group.count == 1 { String::new() } else { format!("{} times ", group.count) };
        let begins =
            if group.count == 1 { format!(", begins at {}", unit.with_unit(first[at])) } else { String::new() };
        at += group.count;
        let does = words.meaning(Role::Design, &group.name).map_or(String::new(), |does| format!("; {does}"));
        let limits = format!("{} to {}", unit.short(group.lo), unit.with_unit(group.hi));
        line(text, "design", &format!("{}: {many}{limits}{begins}{does}", group.name));
    }
    for (_, name, formula) in words.ports.iter().filter(|(role, ..)| *role == Role::Reward) {
        line(text, "reward", &format!("{name} = {formula}"));
    }
    for (_, name, formula) in words.ports.iter().filter(|(role, ..)| *role == Role::End) {
        let named = if name.is_empty() { String::new() } else { format!("{name}: ") };
        line(text, "ends", &format!("{named}{formula}"));
    }
}

/// A line with a title; further lines of one title leave it out.
fn line(text: &mut String, title: &str, says: &str) {
    let known = format!("\n  {title:<10}  ");
    let shown = if text.contains(&known) { "" } else { title };
    let _ = writeln!(text, "  {shown:<10}  {says}");
}

/// What was measured, and what went wrong.
fn tried(text: &mut String, assembly: &Assembly, trial: &Trial) {
    let mut times = trial.step_s.map_or(String::new(), |step| format!("a step takes {:.1} µs", 1e6 * step));
    if let Some(remake) = trial.remake_s {
        let _ = write!(times, ", another design {:.2} ms more at the start of an episode", 1e3 * remake);
    }
    line(text, "time", &format!("{times} (measured now, with one thread)"));
    let ended = match trial.ended {
        0 => format!("none of {} ended before step {}", trial.episodes, trial.most_steps),
        ended => {
            let named: Vec<String> = trial.ended_by.iter().map(|(name, count)| format!("{name} {count}")).collect();
            let by = if named.is_empty() { String::new() } else { format!(" ({})", named.join(", ")) };
            format!("{ended} of {} ended{by}, after {:.1} steps in the mean", trial.episodes, trial.mean_steps())
        }
    };
    line(text, "tried", &format!("episodes with random commands and designs: {ended}"));
    let mut warn = |what: String| {
        let _ = writeln!(text, "  warning     {}", what.replace('\n', &format!("\n{:INDENT$}", "")));
    };
    if let (failed @ 1.., Some(first)) = &trial.failed {
        warn(format!(
            "the physics of {failed} of these episodes failed, first at {first}\ntraining throws such episodes away; a smaller \
             time step, narrower limits or weaker motors help"
        ));
    } else if let Some(EnvFault::Faulted { step, why }) = &trial.broken {
        warn(format!("physics fail with random commands and designs, at step {step}: {why}"));
    }
    if matches!(&trial.broken, Some(EnvFault::Differs { cause, .. }) if *cause == MADE_FROM) {
        warn(
            "start, observation or reward follow design parameters that shape no model: a gradient through the law does not see \
             that\ndraw those once an episode (design.placements, or --method episode) to have it count"
                .to_owned(),
        );
    }
    let built = assembly.experiment().task.built();
    if trial.is_over_at_once() {
        warn(over_at_once(trial));
    }
    for doubt in built.mechanism.iter().flat_map(|mechanism| mechanism.doubts()) {
        warn(doubt);
    }
    if trial.fixed_start {
        warn("every episode starts alike: a controller may learn the one start by heart".to_owned());
    }
    let (train, policy) = (&assembly.experiment().train, &assembly.policy);
    let gradient = assembly.generation().is_none();
    if gradient
        && policy.drawn_actions() > 0
        && train.episodes_per_iteration == 1
        && train.rows() <= train.episode_steps
    {
        warn(
            "one episode an iteration teaches the design nothing: a design that is drawn once an episode is worth more or less \
             than those of the other episodes\ntake more of them: train.episodes_per_iteration"
                .to_owned(),
        );
    }
    if gradient && let Some(lane) = train.short_lanes() {
        warn(format!(
            "a lane takes {lane} steps an iteration, and an episode may have {}: what comes after step {lane} of an episode is \
             never seen\ntake fewer lanes (train.episodes_per_iteration) or more steps (train.steps_per_iteration), unless \
             episodes end before",
            train.episode_steps
        ));
    }
}

/// Of episodes that end as they begin.
fn over_at_once(trial: &Trial) -> String {
    let names: Vec<&str> = trial.ended_by.keys().map(String::as_str).collect();
    let cause = if names.is_empty() { String::new() } else { format!(", by {}", names.join(", ")) };
    let count = trial.at_once;
    format!(
        "{count} of {} episodes ended within {AT_ONCE} steps{cause}\nnothing is learned of what is over as it begins: see whether \
         that holds at the start already (task.start), and what its numbers measure",
        trial.episodes
    )
}

/// The parts of a training.
fn training(assembly: &Assembly, trial: &Trial) -> String {
    let main = stage(&assembly.main_stage(), trial);
    if !assembly.polishes() {
        return main;
    }
    format!("{main}, then {} steps to polish the controller", grouped(assembly.polish_steps()))
}

/// The parts of its main stage.
fn stage(assembly: &Assembly, trial: &Trial) -> String {
    let spec = assembly.experiment();
    if let Some((popsize, each)) = assembly.generation() {
        let generations = spec.train.env_steps / (popsize as u64 * each);
        return format!(
            "about {} generations of {popsize} candidates of {} steps",
            grouped(generations),
            grouped(each)
        );
    }
    let (train, (iterations, last)) = (&spec.train, assembly.iterations());
    let (lanes, episode) = (train.episodes_per_iteration, train.episode_steps);
    let episodes = if lanes == 1 { "episode" } else { "episodes" };
    if train.steps_per_iteration == 0 {
        // Episodes that end early leave steps for more iterations.
        if trial.ended > 0 {
            return format!(
                "at least {} iterations of {lanes} {episodes} of at most {episode} steps",
                grouped(iterations)
            );
        }
        let last = if last == lanes as u64 { String::new() } else { format!(", the last of {last}") };
        return format!("{} iterations of {lanes} {episodes} of {episode} steps{last}", grouped(iterations));
    }
    let usual = train.steps_per_iteration as u64;
    let last = if last == usual { String::new() } else { format!(", the last of {}", grouped(last)) };
    format!("{} iterations of {} steps in {lanes} lanes{last}", grouped(iterations), grouped(usual))
}

/// The unit in which limits read well.
fn readable(dimension: Dimension, lo: f64, hi: f64) -> ReadableUnit {
    let unit = hwasp_core::unit(dimension.si()).map(|unit| unit.readable(lo.abs().max(hi.abs())));
    unit.map_or(ReadableUnit { unit: String::new(), to_si: 1.0 }, |u| ReadableUnit {
        unit: u.symbol.into(),
        to_si: u.to_si,
    })
}

fn short(value: f64) -> String {
    ReadableUnit { unit: String::new(), to_si: 1.0 }.short(value)
}

/// Ports with their units; the components of one vector, `name [0]` and so on, are told together.
fn together(ports: &[Port]) -> Vec<String> {
    let mut told: Vec<(&str, &str, usize)> = Vec::new();
    for port in ports {
        let vector = port.name.strip_suffix(']').and_then(|name| name.rsplit_once('['));
        let stem = vector.map_or(port.name.as_str(), |(stem, _)| stem.trim_end());
        match told.last_mut() {
            Some((known, _, count)) if vector.is_some() && *known == stem => *count += 1,
            _ => told.push((stem, port.dimension.si(), 1)),
        }
    }
    let shown = |(stem, unit, count): (&str, &str, usize)| {
        let times = if count == 1 { String::new() } else { format!(" ({count} components)") };
        with_unit(&format!("{stem}{times}"), unit)
    };
    told.into_iter().map(shown).collect()
}

/// A name with what it is measured in.
fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} in {unit}") }
}

/// Ports, of many the first ones.
fn listed(ports: &[String]) -> String {
    let shown = ports.iter().take(MOST_PORTS).map(String::as_str).collect::<Vec<_>>().join(", ");
    if ports.len() > MOST_PORTS { format!("{shown}, and {} more", ports.len() - MOST_PORTS) } else { shown }
}

/// The components of an action by what they are: a command and an effort may be called alike.
fn varied(action: &[String], env: &EnvSpec, design: &[String]) -> String {
    let mut parts: [(&str, Vec<String>); 3] = [("design", vec![]), ("effort", vec![]), ("command", vec![])];
    for name in action {
        // In this order they stand in an action, so that what was a command is none of the others afterwards.
        let effort = env.effort.iter().any(|port| port.name == *name);
        let begun =
            |part: usize, parts: &[(&str, Vec<String>)]| parts[part..].iter().any(|(_, names)| !names.is_empty());
        let part = match () {
            () if design.contains(name) && !begun(1, &parts) => 0,
            () if effort && !begun(2, &parts) => 1,
            () => 2,
        };
        parts[part].1.push(name.clone());
    }
    let parts = parts.iter().filter(|(_, names)| !names.is_empty());
    parts.map(|(what, names)| format!("{} ({what})", shorten(names))).collect::<Vec<_>>().join("; ")
}

/// The first few of many names.
fn shorten(names: &[String]) -> String {
    const SHOWN: usize = 4;
    let shown = names.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN { format!("{shown}, … ({} in all)", names.len()) } else { shown }
}
