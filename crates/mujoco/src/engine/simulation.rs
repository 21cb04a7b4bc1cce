//! The simulation itself.

use mujoco_rs::prelude::{MjData, MjModel};

use super::{BodyId, BuildError, GeomId, PhysicsFault, TendonId, Warning, log};

/// Above this the engine calls a value bad (`mjMAXVAL`).
const MAX_VALUE: f64 = 1e10;

/// A force and a torque on a body, in the world's frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// Force at the centre of mass, N.
    pub force: [f64; 3],
    /// Torque, N·m.
    pub torque: [f64; 3],
}

/// One model and its state.
///
/// Two simulations share nothing, so that each can run on a thread of its own; the same calls give the same bits in both.
#[derive(Debug, Clone)]
pub struct Simulation {
    data: MjData<Box<MjModel>>,
    /// The fault since which the state means nothing.
    fault: Option<PhysicsFault>,
}

impl Simulation {
    /// Compiles an MJCF text and sets its initial state. Derived quantities (positions of bodies, contacts) are there after
    /// [`Self::forward`] or a step.
    pub fn from_mjcf(mjcf: &str) -> Result<Self, BuildError> {
        log::install();
        let model = MjModel::from_xml_string(mjcf).map_err(|error| BuildError::Mjcf(error.to_string()))?;
        Self::new(model)
    }

    /// A simulation of a compiled model.
    pub(super) fn new(model: MjModel) -> Result<Self, BuildError> {
        let data = MjData::try_new(Box::new(model)).map_err(|error| BuildError::Allocation(error.to_string()))?;
        Ok(Self { data, fault: None })
    }

    /// Advances by a number of steps, with the same controls and forces. Positions of bodies and contacts are afterwards
    /// those at the start of the last step, as the engine leaves them; [`Self::forward`] brings them up to date.
    ///
    /// Stops at the first fault. From then on every step returns that fault, until [`Self::reset`].
    pub fn step(&mut self, steps: usize) -> Result<(), PhysicsFault> {
        self.sound()?;
        for _ in 0..steps {
            let time = self.data.time();
            self.data.step();
            self.heed_warnings(time)?;
        }
        self.check_state()
    }

    /// Computes everything that depends on the state, without advancing. Faults as in [`Self::step`].
    pub fn forward(&mut self) -> Result<(), PhysicsFault> {
        self.sound()?;
        // Only steps check the state before they use it.
        self.check_state()?;
        let time = self.data.time();
        self.data.forward();
        self.heed_warnings(time)
    }

    /// Back to the model's initial state at time zero: controls, applied forces and faults are gone, edits of the model stay.
    pub fn reset(&mut self) {
        self.data.reset();
        self.fault = None;
    }

    /// Simulation time, s.
    pub fn time(&self) -> f64 {
        self.data.time()
    }

    /// Length of a step, s.
    pub fn timestep(&self) -> f64 {
        self.data.model_opt().timestep
    }

    /// Positions, as the joints' addresses say ([`super::JointAddress`]): rad, m, unit quaternions.
    pub fn qpos(&self) -> &[f64] {
        self.data.qpos()
    }

    /// Positions, to be written.
    pub fn qpos_mut(&mut self) -> &mut [f64] {
        self.data.qpos_mut()
    }

    /// Velocities, one per degree of freedom: rad/s, m/s.
    pub fn qvel(&self) -> &[f64] {
        self.data.qvel()
    }

    /// Velocities, to be written.
    pub fn qvel_mut(&mut self) -> &mut [f64] {
        self.data.qvel_mut()
    }

    /// Accelerations, one per degree of freedom, as computed last: rad/s², m/s².
    pub fn qacc(&self) -> &[f64] {
        self.data.qacc()
    }

    /// Controls of the actuators, in their units.
    pub fn ctrl(&self) -> &[f64] {
        self.data.ctrl()
    }

    /// Controls of the actuators, to be written; they hold until written again or reset.
    pub fn ctrl_mut(&mut self) -> &mut [f64] {
        self.data.ctrl_mut()
    }

    /// Applied generalised forces, one per degree of freedom: N·m, N.
    pub fn qfrc_applied(&self) -> &[f64] {
        self.data.qfrc_applied()
    }

    /// Applied generalised forces, to be written; they hold until written again or reset.
    pub fn qfrc_applied_mut(&mut self) -> &mut [f64] {
        self.data.qfrc_applied_mut()
    }

    /// Forces of the actuators on the degrees of freedom, as computed last: N·m, N.
    pub fn qfrc_actuator(&self) -> &[f64] {
        self.data.qfrc_actuator()
    }

    /// Forces of constraints (contacts, limits, equalities, dry friction) on the degrees of freedom, as computed last: N·m, N.
    pub fn qfrc_constraint(&self) -> &[f64] {
        self.data().qfrc_constraint()
    }

    /// Forces of springs, dampers and tendons on the degrees of freedom, as computed last: N·m, N.
    pub fn qfrc_passive(&self) -> &[f64] {
        self.data.qfrc_passive()
    }

    /// Length of a tendon, as computed last, m.
    pub fn tendon_length(&self, tendon: TendonId) -> f64 {
        self.data.ten_length()[tendon.0]
    }

    /// The mass matrix, row by row, as computed last.
    ///
    /// # Panics
    ///
    /// If `matrix` has not n² elements for n degrees of freedom.
    pub fn mass_matrix(&self, matrix: &mut [f64]) {
        let n = self.qvel().len();
        assert_eq!(matrix.len(), n * n, "one element for each pair of degrees of freedom");
        let written = self.data.full_m(matrix);
        debug_assert!(written.is_ok(), "the length is the only thing that can be wrong: {written:?}");
    }

    /// Position of a body's frame, as computed last, m.
    pub fn body_position(&self, body: BodyId) -> [f64; 3] {
        self.data.xpos()[body.0]
    }

    /// Orientation of a body's frame, as computed last: a unit quaternion (w, x, y, z).
    pub fn body_orientation(&self, body: BodyId) -> [f64; 4] {
        self.data.xquat()[body.0]
    }

    /// Position of a geom's centre, as computed last, m.
    pub fn geom_position(&self, geom: GeomId) -> [f64; 3] {
        self.data.geom_xpos()[geom.0]
    }

    /// Applies a wrench to a body; it holds until set again or reset.
    pub fn set_wrench(&mut self, body: BodyId, Wrench { force, torque }: Wrench) {
        let ([fx, fy, fz], [tx, ty, tz]) = (force, torque);
        self.data.xfrc_applied_mut()[body.0] = [fx, fy, fz, tx, ty, tz];
    }

    /// The wrench that was applied to a body last.
    pub fn wrench(&self, body: BodyId) -> Wrench {
        let [fx, fy, fz, tx, ty, tz] = self.data.xfrc_applied()[body.0];
        Wrench { force: [fx, fy, fz], torque: [tx, ty, tz] }
    }

    /// Mass of a body, kg.
    pub fn mass(&self, body: BodyId) -> f64 {
        self.model().body_mass()[body.0]
    }

    /// Coefficients of friction of a geom: sliding, spinning (m), rolling (m).
    pub fn friction(&self, geom: GeomId) -> [f64; 3] {
        self.model().geom_friction()[geom.0]
    }

    pub(super) fn model(&self) -> &MjModel {
        self.data.model()
    }

    pub(super) fn data(&self) -> &MjData<Box<MjModel>> {
        &self.data
    }

    pub(super) fn data_mut(&mut self) -> &mut MjData<Box<MjModel>> {
        &mut self.data
    }

    /// Repeats the fault that is not reset yet.
    fn sound(&self) -> Result<(), PhysicsFault> {
        self.fault.clone().map_or(Ok(()), Err)
    }

    /// The engine counts warnings, and counts from zero after a reset, its own included.
    fn heed_warnings(&mut self, time: f64) -> Result<(), PhysicsFault> {
        let counters = self.data.warning();
        let Some(index) = counters.iter().position(|counter| counter.number > 0) else { return Ok(()) };
        let subject = usize::try_from(counters[index].lastinfo).unwrap_or_default();
        Err(self.fail(Warning::ALL[index], time, subject, log::take_warning()))
    }

    /// The engine checks the state only at the start of the next step.
    fn check_state(&mut self) -> Result<(), PhysicsFault> {
        let bad = |values: &[f64]| values.iter().position(|value| value.is_nan() || value.abs() > MAX_VALUE);
        let fault = bad(self.data.qpos())
            .map(|index| (Warning::BadPosition, index, self.data.qpos()[index]))
            .or_else(|| bad(self.data.qvel()).map(|index| (Warning::BadVelocity, index, self.data.qvel()[index])));
        match fault {
            None => Ok(()),
            Some((warning, index, value)) => {
                Err(self.fail(warning, self.data.time(), index, format!("the value is {value}")))
            }
        }
    }

    fn fail(&mut self, warning: Warning, time: f64, index: usize, message: String) -> PhysicsFault {
        self.fault.insert(PhysicsFault { warning, time, index, message }).clone()
    }
}
