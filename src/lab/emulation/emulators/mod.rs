//! An emulator for every device, on its real wire.
//!
//! An [`Emulator`] is what a device does, without input and output: it is told the time, what clients send, and the fault in force, and says
//! what leaves. A simulated world or a test feeds it with what the device would measure. Its `serve` is the body that all of them have: a
//! thread with the wires, which ends when its [`Serving`] is dropped. Faults are set at any time; what concerns bytes is done by the body,
//! what concerns meaning (checksum, status bits, numbers) by the emulator itself.

mod alone;
pub mod bota;
pub mod dynamixel;
pub mod endoscope;
mod faults;
pub mod force_dimension;
pub mod haply;
#[cfg(target_os = "linux")]
pub mod hid;
pub mod kinova;
pub mod ndi;
mod places;
mod serving;
mod wires;

#[cfg(test)]
mod discovery_tests;

use std::io;

pub use alone::{ALONE, Settings};
pub use faults::{EmulatedFault, FaultSwitch};
pub use serving::{Serving, Turn};
pub use wires::{End, Peer};

/// An emulated device. All calls come from one thread.
pub trait Emulator: Send {
    /// Claims the places where clients reach it; they are opened by the body, and again after a disconnection.
    ///
    /// # Errors
    /// When a place is taken or not an emulator's.
    fn wires(&self) -> io::Result<Vec<Box<dyn End>>>;

    /// What clients are told, made of the places of its wires.
    fn endpoint(&self, places: &[String]) -> String {
        places[0].clone()
    }

    /// Called before anything else on the thread that serves.
    fn begin(&mut self) {}

    /// Another client may connect now.
    fn admits(&self) -> bool {
        true
    }

    /// A client connected, or opened the line.
    fn meet(&mut self, _: Peer, _: &mut Turn<'_>) {}

    /// A client sent this; nothing at first, where it only connected.
    fn hear(&mut self, from: Peer, bytes: &[u8], turn: &mut Turn<'_>);

    /// Time has passed, 5 ms at most and not beyond [`due_s`](Self::due_s); also while the line is cut.
    fn pass(&mut self, turn: &mut Turn<'_>);

    /// When it has something to send or to do, s; `None`: nothing that must not wait for two milliseconds.
    fn due_s(&self) -> Option<f64> {
        None
    }

    /// A client is gone; [`Peer::Everyone`] when the line was cut.
    fn lose(&mut self, _: Peer) {}
}
