//! What clients can read and write by RTDE, by the names of the vendor's guide.

use hwasp_drivers::ur::FieldType;
use hwasp_drivers::ur::wire::{Body, WireError};

use super::controller::{Controller, REGISTERS, SafetyMode, Shown};
use super::settings::Generation;

/// Outputs that are always there, with what stands behind them.
const OUTPUTS: [(&str, FieldType, Source); 70] = {
    use FieldType::{Double, Int32, Uint32, Uint64, Vector3, Vector6, Vector6Int32};
    use Source::{
        Clock, JointModes, Joints, Payload, PayloadCenter, Robot, RobotBits, Runtime, Safety, SafetyBits, Speeds, Tcp,
        Tool, ToolSpeed, Unit, Zero,
    };
    [
        ("timestamp", Double, Clock),
        ("target_q", Vector6, Joints),
        ("target_qd", Vector6, Speeds),
        ("target_qdd", Vector6, Zero),
        ("target_current", Vector6, Zero),
        ("target_moment", Vector6, Zero),
        ("actual_q", Vector6, Joints),
        ("actual_qd", Vector6, Speeds),
        ("actual_current", Vector6, Zero),
        ("actual_current_window", Vector6, Zero),
        ("joint_control_output", Vector6, Zero),
        ("actual_TCP_pose", Vector6, Tool),
        ("actual_TCP_speed", Vector6, ToolSpeed),
        ("actual_TCP_force", Vector6, Zero),
        ("target_TCP_pose", Vector6, Tool),
        ("target_TCP_speed", Vector6, ToolSpeed),
        ("actual_digital_input_bits", Uint64, Zero),
        ("joint_temperatures", Vector6, Zero),
        ("actual_execution_time", Double, Zero),
        ("robot_mode", Int32, Robot),
        ("joint_mode", Vector6Int32, JointModes),
        ("safety_mode", Int32, Safety),
        ("safety_status", Int32, Safety),
        ("actual_tool_accelerometer", Vector3, Zero),
        ("speed_scaling", Double, Unit),
        ("target_speed_fraction", Double, Unit),
        ("actual_momentum", Double, Zero),
        ("tcp_force_scalar", Double, Zero),
        ("actual_main_voltage", Double, Zero),
        ("actual_robot_voltage", Double, Zero),
        ("actual_robot_current", Double, Zero),
        ("actual_joint_voltage", Vector6, Zero),
        ("actual_digital_output_bits", Uint64, Zero),
        ("runtime_state", Uint32, Runtime),
        ("elbow_position", Vector3, Zero),
        ("elbow_velocity", Vector3, Zero),
        ("robot_status_bits", Uint32, RobotBits),
        ("safety_status_bits", Uint32, SafetyBits),
        ("analog_io_types", Uint32, Zero),
        ("standard_analog_input0", Double, Zero),
        ("standard_analog_input1", Double, Zero),
        ("standard_analog_output0", Double, Zero),
        ("standard_analog_output1", Double, Zero),
        ("io_current", Double, Zero),
        ("tool_mode", Uint32, Zero),
        ("tool_analog_input_types", Uint32, Zero),
        ("tool_analog_input0", Double, Zero),
        ("tool_analog_input1", Double, Zero),
        ("tool_output_voltage", Int32, Zero),
        ("tool_output_current", Double, Zero),
        ("tool_temperature", Double, Zero),
        ("tool_output_mode", FieldType::Uint8, Zero),
        ("tool_digital_output0_mode", FieldType::Uint8, Zero),
        ("tool_digital_output1_mode", FieldType::Uint8, Zero),
        ("input_bit_registers0_to_31", Uint32, Zero),
        ("input_bit_registers32_to_63", Uint32, Zero),
        ("output_bit_registers0_to_31", Uint32, Zero),
        ("output_bit_registers32_to_63", Uint32, Zero),
        ("script_control_line", Uint32, Zero),
        ("ft_raw_wrench", Vector6, Zero),
        ("wrench_calc_from_currents", Vector6, Zero),
        ("tcp_offset", Vector6, Tcp),
        ("payload", Double, Payload),
        ("payload_cog", Vector3, PayloadCenter),
        ("payload_inertia", Vector6, Zero),
        ("joint_position_deviation_ratio", Double, Zero),
        ("collision_detection_ratio", Double, Zero),
        ("time_scale_source", Int32, Zero),
        ("encoder0_raw", Double, Zero),
        ("encoder1_raw", Double, Zero),
    ]
};

/// Names that controllers of the first generation do not know.
const NEW: [&str; 5] = [
    "ft_raw_wrench",
    "wrench_calc_from_currents",
    "joint_position_deviation_ratio",
    "collision_detection_ratio",
    "time_scale_source",
];

/// Inputs that are no registers; they are taken and nothing hangs on them.
const INPUTS: [(&str, FieldType); 16] = [
    ("speed_slider_mask", FieldType::Uint32),
    ("speed_slider_fraction", FieldType::Double),
    ("standard_digital_output_mask", FieldType::Uint8),
    ("standard_digital_output", FieldType::Uint8),
    ("configurable_digital_output_mask", FieldType::Uint8),
    ("configurable_digital_output", FieldType::Uint8),
    ("tool_digital_output_mask", FieldType::Uint8),
    ("tool_digital_output", FieldType::Uint8),
    ("standard_analog_output_mask", FieldType::Uint8),
    ("standard_analog_output_type", FieldType::Uint8),
    ("standard_analog_output_0", FieldType::Double),
    ("standard_analog_output_1", FieldType::Double),
    ("tool_digital_output0_mode", FieldType::Uint8),
    ("input_bit_registers0_to_31", FieldType::Uint32),
    ("input_bit_registers32_to_63", FieldType::Uint32),
    ("external_force_torque", FieldType::Vector6),
];

/// Where an output comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    Clock,
    Joints,
    Speeds,
    Tool,
    ToolSpeed,
    Tcp,
    Payload,
    PayloadCenter,
    Robot,
    JointModes,
    Safety,
    Runtime,
    RobotBits,
    SafetyBits,
    Unit,
    Zero,
    Whole(usize),
    Real(usize),
    Bit(usize),
    InputWhole(usize),
    InputReal(usize),
}

/// Where an input goes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sink {
    Whole(usize),
    Real(usize),
    Bit(usize),
    Nowhere,
}

/// The number behind a name, if that is a register.
fn register(name: &str, head: &str, count: usize) -> Option<usize> {
    name.strip_prefix(head)?.parse().ok().filter(|number| *number < count)
}

/// An output of this name.
pub(super) fn output(name: &str, generation: Generation) -> Option<(FieldType, Source)> {
    if generation == Generation::Cb3 && NEW.contains(&name) {
        return None;
    }
    if let Some(entry) = OUTPUTS.iter().find(|entry| entry.0 == name) {
        return Some((entry.1, entry.2));
    }
    let whole = register(name, "output_int_register_", REGISTERS).map(Source::Whole);
    let input_whole = || register(name, "input_int_register_", REGISTERS).map(Source::InputWhole);
    if let Some(source) = whole.or_else(input_whole) {
        return Some((FieldType::Int32, source));
    }
    let real = register(name, "output_double_register_", REGISTERS).map(Source::Real);
    let input_real = || register(name, "input_double_register_", REGISTERS).map(Source::InputReal);
    if let Some(source) = real.or_else(input_real) {
        return Some((FieldType::Double, source));
    }
    // Bits below 64 go by the words that hold them (RTDE guide).
    let bit = register(name, "output_bit_register_", 128).filter(|bit| *bit >= 64);
    bit.map(|bit| (FieldType::Bool, Source::Bit(bit)))
}

/// An input of this name.
pub(super) fn input(name: &str) -> Option<(FieldType, Sink)> {
    if let Some(entry) = INPUTS.iter().find(|entry| entry.0 == name) {
        return Some((entry.1, Sink::Nowhere));
    }
    let whole = register(name, "input_int_register_", REGISTERS).map(|at| (FieldType::Int32, Sink::Whole(at)));
    let real = || register(name, "input_double_register_", REGISTERS).map(|at| (FieldType::Double, Sink::Real(at)));
    let bit = || register(name, "input_bit_register_", 128).map(|at| (FieldType::Bool, Sink::Bit(at)));
    whole.or_else(real).or_else(bit)
}

impl Controller {
    /// Writes the bytes of an output.
    pub(super) fn write(&self, (kind, source): (FieldType, Source), shown: &Shown, bytes: &mut Vec<u8>) {
        let mut reals = |values: &[f64]| values.iter().for_each(|value| bytes.extend_from_slice(&value.to_be_bytes()));
        let pose = |pose: &hwasp_drivers::Pose| [pose.position, pose.rotation].concat();
        match source {
            Source::Clock => reals(&[self.clock]),
            Source::Joints => reals(&shown.q),
            Source::Speeds => reals(&shown.qd),
            Source::Tool => reals(&pose(&shown.tool)),
            Source::ToolSpeed => reals(&shown.tool_speed),
            Source::Tcp => reals(&pose(&super::kinematics::pose_of(&self.tcp))),
            Source::Payload => reals(&[self.payload.0]),
            Source::PayloadCenter => reals(&self.payload.1),
            Source::Unit => reals(&[1.0]),
            Source::Real(at) => reals(&[self.outputs.reals[at]]),
            Source::InputReal(at) => reals(&[self.inputs.reals[at]]),
            Source::Whole(at) => bytes.extend_from_slice(&self.outputs.wholes[at].to_be_bytes()),
            Source::InputWhole(at) => bytes.extend_from_slice(&self.inputs.wholes[at].to_be_bytes()),
            Source::Bit(at) => bytes.push(u8::from(self.outputs.bits[at])),
            Source::Robot => bytes.extend_from_slice(&self.robot_mode().to_be_bytes()),
            // 253 is a joint that runs.
            Source::JointModes => (0..6).for_each(|_| bytes.extend_from_slice(&253_i32.to_be_bytes())),
            Source::Safety => bytes.extend_from_slice(&(self.safety as i32).to_be_bytes()),
            Source::Runtime => bytes.extend_from_slice(&self.runtime_state().to_be_bytes()),
            Source::RobotBits => bytes.extend_from_slice(&self.robot_bits().to_be_bytes()),
            Source::SafetyBits => bytes.extend_from_slice(&self.safety_bits().to_be_bytes()),
            Source::Zero => bytes.resize(bytes.len() + kind.size(), 0),
        }
    }

    /// Bit 0 power, bit 1 a program plays.
    fn robot_bits(&self) -> u32 {
        u32::from(self.robot_mode() >= 5) | u32::from(self.runtime_state() == 2) << 1
    }

    /// Bit 0 normal, 2 protective stop, 6 the robot's emergency stop, 7 any, 10 stopped by safety.
    fn safety_bits(&self) -> u32 {
        match self.safety {
            SafetyMode::Normal => 1,
            SafetyMode::ProtectiveStop => 1 << 2 | 1 << 10,
            SafetyMode::EmergencyStop => 1 << 6 | 1 << 7 | 1 << 10,
        }
    }

    /// Takes a packet of inputs in the order of their recipe; all of it or nothing.
    pub(super) fn take(&mut self, recipe: &[(FieldType, Sink)], mut body: Body<'_>) -> Result<(), WireError> {
        let mut fresh = self.inputs.clone();
        for (kind, sink) in recipe {
            match sink {
                Sink::Whole(at) => fresh.wholes[*at] = body.i32()?,
                Sink::Real(at) => fresh.reals[*at] = body.f64()?,
                Sink::Bit(at) => fresh.bits[*at] = body.u8()? != 0,
                Sink::Nowhere => drop(body.field(*kind)?),
            }
        }
        body.end()?;
        self.inputs = fresh;
        Ok(())
    }
}
