//! What a problem is.
//!
//! A [`Problem`] has a name, settings for the table `[task]` of experiment files, and a function from their values to
//! [`Built`]: the worlds where one trains and where the result has to work. The problems that come with the program and your
//! own implement the same trait and enter the same catalogue.
//!
//! ```
//! use hwasp_core::Dimension;
//! use hwasp_problem::{AnyError, Built, Problem};
//! use hwasp_settings::{Fields, Settings};
//! # use hwasp_core::{Law, MakeEnvironment};
//! # fn law() -> Result<Law, AnyError> { Err("not in this example".into()) }
//! # fn environments(_: f64) -> impl MakeEnvironment { |_| unreachable!() }
//!
//! /// A lamp on an arm that a spring should carry.
//! struct Lamp;
//!
//! #[derive(Clone, Debug, PartialEq)]
//! struct LampSettings {
//!     /// Where the arm has to be held, rad.
//!     goal: f64,
//! }
//!
//! impl Settings for LampSettings {
//!     fn fields(&mut self, fields: &mut Fields<'_, '_>) {
//!         fields.quantity("goal", &mut self.goal, Dimension::Angle, -1.2..=1.2, "where the arm has to be held");
//!     }
//! }
//!
//! impl Problem for Lamp {
//!     type Settings = LampSettings;
//!
//!     fn name(&self) -> &str {
//!         "lamp"
//!     }
//!
//!     fn defaults(&self) -> LampSettings {
//!         LampSettings { goal: 0.6 }
//!     }
//!
//!     fn build(&self, settings: &LampSettings) -> Result<Built, AnyError> {
//!         Ok(Built::new(law()?, environments(settings.goal)))
//!     }
//! }
//! ```

#![forbid(unsafe_code)]

mod built;
mod error;
mod manual;
mod mechanism;
mod problem;
mod words;
mod world;

pub use built::{Built, MakeWorld, StandIn, StandInKind};
pub use error::{AnyError, FaultsTold};
pub use manual::{Fact, Frame, Manual, Motor, Sensor, Target, Told, Topic};
pub use mechanism::{Changed, Mechanism, ModelFile, ModelFormat};
pub use problem::{AnyProblem, Preset, Problem};
pub use words::{Role, Words};
pub use world::World;
