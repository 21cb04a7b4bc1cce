//! The step against an independent double-precision model of the policy, and what an update must keep.

use std::sync::Arc;

use hwasp_core::{
    EpisodeKind, Episodes, HardwarePolicy, MakeEnvironment, Noise, Placement, PolicySpec, Sampler, Serial, Threads,
};
use hwasp_diff::Activation;
use hwasp_tasks::mass_spring::{MassSpring, MassSpringSettings};
use proptest::prelude::*;
use rand::RngExt;

use super::*;
use crate::archive::Archive;
use crate::baseline::{BaselineConfig, MlpBaselineConfig};
use crate::gae::{AdvantageConfig, Advantages};

mod model;
use model::Model;

/// Three springs, one in the action, one in the graph, one fixed, under a small controller.
fn policy() -> (MassSpring, Arc<HardwarePolicy>) {
    policy_of(vec![Placement::Graph, Placement::Action, Placement::Fixed(5.0)])
}

/// The same with two more springs that are drawn once an episode.
fn drawing() -> (MassSpring, Arc<HardwarePolicy>) {
    let drawn = Placement::Episode;
    policy_of(vec![Placement::Graph, drawn, Placement::Action, Placement::Fixed(5.0), drawn])
}

fn policy_of(placements: Vec<Placement>) -> (MassSpring, Arc<HardwarePolicy>) {
    let count = placements.len();
    let problem = MassSpring::stiffness(MassSpringSettings { count, ..MassSpringSettings::default() }).unwrap();
    let noise = Noise { command: vec![0.3.into()], effort: vec![3.0.into()], design: 0.1.into(), train: true };
    let spec = PolicySpec {
        hidden: vec![8, 8],
        activation: Activation::Tanh,
        squash: true,
        state_dependent_std: false,
        observation_center: vec![0.1, 0.0],
        observation_scale: vec![0.1, 0.5],
        sees_design: false,
        normalize: None,
        law: problem.law(),
        placements,
        noise,
    };
    let policy = HardwarePolicy::new(spec, problem.make(None).spec()).unwrap();
    (problem, Arc::new(policy))
}

fn collect(problem: &MassSpring, policy: &Arc<HardwarePolicy>, params: &[f32], iteration: u64, episodes: u64) -> Batch {
    let sampler = Sampler::new(Arc::clone(policy), Arc::new(problem.clone()), Some(50));
    let kind = EpisodeKind::Training;
    sampler
        .collect(&Serial, params, &Episodes { seed: 1, iteration, indices: 0..episodes, progress: 0.0, kind })
        .unwrap()
}

fn settings(config: TrpoConfig) -> TrpoSettings {
    TrpoSettings { trpo: config, baseline: BaselineConfig::Linear { ridge: 1e-5, privileged: false, context: false } }
}

fn minibatch(policy: &HardwarePolicy, batch: &Batch) -> Minibatch {
    let mut rows = Minibatch::default();
    let all: Vec<u32> = (0..batch.rows() as u32).collect();
    let dims = (policy.obs_dim(), policy.state_dim(), policy.action_dim());
    rows.gather(batch, &vec![0.0; all.len()], &all, dims);
    rows.draws.gather(&draws(policy, batch, &[]), &all);
    rows
}

/// Draws of a batch that were worth so much each; nothing where nothing is said.
fn draws(policy: &HardwarePolicy, batch: &Batch, worth: &[f64]) -> Draws {
    let targets = Advantages {
        advantage: vec![],
        lambda_return: vec![],
        discounted_return: vec![],
        episode_return: vec![],
        episode_advantage: (0..batch.episodes.len()).map(|e| worth.get(e).copied().unwrap_or(0.0)).collect(),
        foresight: Foresight::default(),
    };
    Draws::new(policy, batch, &targets, &AdvantageConfig { normalize: false, ..AdvantageConfig::default() })
}

/// H·v without damping, through the passes that an update uses.
fn product(policy: &Arc<HardwarePolicy>, batch: &Batch, params: &[f32], v: &[f64]) -> Vec<f64> {
    let rows = minibatch(policy, batch);
    let mut passes = Passes::new(Arc::clone(policy));
    let mut out = vec![0.0; params.len()];
    passes.gradient(&Serial, &rows, params, 0.0, &mut out);
    Fisher::new(&passes, &rows, params, 0.0).product(&Serial, v, &mut out);
    out
}

fn norm(v: impl Iterator<Item = f64>) -> f64 {
    v.map(|x| x * x).sum::<f64>().sqrt()
}

/// 300 rows: two jobs, the second with a block that is not full. Differences of the gradient of KL(old || new), in `f64`
/// through controller, law and noise.
#[test]
fn fisher_products_are_differences_of_the_gradient_of_the_divergence() {
    for (seed, (problem, policy)) in [(0, policy()), (1, policy()), (2, policy()), (0, drawing()), (1, drawing())] {
        let params = policy.init(seed, 1.0);
        let batch = collect(&problem, &policy, &params, 0, 6);
        let model = Model::new(&policy, &batch);
        let old: Vec<f64> = params.iter().map(|&p| f64::from(p)).collect();
        let mut numbers = stream(seed, Purpose::Check, 0, 0);
        let v: Vec<f64> = params.iter().map(|_| f64::from((numbers.random::<f64>() - 0.5) as f32)).collect();
        let h = 1e-5;
        let moved = |h: f64| {
            let new: Vec<f64> = old.iter().zip(&v).map(|(p, v)| p + h * v).collect();
            model.divergence(&old, &new).1
        };
        let (ahead, behind) = (moved(h), moved(-h));
        let wanted: Vec<f64> = ahead.iter().zip(&behind).map(|(a, b)| (a - b) / (2.0 * h)).collect();
        let found = product(&policy, &batch, &params, &v);
        for group in policy.groups() {
            let at = group.range.clone();
            let off = norm(found[at.clone()].iter().zip(&wanted[at.clone()]).map(|(a, b)| a - b));
            let all = norm(wanted[at].iter().copied());
            println!("{:?}: {:.1e} of {all:.1e}", group.kind, off / all);
            assert!(all > 0.0 && off < 1e-5 * all, "{:?}: {off} of {all}", group.kind);
        }
    }
}

/// KL of two Gaussians whose log standard deviations differ by d: d + ½(exp(-2d) - 1) = d² + O(d³), so that its second
/// derivative is 2, whatever σ and however many rows; and nothing of it is seen by the other parameters.
#[test]
fn log_standard_deviations_by_hand() {
    let (problem, policy) = policy();
    let params = policy.init(0, 1.0);
    let batch = collect(&problem, &policy, &params, 0, 2);
    let range = policy.log_std_params().unwrap();
    let mut v = vec![0.0; params.len()];
    for (k, v) in v[range.clone()].iter_mut().enumerate() {
        *v = 1.0 + k as f64;
    }
    let found = product(&policy, &batch, &params, &v);
    assert!(found[..range.start].iter().all(|&x| x == 0.0));
    for (k, x) in found[range].iter().enumerate() {
        assert_eq!(*x, 2.0 * (1.0 + k as f64));
    }
}

/// What is drawn once an episode counts once in its 50 rows: 2/50.
#[test]
fn log_standard_deviations_of_draws_by_hand() {
    let (problem, policy) = drawing();
    let params = policy.init(0, 1.0);
    let batch = collect(&problem, &policy, &params, 0, 2);
    let range = policy.log_std_params().unwrap();
    let mut v = vec![0.0; params.len()];
    v[range.clone()].fill(1.0);
    let found = product(&policy, &batch, &params, &v)[range].to_vec();
    assert!(found[..2].iter().all(|x| (x - 0.04).abs() < 1e-7), "{found:?}");
    assert_eq!(found[2..], [2.0, 2.0, 2.0]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Wherever it starts and whatever the limit, an update lowers the loss and stays within the divergence, both
    /// judged by the model, or it changes nothing.
    #[test]
    fn an_update_gains_within_the_bound(
        seed in 0..1000_u64, exponent in -4.0..0.5_f64, left in 0.1..1.0_f64, share in 0.05..1.0_f64, draws in any::<bool>(),
    ) {
        let (problem, policy) = if draws { drawing() } else { policy() };
        let params = policy.init(seed, 1.0);
        // Half way through the decay.
        let (whole, progress) = (10_f64.powf(exponent), 0.5);
        let max_kl = whole * (1.0 + left) / 2.0;
        let config = TrpoConfig { max_kl: whole, max_kl_final: left, fisher_rows: FisherRows::Fraction(share), ..TrpoConfig::default() };
        let mut trpo = Trpo::new(&settings(config.clone()), Arc::clone(&policy), params.clone(), seed);
        let batch = collect(&problem, &policy, &params, seed, 6);
        let targets = trpo.baseline.targets(&batch, &config.advantages, 0).unwrap();
        let metrics = trpo.update(&Serial, &batch, progress, 0).unwrap();
        let told = |name| metrics.get(name).unwrap();
        let model = Model::new(&policy, &batch);
        let wide = |p: &[f32]| p.iter().map(|&p| f64::from(p)).collect::<Vec<_>>();
        let (old, new) = (wide(&params), wide(trpo.params()));
        let kl = model.divergence(&old, &new).0;
        prop_assert!((kl - told("kl")).abs() < 1e-4 * max_kl, "{kl} was told as {}", told("kl"));
        prop_assert!(kl <= max_kl * (1.0 + 1e-4));
        let draws = Draws::new(&*policy, &batch, &targets, &config.advantages);
        let surrogate = |params: &[f64]| model.surrogate(params, &targets.advantage, &draws.advantage);
        let gain = surrogate(&new) - surrogate(&old);
        prop_assert!((gain - told("gain")).abs() < 1e-4, "{gain} was told as {}", told("gain"));
        if told("step_fraction") == 0.0 {
            prop_assert_eq!((trpo.params(), told("rejected"), told("tried")), (&params[..], 1.0, 15.0));
        } else {
            prop_assert!(gain > 0.0 && told("rejected") == 0.0);
            prop_assert!((told("step_fraction") - 0.8_f64.powi(told("tried") as i32 - 1)).abs() < 1e-12);
        }
    }
}

/// A step of the default settings uses most of what it may, which a step of wrong length or direction would not.
#[test]
fn the_first_step_nearly_fits() {
    let (problem, policy) = policy();
    let params = policy.init(2, 1.0);
    let mut trpo = Trpo::new(&settings(TrpoConfig::default()), Arc::clone(&policy), params.clone(), 2);
    let metrics = trpo.update(&Serial, &collect(&problem, &policy, &params, 0, 20), 0.0, 0).unwrap();
    let told = |name| metrics.get(name).unwrap();
    assert!(told("kl") > 0.005 && told("kl") <= 0.01, "{}", told("kl"));
    assert!(told("step_fraction") > 0.6 && told("cg_iterations") == 10.0, "{metrics:?}");
}

/// One step of conjugate gradients goes along D²·g, so that a unit of 3 gives the design nine times its share. What
/// many steps find hardly depends on the unit, as D·(D·H·D)⁻¹·D·g = H⁻¹·g but for the damping.
#[test]
fn the_unit_of_the_design_is_a_matter_of_conditioning() {
    let (problem, policy) = policy();
    let params = policy.init(2, 1.0);
    let batch = collect(&problem, &policy, &params, 0, 20);
    // The length of the design's part of a step over the controller's.
    let share = |design_scale: f64, cg_iterations: usize| {
        let config = TrpoConfig { design_scale, cg_iterations, damping: 1e-3, ..TrpoConfig::default() };
        let mut trpo = Trpo::new(&settings(config), Arc::clone(&policy), params.clone(), 2);
        assert!(trpo.update(&Serial, &batch, 0.0, 0).unwrap().get("step_fraction") > Some(0.0));
        let moved: Vec<f64> = trpo.params().iter().zip(&params).map(|(a, b)| f64::from(a - b)).collect();
        let part = |range: std::ops::Range<usize>| norm(moved[range].iter().copied());
        part(policy.design_params()) / part(0..policy.design_params().start)
    };
    let (short, long) = (share(3.0, 1) / share(1.0, 1), share(3.0, 100) / share(1.0, 100));
    assert!((short - 9.0).abs() < 1e-2, "{short}");
    assert!((long - 1.0).abs() < 0.4, "{long}");
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let (problem, policy) = policy();
    let params = policy.init(0, 1.0);
    let batch = collect(&problem, &policy, &params, 0, 30);
    let config = TrpoConfig { fisher_rows: FisherRows::Count(700), ..TrpoConfig::default() };
    let train = |executor: &dyn Executor| {
        let mut trpo = Trpo::new(&settings(config.clone()), Arc::clone(&policy), params.clone(), 0);
        let metrics = trpo.update(executor, &batch, 0.0, 0).unwrap();
        (trpo.params().iter().map(|p| p.to_bits()).collect::<Vec<_>>(), metrics)
    };
    let serial = train(&Serial);
    assert!(serial.1.get("step_fraction") > Some(0.0));
    for count in [1, 2, 3] {
        assert_eq!(serial, train(&Threads::new(count).unwrap()), "{count} threads");
    }
}

#[test]
fn resumes_bit_for_bit() {
    let (problem, policy) = policy();
    for baseline in [
        BaselineConfig::Linear { ridge: 1e-5, privileged: true, context: false },
        BaselineConfig::Mlp(MlpBaselineConfig { privileged: true, ..MlpBaselineConfig::default() }),
    ] {
        let trpo = TrpoConfig { fisher_rows: FisherRows::Fraction(0.3), ..TrpoConfig::default() };
        let settings = TrpoSettings { trpo, baseline };
        let batches = |i, params: &[f32]| collect(&problem, &policy, params, i, 4);
        let mut whole = Trpo::new(&settings, Arc::clone(&policy), policy.init(0, 1.0), 0);
        let mut saved = Archive::new();
        for i in 0..4 {
            if i == 2 {
                saved = whole.save().unwrap();
            }
            whole.update(&Serial, &batches(i, whole.params()), 0.0, i).unwrap();
        }
        let mut resumed = Trpo::new(&settings, Arc::clone(&policy), policy.init(1, 1.0), 0);
        resumed.load(&saved).unwrap();
        for i in 2..4 {
            resumed.update(&Serial, &batches(i, resumed.params()), 0.0, i).unwrap();
        }
        assert_eq!(resumed.save().unwrap(), whole.save().unwrap());
        assert_ne!(resumed.save().unwrap(), saved);

        let other = TrpoSettings {
            baseline: match settings.baseline {
                BaselineConfig::Linear { .. } => BaselineConfig::Mlp(MlpBaselineConfig::default()),
                BaselineConfig::Mlp(_) => BaselineConfig::Linear { ridge: 1.0, privileged: false, context: false },
            },
            ..settings
        };
        let error = Trpo::new(&other, Arc::clone(&policy), policy.init(0, 1.0), 0).load(&saved).unwrap_err();
        assert!(error.to_string().contains("`baseline."), "{error}");
    }
}

#[test]
fn numbers_that_are_none_change_nothing() {
    let (problem, policy) = policy();
    let params = policy.init(0, 1.0);
    let sound = collect(&problem, &policy, &params, 0, 4);
    let mut trpo = Trpo::new(&settings(TrpoConfig::default()), Arc::clone(&policy), params.clone(), 0);
    let before = trpo.save().unwrap();
    let (mut reward, mut old, mut action) = (sound.clone(), sound.clone(), sound.clone());
    reward.reward[1] = f64::NAN;
    old.log_prob[1] = f32::NAN;
    action.action[1] = f32::INFINITY;
    for (batch, what) in [(reward, "an advantage"), (old, "the policy gradient"), (action, "the policy gradient")] {
        let error = trpo.update(&Serial, &batch, 0.0, 7).unwrap_err();
        assert_eq!(error, LearnError::NotFinite { what, iteration: 7 });
        assert_eq!(trpo.save().unwrap(), before);
    }
    trpo.update(&Serial, &sound, 0.0, 7).unwrap();
    assert_ne!(trpo.params(), params);
}

/// Where all rewards are nothing so are advantages and gradient, and there is no way to go.
#[test]
fn nothing_to_gain_is_no_step() {
    let (problem, policy) = policy();
    let params = policy.init(0, 1.0);
    let mut batch = collect(&problem, &policy, &params, 0, 4);
    batch.reward.fill(0.0);
    let mut trpo = Trpo::new(&settings(TrpoConfig::default()), Arc::clone(&policy), params.clone(), 0);
    for updates in 1..3 {
        let metrics = trpo.update(&Serial, &batch, 0.0, 0).unwrap();
        let told = |name| metrics.get(name).unwrap();
        assert_eq!((told("step_fraction"), told("rejected"), told("kl")), (0.0, f64::from(updates), 0.0));
        assert_eq!(trpo.params(), params);
    }
}
