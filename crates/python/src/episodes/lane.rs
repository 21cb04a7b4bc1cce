//! One environment and the episode in it.

use std::sync::{Mutex, PoisonError};

use hwasp_core::{ActionDecoder, End, EnvSpec, Environment, HardwarePolicy, Normalizer, Policy as _, Purpose, stream};
use hwasp_training::World;

/// What is the same in all lanes.
pub(super) struct Interface {
    pub(super) env: EnvSpec,
    pub(super) names: Vec<String>,
    /// Of each component of an action, SI; none of an effort.
    pub(super) limits: Vec<Option<(f64, f64)>>,
    /// How many of them, the first ones, are drawn once an episode.
    pub(super) drawn: usize,
    /// Which design parameter each of them is, and those after them that are drawn in every step.
    pub(super) draws: Vec<usize>,
    /// The world's model is made from what is drawn, so that it is put into its start again when the draw is known.
    pub(super) restarts: bool,
    pub(super) normalizer: Option<Normalizer>,
    /// Actions are from -1 to 1 where they have limits.
    pub(super) scaled: bool,
    pub(super) progress: f64,
    /// Names of design parameters with their limits, SI.
    pub(super) parameters: Vec<(String, f64, f64)>,
}

impl Interface {
    pub(super) fn new(
        policy: &HardwarePolicy,
        params: &[f32],
        world: &World,
        scaled: bool,
        scale_observations: bool,
        progress: f64,
    ) -> Self {
        let names = policy.action_names().to_vec();
        let limits = policy.action_limits();
        let limits = limits.into_iter().map(|limits| limits.map(|(lo, hi)| (f64::from(lo), f64::from(hi)))).collect();
        let (drawn, space) = (policy.drawn_actions(), policy.space());
        let all = space.names();
        let place = |name: &String| all.iter().position(|known| known == name);
        let draws: Vec<usize> = names.iter().map_while(place).collect();
        let shaped = |&i: &usize| world.env.shaped_by.contains(&space.group_of(i).name);
        Self {
            env: world.env.clone(),
            limits,
            drawn,
            restarts: draws[..drawn].iter().any(shaped),
            draws,
            normalizer: scale_observations.then(|| policy.normalizer(params)),
            scaled,
            names,
            progress,
            parameters: all
                .into_iter()
                .enumerate()
                .map(|(i, name)| (name, space.bounds(i).0, space.bounds(i).1))
                .collect(),
        }
    }

    /// An action's component in SI.
    fn si(&self, i: usize, value: f64) -> f64 {
        match self.limits[i] {
            Some((lo, hi)) if self.scaled => 0.5 * (lo + hi) + 0.5 * (hi - lo) * value.clamp(-1.0, 1.0),
            _ => value,
        }
    }
}

/// One environment and the episode in it.
pub(super) struct Lane {
    /// Never locked: whoever has a lane to itself needs no lock.
    pub(super) environment: Mutex<Box<dyn Environment>>,
    pub(super) decoder: ActionDecoder,
    /// What the hardware was built to, SI.
    pub(super) built: Vec<f64>,
    /// The whole design of the episode, SI: as built, but for what is drawn.
    pub(super) design: Vec<f64>,
    pub(super) seed: u64,
    /// The index of the episode at hand under this seed.
    pub(super) episode: u64,
    /// Whether an episode is under way.
    pub(super) begun: bool,
    pub(super) steps: u64,
    pub(super) state: Vec<f64>,
    pub(super) seen: Vec<f64>,
    pub(super) action: Vec<f64>,
    pub(super) unsampled: Vec<f64>,
    pub(super) obs: Vec<f32>,
    /// The observation with which the last episode ended, where the next one has begun since.
    pub(super) last: Vec<f32>,
    pub(super) reward: f64,
    pub(super) end: Option<End>,
}

impl Lane {
    /// One that has not begun.
    pub(super) fn new(
        interface: &Interface,
        policy: &HardwarePolicy,
        design: &[f64],
        environment: Box<dyn Environment>,
    ) -> Self {
        let mut decoder = policy.action_decoder();
        decoder.build(design);
        let seen = interface.env.observation.len();
        Self {
            environment: Mutex::new(environment),
            built: design.to_vec(),
            design: design.to_vec(),
            seed: 0,
            episode: 0,
            begun: false,
            steps: 0,
            state: vec![0.0; interface.env.state.len()],
            seen: vec![0.0; seen],
            action: vec![0.0; interface.names.len()],
            unsampled: vec![0.0; decoder.unsampled()],
            obs: vec![0.0; seen],
            last: vec![0.0; seen],
            reward: 0.0,
            end: None,
            decoder,
        }
    }

    pub(super) fn environment(&mut self) -> &mut dyn Environment {
        &mut **self.environment.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn start(&mut self, interface: &Interface) {
        self.begun = true;
        self.steps = 0;
        self.design.clone_from(&self.built);
        self.decoder.build(&self.design);
        self.put(interface);
        self.see(interface);
    }

    /// Puts the world into the start of the episode at hand: the one of this index in a training's first iteration.
    fn put(&mut self, interface: &Interface) {
        let rng = &mut stream(self.seed, Purpose::TrainingReset, 0, self.episode);
        let environment = self.environment.get_mut().unwrap_or_else(PoisonError::into_inner);
        environment.set_progress(interface.progress);
        environment.set_design(&self.design);
        environment.reset(rng);
    }

    fn see(&mut self, interface: &Interface) {
        self.environment.get_mut().unwrap_or_else(PoisonError::into_inner).observe(&mut self.seen);
        match &interface.normalizer {
            Some(normalizer) => normalizer.apply(&self.seen, &mut self.obs),
            None => self.obs.iter_mut().zip(&self.seen).for_each(|(out, &x)| *out = x as f32),
        }
    }

    pub(super) fn step(&mut self, interface: &Interface, action: impl Fn(usize) -> f64) {
        for i in 0..self.action.len() {
            if i < interface.drawn && self.steps > 0 {
                continue;
            }
            self.action[i] = interface.si(i, action(i));
        }
        for (&i, &value) in interface.draws.iter().zip(&self.action) {
            let (lo, hi) = self.decoder.law().design().bounds(i);
            self.design[i] = value.clamp(lo, hi);
        }
        if self.steps == 0 && interface.drawn > 0 {
            self.decoder.build(&self.design);
            if interface.restarts {
                self.put(interface);
            }
        }
        let environment = self.environment.get_mut().unwrap_or_else(PoisonError::into_inner);
        environment.state(&mut self.state);
        self.decoder.decode(&self.action, &self.unsampled, &self.state);
        let step = environment.step(self.decoder.effort(), self.decoder.command());
        self.steps += 1;
        (self.reward, self.end) = (step.reward, step.end);
        self.see(interface);
        self.begun = step.end.is_none();
    }

    /// Begins the next episode under the same seed.
    pub(super) fn next(&mut self, interface: &Interface) {
        self.episode += 1;
        self.start(interface);
    }
}
