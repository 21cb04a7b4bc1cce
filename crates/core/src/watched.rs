//! Environments that somebody watches, or changes.

use std::sync::Arc;

use crate::environment::{EnvSpec, Environment, Outcome, Step};
use crate::sight::Sight;
use crate::streams::Stream;

/// What comes between an environment and who drives it. All that is not written here passes as it is.
pub trait Watch: Send {
    /// In the place of [`Environment::set_progress`].
    fn set_progress(&mut self, inner: &mut dyn Environment, progress: f64) {
        inner.set_progress(progress);
    }

    /// In the place of [`Environment::reset`].
    fn reset(&mut self, inner: &mut dyn Environment, rng: &mut Stream) {
        inner.reset(rng);
    }

    /// In the place of [`Environment::step`].
    fn step(&mut self, inner: &mut dyn Environment, effort: &[f64], command: &[f64]) -> Step;
}

/// An environment with a [`Watch`].
pub struct Watched<W> {
    inner: Box<dyn Environment>,
    watch: W,
}

impl<W: Watch> Watched<W> {
    /// Puts a watch before an environment.
    pub fn new(inner: Box<dyn Environment>, watch: W) -> Self {
        Self { inner, watch }
    }
}

impl<W: Watch> Environment for Watched<W> {
    fn spec(&self) -> &EnvSpec {
        self.inner.spec()
    }

    fn set_progress(&mut self, progress: f64) {
        self.watch.set_progress(&mut *self.inner, progress);
    }

    fn set_design(&mut self, design: &[f64]) {
        self.inner.set_design(design);
    }

    fn reset(&mut self, rng: &mut Stream) {
        self.watch.reset(&mut *self.inner, rng);
    }

    fn observe(&self, out: &mut [f64]) {
        self.inner.observe(out);
    }

    fn state(&self, out: &mut [f64]) {
        self.inner.state(out);
    }

    fn context(&self, out: &mut [f64]) {
        self.inner.context(out);
    }

    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step {
        self.watch.step(&mut *self.inner, effort, command)
    }

    fn terms(&self) -> &[f64] {
        self.inner.terms()
    }

    fn ended_by(&self) -> Option<Arc<str>> {
        self.inner.ended_by()
    }

    fn outcome(&self) -> Option<Outcome> {
        self.inner.outcome()
    }

    fn look(&mut self) -> Option<Sight> {
        self.inner.look()
    }

    fn fault(&self) -> Option<String> {
        self.inner.fault()
    }
}
