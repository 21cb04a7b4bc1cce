//! Where the flange is, and which joints bring it somewhere.
//!
//! Denavit and Hartenberg's values are the vendor's ("Parameters for calculations of kinematics and dynamics"). The way back is
//! in closed form, as these arms have a wrist whose three axes cut in pairs; its eight branches are checked forwards.

use std::f64::consts::{FRAC_PI_2, TAU};

use hwasp_drivers::Pose;
use nalgebra::{Isometry3, Matrix4, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Joints, rad.
pub type Joints = [f64; 6];

/// Lengths of an arm, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lengths {
    /// From the base to the shoulder.
    pub d1: f64,
    /// Upper arm; negative as the vendor writes it.
    pub a2: f64,
    /// Forearm; negative too.
    pub a3: f64,
    /// To the first wrist.
    pub d4: f64,
    /// To the second.
    pub d5: f64,
    /// To the flange.
    pub d6: f64,
}

/// UR5 (CB3).
pub const UR5: Lengths = Lengths { d1: 0.089_159, a2: -0.425, a3: -0.392_25, d4: 0.109_15, d5: 0.094_65, d6: 0.0823 };
/// `UR5e`.
pub const UR5E: Lengths = Lengths { d1: 0.1625, a2: -0.425, a3: -0.3922, d4: 0.1333, d5: 0.0997, d6: 0.0996 };

/// Joints turn so far either way, rad.
const MOST: f64 = TAU;

/// One link: about z by `theta`, along it by `d`, then along x by `a` and about it by `alpha`.
fn link(theta: f64, d: f64, a: f64, alpha: f64) -> Isometry3<f64> {
    let about_z = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), theta);
    let about_x = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), alpha);
    let shift = Translation3::from(about_z * Vector3::new(a, 0.0, d));
    Isometry3::from_parts(shift, about_z * about_x)
}

/// A pose as the wire tells it: axis times angle.
pub fn pose_of(frame: &Isometry3<f64>) -> Pose {
    Pose { position: frame.translation.vector.into(), rotation: frame.rotation.scaled_axis().into() }
}

/// A frame of a pose.
pub fn frame_of(pose: &Pose) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(pose.rotation));
    Isometry3::from_parts(Translation3::from(Vector3::from(pose.position)), rotation)
}

impl Lengths {
    /// The flange in the base.
    pub fn forward(&self, q: &Joints) -> Isometry3<f64> {
        link(q[0], self.d1, 0.0, FRAC_PI_2)
            * link(q[1], 0.0, self.a2, 0.0)
            * link(q[2], 0.0, self.a3, 0.0)
            * link(q[3], self.d4, 0.0, FRAC_PI_2)
            * link(q[4], self.d5, 0.0, -FRAC_PI_2)
            * link(q[5], self.d6, 0.0, 0.0)
    }

    /// The joints nearest to `near` that bring the flange to `flange`; `None` where it does not reach.
    pub fn inverse(&self, flange: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
        let mut best: Option<(f64, Joints)> = None;
        for raw in self.branches(flange, near) {
            let mut q = raw;
            for joint in 0..6 {
                q[joint] = wind(raw[joint], near[joint]);
            }
            let there = self.forward(&q);
            let off = (there.translation.vector - flange.translation.vector).norm()
                + there.rotation.angle_to(&flange.rotation);
            let far: f64 = (0..6).map(|joint| (q[joint] - near[joint]).powi(2)).sum();
            if off < 1e-6 && best.is_none_or(|(least, _)| far < least) {
                best = Some((far, q));
            }
        }
        best.map(|(_, q)| q)
    }

    fn branches(&self, flange: &Isometry3<f64>, near: &Joints) -> Vec<Joints> {
        let t: Matrix4<f64> = flange.to_homogeneous();
        let wrist = flange * nalgebra::Point3::new(0.0, 0.0, -self.d6);
        let reach = wrist.x.hypot(wrist.y);
        let mut all = Vec::with_capacity(8);
        let Some(shoulder) = arc_cosine(self.d4 / reach) else {
            return all;
        };
        for pan in [shoulder, -shoulder] {
            let q1 = wrist.y.atan2(wrist.x) + pan + FRAC_PI_2;
            let (s1, c1) = q1.sin_cos();
            let Some(bend) = arc_cosine((t[(0, 3)] * s1 - t[(1, 3)] * c1 - self.d4) / self.d6) else {
                continue;
            };
            for q5 in [bend, -bend] {
                let s5 = q5.sin();
                // With the wrist straight the last joint and the fourth turn about one axis: the last stays.
                let q6 = if s5.abs() < 1e-9 {
                    near[5]
                } else {
                    let y = (-t[(0, 1)] * s1 + t[(1, 1)] * c1) / s5;
                    let x = (t[(0, 0)] * s1 - t[(1, 0)] * c1) / s5;
                    y.atan2(x)
                };
                let base = link(q1, self.d1, 0.0, FRAC_PI_2);
                let hand = link(q5, self.d5, 0.0, -FRAC_PI_2) * link(q6, self.d6, 0.0, 0.0);
                let middle = base.inverse() * flange * hand.inverse();
                // Both links of the arm lie in the plane of the shoulder.
                let (x, y) = {
                    let elbow = middle * link(0.0, self.d4, 0.0, FRAC_PI_2).inverse();
                    (elbow.translation.x, elbow.translation.y)
                };
                let far = x * x + y * y;
                let Some(elbow) = arc_cosine((far - self.a2 * self.a2 - self.a3 * self.a3) / (2.0 * self.a2 * self.a3))
                else {
                    continue;
                };
                for q3 in [elbow, -elbow] {
                    let q2 = y.atan2(x) - (self.a3 * q3.sin()).atan2(self.a2 + self.a3 * q3.cos());
                    let arm = link(q2, 0.0, self.a2, 0.0) * link(q3, 0.0, self.a3, 0.0);
                    let rest = (arm.inverse() * middle).rotation.to_rotation_matrix();
                    let q4 = rest[(1, 0)].atan2(rest[(0, 0)]);
                    all.push([q1, q2, q3, q4, q5, q6]);
                }
            }
        }
        all
    }
}

/// Also of what rounding has carried a little beyond one.
fn arc_cosine(value: f64) -> Option<f64> {
    (value.abs() <= 1.0 + 1e-9).then(|| value.clamp(-1.0, 1.0).acos())
}

/// The same angle, by whole turns as near as it gets, within what a joint turns.
fn wind(angle: f64, near: f64) -> f64 {
    let mut wound = angle + TAU * ((near - angle) / TAU).round();
    if wound > MOST {
        wound -= TAU;
    }
    if wound < -MOST {
        wound += TAU;
    }
    wound
}

/// A pose between two: straight, and turned the short way.
pub(crate) fn between(from: &Isometry3<f64>, to: &Isometry3<f64>, part: f64) -> Isometry3<f64> {
    let turn = (from.rotation.inverse() * to.rotation).scaled_axis();
    let shift = from.translation.vector.lerp(&to.translation.vector, part);
    Isometry3::from_parts(Translation3::from(shift), from.rotation * UnitQuaternion::from_scaled_axis(turn * part))
}

/// Turn from one frame to another as an axis times an angle, in the base.
pub(crate) fn turned(from: &Isometry3<f64>, to: &Isometry3<f64>) -> Vector3<f64> {
    Rotation3::from(to.rotation * from.rotation.inverse()).scaled_axis()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use proptest::prelude::*;

    use super::*;

    /// With all joints at zero the arm lies along −x, the wrists point along −y and down: the sums of the vendor's lengths.
    #[test]
    fn stretched_out_it_is_as_long_as_its_links() {
        for arm in [UR5, UR5E] {
            let flange = arm.forward(&[0.0; 6]);
            let expected = Vector3::new(arm.a2 + arm.a3, -arm.d4 - arm.d6, arm.d1 - arm.d5);
            assert!((flange.translation.vector - expected).norm() < 1e-12, "{flange}");
        }
        // Upright, as the vendor's "home": the same lengths, stacked.
        let home = UR5.forward(&[0.0, -FRAC_PI_2, 0.0, -FRAC_PI_2, 0.0, 0.0]);
        let expected = Vector3::new(0.0, -UR5.d4 - UR5.d6, UR5.d1 - UR5.a2 - UR5.a3 + UR5.d5);
        assert!((home.translation.vector - expected).norm() < 1e-12, "{home}");
    }

    proptest! {
        #[test]
        fn the_way_back_comes_home(q in prop::array::uniform6(-PI..PI), e in any::<bool>()) {
            let arm = if e { UR5E } else { UR5 };
            // Away from where branches meet, and from where the wrist stands over the shoulder.
            prop_assume!(q[2].sin().abs() > 0.02 && q[4].sin().abs() > 0.02);
            let flange = arm.forward(&q);
            let wrist = flange * nalgebra::Point3::new(0.0, 0.0, -arm.d6);
            prop_assume!(wrist.x.hypot(wrist.y) > arm.d4 + 0.01);
            let back = arm.inverse(&flange, &q).expect("a pose that was reached is in reach");
            for joint in 0..6 {
                prop_assert!((back[joint] - q[joint]).abs() < 1e-6, "{back:?} is not {q:?}");
            }
        }

        #[test]
        fn from_elsewhere_it_reaches_the_same_pose(
            q in prop::array::uniform6(-PI..PI),
            near in prop::array::uniform6(-TAU..TAU),
        ) {
            let flange = UR5.forward(&q);
            let back = UR5.inverse(&flange, &near);
            prop_assume!(q[2].sin().abs() > 0.02 && q[4].sin().abs() > 0.02);
            let back = back.expect("in reach");
            prop_assert!(back.iter().all(|angle| angle.abs() <= MOST));
            let there = UR5.forward(&back);
            prop_assert!((there.translation.vector - flange.translation.vector).norm() < 1e-6);
            prop_assert!(there.rotation.angle_to(&flange.rotation) < 1e-6);
        }
    }

    #[test]
    fn out_of_reach_is_out_of_reach() {
        let far = Isometry3::translation(1.5, 0.0, 0.3);
        assert_eq!(UR5.inverse(&far, &[0.0; 6]), None);
    }

    #[test]
    fn with_a_straight_wrist_the_last_joint_stays() {
        let q = [0.3, -1.2, 1.4, -0.2, 0.0, 0.7];
        let back = UR5.inverse(&UR5.forward(&q), &q).expect("in reach");
        assert!((back[5] - 0.7).abs() < 1e-9 && (back[3] - q[3]).abs() < 1e-6, "{back:?}");
    }
}
