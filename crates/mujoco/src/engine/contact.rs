//! What touches what.

use super::{GeomId, Simulation};

/// A contact that the solver acts on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The two geoms.
    pub geoms: [GeomId; 2],
    /// Midpoint in the world's frame, m.
    pub position: [f64; 3],
    /// Unit normal in the world's frame, from the first geom to the second.
    pub normal: [f64; 3],
    /// Distance of the surfaces, m; negative where they overlap.
    pub distance: f64,
}

/// What one geom does to another.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactForce {
    /// Number of contacts.
    pub contacts: usize,
    /// Sum of the forces along the normals, N; none is negative, but for geoms that stick.
    pub normal: f64,
    /// Force in the world's frame, N.
    pub force: [f64; 3],
    /// Torque about the centre of the geom that it acts on, in the world's frame, N·m.
    pub torque: [f64; 3],
}

impl Simulation {
    /// What `by` does to `on` where they touch, summed over their contacts, as the last step or [`Self::forward`] computed
    /// it.
    pub fn contact_force(&self, on: GeomId, by: GeomId) -> ContactForce {
        let mut sum = ContactForce::default();
        let centre = self.geom_position(on);
        for (index, contact) in self.data().contact().iter().enumerate() {
            // Along its normal the engine gives the force on the second geom.
            let sign = match contact.geom.map(|geom| usize::try_from(geom).ok().map(GeomId)) {
                [Some(a), Some(b)] if a == by && b == on => 1.0,
                [Some(a), Some(b)] if a == on && b == by => -1.0,
                _ => continue,
            };
            if contact.exclude != 0 {
                continue;
            }
            let local = self.data().contact_force(index);
            let world = |part: &[f64]| -> [f64; 3] {
                std::array::from_fn(|axis| {
                    sign * (0..3).map(|row| part[row] * contact.frame[3 * row + axis]).sum::<f64>()
                })
            };
            let (force, torque) = (world(&local[..3]), world(&local[3..]));
            let arm: [f64; 3] = std::array::from_fn(|axis| contact.pos[axis] - centre[axis]);
            sum.contacts += 1;
            sum.normal += local[0];
            for axis in 0..3 {
                let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
                sum.force[axis] += force[axis];
                sum.torque[axis] += torque[axis] + arm[next] * force[last] - arm[last] * force[next];
            }
        }
        sum
    }

    /// The contacts between geoms that the last step or [`Self::forward`] acted on, in the engine's order.
    pub fn contacts(&self) -> impl Iterator<Item = Contact> + '_ {
        self.data().contact().iter().filter_map(|contact| {
            // Excluded contacts lie within the gap or move nothing; of contacts with soft bodies one geom is -1.
            let geoms = [usize::try_from(contact.geom[0]).ok()?, usize::try_from(contact.geom[1]).ok()?];
            (contact.exclude == 0).then(|| Contact {
                geoms: geoms.map(GeomId),
                position: contact.pos,
                normal: [contact.frame[0], contact.frame[1], contact.frame[2]],
                distance: contact.dist,
            })
        })
    }

    /// Whether two geoms touch.
    pub fn touch(&self, a: GeomId, b: GeomId) -> bool {
        self.contacts().any(|contact| contact.geoms == [a, b] || contact.geoms == [b, a])
    }

    /// Which geoms of `set` touch any geom of `of`: `touched[i]` says it of `set[i]`. Returns how many do.
    ///
    /// # Panics
    ///
    /// If `touched` is not as long as `set`.
    pub fn touching(&self, of: &[GeomId], set: &[GeomId], touched: &mut [bool]) -> usize {
        assert_eq!(set.len(), touched.len(), "one answer for each geom of the set");
        touched.fill(false);
        for Contact { geoms: [a, b], .. } in self.contacts() {
            for (geom, other) in [(a, b), (b, a)] {
                if of.contains(&other)
                    && let Some(index) = set.iter().position(|&member| member == geom)
                {
                    touched[index] = true;
                }
            }
        }
        touched.iter().filter(|&&touches| touches).count()
    }
}
