//! What the dashboard answers.

use super::controller::{Controller, SafetyMode};
use super::settings::Generation;

/// The first line that a client reads.
pub(super) const GREETING: &str = "Connected: Universal Robots Dashboard Server";

/// The answer to one line, and whether the connection stays.
pub(super) fn answer(controller: &mut Controller, line: &str) -> (String, bool) {
    let new = controller.settings.generation == Generation::ESeries;
    let safety = match controller.safety {
        SafetyMode::Normal => "NORMAL",
        SafetyMode::ProtectiveStop => "PROTECTIVE_STOP",
        SafetyMode::EmergencyStop => "ROBOT_EMERGENCY_STOP",
    };
    let text = match line.to_ascii_lowercase().as_str() {
        "polyscopeversion" => {
            let [major, minor, bugfix, build] = controller.settings.generation.version();
            format!("URSoftware {major}.{minor}.{bugfix}.{build} (Jan 01 2022)")
        }
        "get serial number" => if new { "20225500001" } else { "2018350001" }.to_owned(),
        "get robot model" => "UR5".to_owned(),
        "is in remote control" if new => (!controller.faults.local).to_string(),
        "robotmode" => {
            let mode = match controller.robot_mode() {
                7 => "RUNNING",
                5 => "IDLE",
                _ => "POWER_OFF",
            };
            format!("Robotmode: {mode}")
        }
        "safetymode" => format!("Safetymode: {safety}"),
        "safetystatus" => format!("Safetystatus: {safety}"),
        "running" => format!("Program running: {}", controller.runtime_state() == 2),
        "programstate" => {
            let name = controller.program.as_ref().map_or("<unnamed>", |program| program.name()).to_owned();
            let state = match controller.runtime_state() {
                2 => "PLAYING",
                4 => "PAUSED",
                _ => "STOPPED",
            };
            format!("{state} {name}")
        }
        "stop" => {
            controller.stop_program();
            "Stopped".to_owned()
        }
        "unlock protective stop" => controller.unlock().to_owned(),
        "close popup" => "closing popup".to_owned(),
        "close safety popup" => "closing safety popup".to_owned(),
        "quit" => return ("Disconnected".to_owned(), false),
        _ => format!("could not understand: '{line}'"),
    };
    (text, true)
}
