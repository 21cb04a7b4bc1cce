//! Commands, efforts and the law between them.

use hwasp_core::{DesignSpace, Dimension, Law, Ports};
use hwasp_expr::{Part, Quantity};
use hwasp_settings::text::shorten;
use hwasp_settings::{listed, nearest};

use super::{Compiler, MOST_OBSERVED};
use crate::anatomy::Anatomy;
use crate::columns::Column;
use crate::names::{InPlace, Names, Place};
use crate::robot::Target;

impl Compiler<'_, '_> {
    /// What the law acts on, by name.
    pub(super) fn targets(&mut self) -> Vec<(String, Target, Dimension)> {
        let mut targets = Vec::new();
        for (name, _) in &self.settings.law {
            match target(&self.names.anatomy, name) {
                Ok((target, dimension)) => {
                    let quantity =
                        if dimension == Dimension::None { Quantity::Unknown } else { Quantity::of(dimension) };
                    self.names.efforts.push((name.clone(), quantity));
                    targets.push((name.clone(), target, dimension));
                }
                Err((message, hint)) => {
                    self.names.faulty.ports = true;
                    self.refuse(&["law", name], message, Some(hint));
                }
            }
        }
        targets
    }

    /// What the controller commands: the actuators that it drives as they are, and commands that the law takes.
    pub(super) fn commands(&mut self, targets: &[(String, Target, Dimension)]) -> Vec<Option<usize>> {
        let settings = self.settings;
        let actuators: Vec<_> = self.names.anatomy.actuators.iter().map(|actuator| actuator.name.clone()).collect();
        let declared: Vec<&str> = settings.commands.iter().map(|command| command.name.as_str()).collect();
        let free = declared.iter().filter(|name| !actuators.iter().any(|actuator| actuator == *name));
        let candidates: Vec<String> = actuators.iter().cloned().chain(free.map(|name| (*name).to_owned())).collect();
        let quantity = |name: &str| {
            let found = settings.commands.iter().find(|command| command.name == name);
            found.and_then(|command| command.limits.exponents()).map_or(Quantity::Unknown, Quantity::Known)
        };
        let read = self.read_by_law(&candidates);
        let mut direct = Vec::new();
        for name in candidates {
            let actuator = actuators.iter().position(|known| *known == name);
            let taken = actuator.is_some_and(|i| targets.iter().any(|(_, target, _)| *target == Target::Actuator(i)));
            let by_law = read.contains(&name);
            if taken && !by_law && !declared.contains(&name.as_str()) {
                continue;
            }
            direct.push(actuator.filter(|_| !taken && !by_law));
            self.names.commands.push((name.clone(), quantity(&name)));
            let limited = actuator.is_some_and(|i| self.names.anatomy.actuators[i].limits.is_some());
            if !limited && !declared.contains(&name.as_str()) {
                let hint = format!("write commands = {{ \"{name}\" = {{ limits = [-1, 1] }} }}");
                self.refuse(&["commands"], format!("nobody limits the command `{name}`"), Some(hint));
            }
        }
        if self.names.commands.is_empty() {
            self.names.faulty.ports = true;
            let message = "nothing is commanded: the model has no actuator, and [task.commands] names none".to_owned();
            let single = self.names.anatomy.joints.iter().any(|joint| joint.dof.len() == 1);
            let hint = if single {
                "add motors = { JOINT = { limits = [-1, 1] } }"
            } else {
                "motors are added to hinges and slides, of which the model has none: add actuators to its file, on sites or balls"
            };
            self.refuse(&["commands"], message, Some(hint.into()));
        }
        direct
    }

    /// The commands that the law reads, of all that there could be.
    pub(super) fn read_by_law(&mut self, candidates: &[String]) -> Vec<String> {
        let names = Names {
            anatomy: self.names.anatomy.clone(),
            columns: self.names.columns.clone(),
            faulty: self.names.faulty.clone(),
            commands: candidates.iter().map(|name| (name.clone(), Quantity::Unknown)).collect(),
            efforts: self.names.efforts.clone(),
            own: self.names.own.clone(),
            functions: self.names.functions.clone(),
            memory: Vec::new(),
            time_step: self.names.time_step,
        };
        let names = std::mem::replace(&mut self.names, names);
        let kept = (names, self.formulas.clone(), self.sound, self.defined.clone());
        self.definitions(false);
        let mut read = Vec::new();
        for (_, text) in &self.settings.law {
            let mut scope = InPlace { names: &mut self.names, place: Place::Law, width: 1 };
            let Ok(value) = self.formulas.read(text, &mut scope) else { continue };
            let (columns, _) = self.formulas.inputs(&value.parts);
            read.extend(columns.into_iter().filter_map(|at| match self.names.columns.all()[at] {
                Column::Command(i) => Some(candidates[i].clone()),
                _ => None,
            }));
        }
        (self.names, self.formulas, self.sound, self.defined) = kept;
        read
    }

    /// The efforts of the law.
    pub(super) fn law(&mut self) -> Vec<Part> {
        let settings = self.settings;
        let mut parts = Vec::new();
        for (name, text) in &settings.law {
            let Some((part, quantity)) = self.scalar(&["law", name], text, Place::Law) else { continue };
            let effort = self.names.efforts.iter().find(|(effort, _)| effort == name);
            let wanted = effort.map_or(Quantity::Unknown, |(_, quantity)| *quantity);
            if let (Quantity::Known(a), Quantity::Known(b)) = (quantity, wanted)
                && !a.fits(b)
            {
                let message = format!("the effort is in {a}, and {name} takes {b}");
                self.refuse(&["law", name], message, Some("see the units of the parameters and commands in it".into()));
                continue;
            }
            parts.push(part);
        }
        parts
    }

    /// The law with its ports; its states are what it reads beside commands and design.
    pub(super) fn traced_law(&mut self, space: &DesignSpace, parts: &[Part]) -> Option<(Law, Vec<usize>)> {
        let (read, _) = self.formulas.inputs(parts);
        let all = self.names.columns.all();
        let states: Vec<usize> = read.into_iter().filter(|&at| !matches!(all[at], Column::Command(_))).collect();
        if states.len() > MOST_OBSERVED {
            self.refuse(&["law"], format!("the law reads {} values, more than {MOST_OBSERVED}", states.len()), None);
            return None;
        }
        let commands: Vec<(usize, String)> = self
            .names
            .commands
            .iter()
            .enumerate()
            .map(|(i, (name, _))| {
                let at = self.names.columns.all().iter().position(|&column| column == Column::Command(i));
                (at.unwrap_or(usize::MAX - i), name.clone())
            })
            .collect();
        let labels = self.names.columns.names();
        let columns: Vec<(usize, String)> =
            commands.iter().cloned().chain(states.iter().map(|&at| (at, labels[at].clone()))).collect();
        let outputs: Vec<(String, Part)> =
            self.names.efforts.iter().map(|(name, _)| name.clone()).zip(parts.iter().copied()).collect();
        let ports = Ports {
            command: commands.into_iter().map(|(_, name)| name).collect(),
            state: states.iter().map(|&at| labels[at].clone()).collect(),
            effort: outputs.iter().map(|(name, _)| name.clone()).collect(),
        };
        let program = self.formulas.program_over(&space.names(), &columns, outputs);
        match Law::from_program(program, space.clone(), ports) {
            Ok(law) => Some((law, states)),
            Err(error) => {
                self.refuse(&["law"], error.to_string(), None);
                None
            }
        }
    }
}

/// What a key of the law acts on, and what it takes; else what is wrong, and a way out. Elements are named, or counted as `#2`.
fn target(anatomy: &Anatomy, name: &str) -> Result<(Target, Dimension), (String, String)> {
    let (kind, element) = name.split_once('.').unwrap_or((name, ""));
    let names: Vec<&str> = match kind {
        "joint" => anatomy.joints.iter().map(|joint| joint.name.as_str()).collect(),
        "tendon" => anatomy.tendons.iter().map(String::as_str).collect(),
        "actuator" => anatomy.actuators.iter().map(|actuator| actuator.name.as_str()).collect(),
        _ => {
            let message = format!("`{}` is nothing that a law acts on", shorten(name, 60));
            return Err((message, "write \"joint.NAME\", \"tendon.NAME\" or \"actuator.NAME\"".to_owned()));
        }
    };
    // Names in quotes, as formulas have them.
    let element = element.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(element);
    let found = match element.strip_prefix('#').and_then(|number| number.parse().ok()) {
        Some(number) => (number < names.len()).then_some(number),
        None => names.iter().position(|known| *known == element && !element.is_empty()),
    };
    // A ball or a free joint takes several efforts.
    let single = |at: &usize| kind != "joint" || anatomy.joints[*at].dof.len() == 1;
    let Some(at) = found.filter(single) else {
        let known = || (0..names.len()).filter(single).map(|at| names[at]).filter(|name| !name.is_empty());
        let hint = match nearest(element, known()) {
            _ if found.is_some() => "a law acts on hinges and slides".to_owned(),
            Some(near) => format!("did you mean `{kind}.{near}`?"),
            None if known().next().is_none() => format!("the model has no {kind} that a law could act on"),
            None => format!("known here: {}", listed(known())),
        };
        let message = match found {
            Some(_) => format!("`{}` is a ball or free joint", shorten(name, 60)),
            None => format!("the model has no {kind} `{}`", shorten(element, 60)),
        };
        return Err((message, hint));
    };
    Ok(match kind {
        "joint" => (Target::Joint(anatomy.joints[at].dof.start), anatomy.joints[at].effort()),
        "tendon" => (Target::Tendon(at), Dimension::Force),
        _ => (Target::Actuator(at), Dimension::None),
    })
}
