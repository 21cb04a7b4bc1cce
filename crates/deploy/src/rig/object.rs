//! `[object]` and `[log]`.

use std::path::PathBuf;

use hwasp_core::Dimension;
use hwasp_settings::{Fields, Settings};

/// What is known of the object.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectSettings {
    /// Where the tracker sends to: a port of this computer.
    pub tracker_port: u64,
    /// How old its newest word may be, s.
    pub tracker_stale: f64,
    /// The torque, N·m, from which on an object counts as held; none for what the controller was trained with.
    pub felt: Option<f64>,
}

impl Default for ObjectSettings {
    fn default() -> Self {
        Self { tracker_port: 5005, tracker_stale: 0.1, felt: None }
    }
}

impl Settings for ObjectSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let about = "UDP port of this computer to which a tracker sends lines {\"position\":[x,y,z],\"time\":t}, m and s, in the world";
        fields.integer("tracker_port", &mut self.tracker_port, 1..=65535, about);
        let about = "how old its newest word may be; until it speaks again palm and motor wait";
        fields.quantity("tracker_stale", &mut self.tracker_stale, Dimension::Time, 0.01..=2.0, about);
        let about = "torque of the motor from which on a carried object counts as held; \"none\" for task.grasp_felt of the run";
        fields.optional_quantity("felt", &mut self.felt, (Dimension::Torque, 0.3), 0.0..=3.0, about);
    }
}

/// What is kept.
#[derive(Clone, Debug, PartialEq)]
pub struct LogSettings {
    /// The folder of logs, relative to where the program was started.
    pub folder: PathBuf,
}

impl Default for LogSettings {
    fn default() -> Self {
        Self { folder: "deploy-logs".into() }
    }
}

impl Settings for LogSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.path(
            "folder",
            &mut self.folder,
            "the folder of logs and of trials.csv; each run writes an .mcap and a .csv there",
        );
    }
}
