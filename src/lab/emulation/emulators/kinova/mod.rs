//! An emulated Gen3: sessions, calls and the cycle on the real interface, and a body that follows commands.
//!
//! It answers the calls of the manufacturer's examples for an arm with 7 joints: `CallSession`, `Base` (servoing, twists,
//! joint speeds, actions, waypoints, sequences, kinematics, users, protection zones, notifications), `BaseCyclic`, and
//! through the device id of a request `DeviceManager`, `DeviceConfig`, `ActuatorConfig`, `InterconnectConfig` and
//! `ControlConfig`. All other calls are refused with the base's error frame.
//!
//! Unknown for the real arm, and assumed here: the time of the watchdog and the distance that trips a following error.
//! Both are in [`EmulatedKinova`].

mod actions;
mod base_calls;
mod body;
mod calls;
mod control;
mod devices;
#[cfg(test)]
mod driver_tests;
mod entities;
mod entity_store;
#[cfg(test)]
mod fault_tests;
mod feedback_message;
mod forms;
mod interconnect;
mod interface;
mod joint_motion;
mod moves;
#[cfg(test)]
pub(super) mod opening_tests;
mod robot;
#[cfg(test)]
mod route_tests;
mod setting;
pub(super) mod standalone;
mod topics;
mod wire;

use nima_devices::ARM_JOINTS;

pub use body::{BodyCommand, BodyState, KinovaBody, StandIn};

use crate::emulators::Emulator;

/// Properties of the emulated arm.
#[derive(Clone, Debug, PartialEq)]
pub struct EmulatedKinova {
    /// User that may log in.
    pub user: String,
    pub password: String,
    /// Serial number of its base.
    pub serial: String,
    /// Number of joints that it reports.
    pub joints: u32,
    /// State reported while there is no fault: 7 ready, 3 initialisation, 5 maintenance.
    pub idle_state: u32,
    /// Time without a low-level command that counts as a fault, ms. An assumption: the manufacturer says only that "a
    /// fair amount of jitter" is tolerated (kortex issue 211).
    pub watchdog_ms: f64,
    /// Difference between command and measured angle that counts as a fault, degrees. An assumption.
    pub following_error_deg: f64,
    /// Port of the calls (TCP); 0 selects a free one.
    pub tcp_port: u16,
    /// Port of the cycle (UDP); 0 selects a free one.
    pub udp_port: u16,
}

impl Default for EmulatedKinova {
    fn default() -> Self {
        Self {
            user: "admin".to_owned(),
            password: "admin".to_owned(),
            serial: "EMULATED-1".to_owned(),
            joints: ARM_JOINTS as u32,
            idle_state: 7,
            watchdog_ms: 50.0,
            following_error_deg: 5.0,
            tcp_port: 0,
            udp_port: 0,
        }
    }
}

impl EmulatedKinova {
    /// Makes the emulator with a body. The endpoint is `127.0.0.1 tcp=PORT udp=PORT`, for
    /// [`EmulatorSettings::at`](nima_devices::kinova::KinovaSettings::at).
    pub fn with(self, body: impl KinovaBody + 'static) -> Box<dyn Emulator> {
        Box::new(wire::KinovaServer::new(self, Box::new(body)))
    }
}
