//! The sensitivities as files and programs have them. Everything is in SI units.

use hwasp_core::unit;
use hwasp_runs::text::ReadableUnit;
use hwasp_training::stats::LEAST_VALUES;
use hwasp_training::{Change, Evaluation, MeanInterval, SuccessRate};
use serde::{Deserialize, Serialize};

/// The sensitivities of a design: `tolerances.json`. SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensitivities {
    /// The experiment.
    pub experiment: String,
    /// How learner, controller and hardware were composed.
    pub method: String,
    /// The problem.
    pub task: String,
    /// The root seed of the run.
    pub seed: u64,
    /// The design as it should be built.
    pub nominal: Evaluation,
    /// Its parameters, the one whose error costs most return first.
    pub parameters: Vec<Sensitivity>,
}

/// What an error of one parameter does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// The parameter.
    pub name: String,
    /// The SI unit of its values.
    pub unit: String,
    /// As it should be built.
    pub nominal: f64,
    /// The manufacturing error, to either side.
    pub error: f64,
    /// The error as it was given: `5 %`, `0.1 mm`.
    pub error_text: String,
    /// Too small by the error.
    pub minus: Side,
    /// Too large by it.
    pub plus: Side,
    /// What the worse of both costs of the mean return; 0 where neither costs anything.
    pub loss: f64,
}

/// The design with one parameter off.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Side {
    /// The parameter's value.
    pub value: f64,
    /// Undiscounted return.
    #[serde(rename = "return")]
    pub undiscounted_return: MeanInterval,
    /// Success, for tasks that know it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub success: Option<SuccessRate>,
    /// From the nominal design to this one, episode by episode.
    pub change: Change,
}

/// How many parameters a sentence names.
const NAMED: usize = 3;

impl Sensitivities {
    /// What follows, in sentences: what has to be made precisely; and where some error raises the return, that the design is no local
    /// optimum, and by how much it could be better. Only changes count whose interval leaves out 0; where there are none, it says why
    /// nothing follows.
    pub fn verdict(&self) -> String {
        let mut costly: Vec<(f64, &str)> = (self.parameters.iter())
            .filter_map(|p| Some((p.sides().filter(|side| side.lowers()).map(Side::mean).reduce(f64::min)?, &*p.name)))
            .collect();
        costly.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut gains: Vec<(&Side, &str, &str)> = (self.parameters.iter())
            .flat_map(|p| ["smaller", "larger"].into_iter().zip(p.sides()).map(|(way, side)| (side, way, &*p.name)))
            .filter(|(side, ..)| side.raises())
            .collect();
        gains.sort_by(|a, b| b.0.mean().total_cmp(&a.0.mean()));
        if costly.is_empty() && gains.is_empty() {
            return self.undecided();
        }
        let mut told = Vec::new();
        if !costly.is_empty() {
            let names: Vec<&str> = costly.iter().take(NAMED).map(|(_, name)| *name).collect();
            told.push(format!("To be made precisely first: {}.", names.join(", ")));
        }
        if !gains.is_empty() {
            let every = self.parameters.iter().flat_map(Sensitivity::sides).all(|side| side.mean() > 0.0);
            let some = if every { "Every error raised the return" } else { "Some errors raised the return" };
            let gain = |(side, way, name): &(&Side, &str, &str)| {
                format!("{name} {way} by {:.1}", side.change.undiscounted_return)
            };
            let most: Vec<String> = gains.iter().take(NAMED).map(gain).collect();
            told.push(format!("{some}: the design is no local optimum. What raised it most: {}.", most.join(", ")));
        }
        told.join(" ")
    }

    /// Why nothing follows.
    fn undecided(&self) -> String {
        let changes = || self.parameters.iter().flat_map(Sensitivity::sides).map(|side| &side.change);
        let fewest = changes().map(|change| change.episodes).min().unwrap_or(0);
        if fewest < LEAST_VALUES as u64 {
            let episodes = if fewest == 1 { "episode does" } else { "episodes do" };
            return format!(
                "{fewest} {episodes} not tell which part has to be precise: that takes {LEAST_VALUES}, and better more."
            );
        }
        if self.parameters.iter().flat_map(Sensitivity::sides).all(|side| side.mean() == 0.0) {
            return "No error changes the return.".to_owned();
        }
        if changes().all(|change| change.undiscounted_return.interval.is_some()) {
            return "No error changes the return by more than chance does: more episodes may tell.".to_owned();
        }
        "Changes that are the same in all episodes have no interval: nothing is sure of them.".to_owned()
    }
}

impl Side {
    /// The mean change of the return.
    fn mean(&self) -> f64 {
        self.change.undiscounted_return.mean
    }

    /// Whether it is sure that it costs something.
    fn lowers(&self) -> bool {
        self.change.undiscounted_return.interval.is_some_and(|interval| interval.high < 0.0)
    }

    /// Whether it is sure that it gains something.
    fn raises(&self) -> bool {
        self.change.undiscounted_return.interval.is_some_and(|interval| interval.low > 0.0)
    }
}

impl Sensitivity {
    /// Too small, and too large.
    fn sides(&self) -> impl Iterator<Item = &Side> {
        [&self.minus, &self.plus].into_iter()
    }

    /// The parameter as it should be built, in a unit that reads well.
    pub fn designed(&self) -> String {
        self.told(self.nominal)
    }

    /// The error: a share as it was given, a quantity in the unit of the parameter.
    pub fn off_by(&self) -> String {
        if self.error_text.ends_with('%') { self.error_text.clone() } else { self.told(self.error) }
    }

    /// What was simulated on a side, in the same unit.
    pub fn simulated(&self, side: &Side) -> String {
        self.told(side.value)
    }

    fn told(&self, value: f64) -> String {
        readable(value, self.nominal, &self.unit)
    }
}

/// A value with its unit, four figures of it, in the unit in which another value reads well.
pub(super) fn readable(value: f64, other: f64, si: &str) -> String {
    let shown = unit(si).map(|unit| unit.readable(other));
    let (symbol, to_si) = shown.map_or((si, 1.0), |unit| (unit.symbol, unit.to_si));
    ReadableUnit { unit: symbol.to_owned(), to_si }.with_unit(significant(value / to_si) * to_si)
}

/// To four figures.
fn significant(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let unit = 10f64.powi(value.abs().log10().floor() as i32 - 3);
    (value / unit).round() * unit
}

#[cfg(test)]
mod tests {
    use hwasp_training::stats::Interval;

    use super::*;

    /// Changes of the return with intervals of this much to either side; none of less than four episodes.
    fn varied(name: &str, [minus, plus]: [f64; 2], spread: f64, episodes: u64) -> Sensitivity {
        let interval = |mean: f64| Interval { low: mean - spread, high: mean + spread };
        let figure = |mean: f64| MeanInterval { mean, interval: (episodes >= 4).then(|| interval(mean)) };
        let side = |value: f64, mean: f64| Side {
            value,
            undiscounted_return: figure(10.0 + mean),
            success: None,
            change: Change { episodes, undiscounted_return: figure(mean), success: None },
        };
        Sensitivity {
            name: name.to_owned(),
            unit: "m".to_owned(),
            nominal: 0.006_630_4,
            error: 0.000_1,
            error_text: "0.0001 m".to_owned(),
            minus: side(0.006_530_4, minus),
            plus: side(0.006_730_4, plus),
            loss: (-minus.min(plus)).max(0.0),
        }
    }

    fn verdict(mut parameters: Vec<Sensitivity>) -> String {
        parameters.sort_by(|a, b| b.loss.total_cmp(&a.loss));
        let list = Sensitivities {
            experiment: String::new(),
            method: String::new(),
            task: String::new(),
            seed: 0,
            nominal: serde_json::from_str(NOMINAL).unwrap(),
            parameters,
        };
        list.verdict()
    }

    /// `0.00663 m -0.1 mm` was one figure in two units.
    #[test]
    fn a_parameter_and_its_error_are_told_in_one_unit() {
        let parameter = varied("radius", [-1.0, 2.0], 1.0, 4);
        assert_eq!(
            (&*parameter.designed(), &*parameter.off_by(), &*parameter.simulated(&parameter.minus)),
            ("6.63 mm", "0.1 mm", "6.53 mm")
        );
        let share = Sensitivity { error_text: "5 %".into(), ..parameter };
        assert_eq!(share.off_by(), "5 %");
        assert_eq!((&*readable(-0.1, 0.03, "rad"), &*readable(1.3041, 1.3, "")), ("-0.1 rad", "1.304"));
        assert_eq!((&*readable(104.72, 100.0, "N/m"), &*readable(0.0, 0.0, "m")), ("104.7 N/m", "0 mm"));
    }

    /// Where every error raised the return, "No error costs anything" called a design perfect that was only unfinished.
    #[test]
    fn a_design_that_errors_improve_is_no_optimum() {
        let told = |of: &[[f64; 2]]| {
            let names = ["a", "b", "c", "d"];
            verdict(of.iter().zip(names).map(|(&changes, name)| varied(name, changes, 0.2, 4)).collect())
        };
        assert_eq!(told(&[[-1.0, 0.1], [0.1, -3.0]]), "To be made precisely first: b, a.");
        assert_eq!(
            told(&[[1.0, 2.0], [0.5, 0.1], [4.0, 0.1]]),
            "Every error raised the return: the design is no local optimum. What raised it most: c smaller by 4.0 [3.8, 4.2], a \
             larger by 2.0 [1.8, 2.2], a smaller by 1.0 [0.8, 1.2]."
        );
        // What has to be precise in one way may be better the other way.
        assert_eq!(
            told(&[[-1.0, 2.0], [0.1, 0.0]]),
            "To be made precisely first: a. Some errors raised the return: the design is no local optimum. What raised it most: a \
             larger by 2.0 [1.8, 2.2]."
        );
    }

    /// One episode was enough for "To be made precisely first: gear." or "the design is no local optimum".
    #[test]
    fn nothing_follows_from_what_has_no_interval_or_one_with_0() {
        for changes in [[-1.0, 2.0], [3.0, 2.0], [-1.0, -2.0], [0.0, 0.0]] {
            assert_eq!(
                verdict(vec![varied("gear", changes, 0.2, 1)]),
                "1 episode does not tell which part has to be precise: that takes 4, and better more."
            );
            assert!(verdict(vec![varied("gear", changes, 0.2, 3)]).starts_with("3 episodes do not tell"));
            assert_eq!(
                verdict(vec![varied("gear", changes, 5.0, 4)]),
                if changes == [0.0, 0.0] {
                    "No error changes the return."
                } else {
                    "No error changes the return by more than chance does: more episodes may tell."
                }
            );
        }
        // Of several, those count that are sure, and of both sides the one that is.
        let mut half = varied("d", [-1.5, -8.0], 1.0, 8);
        half.plus.change.undiscounted_return.interval = Some(Interval { low: -17.0, high: 1.0 });
        let mixed = vec![
            varied("a", [-9.0, 1.0], 10.0, 8),
            varied("b", [-2.0, 0.0], 1.0, 8),
            varied("c", [5.0, 5.0], 1.0, 8),
            half,
        ];
        assert_eq!(
            verdict(mixed),
            "To be made precisely first: b, d. Some errors raised the return: the design is no local optimum. What raised it most: c \
             smaller by 5.0 [4.0, 6.0], c larger by 5.0 [4.0, 6.0]."
        );
        // All episodes alike.
        let mut alike = varied("a", [-1.0, 0.0], 0.2, 8);
        for side in [&mut alike.minus, &mut alike.plus] {
            side.change.undiscounted_return.interval = None;
        }
        assert_eq!(
            verdict(vec![alike]),
            "Changes that are the same in all episodes have no interval: nothing is sure of them."
        );
    }

    const NOMINAL: &str = r#"{ "episodes": 4, "seed": 1, "discarded_episodes": 0, "success": [],
        "discounted_return": { "mean": 1.0, "low": 0.0, "high": 2.0 }, "return": { "mean": 1.0, "low": 0.0, "high": 2.0 },
        "median_discounted_return": 1.0, "worst_discounted_return": 1.0 }"#;
}
