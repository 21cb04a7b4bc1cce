//! What a bench is like where it differs from the paper's simulation: what is sensed, how late, and what the hand really does.

use hwasp_core::Dimension;
use hwasp_settings::{Fields, choice};

choice! {
    /// What the controller is told of the motor's travel.
    pub enum TravelSensed {
        /// The sum of what was commanded, as the paper's simulation has it.
        Commanded = "commanded",
        /// Where the spool is: it stands still while the motor's limit does not let it wind.
        Encoder = "encoder",
        /// Where the spool is, and as `motor_travel_target` also the sum of what was commanded: what both differ by tells that
        /// the motor is at its limit, whatever its torque reads.
        Both = "both",
    }
}

choice! {
    /// What the controller is told of where the object is.
    pub enum ObjectSensed {
        /// Where it is at every moment, as a camera would tell.
        Tracked = "tracked",
        /// Where it was at the start, and with the palm once the grasp is felt, as in the paper's laboratory.
        Carried = "carried",
        /// Where it was at the start.
        Fixed = "fixed",
    }
}

/// Each span is drawn from once an episode; where both its ends are the same, nothing varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Bench {
    /// What `motor_travel` tells, and whether there is a `motor_travel_target`.
    pub travel_sensed: TravelSensed,
    /// What `object_x`, `object_y` and `object_z` tell.
    pub object_sensed: ObjectSensed,
    /// The reading of the motor's torque from which on a carried object counts as held, N·m.
    pub grasp_felt: f64,
    /// How fast the palm may be, m/s; none where the commands' limits are all there is.
    pub palm_speed: Option<f64>,
    /// From sensors to commands, s; whole periods of the controller.
    pub delay: [f64; 2],
    /// Time constant with which the arm follows its target, s.
    pub arm_lag: [f64; 2],
    /// Tendon that is wound before anything is taut, m.
    pub slack: [f64; 2],
    /// What the motor's torque reads, as a multiple of what it is.
    pub torque_gain: [f64; 2],
    /// The motor's real limit, as a multiple of what it should be.
    pub limit_gain: [f64; 2],
    /// Of motor and spool, N·m: winding takes so much more, of which the tendons feel nothing.
    pub motor_friction: [f64; 2],
    /// Between which fractions of training the spans grow from nothing to all of it.
    pub growth: [f64; 2],
}

impl Default for Bench {
    /// The paper's simulation.
    fn default() -> Self {
        Self {
            travel_sensed: TravelSensed::Commanded,
            object_sensed: ObjectSensed::Tracked,
            grasp_felt: 0.3,
            palm_speed: None,
            delay: [0.0; 2],
            arm_lag: [0.0; 2],
            slack: [0.0; 2],
            torque_gain: [1.0; 2],
            limit_gain: [1.0; 2],
            motor_friction: [0.0; 2],
            growth: [0.0; 2],
        }
    }
}

impl Bench {
    pub(super) fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let about = "what is told of the motor's travel: the sum that was `commanded`, as in the paper, or the `encoder` of the spool, \
                     which the motor's limit holds back; `both`: the encoder, and the sum as `motor_travel_target`";
        fields.choice("travel_sensed", &mut self.travel_sensed, about);
        let about = "what is told of the object's place: `tracked` all the time; `carried`: told at the start, and with the palm \
                     once the grasp is felt; `fixed`: told at the start";
        fields.choice("object_sensed", &mut self.object_sensed, about);
        let about = "reading of the motor's torque from which on a carried object counts as held";
        fields.quantity("grasp_felt", &mut self.grasp_felt, Dimension::Torque, 0.0..=10.0, about);
        let about = "the most that the arm moves the palm with, in any direction";
        let example = (Dimension::Speed, 0.1);
        fields.optional_quantity("palm_speed", &mut self.palm_speed, example, 1e-3..=10.0, about);
        let about = "from the sensors to the commands, drawn once an episode, in whole periods of the controller";
        fields.span("delay", &mut self.delay, Dimension::Time, 0.0..=0.5, about);
        let about = "time constant with which the arm follows, drawn once an episode";
        fields.span("arm_lag", &mut self.arm_lag, Dimension::Time, 0.0..=1.0, about);
        let about = "of tendon, wound before it pulls, drawn once an episode";
        fields.span("slack", &mut self.slack, Dimension::Length, 0.0..=0.02, about);
        let about = "what the motor's torque reads as a multiple of what it is, drawn once an episode";
        fields.span("torque_gain", &mut self.torque_gain, Dimension::None, 0.1..=10.0, about);
        let about = "the motor's limit as a multiple of what it should be, drawn once an episode";
        fields.span("limit_gain", &mut self.limit_gain, Dimension::None, 0.1..=10.0, about);
        let about =
            "friction of motor and spool: what winding takes more and the tendons do not feel, drawn once an episode";
        fields.span("motor_friction", &mut self.motor_friction, Dimension::Torque, 0.0..=1.0, about);
        let about = "between which fractions of training delay, arm_lag, slack, friction and both gains grow from nothing to what is drawn: a \
                     curriculum";
        fields.fractions("bench_growth", &mut self.growth, about);
    }
}
