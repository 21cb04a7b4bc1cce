//! Parts as STEP files (ISO 10303-21, AP214), for programs that want solids instead of triangles.
//!
//! A file has one solid, whose faces are planes with straight edges: the faces of the mesh, triangles of one plane put together. Round
//! outlines are the polygons that they are in the mesh, so that both files are one shape to the last digit.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::parts::Part;
use crate::solid::faces;

/// Entities of a file, numbered as they come.
#[derive(Default)]
struct Entities {
    text: String,
    count: usize,
}

impl Entities {
    fn add(&mut self, entity: &str) -> usize {
        self.count += 1;
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "#{}={entity};", self.count);
        self.count
    }

    fn point(&mut self, at: [f64; 3]) -> usize {
        self.add(&format!("CARTESIAN_POINT('',{})", triple(at.map(|it| 1e3 * it))))
    }

    fn direction(&mut self, of: [f64; 3]) -> usize {
        self.add(&format!("DIRECTION('',{})", triple(of)))
    }
}

fn triple([x, y, z]: [f64; 3]) -> String {
    // STEP wants a decimal point in every real number.
    format!("({x:.9},{y:.9},{z:.9})")
}

/// A part as the text of a STEP file, mm.
pub fn step(part: &Part) -> String {
    let (faces, vertices) = faces(&part.mesh);
    let mut it = Entities::default();
    let mut vertex: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
    let mut edge: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    let mut of_faces = Vec::new();
    for face in &faces {
        let mut bounds = Vec::new();
        for chain in &face.loops {
            let mut oriented = Vec::new();
            for i in 0..chain.len() {
                let (from, to) = (chain[i], chain[(i + 1) % chain.len()]);
                let key = [from.min(to), from.max(to)];
                let curve = if let Some(&curve) = edge.get(&key) {
                    curve
                } else {
                    let ends = key.map(|index| {
                        *vertex.entry(index).or_insert_with(|| {
                            let point = it.point(vertices[index]);
                            (point, it.add(&format!("VERTEX_POINT('',#{point})")))
                        })
                    });
                    let curve = line(&mut it, ends, key.map(|index| vertices[index]));
                    edge.insert(key, curve);
                    curve
                };
                let same = if from < to { ".T." } else { ".F." };
                oriented.push(it.add(&format!("ORIENTED_EDGE('',*,*,#{curve},{same})")));
            }
            let ring = it.add(&format!("EDGE_LOOP('',{})", list(&oriented)));
            bounds.push((ring, area(chain, vertices, face.normal)));
        }
        // The outer loop is the one around all others.
        bounds.sort_by(|a, b| b.1.total_cmp(&a.1));
        let bounds: Vec<usize> = (bounds.iter().enumerate())
            .map(|(i, (ring, _))| {
                let kind = if i == 0 { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
                it.add(&format!("{kind}('',#{ring},.T.)"))
            })
            .collect();
        let first = face.loops[0][0];
        let second = face.loops[0][1];
        let origin = it.point(vertices[first]);
        let normal = it.direction(face.normal);
        let along = it.direction(unit(vertices[first], vertices[second]).0);
        let placed = it.add(&format!("AXIS2_PLACEMENT_3D('',#{origin},#{normal},#{along})"));
        let plane = it.add(&format!("PLANE('',#{placed})"));
        of_faces.push(it.add(&format!("ADVANCED_FACE('',{},#{plane},.T.)", list(&bounds))));
    }
    let shell = it.add(&format!("CLOSED_SHELL('',{})", list(&of_faces)));
    let solid = it.add(&format!("MANIFOLD_SOLID_BREP('{}',#{shell})", part.name));
    product(&mut it, part.name, solid);
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('{0}, a part of a hand'),'2;1');\n\
         FILE_NAME('{0}.step','',(''),(''),'hwasp','hwasp','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n{1}ENDSEC;\nEND-ISO-10303-21;\n",
        part.name, it.text
    )
}

/// What makes a solid the shape of a product, in mm and radians.
fn product(it: &mut Entities, name: &str, solid: usize) {
    let context = it.add("APPLICATION_CONTEXT('automotive design')");
    it.add(&format!("APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{context})"));
    let of_product = it.add(&format!("PRODUCT_CONTEXT('',#{context},'mechanical')"));
    let product = it.add(&format!("PRODUCT('{name}','{name}','',(#{of_product}))"));
    let formation = it.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
    let view = it.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{context},'design')"));
    let definition = it.add(&format!("PRODUCT_DEFINITION('design','',#{formation},#{view})"));
    let shape = it.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
    let length = it.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
    let angle = it.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    let solid_angle = it.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
    let exact = it.add(&format!("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),#{length},'distance','')"));
    let space = it.add(&format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{exact}))GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},\
         #{angle},#{solid_angle}))REPRESENTATION_CONTEXT('',''))"
    ));
    let origin = it.point([0.0; 3]);
    let up = it.direction([0.0, 0.0, 1.0]);
    let right = it.direction([1.0, 0.0, 0.0]);
    let placed = it.add(&format!("AXIS2_PLACEMENT_3D('',#{origin},#{up},#{right})"));
    let brep = it.add(&format!("ADVANCED_BREP_SHAPE_REPRESENTATION('{name}',(#{placed},#{solid}),#{space})"));
    it.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{brep})"));
}

/// A straight edge between two vertices (point and vertex of each).
fn line(it: &mut Entities, [(start, from), (_, to)]: [(usize, usize); 2], [a, b]: [[f64; 3]; 2]) -> usize {
    let (along, length) = unit(a, b);
    let along = it.direction(along);
    let vector = it.add(&format!("VECTOR('',#{along},{:.9})", 1e3 * length));
    let line = it.add(&format!("LINE('',#{start},#{vector})"));
    it.add(&format!("EDGE_CURVE('',#{from},#{to},#{line},.T.)"))
}

fn unit(from: [f64; 3], to: [f64; 3]) -> ([f64; 3], f64) {
    let along = [0, 1, 2].map(|i| to[i] - from[i]);
    let length = along.iter().map(|part| part * part).sum::<f64>().sqrt();
    (along.map(|part| part / length), length)
}

/// The area that a loop goes around, m², positive for the outer one.
fn area(chain: &[usize], vertices: &[[f64; 3]], normal: [f64; 3]) -> f64 {
    let mut sum = [0.0; 3];
    for i in 0..chain.len() {
        let ([ax, ay, az], [bx, by, bz]) = (vertices[chain[i]], vertices[chain[(i + 1) % chain.len()]]);
        let across = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
        sum = [0, 1, 2].map(|k| sum[k] + 0.5 * across[k]);
    }
    (0..3).map(|k| sum[k] * normal[k]).sum()
}

fn list(entities: &[usize]) -> String {
    let names: Vec<String> = entities.iter().map(|entity| format!("#{entity}")).collect();
    format!("({})", names.join(","))
}
