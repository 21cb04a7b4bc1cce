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

impl Simulation {
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
