//! How far the loops of a model are open.

use mujoco_rs::prelude::{MjtConstraint, MjtEq, MjtJoint};

use super::inventory::name;
use super::{Kind, Simulation};

/// Where the weight of a weld's turning stands among its numbers.
const TORQUE_SCALE: usize = 10;

/// How far an equality constraint is from holding.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// The constraint's name.
    pub name: Option<String>,
    /// Which of all equality constraints it is, from 0.
    pub index: usize,
    /// As MJCF calls it: `connect`, `weld`, `joint`.
    pub kind: &'static str,
    /// How far apart what it joins is, m.
    pub distance: f64,
    /// How far it is turned, rad.
    pub angle: f64,
}

impl Simulation {
    /// How far each active equality constraint of bodies, sites and joints is from holding, as computed last. Those of tendons and
    /// flexible bodies pull, and close nothing: they are left out.
    pub fn gaps(&self) -> Vec<Gap> {
        let (model, data) = (self.model(), self.data());
        let mut gaps: Vec<Gap> = Vec::new();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for ((&kind, &id), &residual) in data.efc_type().iter().zip(data.efc_id()).zip(data.efc_pos()) {
            if kind != MjtConstraint::mjCNSTR_EQUALITY {
                continue;
            }
            let index = id as usize;
            let kind = match model.eq_type()[index] {
                MjtEq::mjEQ_CONNECT => "connect",
                MjtEq::mjEQ_WELD => "weld",
                MjtEq::mjEQ_JOINT => "joint",
                _ => continue,
            };
            // The rows of a constraint stand together.
            if gaps.last().is_none_or(|gap| gap.index != index) {
                gaps.push(Gap { name: name(model, Kind::Equality, index), index, kind, distance: 0.0, angle: 0.0 });
                rows.push(Vec::new());
            }
            rows.last_mut().expect("a gap has rows").push(residual);
        }
        for (gap, rows) in gaps.iter_mut().zip(rows) {
            let (place, turn) = rows.split_at(rows.len().min(3));
            gap.distance = size(place);
            if gap.kind == "weld" {
                // Of the turning the engine has the quaternion's vector, weighted: sines of half the angle.
                let scale = model.eq_data()[gap.index][TORQUE_SCALE];
                gap.angle = if scale > 0.0 { 2.0 * (size(turn) / scale).min(1.0).asin() } else { 0.0 };
            } else if gap.kind == "joint"
                && model.jnt_type()[model.eq_obj1id()[gap.index] as usize] != MjtJoint::mjJNT_SLIDE
            {
                (gap.distance, gap.angle) = (0.0, gap.distance);
            }
        }
        gaps
    }
}

fn size(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}
