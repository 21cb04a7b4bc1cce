//! A design as text.

use std::fmt::Write;

use hwasp_runs::text::ReadableUnit;
use hwasp_workshop::design::{
    ClosingPoint, DesignReport, DigitPair, GroupReport, HandJudgements, HandReport, JointReport,
};
use hwasp_workshop::parts::Verdict;

/// Travel between the printed rows of free closing, mm.
const ROWS_EVERY: usize = 4;

/// What can be said of a run's design without simulating it.
pub(crate) fn design(report: &DesignReport, verdict: Option<&Verdict>) -> String {
    let mut text = format!("\n{} · {} · seed {}: the design\n\n", report.experiment, report.method, report.seed);
    let widest = report.groups.iter().map(|g| g.name.len()).max().unwrap_or(0).max("as trained".len());
    for group in &report.groups {
        text.push_str(&if group.position.len() == 1 { one(group, widest) } else { many(group, widest) });
    }
    if let Some(limits) = &report.judged {
        let _ = writeln!(text, "  {limits}");
    }
    if let Some(hand) = &report.hand {
        let HandJudgements { open, pinch, closing: closes } = &hand.judged;
        for (block, judged) in [(transmission(hand), open), (pinches(hand), pinch), (closing(hand), closes)] {
            let _ = writeln!(text, "{block}  {judged}");
        }
    }
    if let Some(verdict) = verdict {
        let _ = writeln!(text, "\n  {}", verdict.to_string().replace('\n', "\n  "));
    }
    text
}

/// A group of one parameter.
fn one(report: &GroupReport, widest: usize) -> String {
    let group = &report.group;
    let shown = ReadableUnit::of(group);
    let (lo, hi) = (shown.short(group.limits[0]), shown.with_unit(group.limits[1]));
    let mut text = format!(
        "  {:<widest$}  {:>16}   {:>5.1} % of the way from {lo} to {hi}{}\n",
        report.name,
        shown.long(group.as_built[0]),
        100.0 * report.position[0],
        best(report, &shown)
    );
    if group.as_built != group.values {
        let _ = writeln!(text, "  {:<widest$}  {:>16}   as trained", "", shown.long(group.values[0]));
    }
    text
}

/// A group of like parameters: what they are together, and their range.
fn many(report: &GroupReport, widest: usize) -> String {
    let group = &report.group;
    let shown = ReadableUnit::of(group);
    let (lo, hi) = (shown.short(group.limits[0]), shown.with_unit(group.limits[1]));
    let count = group.values.len();
    let line = |name: &str, total: f64, values: &[f64], more: &str| {
        let (least, most) = ends(values);
        let (least, most) = (shown.short(least), shown.long(most));
        format!("  {name:<widest$}  {} in total over {count}, each {least} to {most}{more}\n", shown.long(total))
    };
    let mut text = line(&report.name, group.total_as_built, &group.as_built, &best(report, &shown));
    if group.as_built != group.values {
        let why = ": the law says what is built of it";
        text.push_str(&line("as trained", group.total, &group.values, why));
    }
    let (least, most) = ends(&report.position);
    let (least, most) = (100.0 * least, 100.0 * most);
    let _ = writeln!(text, "  {:<widest$}  at {least:.1} to {most:.1} % of the way from {lo} to {hi}", "");
    text
}

fn best(report: &GroupReport, shown: &ReadableUnit) -> String {
    report.group.optimum.map_or(String::new(), |best| format!(" (best known {})", shown.long(best)))
}

fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &v| (lo.min(v), hi.max(v)))
}

/// The twelve as a table, beside the paper's two hands, and whether springs hold the digits open.
fn transmission(hand: &HandReport) -> String {
    let mut text = format!("\n  {:<24}", "transmission");
    let row = |name: &str, cells: [String; 4]| {
        let cells: Vec<String> = cells.iter().map(|cell| format!("{cell:>17}")).collect();
        format!("  {name:<24}{}\n", cells.concat())
    };
    let figures = |name: &str, figure: &dyn Fn(&JointReport) -> f64, decimals: usize| {
        let cell = |i: usize| hand.joints.get(i).map_or(String::new(), |joint| format!("{:.decimals$}", figure(joint)));
        row(name, [0, 1, 2, 3].map(cell))
    };
    for joint in &hand.joints {
        let _ = write!(text, "{:>17}", joint.joint.replace('_', " "));
    }
    text.push('\n');
    for (i, (name, per_si)) in
        [("radius, mm", 1e3), ("stiffness, N·mm/rad", 1e3), ("preload, rad", 1.0)].iter().enumerate()
    {
        text.push_str(&figures(name, &|j| per_si * j.design[i], 2));
        text.push_str(&figures("  the paper's HWasP", &|j| per_si * j.paper_hwasp[i], 1));
        text.push_str(&figures("  the paper's Minimal", &|j| per_si * j.paper_minimal[i], 1));
    }
    text.push_str("\n  open, palm down\n");
    text.push_str(&figures("spring opens, N·mm", &|j| 1e3 * j.spring, 2));
    text.push_str(&figures("weight closes, N·mm", &|j| 1e3 * j.weight, 2));
    text.push_str(&figures("margin, N·mm", &|j| 1e3 * j.margin, 2));
    let fate = |open: bool| if open { "stays open" } else { "droops shut" };
    let DigitPair { thumb, finger } = hand.stays_open;
    let _ = writeln!(text, "  the thumb {}, each finger {}", fate(thumb), fate(finger));
    text
}

/// What the fingertips can hold.
fn pinches(hand: &HandReport) -> String {
    let limit = hand.tension_limit;
    let mut text = format!(
        "\n  pinch by the fingertips (friction 0.5, 1.5 times the weight; an embracing grasp takes less than half of it)\n  \
         {:<9}{:>24}{:>9}{:>9}{:>18}{:>26}\n",
        "width",
        "torque ratio that holds",
        "thumb",
        "finger",
        format!("lifts at {limit:.0} N"),
        "500 g takes"
    );
    let ratio = |ratio: Option<f64>| ratio.map_or("none".to_owned(), |ratio| format!("{ratio:.2}"));
    for pinch in &hand.pinches {
        let band = pinch.band.map_or("out of reach".to_owned(), |band| format!("{:.2} to {:.2}", band.lo, band.hi));
        let DigitPair { thumb, finger } = pinch.torque_ratio;
        let lifts = pinch.capacity.map_or(String::new(), |mass| format!("{:.0} g", 1e3 * mass));
        let takes = pinch
            .heaviest
            .map_or(String::new(), |needs| format!("{:.0} N ({:.2} N·m)", needs.total, needs.motor_torque));
        let width = format!("{:.0} mm", 1e3 * pinch.width);
        let (thumb, finger) = (ratio(thumb), ratio(finger));
        let _ = writeln!(text, "  {width:<9}{band:>24}{thumb:>9}{finger:>9}{lifts:>18}{takes:>26}");
    }
    let DigitPair { thumb, finger } = hand.pulley_ratio;
    let _ = writeln!(
        text,
        "  The ratio is that of proximal to distal torque; the design's, springs included, with {:.0} N in each tendon. Of its\n  \
         pulleys alone: thumb {thumb:.2}, finger {finger:.2}. Below the band the distal links curl in, above it they are pushed out.",
        limit / 3.0
    );
    text
}

/// A few rows of the closing chart.
fn closing(hand: &HandReport) -> String {
    let last = hand.closing.len().saturating_sub(1);
    let mut text = format!(
        "\n  free closing: joint angles in degrees (proximal, distal) and tension\n  {:<12}{:>16}{:>10}{:>20}{:>10}{:>14}\n",
        "wound", "thumb", "", "each finger", "", "three tendons"
    );
    for (i, point) in hand.closing.iter().enumerate().filter(|(i, _)| i % ROWS_EVERY == 0 || *i == last) {
        // The last row is the end itself, unless that lies on a whole millimetre.
        let decimals = usize::from(i == last);
        let ClosingPoint { travel, thumb, finger, total_tension } = point;
        let angles = |angles: [f64; 2]| format!("{:>7.1}{:>7.1}", angles[0].to_degrees(), angles[1].to_degrees());
        let newtons = |tension: f64| format!("{tension:.1} N");
        let _ = writeln!(
            text,
            "  {:<12}{:>16}{:>10}{:>20}{:>10}{:>14}",
            format!("{:.decimals$} mm", 1e3 * travel),
            angles(thumb.angles),
            newtons(thumb.tension),
            angles(finger.angles),
            newtons(finger.tension),
            newtons(*total_tension)
        );
    }
    text
}
