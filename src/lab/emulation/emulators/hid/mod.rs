//! Emulated caps and pedals on a packet socket, and an emulated `spacenavd` on its stream.
//!
//! A client first gets one packet that identifies the device, `nima-hid VVVV:PPPP SERIAL NAME`, then one packet per
//! report, as from a hidraw node; its own packets are output reports. Faults that a human interface device cannot have
//! (checksums, status bits) do nothing; "not a number" is an axis far beyond its range, or a keyboard that reports a
//! roll-over error.

use std::{
    io,
    os::unix::net::UnixListener,
    path::{Path, PathBuf},
    time::Duration,
};

use nalgebra::Vector3;
use nima_devices::{
    CapReading, PedalReading,
    hid::{
        cap_codec::{self, CapReport, counts_of},
        pedal_codec::{self, PedalLayout},
        seqpacket,
        source::HidIdentity,
        spacenavd::SpacenavdEvent,
    },
};

use crate::emulators::{EmulatedFault, Emulator, EmulatorTurn, WireEnd, WirePeer, wires::socket};

mod models;
pub(super) mod standalone;
#[cfg(test)]
mod tests;
pub use models::{CapBody, CapModel, PedalBody, PedalModel};
use models::{CapSide, PedalSide, SpacenavdSide};

/// One kind of device: makes the data to send.
trait WireSide: Send {
    /// Name of its socket in its own folder.
    const NAME: &'static str;
    /// Returns the time between two steps.
    fn period(&self) -> Duration;
    /// Returns the first packet for a new client; `None` for a stream, which has no greeting.
    fn hello(&self) -> Option<String>;
    /// Makes the frames of this step.
    fn step(&mut self, now_s: f64, fault: EmulatedFault, send: &mut dyn FnMut(&[u8]));
    /// Processes data of a client.
    fn command(&mut self, bytes: &[u8]);
}

/// Returns an emulated cap at this path, or in its own folder.
pub fn cap(path: Option<PathBuf>, model: CapModel, body: CapBody) -> Box<dyn Emulator> {
    Box::new(Periodic { path, side: CapSide::new(model, body), due_s: 0.0 })
}

/// Returns an emulated pedal, placed like a cap.
pub fn pedal(path: Option<PathBuf>, model: PedalModel, body: PedalBody) -> Box<dyn Emulator> {
    Box::new(Periodic { path, side: PedalSide::new(model, body), due_s: 0.0 })
}

/// Returns an emulated `spacenavd` with one cap, placed like a cap.
pub fn spacenavd(path: Option<PathBuf>, body: CapBody) -> Box<dyn Emulator> {
    Box::new(Periodic { path, side: SpacenavdSide::new(body), due_s: 0.0 })
}

/// A device that sends at its own rate.
struct Periodic<S> {
    path: Option<PathBuf>,
    side: S,
    due_s: f64,
}

impl<S: WireSide> Emulator for Periodic<S> {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        let listen =
            if self.side.hello().is_some() { seqpacket::listen } else { |path: &Path| UnixListener::bind(path) };
        Ok(vec![socket(self.path.as_deref(), S::NAME, listen)?])
    }

    fn endpoint(&self, places: &[String]) -> String {
        let kind = if self.side.hello().is_some() { "emulated" } else { "spacenavd" };
        format!("{kind}:{}", places[0])
    }

    fn meet(&mut self, peer: WirePeer, turn: &mut EmulatorTurn<'_>) {
        if let Some(hello) = self.side.hello() {
            turn.send_unspoilt(peer, hello.as_bytes());
        }
    }

    fn receive(&mut self, _: WirePeer, bytes: &[u8], _: &mut EmulatorTurn<'_>) {
        self.side.command(bytes);
    }

    fn pass(&mut self, turn: &mut EmulatorTurn<'_>) {
        if turn.now_s >= self.due_s {
            self.side.step(turn.now_s, turn.fault, &mut |frame| turn.send(WirePeer::Everyone, frame));
            // Do not send a burst after a pause of the whole machine.
            self.due_s = (self.due_s + self.side.period().as_secs_f64()).max(turn.now_s);
        }
    }

    fn due_s(&self) -> Option<f64> {
        Some(self.due_s)
    }
}
