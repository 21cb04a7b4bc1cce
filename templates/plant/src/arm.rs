//! The plant: physics without purpose. A lamp at the end of a light arm, θ from upright.

use hwasp_core::{Form, Plant, Sight, Solid};

/// Mass of the lamp, kg.
const MASS: f64 = 0.6;
/// Length of the arm, m.
const LENGTH: f64 = 0.4;
/// Friction of the pivot, N·m·s/rad.
const FRICTION: f64 = 0.1;
/// The arm meets its stops here, rad from upright.
const STOP: f64 = 1.5;
/// What gravity does to the arm when it is level, m·g·l, N·m.
pub(crate) const GRAVITY_MOMENT: f64 = MASS * 9.81 * LENGTH;
/// Step of the integration, s.
const STEP: f64 = 0.005;
/// Steps of the integration in one of the controller. The law's torque is held meanwhile.
const STEPS: usize = 4;
/// Height of the pivot, m.
pub(crate) const PIVOT: f64 = 0.15;
/// Step of the controller, s.
pub(crate) const TIME_STEP: f64 = STEPS as f64 * STEP;

/// The arm, at first upright and at rest.
#[derive(Clone, Debug, Default)]
pub(crate) struct Arm {
    angle: f64,
    speed: f64,
}

impl Arm {
    /// Puts it at rest at `angle`, rad.
    pub(crate) fn place(&mut self, angle: f64) {
        (self.angle, self.speed) = (angle, 0.0);
    }

    /// The angle, rad from upright.
    pub(crate) fn angle(&self) -> f64 {
        self.angle
    }

    /// How it looks in films: lamp and arm on a foot, m, in red, green and blue.
    pub(crate) fn sight(&self) -> Sight {
        let (sin, cos) = self.angle.sin_cos();
        let [pivot, lamp] = [0.0, LENGTH].map(|length| [length * sin, 0.0, PIVOT + length * cos]);
        let foot = Form::Cylinder { radius: 0.03, half_length: 0.5 * PIVOT };
        Sight {
            solids: vec![
                Solid::new(foot, [0.0, 0.05, 0.5 * PIVOT], [196, 200, 206]).fixed(),
                Solid::rod([pivot, lamp], 0.012, [0, 114, 178]),
                Solid::new(Form::Ellipsoid([0.05; 3]), lamp, [240, 178, 122]),
            ],
            ..Sight::default()
        }
    }
}

impl Plant for Arm {
    /// `effort` is what the law says: the torque on the arm, N·m.
    fn advance(&mut self, effort: &[f64], _command: &[f64]) {
        for _ in 0..STEPS {
            let torque = effort[0] + GRAVITY_MOMENT * self.angle.sin() - FRICTION * self.speed;
            self.speed += torque / (MASS * LENGTH * LENGTH) * STEP;
            self.angle += self.speed * STEP;
            if self.angle.abs() > STOP {
                (self.angle, self.speed) = (self.angle.clamp(-STOP, STOP), 0.0);
            }
        }
    }

    /// What the law may read: angle, rad, and speed, rad/s.
    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&[self.angle, self.speed]);
    }
}
