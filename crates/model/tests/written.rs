//! Robots as files: what is written is the robot with its design.

#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;
use std::sync::Arc;

use hwasp_core::Form;
use hwasp_experiment::{Experiment, Files as Named, Folder, Layers};
use hwasp_mujoco::engine::{Files, Simulation, Spec, View};
use hwasp_problem::ModelFormat;
use hwasp_testing::{catalogue, layers, resolve};

/// The model of an experiment with a design, written and loaded anew, and its text.
fn written(experiment: &Experiment, design: &[f64]) -> (Simulation, String) {
    let mechanism = experiment.task.built().mechanism.as_ref().unwrap();
    let files = mechanism.write(ModelFormat::Mjcf, design).unwrap();
    let text = String::from_utf8(files[0].contents.clone()).unwrap();
    let main = files[0].name.clone();
    let named = files.iter().map(|file| (file.name.clone(), Arc::from(&*file.contents)));
    let files = Files::new(named.collect::<Vec<(String, Arc<[u8]>)>>()).unwrap();
    (Spec::parse(&main, &files).unwrap().compile().unwrap(), text)
}

/// Masses, lengths and inertias follow of gear 100, rest 0, shank 0.6 m and stiffness 50 N·m/rad.
#[test]
fn the_hopper_has_the_masses_and_lengths_of_its_design() {
    let experiment = resolve(layers("hopper"), None).unwrap();
    assert_eq!(experiment.task.built().training.law.design().names(), ["gear", "rest", "shank", "stiffness"]);
    let (sim, text) = written(&experiment, &[100.0, 0.0, 0.6, 50.0]);
    let capsule = |radius: f64, length: f64| 900.0 * PI * radius * radius * (length + 4.0 / 3.0 * radius);
    let mass = |name: &str| {
        let inventory = sim.inventory();
        inventory.bodies.iter().find(|body| body.name.as_deref() == Some(name)).unwrap().mass
    };
    assert!((mass("shank") - capsule(0.035, 0.6)).abs() < 1e-9, "{}", mass("shank"));
    assert!((mass("thigh") - capsule(0.045, 0.45)).abs() < 1e-9, "{}", mass("thigh"));
    let start = sim.qpos().to_vec();
    let heights = ["shank", "foot"].map(|name| sim.body(name).unwrap());
    let mut upright = sim.clone();
    upright.forward().unwrap();
    let [shank, foot] = heights.map(|body| upright.body_position(body)[2]);
    assert!((shank - foot - 0.6).abs() < 1e-12);
    let forms: Vec<Form> = View::new(sim).sight(&start).solids.into_iter().map(|solid| solid.form).collect();
    assert!(forms.contains(&Form::Capsule { radius: 0.035, half_length: 0.3 }), "{forms:?}");
    // 0.02 + 2e-5·100² of the rotor.
    let knee = text.lines().find(|line| line.contains("name=\"knee\"")).unwrap();
    assert!(knee.contains("armature=\"0.22\""), "{knee}");
}

/// A mesh lies where the written model looks for it: beside it where it lay in the model's folder, else in folders as they were.
#[test]
fn a_mesh_goes_along() {
    for (meshes, place, written_as) in [
        ("shapes", "robots/shapes/dart.obj", ["robot.xml", "shapes/dart.obj"]),
        ("../shapes", "shapes/dart.obj", ["robots/robot.xml", "shapes/dart.obj"]),
    ] {
        let model = format!(
            r#"<mujoco><compiler meshdir="{meshes}"/><asset><mesh name="dart" file="dart.obj"/></asset>
            <worldbody><body name="dart"><joint name="slide" type="slide"/>
              <geom name="dart" type="mesh" mesh="dart" density="1000"/></body></worldbody>
            <actuator><motor name="push" joint="slide" ctrlrange="-1 1"/></actuator></mujoco>"#
        );
        let dart = "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nv 0 0 0.3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
        let files = [("robots/dart.xml", &*model), (place, dart)];
        let files = Named::from(files.map(|(path, text)| (path.to_owned(), Arc::from(text.as_bytes()))));
        let text = "name = \"dart\"\n[task]\nproblem = \"model\"\nmodel = \"robots/dart.xml\"\n[task.reward]\nalive = 1\n\
                    [task.design]\ndensity = { limits = [500, 2000], sets = [\"geom.dart.density = density\"] }\n";
        let layers = Layers::from_text("dart.toml", text).unwrap().with_folder(Folder::Sent(Arc::new(files)));
        let experiment =
            hwasp_experiment::resolve(layers, None, catalogue()).unwrap_or_else(|faults| panic!("{faults}"));
        let mechanism = experiment.task.built().mechanism.as_ref().unwrap();
        let names: Vec<String> =
            mechanism.write(ModelFormat::Mjcf, &[2000.0]).unwrap().into_iter().map(|file| file.name).collect();
        assert_eq!(names, written_as);
        let (sim, text) = written(&experiment, &[2000.0]);
        // A sixth of a cube of 0.3 m; the engine keeps corners in single precision.
        let mass = sim.inventory().bodies[1].mass;
        assert!((mass - 2000.0 * 0.3_f64.powi(3) / 6.0).abs() < 1e-4, "{mass}: {text}");
    }
}
