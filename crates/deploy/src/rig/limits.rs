//! `[limits]`.

use hwasp_core::Dimension;
use hwasp_settings::{Fields, Settings};

/// What ends a motion. Rules that use them are in [`safety`](crate::safety).
#[derive(Clone, Debug, PartialEq)]
pub struct LimitSettings {
    /// Where the palm may be, from and to, in the task's world, m: x, y and z.
    pub workspace: [[f64; 2]; 3],
    /// How far outside of it the palm is found before it is stopped, m.
    pub margin: f64,
    /// The most that the palm moves with, m/s.
    pub palm_speed: f64,
    /// How far the palm may be from where it was sent, m.
    pub following: f64,
    /// The most current that the motor takes for longer than `current_time`, A.
    pub current: f64,
    /// s.
    pub current_time: f64,
    /// The most that the motor is warm, °C.
    pub temperature: f64,
    /// What its supply may be, from and to, V.
    pub voltage: [f64; 2],
    /// Oldest data of the arm, s.
    pub arm_stale: f64,
    /// Oldest answer of the motor, s.
    pub motor_stale: f64,
    /// For how long the spool may stand still while it should wind and has current to spare, s.
    pub stuck: f64,
    /// The most that a step may begin too late, s.
    pub overrun: f64,
    /// How far the goal of the spool leads what it has wound, in tendon, m.
    pub lead: f64,
    /// For how long an object that is not seen is waited for, s.
    pub patience: f64,
    /// For how long the motor holds on after a stop, s.
    pub hold: f64,
}

impl Default for LimitSettings {
    fn default() -> Self {
        Self {
            workspace: [[-0.15, 0.15], [-0.15, 0.15], [0.06, 0.48]],
            margin: 0.02,
            palm_speed: 0.1,
            following: 0.03,
            current: 1.2,
            current_time: 0.5,
            temperature: 70.0,
            voltage: [10.0, 14.8],
            arm_stale: 0.040,
            motor_stale: 0.050,
            stuck: 0.3,
            overrun: 0.030,
            lead: 0.005,
            patience: 1.0,
            hold: 60.0,
        }
    }
}

impl Settings for LimitSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let (length, time) = (Dimension::Length, Dimension::Time);
        let [x, y, z] = &mut self.workspace;
        fields.span(
            "workspace_x",
            x,
            length,
            -2.0..=2.0,
            "where the palm may be; the controller was trained within ±150 mm",
        );
        fields.span("workspace_y", y, length, -2.0..=2.0, "the same along y");
        let about = "the same above the table; the open fingers reach 64 mm below the palm";
        fields.span("workspace_z", z, length, 0.0..=2.0, about);
        let about = "how far outside of it the palm is found before it is stopped";
        fields.quantity("margin", &mut self.margin, length, 0.001..=0.2, about);
        fields.quantity(
            "palm_speed",
            &mut self.palm_speed,
            Dimension::Speed,
            0.001..=0.5,
            "the most that the palm moves with",
        );
        let about = "how far the palm may be from where it was sent";
        fields.quantity("following", &mut self.following, length, 0.002..=0.3, about);
        let about = "the most current that the motor takes for longer than current_time";
        fields.quantity("current", &mut self.current, Dimension::Current, 0.05..=3.2, about);
        fields.quantity("current_time", &mut self.current_time, time, 0.02..=5.0, "how long more current is borne");
        fields.number("temperature", &mut self.temperature, 30.0..=79.0, "°C, of the motor; at 80 it ends by itself");
        let about = "of the motor's supply, from and to";
        fields.span("voltage", &mut self.voltage, Dimension::Voltage, 5.0..=20.0, about);
        fields.quantity(
            "arm_stale",
            &mut self.arm_stale,
            time,
            0.01..=0.1,
            "how old the newest data of the arm may be",
        );
        fields.quantity(
            "motor_stale",
            &mut self.motor_stale,
            time,
            0.02..=0.2,
            "the same of the motor's newest answer",
        );
        let about = "for how long the spool may stand still while it should wind and has current to spare";
        fields.quantity("stuck", &mut self.stuck, time, 0.05..=2.0, about);
        fields.quantity("overrun", &mut self.overrun, time, 0.005..=0.2, "how late a step of the controller may begin");
        let about =
            "how far the goal of the spool leads what it has wound, in tendon: more would only take longer to unwind";
        fields.quantity("lead", &mut self.lead, length, 0.001..=0.02, about);
        let about = "for how long an object that is not seen any more is waited for";
        fields.quantity("patience", &mut self.patience, time, 0.0..=60.0, about);
        let about = "for how long the motor holds on after a stop, before it is freed; Ctrl-C frees it earlier";
        fields.quantity("hold", &mut self.hold, time, 0.0..=3600.0, about);
        if fields.sound(&["arm_stale", "palm_speed", "following"]) {
            let blind = 2.0 * self.arm_stale * self.palm_speed;
            fields.check("arm_stale", blind <= self.following.min(0.01), || {
                let message = format!(
                    "in two times limits.arm_stale the palm moves {:.0} mm at limits.palm_speed, which nobody would see",
                    1e3 * blind
                );
                (message, "make arm_stale or palm_speed smaller, so that it is at most 10 mm".to_owned())
            });
        }
    }
}
