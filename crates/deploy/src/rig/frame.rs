//! From places in the task's world to poses of the arm, and back.

use hwasp_drivers::Pose;

use super::WorldSettings;

type Matrix = [[f64; 3]; 3];

/// The task's world in the arm's base. The palm never turns in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    origin: [f64; 3],
    axes: Matrix,
    tool: [f64; 3],
}

impl Frame {
    /// That of a rig.
    pub fn new(world: &WorldSettings) -> Self {
        let axes = matrix(world.rotation);
        Self { origin: world.position, axes, tool: rotation(&times(&axes, &matrix(world.tool_rotation))) }
    }

    /// The pose of the arm with the palm at a place of the world, m.
    pub fn pose(&self, place: [f64; 3]) -> Pose {
        let turned = apply(&self.axes, place);
        Pose { position: [0, 1, 2].map(|i| self.origin[i] + turned[i]), rotation: self.tool }
    }

    /// Where the palm is in the world, m.
    pub fn place(&self, pose: &Pose) -> [f64; 3] {
        let from = [0, 1, 2].map(|i| pose.position[i] - self.origin[i]);
        self.turned_back(from)
    }

    /// A direction of the arm's base, such as a speed, in the world.
    pub fn turned_back(&self, v: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| (0..3).map(|j| self.axes[j][i] * v[j]).sum())
    }
}

/// Rodrigues' formula: the matrix that turns by axis times angle.
fn matrix(rotation: [f64; 3]) -> Matrix {
    let angle = rotation.iter().map(|x| x * x).sum::<f64>().sqrt();
    if angle < 1e-12 {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    let [x, y, z] = rotation.map(|r| r / angle);
    let (s, c) = angle.sin_cos();
    let d = 1.0 - c;
    [
        [c + x * x * d, x * y * d - z * s, x * z * d + y * s],
        [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
        [z * x * d - y * s, z * y * d + x * s, c + z * z * d],
    ]
}

/// Its inverse.
fn rotation(m: &Matrix) -> [f64; 3] {
    let angle = (0.5 * (m[0][0] + m[1][1] + m[2][2] - 1.0)).clamp(-1.0, 1.0).acos();
    if angle < 1e-9 {
        return [0.0; 3];
    }
    if std::f64::consts::PI - angle < 1e-6 {
        // Half a turn: the axis is the column of (m + 1)/2 that is longest.
        let column = (0..3).max_by(|&a, &b| m[a][a].total_cmp(&m[b][b])).unwrap_or(0);
        let axis = [0, 1, 2].map(|i| 0.5 * (m[i][column] + f64::from(u8::from(i == column))));
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        return axis.map(|x| x / length * angle);
    }
    let scale = angle / (2.0 * angle.sin());
    [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]].map(|x| x * scale)
}

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|j| m[i][j] * v[j]).sum())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    fn near(a: [f64; 3], b: [f64; 3]) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9), "{a:?}, not {b:?}");
    }

    #[test]
    fn places_and_poses_by_hand() {
        // A table that is turned by a quarter about z: its x is the arm's y.
        let world =
            WorldSettings { position: [0.5, 0.1, 0.02], rotation: [0.0, 0.0, FRAC_PI_2], ..WorldSettings::default() };
        let frame = Frame::new(&world);
        let pose = frame.pose([0.1, 0.2, 0.3]);
        near(pose.position, [0.3, 0.2, 0.32]);
        near(frame.place(&pose), [0.1, 0.2, 0.3]);
        near(frame.turned_back([0.0, 1.0, 0.0]), [1.0, 0.0, 0.0]);
        // Half a turn about x, then a quarter about z, is half a turn about the diagonal.
        near(pose.rotation.map(f64::abs), [PI * 0.5_f64.sqrt(), PI * 0.5_f64.sqrt(), 0.0]);
    }

    #[test]
    fn a_rotation_is_that_of_its_matrix() {
        for r in [[0.1, -0.2, 0.3], [1.0, 2.0, -0.5], [PI, 0.0, 0.0], [0.0, -2.0, 0.0], [0.0; 3]] {
            near(rotation(&matrix(r)), r);
        }
    }
}
