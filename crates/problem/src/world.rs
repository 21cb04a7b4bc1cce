//! A mechanism in a world.

use std::fmt;
use std::sync::{Arc, OnceLock};

use hwasp_core::{EnvSpec, Environment, Initial, Law, MakeEnvironment};

use crate::error::AnyError;

/// A mechanism in a world: its law, and environments for it.
#[derive(Clone)]
pub struct World {
    /// The mechanism's law.
    pub law: Law,
    /// What the environments are from outside.
    pub env: EnvSpec,
    /// Makes environments. Where physics are set up later, [`ready`](Self::ready) is to be asked first.
    pub make: Arc<dyn MakeEnvironment>,
    later: Option<Arc<Later>>,
}

impl World {
    /// A world whose physics are there.
    pub fn new(law: Law, make: impl MakeEnvironment + 'static) -> Self {
        Self::shared(law, Arc::new(make))
    }

    /// The same, of environments that are shared already.
    pub fn shared(law: Law, make: Arc<dyn MakeEnvironment>) -> Self {
        let env = make.make(None).spec().clone();
        Self { law, env, make, later: None }
    }

    /// The same of environments that are known from outside, so that none is made to ask it.
    pub fn described(law: Law, env: EnvSpec, make: Arc<dyn MakeEnvironment>) -> Self {
        Self { law, env, make, later: None }
    }

    /// A world whose physics are set up when they are asked for: a model that has to be compiled, an engine that may be missing.
    /// `env` is what the environments will be from outside.
    pub fn later(
        law: Law,
        env: EnvSpec,
        make: impl Fn() -> Result<Arc<dyn MakeEnvironment>, AnyError> + Send + Sync + 'static,
    ) -> Self {
        let later = Arc::new(Later { make: Box::new(make), made: OnceLock::new() });
        Self { law, env, make: Arc::clone(&later) as Arc<dyn MakeEnvironment>, later: Some(later) }
    }

    /// Sets the physics up, once.
    ///
    /// # Errors
    /// Why they cannot be.
    pub fn ready(&self) -> Result<(), String> {
        self.later.as_ref().map_or(Ok(()), |later| later.made().as_ref().map(|_| ()).map_err(Clone::clone))
    }

    /// The same world with episodes of so many steps, unless shorter ones are asked for.
    #[must_use]
    pub fn with_horizon(mut self, horizon: usize) -> Self {
        let make = Arc::clone(&self.make);
        self.env.horizon = horizon;
        self.make = Arc::new(WithHorizon { make, horizon });
        self
    }

    /// The same world whose design begins elsewhere: at one start for each group.
    ///
    /// # Errors
    /// Of starts outside of their limits, or not one for each group.
    pub fn beginning(mut self, initial: &[Initial]) -> Result<Self, AnyError> {
        self.law = self.law.beginning(initial)?;
        Ok(self)
    }
}

impl fmt::Debug for World {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("World").field("law", &self.law).field("env", &self.env).finish_non_exhaustive()
    }
}

/// Environments with episodes of so many steps, unless shorter ones are asked for.
struct WithHorizon {
    make: Arc<dyn MakeEnvironment>,
    horizon: usize,
}

impl MakeEnvironment for WithHorizon {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        self.make.make(Some(horizon.unwrap_or(self.horizon)))
    }

    fn make_many(&self, count: usize, horizon: Option<usize>) -> Vec<Box<dyn Environment>> {
        self.make.make_many(count, Some(horizon.unwrap_or(self.horizon)))
    }
}

type Make = dyn Fn() -> Result<Arc<dyn MakeEnvironment>, AnyError> + Send + Sync;

/// Physics that are set up when they are asked for.
struct Later {
    make: Box<Make>,
    made: OnceLock<Result<Arc<dyn MakeEnvironment>, String>>,
}

impl Later {
    fn made(&self) -> &Result<Arc<dyn MakeEnvironment>, String> {
        self.made.get_or_init(|| (self.make)().map_err(|error| error.to_string()))
    }
}

impl MakeEnvironment for Later {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        match self.made() {
            Ok(make) => make.make(horizon),
            Err(error) => panic!("World::ready is asked before the first environment is made: {error}"),
        }
    }

    fn make_many(&self, count: usize, horizon: Option<usize>) -> Vec<Box<dyn Environment>> {
        match self.made() {
            Ok(make) => make.make_many(count, horizon),
            Err(error) => panic!("World::ready is asked before the first environment is made: {error}"),
        }
    }
}
