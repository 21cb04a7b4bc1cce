//! Which arm is emulated, and where it listens.

use std::net::{IpAddr, Ipv4Addr};

use super::kinematics::{Joints, Lengths, UR5, UR5E};

/// The two generations of controllers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Generation {
    /// UR5 on CB3, software 3.15, 125 Hz.
    Cb3,
    /// `UR5e`, software 5.11, 500 Hz.
    ESeries,
}

impl Generation {
    /// One period of the controller, ms.
    pub(super) fn period(self) -> u32 {
        match self {
            Self::Cb3 => 8,
            Self::ESeries => 2,
        }
    }

    pub(super) fn lengths(self) -> Lengths {
        match self {
            Self::Cb3 => UR5,
            Self::ESeries => UR5E,
        }
    }

    /// Major, minor, bugfix, build.
    pub(super) fn version(self) -> [u32; 4] {
        match self {
            Self::Cb3 => [3, 15, 8, 106_339],
            Self::ESeries => [5, 11, 1, 108_318],
        }
    }
}

/// Ports; 0 takes any that is free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ports {
    /// Of RTDE.
    pub rtde: u16,
    /// Of the dashboard.
    pub dashboard: u16,
    /// For programs: the secondary interface.
    pub script: u16,
    /// For programs too: the real-time interface, to which `ur_rtde` sends.
    pub realtime: u16,
}

impl Ports {
    /// Any that are free.
    pub const ANY: Self = Self { rtde: 0, dashboard: 0, script: 0, realtime: 0 };
    /// Those of the vendor.
    pub const VENDOR: Self = Self { rtde: 30004, dashboard: 29999, script: 30002, realtime: 30003 };
}

/// What is emulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UrEmulatorSettings {
    /// Of the controller, and with it the arm.
    pub generation: Generation,
    /// Where it listens; this machine alone by default.
    pub address: IpAddr,
    /// Where it listens.
    pub ports: Ports,
    /// Where the joints begin, rad.
    pub joints: Joints,
}

impl UrEmulatorSettings {
    /// With the elbow up and the tool pointing down, at any free ports.
    pub fn new(generation: Generation) -> Self {
        use std::f64::consts::FRAC_PI_2;
        let joints = [0.0, -1.9, 2.0, -FRAC_PI_2 - 0.1, -FRAC_PI_2, 0.0];
        Self { generation, address: IpAddr::V4(Ipv4Addr::LOCALHOST), ports: Ports::ANY, joints }
    }
}
