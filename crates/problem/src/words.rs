//! What a problem and its ports mean, in a few words for exports and reports.

/// What a name is of: a port on one side of controller and law, a parameter or a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// What the controller sees.
    Observation,
    /// What only the law reads.
    State,
    /// What the controller asks of the motors.
    Command,
    /// What the mechanism does to the world.
    Effort,
    /// A group of design parameters: what it does.
    Design,
    /// A term of the reward: how it is computed.
    Reward,
    /// A way in which an episode ends before its time: when it does. One that stands alone may have no name.
    End,
}

/// What a problem and its ports mean.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Words {
    /// Body, purpose, and what of the body is designed, in one to three sentences; empty where nobody has written them.
    pub about: String,
    /// Ports, design groups and terms of the reward by role and name, with their meaning. Units and limits stand beside them wherever they are shown.
    pub ports: Vec<(Role, String, String)>,
}

impl Words {
    /// Words with sentences about the problem.
    pub fn about(text: impl Into<String>) -> Self {
        Self { about: text.into(), ports: Vec::new() }
    }

    /// The same with the meaning of ports of one role.
    #[must_use]
    pub fn with(mut self, role: Role, ports: &[(&str, &str)]) -> Self {
        let ports = ports.iter().map(|&(name, meaning)| (role, name.to_owned(), meaning.to_owned()));
        self.ports.extend(ports);
        self
    }

    /// What a port means, where it is known.
    pub fn meaning(&self, role: Role, name: &str) -> Option<&str> {
        let found = self.ports.iter().find(|(of, port, _)| (*of, port.as_str()) == (role, name));
        found.map(|(_, _, meaning)| meaning.as_str())
    }
}
