//! An emulator for every device, on its real interface.
//!
//! An [`Emulator`] implements the behaviour of a device without I/O: it receives the time, the clients' data and the
//! active fault, and returns the data to send. A simulated world or a test provides the values to be measured. `serve`
//! is common to all of them: a thread with the connections, which ends when its [`EmulatorThread`] is dropped. Faults
//! can be set at any time; transmission faults are applied by `serve`, and faults of the content (checksum, status
//! bits, numbers) by the emulator itself.

mod addresses;
pub mod ati;
pub mod bota;
pub mod dynamixel;
pub mod endoscope;
pub mod external;
mod faults;
pub mod force_dimension;
pub mod haply;
#[cfg(target_os = "linux")]
pub mod hid;
pub mod kinova;
pub mod ndi;
mod serving;
mod standalone;
mod wires;

#[cfg(test)]
mod discovery_tests;
#[cfg(test)]
mod probe_sweep_tests;

use std::io;

use nima_devices::bota::Transport;

pub use faults::{EmulatedFault, FaultSwitch};
pub use serving::{EmulatorThread, EmulatorTurn};
pub use standalone::EmulatorSettings;
pub use wires::{WireEnd, WirePeer};

/// Makes an emulator from settings.
type StandaloneMaker = fn(&EmulatorSettings) -> io::Result<Box<dyn Emulator>>;

/// All emulators that run alone, by name.
pub const ALONE: &[(&str, StandaloneMaker)] = &[
    ("ati", ati::standalone::sensor),
    ("bota-gen0", |settings| bota::standalone::sensor(Transport::Gen0, settings)),
    ("bota-gen-a", |settings| bota::standalone::sensor(Transport::GenA, settings)),
    ("bota-socket", |settings| bota::standalone::sensor(Transport::Socket, settings)),
    ("dynamixel", dynamixel::standalone::bus),
    ("endoscope", endoscope::standalone::endoscope),
    ("external-arm", external::standalone::arm),
    ("force-dimension", force_dimension::standalone::handle),
    ("haply", haply::standalone::handle),
    ("kinova", kinova::standalone::arm),
    ("ndi", ndi::standalone::network),
    ("ndi-serial", ndi::standalone::line),
    #[cfg(target_os = "linux")]
    ("pedal", hid::standalone::pedal),
    #[cfg(target_os = "linux")]
    ("spacemouse", hid::standalone::cap),
    #[cfg(target_os = "linux")]
    ("spacenavd", hid::standalone::spacenavd),
];

/// An emulated device. All calls come from one thread.
pub trait Emulator: Send {
    /// Claims the endpoints at which clients reach it; `serve` opens them, and reopens them after a disconnection.
    ///
    /// # Errors
    /// If an endpoint is in use, or is not an emulator's.
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>>;

    /// Returns the endpoint shown to clients, built from the endpoints of its wires.
    fn endpoint(&self, places: &[String]) -> String {
        places[0].clone()
    }

    /// Called first on the serving thread.
    fn begin(&mut self) {}

    /// Returns whether another client may connect now.
    fn admits(&self) -> bool {
        true
    }

    /// Called when a client connected, or opened the serial port.
    fn meet(&mut self, _: WirePeer, _: &mut EmulatorTurn<'_>) {}

    /// Called with data from a client; empty at first if the client has only connected.
    fn receive(&mut self, from: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>);

    /// Called when time has passed, at most every 5 ms and not later than [`due_s`](Self::due_s); even while the
    /// connection is cut.
    fn pass(&mut self, turn: &mut EmulatorTurn<'_>);

    /// Returns when the device next has something to send or to do, s; `None` if it can wait for two milliseconds.
    fn due_s(&self) -> Option<f64> {
        None
    }

    /// Called when a client is gone; with [`WirePeer::Everyone`] when the connection was cut.
    fn lose(&mut self, _: WirePeer) {}
}
