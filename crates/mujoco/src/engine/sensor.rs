//! What sensors measure.

use mujoco_rs::prelude::{MjModel, MjtJoint, MjtSensor, MjtTrn};

use super::Quantity;

/// The type of a sensor as MJCF calls it, and what its values measure.
pub(super) fn quantity(model: &MjModel, sensor: usize) -> (&'static str, Quantity) {
    use Quantity as Q;
    // Of sensors of joints, tendons and actuators it is the index of those.
    let object = usize::try_from(model.sensor_objid()[sensor]).unwrap_or_default();
    let joint = |turns, slides| of_joint(model, object, turns, slides);
    let actuator = |turns, slides| of_actuator(model, object, turns, slides);
    match model.sensor_type()[sensor] {
        MjtSensor::mjSENS_TOUCH => ("touch", Q::Force),
        MjtSensor::mjSENS_ACCELEROMETER => ("accelerometer", Q::Acceleration),
        MjtSensor::mjSENS_VELOCIMETER => ("velocimeter", Q::Velocity),
        MjtSensor::mjSENS_GYRO => ("gyro", Q::AngularVelocity),
        MjtSensor::mjSENS_FORCE => ("force", Q::Force),
        MjtSensor::mjSENS_TORQUE => ("torque", Q::Torque),
        MjtSensor::mjSENS_MAGNETOMETER => ("magnetometer", Q::MagneticFluxDensity),
        // It may give directions beside distances.
        MjtSensor::mjSENS_RANGEFINDER if model.sensor_dim()[sensor] == 1 => ("rangefinder", Q::Length),
        MjtSensor::mjSENS_RANGEFINDER => ("rangefinder", Q::Mixed),
        MjtSensor::mjSENS_CAMPROJECTION => ("camprojection", Q::Pixels),
        MjtSensor::mjSENS_JOINTPOS => ("jointpos", joint(Q::Angle, Q::Length)),
        MjtSensor::mjSENS_JOINTVEL => ("jointvel", joint(Q::AngularVelocity, Q::Velocity)),
        MjtSensor::mjSENS_TENDONPOS => ("tendonpos", Q::Length),
        MjtSensor::mjSENS_TENDONVEL => ("tendonvel", Q::Velocity),
        MjtSensor::mjSENS_ACTUATORPOS => ("actuatorpos", actuator(Q::Angle, Q::Length)),
        MjtSensor::mjSENS_ACTUATORVEL => ("actuatorvel", actuator(Q::AngularVelocity, Q::Velocity)),
        MjtSensor::mjSENS_ACTUATORFRC => ("actuatorfrc", actuator(Q::Torque, Q::Force)),
        MjtSensor::mjSENS_JOINTACTFRC => ("jointactuatorfrc", joint(Q::Torque, Q::Force)),
        MjtSensor::mjSENS_TENDONACTFRC => ("tendonactuatorfrc", Q::Force),
        MjtSensor::mjSENS_BALLQUAT => ("ballquat", Q::Number),
        MjtSensor::mjSENS_BALLANGVEL => ("ballangvel", Q::AngularVelocity),
        MjtSensor::mjSENS_JOINTLIMITPOS => ("jointlimitpos", joint(Q::Angle, Q::Length)),
        MjtSensor::mjSENS_JOINTLIMITVEL => ("jointlimitvel", joint(Q::AngularVelocity, Q::Velocity)),
        MjtSensor::mjSENS_JOINTLIMITFRC => ("jointlimitfrc", joint(Q::Torque, Q::Force)),
        MjtSensor::mjSENS_TENDONLIMITPOS => ("tendonlimitpos", Q::Length),
        MjtSensor::mjSENS_TENDONLIMITVEL => ("tendonlimitvel", Q::Velocity),
        MjtSensor::mjSENS_TENDONLIMITFRC => ("tendonlimitfrc", Q::Force),
        MjtSensor::mjSENS_FRAMEPOS => ("framepos", Q::Length),
        MjtSensor::mjSENS_FRAMEQUAT => ("framequat", Q::Number),
        MjtSensor::mjSENS_FRAMEXAXIS => ("framexaxis", Q::Number),
        MjtSensor::mjSENS_FRAMEYAXIS => ("frameyaxis", Q::Number),
        MjtSensor::mjSENS_FRAMEZAXIS => ("framezaxis", Q::Number),
        MjtSensor::mjSENS_FRAMELINVEL => ("framelinvel", Q::Velocity),
        MjtSensor::mjSENS_FRAMEANGVEL => ("frameangvel", Q::AngularVelocity),
        MjtSensor::mjSENS_FRAMELINACC => ("framelinacc", Q::Acceleration),
        MjtSensor::mjSENS_FRAMEANGACC => ("frameangacc", Q::AngularAcceleration),
        MjtSensor::mjSENS_SUBTREECOM => ("subtreecom", Q::Length),
        MjtSensor::mjSENS_SUBTREELINVEL => ("subtreelinvel", Q::Velocity),
        MjtSensor::mjSENS_SUBTREEANGMOM => ("subtreeangmom", Q::AngularMomentum),
        MjtSensor::mjSENS_INSIDESITE => ("insidesite", Q::Number),
        MjtSensor::mjSENS_GEOMDIST => ("distance", Q::Length),
        MjtSensor::mjSENS_GEOMNORMAL => ("normal", Q::Number),
        MjtSensor::mjSENS_GEOMFROMTO => ("fromto", Q::Length),
        MjtSensor::mjSENS_CONTACT => ("contact", Q::Mixed),
        MjtSensor::mjSENS_E_POTENTIAL => ("e_potential", Q::Energy),
        MjtSensor::mjSENS_E_KINETIC => ("e_kinetic", Q::Energy),
        MjtSensor::mjSENS_CLOCK => ("clock", Q::Time),
        MjtSensor::mjSENS_TACTILE => ("tactile", Q::Mixed),
        MjtSensor::mjSENS_PLUGIN => ("plugin", Q::Mixed),
        MjtSensor::mjSENS_USER => ("user", Q::Mixed),
    }
}

fn of_joint(model: &MjModel, joint: usize, turns: Quantity, slides: Quantity) -> Quantity {
    match model.jnt_type().get(joint) {
        Some(MjtJoint::mjJNT_SLIDE) => slides,
        _ => turns,
    }
}

/// Before the gear: what the driven joint or tendon has.
fn of_actuator(model: &MjModel, actuator: usize, turns: Quantity, slides: Quantity) -> Quantity {
    let target =
        model.actuator_trnid().get(actuator).map_or(0, |target| usize::try_from(target[0]).unwrap_or_default());
    match model.actuator_trntype().get(actuator) {
        Some(MjtTrn::mjTRN_JOINT | MjtTrn::mjTRN_JOINTINPARENT) => of_joint(model, target, turns, slides),
        Some(MjtTrn::mjTRN_TENDON | MjtTrn::mjTRN_SLIDERCRANK) => slides,
        Some(MjtTrn::mjTRN_SO3) => turns,
        _ => Quantity::Mixed,
    }
}
