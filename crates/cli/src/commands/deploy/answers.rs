//! What a person types, without keeping Ctrl-C waiting.

use std::io::BufRead;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::Duration;

/// How often it is looked whether somebody wants it to end.
const LOOK: Duration = Duration::from_millis(50);

/// Lines of standard input, read by a thread of their own.
pub(super) struct Answers {
    lines: Receiver<String>,
    interrupts: Arc<AtomicU32>,
    /// What had been asked before.
    seen: u32,
}

impl Answers {
    /// Begins to read. To be called once.
    pub(super) fn listen(interrupts: Arc<AtomicU32>) -> Self {
        let (sender, lines) = mpsc::channel();
        std::thread::spawn(move || {
            for line in std::io::stdin().lock().lines() {
                let Ok(line) = line else { return };
                if sender.send(line.trim().to_lowercase()).is_err() {
                    return;
                }
            }
        });
        Self { lines, interrupts, seen: 0 }
    }

    /// The next line; none where the input has ended or somebody asked to stop meanwhile.
    pub(super) fn next(&mut self) -> Option<String> {
        loop {
            match self.lines.recv_timeout(LOOK) {
                Ok(line) => return Some(line),
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) => {
                    let interrupts = self.interrupts.load(Ordering::Relaxed);
                    if interrupts > self.seen {
                        self.seen = interrupts;
                        return None;
                    }
                }
            }
        }
    }
}
