//! The law of n parallel springs.

use hwasp_core::{DesignGroup, DesignSpace, Dimension, Hardware, Ports};
use hwasp_diff::Scalar;

use super::{MassSpringError, MassSpringSettings, ports};

/// n parallel springs of no natural length between ceiling and upper mass, and the motor that pulls against them (paper,
/// section 5 and appendix A).
///
/// | | name | unit | |
/// |---|---|---|---|
/// | design | `stiffness[i]`, kᵢ | N/m | n values in [0, `max_total_stiffness` / n] |
/// | command | `motor`, f | N | the string's pull, downwards |
/// | state | `y1`, `v1`, `y2`, `v2` | m, m/s | only y1 is used |
/// | effort | `effort` | N | f - (Σ kᵢ)·y1 on both masses, downwards |
#[derive(Clone, Debug)]
pub struct Springs {
    design: DesignSpace,
}

impl Springs {
    /// The springs that the settings describe.
    pub fn new(settings: &MassSpringSettings) -> Result<Self, MassSpringError> {
        settings.check()?;
        let design = DesignSpace::new(vec![DesignGroup {
            name: "stiffness".into(),
            dimension: Dimension::Stiffness,
            lo: 0.0,
            hi: settings.max_total_stiffness / settings.count as f64,
            count: settings.count,
            initial: settings.initial,
        }])?;
        Ok(Self { design })
    }
}

impl Hardware for Springs {
    fn design(&self) -> &DesignSpace {
        &self.design
    }

    fn ports(&self) -> Ports {
        ports::of_law(ports::EFFORT)
    }

    fn effort<T: Scalar>(&self, design: &[T], command: &[T], state: &[T], effort: &mut [T]) {
        let total: T = design.iter().copied().sum();
        // f_total = f_str - f_spr, with f_spr = Σ kᵢ·y1 (appendix A).
        effort[0] = command[0] - total * state[0];
    }
}
