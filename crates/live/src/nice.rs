//! Trainings go first.

/// Lets other threads go before the calling one, by this much of the 19 that there are. Threads that it starts inherit that.
#[cfg(target_os = "linux")]
pub(crate) fn step_back(by: i32) {
    // Linux counts it for each thread. Where it is not allowed all are alike, which is no fault.
    let _ = rustix::process::nice(by);
}

/// Elsewhere it would count for the training, too.
#[cfg(not(target_os = "linux"))]
pub(crate) fn step_back(_: i32) {}
