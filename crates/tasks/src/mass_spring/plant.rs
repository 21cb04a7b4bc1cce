//! The two masses.

use hwasp_core::Plant;

use super::MassSpringSettings;

/// What joins the two masses, and with it what the law's effort is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coupling {
    /// A rigid bar of this length, m. Effort: the force on the pair in N, *motor included*; the command itself is not
    /// added again.
    FixedBar(f64),
    /// A rigid bar whose length, m, is the effort, given anew with every action. The motor pulls the pair.
    GivenBar,
    /// Nothing. Efforts: the forces of the law on the upper and on the lower mass, N. The motor pulls the lower mass.
    Free,
}

/// Two point masses m1 at y1 and m2 at y2, metres below the ceiling, positive downwards (paper, section 5). There may be
/// a spring of its own, of stiffness K and no natural length, between ceiling and upper mass.
///
/// One action: the forces are evaluated once, from the state at its start, and held for all simulation steps; each is
/// v' = v + a·dt, y' = y + v·dt + a·dt²/2 (the paper's mid-point Euler). Only then positions and speeds are limited.
/// A rigid coupling moves y1 alone: y2 = y1 + l and v2 = v1 follow, and are not limited by themselves.
#[derive(Clone, Debug)]
pub struct MassSpringPlant {
    coupling: Coupling,
    m1: f64,
    m2: f64,
    g: f64,
    /// Stiffness of the plant's own spring, K; zero where the law supplies the springs.
    k: f64,
    dt: f64,
    /// dt²/2.
    half_dt2: f64,
    substeps: usize,
    max_position: f64,
    max_speed: f64,
    /// Infinite where there is none.
    effort_limit: f64,
    y1: f64,
    v1: f64,
    y2: f64,
    v2: f64,
}

impl MassSpringPlant {
    /// At rest at the ceiling. Only a plant of [`GivenBar`](Coupling::GivenBar) or [`Free`](Coupling::Free) has a spring of
    /// its own. The settings should be [checked](MassSpringSettings::check).
    pub fn new(settings: &MassSpringSettings, coupling: Coupling) -> Self {
        let (k, length) = match coupling {
            Coupling::FixedBar(length) => (0.0, length),
            Coupling::GivenBar | Coupling::Free => (settings.spring_stiffness, 0.0),
        };
        Self {
            coupling,
            m1: settings.upper_mass,
            m2: settings.lower_mass,
            g: settings.gravity,
            k,
            dt: settings.time_step,
            half_dt2: 0.5 * settings.time_step * settings.time_step,
            substeps: settings.substeps,
            max_position: settings.max_position,
            max_speed: settings.max_speed,
            effort_limit: settings.effort_limit.unwrap_or(f64::INFINITY),
            y1: 0.0,
            v1: 0.0,
            y2: length,
            v2: 0.0,
        }
    }

    /// Puts the upper mass at `y1`, the lower one `gap` below it (m), and both at the speed `v` (m/s). A fixed bar is as
    /// long as it is, and ignores the gap.
    pub fn place(&mut self, y1: f64, v: f64, gap: f64) {
        let gap = if let Coupling::FixedBar(length) = self.coupling { length } else { gap };
        (self.y1, self.v1, self.y2, self.v2) = (y1, v, y1 + gap, v);
    }

    /// What joins the masses.
    pub fn coupling(&self) -> Coupling {
        self.coupling
    }

    /// Position and velocity of the upper mass, m and m/s.
    #[inline]
    pub fn upper(&self) -> (f64, f64) {
        (self.y1, self.v1)
    }

    /// Position and velocity of the lower mass, m and m/s.
    #[inline]
    pub fn lower(&self) -> (f64, f64) {
        (self.y2, self.v2)
    }

    /// Position and velocity after one action under the constant acceleration `a`.
    #[inline]
    fn integrate(&self, mut y: f64, mut v: f64, a: f64) -> (f64, f64) {
        let (dv, dy) = (a * self.dt, a * self.half_dt2);
        for _ in 0..self.substeps {
            y += v * self.dt + dy;
            v += dv;
        }
        (y.clamp(0.0, self.max_position), v.clamp(-self.max_speed, self.max_speed))
    }

    /// Moves both masses as one body under this force, N, gravity not included.
    #[inline]
    fn move_pair(&mut self, force: f64, length: f64) {
        let a = self.g + force / (self.m1 + self.m2);
        (self.y1, self.v1) = self.integrate(self.y1, self.v1, a);
        (self.y2, self.v2) = (self.y1 + length, self.v1);
    }
}

impl Plant for MassSpringPlant {
    #[inline]
    fn advance(&mut self, effort: &[f64], command: &[f64]) {
        let limited = |force: f64| force.clamp(-self.effort_limit, self.effort_limit);
        match self.coupling {
            Coupling::FixedBar(length) => self.move_pair(limited(effort[0]), length),
            Coupling::GivenBar => self.move_pair(command[0] - self.k * self.y1, effort[0]),
            Coupling::Free => {
                let a1 = self.g + (limited(effort[0]) - self.k * self.y1) / self.m1;
                let a2 = self.g + (limited(effort[1]) + command[0]) / self.m2;
                (self.y1, self.v1) = self.integrate(self.y1, self.v1, a1);
                (self.y2, self.v2) = self.integrate(self.y2, self.v2, a2);
            }
        }
    }

    /// y1 (m), v1 (m/s), y2 (m), v2 (m/s).
    #[inline]
    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&[self.y1, self.v1, self.y2, self.v2]);
    }
}
