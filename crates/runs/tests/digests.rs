//! The bits of short trainings, kept: whoever changes one of them does so on purpose and says why in the changelog.
//!
//! What is promised is in ARCHITECTURE.md, "Numbers": the same bits for any number of threads and any width of the processor's
//! vectors, on one platform. One of the cases has less of it: the engine of `z-grasp` may compute otherwise with other vectors.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::sync::atomic::AtomicBool;

use hwasp_core::{Executor, Serial, Threads};
use hwasp_runs::write_policy;
use hwasp_testing::{layers, resolve};
use hwasp_training::{Assembly, train};
use sha2::{Digest, Sha256};

/// A short training with seed 5.
struct Case {
    experiment: &'static str,
    method: Option<&'static str>,
    env_steps: &'static str,
    /// Whether its bits may depend on the processor.
    may_vary: bool,
    /// SHA-256 of `policy.safetensors`, from a processor with AVX-512.
    digest: &'static str,
}

const CASES: [Case; 5] = [
    Case {
        experiment: "mass-spring",
        method: None,
        env_steps: "40000",
        may_vary: false,
        digest: "f21f25d03c49dbef792b61b3ddd127c751105beaf7645ca95ef2d34cc88896fa",
    },
    Case {
        experiment: "bar-length",
        method: Some("minimal"),
        env_steps: "40000",
        may_vary: false,
        digest: "cbaeef166005faa1bcb122ff12ec3f6dac06714d5119d8f24596ee780842269b",
    },
    Case {
        experiment: "pendulum-trpo",
        method: None,
        env_steps: "20000",
        may_vary: false,
        digest: "7d4e9e215623a7191482552c8991961ad36e43d3997f95e8b2e408d8db6a1042",
    },
    Case {
        experiment: "z-grasp",
        method: None,
        env_steps: "40000",
        may_vary: true,
        digest: "3cb2abefc4e848fd817c44b1a9b6e17c978b74522a5ab8059a41497e95de1f75",
    },
    Case {
        experiment: "reach",
        method: Some("cmaes"),
        env_steps: "60000",
        may_vary: false,
        digest: "4810adfcf18205a0e3d1d2b6fd8b9a535851aab7e25ab47e3656716bfeaf3d1d",
    },
];

fn digest(case: &Case, executor: &dyn Executor) -> String {
    let layers = [("seed", "5"), ("train.env_steps", case.env_steps), ("train.evaluation_episodes", "2")]
        .into_iter()
        .fold(layers(case.experiment), |layers, (key, value)| layers.with_override(key, value));
    let assembly = Assembly::new(&resolve(layers, case.method).unwrap()).unwrap();
    let trained = train(&assembly, executor, &mut (), &AtomicBool::new(false)).unwrap();
    let file = write_policy(&assembly.policy, &trained.params).unwrap();
    format!("{:x}", Sha256::digest(&file))
}

#[test]
fn short_trainings_keep_their_bits() {
    let (platform, wide) = (cfg!(all(target_os = "linux", target_env = "gnu", target_arch = "x86_64")), widest());
    for case in &CASES {
        let name = format!("{} {}", case.experiment, case.method.unwrap_or("hwasp"));
        let one = digest(case, &Serial);
        assert_eq!(one, digest(case, &Threads::new(2).unwrap()), "{name}: two threads");
        if platform && (wide || !case.may_vary) {
            assert_eq!(one, case.digest, "{name}: other bits than those of earlier versions");
        } else {
            println!(
                "left out: {name}, whose bits were kept for AVX-512 on x86_64 Linux with glibc; here they are {one}"
            );
        }
    }
}

/// Whether the kept bits are of such a processor.
fn widest() -> bool {
    hwasp_diff::fast::instructions() == "V4"
}
