//! The values that formulas read, each a column of their programs.

use std::collections::HashMap;

use hwasp_core::Dimension;
use hwasp_expr::{Distribution, Quantity};

/// A number that the engine knows, by indices of the compiled model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Reading {
    /// Positions, velocities, accelerations, by their addresses.
    Position(usize),
    Velocity(usize),
    Acceleration(usize),
    /// Force of the actuators on a degree of freedom.
    ActuatorForceOn(usize),
    /// Force of contacts, limits and the like on a degree of freedom.
    ConstraintForceOn(usize),
    /// Of a body: place, orientation, velocity, angular velocity, centre of mass, forces from outside (3 torques, 3 forces).
    BodyPosition(usize, usize),
    BodyOrientation(usize, usize),
    BodyVelocity(usize, usize),
    BodyAngularVelocity(usize, usize),
    BodyCentre(usize, usize),
    BodyForce(usize, usize),
    GeomPosition(usize, usize),
    GeomOrientation(usize, usize),
    SitePosition(usize, usize),
    SiteOrientation(usize, usize),
    TendonLength(usize),
    TendonVelocity(usize),
    ActuatorForce(usize),
    ActuatorLength(usize),
    ActuatorVelocity(usize),
    Activation(usize),
    Control(usize),
    Sensor(usize),
    /// Whether two geoms touch, and the force between them along the normal.
    Touch(usize, usize),
    TouchForce(usize, usize),
    /// Whether a geom touches anything.
    TouchAny(usize),
    /// Centre of mass of everything that moves, and its velocity.
    Centre(usize),
    CentreVelocity(usize),
    Kinetic,
    Potential,
}

impl Reading {
    /// Whether the engine derives it of the state, so that it may be of the step before.
    pub(crate) fn is_derived(self) -> bool {
        !matches!(self, Self::Position(_) | Self::Velocity(_) | Self::Activation(_) | Self::Control(_))
    }
}

/// When something is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Stage {
    /// Quantities of an episode.
    Random,
    /// Where it starts.
    Start,
    /// After every step.
    Step,
    /// Before every step.
    Force,
}

/// A value that formulas read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Column {
    Engine(Reading),
    Command(usize),
    Effort(usize),
    /// A value at the end of the step before.
    Memory(usize),
    /// A quantity of the episode.
    Random(usize),
    /// A random number.
    Draw(Stage, usize),
    /// s since the start of the episode.
    Time,
    /// Steps since the start.
    Count,
    /// How much of training is done, 0 to 1.
    Progress,
}

/// The columns that formulas have asked for, in order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Columns {
    all: Vec<Column>,
    at: HashMap<Column, usize>,
    names: Vec<String>,
    /// What each measures, where it is known.
    dimensions: Vec<Dimension>,
    /// How each draw is drawn, by stage and number.
    draws: HashMap<Stage, Vec<Distribution>>,
}

impl Columns {
    /// The place of a column, which is called `name`.
    pub(crate) fn place(&mut self, column: Column, name: impl FnOnce() -> String) -> usize {
        if let Some(&at) = self.at.get(&column) {
            return at;
        }
        let at = self.all.len();
        self.all.push(column);
        self.at.insert(column, at);
        self.names.push(name());
        at
    }

    /// Notes what a column measures, where that is known.
    pub(crate) fn measures(&mut self, at: usize, quantity: Quantity) {
        self.dimensions.resize(self.all.len(), Dimension::None);
        if let Some(dimension) = quantity.dimension() {
            self.dimensions[at] = dimension;
        }
    }

    /// What a column measures, as far as it is known.
    pub(crate) fn dimension(&self, at: usize) -> Dimension {
        self.dimensions.get(at).copied().unwrap_or(Dimension::None)
    }

    /// A place for a new random number.
    pub(crate) fn draw(&mut self, stage: Stage, from: Distribution) -> usize {
        let draws = self.draws.entry(stage).or_default();
        draws.push(from);
        let number = draws.len() - 1;
        self.place(Column::Draw(stage, number), || format!("draw {number} of {stage:?}"))
    }

    pub(crate) fn all(&self) -> &[Column] {
        &self.all
    }

    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// The draws of a stage: how, and into which column.
    pub(crate) fn draws_of(&self, stage: Stage) -> Vec<(Distribution, usize)> {
        let draws = self.draws.get(&stage).map_or(&[][..], Vec::as_slice);
        draws.iter().enumerate().map(|(i, &from)| (from, self.at[&Column::Draw(stage, i)])).collect()
    }
}
