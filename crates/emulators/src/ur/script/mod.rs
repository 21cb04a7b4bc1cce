//! Programs in the language of the controller, run as they were sent: the part of it that programs of clients use.

mod compile;
mod lexer;
mod machine;
mod value;

pub(crate) use compile::compile;
pub(crate) use machine::{Answer, Arguments, Controller, Machine, Wait};
pub(crate) use value::Value;

#[cfg(test)]
mod tests;
