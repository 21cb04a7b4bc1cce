//! The spool between motor and tendons, with friction.

use hwasp_grasp::yielding;

use super::HandWorldError;
use crate::world::SpoolDrive;

/// What is wrong with a built hand compared with its description: for [`HandWorld`](super::HandWorld), and for whoever has to
/// find it out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planted {
    /// The motor's torque per current, as a multiple of what the description says.
    pub torque_gain: f64,
    /// Stiffness of each tendon, N/m; that of the description where there is none.
    pub tendon_stiffness: Option<f64>,
    /// Friction of motor and spool, N·m: winding needs so much more torque, and holding so much less.
    pub friction: f64,
    /// Tendon that is wound before any is taut, m.
    pub slack: f64,
    /// From the motor's goal to the spool, s.
    pub delay: f64,
    /// Where the motor's encoder stands with nothing wound, rad.
    pub zero: f64,
}

impl Default for Planted {
    fn default() -> Self {
        Self { torque_gain: 1.0, tendon_stiffness: None, friction: 0.0, slack: 0.0, delay: 0.0, zero: 0.0 }
    }
}

/// What can be planted: names, limits and units. Beyond them nothing moves as a hand does.
const LIMITS: [(&str, [f64; 2], &str); 6] = [
    ("torque_gain", [0.01, 10.0], ""),
    ("tendon_stiffness", [100.0, 1e6], " N/m"),
    ("friction", [0.0, 0.5], " N·m"),
    ("slack", [0.0, 0.02], " m"),
    ("delay", [0.0, 0.5], " s"),
    ("zero", [-100.0, 100.0], " rad"),
];

impl Planted {
    /// What can be planted, for a person.
    pub(super) fn names() -> String {
        LIMITS.map(|(name, ..)| name).join(", ")
    }

    /// Plants a value by its name.
    ///
    /// # Errors
    /// Where nothing is called so, or the value is outside of its limits.
    pub fn plant(&mut self, name: &str, value: f64) -> Result<(), HandWorldError> {
        let field = match name {
            "torque_gain" => &mut self.torque_gain,
            "tendon_stiffness" => self.tendon_stiffness.insert(value),
            "friction" => &mut self.friction,
            "slack" => &mut self.slack,
            "delay" => &mut self.delay,
            "zero" => &mut self.zero,
            _ => return Err(HandWorldError::NotPlanted { name: name.to_owned() }),
        };
        *field = value;
        self.check()
    }

    pub(super) fn check(&self) -> Result<(), HandWorldError> {
        let Self { torque_gain, tendon_stiffness, friction, slack, delay, zero } = *self;
        let values = [Some(torque_gain), tendon_stiffness, Some(friction), Some(slack), Some(delay), Some(zero)];
        for ((name, [lo, hi], unit), value) in LIMITS.into_iter().zip(values) {
            if let Some(value) = value.filter(|value| !(lo..=hi).contains(value)) {
                return Err(HandWorldError::Planted { name, value, lo, hi, unit });
            }
        }
        Ok(())
    }
}

/// The spool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spool {
    /// Wound, m.
    pub(super) wound: f64,
    /// The motor's torque, N·m.
    pub(super) torque: f64,
    /// What all tendons pull together, N.
    pub(super) tension: f64,
}

/// What the spool turns in and against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tendons {
    /// What the digits have taken up of each, m.
    pub(super) taken_up: [f64; 3],
    /// N/m.
    pub(super) stiffness: f64,
    /// m.
    pub(super) radius: f64,
    /// N·m.
    pub(super) friction: f64,
}

impl Tendons {
    fn tension(&self, wound: f64) -> f64 {
        yielding(wound, self.taken_up, self.stiffness, f64::INFINITY).1
    }

    /// How much is wound where the tendons turn the spool with this torque, N·m.
    fn wound_at(&self, torque: f64) -> f64 {
        yielding(f64::INFINITY, self.taken_up, self.stiffness, torque.max(0.0) / self.radius).0
    }
}

impl Spool {
    /// Turns as far as the motor drives it (goal in m of tendon, torque in N·m) and the tendons let it.
    pub(super) fn turn(&mut self, drive: Option<(f64, f64)>, tendons: &Tendons) {
        let (friction, before) = (tendons.friction, self.wound);
        let (goal, most) = drive.unwrap_or((before, 0.0));
        let mut wound = before;
        if goal > before {
            // It winds until the motor's torque is used up by tendons and friction.
            wound = if most > friction { goal.min(tendons.wound_at(most - friction)).max(before) } else { before };
        } else if goal < before {
            // It pays out, with the tendons' help where the motor alone does not overcome the friction.
            let stuck = if most >= friction { f64::NEG_INFINITY } else { tendons.wound_at(friction - most) };
            wound = goal.max(stuck.min(before));
        }
        // It gives way where the tendons pull more than motor and friction hold.
        if tendons.radius * tendons.tension(wound) > most + friction {
            wound = tendons.wound_at(most + friction);
        }
        let tension = tendons.tension(wound);
        let pulled = tendons.radius * tension;
        let torque = if wound > before {
            pulled + friction
        } else if wound < before {
            pulled - friction
        } else if goal > wound {
            most
        } else {
            self.torque.clamp(pulled - friction, pulled + friction)
        };
        *self = Self { wound, torque: torque.clamp(-most, most), tension };
    }
}

impl From<SpoolDrive> for Option<(f64, f64)> {
    /// Goal, rad, and current, A.
    fn from(drive: SpoolDrive) -> Self {
        match drive {
            SpoolDrive::Free => None,
            SpoolDrive::Position { goal, current } => Some((goal, current)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS: f64 = 0.008;

    fn tendons(friction: f64) -> Tendons {
        Tendons { taken_up: [0.001, 0.002, 0.004], stiffness: 5000.0, radius: RADIUS, friction }
    }

    /// Without friction it is where the plant of training has it, wherever it was.
    #[test]
    fn without_friction_it_yields() {
        let tendons = tendons(0.0);
        for before in [0.0, 0.003, 0.02] {
            for goal in [0.0, 0.0015, 0.003, 0.01, 0.02] {
                let mut spool = Spool { wound: before, ..Spool::default() };
                spool.turn(Some((goal, RADIUS * 75.0)), &tendons);
                let (wound, tension) = yielding(goal, tendons.taken_up, 5000.0, 75.0);
                assert!((spool.wound - wound).abs() < 1e-15 && (spool.tension - tension).abs() < 1e-9, "{spool:?}");
                assert!((spool.torque - RADIUS * tension).abs() < 1e-12, "{spool:?}");
            }
        }
    }

    /// Winding reads more and unwinding less than the tendons pull, by the friction.
    #[test]
    fn friction_is_a_loop() {
        let tendons = tendons(0.05);
        let mut spool = Spool::default();
        let mut at = |goal: f64| {
            spool.turn(Some((goal, 0.6)), &tendons);
            (spool.wound, spool.torque - RADIUS * spool.tension)
        };
        let near = |(wound, extra): (f64, f64), wanted: (f64, f64)| {
            assert!(
                (wound - wanted.0).abs() < 1e-12 && (extra - wanted.1).abs() < 1e-12,
                "{wound} {extra}, {wanted:?}"
            );
        };
        near(at(0.006), (0.006, 0.05));
        near(at(0.006), (0.006, 0.05));
        near(at(0.0055), (0.0055, -0.05));
        near(at(0.0055), (0.0055, -0.05));
        // At the motor's limit it stands, and holds more than it can wind.
        let (wound, _) = at(0.03);
        let (held, extra) = at(0.03);
        assert!(wound == held && (extra - 0.05).abs() < 1e-12);
        assert!((RADIUS * tendons.tension(wound) - 0.55).abs() < 1e-12);
    }

    #[test]
    fn a_free_spool_unwinds_as_far_as_friction_lets_it() {
        for (friction, tension) in [(0.0, 0.0), (0.04, 5.0)] {
            let mut spool = Spool { wound: 0.01, ..Spool::default() };
            spool.turn(None, &tendons(friction));
            assert!((spool.tension - tension).abs() < 1e-9 && spool.torque == 0.0, "{spool:?}");
        }
    }
}
