//! A UR5 on CB3 or a `UR5e`, as far as clients see it: RTDE, dashboard, and programs that run as they were sent.
//!
//! The host calls [`UrEmulator::advance`] as time goes on. Faults are ordered by text; `docs/deploy_arm.md` has their table.

mod alone;
mod controller;
mod dashboard;
mod faults;
mod fields;
mod functions;
mod kinematics;
mod motion;
#[cfg(test)]
mod program_tests;
mod rtde;
mod script;
mod server;
mod settings;
mod upload;

use std::net::SocketAddr;
use std::sync::{Arc, Mutex};

use hwasp_drivers::Pose;
use thiserror::Error;

pub use alone::Alone;
pub use kinematics::{Joints, Lengths, UR5, UR5E, frame_of, pose_of};
pub use settings::{Generation, Ports, UrEmulatorSettings};

use controller::Controller;
use faults::Order;
pub(crate) use faults::check_fault;
use server::{Door, Service, Shared, lock};

/// Why there is no emulator.
#[derive(Debug, Error)]
#[error("cannot listen at {address} for {service}: {cause}; choose another port, or 0 for any")]
pub struct PortError {
    address: SocketAddr,
    service: &'static str,
    cause: std::io::Error,
}

/// The emulator of an arm. It listens until it is dropped.
#[derive(Debug)]
pub struct UrEmulator {
    shared: Arc<Mutex<Shared>>,
    ports: Ports,
    /// Time that is not yet a whole millisecond, s.
    rest: f64,
    _doors: [Door; 4],
}

impl UrEmulator {
    /// Opens its ports.
    pub fn start(settings: &UrEmulatorSettings) -> Result<Self, PortError> {
        let shared = Arc::new(Mutex::new(Shared::new(Controller::new(*settings))));
        let open = |port: u16, service: Service, name: &'static str| {
            let address = SocketAddr::new(settings.address, port);
            Door::open(address, service, &shared).map_err(|cause| PortError { address, service: name, cause })
        };
        let rtde = open(settings.ports.rtde, Service::Rtde, "RTDE")?;
        let dashboard = open(settings.ports.dashboard, Service::Dashboard, "the dashboard")?;
        let script = open(settings.ports.script, Service::Script, "programs")?;
        let realtime = open(settings.ports.realtime, Service::Script, "programs")?;
        let ports = Ports {
            rtde: rtde.address.port(),
            dashboard: dashboard.address.port(),
            script: script.address.port(),
            realtime: realtime.address.port(),
        };
        Ok(Self { shared, ports, rest: 0.0, _doors: [rtde, dashboard, script, realtime] })
    }

    /// Where it listens.
    pub fn ports(&self) -> Ports {
        self.ports
    }

    /// Where the tool is, in the arm's base; true even while clients are told otherwise.
    pub fn tool(&self) -> Pose {
        pose_of(&lock(&self.shared).controller.frame())
    }

    /// How fast the tool is, m/s.
    pub fn tool_speed(&self) -> f64 {
        lock(&self.shared).controller.speed()
    }

    /// Its clock, s; it goes on with [`UrEmulator::advance`].
    pub fn clock(&self) -> f64 {
        lock(&self.shared).controller.clock
    }

    /// Where the joints are, rad.
    pub fn joints(&self) -> Joints {
        lock(&self.shared).controller.body.q
    }

    /// Time goes on by `dt`, s; whole milliseconds are computed, what is left counts next time.
    pub fn advance(&mut self, dt: f64) {
        self.rest += dt.clamp(0.0, 1.0);
        while self.rest >= 1e-3 - 1e-9 {
            self.rest -= 1e-3;
            let Shared { controller, clients, .. } = &mut *lock(&self.shared);
            let period = controller.millisecond();
            for (_, client) in clients {
                if period {
                    client.period(controller);
                }
                client.release(controller.clock);
            }
        }
    }

    /// Orders a fault, or `clear`.
    pub fn inject(&mut self, fault: &str) -> Result<(), String> {
        let mut all = lock(&self.shared);
        match faults::order(fault, all.controller.faults)? {
            Order::ProtectiveStop => all.controller.protective_stop(),
            Order::EmergencyStop => all.controller.emergency_stop(),
            Order::Cut => all.cut(),
            Order::Clear => all.controller.clear(),
            Order::Set(faults) => {
                if faults.freeze && !all.controller.faults.freeze {
                    all.controller.freeze();
                }
                all.controller.faults = faults;
                if faults.idle {
                    all.controller.stop_program();
                }
            }
        }
        Ok(())
    }

    /// What programs and the controller said, oldest first.
    pub fn messages(&self) -> Vec<String> {
        lock(&self.shared).controller.log.clone()
    }
}

impl Drop for UrEmulator {
    fn drop(&mut self) {
        lock(&self.shared).cut();
    }
}
