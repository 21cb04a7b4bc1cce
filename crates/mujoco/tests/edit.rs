//! Changes of the model in place.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::{MASS, SHAPES, simulation, trajectory};
use hwasp_mujoco::engine::{EditError, Shape, Simulation};

fn edit(simulation: &mut Simulation, shape: Shape, mass: f64) {
    let (geom, body) = (simulation.geom("object").unwrap(), simulation.body("object").unwrap());
    simulation.edit().shape(geom, shape).unwrap().inertial(body, mass, shape.inertia(mass)).unwrap();
}

/// All changes of shape: the edited model falls, lands and slides to the bit like one compiled with the new shape, and so
/// does one that has been used before the change.
#[test]
fn an_edited_model_moves_like_a_compiled_one() {
    for to in SHAPES {
        let compiled = trajectory(&mut simulation(to, 2.0 * MASS, 1.0));
        for from in SHAPES {
            let mut edited = simulation(from, MASS, 1.0);
            assert!(trajectory(&mut edited) != compiled, "from {from:?} to {to:?} the test would see nothing");
            edit(&mut edited, to, 2.0 * MASS);
            assert!(trajectory(&mut edited) == compiled, "from {from:?} to {to:?}");
        }
    }
}

/// Bounding volumes follow: an enlarged sphere touches what it could not reach before.
#[test]
fn an_enlarged_sphere_touches() {
    let mut simulation = simulation(SHAPES[0], MASS, 1.0);
    let (object, left) = (simulation.geom("object").unwrap(), simulation.geom("left").unwrap());
    simulation.forward().unwrap();
    assert!(!simulation.touch(object, left));
    simulation.edit().shape(object, Shape::Sphere { radius: 0.1 }).unwrap();
    simulation.forward().unwrap();
    assert!(simulation.touch(object, left));
}

#[test]
fn friction_is_edited() {
    let slippery = trajectory(&mut simulation(SHAPES[1], MASS, 0.1));
    let mut edited = simulation(SHAPES[1], MASS, 1.5);
    assert!(trajectory(&mut edited) != slippery);
    // Of two geoms the larger coefficient counts.
    let floor = ["floor", "left", "right"].map(|name| edited.geom(name).unwrap());
    let object = edited.geom("object").unwrap();
    edited.edit().friction(object, [0.1, 0.005, 0.0001]).unwrap();
    assert!(trajectory(&mut edited) == slippery);
    let mut change = edited.edit();
    for geom in floor {
        change.friction(geom, [0.05, 0.005, 0.0001]).unwrap();
    }
    drop(change);
    assert!(trajectory(&mut edited) != slippery);
}

#[test]
fn impossible_values_are_errors() {
    let mut simulation = simulation(SHAPES[0], MASS, 1.0);
    let [object, floor] = ["object", "floor"].map(|name| simulation.geom(name).unwrap());
    let body = simulation.body("object").unwrap();
    let before = trajectory(&mut simulation);
    let mut change = simulation.edit();
    let flat = Shape::Box { half: [0.1, 0.0, 0.1] };
    let error = change.shape(object, flat).unwrap_err();
    assert!(error.to_string().starts_with("a length of 0 m of Box"), "{error}");
    assert!(matches!(
        change.shape(object, Shape::Sphere { radius: f64::NAN }),
        Err(EditError::Length { value, .. }) if value.is_nan()
    ));
    assert!(matches!(change.shape(floor, SHAPES[0]), Err(EditError::NoShape)));
    for mass in [0.0, -1.0, 1e-16, f64::INFINITY, f64::NAN] {
        assert!(matches!(change.inertial(body, mass, [1.0; 3]), Err(EditError::Mass(_))), "{mass}");
    }
    for inertia in [[0.0; 3], [1.0, 1.0, 2.1], [1.0, 1.0, f64::NAN], [-1.0, 1.0, 1.0]] {
        assert!(matches!(change.inertial(body, 1.0, inertia), Err(EditError::Inertia(_))), "{inertia:?}");
    }
    assert!(matches!(change.friction(object, [-0.1, 0.0, 0.0]), Err(EditError::Friction(_))));
    drop(change);
    assert_eq!(trajectory(&mut simulation), before, "an error changes nothing");
}

/// The textbook's moments, and the engine's own: it computes them from the geom if the body has no `inertial`.
#[test]
fn volumes_and_inertias_are_the_engines() {
    for shape in SHAPES {
        let (kind, size) = match shape {
            Shape::Sphere { radius } => ("sphere", vec![radius]),
            Shape::Box { half } => ("box", half.to_vec()),
            Shape::Cylinder { radius, half_length } => ("cylinder", vec![radius, half_length]),
            Shape::Ellipsoid { radii } => ("ellipsoid", radii.to_vec()),
        };
        let size = size.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        let mut simulation = Simulation::from_mjcf(&format!(
            r#"<mujoco><worldbody><body name="object"><freejoint/>
                <geom type="{kind}" size="{size}" density="700"/></body></worldbody></mujoco>"#
        ))
        .unwrap();
        let mass = simulation.mass(simulation.body("object").unwrap());
        assert!((700.0 * shape.volume() / mass - 1.0).abs() < 1e-12, "{shape:?}");
        simulation.forward().unwrap();
        let mut matrix = [0.0; 36];
        simulation.mass_matrix(&mut matrix);
        for (axis, moment) in shape.inertia(mass).into_iter().enumerate() {
            assert!((matrix[(3 + axis) * 7] / moment - 1.0).abs() < 1e-12, "{shape:?}, axis {axis}");
        }
    }
}
