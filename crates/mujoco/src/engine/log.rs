//! Where the engine's messages go: to the error they belong to, and never into a file.

use std::cell::RefCell;
use std::sync::Once;

use mujoco_rs::prelude::{MjLogMessage, MjtLogLevel, log_config, set_log_config, set_log_handler};

thread_local! {
    /// The engine's last warning on this thread. It warns on the thread that steps.
    static LAST_WARNING: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Takes over the engine's messages. To be called before anything else of the engine; does nothing the second time.
#[expect(unsafe_code, reason = "the handler is a global of the engine")]
pub(super) fn install() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        // SAFETY: both functions ask that no other thread uses MuJoCo meanwhile. This is the only crate that does, all
        // its ways to the engine start at `Simulation::from_mjcf`, and that waits here until the first call is through.
        unsafe {
            set_log_handler(receive);
            // The wrapper asks the engine for messages on every topic, timings of each step among them.
            set_log_config(log_config().with_topics(0).with_logto_file(false).with_logto_console(false));
        }
    });
}

/// The engine's last warning on this thread, which is forgotten.
pub(super) fn take_warning() -> String {
    LAST_WARNING.take()
}

#[allow(clippy::print_stderr, reason = "the process ends after an error of the engine: nobody else can tell why")]
fn receive(message: &MjLogMessage) {
    match message.level() {
        MjtLogLevel::mjLOG_ERROR => eprintln!("MuJoCo has to end the process: {}", message.subject()),
        MjtLogLevel::mjLOG_WARNING => LAST_WARNING.set(message.subject().to_owned()),
        MjtLogLevel::mjLOG_INFO | MjtLogLevel::mjLOG_DEBUG => {}
    }
}
