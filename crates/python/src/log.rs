//! What the library has to say goes to Python's `logging`, to the logger `hwasp`.

use std::fmt::{self, Write};
use std::sync::Once;

use pyo3::prelude::*;
use pyo3::types::PyModule;
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;

/// To be called before the library is put to work, and not by the command of the package, which has a log of its own.
pub(crate) fn begin() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // It can fail only where the command was first.
        let _ = tracing_subscriber::registry().with(Logging).try_init();
    });
}

struct Logging;

impl<S: Subscriber> Layer<S> for Logging {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let level = match *event.metadata().level() {
            Level::ERROR => 40,
            Level::WARN => 30,
            Level::INFO => 20,
            // Nobody reads them here, and each would take the interpreter.
            _ => return,
        };
        let mut message = Message(String::new());
        event.record(&mut message);
        Python::attach(|py| {
            let told = PyModule::import(py, "logging").and_then(|logging| {
                let logger = logging.call_method1("getLogger", ("hwasp",))?;
                logger.call_method1("log", (level, "%s", message.0))
            });
            // A handler that fails stops no training.
            drop(told);
        });
    }
}

struct Message(String);

impl Visit for Message {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        if field.name() == "message" {
            let _ = write!(self.0, "{value:?}");
        }
    }
}
