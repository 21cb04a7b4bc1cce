//! What the program says, as text.

pub(crate) mod check;
#[cfg(feature = "cluster")]
pub(crate) mod cluster;
pub(crate) mod design;
pub(crate) mod parts;

use std::fmt::Write;
use std::path::Path;

use hwasp_experiment::Experiment;
use hwasp_export::{ExportFile, Kind};
use hwasp_runs::text::{grouped, quantity};
use hwasp_runs::{Replay, Summary};
use hwasp_training::StandInKind;
use hwasp_training::stats::{Interval, LEAST_VALUES};
use hwasp_training::{Evaluation, MeanInterval};

/// An iteration that was repeated.
pub(crate) fn replay(replay: &Replay) -> String {
    let mut text = format!("iteration {}, after {} steps\n", replay.iteration, grouped(replay.env_steps));
    if let Some(fault) = &replay.fault {
        let _ = writeln!(text, "  then   {fault}");
    }
    let _ = match &replay.outcome {
        Ok(update) => {
            let told = |name| update.get(name).unwrap_or(f64::NAN);
            writeln!(text, "  now    it goes well: KL divergence {:.3e}, entropy {:.3}", told("kl"), told("entropy"))
        }
        Err(error) => writeln!(text, "  now    {error}"),
    };
    if let Some(same) = replay.same_batch {
        let _ = writeln!(text, "  the episodes are {}", if same { "the same to the bit" } else { "others than then" });
    }
    text
}

/// The result of a training.
pub(crate) fn training(summary: &Summary, path: &Path) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "\n{} · {} · seed {}: {} steps in {:.1} s ({} steps/s)\n",
        summary.experiment,
        summary.method,
        summary.seed,
        grouped(summary.env_steps),
        summary.wall_s,
        grouped(summary.steps_per_s as u64)
    );
    if let Some(steps) = summary.polish_steps {
        let _ = writeln!(
            text,
            "  the last {} of these steps polished the controller on the design as built\n",
            grouped(steps)
        );
    }
    if let Some(failed) = summary.failed_candidates.filter(|&failed| failed > 0) {
        let _ = writeln!(text, "  {} candidates failed and ranked last", grouped(failed));
        if let Some(first) = &summary.first_failure {
            let _ = writeln!(text, "  the first: {first}");
        }
        text.push('\n');
    }
    for (name, group) in &summary.design {
        let count = group.values.len();
        let unit = &group.unit;
        let of = if count == 1 { String::new() } else { format!(" in total over {count}") };
        let best = group.optimum.map_or(String::new(), |o| format!(" (best known {})", quantity(o, unit)));
        let _ = writeln!(text, "  {name:<10} {}{of}{best}", quantity(group.total_as_built, unit));
        if group.as_built != group.values {
            let trained = quantity(group.total, unit);
            let _ = writeln!(text, "  {:<10} trained as {trained}: the law says what is built of it", "");
        }
        if count > 1 {
            let values: Vec<String> = group.as_built.iter().take(10).map(|v| format!("{v:.4}")).collect();
            let more = if count > 10 { " …" } else { "" };
            let _ = writeln!(text, "  {:<10} {}{more}", "", values.join("  "));
        }
    }
    let _ = writeln!(text);
    text.push_str(&evaluation(&summary.evaluation, true, None));
    let _ = writeln!(
        text,
        "\n  {}: design.toml, policy.safetensors, curves.svg, metrics.csv, summary.json",
        path.display()
    );
    text
}

/// Under which values of `--set` a run is judged, as a first line; empty where there are none.
pub(crate) fn under(assignments: &[String]) -> String {
    let plain = |(key, value): (&str, &str)| format!("{} = {}", key.trim(), value.trim().trim_matches('"'));
    let set: Vec<String> = assignments.iter().filter_map(|set| set.split_once('=').map(plain)).collect();
    if set.is_empty() { String::new() } else { format!("  under {}:\n", set.join(", ")) }
}

/// The world that a run is judged in.
pub(crate) fn world(nearer: Option<StandInKind>) -> &'static str {
    match nearer {
        None => "hardware as built",
        Some(StandInKind::NativeTendons) => "native tendons",
        Some(StandInKind::FastLaw) => "law at the rate of the physics",
    }
}

/// An evaluation in a [`world`]; the rates of success of each kind of episode, an object's shape for one, only `per_kind`.
pub(crate) fn evaluation(evaluation: &Evaluation, per_kind: bool, nearer: Option<StandInKind>) -> String {
    let counted = evaluation.episodes - evaluation.discarded_episodes.min(evaluation.episodes);
    let line = |name: &str, m: &MeanInterval| {
        let interval = match m.interval {
            Some(Interval { low, high }) => format!("95 % interval [{low:.2}, {high:.2}]"),
            None if counted < LEAST_VALUES as u64 => {
                format!("no interval: {counted} of the {LEAST_VALUES} episodes that it takes")
            }
            None => "no interval: it is the same in all episodes".to_owned(),
        };
        format!("  {name:<20} {:>10.2}   {interval}\n", m.mean)
    };
    let mut text = format!(
        "  deterministic policy, {} held-out starts (seed {}), {}:\n",
        evaluation.episodes,
        evaluation.seed,
        world(nearer)
    );
    text.push_str(&line("discounted return", &evaluation.discounted_return));
    text.push_str(&line("return", &evaluation.undiscounted_return));
    for (term, mean) in &evaluation.terms {
        let _ = writeln!(text, "    {term:<18} {mean:>10.2}");
    }
    if let Some(ends) = &evaluation.ends {
        let _ = writeln!(
            text,
            "  {:<20} {:>10.2}   steps ({:.2} s); {ends}",
            "episode length", ends.mean_steps, ends.mean_s
        );
    }
    // The first is over all episodes.
    let shown = if per_kind { evaluation.success.len() } else { 1 };
    for rate in evaluation.success.iter().take(shown) {
        let name = if rate.kind == "all" { "success".to_owned() } else { format!("  {}", rate.kind) };
        let _ = writeln!(
            text,
            "  {name:<20} {:>9.1}%   {} of {}, 95 % interval [{:.1}, {:.1}]",
            100.0 * rate.rate(),
            rate.successes,
            rate.episodes,
            100.0 * rate.low,
            100.0 * rate.high
        );
    }
    if evaluation.success.len() > shown {
        let kinds = evaluation.success.len() - shown;
        let _ = writeln!(text, "  {:<20} --per-shape tells the rates of {kinds} kinds", "");
    }
    if evaluation.discarded_episodes > 0 {
        let _ = writeln!(text, "  {} episodes discarded: their physics failed", evaluation.discarded_episodes);
    }
    text
}

/// What was exported, and what there is not of this run.
pub(crate) fn exported(spec: &Experiment, out: &Path, files: &[ExportFile], left_out: &[Kind]) -> String {
    let (name, method, seed) = (&spec.name, spec.method.name(), spec.seed);
    let mut text = format!("{name} · {method} · seed {seed}, into {}:\n", out.display());
    for ExportFile { name, contents } in files {
        let _ = writeln!(text, "  {name:<26} {:>9.1} kB", contents.len() as f64 / 1e3);
    }
    if !left_out.is_empty() {
        let kinds: Vec<&str> = left_out.iter().map(|kind| kind.name()).collect();
        let _ = writeln!(text, "  without {}: {} has none", kinds.join(", "), spec.task.name());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    use hwasp_training::{Ends, SuccessRate};

    /// An evaluation whose success was counted by these kinds.
    fn counted(kinds: &[&str]) -> Evaluation {
        let figure = MeanInterval { mean: 1.0, interval: Some(Interval { low: 0.5, high: 1.5 }) };
        let rate = |kind: &&str| SuccessRate { kind: (*kind).into(), successes: 3, episodes: 4, low: 0.3, high: 0.95 };
        Evaluation {
            episodes: 4,
            seed: 9,
            discounted_return: figure,
            undiscounted_return: figure,
            median_discounted_return: 1.0,
            worst_discounted_return: 0.0,
            discarded_episodes: 0,
            ends: None,
            success: kinds.iter().map(rate).collect(),
            terms: [].into(),
        }
    }

    #[test]
    fn rates_of_shapes_are_told_if_asked_for() {
        let hand = counted(&["all", "box", "sphere"]);
        let lines = |per_kind| -> Vec<String> {
            let text = evaluation(&hand, per_kind, None);
            text.lines().skip(3).map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
        };
        let rate = "75.0% 3 of 4, 95 % interval [30.0, 95.0]";
        assert_eq!(lines(true), [format!("success {rate}"), format!("box {rate}"), format!("sphere {rate}")]);
        assert_eq!(lines(false), [format!("success {rate}"), "--per-shape tells the rates of 2 kinds".into()]);
    }

    #[test]
    fn tasks_without_success_say_nothing_of_it() {
        let gear = counted(&[]);
        assert_eq!(evaluation(&gear, false, None), evaluation(&gear, true, None));
        assert_eq!(evaluation(&gear, true, None).lines().count(), 3);
    }

    /// Nothing told how long episodes are, nor why they end: a hopper that falls at once looked like one that hops.
    #[test]
    fn episodes_are_told_with_their_length_and_their_ends() {
        let ends = |time_limit, named: &[(&str, u64)]| {
            let named: BTreeMap<String, u64> = named.iter().map(|&(name, n)| (name.to_owned(), n)).collect();
            let ends = Ends { mean_steps: 412.5, mean_s: 3.3, time_limit, before: 4 - time_limit, named };
            let text = evaluation(&Evaluation { ends: Some(ends), ..counted(&[]) }, false, None);
            text.lines().last().map(str::to_owned).unwrap_or_default()
        };
        let line = "  episode length           412.50   steps (3.30 s); ";
        assert_eq!(ends(4, &[]), format!("{line}all ran to the time limit"));
        let some = "1 of 4 ran to the time limit, 3 ended before it (fallen 2, tilted 1)";
        assert_eq!(ends(1, &[("fallen", 2), ("tilted", 1)]), format!("{line}{some}"));
        assert_eq!(ends(0, &[]), format!("{line}all ended before the time limit"));
    }

    #[test]
    fn the_terms_of_the_reward_stand_below_their_sum() {
        let named =
            Evaluation { terms: [("effort".to_owned(), -0.25), ("forward".to_owned(), 1.25)].into(), ..counted(&[]) };
        let text = evaluation(&named, false, None);
        assert_eq!(
            text.lines().skip(3).collect::<Vec<_>>(),
            ["    effort                  -0.25", "    forward                  1.25"]
        );
    }
}
