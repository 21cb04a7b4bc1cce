use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use hwasp_core::{End, EpisodeResult, Mesh, Outcome, Sight};
use serde_json::Value;

use super::*;
use crate::record::Moment;

/// Solids and a cord, at moments 0.05 s apart.
fn take(solids: impl Fn(usize) -> Vec<Solid>, cord: impl Fn(usize) -> Cord, moments: usize) -> Take {
    let moment = |i: usize| Moment {
        step: 5 * i,
        worth: 0.5 * i as f64,
        sight: Sight {
            solids: solids(i),
            cords: vec![cord(i)],
            about: "a <b>".into(),
            told: format!("moment {i}"),
            moments: vec![],
        },
    };
    let result = EpisodeResult {
        discounted_return: 1.5,
        undiscounted_return: 2.5,
        steps: 5 * moments,
        end: End::Truncated,
        ended_by: None,
        outcome: Some(Outcome { kind: "sphere".into(), success: true }),
        terms: vec![],
    };
    Take { index: 3, name: "best".into(), moments: (0..moments).map(moment).collect(), result, time_step: 0.01 }
}

fn json(takes: &[Take]) -> Value {
    serde_json::from_str(&Scene::new("a hand", takes).json()).unwrap()
}

/// The numbers in a text, as the viewer reads them.
fn numbers(text: &Value) -> Vec<f32> {
    let bytes = STANDARD.decode(text.as_str().unwrap()).unwrap();
    bytes.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect()
}

fn string(i: usize) -> Cord {
    Cord { parts: vec![vec![[0.0; 3], [1.0, 0.0, i as f64]], vec![[2.0; 3]; 3]], colour: [1, 2, 3] }
}

#[test]
fn what_moves_has_a_pose_for_each_moment_and_what_rests_has_one() {
    let ball = |i: usize| Solid::new(Form::Ellipsoid([0.1, 0.2, 0.3]), [0.5 * i as f64, 0.0, 1.0], [9, 8, 7]);
    let floor = Solid::new(Form::Plane([0.0; 2]), [0.0; 3], [1; 3]).fixed();
    // Grows, but stays.
    let rod = |i: usize| Solid::rod([[0.0; 3], [0.0, 0.0, 1.0 + i as f64]], 0.25, [4; 3]);
    let take = take(|i| vec![floor.clone(), ball(i), rod(i)], string, 3);
    let scene = json(&[take]);
    let episode = &scene["takes"][0];
    let solid = |i: usize| &episode["solids"][i];
    assert_eq!(numbers(&solid(0)["poses"]), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let upright = [0.0, 0.0, 0.0, 1.0];
    let poses: Vec<f32> = [0.0, 0.5, 1.0].iter().flat_map(|&x| [&[x, 0.0, 1.0][..], &upright].concat()).collect();
    assert_eq!(numbers(&solid(1)["poses"]), poses);
    assert_eq!(numbers(&solid(1)["sizes"]), [0.1, 0.2, 0.3]);
    assert_eq!(numbers(&solid(2)["sizes"]), [0.25, 0.25, 0.5, 0.25, 0.25, 1.0, 0.25, 0.25, 1.5]);
    assert_eq!(
        (&solid(0)["form"], &solid(0)["fixed"], &solid(2)["form"]),
        (&"plane".into(), &true.into(), &"capsule".into())
    );
    let way = |z: f32| vec![2.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0, z, 3.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0];
    assert_eq!(numbers(&episode["cords"][0]["ways"]), [way(0.0), way(1.0), way(2.0)].concat());
    let told = serde_json::json!({
        "index": 3, "name": "best", "about": "a <b>", "success": true, "kind": "sphere", "return": 2.5, "discounted_return": 1.5,
        "steps": 15, "times": [0.0, 0.05, 0.1], "told": ["moment 0", "moment 1", "moment 2"], "worth": [0.0, 0.5, 1.0],
    });
    for (key, value) in told.as_object().unwrap() {
        let (found, value) = (episode[key].to_string(), value.to_string());
        assert_eq!(found, value, "{key}");
    }
}

/// Turned about all axes by all angles: the quaternion gives the axes back.
#[test]
fn quaternions_turn_as_the_axes_do() {
    for step in 0..48 {
        let angle = f64::from(step) * 0.131;
        let (sin, cos) = angle.sin_cos();
        let about_x = Solid {
            axes: [[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -sin, cos]],
            ..Solid::new(Form::Box([1.0; 3]), [0.0; 3], [0; 3])
        };
        let solid = about_x.turned(1.7 * angle);
        let [x, y, z, w] = <[f32; 4]>::try_from(&pose(&solid)[3..]).unwrap().map(f64::from);
        let turned = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
            [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
            [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        for (found, expected) in turned.iter().flatten().zip(solid.axes.iter().flatten()) {
            assert!((found - expected).abs() < 1e-6, "{angle}: {turned:?}, {:?}", solid.axes);
        }
    }
}

#[test]
fn equal_meshes_are_there_once_for_all_takes() {
    let mesh = || Form::Mesh(Arc::new(Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])));
    let solids = |_| [0.0, 1.0].map(|x| Solid::new(mesh(), [x, 0.0, 0.0], [5; 3])).to_vec();
    let scene = json(&[take(solids, string, 2), take(solids, string, 2)]);
    assert_eq!(scene["surfaces"].as_array().unwrap().len(), 1);
    for take in 0..2 {
        for solid in 0..2 {
            assert_eq!(scene["takes"][take]["solids"][solid]["surface"], 0);
        }
    }
    assert_eq!(numbers(&scene["surfaces"][0]["points"]), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
}

#[test]
fn the_same_takes_give_the_same_text() {
    let solids = |i| vec![Solid::new(Form::Box([1.0; 3]), [i as f64; 3], [5; 3])];
    let [a, b] = [(); 2].map(|()| Scene::new("one", &[take(solids, string, 4)]).json());
    assert_eq!(a, b);
}
