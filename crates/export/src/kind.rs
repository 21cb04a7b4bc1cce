//! What can be exported.

use hwasp_experiment::Experiment;
use hwasp_problem::ModelFormat;
use hwasp_workshop::design::hand_of;

/// What can be exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The controller, and the controller with the hardware's law, as ONNX models.
    Onnx,
    /// The controller's numbers as safetensors.
    Safetensors,
    /// The controller's numbers as JSON.
    Json,
    /// The mechanism in its world as a `MuJoCo` model.
    Mjcf,
    /// Its links and joints as URDF.
    Urdf,
    /// Its printed parts as STL.
    Stl,
    /// The same as an OpenSCAD file, with the parameters at its top.
    Scad,
    /// The same as STEP.
    Step,
    /// What a workshop gets beside them: bill, assembly, drawings, verdict.
    Package,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Onnx,
        Self::Safetensors,
        Self::Json,
        Self::Mjcf,
        Self::Urdf,
        Self::Stl,
        Self::Scad,
        Self::Step,
        Self::Package,
    ];

    /// Its name, as the command line has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Onnx => "onnx",
            Self::Safetensors => "safetensors",
            Self::Json => "json",
            Self::Mjcf => "mjcf",
            Self::Urdf => "urdf",
            Self::Stl => "stl",
            Self::Scad => "scad",
            Self::Step => "step",
            Self::Package => "package",
        }
    }

    /// Whether a run of this experiment has it: models are of a mechanism that can be written so, printed parts are of the hand.
    pub fn is_of(self, spec: &Experiment) -> bool {
        let mechanism = spec.task.built().mechanism.as_ref();
        let has = |format| mechanism.is_some_and(|mechanism| mechanism.formats().contains(&format));
        match self {
            Self::Onnx | Self::Safetensors | Self::Json => true,
            Self::Mjcf => has(ModelFormat::Mjcf),
            Self::Urdf => has(ModelFormat::Urdf),
            Self::Stl | Self::Scad | Self::Step | Self::Package => hand_of(spec).is_some(),
        }
    }
}
