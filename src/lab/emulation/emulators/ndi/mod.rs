//! An emulated unit on its real wire: TCP or a pseudo-terminal, fed by a body that says where the tools are.
//!
//! It takes both forms of commands, keeps the unit's modes (not initialised, set up, tracking) with its error codes, counts frames
//! at 60 Hz and sends each reply in one write. On the pseudo-terminal it keeps the line's speed: what is sent at another speed
//! than its own is not understood, and commands and replies take the line for as long as their bytes need. A pseudo-terminal carries
//! no break; setting its speed to 9600 while the unit has another stands for one.

pub(super) mod alone;
#[cfg(test)]
mod driver_tests;
#[cfg(test)]
mod fault_tests;
mod port;
mod unit;
mod wire;

use nalgebra::{UnitQuaternion, Vector3};
use nima_devices::{Tracked, ndi::words::SystemStatus};

pub use unit::{Answer, Unit};

/// Frames of the emulated unit, Hz.
pub const FRAME_HZ: f64 = 60.0;

/// What the simulated world says to the unit. Called on the emulator's thread.
pub trait Body: Send {
    /// Where the tool with this number (in the order in which its handle was asked for) is at this time of the unit, s.
    fn tool(&mut self, unit_s: f64, number: usize) -> Tracked;

    /// How the unit is.
    fn system(&mut self) -> SystemStatus {
        SystemStatus::default()
    }

    /// The unit beeps.
    fn beep(&mut self, _times: u8) {}
}

impl<F: FnMut(f64, usize) -> Tracked + Send> Body for F {
    fn tool(&mut self, unit_s: f64, number: usize) -> Tracked {
        self(unit_s, number)
    }
}

/// What the emulated unit says it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Profile {
    /// Product, as in the first line of its version text.
    pub product: String,
    /// Serial number.
    pub serial: String,
    /// Freeze tag, by which hosts choose between `TX` and `BX`.
    pub firmware: String,
}

impl Default for Profile {
    fn default() -> Self {
        Self {
            product: "Polaris Vega".to_owned(),
            serial: "EMULATED".to_owned(),
            firmware: "Polaris Vega 014".to_owned(),
        }
    }
}

/// Alone, without a world: the tools circle slowly 1.5 m before the camera, 0.2 m apart.
pub fn wandering(unit_s: f64, number: usize) -> Tracked {
    let turn = 0.5 * unit_s + number as f64;
    let centre = Vector3::new(-0.3 + 0.2 * number as f64, 0.0, -1.5);
    Tracked::Seen {
        c_from_tool: UnitQuaternion::from_euler_angles(0.2 * turn.sin(), 0.2 * turn.cos(), 0.3 * (0.7 * turn).sin()),
        position_in_c_m: centre + 0.05 * Vector3::new(turn.cos(), turn.sin(), (0.5 * turn).sin()),
        error_m: 0.000_15,
        at_the_edge: false,
    }
}
