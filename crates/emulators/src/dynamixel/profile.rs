//! How a motor gets to its goal: no faster than it may, and no harder.

/// Where the goal within is, and how fast it moves; ticks and ticks a second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Profile {
    pub(super) position: f64,
    pub(super) velocity: f64,
}

impl Profile {
    /// Takes on a speed at no more than `acceleration`, ticks/s², and moves for `dt`, s.
    pub(super) fn speed_up(&mut self, speed: f64, acceleration: f64, dt: f64) {
        let most = acceleration * dt;
        self.velocity += (speed - self.velocity).clamp(-most, most);
        self.position += self.velocity * dt;
    }

    /// Moves towards `goal` for `dt`, s, at no more than `speed`, ticks/s, and slows down in time.
    pub(super) fn approach(&mut self, goal: f64, speed: f64, acceleration: f64, dt: f64) {
        let left = goal - self.position;
        // The speed from which it can still stop there, one step ahead: v²/2a + v·dt/2 = left.
        let stopping = if acceleration.is_finite() {
            let half = 0.5 * acceleration * dt;
            (half * half + 2.0 * acceleration * left.abs()).sqrt() - half
        } else {
            f64::INFINITY
        };
        let wanted = speed.min(stopping).min(left.abs() / dt);
        self.speed_up(wanted.copysign(left), acceleration, dt);
        // The last bit of the way is a step, not a fraction of one.
        if (goal - self.position).abs() < 1e-6 {
            *self = Self { position: goal, velocity: if left == 0.0 { 0.0 } else { self.velocity } };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_arrives_and_stays_within_its_limits() {
        for (speed, acceleration) in [(1000.0, 4000.0), (1000.0, f64::INFINITY), (1e9, 4000.0)] {
            let mut profile = Profile { position: -100.0, velocity: 0.0 };
            let (mut fastest, mut hardest, mut steps) = (0.0_f64, 0.0_f64, 0);
            while profile.position != 900.0 && steps < 5000 {
                let before = profile;
                profile.approach(900.0, speed, acceleration, 0.001);
                fastest = fastest.max(profile.velocity.abs());
                hardest = hardest.max((profile.velocity - before.velocity).abs() / 0.001);
                assert!(profile.position <= 900.0 + 1e-9, "{profile:?}");
                steps += 1;
            }
            assert!(steps < 3000 && fastest <= speed * (1.0 + 1e-12), "{steps} steps at {fastest}");
            // The last step may brake to the full.
            assert!(hardest <= acceleration * 1.5, "{hardest}");
            profile.approach(900.0, speed, acceleration, 0.001);
            profile.approach(900.0, speed, acceleration, 0.001);
            assert_eq!(profile, Profile { position: 900.0, velocity: profile.velocity });
        }
    }
}
