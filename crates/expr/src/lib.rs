//! Formulas as text, for everything that an experiment says of a robot: what is observed and rewarded, when an episode ends,
//! where it starts, what is drawn at random, and the law of the hardware.
//!
//! ```text
//! clip(joint.knee.vel, -10, 10)
//! -1e-3 * sum(command^2)
//! body.torso.pos.z < 0.7 m or abs(joint.root.pos) > 0.2
//! gear * command.knee - stiffness * (joint.knee.pos - rest)
//! ```
//!
//! A formula is a scalar or a vector. What its names stand for, the owner says ([`Scope`]); everything else is here: units,
//! dimensions, shapes, functions. Any number of formulas go into one [`Formulas`] and become one [`Program`](hwasp_diff::Program),
//! which runs without allocating and can be differentiated.
//!
//! ```
//! use hwasp_expr::{Formulas, NameError, Path, Quantity, Scope, Symbol};
//!
//! /// One name, a column.
//! struct Knee;
//!
//! impl Scope for Knee {
//!     fn name(&mut self, formulas: &mut Formulas, path: &Path) -> Result<Symbol, NameError> {
//!         match path.first() {
//!             "knee" => Ok(Symbol::new(vec![formulas.column(0)], Quantity::Unknown, 1)),
//!             _ => Err(NameError::unknown(["knee"])),
//!         }
//!     }
//! }
//!
//! let mut formulas = Formulas::default();
//! let value = formulas.read("2 * clip(knee, -1, 1)^2", &mut Knee)?;
//! let program = formulas.program(&[], &["knee".into()], vec![("reward".into(), value.parts[0])]);
//! let (mut tape, mut reward) = (program.tape::<f64>(1), [0.0]);
//! program.bind(&[], &mut tape);
//! program.forward(&[0.5], 1, 1, &mut tape, &mut reward, 1);
//! assert_eq!(reward, [0.5]);
//! # Ok::<(), hwasp_expr::ExprError>(())
//! ```

#![forbid(unsafe_code)]

mod check;
mod draws;
mod error;
mod expand;
mod exponents;
mod formulas;
mod function;
mod functions;
mod lexer;
mod library;
mod outline;
mod parser;
mod quaternion;
mod reference;
mod scope;
mod shapes;
mod suggest;
mod syntax;
mod text;
mod units;

pub use error::ExprError;
pub use exponents::{Exponents, Quantity};
pub use formulas::{Formulas, Part, Value};
pub use function::{Function, Parameter, Signature, name_fault};
pub use library::{LIBRARY, LawDoc, laws};
pub use outline::groups;
pub use parser::LONGEST_TEXT;
pub use reference::{FUNCTIONS, FunctionDoc};
pub use scope::{Distribution, NameError, Scope, Symbol};
pub use syntax::Path;
pub use text::Texts;
pub use units::{parse_unit, quantity};
