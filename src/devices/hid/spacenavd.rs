//! The socket of `spacenavd` (protocol 0): the daemon gives access to a cap without permission for the device itself.
//!
//! A UNIX stream of events of eight native 32-bit integers: `[0, x, y, z, rx, ry, rz, period]` for motion, `[1, button,
//! ...]` for press, `[2, button, ...]` for release. The daemon's axes are x right, y up, z away from the user (its
//! default map), full deflection about 350 at sensitivity 1. Events arrive only on changes.
//!
//! Source: `libspnav` 1.0 (reference `hid.md`).

#[cfg(unix)]
use std::{
    io::{ErrorKind, Read as _, Write as _},
    path::Path,
};

use nalgebra::Vector3;

use super::cap_codec::{BadReport, CapState, FULL};
#[cfg(unix)]
use crate::{DeviceError, Loss, transport::TransportDatagrams};

/// The daemon's default socket.
pub const SOCKET: &str = "/var/run/spnav.sock";
/// Eight 32-bit numbers in the machine's byte order (protocol version 0).
pub const EVENT_LENGTH: usize = 32;
/// First number of an event.
const MOTION: i32 = 0;
const PRESS: i32 = 1;
const RELEASE: i32 = 2;
/// Larger counts are impossible at any sensitivity: the daemon multiplies the 350 counts of full deflection with
/// sensitivities from its configuration.
const POSSIBLE: u32 = 100_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpacenavdEvent {
    /// x, y, z, rx, ry, rz in the daemon's axes, counts.
    Motion([i32; 6]),
    /// A button, from 0.
    Button { number: u32, pressed: bool },
}

impl SpacenavdEvent {
    /// Decodes one event.
    ///
    /// # Errors
    /// [`BadReport`] if the length, the type or a value do not belong to an event.
    pub fn decode(bytes: &[u8]) -> Result<Self, BadReport> {
        let bytes: &[u8; EVENT_LENGTH] = bytes.try_into().map_err(|_| BadReport::Shape)?;
        let mut words = [0_i32; 8];
        words.iter_mut().zip(bytes.as_chunks::<4>().0).for_each(|(word, four)| *word = i32::from_ne_bytes(*four));
        match words {
            [MOTION, axes @ .., _] if axes.iter().all(|axis| axis.unsigned_abs() < POSSIBLE) => Ok(Self::Motion(axes)),
            [MOTION, ..] => Err(BadReport::Content),
            [kind @ (PRESS | RELEASE), number, ..] => match u32::try_from(number) {
                Ok(number) => Ok(Self::Button { number, pressed: kind == PRESS }),
                Err(_) => Err(BadReport::Content),
            },
            _ => Err(BadReport::Shape),
        }
    }

    /// Encodes the event; `period_ms` is the time since the last motion.
    pub fn encode(&self, period_ms: i32) -> [u8; EVENT_LENGTH] {
        let mut words = [0_i32; 8];
        match self {
            Self::Motion(axes) => {
                words[1..7].copy_from_slice(axes);
                words[7] = period_ms;
            }
            Self::Button { number, pressed } => {
                words[..2].copy_from_slice(&[if *pressed { PRESS } else { RELEASE }, number.cast_signed()]);
            }
        }
        let mut bytes = [0; EVENT_LENGTH];
        bytes.as_chunks_mut::<4>().0.iter_mut().zip(words).for_each(|(four, word)| *four = word.to_ne_bytes());
        bytes
    }

    /// Applies the event to a cap's state; the daemon's y and z axes are swapped.
    pub fn apply(&self, state: &mut CapState, now_s: f64) {
        match self {
            Self::Motion([x, y, z, rx, ry, rz]) => {
                let axes = |x: &i32, y: &i32, z: &i32| {
                    Vector3::new(*x, *y, *z).map(|count| (f64::from(count) / FULL).clamp(-1.0, 1.0))
                };
                state.set(axes(x, z, y), axes(rx, rz, ry), now_s);
            }
            Self::Button { number, pressed } => state.set_button(*number, *pressed),
        }
    }
}

/// A connection to the daemon that returns complete events.
#[cfg(unix)]
#[derive(Debug)]
pub struct Spacenavd {
    stream: std::os::unix::net::UnixStream,
    partial: [u8; EVENT_LENGTH],
    filled: usize,
}

#[cfg(unix)]
impl Spacenavd {
    /// Connects to the daemon's socket.
    ///
    /// # Errors
    /// [`DeviceError`] if the socket cannot be connected to.
    pub fn open(path: &Path) -> Result<Self, DeviceError> {
        let stream = std::os::unix::net::UnixStream::connect(path).and_then(|stream| {
            stream.set_nonblocking(true)?;
            Ok(stream)
        });
        let stream = stream.map_err(|error| match error.kind() {
            ErrorKind::ConnectionRefused => DeviceError::NobodyListens { place: path.display().to_string() },
            _ => DeviceError::of_port(path, &error, "the socket of spacenavd needs no rule; set its mode to 0666"),
        })?;
        Ok(Self { stream, partial: [0; EVENT_LENGTH], filled: 0 })
    }
}

#[cfg(unix)]
impl TransportDatagrams for Spacenavd {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Loss> {
        match self.stream.read(&mut self.partial[self.filled..]) {
            Ok(0) => return Err(Loss::Disconnected),
            Ok(count) => self.filled += count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => return Ok(None),
            Err(_) => return Err(Loss::Disconnected),
        }
        if self.filled < EVENT_LENGTH || buffer.len() < EVENT_LENGTH {
            return Ok(None);
        }
        self.filled = 0;
        buffer[..EVENT_LENGTH].copy_from_slice(&self.partial);
        Ok(Some(EVENT_LENGTH))
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        self.stream.write_all(bytes).map_err(|_| Loss::Disconnected)
    }
}
