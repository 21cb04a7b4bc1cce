//! The parts list as a sheet for the bench: mm, N·mm/rad, degrees.

use std::collections::BTreeMap;
use std::fmt::Write;

use hwasp_runs::text::markdown;
use hwasp_training::{Change, Evaluation, MeanInterval};

use super::{JointDesign, JointParts, PartsList};

/// The sheet, Markdown.
pub fn build_sheet(list: &PartsList) -> String {
    let PartsList { experiment, method, seed, catalogue, .. } = list;
    let mut text = format!(
        "# Parts for {} ({method}, seed {seed})\n\nLengths are in mm, torques in N·mm, angles in degrees. Springs are \
         of the catalogue {} ({} springs).\n\n",
        markdown(experiment),
        markdown(&catalogue.name),
        catalogue.springs
    );
    text.push_str(&shopping(list));
    for joint in &list.joints {
        text.push_str(&joint_table(joint, list));
    }
    text.push_str(&mounting(list));
    text.push_str(&worth(list));
    if let Some(verdict) = &list.verdict {
        let _ = writeln!(text, "\n## Verdict: {}\n", if verdict.buildable { "buildable" } else { "not buildable" });
        for finding in &verdict.findings {
            let good = if finding.good { "good" } else { "**not good**" };
            let _ = writeln!(text, "- {}, {good}: {}", finding.what, markdown(&finding.told));
        }
    }
    text
}

/// `thumb_proximal` as a heading has it.
fn title(joint: &str) -> String {
    let words = joint.replace('_', " ");
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn shopping(list: &PartsList) -> String {
    let mut text = "## To get\n\n| what | how many | for |\n|---|---|---|\n".to_owned();
    let joints: u32 = list.joints.iter().map(|joint| joint.joints).sum();
    let mut springs: BTreeMap<&str, (u32, Vec<String>)> = BTreeMap::new();
    for joint in &list.joints {
        let (groove, name) = (joint.pulley.groove_radius, joint.joint.replace('_', " "));
        let _ = writeln!(text, "| pulley, groove radius {:.2} | {} | {name} |", 1e3 * groove, joint.joints);
        let (count, of) = springs.entry(&joint.spring.part).or_default();
        *count += joint.spring.count * joint.joints;
        of.push(name);
    }
    for (part, (count, of)) in springs {
        let _ = writeln!(text, "| spring {} | {count} | {} |", markdown(part), of.join(", "));
    }
    let _ = writeln!(text, "| axle of {:.2} | {joints} | every joint |", 1e3 * list.workshop.axle);
    let pins = 2 * list.joints.iter().filter(|j| j.joint.ends_with("distal")).map(|j| j.joints).sum::<u32>();
    let _ = writeln!(text, "| pin of {:.2} | {pins} | two in every distal pulley |", 1e3 * list.workshop.pin);
    let _ = writeln!(text, "| line of {:.2} | 3 | thumb and both fingers |", 1e3 * list.workshop.line);
    text
}

fn joint_table(joint: &JointParts, list: &PartsList) -> String {
    let JointParts { trained, built, pulley, spring, .. } = joint;
    let workshop = &list.workshop;
    let many = if joint.joints == 1 { String::new() } else { format!(", {} times", joint.joints) };
    let mut text = format!("\n## {}{many}\n\n| | trained | built |\n|---|---|---|\n", title(&joint.joint));
    let mut both = |what: &str, of: &dyn Fn(&JointDesign) -> f64, decimals: usize| {
        let _ = writeln!(text, "| {what} | {:.decimals$} | {:.decimals$} |", of(trained), of(built));
    };
    both("pulley radius, mm", &|d| 1e3 * d.radius, 3);
    let together = format!("spring rate, N·mm/rad ({} springs)", spring.count);
    both(&together, &|d| 1e3 * d.stiffness, 3);
    both("preload, degrees", &|d| d.preload.to_degrees(), 1);
    text.push_str("\n| part | |\n|---|---|\n");
    let mut row = |what: &str, value: String| {
        let _ = writeln!(text, "| {what} | {value} |");
    };
    row(
        "pulley",
        format!(
            "groove radius {:.2} (diameter {:.2}) for a line of {:.2}",
            1e3 * pulley.groove_radius,
            2e3 * pulley.groove_radius,
            1e3 * pulley.line
        ),
    );
    row("springs", format!("{} × {}", spring.count, markdown(&spring.part)));
    row("wire", format!("{:.2}", 1e3 * spring.wire));
    row("coil, free", format!("{:.2} outside, {:.2} inside", 1e3 * spring.outer, 1e3 * spring.inner));
    row("turns", format!("{:.2}", spring.turns));
    row("legs", format!("{:.0} long, {:.0}° apart when free", 1e3 * spring.leg, spring.leg_angle.to_degrees()));
    let circle = list.workshop.leg_circle(&spring.seated());
    row("legs, bent", format!("outwards to {:.2} from the middle of the axle, there along it", 1e3 * circle));
    row("rate of one", format!("{:.3} N·mm/rad", 1e3 * spring.rate));
    row("torque of one, joint closed", format!("{:.2} N·mm", 1e3 * spring.largest_torque));
    row(
        "stress, joint closed",
        format!("{:.0} MPa, {:.0} % of the wire's strength", 1e-6 * spring.stress, 100.0 * spring.stress_share),
    );
    row(
        "mandrel",
        format!("axle of {:.2}; the coil closes to {:.2} inside", 1e3 * workshop.axle, 1e3 * spring.inner_wound),
    );
    row(
        "body, joint closed",
        format!("{:.2} long, room for {:.2}", 1e3 * spring.length_wound, 1e3 * workshop.spring_room),
    );
    row(
        "hole of the fixed leg",
        format!(
            "no. {} of {} ({:.1}°)",
            spring.hole,
            workshop.holes(),
            (f64::from(spring.hole) * workshop.hole_pitch).to_degrees()
        ),
    );
    row("torque at the joint off by at most", format!("{:.2} N·mm", 1e3 * joint.torque_error));
    text
}

fn mounting(list: &PartsList) -> String {
    let workshop = &list.workshop;
    let turns = if workshop.springs > 1 {
        "The springs of a joint sit on both sides of its pulley, wound left and right in turn. "
    } else {
        ""
    };
    format!(
        "\n## Mounting\n\n{turns}Closing the joint winds a spring up. Its moving leg lies on the moving link, its fixed leg in a hole \
         of the other one. There are {} holes, {:.1}° apart, on a circle about the axle. Hole 0 lies where the moving leg lies with \
         the joint open; count from there against the direction in which the joint closes.\n",
        workshop.holes(),
        workshop.hole_pitch.to_degrees()
    )
}

fn worth(list: &PartsList) -> String {
    let worth = &list.worth;
    let mut text = format!(
        "\n## Worth, by simulation\n\n{} held-out episodes (seed {}), the same in every row, with 95 % intervals; changes are \
         against the first row, episode by episode.\n\n| | return | change | success | change |\n|---|---|---|---|---|\n",
        worth.trained.episodes, worth.trained.seed
    );
    let mut row = |what: &str, evaluation: &Evaluation, change: Option<&Change>| {
        let [of_return, of_success] = [
            change.map(|change| interval(&change.undiscounted_return, 1.0, 1)),
            change.and_then(|change| change.success.as_ref()).map(|success| interval(success, 100.0, 1)),
        ]
        .map(Option::unwrap_or_default);
        let success = evaluation.success.first().map_or(String::new(), |rate| {
            format!("{:.1} % [{:.1}, {:.1}]", 100.0 * rate.rate(), 100.0 * rate.low, 100.0 * rate.high)
        });
        let total = interval(&evaluation.undiscounted_return, 1.0, 1);
        let _ = writeln!(text, "| {what} | {total} | {of_return} | {success} | {of_success} |");
    };
    row("as trained", &worth.trained, None);
    row("on these parts", &worth.snapped, Some(&worth.snapping));
    if let Some(tuned) = &worth.tuned {
        let what = format!("on these parts, controller trained further for {} steps", tuned.env_steps);
        row(&what, &tuned.evaluation, Some(&tuned.change));
    }
    text
}

fn interval(figure: &MeanInterval, scale: f64, decimals: usize) -> String {
    format!("{:.decimals$}", figure.scaled(scale))
}
