//! `[arm]` and `[world]`.

use std::f64::consts::PI;

use hwasp_core::Dimension;
use hwasp_settings::{Fields, Settings};

use super::vector::vector;

/// The arm, and how the hand sits on its flange.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmSettings {
    /// Name or address in the network.
    pub host: String,
    /// Port of its real-time data.
    pub rtde_port: u64,
    /// Port of its dashboard.
    pub dashboard_port: u64,
    /// Port that takes programs.
    pub script_port: u64,
    /// Poses that it is sent, Hz.
    pub rate: f64,
    /// From flange to palm, in the flange's axes, m.
    pub tcp_position: [f64; 3],
    /// The palm's axes in the flange's: axis times angle, rad.
    pub tcp_rotation: [f64; 3],
    /// Mass of the hand, kg.
    pub payload: f64,
    /// Its centre of mass in the flange's axes, m.
    pub payload_centre: [f64; 3],
}

impl Default for ArmSettings {
    fn default() -> Self {
        Self {
            host: "192.168.0.10".to_owned(),
            rtde_port: 30004,
            dashboard_port: 29999,
            script_port: 30002,
            rate: 125.0,
            tcp_position: [0.0, 0.0, 0.08],
            tcp_rotation: [0.0; 3],
            payload: 0.6,
            payload_centre: [0.0, 0.0, 0.05],
        }
    }
}

impl Settings for ArmSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        const PORTS: std::ops::RangeInclusive<u64> = 1..=65535;
        fields.line("host", &mut self.host, 253, "name or address of the arm's controller in the network");
        fields.integer("rtde_port", &mut self.rtde_port, PORTS, "port of its real-time data (RTDE)");
        fields.integer("dashboard_port", &mut self.dashboard_port, PORTS, "port of its dashboard");
        fields.integer("script_port", &mut self.script_port, PORTS, "port that takes URScript");
        let about = "poses that the arm is sent in a second: 125 for CB3, 500 for e-Series";
        fields.number("rate", &mut self.rate, 50.0..=500.0, about);
        let about = "from the flange to the palm's reference point, between the proximal joints of thumb and fingers, in the flange's axes";
        vector(fields, "tcp_position", &mut self.tcp_position, Dimension::Length, -0.5..=0.5, about);
        let about = "the tool's axes in the flange's, axis times angle";
        vector(fields, "tcp_rotation", &mut self.tcp_rotation, Dimension::Angle, -7.0..=7.0, about);
        fields.quantity("payload", &mut self.payload, Dimension::Mass, 0.0..=10.0, "mass of the hand with its motor");
        let about = "its centre of mass in the flange's axes";
        vector(fields, "payload_centre", &mut self.payload_centre, Dimension::Length, -0.5..=0.5, about);
    }
}

/// Where the task's world is for the arm: its origin on the table, z upwards.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldSettings {
    /// Its origin in the arm's base, m.
    pub position: [f64; 3],
    /// Its axes in the arm's base: axis times angle, rad.
    pub rotation: [f64; 3],
    /// The tool's axes in the world while the palm faces down: axis times angle, rad.
    pub tool_rotation: [f64; 3],
}

impl Default for WorldSettings {
    fn default() -> Self {
        // The flange's z points out of the arm, the palm's z points up: half a turn about x.
        Self { position: [-0.42, -0.11, 0.0], rotation: [0.0; 3], tool_rotation: [PI, 0.0, 0.0] }
    }
}

impl Settings for WorldSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let about = "the place on the table, in the arm's base, above which the palm works; objects stand there";
        vector(fields, "position", &mut self.position, Dimension::Length, -2.0..=2.0, about);
        let about = "the world's axes in the arm's base, axis times angle; z points up from the table";
        vector(fields, "rotation", &mut self.rotation, Dimension::Angle, -7.0..=7.0, about);
        let about = "the tool's axes in the world while the palm faces down, axis times angle; the fingers are on the side of y";
        vector(fields, "tool_rotation", &mut self.tool_rotation, Dimension::Angle, -7.0..=7.0, about);
    }
}
