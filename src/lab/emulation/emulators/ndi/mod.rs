//! An emulated unit on its real interface: TCP or a pseudo-terminal, fed by a body that provides the poses of the
//! tools.
//!
//! It accepts both forms of commands, implements the unit's modes (not initialised, set up, tracking) with its error
//! codes, counts frames at 60 Hz and sends each reply in one write. On the pseudo-terminal it emulates the baud rate:
//! data sent at a different rate are not understood, and commands and replies occupy the line for as long as their
//! bytes need. A pseudo-terminal cannot carry a break; setting its rate to 9600 while the unit has another one counts
//! as a break.

#[cfg(test)]
mod driver_tests;
#[cfg(test)]
mod fault_tests;
mod port;
pub(super) mod standalone;
mod unit;
mod wire;

use nalgebra::{UnitQuaternion, Vector3};
use nima_devices::{TrackedTool, ndi::text::SystemStatus};

pub use unit::{NdiUnit, UnitAnswer};

/// Frame rate of the emulated unit, Hz.
pub const FRAME_HZ: f64 = 60.0;

/// The simulated world as seen by the unit. Called on the emulator's thread.
pub trait NdiBody: Send {
    /// Returns the pose of the tool with this number (in the order in which its handle was requested) at this time of
    /// the unit, s.
    fn tool(&mut self, unit_s: f64, number: usize) -> TrackedTool;

    /// Returns the status of the unit.
    fn system(&mut self) -> SystemStatus {
        SystemStatus::default()
    }

    /// Called when the unit beeps.
    fn beep(&mut self, _times: u8) {}
}

impl<F: FnMut(f64, usize) -> TrackedTool + Send> NdiBody for F {
    fn tool(&mut self, unit_s: f64, number: usize) -> TrackedTool {
        self(unit_s, number)
    }
}

/// Identity of the emulated unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NdiProfile {
    /// Product, as in the first line of its version text.
    pub product: String,
    pub serial: String,
    /// Freeze tag: hosts use it to choose between `TX` and `BX`.
    pub firmware: String,
}

impl Default for NdiProfile {
    fn default() -> Self {
        Self {
            product: "Polaris Vega".to_owned(),
            serial: "EMULATED".to_owned(),
            firmware: "Polaris Vega 014".to_owned(),
        }
    }
}

/// Standalone, without a world: the tools circle slowly 1.5 m in front of the camera, 0.2 m apart.
pub fn wandering(unit_s: f64, number: usize) -> TrackedTool {
    let turn = 0.5 * unit_s + number as f64;
    let centre = Vector3::new(-0.3 + 0.2 * number as f64, 0.0, -1.5);
    TrackedTool::Seen {
        c_from_tool: UnitQuaternion::from_euler_angles(0.2 * turn.sin(), 0.2 * turn.cos(), 0.3 * (0.7 * turn).sin()),
        position_in_c_m: centre + 0.05 * Vector3::new(turn.cos(), turn.sin(), (0.5 * turn).sin()),
        error_m: 0.000_15,
        at_the_edge: false,
    }
}
