//! The workshop that a hand is built in, described once: parts are chosen by it, sheets list it, and print files are made for it.

use std::f64::consts::TAU;

use hwasp_core::Dimension;
use hwasp_settings::{Faults, Fields, Layers, Section, Settings, read, written};
use serde::{Deserialize, Serialize};

/// The table that its keys are in.
const TABLE: &str = "bench";

/// A spring as its joint has to make room for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeatedSpring {
    /// Diameter of its wire, and so of its legs, m.
    pub wire: f64,
    /// Outer diameter of the coil, m. It is widest when it is free.
    pub outer: f64,
    /// Length of the coil along the axle, m. It is longest with the joint closed.
    pub length: f64,
}

/// A workshop. All defaults are our choice, for a finger of 24 mm.
///
/// Axle and rooms are those of a joint whose pulley has two springs beside it, as the paper's hand has; 15° are 24 holes, which
/// put a preload within 0.13 rad.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Workshop {
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
    /// Springs of a joint.
    pub springs: u32,
    /// Angle between neighbouring holes for the fixed legs, rad.
    pub hole_pitch: f64,
    /// Diameter of the tendon, m.
    pub line: f64,
    /// Step in which groove radii are made, m.
    pub radius_step: f64,
    /// Between printed parts that move on each other, m; half of it around axles and legs.
    pub print_clearance: f64,
    /// The thinnest wall that the printer makes, m.
    pub wall: f64,
    /// Diameter of the pins between distal pulleys and their links, m.
    pub pin: f64,
    /// Thickness of the soft pads on the closing side of links, m.
    pub pad: f64,
    /// Density of the printed material, kg/m³.
    pub density: f64,
    /// Thickness of what is printed full on every side of a part, m; the rest is filled in part.
    pub shell: f64,
    /// By how much springs have to hold every joint open against its weight, N·m.
    pub droop_margin: f64,
}

impl Default for Workshop {
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
            print_clearance: 0.0002,
            wall: 0.0008,
            pin: 0.001,
            pad: 0.001,
            density: 1240.0,
            shell: 0.0008,
            droop_margin: 0.0005,
        }
    }
}

impl Settings for Workshop {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let mm = |lo: f64, hi: f64| lo * 1e-3..=hi * 1e-3;
        let length = Dimension::Length;
        fields.quantity("axle", &mut self.axle, length, mm(0.5, 20.0), "the pin of a joint, on which its springs sit");
        let meaning = "least play of a wound coil on the axle, as a share of the axle";
        fields.number("clearance", &mut self.clearance, 0.0..=1.0, meaning);
        let meaning = "room for the body of each spring along the axle";
        fields.quantity("spring_room", &mut self.spring_room, length, mm(1.0, 100.0), meaning);
        fields.quantity("coil_room", &mut self.coil_room, length, mm(2.0, 100.0), "room for a coil across the axle");
        let meaning = "most bending stress of a spring, as a share of its wire's strength";
        fields.number("stress_share", &mut self.stress_share, 0.05..=1.0, meaning);
        let mut springs = u64::from(self.springs);
        let meaning = "springs of a joint, on both sides of its pulley, wound left and right in turn";
        fields.integer("springs", &mut springs, 1..=4, meaning);
        self.springs = springs as u32;
        let limits = 1f64.to_radians()..=90f64.to_radians();
        let meaning = "angle between neighbouring holes for the fixed legs, a whole part of a circle";
        fields.quantity("hole_pitch", &mut self.hole_pitch, Dimension::Angle, limits, meaning);
        let holes = TAU / self.hole_pitch;
        let whole = !fields.sound(&["hole_pitch"]) || (holes - holes.round()).abs() < 1e-6;
        fields.check("hole_pitch", whole, || {
            let message =
                format!("{TABLE}.hole_pitch divides a circle into {holes:.2} parts, and they have to be whole");
            (message, "15, 18, 20, 22.5 and 24 deg do, for example".into())
        });
        let meaning = "diameter of the tendon; a pulley's radius is that of its groove and half of this";
        fields.quantity("line", &mut self.line, length, mm(0.05, 3.0), meaning);
        let meaning = "step in which groove radii are made";
        fields.quantity("radius_step", &mut self.radius_step, length, mm(0.001, 1.0), meaning);
        let meaning = "between printed parts that move on each other; half of it around axles and legs";
        fields.quantity("print_clearance", &mut self.print_clearance, length, mm(0.01, 1.0), meaning);
        fields.quantity("wall", &mut self.wall, length, mm(0.05, 3.0), "the thinnest wall that is printed");
        let meaning = "pins between distal pulleys and their links";
        fields.quantity("pin", &mut self.pin, length, mm(0.1, 5.0), meaning);
        let meaning = "the soft pads on the closing side of links";
        fields.quantity("pad", &mut self.pad, length, mm(0.0, 5.0), meaning);
        let meaning = "of what is printed; PLA has 1240, PETG 1270, ABS 1050 kg/m^3";
        fields.quantity("density", &mut self.density, Dimension::Density, 100.0..=10_000.0, meaning);
        let meaning = "what is printed full on every side of a part; the rest is filled in part";
        fields.quantity("shell", &mut self.shell, length, mm(0.1, 10.0), meaning);
        let meaning = "by how much springs have to hold every joint open against its weight, palm down";
        fields.quantity("droop_margin", &mut self.droop_margin, Dimension::Torque, 0.0..=0.1, meaning);
    }
}

impl Workshop {
    /// The default workshop with some figures set: `axle=3 mm`, as `--bench` has them. All faults are told at once.
    pub fn with(assignments: &[String]) -> Result<Self, Faults> {
        let mut layers = Layers::from_text("--bench", "")?;
        for given in assignments {
            let Some((key, value)) = given.split_once('=') else {
                let hint = "write it as KEY=VALUE, axle=\"3 mm\" for example".to_owned();
                return Err(Faults::single(
                    &format!("--bench {given}"),
                    "this sets nothing: it has no `=`".into(),
                    Some(hint),
                ));
            };
            layers = layers.with_option(format!("--bench {given}"), &format!("{TABLE}.{}", key.trim()), value.trim());
        }
        Self::read(&layers)
    }

    /// Whether every figure is within its limits: those of a file may not be. `place`: what a fault calls the file.
    pub fn check(&self, place: &str) -> Result<(), Faults> {
        let keys = written(&mut self.clone()).0;
        let layers = keys.iter().fold(Layers::from_text(place, "")?, |layers, (key, value)| {
            layers.with_option(place.to_owned(), &format!("{TABLE}.{key}"), &value.to_string())
        });
        Self::read(&layers).map(|_| ())
    }

    fn read(layers: &Layers) -> Result<Self, Faults> {
        let mut workshop = Self::default();
        let (table, reader) = (layers.overridden(""), layers.reader());
        let mut root = Section::root(&reader, &table);
        let mut section = reader.section(&mut root, TABLE);
        read(&mut workshop, &mut section);
        section.finish();
        root.finish();
        let mut faults = reader.into_errors();
        layers.tell(&[], &mut faults);
        faults.into_result().map(|()| workshop)
    }

    /// Holes on the circle.
    pub fn holes(&self) -> u32 {
        (TAU / self.hole_pitch).round() as u32
    }

    /// Radius of a printed hole for an axle, m.
    pub fn bore(&self) -> f64 {
        0.5 * (self.axle + 0.5 * self.print_clearance)
    }

    /// The least radius of a groove, m: there is a wall between it and the hole for the axle.
    pub fn least_groove(&self) -> f64 {
        self.bore() + self.wall
    }

    /// Radius of a printed hole for the leg of a spring, m.
    pub fn leg_hole(&self, spring: &SeatedSpring) -> f64 {
        0.5 * (spring.wire + self.print_clearance)
    }

    /// From the axle to the legs of a spring, m: beside the coil, clear of the axle, and so far out that there are walls between the
    /// holes.
    pub fn leg_circle(&self, spring: &SeatedSpring) -> f64 {
        let hole = self.leg_hole(spring);
        let beside = 0.5 * spring.outer + self.print_clearance + 0.5 * spring.wire;
        let apart = (2.0 * hole + self.wall) / (2.0 * (0.5 * self.hole_pitch).sin());
        beside.max(self.bore() + self.wall + hole).max(apart)
    }

    /// Springs of a joint on the side of positive x of its pulley, and on the other side.
    pub fn sides(&self) -> [u32; 2] {
        [self.springs.div_ceil(2), self.springs / 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(given: &[&str]) -> Result<Workshop, String> {
        Workshop::with(&given.iter().map(|&given| given.to_owned()).collect::<Vec<_>>()).map_err(|e| e.to_string())
    }

    #[test]
    fn figures_are_set_as_they_are_typed() {
        let given =
            ["axle=3 mm", "hole_pitch=\"10 deg\"", " springs = 1 ", "stress_share=0.5", "line=0.3mm", "wall=1 mm"];
        let set = with(&given).unwrap();
        let wanted = Workshop { axle: 0.003, springs: 1, stress_share: 0.5, line: 0.0003, wall: 0.001, ..set.clone() };
        assert_eq!((&set, set.holes(), set.sides()), (&wanted, 36, [1, 0]));
        assert_eq!(with(&[]).unwrap(), Workshop::default());
        assert_eq!(Workshop::default().sides(), [1, 1]);
    }

    /// What is wrong is told with its value, its limits and a way out, all of it at once.
    #[test]
    fn wrong_figures_are_told() {
        for (given, told) in [
            ("axle", "it has no `=`"),
            ("axel=3 mm", "did you mean `axle`?"),
            ("axle=3", "names no unit"),
            ("axle=300 mm", "bench.axle = \"300 mm\" is outside"),
            ("axle=nan mm", "bench.axle = \"nan mm\""),
            ("springs=1.5", "is not a whole number in [1, 4]"),
            ("springs=2 N", "is not a whole number in [1, 4]"),
            ("hole_pitch=17 deg", "divides a circle into 21.18 parts"),
        ] {
            let error = with(&[given]).unwrap_err();
            assert!(error.contains(told) && error.contains(&format!("--bench {given}")), "{given}: {error}");
            assert!(error.contains("= hint: ") || error.contains("[5e-4 m, 0.02 m]"), "{error}");
        }
        assert!(with(&["axle=300 mm", "line=9 mm"]).unwrap_err().ends_with("2 faults"));
    }

    /// Figures of a file come from anywhere: a pitch of nothing asked for holes without end.
    #[test]
    fn figures_of_a_file_are_checked() {
        assert_eq!(Workshop::default().check("parts.json"), Ok(()));
        let error = Workshop { hole_pitch: 1e-9, ..Workshop::default() }.check("parts.json").unwrap_err().to_string();
        assert!(error.contains("bench.hole_pitch") && error.contains("parts.json"), "{error}");
    }
}
