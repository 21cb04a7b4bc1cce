//! The numbers of the mass-spring problem, and the check that they describe one.

use hwasp_core::{DesignError, Initial};
use thiserror::Error;

use super::reward::{Reward, Switch};

/// Every number of the mass-spring problem, SI. The default is the paper's (section 5, appendix A), and the authors'
/// published code where the paper is silent (marked †).
///
/// | field | symbol | default | case | must be |
/// |---|---|---|---|---|
/// | `count` | n | 10 (also 50) | both | ≥ 1 |
/// | `upper_mass`, `lower_mass` | m1, m2 | 0.1 kg | both | > 0 |
/// | `gravity` | g | 9.8 m/s² | both | ≥ 0 |
/// | `goal` | h | 0.2 m | both | ≥ 0 |
/// | `bar_length` | l | 0.1 m | stiffness | ≥ 0 |
/// | `max_total_stiffness` | n·max kᵢ | 100 N/m | stiffness | > 0 |
/// | `spring_stiffness` | K | 20 N/m † | bar | > 0 |
/// | `max_total_length` | n·max lᵢ | 0.5 m † | bar | > 0 |
/// | `torque_constant` | kT | 0.001 N·m/A | both | > 0 |
/// | `shaft_radius` | `r_shaft` | 0.001 m | both | > 0 |
/// | `max_current` | `i_max` | 5 A † | both | > 0 |
/// | `time_step` | dt | 0.002 s † | both | > 0 |
/// | `substeps` | | 5 † | both | ≥ 1 |
/// | `horizon` | | 1000 actions (10 s) | both | ≥ 1 |
/// | `max_position` | | 0.5 m † | both | > 0 |
/// | `max_speed` | | 2 m/s † | both | > 0 |
/// | `interface_stiffness` | `k_interf` | 200 N/m † | bar, soft | > 0 |
/// | `interface_damping` | `b_interf` | 10 N·s/m † | bar, soft | ≥ 0 |
/// | `effort_limit` | | none (authors: 5 N †) | force efforts | > 0 |
/// | `initial` | u | logit in ±5 † | both | |
/// | `stiffness_reward`, `bar_reward` | α, β, γ, ε, c | see [`Reward`] | one each | ≥ 0, c > 0 |
#[derive(Clone, Debug, PartialEq)]
pub struct MassSpringSettings {
    /// Number of springs or of bar segments, n: the design parameters.
    pub count: usize,
    /// Mass of the upper body, m1, kg.
    pub upper_mass: f64,
    /// Mass of the lower body, m2, kg.
    pub lower_mass: f64,
    /// Gravity, g, m/s².
    pub gravity: f64,
    /// Where the lower mass should come to rest, h, m below the ceiling.
    pub goal: f64,
    /// Length of the bar between the masses where the springs are optimised, l, m.
    pub bar_length: f64,
    /// The most that all springs together can have, N/m; one spring is in [0, this / n].
    pub max_total_stiffness: f64,
    /// Stiffness of the spring where the bar is optimised, K, N/m.
    pub spring_stiffness: f64,
    /// The longest that all segments together can be, m; one segment is in [0, this / n].
    pub max_total_length: f64,
    /// Torque constant of the motor, kT, N·m/A.
    pub torque_constant: f64,
    /// Radius of the shaft that winds the string, `r_shaft`, m.
    pub shaft_radius: f64,
    /// Largest motor current of either sign, `i_max`, A.
    pub max_current: f64,
    /// Simulation step, dt, s.
    pub time_step: f64,
    /// Simulation steps per action.
    pub substeps: usize,
    /// Actions per episode.
    pub horizon: usize,
    /// Positions are limited to [0, this], m.
    pub max_position: f64,
    /// Speeds are limited to ± this, m/s.
    pub max_speed: f64,
    /// Stiffness of the softened interface, `k_interf`, N/m.
    pub interface_stiffness: f64,
    /// Damping of the softened interface, `b_interf`, N·s/m.
    pub interface_damping: f64,
    /// Limits every force that a law hands to the plant to ± this, N. The authors' in-policy environments do this at
    /// 5 N (motor plus springs, and each interface force), their in-action ones do not, so that the two are different
    /// plants; here the limits are the motor's, and this is for running their published setting.
    pub effort_limit: Option<f64>,
    /// Where the design begins.
    pub initial: Initial,
    /// The reward where springs are optimised.
    pub stiffness_reward: Reward,
    /// The reward where the bar is optimised.
    pub bar_reward: Reward,
}

impl Default for MassSpringSettings {
    fn default() -> Self {
        Self {
            count: 10,
            upper_mass: 0.1,
            lower_mass: 0.1,
            gravity: 9.8,
            goal: 0.2,
            bar_length: 0.1,
            max_total_stiffness: 100.0,
            spring_stiffness: 20.0,
            max_total_length: 0.5,
            torque_constant: 0.001,
            shaft_radius: 0.001,
            max_current: 5.0,
            time_step: 0.002,
            substeps: 5,
            horizon: 1000,
            max_position: 0.5,
            max_speed: 2.0,
            interface_stiffness: 200.0,
            interface_damping: 10.0,
            effort_limit: None,
            initial: Initial::Logit { half_width: 5.0 },
            stiffness_reward: Reward::STIFFNESS,
            bar_reward: Reward::BAR,
        }
    }
}

/// Why settings do not describe a mass-spring problem.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MassSpringError {
    /// A quantity that has to be positive.
    #[error("{name} = {value} {unit} is not a positive finite number")]
    NotPositive {
        /// The field.
        name: &'static str,
        /// What was given, SI.
        value: f64,
        /// The SI unit.
        unit: &'static str,
    },
    /// A quantity that may be zero, but neither negative nor infinite.
    #[error("{name} = {value} {unit} is not a finite number of at least 0")]
    Negative {
        /// The field.
        name: &'static str,
        /// What was given, SI.
        value: f64,
        /// The SI unit.
        unit: &'static str,
    },
    /// A count that has to be at least one.
    #[error("{name} = 0, but at least 1 is needed")]
    Zero {
        /// The field.
        name: &'static str,
    },
    /// A start of the design that its limits do not allow.
    #[error(transparent)]
    Design(#[from] DesignError),
}

impl MassSpringSettings {
    /// The largest force of the motor, kT·i/`r_shaft` (paper, appendix A), N.
    pub fn motor_limit(&self) -> f64 {
        self.torque_constant * self.max_current / self.shaft_radius
    }

    /// What the softened interface gives way under the lower mass at rest, m2·g / (`k_interf`/2), m: 9.8 mm.
    pub fn interface_stretch(&self) -> f64 {
        self.lower_mass * self.gravity / (0.5 * self.interface_stiffness)
    }

    /// The total stiffness that holds the lower mass at the goal with the motor off: K* = (m1 + m2)·g / (h - l), N/m
    /// (paper, appendix A, quasi-static assumption): 19.6.
    pub fn optimal_stiffness(&self) -> f64 {
        (self.upper_mass + self.lower_mass) * self.gravity / (self.goal - self.bar_length)
    }

    /// The length of a rigid bar that holds the lower mass at the goal with the motor off: l* = h - (m1 + m2)·g / K, m
    /// (the same assumption): 0.102. A softened bar stretches, so that its own optimum is shorter by
    /// [`interface_stretch`](Self::interface_stretch).
    pub fn optimal_length(&self) -> f64 {
        self.goal - (self.upper_mass + self.lower_mass) * self.gravity / self.spring_stiffness
    }

    /// Refuses what is no problem at all; the first fault in the order of the fields.
    pub fn check(&self) -> Result<(), MassSpringError> {
        let counts = [("count", self.count), ("substeps", self.substeps), ("horizon", self.horizon)];
        if let Some(&(name, _)) = counts.iter().find(|(_, count)| *count == 0) {
            return Err(MassSpringError::Zero { name });
        }
        let positive = [
            ("upper_mass", self.upper_mass, "kg"),
            ("lower_mass", self.lower_mass, "kg"),
            ("max_total_stiffness", self.max_total_stiffness, "N/m"),
            ("spring_stiffness", self.spring_stiffness, "N/m"),
            ("max_total_length", self.max_total_length, "m"),
            ("torque_constant", self.torque_constant, "N·m/A"),
            ("shaft_radius", self.shaft_radius, "m"),
            ("max_current", self.max_current, "A"),
            ("time_step", self.time_step, "s"),
            ("max_position", self.max_position, "m"),
            ("max_speed", self.max_speed, "m/s"),
            ("interface_stiffness", self.interface_stiffness, "N/m"),
            ("effort_limit", self.effort_limit.unwrap_or(1.0), "N"),
            ("stiffness_reward.switch.sharpness", self.stiffness_reward.switch.sharpness().unwrap_or(1.0), ""),
            ("bar_reward.switch.sharpness", self.bar_reward.switch.sharpness().unwrap_or(1.0), ""),
        ];
        if let Some(&(name, value, unit)) = positive.iter().find(|(_, v, _)| !(v.is_finite() && *v > 0.0)) {
            return Err(MassSpringError::NotPositive { name, value, unit });
        }
        let not_negative = [
            ("gravity", self.gravity, "m/s²"),
            ("goal", self.goal, "m"),
            ("bar_length", self.bar_length, "m"),
            ("interface_damping", self.interface_damping, "N·s/m"),
            ("stiffness_reward.position", self.stiffness_reward.position, "1/m"),
            ("stiffness_reward.speed", self.stiffness_reward.speed, "s/m"),
            ("stiffness_reward.force", self.stiffness_reward.force, "1/N"),
            ("stiffness_reward.threshold", self.stiffness_reward.threshold, ""),
            ("bar_reward.position", self.bar_reward.position, "1/m"),
            ("bar_reward.speed", self.bar_reward.speed, "s/m"),
            ("bar_reward.force", self.bar_reward.force, "1/N"),
            ("bar_reward.threshold", self.bar_reward.threshold, ""),
        ];
        match not_negative.iter().find(|(_, v, _)| !(v.is_finite() && *v >= 0.0)) {
            Some(&(name, value, unit)) => Err(MassSpringError::Negative { name, value, unit }),
            None => Ok(()),
        }
    }

    /// The same with the paper's two-stage reward (appendix A, first equation) in place of the soft one.
    #[must_use]
    pub fn with_hard_reward(mut self) -> Self {
        self.stiffness_reward.switch = Switch::Hard;
        self.bar_reward.switch = Switch::Hard;
        self
    }
}
