//! What can be exported.

use hwasp_experiment::Experiment;

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
    /// The hand and its task as a `MuJoCo` model, with native tendons and springs.
    Mjcf,
    /// The hand's links and joints as URDF.
    Urdf,
    /// Its printed parts as STL.
    Stl,
    /// The same as an OpenSCAD file, with the parameters at its top.
    Scad,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Onnx, Self::Safetensors, Self::Json, Self::Mjcf, Self::Urdf, Self::Stl, Self::Scad];

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
        }
    }

    /// Whether a run of this experiment has it: only hands have a mechanism to be written.
    pub fn is_of(self, spec: &Experiment) -> bool {
        let of_mechanism = matches!(self, Self::Mjcf | Self::Urdf | Self::Stl | Self::Scad);
        !of_mechanism || hand_of(spec).is_some()
    }
}
