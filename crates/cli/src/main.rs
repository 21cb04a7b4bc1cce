//! hwasp
fn main() {}
