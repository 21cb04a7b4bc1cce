//! How bodies, sites and geoms move, and what moves them.

use mujoco_rs::prelude::MjtObjBase;
use mujoco_rs::wrappers::fun::utility::mju_mat_2_quat;

use super::inventory::sensor_values;
use super::{ActuatorId, BodyId, GeomId, KeyframeId, SensorId, Simulation, SiteId, TendonId};

/// A velocity of a body, in the world's frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Of the body's origin, m/s.
    pub linear: [f64; 3],
    /// rad/s.
    pub angular: [f64; 3],
}

/// Energy, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// Of gravity and springs; zero where all bodies lie at the world's origin.
    pub potential: f64,
    /// Of motion.
    pub kinetic: f64,
}

/// A state that does not fit the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a state of {} positions and {} velocities does not fit a model of {} and {}", .given[0], .given[1], .model[0], .model[1])]
pub struct StateSize {
    /// Positions and velocities that were given.
    pub given: [usize; 2],
    /// Those that the model has.
    pub model: [usize; 2],
}

impl Simulation {
    /// Sets positions and velocities, as [`Self::qpos`] and [`Self::qvel`] have them. Nothing else changes.
    pub fn set_state(&mut self, qpos: &[f64], qvel: &[f64]) -> Result<(), StateSize> {
        let (given, model) = ([qpos.len(), qvel.len()], [self.qpos().len(), self.qvel().len()]);
        if given != model {
            return Err(StateSize { given, model });
        }
        self.qpos_mut().copy_from_slice(qpos);
        self.qvel_mut().copy_from_slice(qvel);
        Ok(())
    }

    /// Puts the simulation into a state that the model names, with its time, controls and activations. Faults and applied
    /// forces are gone, as after [`Self::reset`].
    pub fn set_keyframe(&mut self, keyframe: KeyframeId) {
        self.reset();
        let reset = self.data_mut().reset_keyframe(keyframe.0);
        assert!(reset.is_ok(), "the keyframe {keyframe:?} is one of another model");
    }

    /// The positions of a state that the model names, as [`Self::qpos`].
    pub fn keyframe_qpos(&self, keyframe: KeyframeId) -> &[f64] {
        let count = self.qpos().len();
        let all = self.model().key_qpos();
        &all[keyframe.0 * count..][..count]
    }

    /// Position of a body's centre of mass, as computed last, m.
    pub fn body_center(&self, body: BodyId) -> [f64; 3] {
        self.data().xipos()[body.0]
    }

    /// Velocity of a body, as computed last.
    pub fn body_velocity(&self, body: BodyId) -> Twist {
        let [wx, wy, wz, vx, vy, vz] = self.data().object_velocity(MjtObjBase::mjOBJ_XBODY, body.0, false);
        Twist { linear: [vx, vy, vz], angular: [wx, wy, wz] }
    }

    /// Centre of mass of a body together with all that belong to it, as computed last, m. The world's is that of everything.
    pub fn subtree_center(&self, body: BodyId) -> [f64; 3] {
        self.data().subtree_com()[body.0]
    }

    /// Velocity of [`Self::subtree_center`], computed from the velocities as computed last, m/s.
    pub fn subtree_velocity(&mut self, body: BodyId) -> [f64; 3] {
        if !self.data().flg_subtreevel() {
            self.data_mut().subtree_vel();
        }
        self.data().subtree_linvel()[body.0]
    }

    /// What the world does to a body by contacts and applied wrenches, as computed last: torque (N·m) and force (N) in the
    /// world's frame, about the centre of mass of the tree that the body belongs to. Equality constraints count too.
    pub fn external_force(&mut self, body: BodyId) -> [f64; 6] {
        if !self.data().flg_rnepost() {
            self.data_mut().rne_post_constraint();
        }
        self.data().cfrc_ext()[body.0]
    }

    /// Energy of positions and velocities as computed last.
    pub fn energy(&mut self) -> Energy {
        self.data_mut().energy_pos();
        self.data_mut().energy_vel();
        let [potential, kinetic] = *self.data().energy();
        Energy { potential, kinetic }
    }

    /// Orientation of a geom, as computed last: a unit quaternion (w, x, y, z).
    pub fn geom_orientation(&self, geom: GeomId) -> [f64; 4] {
        quaternion(&self.data().geom_xmat()[geom.0])
    }

    /// Position of a site, as computed last, m.
    pub fn site_position(&self, site: SiteId) -> [f64; 3] {
        self.data().site_xpos()[site.0]
    }

    /// Orientation of a site, as computed last: a unit quaternion (w, x, y, z).
    pub fn site_orientation(&self, site: SiteId) -> [f64; 4] {
        quaternion(&self.data().site_xmat()[site.0])
    }

    /// Values of all sensors, as computed last; [`super::SensorEntry`] says where each stands and what it measures.
    pub fn sensordata(&self) -> &[f64] {
        self.data().sensordata()
    }

    /// Values of a sensor, as computed last.
    pub fn sensor_values(&self, sensor: SensorId) -> &[f64] {
        &self.data().sensordata()[sensor_values(self.model(), sensor.0)]
    }

    /// How fast a tendon grows longer, as computed last, m/s.
    pub fn tendon_velocity(&self, tendon: TendonId) -> f64 {
        self.data().ten_velocity()[tendon.0]
    }

    /// Derivative of a tendon's length by each degree of freedom, as computed last: its moment arms, m/rad or a ratio.
    ///
    /// # Panics
    ///
    /// If `moment` has not one element for each degree of freedom.
    pub fn tendon_moment(&self, tendon: TendonId, moment: &mut [f64]) {
        assert_eq!(moment.len(), self.qvel().len(), "one element for each degree of freedom");
        moment.fill(0.0);
        for (dof, value) in self.tendon_row(tendon) {
            moment[dof] = value;
        }
    }

    /// Lets a tendon pull with a tension, N, in addition to what is applied already: it adds to [`Self::qfrc_applied`],
    /// which holds until written again. The moment arms are those computed last ([`Self::forward`]). A negative tension
    /// pushes.
    pub fn add_tendon_tension(&mut self, tendon: TendonId, tension: f64) {
        // The row belongs to the data whose forces are written, so its elements are reached by index.
        for place in self.tendon_places(tendon) {
            let dof = self.model().ten_j_colind()[place] as usize;
            let moment = self.data().ten_j()[place];
            self.qfrc_applied_mut()[dof] -= tension * moment;
        }
    }

    /// Force of an actuator along what it drives, before the gear, as computed last: N or N·m. Of an actuator with several
    /// outputs, the first.
    pub fn actuator_force(&self, actuator: ActuatorId) -> f64 {
        self.data().actuator_force()[self.output(actuator)]
    }

    /// Length of an actuator: the coordinate of what it drives times the gear, as computed last.
    pub fn actuator_length(&self, actuator: ActuatorId) -> f64 {
        self.data().actuator_length()[self.output(actuator)]
    }

    /// Velocity of an actuator, as [`Self::actuator_length`], per second.
    pub fn actuator_velocity(&self, actuator: ActuatorId) -> f64 {
        self.data().actuator_velocity()[self.output(actuator)]
    }

    /// Activations of all actuators that have dynamics of their own; [`super::ActuatorEntry`] says where each stands.
    pub fn activations(&self) -> &[f64] {
        self.data().act()
    }

    /// Activations, to be written.
    pub fn activations_mut(&mut self) -> &mut [f64] {
        self.data_mut().act_mut()
    }

    fn output(&self, actuator: ActuatorId) -> usize {
        self.model().actuator_outadr()[actuator.0] as usize
    }

    /// Where the elements of a tendon's row of the sparse Jacobian stand.
    fn tendon_places(&self, tendon: TendonId) -> std::ops::Range<usize> {
        let start = self.model().ten_j_rowadr()[tendon.0] as usize;
        start..start + self.model().ten_j_rownnz()[tendon.0] as usize
    }

    fn tendon_row(&self, tendon: TendonId) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.tendon_places(tendon)
            .map(|place| (self.model().ten_j_colind()[place] as usize, self.data().ten_j()[place]))
    }
}

/// The unit quaternion of a rotation matrix, row by row.
fn quaternion(matrix: &[f64; 9]) -> [f64; 4] {
    let mut quaternion = [0.0; 4];
    mju_mat_2_quat(&mut quaternion, matrix);
    quaternion
}
