//! From logs to what a built hand differs by: the simulation is fitted to what was logged, by CMA-ES.

use hwasp_algos::{Cmaes, CmaesConfig, Search};
use hwasp_core::Executor;
use hwasp_emulators::hand::Planted;
use hwasp_export::Deployed;

use crate::controller::hand;
use crate::error::DeployError;
use crate::log::{Logged, Row};
use crate::replay::{Pair, Simulation, of_phase, of_this_hand};

/// What a hand differs by, and how well that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Identified {
    /// Torque per current as a multiple of the data sheet's.
    pub torque_gain: f64,
    /// Of each tendon, N/m.
    pub tendon_stiffness: f64,
    /// Of motor and spool, N·m.
    pub friction: f64,
    /// From the motor's goal to the spool, s.
    pub delay: f64,
    /// Tendon that is wound before any pulls, m.
    pub slack: f64,
    /// Root of the mean square of what is left: wound, m, and current, A.
    pub left: [f64; 2],
    /// The same before the fit.
    pub before: [f64; 2],
    /// Whether the logs tell torque per current from stiffness and friction. Where springs hardly pull they do not: a hand that is
    /// stiffer by a factor, with more friction and a stronger motor, draws the same current.
    pub gain_is_told: bool,
}

/// What counts as one unit of difference: wound, m, and current, A. About what noise and a simulation's error are.
const UNITS: [f64; 2] = [1e-4, 2e-3];
/// Numbers of the fit: logarithms of gain and stiffness, then friction, delay and slack in these units.
const FITTED: usize = 5;
const SCALES: [f64; 3] = [0.05, 0.05, 2e-3];
const LOWER: [f64; FITTED] = [-1.0, -1.6, 0.0, 0.0, 0.0];
const UPPER: [f64; FITTED] = [1.0, 1.6, 6.0, 3.0, 5.0];
const BEGIN: [f64; FITTED] = [0.0, 0.0, 0.3, 0.3, 0.1];

/// How much what was calibrated counts, and how far the logarithm of a gain is from it.
const PRIOR: f64 = 0.01;
const WIDTH: f64 = 0.1;
/// A hand that is so much stronger in everything has to leave so much more of a difference, if logs tell the gain.
const STRONGER: f64 = 1.2;
const AGAINST: f64 = 1.2;

fn planted(x: &[f64], stiffness: f64) -> Planted {
    Planted {
        torque_gain: x[0].exp(),
        tendon_stiffness: Some(stiffness * x[1].exp()),
        friction: SCALES[0] * x[2],
        delay: SCALES[1] * x[3],
        slack: SCALES[2] * x[4],
        zero: 0.0,
    }
}

/// Part of a log: the closing and opening in the air before a grasp. What is grasped nobody has weighed, and it would only mislead.
struct Stretch<'l> {
    rows: &'l [Row],
    simulation: Simulation,
    per_ampere: f64,
}

/// Fits the hand of a run to logs. `told` hears of each generation: how many there are, and what is left, in units.
///
/// # Errors
/// Where the logs have no grasp, or are of another hand.
pub fn identify(
    logs: &[Logged],
    deployed: &Deployed,
    generations: u32,
    executor: &dyn Executor,
    told: &mut dyn FnMut(u32, f64),
) -> Result<Identified, DeployError> {
    let nominal = hand(deployed.spec())?.transmission.tendon_stiffness;
    let mut stretches = Vec::new();
    for logged in logs {
        of_this_hand(logged, deployed)?;
        if logged.about.what == "shadow" {
            return Err(DeployError::Fit {
                what: "a log of a shadow run tells nothing of the hand, for nothing moved".to_owned(),
                hint: "name logs of runs in which it grasped",
            });
        }
        for (&episode, &object) in &logged.episodes {
            let per_ampere = logged.about.torque_per_current;
            // Closing and opening in the air: there the springs are all that pulls, and friction is with the one and against the other.
            let rows = of_phase(logged, episode, "measure");
            if !rows.is_empty() {
                stretches.push(Stretch {
                    rows,
                    simulation: Simulation::new(deployed, object, logged.about.winding_sign)?,
                    per_ampere,
                });
            }
        }
    }
    if stretches.is_empty() {
        return Err(DeployError::Fit {
            what: "no log has a closing in the air, with which each grasp begins".to_owned(),
            hint: "name logs of `hwasp deploy run`, five grasps at least",
        });
    }
    let left = |planted: Planted| -> Option<[f64; 2]> {
        let mut pairs: Vec<Pair> = Vec::new();
        for stretch in &stretches {
            pairs.extend(stretch.simulation.run(stretch.rows, planted, stretch.per_ampere).ok()?);
        }
        Some([mean_square(&pairs, |pair| pair.wound), mean_square(&pairs, |pair| pair.current)].map(f64::sqrt))
    };
    let units = |left: [f64; 2]| left.iter().zip(UNITS).map(|(x, unit)| (x / unit).powi(2)).sum::<f64>();
    let wrong = |error: hwasp_algos::SearchError| DeployError::Fit {
        what: error.to_string(),
        hint: "see by `hwasp deploy replay` which log the simulation does not follow",
    };
    let config = CmaesConfig {
        sigma: 0.4,
        popsize: Some(10),
        lower: Some(LOWER.to_vec()),
        upper: Some(UPPER.to_vec()),
        ..CmaesConfig::default()
    };
    // Where the logs say nothing of the gain, it is what was calibrated.
    let sheet = hand(deployed.spec())?.transmission.torque_constant;
    let calibrated = (logs.first().map_or(sheet, |logged| logged.about.torque_per_current) / sheet).ln();
    let begin: [f64; FITTED] =
        std::array::from_fn(|i| if i < 2 { calibrated.clamp(LOWER[i], UPPER[i]) } else { BEGIN[i] });
    let prior = |x: &[f64]| PRIOR * ((x[0] - calibrated) / WIDTH).powi(2);
    let mut search = Cmaes::new(config, &begin, 0).map_err(wrong)?;
    for generation in 0..generations {
        let candidates = search.ask();
        let scores = executor.map(candidates.len(), |i| {
            let (x, left) = (&candidates[i], left(planted(&candidates[i], nominal)));
            left.map_or(f64::NEG_INFINITY, |left| -units(left) - prior(x))
        });
        search.tell(&scores).map_err(wrong)?;
        told(generation + 1, search.best().map_or(f64::NAN, |(_, score)| (-score).sqrt()));
        if search.stopped().is_some() {
            break;
        }
    }
    let best = search.best().map_or_else(|| search.center(), |(best, _)| best.to_vec());
    let found = planted(&best, nominal);
    let lost = || DeployError::Fit {
        what: "the simulation breaks down".to_owned(),
        hint: "see by `hwasp deploy replay` which log it does not follow",
    };
    let (before, after) = (left(Planted::default()).ok_or_else(lost)?, left(found).ok_or_else(lost)?);
    // A hand that is stronger in everything: do the logs speak against it?
    let mut stronger = best.clone();
    (stronger[0], stronger[1], stronger[2]) = (best[0] + STRONGER.ln(), best[1] + STRONGER.ln(), STRONGER * best[2]);
    let against = left(planted(&stronger, nominal)).map_or(f64::INFINITY, units);
    Ok(Identified {
        gain_is_told: against > AGAINST * units(after),
        torque_gain: found.torque_gain,
        tendon_stiffness: found.tendon_stiffness.unwrap_or(nominal),
        friction: found.friction,
        delay: found.delay,
        slack: found.slack,
        left: after,
        before,
    })
}

fn mean_square(pairs: &[Pair], of: impl Fn(&Pair) -> [f64; 2]) -> f64 {
    let off = pairs.iter().map(of).map(|[logged, simulated]| logged - simulated).filter(|off| off.is_finite());
    let (sum, count) = off.fold((0.0, 0_u32), |(sum, count), off| (sum + off * off, count + 1));
    sum / f64::from(count.max(1))
}

/// How far what was fitted is varied in training, as a share.
const SPREAD: f64 = 0.1;

/// The experiment of a run with what was identified, TOML: to be trained further, so all schedules are at their end.
///
/// # Errors
/// Where the experiment cannot be written.
pub fn experiment(deployed: &Deployed, found: &Identified, calibrated: f64) -> Result<String, DeployError> {
    let unwritten = |what: String| DeployError::Fit { what, hint: "see that experiment.toml of the run is whole" };
    let text = deployed.spec().to_toml().map_err(|error| unwritten(error.to_string()))?;
    let mut table: toml::Table = text.parse().map_err(|error: toml::de::Error| unwritten(error.to_string()))?;
    // A reading is off by what the calibration did not know, and the motor's limit the other way.
    let reads = calibrated / found.torque_gain;
    let span = |value: f64| [value * (1.0 - SPREAD), value * (1.0 + SPREAD)];
    let plain = |value: f64| toml::Value::Array(span(value).map(toml::Value::Float).to_vec());
    let text = |value: f64, unit: &str| toml::Value::String(format!("{value:.5} {unit}"));
    let quantity = |value: f64, unit: &str| toml::Value::Array(span(value).map(|x| text(x, unit)).to_vec());
    for (section, key, value) in [
        ("task", "torque_gain", plain(reads)),
        ("task", "limit_gain", plain(1.0 / reads)),
        ("task", "delay", quantity(found.delay, "s")),
        ("task", "slack", quantity(found.slack, "m")),
        ("task", "motor_friction", quantity(found.friction, "N*m")),
        ("task", "tendon_stiffness", text(found.tendon_stiffness, "N/m")),
        ("train", "progress_start", toml::Value::Float(1.0)),
    ] {
        let table = table.get_mut(section).and_then(toml::Value::as_table_mut);
        table.ok_or_else(|| unwritten(format!("it has no [{section}]")))?.insert(key.to_owned(), value);
    }
    let written = toml::to_string(&table).map_err(|error| unwritten(error.to_string()))?;
    Ok(format!("# The run's experiment, with what `hwasp deploy identify` found in logs of the built hand.\n{written}"))
}
