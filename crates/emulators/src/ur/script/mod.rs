//! Programs in the language of the controller, run as they were sent: the part of it that programs of clients use.

mod calls;
mod compile;
mod expressions;
mod lexer;
mod machine;
mod steps;
mod value;

pub(crate) use calls::{Answer, Arguments, Controller, Wait};
pub(crate) use compile::compile;
pub(crate) use machine::Machine;
pub(crate) use value::Value;

#[cfg(test)]
mod tests;
