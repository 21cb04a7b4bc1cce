//! The one verdict: whether a hand can be built, and why.

use std::fmt;

use hwasp_tasks::hand::names::{KINDS, LINK_PARTS};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};
use serde::{Deserialize, Serialize};

use crate::bodies::{LinkBody, link_bodies};
use crate::droop::{JointDroop, droop_of};
use crate::parts::{Part, parts};
use crate::workshop::{SeatedSpring, Workshop};

/// How far the mass of a link may be off the simulation's, as a share.
pub const MASS_SHARE: f64 = 0.05;
/// The thinnest wall that is taken for one, m: two lines of a nozzle of 0.4 mm.
pub const LEAST_WALL: f64 = 0.8e-3;
/// What a figure of a mesh may be off by.
const LAST_DIGITS: f64 = 1e-6;

/// A spring as it was chosen for a kind of joint.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedSpring {
    /// What it is ordered by.
    pub part: String,
    /// What its joint has to make room for.
    pub seated: SeatedSpring,
    /// Bending stress with the joint closed, as a share of the wire's strength.
    pub stress_share: f64,
}

/// One thing that was looked at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What: `droop`, `springs`, `walls`, `masses` or `parts`.
    pub what: String,
    /// Whether it is as it has to be.
    pub good: bool,
    /// In words, with values and limits.
    pub told: String,
}

impl Finding {
    fn new(what: &str, good: bool, told: String) -> Self {
        Self { what: what.to_owned(), good, told }
    }
}

/// Whether a hand can be built, and why.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// Whether everything is as it has to be.
    pub buildable: bool,
    /// What was looked at.
    pub findings: Vec<Finding>,
    /// The worst pose of each kind of joint; empty where parts cannot be made.
    pub droop: Vec<JointDroop>,
}

impl Verdict {
    fn of(findings: Vec<Finding>, droop: Vec<JointDroop>) -> Self {
        Self { buildable: findings.iter().all(|finding| finding.good), findings, droop }
    }

    /// The verdict on a hand that no parts were found for: what kept them from being chosen.
    pub fn without_parts(told: String) -> Self {
        Self::of(vec![Finding::new("parts", false, told)], Vec::new())
    }
}

impl fmt::Display for Verdict {
    /// A line for the verdict and one for each finding.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.buildable { "buildable" } else { "not buildable" })?;
        for Finding { what, good, told } in &self.findings {
            write!(f, "\n  {} {what}: {told}", if *good { "ok " } else { "NO " })?;
        }
        Ok(())
    }
}

/// The verdict on a hand with this design (SI, as its parts make it) and these springs at each of [`KINDS`], built in a workshop: whether
/// its parts can be made with walls that hold, weigh what was simulated and stay open, and whether its springs last.
pub fn verdict(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    springs: &[FittedSpring; 4],
    workshop: &Workshop,
) -> Verdict {
    let seated = springs.each_ref().map(|spring| spring.seated);
    let parts = match parts(hand, design, &seated, workshop) {
        Ok(parts) => parts,
        Err(error) => return Verdict::without_parts(error.to_string().replace('\n', ";")),
    };
    let bodies = link_bodies(hand, &parts, &seated, workshop);
    let droop = droop_of(hand, design, &bodies);
    let findings =
        vec![of_droop(&droop, workshop), of_springs(springs, workshop), of_walls(&parts, workshop), of_masses(&bodies)];
    Verdict::of(findings, droop)
}

fn of_droop(droop: &[JointDroop], workshop: &Workshop) -> Finding {
    let margins: Vec<String> =
        droop.iter().map(|joint| format!("{} {:+.2}", joint.joint, 1e3 * joint.margin())).collect();
    let wanted = workshop.droop_margin;
    let worst = droop.iter().find(|joint| joint.margin() < wanted);
    let way = worst.map_or(String::new(), |joint| {
        format!(
            "; {} falls shut at {:.2}, {:.2} rad: train with a stiffer spring or more preload there",
            joint.joint, joint.pose[0], joint.pose[1]
        )
    });
    let told = format!(
        "springs hold against the weight of the links, palm down, by N·mm: {}; at least {:.2} is wanted{way}",
        margins.join(", "),
        1e3 * wanted
    );
    Finding::new("droop", worst.is_none(), told)
}

fn of_springs(springs: &[FittedSpring; 4], workshop: &Workshop) -> Finding {
    let shares: Vec<String> = (KINDS.iter().zip(springs))
        .map(|(kind, spring)| format!("{kind} {:.0} %", 100.0 * spring.stress_share))
        .collect();
    let most = workshop.stress_share;
    let good = springs.iter().all(|spring| spring.stress_share <= most);
    let way = if good { "" } else { "; choose others: `hwasp parts RUN`, or a larger `coil_room` or `spring_room`" };
    let told = format!(
        "they fit, and are stressed to {} of their strength; at most {:.0} % is wanted{way}",
        shares.join(", "),
        100.0 * most
    );
    Finding::new("springs", good, told)
}

fn of_walls(parts: &[Part], workshop: &Workshop) -> Finding {
    let walls = parts.iter().map(|part| (part.name, part.thinnest_wall()));
    let thinnest = walls.min_by(|a, b| a.1.thickness.total_cmp(&b.1.thickness));
    let Some((part, wall)) = thinnest else {
        return Finding::new("walls", false, "there are no parts".to_owned());
    };
    let wanted = LEAST_WALL.max(workshop.wall);
    let good = wall.thickness > wanted - LAST_DIGITS;
    let [x, y, z] = wall.at.map(|at| 1e3 * at);
    let way = if good { "" } else { "; have a larger `wall`: `hwasp parts RUN --bench wall=…`" };
    let told = format!(
        "the thinnest has {:.2} mm, in {part} at {x:.1}, {y:.1}, {z:.1} mm; at least {:.2} mm is wanted{way}",
        1e3 * wall.thickness,
        1e3 * wanted
    );
    Finding::new("walls", good, told)
}

fn of_masses(bodies: &[LinkBody]) -> Finding {
    let told: Vec<String> = bodies
        .iter()
        .map(|body| {
            let (mass, simulated, fill) = (1e3 * body.weight.mass, 1e3 * body.simulated, 100.0 * body.infill);
            format!("{} {mass:.2} g of {simulated:.2} g with {fill:.0} % infill", LINK_PARTS[body.kind])
        })
        .collect();
    let good = bodies.iter().all(|body| body.off().abs() <= MASS_SHARE);
    let way = if good { "" } else { "; have another `shell` or `density`: `hwasp parts RUN --bench KEY=VALUE`" };
    let told = format!("links weigh {}; at most {:.0} % off is wanted{way}", told.join(", "), 100.0 * MASS_SHARE);
    Finding::new("masses", good, told)
}
