//! The parameters' file: what is written is read back bit by bit, and nothing else is.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use hwasp_core::Policy;
use hwasp_runs::{PolicyFileError, read_policy, write_policy};
use hwasp_training::Assembly;
use proptest::collection::vec;
use proptest::prelude::*;
use safetensors::SafeTensors;

fn assembly(method: &str, settings: &[(&str, &str)]) -> Assembly {
    let layers = hwasp_testing::layers("mass-spring");
    let layers = settings.iter().fold(layers, |layers, (key, value)| layers.with_override(key, value));
    Assembly::new(&hwasp_testing::resolve(layers, Some(method)).unwrap()).unwrap()
}

/// A policy of few parameters.
fn small() -> Assembly {
    assembly("hwasp", &[("controller.hidden", "[2]"), ("task.segments", "2")])
}

/// Parameters that are all different, none of them round.
fn params(count: usize) -> Vec<f32> {
    (0..count).map(|i| (i as f32).sin() * 1e-3_f32.powi(i as i32 % 4)).collect()
}

fn bits(params: &[f32]) -> Vec<u32> {
    params.iter().map(|p| p.to_bits()).collect()
}

#[test]
fn parameters_come_back_bit_by_bit() {
    let mixed = r#"{ "stiffness[0..4]" = "action", "stiffness[5]" = "fixed" }"#;
    for assembly in [
        assembly("hwasp", &[]),
        assembly("minimal", &[("controller.hidden", "[5, 4, 3]")]),
        assembly("fixed", &[]),
        assembly("hwasp", &[("controller.hidden", "[]")]),
        assembly("hwasp", &[("design.placements", mixed), ("noise.train", "false")]),
    ] {
        let policy = &assembly.policy;
        let mut written = params(policy.param_count());
        written[0] = -0.0;
        written[1] = f32::MIN_POSITIVE / 2.0;
        written[2] = f32::MAX;
        let bytes = write_policy(policy, &written).unwrap();
        assert_eq!(bits(&read_policy(policy, &bytes).unwrap()), bits(&written), "{:?}", policy.spec().placements);
    }
}

#[test]
fn tensors_have_the_names_and_shapes_that_others_expect() {
    let assembly = assembly("hwasp", &[]);
    let bytes = write_policy(&assembly.policy, &assembly.init()).unwrap();
    let file = SafeTensors::deserialize(&bytes).unwrap();
    let mut shapes: Vec<_> = file.tensors().into_iter().map(|(name, t)| (name, t.shape().to_vec())).collect();
    shapes.sort();
    let shapes: Vec<_> = shapes.iter().map(|(name, shape)| (name.as_str(), shape.as_slice())).collect();
    let expected: [(&str, &[usize]); 8] = [
        ("controller.0.bias", &[32]),
        ("controller.0.weight", &[2, 32]),
        ("controller.1.bias", &[32]),
        ("controller.1.weight", &[32, 32]),
        ("controller.2.bias", &[1]),
        ("controller.2.weight", &[32, 1]),
        ("design.logit", &[10]),
        ("log_std", &[2]),
    ];
    assert_eq!(shapes, expected);
}

#[test]
fn a_policy_of_another_shape_is_refused_by_name() {
    let (this, other) = (assembly("hwasp", &[]), assembly("hwasp", &[("task.segments", "9")]));
    let bytes = write_policy(&other.policy, &other.init()).unwrap();
    let error = read_policy(&this.policy, &bytes).unwrap_err();
    let PolicyFileError::Tensor { name, found, needed } = error else { panic!("{error}") };
    assert_eq!((name.as_str(), found.as_str(), needed.as_str()), ("design.logit", "F32 [9]", "F32 [10]"));

    let fixed = assembly("fixed", &[]);
    let bytes = write_policy(&fixed.policy, &fixed.init()).unwrap();
    let error = read_policy(&this.policy, &bytes).unwrap_err();
    assert!(
        matches!(error, PolicyFileError::Tensor { ref name, ref found, .. } if name == "design.logit" && found == "missing"),
        "{error}"
    );
}

#[test]
fn what_is_no_number_is_refused_where_it_stands() {
    let assembly = small();
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut params = params(assembly.policy.param_count());
        // The controller is 2 inputs, 2 units, 1 output: 4 + 2 + 2 + 1 parameters.
        params[9 + 1] = value;
        let bytes = write_policy(&assembly.policy, &params).unwrap();
        let error = read_policy(&assembly.policy, &bytes).unwrap_err();
        let PolicyFileError::NotFinite { name, at, .. } = error else { panic!("{error}") };
        assert_eq!((name.as_str(), at), ("design.logit", 1));
    }
}

/// Running statistics of the observations: behind the controller, and with a scale that can be divided by.
#[test]
fn running_statistics_come_back_and_scales_are_positive() {
    let assembly = assembly(
        "hwasp",
        &[
            ("controller.observation_center", "[0.0, 0.0]"),
            ("controller.observation_scale", "[1.0, 1.0]"),
            ("controller.normalize_observations", "true"),
        ],
    );
    let range = assembly.policy.normalizer_params();
    let mut params = assembly.init();
    params[range.clone()].copy_from_slice(&[0.25, -3.0, 0.5, 2.0]);
    let bytes = write_policy(&assembly.policy, &params).unwrap();
    let file = SafeTensors::deserialize(&bytes).unwrap();
    for (name, values) in [("observation.center", [0.25_f32, -3.0]), ("observation.scale", [0.5, 2.0])] {
        assert_eq!(file.tensor(name).unwrap().data(), values.map(f32::to_le_bytes).as_flattened(), "{name}");
    }
    assert_eq!(bits(&read_policy(&assembly.policy, &bytes).unwrap()), bits(&params));
    params[range.end - 1] = 0.0;
    let error = read_policy(&assembly.policy, &write_policy(&assembly.policy, &params).unwrap()).unwrap_err();
    assert_eq!(error.to_string(), "tensor `observation.scale` holds 0 at position 1");
}

#[test]
fn every_cut_is_refused() {
    let assembly = small();
    let bytes = write_policy(&assembly.policy, &params(assembly.policy.param_count())).unwrap();
    for length in 0..bytes.len() {
        assert!(read_policy(&assembly.policy, &bytes[..length]).is_err(), "{length} of {} bytes", bytes.len());
    }
}

/// Whatever the bytes: an error, or as many numbers as there are parameters.
fn survives(assembly: &Assembly, bytes: &[u8]) {
    if let Ok(params) = read_policy(&assembly.policy, bytes) {
        assert_eq!(params.len(), assembly.policy.param_count());
        assert!(params.iter().all(|p| p.is_finite()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_are_survived(bytes in vec(any::<u8>(), 0..300)) {
        survives(&small(), &bytes);
    }

    /// Behind a header of plausible length.
    #[test]
    fn random_headers_are_survived(header in "[{}\\[\\]\":,a-z0-9_. ]{0,120}", data in vec(any::<u8>(), 0..40)) {
        let bytes = [&(header.len() as u64).to_le_bytes()[..], header.as_bytes(), &data].concat();
        survives(&small(), &bytes);
    }

    #[test]
    fn changed_bytes_are_survived(changes in vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let assembly = small();
        let mut bytes = write_policy(&assembly.policy, &params(assembly.policy.param_count())).unwrap();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        survives(&assembly, &bytes);
    }
}
