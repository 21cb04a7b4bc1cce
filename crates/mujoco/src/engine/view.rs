//! What is seen of a model: [`View`].

use hwasp_core::{Cord, Form, Mesh, Sight, Solid};
use mujoco_rs::prelude::{MjModel, MjtGeomBase};

use super::Simulation;

/// Geoms and tendons of these groups are seen, as in the engine's own viewer: higher ones are those that only touch.
const SEEN_GROUPS: std::ops::RangeInclusive<i32> = 0..=2;
/// The most solids that are shown: the largest ones.
const MOST_SOLIDS: usize = 150;
/// The most rows and columns of points of a height field.
const MOST_ROWS: usize = 24;
/// What the engine gives a geom for which no colour was said.
const NO_COLOUR: [f32; 4] = [0.5, 0.5, 0.5, 1.0];

/// A model that takes poses to be looked at. It is apart from whatever runs: to look changes nothing there.
#[derive(Clone, Debug)]
pub struct View {
    sim: Simulation,
    solids: Vec<(usize, Solid)>,
    /// Tendons with their colours.
    cords: Vec<(usize, [u8; 3])>,
}

impl View {
    /// Of a simulation, whose state does not matter.
    pub fn new(sim: Simulation) -> Self {
        let model = sim.model();
        let shown = |group: i32, opacity: f32| SEEN_GROUPS.contains(&group) && opacity > 0.0;
        let paints: Vec<[f32; 4]> = (0..model.geom_type().len()).map(|geom| paint(model, geom)).collect();
        let ground = |geom: usize| is_ground(model.geom_type()[geom]);
        let mut geoms: Vec<usize> =
            (0..paints.len()).filter(|&geom| shown(model.geom_group()[geom], paints[geom][3])).collect();
        if geoms.iter().all(|&geom| ground(geom)) {
            // A model that only has what touches shows that.
            geoms = (0..paints.len()).collect();
        }
        let size = |&geom: &usize| if ground(geom) { f64::INFINITY } else { model.geom_rbound()[geom] };
        geoms.sort_by(|a, b| size(b).total_cmp(&size(a)));
        geoms.truncate(MOST_SOLIDS);
        geoms.sort_unstable();
        let solid = |geom: usize| {
            let [red, green, blue, opacity] = paints[geom];
            let solid = Solid {
                form: form(model, geom)?,
                at: [0.0; 3],
                axes: [[0.0; 3]; 3],
                colour: [red, green, blue].map(shade),
                opacity: if opacity > 0.0 { opacity.min(1.0) } else { 1.0 },
                fixed: model.body_weldid()[model.geom_bodyid()[geom] as usize] == 0,
            };
            Some((geom, solid))
        };
        let solids = geoms.into_iter().filter_map(solid).collect();
        let cord = |tendon: usize| {
            let [red, green, blue, opacity] = model.tendon_rgba()[tendon];
            shown(model.tendon_group()[tendon], opacity).then(|| (tendon, [red, green, blue].map(shade)))
        };
        let cords = (0..model.tendon_rgba().len()).filter_map(cord).collect();
        Self { sim, solids, cords }
    }

    /// What is seen at these positions ([`Simulation::qpos`]).
    ///
    /// # Panics
    /// If they are not as many as the model has.
    pub fn sight(&mut self, positions: &[f64]) -> Sight {
        self.sim.qpos_mut().copy_from_slice(positions);
        let data = self.sim.data_mut();
        data.kinematics();
        data.com_pos();
        data.tendon_comp();
        let data = self.sim.data();
        let solid = |(geom, solid): &(usize, Solid)| {
            let [a, b, c, d, e, f, g, h, i] = data.geom_xmat()[*geom];
            Solid { at: data.geom_xpos()[*geom], axes: [[a, d, g], [b, e, h], [c, f, i]], ..solid.clone() }
        };
        let cord = |&(tendon, colour): &(usize, [u8; 3])| Cord { parts: self.parts(tendon), colour };
        Sight {
            solids: self.solids.iter().map(solid).collect(),
            cords: self.cords.iter().map(cord).collect(),
            ..Sight::default()
        }
    }

    /// The way of a tendon; one over joints has none.
    fn parts(&self, tendon: usize) -> Vec<Vec<[f64; 3]>> {
        let data = self.sim.data();
        let first = data.ten_wrapadr()[tendon].max(0) as usize;
        let points = first..first + data.ten_wrapnum()[tendon].max(0) as usize;
        let mut parts = vec![Vec::new()];
        for point in points {
            // Two points in each row of the engine's arrays.
            let (row, half) = (point / 2, point % 2);
            let [a, b, c, d, e, f] = data.wrap_xpos()[row];
            // A pulley parts the tendon.
            if data.wrap_obj()[row][half] == -2 {
                parts.push(Vec::new());
            } else if let Some(part) = parts.last_mut() {
                part.push(if half == 0 { [a, b, c] } else { [d, e, f] });
            }
        }
        parts.retain(|part| part.len() > 1);
        parts
    }
}

/// A share of a colour as a byte.
fn shade(share: f32) -> u8 {
    (255.0 * share.clamp(0.0, 1.0)).round() as u8
}

fn is_ground(kind: MjtGeomBase) -> bool {
    matches!(kind, MjtGeomBase::mjGEOM_PLANE | MjtGeomBase::mjGEOM_HFIELD)
}

/// A geom's colour: its own, or that of its material where none was said.
fn paint(model: &MjModel, geom: usize) -> [f32; 4] {
    let own = model.geom_rgba()[geom];
    match usize::try_from(model.geom_matid()[geom]) {
        Ok(material) if own == NO_COLOUR => model.mat_rgba()[material],
        _ => own,
    }
}

/// The shape of a geom; none where there is nothing to be drawn.
fn form(model: &MjModel, geom: usize) -> Option<Form> {
    let [x, y, z] = model.geom_size()[geom];
    let data = usize::try_from(model.geom_dataid()[geom]).ok();
    Some(match model.geom_type()[geom] {
        MjtGeomBase::mjGEOM_PLANE => Form::Plane([x, y]),
        MjtGeomBase::mjGEOM_HFIELD => field(model, data?),
        MjtGeomBase::mjGEOM_SPHERE => Form::Ellipsoid([x; 3]),
        MjtGeomBase::mjGEOM_CAPSULE => Form::Capsule { radius: x, half_length: y },
        MjtGeomBase::mjGEOM_ELLIPSOID => Form::Ellipsoid([x, y, z]),
        MjtGeomBase::mjGEOM_CYLINDER => Form::Cylinder { radius: x, half_length: y },
        MjtGeomBase::mjGEOM_BOX => Form::Box([x, y, z]),
        MjtGeomBase::mjGEOM_MESH | MjtGeomBase::mjGEOM_SDF => mesh(model, data?),
    })
}

/// A height field, with fewer points where it has many.
fn field(model: &MjModel, field: usize) -> Form {
    let [rows, columns] = [model.hfield_nrow()[field], model.hfield_ncol()[field]].map(|count| count.max(1) as usize);
    let [x, y, top, _] = model.hfield_size()[field];
    let heights = &model.hfield_data()[model.hfield_adr()[field].max(0) as usize..][..rows * columns];
    let some = |count: usize| {
        let shown = count.min(MOST_ROWS);
        (0..shown).map(move |i| if shown > 1 { i * (count - 1) / (shown - 1) } else { 0 })
    };
    let place = |i: usize, count: usize, half: f64| -half + 2.0 * half * i as f64 / (count - 1).max(1) as f64;
    let point = |row: usize, column: usize| {
        let height = top * f64::from(heights[row * columns + column]);
        [place(column, columns, x), place(row, rows, y), height]
    };
    Form::Field(some(rows).map(|row| some(columns).map(|column| point(row, column)).collect()).collect())
}

/// The triangles of a mesh.
fn mesh(model: &MjModel, mesh: usize) -> Form {
    let part = |first: i32, count: i32| first.max(0) as usize..(first.max(0) + count.max(0)) as usize;
    let points = &model.mesh_vert()[part(model.mesh_vertadr()[mesh], model.mesh_vertnum()[mesh])];
    let faces = &model.mesh_face()[part(model.mesh_faceadr()[mesh], model.mesh_facenum()[mesh])];
    let points = points.iter().map(|point| point.map(f64::from)).collect();
    let faces = faces.iter().map(|face| face.map(|point| point.max(0) as u32)).collect();
    Form::Mesh(Mesh::new(points, faces).into())
}
