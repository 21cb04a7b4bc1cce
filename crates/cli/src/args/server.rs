//! Arguments of commands that may have their work done elsewhere.

#[cfg(feature = "cluster")]
use std::time::Duration;

use hwasp_session::Elsewhere;

#[cfg(feature = "cluster")]
use super::ConnectArgs;
#[cfg(feature = "cluster")]
use super::parse::seconds;

/// Workers on other machines, where a command may use them.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ServerArgs {
    /// Have the work done by the workers of this queue, such as `nats://127.0.0.1:4222`; the result has the same bits. `hwasp cluster up`
    /// starts one
    #[cfg(feature = "cluster")]
    #[arg(long, value_name = "ADDRESS", help_heading = "Workers on other machines")]
    pub(crate) server: Option<String>,
    #[cfg(feature = "cluster")]
    #[command(flatten)]
    pub(crate) connect: ConnectArgs,
    /// How long no worker may be heard of before it ends with an error. A training that ends so goes on with --resume
    #[cfg(feature = "cluster")]
    #[arg(long, value_name = "SECONDS", default_value = "600", allow_negative_numbers = true, value_parser = seconds, help_heading = "Workers on other machines")]
    pub(crate) patience: Duration,
}

impl ServerArgs {
    /// The workers that are asked for, if any are.
    #[cfg(feature = "cluster")]
    pub(crate) fn elsewhere(&self) -> Option<Elsewhere> {
        self.server.as_deref().map(|address| Elsewhere::new(self.connect.server(address), self.patience))
    }

    /// A program without the feature `cluster` has no such arguments.
    #[cfg(not(feature = "cluster"))]
    #[allow(clippy::unused_self)] // as it is with the feature
    pub(crate) fn elsewhere(&self) -> Option<Elsewhere> {
        None
    }
}
