//! The hand as what is built of its law.

use std::any::Any;

use hwasp_problem::Mechanism;

use super::HandDescription;

impl Mechanism for HandDescription {
    fn as_any(&self) -> &dyn Any {
        self
    }

    /// Springs as they are sold, pulleys as they are printed, and half the way between two holes 15° apart.
    fn manufacturing_errors(&self) -> Vec<(String, String)> {
        [("radius", "0.1 mm"), ("stiffness", "5 %"), ("preload", "0.13 rad")]
            .map(|(quantity, error)| (quantity.to_owned(), error.to_owned()))
            .to_vec()
    }
}
