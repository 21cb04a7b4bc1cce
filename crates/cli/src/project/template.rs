//! The files of a project. They lie in `templates/`, where those in Rust are compiled and tested as an example of the program.

use hwasp_experiment::EXPERIMENT;

use super::{Checkout, ProjectError};

macro_rules! text {
    ($path:literal) => {
        include_str!(concat!("../../../../templates/", $path))
    };
}

/// What the physics of a project are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Template {
    /// Written in Rust.
    Plant,
    /// The `MuJoCo` engine's, from an MJCF file.
    Mjcf,
}

/// What both have.
const COMMON: &[(&str, &str)] = &[
    (".gitignore", text!("gitignore")),
    (EXPERIMENT, text!("plant/experiment.toml")),
    ("src/hold.rs", text!("plant/src/hold.rs")),
];
const MAIN: &str = text!("plant/src/main.rs");
const SPRING: &str = text!("plant/src/spring.rs");
const TESTS: &str = text!("plant/src/tests.rs");

impl Template {
    /// Where the files lie in the project, and what is in them.
    pub(super) fn files(self, name: &str, checkout: &Checkout) -> Result<Vec<(&'static str, String)>, ProjectError> {
        let mut files: Vec<_> = COMMON.iter().map(|&(path, text)| (path, text.to_owned())).collect();
        let (manifest, about) = match self {
            Self::Plant => {
                files.extend([
                    (".cargo/config.toml", text!("plant/.cargo/config.toml").to_owned()),
                    ("src/arm.rs", text!("plant/src/arm.rs").to_owned()),
                    ("src/main.rs", MAIN.to_owned()),
                    ("src/spring.rs", SPRING.to_owned()),
                    ("src/tests.rs", TESTS.to_owned()),
                ]);
                (text!("plant/Cargo.toml.in"), "| `src/arm.rs` | the plant: the arm's physics |")
            }
            Self::Mjcf => {
                // A model may be one that the engine refuses.
                let fallible = |text: &str| text.replace("Arm::default()", "Arm::new()?");
                files.extend([
                    (".cargo/config.toml", text!("mjcf/.cargo/config.toml").to_owned()),
                    ("build.rs", text!("mjcf/build.rs").to_owned()),
                    ("link/libmujoco.so", include_str!("../../../mujoco/link/libmujoco.so").to_owned()),
                    ("mechanism.xml", text!("mjcf/mechanism.xml").to_owned()),
                    ("src/arm.rs", text!("mjcf/src/arm.rs").to_owned()),
                    ("src/main.rs", fallible(MAIN)),
                    ("src/spring.rs", fallible(SPRING)),
                    ("src/tests.rs", TESTS.to_owned()),
                ]);
                let about = "| `mechanism.xml` | the arm's physics, as an MJCF file |\n| `src/arm.rs` | the plant: the engine, and \
                             where in it angle, speed and motor are |";
                (text!("mjcf/Cargo.toml.in"), about)
            }
        };
        files.push(("Cargo.toml", filled(manifest, name, checkout)?));
        files.push(("README.md", text!("README.md").replace("{{name}}", name).replace("{{plant}}", about)));
        Ok(files)
    }
}

/// A manifest for that name, whose crates come from there.
fn filled(manifest: &str, name: &str, checkout: &Checkout) -> Result<String, ProjectError> {
    let about = "# hwasp comes from a checkout on this machine.";
    let mut manifest = manifest.replace("{{name}}", name).replace("{{source}}", about);
    for part in ["core", "diff", "problem", "settings", "builtin", "experiment", "training", "cli", "mujoco"] {
        let path = checkout.0.join("crates").join(part);
        let Some(path) = path.to_str() else {
            return Err(ProjectError::NoCheckout { path: checkout.0.clone() });
        };
        // Templates are for the version that they came with.
        let from = format!("path = {}, version = \"{}\"", toml::Value::from(path), env!("CARGO_PKG_VERSION"));
        manifest = manifest.replace(&format!("{{{{{part}}}}}"), &from);
    }
    Ok(manifest)
}
