//! What the workshop has: axle, line, room at a joint, and how finely parts can be made.

use hwasp_core::{Dimension, parse_quantity, unit};
use hwasp_settings::nearest;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The workshop. Each figure can be set, `axle="3 mm"` for one.
///
/// | key | default | what it is | limits |
/// |---|---|---|---|
/// | `axle` | 2.5 mm | the pin of a joint, on which its springs sit | 0.5 to 20 mm |
/// | `clearance` | 0.1 | least play of a wound coil on the axle, as a share of the axle | 0 to 1 |
/// | `spring_room` | 6 mm | room for the body of each spring along the axle | 1 to 100 mm |
/// | `coil_room` | 14 mm | room for a coil across the axle | 2 to 100 mm |
/// | `stress_share` | 0.75 | most bending stress of a spring, as a share of its wire's strength | 0.05 to 1 |
/// | `springs` | 2 | springs side by side at a joint, wound left and right in turn | 1 to 4 |
/// | `hole_pitch` | 15 deg | angle between neighbouring holes for the fixed legs, on a full circle | 1 to 90 deg, a whole part of 360 deg |
/// | `line` | 0.4 mm | diameter of the tendon; a pulley's radius is that of its groove and half of this | 0.05 to 3 mm |
/// | `radius_step` | 0.05 mm | step in which groove radii are made | 0.001 to 1 mm |
///
/// All are our choice. The axle, the line and the room are those of a finger of 24 mm in which a pulley has two springs beside
/// it, as the paper's hand has; 15° are 24 holes, which put a preload within 0.13 rad.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bench {
    /// Diameter of the pin of a joint, m.
    pub axle: f64,
    /// Least play of a wound coil on the axle, as a share of the axle.
    pub clearance: f64,
    /// Room for the body of each spring along the axle, m.
    pub spring_room: f64,
    /// Room for a coil across the axle, m.
    pub coil_room: f64,
    /// Most bending stress, as a share of the wire's strength.
    pub stress_share: f64,
    /// Springs side by side at a joint.
    pub springs: u32,
    /// Angle between neighbouring holes for the fixed legs, rad.
    pub hole_pitch: f64,
    /// Diameter of the tendon, m.
    pub line: f64,
    /// Step in which groove radii are made, m.
    pub radius_step: f64,
}

impl Default for Bench {
    fn default() -> Self {
        Self {
            axle: 0.0025,
            clearance: 0.1,
            spring_room: 0.006,
            coil_room: 0.014,
            stress_share: 0.75,
            springs: 2,
            hole_pitch: 15f64.to_radians(),
            line: 0.0004,
            radius_step: 0.000_05,
        }
    }
}

/// Why a figure of the workshop cannot be set so.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("--bench {given}: {message}\n  = hint: {hint}")]
pub struct BenchError {
    given: String,
    message: String,
    hint: String,
}

/// A key, what it measures, its limits in the unit of its dimension that they are told in.
const KEYS: [(&str, Dimension, &str, [f64; 2]); 9] = [
    ("axle", Dimension::Length, "mm", [0.5, 20.0]),
    ("clearance", Dimension::None, "", [0.0, 1.0]),
    ("spring_room", Dimension::Length, "mm", [1.0, 100.0]),
    ("coil_room", Dimension::Length, "mm", [2.0, 100.0]),
    ("stress_share", Dimension::None, "", [0.05, 1.0]),
    ("springs", Dimension::None, "", [1.0, 4.0]),
    ("hole_pitch", Dimension::Angle, "deg", [1.0, 90.0]),
    ("line", Dimension::Length, "mm", [0.05, 3.0]),
    ("radius_step", Dimension::Length, "mm", [0.001, 1.0]),
];

impl Bench {
    /// Sets a figure: `axle=3 mm`.
    pub fn set(&mut self, assignment: &str) -> Result<(), BenchError> {
        let error = |message: String, hint: String| BenchError { given: assignment.to_owned(), message, hint };
        let known = || KEYS.map(|key| key.0).join(", ");
        let (key, value) = assignment
            .split_once('=')
            .ok_or_else(|| error("it has no `=`".into(), "write it as KEY=VALUE, axle=\"3 mm\" for example".into()))?;
        let (key, value) = (key.trim(), value.trim().trim_matches('"'));
        let &(key, dimension, symbol, [least, most]) = KEYS.iter().find(|known| known.0 == key).ok_or_else(|| {
            let near = nearest(key, KEYS.iter().map(|key| key.0));
            error(
                format!("`{key}` is none of {}", known()),
                near.map_or("see docs/parts.md".into(), |near| format!("did you mean `{near}`?")),
            )
        })?;
        let limits = format!("it goes from {least} to {most} {symbol}").trim_end().to_owned();
        let si = parse_quantity(value, dimension).map_err(|e| error(e.to_string(), limits.clone()))?;
        let per_unit = unit(symbol).map_or(1.0, |unit| unit.to_si);
        let shown = si / per_unit;
        // The last bit of a conversion is no fault.
        if !(least * (1.0 - 1e-9)..=most * (1.0 + 1e-9)).contains(&shown) {
            return Err(error(format!("{value} is outside of its limits"), limits));
        }
        match key {
            "axle" => self.axle = si,
            "clearance" => self.clearance = si,
            "spring_room" => self.spring_room = si,
            "coil_room" => self.coil_room = si,
            "stress_share" => self.stress_share = si,
            "springs" if si.fract() == 0.0 => self.springs = si as u32,
            "springs" => return Err(error(format!("{value} is no whole number"), limits)),
            "hole_pitch" => {
                let holes = 360.0 / shown;
                if (holes - holes.round()).abs() > 1e-6 {
                    return Err(error(
                        format!("{value} is no whole part of a circle"),
                        "15, 18, 20, 22.5 and 24 deg are, for example".into(),
                    ));
                }
                self.hole_pitch = si;
            }
            "line" => self.line = si,
            _ => self.radius_step = si,
        }
        Ok(())
    }

    /// Holes on the circle.
    pub fn holes(&self) -> u32 {
        (std::f64::consts::TAU / self.hole_pitch).round() as u32
    }
}
