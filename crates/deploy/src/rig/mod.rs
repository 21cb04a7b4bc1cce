//! `rig.toml`: where arm and motor are, how the hand sits on the arm, and what neither may exceed.
//!
//! It is read like an experiment: all faults at once, with their lines, limits and ways out.

mod arm;
mod frame;
mod limits;
mod motor;
mod object;
mod template;
mod vector;

use std::path::Path;

use hwasp_runs::files::read_limited;
use hwasp_settings::{Faults, LONGEST_FILE, Layers, Section, Settings, read};

pub use arm::{ArmSettings, WorldSettings};
pub use frame::Frame;
pub use limits::LimitSettings;
pub use motor::{MotorSettings, Winding};
pub use object::{LogSettings, ObjectSettings};
pub use template::{template, text_of};

use crate::error::DeployError;

/// What the file is called.
pub const RIG: &str = "rig.toml";

/// A bench: all that `rig.toml` says. Everything is in SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rig {
    /// `[arm]`.
    pub arm: ArmSettings,
    /// `[world]`.
    pub world: WorldSettings,
    /// `[motor]`.
    pub motor: MotorSettings,
    /// `[limits]`.
    pub limits: LimitSettings,
    /// `[object]`.
    pub object: ObjectSettings,
    /// `[log]`.
    pub log: LogSettings,
}

/// The sections, each with the word that the file explains it by.
pub(crate) const SECTIONS: [(&str, &str); 6] = [
    ("arm", "the arm, and how the hand sits on it"),
    ("world", "where the table is for the arm"),
    ("motor", "the motor of the hand"),
    ("limits", "what ends a motion; software that keeps them is no safety function"),
    ("object", "what is known of the object"),
    ("log", "what is kept"),
];

impl Rig {
    /// Reads a file.
    ///
    /// # Errors
    /// Where it cannot be read, or says what cannot be: all of it at once.
    pub fn open(path: &Path) -> Result<Self, DeployError> {
        let bytes = read_limited(path, LONGEST_FILE as u64).map_err(|source| DeployError::NoRig { source })?;
        Ok(Self::from_text(&path.to_string_lossy(), &String::from_utf8_lossy(&bytes))?)
    }

    /// Reads a text; `name` is how messages call it.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn from_text(name: &str, text: &str) -> Result<Self, Faults> {
        let layers = Layers::from_text(name, text)?;
        let table = layers.merged("");
        let reader = layers.reader();
        let mut root = Section::root(&reader, &table);
        let mut rig = Self::default();
        for (name, settings) in rig.sections() {
            let mut section = reader.section(&mut root, name);
            read(settings, &mut section);
            section.finish();
        }
        root.finish();
        reader.into_errors().into_result()?;
        Ok(rig)
    }

    /// Its sections by name, in the order of the file.
    pub(crate) fn sections(&mut self) -> [(&'static str, &mut dyn Settings); 6] {
        let Self { arm, world, motor, limits, object, log } = self;
        let all: [&mut dyn Settings; 6] = [arm, world, motor, limits, object, log];
        let mut names = SECTIONS.iter();
        all.map(|settings| (names.next().map_or("", |(name, _)| name), settings))
    }

    /// How places of the task's world are poses of the arm.
    pub fn frame(&self) -> Frame {
        Frame::new(&self.world)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_says_what_the_defaults_say() {
        let text = template();
        assert_eq!(Rig::from_text("rig.toml", &text), Ok(Rig::default()));
        for (section, _) in SECTIONS {
            assert!(text.contains(&format!("\n[{section}]\n")), "{section}");
        }
        // Each key has its meaning above it.
        let lines: Vec<_> = text.lines().collect();
        for pair in lines.windows(2).filter(|pair| pair[1].contains(" = ")) {
            assert!(pair[0].starts_with("# "), "{pair:?}");
        }
    }

    #[test]
    fn all_that_is_wrong_is_told_at_once() {
        let text = "[arm]\nhost = 3\n[limits]\npalm_speed = \"3 m/s\"\nworkspce = 2\n[motor]\nid = 400\n[world]\nposition = [\"1 m\", 2]\n";
        let faults = Rig::from_text("rig.toml", text).unwrap_err();
        let told: Vec<_> = faults.faults().iter().map(|fault| fault.message.clone()).collect();
        assert_eq!(told.len(), 5, "{told:?}");
        assert!(
            told.iter().any(|message| message == "limits.palm_speed = \"3 m/s\" is outside [0.001 m/s, 0.5 m/s]"),
            "{told:?}"
        );
        assert!(told.iter().any(|message| message.contains("unknown key `workspce`")), "{told:?}");
    }

    #[test]
    fn limits_are_held_against_each_other() {
        let text = "[limits]\narm_stale = \"150 ms\"\n[motor]\nwatchdog = \"40 ms\"\n";
        let faults = Rig::from_text("rig.toml", text).unwrap_err().to_string();
        assert!(faults.contains("arm_stale") && faults.contains("watchdog"), "{faults}");
    }
}
