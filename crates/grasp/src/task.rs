//! What grasping is about: the observation, the reward and success.

use std::sync::Arc;

use hwasp_core::{EnvSpec, Outcome, Sight, Stream, Task};
use rand::RngExt;

use crate::hold::{Hold, distance};
use crate::object::Object;
use crate::plant::GraspPlant;
use crate::settings::{GraspSettings, ShapeKind, Viewpoint};
use hwasp_mujoco::engine::View;
use hwasp_tasks::grasp::env_spec;
use hwasp_tasks::grasp::rules::HOLD_HEIGHT;

/// What a row of stills shows: the last two are half of what success asks for, and all of it.
const MOMENTS: [&str; 4] = ["contact", "lifted", "raised 5 cm", "raised 10 cm"];

/// Z-Grasp or 3D-Grasp.
#[derive(Clone, Debug)]
pub struct GraspTask {
    settings: GraspSettings,
    hold: Hold,
    /// From the palm to the object as seen from above, at the end of the last step, m.
    beside: f64,
    /// The names of the shapes, in the order of [`ShapeKind::ALL`].
    kinds: [Arc<str>; ShapeKind::ALL.len()],
    /// The shape of the object at hand, by its place among them.
    kind: usize,
    /// How far training has come.
    progress: f64,
    /// What is seen in the episode at hand, once somebody looks.
    view: Option<View>,
}

impl GraspTask {
    pub(super) fn new(settings: GraspSettings) -> Self {
        let kinds = ShapeKind::EACH.map(|kind| Arc::from(kind.name()));
        let kind = settings.shapes[0] as usize;
        Self { settings, hold: Hold::default(), beside: 0.0, kinds, kind, progress: 1.0, view: None }
    }
}

/// How far one is from being above the other, m.
fn beside(palm: [f64; 3], object: [f64; 3]) -> f64 {
    (palm[0] - object[0]).hypot(palm[1] - object[1])
}

impl Task for GraspTask {
    type Plant = GraspPlant;

    fn spec(&self) -> EnvSpec {
        let GraspSettings { hand, palm, bench, palm_step, horizon, .. } = &self.settings;
        env_spec(hand, *palm, bench.travel_sensed, *palm_step, *horizon)
    }

    fn set_progress(&mut self, progress: f64) {
        self.progress = progress;
    }

    fn reset(&mut self, plant: &mut GraspPlant, rng: &mut Stream) {
        let [from, to] = self.settings.height;
        let above = from + (to - from) * rng.random::<f64>();
        let object = Object::draw(&self.settings, self.progress, rng);
        self.kind = object.kind as usize;
        self.view = None;
        self.hold.start();
        let top = object.bounding_box()[2];
        // Settings were checked: what is drawn from them is a body.
        let started = plant.start(object, top + above, self.progress, rng);
        debug_assert!(started.is_ok(), "{started:?}");
        self.beside = beside(plant.palm(), plant.object_position());
    }

    fn observe(&self, plant: &GraspPlant, out: &mut [f64]) {
        plant.observe(out);
        if self.settings.viewpoint == Viewpoint::Palm {
            for i in 0..3 {
                out[3 + i] -= out[i];
            }
        }
    }

    /// Mass, kg, coefficient of friction, 1 for the object's shape and 0 for the others, moments of inertia, kg·m².
    fn context(&self, plant: &GraspPlant, out: &mut [f64]) {
        let object = plant.object();
        let shapes = ShapeKind::EACH.map(|kind| if kind == object.kind { 1.0 } else { 0.0 });
        let about = [object.mass, object.friction].into_iter().chain(shapes).chain(object.inertia);
        for (out, value) in out.iter_mut().zip(about) {
            *out = value;
        }
    }

    fn reward(&mut self, plant: &GraspPlant, command: &[f64]) -> f64 {
        let (palm, object, clearance) = (plant.palm(), plant.object_position(), plant.clearance());
        let touching = plant.touching();
        self.hold.note(clearance, touching, palm, object);
        let reward = &self.settings.reward;
        let distal = [1, 3, 5].iter().filter(|&&link| touching[link]).count();
        let lifted = reward.height.iter().rev().find(|(from, _)| clearance >= *from).map_or(0.0, |(_, worth)| *worth);
        let before = std::mem::replace(&mut self.beside, beside(palm, object));
        let nearer = reward.approach * (before - self.beside);
        let sideways = if let [x, y, _, _] = command { reward.sideways * x.hypot(*y) } else { 0.0 };
        reward.distance * distance(palm, object) + reward.contact * distal as f64 + lifted + nearer + sideways
    }

    fn look(&mut self, plant: &GraspPlant) -> Option<Sight> {
        let view = self.view.get_or_insert_with(|| View::new(plant.simulation().clone()));
        let mut sight = view.sight(plant.simulation().qpos());
        let Object { size, mass, friction, .. } = plant.object();
        let [x, y, z] = size.map(|edge| 1e3 * edge);
        sight.about = format!("{x:.0} × {y:.0} × {z:.0} mm, {:.0} g, friction {friction:.2}", 1e3 * mass);
        let clearance = plant.clearance();
        sight.told = format!("{:.0} mm above the floor", (1e3 * clearance).max(0.0));
        // Contacts are computed by the first step; before it there are none.
        let touches = self.hold.steps() > 0 && plant.touching().contains(&true);
        let seen = [touches, clearance > 0.002, clearance >= 0.5 * HOLD_HEIGHT, clearance >= HOLD_HEIGHT];
        sight.moments = MOMENTS.into_iter().zip(seen).filter_map(|(name, seen)| seen.then_some(name)).collect();
        Some(sight)
    }

    fn outcome(&self) -> Option<Outcome> {
        Some(Outcome { kind: Arc::clone(&self.kinds[self.kind]), success: self.hold.success() })
    }
}
