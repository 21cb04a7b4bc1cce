//! Where the engine's messages go: to the error they belong to, and never into a file.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

use mujoco_rs::prelude::{MjLogMessage, MjtLogLevel, log_config, set_log_config, set_log_handler};

thread_local! {
    /// The engine's last warning on this thread. It warns on the thread that steps.
    static LAST_WARNING: RefCell<String> = const { RefCell::new(String::new()) };
    /// All warnings on this thread, while somebody collects them.
    static WARNINGS: RefCell<Option<Vec<String>>> = const { RefCell::new(None) };
}

/// Takes over the engine's messages. To be called before anything else of the engine; does nothing the second time.
#[expect(unsafe_code, reason = "the handler is a global of the engine")]
pub(super) fn install() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        // SAFETY: both functions ask that no other thread uses MuJoCo meanwhile. This is the only crate that does, all
        // its ways to the engine start at `Simulation::from_mjcf` and `Spec::parse`, and those wait here until the first
        // call is through.
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

/// What the engine warns of on this thread meanwhile.
pub(super) fn warnings_of<R>(work: impl FnOnce() -> R) -> (R, Vec<String>) {
    WARNINGS.set(Some(Vec::new()));
    let result = work();
    (result, WARNINGS.take().unwrap_or_default())
}

#[allow(clippy::print_stderr, reason = "the process ends after an error of the engine: nobody else can tell why")]
fn receive(message: &MjLogMessage) {
    match message.level() {
        MjtLogLevel::mjLOG_ERROR => eprintln!("MuJoCo has to end the process: {}", subject(message)),
        MjtLogLevel::mjLOG_WARNING => {
            let collected = WARNINGS.with_borrow_mut(|warnings| {
                warnings.as_mut().map(|warnings| warnings.push(subject(message))).is_some()
            });
            if !collected {
                LAST_WARNING.set(subject(message));
            }
        }
        MjtLogLevel::mjLOG_INFO | MjtLogLevel::mjLOG_DEBUG => {}
    }
}

/// The engine cuts long messages, which may break a character, and then the wrapper panics. A panic that left the handler
/// would end the process.
fn subject(message: &MjLogMessage) -> String {
    catch_unwind(AssertUnwindSafe(|| message.subject().to_owned()))
        .unwrap_or_else(|_| "a warning that is no text".to_owned())
}
