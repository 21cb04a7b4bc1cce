//! Who called the program: its own process, or Python.

use std::ffi::OsString;
use std::sync::OnceLock;

static CALLER: OnceLock<Caller> = OnceLock::new();

/// Who called the program.
#[derive(Clone, Debug)]
pub struct Caller {
    /// What was typed, the program first.
    pub words: Vec<OsString>,
    /// What starts the program again, as a process of its own: a file, and the words before those of the command line.
    pub itself: Vec<OsString>,
}

impl Caller {
    /// This process, whose file is the program.
    fn process() -> Self {
        let itself = std::env::current_exe().map_or_else(|_| "hwasp".into(), Into::into);
        Self { words: std::env::args_os().collect(), itself: vec![itself] }
    }

    /// Says so for the rest of the process. The first to say it is believed.
    pub(crate) fn remember(self) {
        let _ = CALLER.set(self);
    }

    /// Who it was.
    pub(crate) fn get() -> &'static Self {
        CALLER.get_or_init(Self::process)
    }

    /// The program again, as a process of its own.
    #[cfg(feature = "mujoco")]
    pub(crate) fn again(&self) -> std::process::Command {
        let mut command = std::process::Command::new(&self.itself[0]);
        command.args(&self.itself[1..]);
        command
    }
}
