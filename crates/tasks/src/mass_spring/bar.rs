//! The laws of a bar of n segments: rigid as it is built, and softened so that it can be differentiated through.

use hwasp_core::{DesignGroup, DesignSpace, Dimension, Hardware, Ports};
use hwasp_diff::Scalar;

use super::{MassSpringError, MassSpringSettings, ports};

/// The lengths of n segments that make up the bar.
fn segments(settings: &MassSpringSettings) -> Result<DesignSpace, MassSpringError> {
    settings.check()?;
    Ok(DesignSpace::new(vec![DesignGroup {
        name: "length".into(),
        dimension: Dimension::Length,
        lo: 0.0,
        hi: settings.max_total_length / settings.count as f64,
        count: settings.count,
        initial: settings.initial,
    }])?)
}

/// A rigid bar: its effort on the world is its length, which [`GivenBar`](super::Coupling::GivenBar) takes as it is.
///
/// | | name | unit | |
/// |---|---|---|---|
/// | design | `length[i]`, lᵢ | m | n values in [0, `max_total_length` / n] |
/// | command | `motor` | N | not used by the law; the plant adds it |
/// | state | `y1`, `v1`, `y2`, `v2` | m, m/s | not used |
/// | effort | `length` | m | Σ lᵢ |
#[derive(Clone, Debug)]
pub struct RigidBar {
    design: DesignSpace,
}

impl RigidBar {
    /// The bar that the settings describe.
    pub fn new(settings: &MassSpringSettings) -> Result<Self, MassSpringError> {
        Ok(Self { design: segments(settings)? })
    }
}

impl Hardware for RigidBar {
    fn design(&self) -> &DesignSpace {
        &self.design
    }

    fn ports(&self) -> Ports {
        ports::of_law(ports::LENGTH)
    }

    fn effort<T: Scalar>(&self, design: &[T], _command: &[T], _state: &[T], effort: &mut [T]) {
        effort[0] = design.iter().copied().sum();
    }
}

/// A bar whose "hard" geometry is softened by springs and dampers at its two ends (paper, appendix A), so that it acts by
/// forces on [`Free`](super::Coupling::Free) masses and its length has a gradient.
///
/// | | name | unit | |
/// |---|---|---|---|
/// | design | `length[i]`, lᵢ | m | n values in [0, `max_total_length` / n] |
/// | command | `motor` | N | not used by the law; the plant adds it to the lower mass |
/// | state | `y1`, `v1`, `y2`, `v2` | m, m/s | |
/// | effort | `interface1` | N | `k_interf`/2·(y2 - y1 - Σ lᵢ) + `b_interf`/2·(v2 - v1) on the upper mass |
/// | | `interface2` | N | the opposite, on the lower mass |
///
/// What is built is rigid and does not give way, so it has to be [longer](Hardware::as_built) by what the interface
/// stretches under the lower mass at rest.
#[derive(Clone, Debug)]
pub struct SoftBar {
    design: DesignSpace,
    /// `k_interf`, N/m.
    stiffness: f64,
    /// `b_interf`, N·s/m.
    damping: f64,
    /// m2·g / (`k_interf`/2), m.
    stretch: f64,
}

impl SoftBar {
    /// The bar that the settings describe.
    pub fn new(settings: &MassSpringSettings) -> Result<Self, MassSpringError> {
        Ok(Self {
            design: segments(settings)?,
            stiffness: settings.interface_stiffness,
            damping: settings.interface_damping,
            stretch: settings.interface_stretch(),
        })
    }
}

impl Hardware for SoftBar {
    fn design(&self) -> &DesignSpace {
        &self.design
    }

    fn ports(&self) -> Ports {
        ports::of_law(ports::INTERFACE)
    }

    fn effort<T: Scalar>(&self, design: &[T], _command: &[T], state: &[T], effort: &mut [T]) {
        let length: T = design.iter().copied().sum();
        let (y1, v1, y2, v2) = (state[0], state[1], state[2], state[3]);
        // f_interf (appendix A, equation f_interf), and f'_interf = -f_interf.
        let pull = (y2 - y1 - length) * (0.5 * self.stiffness) + (v2 - v1) * (0.5 * self.damping);
        effort[0] = pull;
        effort[1] = -pull;
    }

    /// The segments of the rigid bar that holds the lower mass where this one does at rest: the stretch is spread evenly;
    /// a segment that reaches its limit leaves its share to the others, and only a bar at its limits gets less.
    fn as_built(&self, design: &[f64]) -> Vec<f64> {
        let room = |i: usize| (self.design.bounds(i).1 - design[i]).max(0.0);
        let mut order: Vec<usize> = (0..design.len()).collect();
        order.sort_by(|&a, &b| room(a).total_cmp(&room(b)));
        let mut built = design.to_vec();
        let mut left = self.stretch;
        for (done, &i) in order.iter().enumerate() {
            let share = (left / (order.len() - done) as f64).min(room(i));
            built[i] += share;
            left -= share;
        }
        built
    }
}
