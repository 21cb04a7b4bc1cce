//! Invariants that every environment keeps, in one suite (after Gymnasium's `env_checker` and `dm_control`'s suite tests).

mod fault;

use rand::RngExt;

use crate::environment::{End, EnvSpec, Environment, MakeEnvironment};
use crate::law::Law;
use crate::streams::{Purpose, stream};

pub use fault::EnvFault;

/// The most steps that a comparison of episodes takes: long enough to reach the limits of a plant.
const STEPS: usize = 200;
/// How many random starts are compared.
const STARTS: u64 = 8;
/// The cause of an [`EnvFault::Differs`] where a world depends on more of the design than [`EnvSpec::shaped_by`] says.
pub const MADE_FROM: &str =
    "both worlds are made from the same design, as far as `shaped_by` says what they are made from";

/// Drives environments from `make` with random commands through `law`, and returns the first broken promise. Every episode
/// has a design of its own: each parameter is drawn evenly between its limits, wherever the law's design begins.
///
/// Promised are sane names, limits, horizon and time step, the law's ports; finite observations, states and rewards of the
/// declared lengths; starts that depend on design, random stream and nothing else (with `fixed_start` not on the stream);
/// the same bits for the same commands; a world that depends on no more of the design than it says; limits on commands; an end by [`Truncated`](End::Truncated) exactly at the horizon,
/// also at another one; nothing left of an episode after a reset, nothing shared between two environments.
pub fn check_env(make: &dyn MakeEnvironment, law: &Law, fixed_start: bool) -> Result<(), EnvFault> {
    let spec = make.make(None).spec().clone();
    check_spec(&spec)?;
    let reads = check_ports(&spec, law)?;
    check_shapes(&spec, law)?;
    let check = Check { make, law, reads, spec };
    check.starts(fixed_start)?;
    check.repeats()?;
    check.shapes()?;
    check.limits()?;
    for horizon in [None, Some(1), Some(7)] {
        check.end(horizon)?;
    }
    Ok(())
}

fn check_spec(spec: &EnvSpec) -> Result<(), EnvFault> {
    for (kind, names) in port_names(spec) {
        if names.is_empty() && kind != "effort" && kind != "state" {
            return Err(EnvFault::NoPort { kind });
        }
        for (index, name) in names.iter().enumerate() {
            if name.trim().is_empty() {
                return Err(EnvFault::Unnamed { kind, index });
            }
            if names[..index].contains(name) {
                return Err(EnvFault::Twice { kind, name: name.clone() });
            }
        }
    }
    for port in &spec.command {
        if !(port.lo.is_finite() && port.hi.is_finite() && port.lo < port.hi) {
            return Err(EnvFault::Limits { name: port.name.clone(), lo: port.lo, hi: port.hi });
        }
    }
    if spec.horizon == 0 {
        return Err(EnvFault::Horizon);
    }
    let time_step = spec.time_step;
    if time_step.is_finite() && time_step > 0.0 { Ok(()) } else { Err(EnvFault::TimeStep { time_step }) }
}

fn port_names(spec: &EnvSpec) -> [(&'static str, Vec<String>); 4] {
    let of = |ports: &[crate::Port]| ports.iter().map(|p| p.name.clone()).collect();
    [
        ("observation", of(&spec.observation)),
        ("state", of(&spec.state)),
        ("effort", of(&spec.effort)),
        ("command", spec.command.iter().map(|p| p.name.clone()).collect()),
    ]
}

/// Where the law's commands are among the environment's, which may have others.
fn check_ports(spec: &EnvSpec, law: &Law) -> Result<Vec<usize>, EnvFault> {
    let ports = law.ports();
    let reads = law.reads(&spec.command);
    for (kind, environment) in port_names(spec) {
        let law = match kind {
            "state" => &ports.state,
            "effort" => &ports.effort,
            "command" => &ports.command,
            _ => continue,
        };
        if *law != environment && (kind != "command" || reads.is_none()) {
            return Err(EnvFault::Ports { kind, law: law.clone(), environment });
        }
    }
    let reads = reads.unwrap_or_default();
    match spec.command.iter().enumerate().find(|(c, port)| !port.direct && !reads.contains(c)) {
        Some((_, port)) => Err(EnvFault::Unread { name: port.name.clone() }),
        None => Ok(reads),
    }
}

/// The world's model can be made from what there is of the design alone.
fn check_shapes(spec: &EnvSpec, law: &Law) -> Result<(), EnvFault> {
    let groups: Vec<String> = law.design().groups().iter().map(|group| group.name.clone()).collect();
    match spec.shaped_by.iter().find(|name| !groups.contains(name)) {
        Some(name) => Err(EnvFault::Shaped { name: name.clone(), groups }),
        None => Ok(()),
    }
}

/// What can be seen of one moment; at the start the reward is 0 and the end is none.
#[derive(Clone, Debug)]
struct Snapshot {
    parts: [(&'static str, Vec<f64>); 5],
    end: Option<End>,
}

impl Snapshot {
    /// Looks at the environment; the lists are filled with NaN before, so that what is not written is found.
    fn take(env: &dyn Environment, step: usize, reward: f64, end: Option<End>) -> Result<Self, EnvFault> {
        let mut observation = vec![f64::NAN; env.spec().observation.len()];
        let mut state = vec![f64::NAN; env.spec().state.len()];
        let mut context = vec![f64::NAN; env.spec().context.len()];
        env.observe(&mut observation);
        env.state(&mut state);
        env.context(&mut context);
        let code = match end {
            None => 0.0,
            Some(End::Terminated) => 1.0,
            Some(End::Truncated) => 2.0,
            Some(End::Faulted) => 3.0,
        };
        let parts = [
            ("observation", observation),
            ("state", state),
            ("context", context),
            ("reward", vec![reward]),
            ("end", vec![code]),
        ];
        let snapshot = Self { parts, end };
        for (kind, values) in &snapshot.parts {
            if let Some(index) = values.iter().position(|v| !v.is_finite()) {
                return Err(EnvFault::NotFinite { kind, index, value: values[index], step });
            }
        }
        Ok(snapshot)
    }

    /// Bit by bit: -0 is not 0 here.
    fn check_same(&self, other: &Self, cause: &'static str, step: usize) -> Result<(), EnvFault> {
        for ((kind, first), (_, second)) in self.parts.iter().zip(&other.parts) {
            for (index, (&first, &second)) in first.iter().zip(second).enumerate() {
                if first.to_bits() != second.to_bits() {
                    return Err(EnvFault::Differs { cause, kind, index, first, second, step });
                }
            }
        }
        Ok(())
    }
}

/// What the checks that run episodes share.
struct Check<'a> {
    make: &'a dyn MakeEnvironment,
    law: &'a Law,
    /// Where the law's commands are among the environment's.
    reads: Vec<usize>,
    spec: EnvSpec,
}

impl Check<'_> {
    /// Resets to the start of this episode's stream, in the world of this design.
    fn reset(env: &mut dyn Environment, design: &[f64], episode: u64) -> Result<Snapshot, EnvFault> {
        env.set_design(design);
        env.reset(&mut stream(0, Purpose::Check, 0, episode));
        Snapshot::take(env, 0, 0.0, None)
    }

    /// A design and commands for this episode, each even between its limits.
    fn inputs(&self, episode: u64, steps: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
        let rng = &mut stream(0, Purpose::Check, 1, episode);
        let mut between = |lo: f64, hi: f64| lo + (hi - lo) * rng.random::<f64>();
        let space = self.law.design();
        let bounds = (0..space.len()).map(|i| space.bounds(i));
        let design = bounds.map(|(lo, hi)| between(lo, hi)).collect();
        let mut draw = || self.spec.command.iter().map(|p| between(p.lo, p.hi)).collect();
        (design, (0..steps).map(|_| draw()).collect())
    }

    /// One step through the law, which sees `command`; the environment gets `sent`.
    fn step(
        &self,
        env: &mut dyn Environment,
        design: &[f64],
        (command, sent): (&[f64], &[f64]),
        step: usize,
    ) -> Result<Snapshot, EnvFault> {
        let mut state = vec![0.0; self.spec.state.len()];
        let mut effort = vec![0.0; self.spec.effort.len()];
        env.state(&mut state);
        let read: Vec<f64> = self.reads.iter().map(|&c| command[c]).collect();
        self.law.effort(design, &read, &state, &mut effort);
        let result = env.step(&effort, sent);
        if result.end == Some(End::Faulted) {
            return Err(EnvFault::Faulted {
                step,
                why: env.fault().unwrap_or_else(|| "it does not say how".to_owned()),
            });
        }
        Snapshot::take(env, step, result.reward, result.end)
    }

    /// The episode of this number, up to its end or to [`STEPS`] steps.
    fn episode(&self, env: &mut dyn Environment, episode: u64) -> Result<Vec<Snapshot>, EnvFault> {
        let (design, commands) = self.inputs(episode, STEPS.min(env.spec().horizon));
        let mut snapshots = vec![Self::reset(env, &design, episode)?];
        for (i, command) in commands.iter().enumerate() {
            snapshots.push(self.step(env, &design, (command, command), i + 1)?);
            if snapshots[i + 1].end.is_some() {
                break;
            }
        }
        Ok(snapshots)
    }

    /// Starts follow the stream.
    fn starts(&self, fixed: bool) -> Result<(), EnvFault> {
        let mut env = self.make.make(None);
        let mut starts = Vec::new();
        let (design, _) = self.inputs(0, 0);
        for episode in 0..STARTS {
            starts.push(Self::reset(env.as_mut(), &design, episode)?);
            let again = Self::reset(env.as_mut(), &design, episode)?;
            starts[episode as usize].check_same(&again, "the same stream starts both", 0)?;
        }
        let first_of_its_kind = |i: &usize| starts[..*i].iter().all(|s| s.check_same(&starts[*i], "", 0).is_err());
        let distinct = (0..starts.len()).filter(first_of_its_kind).count();
        // Of random starts a few may coincide where there are only a few; all of them do not.
        if (distinct == 1) == fixed { Ok(()) } else { Err(EnvFault::Starts { distinct, streams: starts.len(), fixed }) }
    }

    /// An episode is the same in a fresh environment, after another episode, after a part of one, and beside another one.
    fn repeats(&self) -> Result<(), EnvFault> {
        let mut env = self.make.make(None);
        let wanted = self.episode(env.as_mut(), 0)?;
        let compare = |snapshots: &[Snapshot], cause| {
            wanted.iter().zip(snapshots).enumerate().try_for_each(|(i, (a, b))| a.check_same(b, cause, i))
        };
        let mut fresh = self.make.make(None);
        compare(&self.episode(fresh.as_mut(), 0)?, "both are the same episode in fresh environments")?;
        let cause = "a reset leaves nothing of the episode before";
        compare(&self.episode(env.as_mut(), 0)?, cause)?;
        if !self.spec.shaped_by.is_empty() {
            // The episode before was in the world of another design.
            let mut other = self.make.make(None);
            self.episode(other.as_mut(), 1)?;
            compare(&self.episode(other.as_mut(), 0)?, cause)?;
        }

        let (design, commands) = self.inputs(0, wanted.len() - 1);
        let (other_design, other_commands) = self.inputs(1, wanted.len() - 1);
        let mut beside = self.make.make(None);
        Self::reset(env.as_mut(), &design, 0)?;
        Self::reset(beside.as_mut(), &other_design, 1)?;
        let mut beside_runs = true;
        for (i, (command, other)) in commands.iter().zip(&other_commands).enumerate() {
            let snapshot = self.step(env.as_mut(), &design, (command, command), i + 1)?;
            wanted[i + 1].check_same(&snapshot, "another environment beside it changes nothing", i + 1)?;
            beside_runs =
                beside_runs && self.step(beside.as_mut(), &other_design, (other, other), i + 1)?.end.is_none();
        }
        Ok(())
    }

    /// Of the design, the world depends on what it says alone: the law is the same in both of these.
    fn shapes(&self) -> Result<(), EnvFault> {
        let (design, commands) = self.inputs(5, STEPS.min(self.spec.horizon));
        let (mut other, _) = self.inputs(6, 0);
        for (i, value) in other.iter_mut().enumerate() {
            if self.spec.shaped_by.contains(&self.law.design().group_of(i).name) {
                *value = design[i];
            }
        }
        let cause = MADE_FROM;
        let (mut one, mut two) = (self.make.make(None), self.make.make(None));
        Self::reset(one.as_mut(), &design, 5)?.check_same(&Self::reset(two.as_mut(), &other, 5)?, cause, 0)?;
        for (i, command) in commands.iter().enumerate() {
            let first = self.step(one.as_mut(), &design, (command, command), i + 1)?;
            let second = self.step(two.as_mut(), &design, (command, command), i + 1)?;
            first.check_same(&second, cause, i + 1)?;
            if first.end.is_some() {
                break;
            }
        }
        Ok(())
    }

    /// A command beyond its limits does what the limit does.
    fn limits(&self) -> Result<(), EnvFault> {
        let (mut at, mut beyond) = (self.make.make(None), self.make.make(None));
        let (design, commands) = self.inputs(2, STEPS.min(self.spec.horizon));
        Self::reset(at.as_mut(), &design, 2)?;
        Self::reset(beyond.as_mut(), &design, 2)?;
        for (i, command) in commands.iter().enumerate() {
            let (mut limit, mut sent) = (command.clone(), command.clone());
            for (c, port) in self.spec.command.iter().enumerate() {
                let upper = command[c] > 0.5 * (port.lo + port.hi);
                limit[c] = if upper { port.hi } else { port.lo };
                sent[c] = limit[c] + if upper { 1.0 } else { -1.0 } * (port.hi - port.lo);
            }
            let first = self.step(at.as_mut(), &design, (&limit, &limit), i + 1)?;
            let second = self.step(beyond.as_mut(), &design, (&limit, &sent), i + 1)?;
            first.check_same(&second, "one command is at its limit, the other beyond", i + 1)?;
            if first.end.is_some() {
                break;
            }
        }
        Ok(())
    }

    /// Truncation exactly at the horizon, twice in a row; termination at any time.
    fn end(&self, horizon: Option<usize>) -> Result<(), EnvFault> {
        let mut env = self.make.make(horizon);
        let found = env.spec().horizon;
        let asked = horizon.unwrap_or(self.spec.horizon);
        if found != asked {
            return Err(EnvFault::Override { asked, found });
        }
        for episode in [3, 4] {
            let (design, commands) = self.inputs(episode, found);
            Self::reset(env.as_mut(), &design, episode)?;
            for (i, command) in commands.iter().enumerate() {
                let end = self.step(env.as_mut(), &design, (command, command), i + 1)?.end;
                if end == Some(End::Terminated) {
                    break;
                }
                let expected = (i + 1 == found).then_some(End::Truncated);
                if end != expected {
                    return Err(EnvFault::End { horizon: found, step: i + 1, end, expected });
                }
            }
        }
        Ok(())
    }
}
