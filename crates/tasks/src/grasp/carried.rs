//! Where an object is when nobody follows it: known at the start, and carried with the palm once the grasp is felt.

/// The place of an object that was told once. On the bench of the paper no camera saw the object while the hand held it.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedObject {
    told: [f64; 3],
    felt_at: f64,
    /// From palm to object, m, once it is held.
    held: Option<[f64; 3]>,
}

impl CarriedObject {
    /// An object whose centre is at `told`, m; it is held from the moment on when the motor's torque, N·m, reads `felt_at`.
    pub fn new(told: [f64; 3], felt_at: f64) -> Self {
        Self { told, felt_at, held: None }
    }

    /// Where it is taken to be, m, with the palm at `palm`, m, and the motor's torque reading `torque`, N·m. To be asked once a step, in
    /// order.
    pub fn place(&mut self, palm: [f64; 3], torque: f64) -> [f64; 3] {
        if self.held.is_none() && torque >= self.felt_at {
            self.held = Some([0, 1, 2].map(|i| self.told[i] - palm[i]));
        }
        self.held.map_or(self.told, |held| [0, 1, 2].map(|i| palm[i] + held[i]))
    }

    /// Whether the grasp was felt.
    pub fn is_held(&self) -> bool {
        self.held.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_stays_until_it_is_felt_and_then_goes_along() {
        let mut object = CarriedObject::new([0.01, 0.0, 0.03], 0.3);
        assert_eq!(object.place([0.0, 0.0, 0.2], 0.29), [0.01, 0.0, 0.03]);
        assert_eq!(object.place([0.0, 0.0, 0.125], 0.3), [0.01, 0.0, 0.03]);
        assert!(object.is_held());
        let lifted = object.place([0.0, 0.5, 0.625], 0.0);
        assert!(lifted.iter().zip([0.01, 0.5, 0.53]).all(|(a, b)| (a - b).abs() < 1e-15), "{lifted:?}");
    }
}
