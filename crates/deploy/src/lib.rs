//! A trained controller on arm and hand.
#![forbid(unsafe_code)]
