//! The sensitivities as files and programs have them. Everything is in SI units.

use hwasp_core::unit;
use hwasp_runs::text::ReadableUnit;
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
    /// What follows, in a sentence: what has to be made precisely; or, where no error lowers the return, which way it rises.
    pub fn verdict(&self) -> String {
        let names = |parameters: &[&Sensitivity]| {
            parameters.iter().take(NAMED).map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ")
        };
        let costly: Vec<&Sensitivity> = self.parameters.iter().filter(|parameter| parameter.loss > 0.0).collect();
        if !costly.is_empty() {
            return format!("To be made precisely first: {}.", names(&costly));
        }
        let mut gains: Vec<(f64, &str, &str)> = (self.parameters.iter())
            .flat_map(|parameter| {
                let gain = |side: &Side| side.change.undiscounted_return.mean;
                let name = parameter.name.as_str();
                [(gain(&parameter.minus), "smaller", name), (gain(&parameter.plus), "larger", name)]
            })
            .filter(|(gain, ..)| *gain > 0.0)
            .collect();
        gains.sort_by(|a, b| b.0.total_cmp(&a.0));
        if gains.is_empty() {
            return "No error changes the return.".to_owned();
        }
        let gains = gains.iter().take(NAMED).map(|(gain, way, name)| format!("{name} {way} (+{gain:.1})"));
        format!(
            "No error lowers the return: the design is no local optimum. What raises it most: {}.",
            gains.collect::<Vec<_>>().join(", ")
        )
    }
}

impl Sensitivity {
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

    fn sensitivity(name: &str, minus: f64, plus: f64) -> Sensitivity {
        let interval = |mean: f64| Interval { low: mean - 1.0, high: mean + 1.0 };
        let figure = |mean: f64| MeanInterval { mean, interval: Some(interval(mean)) };
        let side = |value: f64, mean: f64| Side {
            value,
            undiscounted_return: figure(10.0 + mean),
            success: None,
            change: Change { episodes: 4, undiscounted_return: figure(mean), success: None },
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

    /// `0.00663 m -0.1 mm` was one figure in two units.
    #[test]
    fn a_parameter_and_its_error_are_told_in_one_unit() {
        let parameter = sensitivity("radius", -1.0, 2.0);
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
        let verdict = |of: &[(f64, f64)]| {
            let of = of.iter().zip(["a", "b", "c", "d"]);
            let mut list = Sensitivities {
                experiment: String::new(),
                method: String::new(),
                task: String::new(),
                seed: 0,
                nominal: serde_json::from_str(NOMINAL).unwrap(),
                parameters: of.map(|(&(minus, plus), name)| sensitivity(name, minus, plus)).collect(),
            };
            list.parameters.sort_by(|a, b| b.loss.total_cmp(&a.loss));
            list.verdict()
        };
        assert_eq!(verdict(&[(-1.0, 2.0), (0.5, -3.0)]), "To be made precisely first: b, a.");
        let told = verdict(&[(1.0, 2.0), (0.5, 0.0), (4.0, 0.0)]);
        assert!(told.starts_with("No error lowers the return: the design is no local optimum."), "{told}");
        assert!(told.ends_with("What raises it most: c smaller (+4.0), a larger (+2.0), a smaller (+1.0)."), "{told}");
        assert_eq!(verdict(&[(0.0, 0.0)]), "No error changes the return.");
    }

    const NOMINAL: &str = r#"{ "episodes": 4, "seed": 1, "discarded_episodes": 0, "success": [],
        "discounted_return": { "mean": 1.0, "low": 0.0, "high": 2.0 }, "return": { "mean": 1.0, "low": 0.0, "high": 2.0 },
        "median_discounted_return": 1.0, "worst_discounted_return": 1.0 }"#;
}
