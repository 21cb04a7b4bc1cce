//! Prints the hand's model, to look at it in any viewer of `MuJoCo`: `cargo run --example hand_mjcf -- native > hand.xml`.
//! Without `native` the joints are driven by torques.

use hwasp_tasks::hand::{Drive, HandDescription, HandError, MjcfOptions, SMALL_CENTRE, mjcf};

#[allow(clippy::print_stdout)] // what it is for
fn main() -> Result<(), HandError> {
    let native = std::env::args().any(|argument| argument == "native");
    let drive = if native { Drive::NativeTendon { design: SMALL_CENTRE } } else { Drive::JointTorque };
    let xml = mjcf(&HandDescription::default(), &MjcfOptions { drive, ..MjcfOptions::default() })?;
    print!("{xml}");
    Ok(())
}
