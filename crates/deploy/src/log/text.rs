//! The words of enumerations in logs.

use hwasp_drivers::{ArmMode, Safety};

use crate::record::Event;

pub(super) fn mode(mode: ArmMode) -> &'static str {
    match mode {
        ArmMode::Running => "running",
        ArmMode::Idle => "idle",
        ArmMode::Off => "off",
    }
}

pub(super) fn safety(safety: Safety) -> &'static str {
    match safety {
        Safety::Normal => "normal",
        Safety::Reduced => "reduced",
        Safety::ProtectiveStop => "protective stop",
        Safety::EmergencyStop => "emergency stop",
        Safety::Stopped => "stopped",
    }
}

/// The name of an event, and what else there is to say.
pub(super) fn event(event: Event) -> (&'static str, String) {
    match event {
        Event::Episode { shape, .. } => ("episode", shape.map_or_else(String::new, |shape| shape.name().to_owned())),
        Event::Decided(response, cause) => ("decided", format!("{response}: {cause}")),
        Event::Felt(torque) => ("felt", format!("{torque:.3} N·m")),
        Event::ArmStopped => ("arm stopped", String::new()),
        Event::Down => ("down", String::new()),
        Event::Freed => ("motor freed", String::new()),
        Event::ArmFault => ("arm fault", String::new()),
        Event::MotorFault => ("motor fault", String::new()),
    }
}
