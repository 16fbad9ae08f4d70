//! An emulated Inverse3 on a pseudo-terminal: it answers every request at once, as the manufacturer's own client
//! expects.
//!
//! The position of the grip comes from its [`HaplyBody`], which receives the force on the hand. The protocol has no checksum
//! and no fault bits. Kinematics, gravity compensation, power and temperatures are not emulated. The reaction of a real
//! handle to a silent connection is not documented and not emulated either: here the last force remains.

pub(super) mod standalone;
#[cfg(test)]
mod tests;

use std::{
    io,
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};

use nalgebra::Vector3;
use nima_devices::haply::{
    CENTRE_M,
    codec::{DeviceInfo, FORCE, FORCE_BYTES, HaplyState, STATE, WAKE_UP, force_of},
};

use crate::emulators::{EmulatedFault, Emulator, EmulatorTurn, WireEnd, WirePeer, wires::terminal};

/// Function that returns the state of the grip at a time (s since the emulator began) with this force on the hand (N,
/// in the device's axes).
pub type HaplyBody = Box<dyn FnMut(f64, &Vector3<f64>) -> HaplyState + Send>;

/// Requests of the manufacturer's client that our driver does not use: torques and angles of the joints, a position.
const TORQUES: u8 = 0x1A;
const ANGLES: u8 = 0x1C;
const POSITION: u8 = 0x2C;
/// Code of the joints' answer.
const JOINTS: u8 = 0x1B;
/// An incomplete request is dropped after this time, s. Otherwise its rest would look like the beginning of the next
/// one.
const PAUSE_S: f64 = 0.02;

/// Properties of an emulated handle.
#[derive(Clone, Debug)]
pub struct EmulatedHaply {
    pub info: DeviceInfo,
    /// The name of its port; by default in its own folder.
    pub link: Option<PathBuf>,
}

impl Default for EmulatedHaply {
    fn default() -> Self {
        let info = DeviceInfo { id: 0x049D, model: 4, hardware: 2, firmware: 9, uuid: *b"nima-emulated-01" };
        Self { info, link: None }
    }
}

impl EmulatedHaply {
    /// Makes the emulator with a source of positions.
    pub fn with(self, body: HaplyBody) -> Box<dyn Emulator> {
        let Self { info, link } = self;
        Box::new(HaplyDevice {
            info,
            link,
            body,
            received: Vec::new(),
            received_s: 0.0,
            force_n: Vector3::zeros(),
            frozen: None,
        })
    }
}

/// The force on the hand, readable from outside.
#[derive(Clone, Debug, Default)]
pub struct HapticForce(Arc<Mutex<Vector3<f64>>>);

impl HapticForce {
    /// Returns the newest force, N.
    pub fn force_n(&self) -> Vector3<f64> {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns a grip that a soft spring (300 N/m) leads along a circle of 10 mm about the middle of the workspace, and
    /// that yields to the force.
    pub fn on_a_circle(&self) -> HaplyBody {
        const SPRING_N_M: f64 = 300.0;
        const RADIUS_M: f64 = 0.01;
        const RATE_RAD_S: f64 = 1.9;
        let felt = self.clone();
        Box::new(move |now_s, force_n| {
            *felt.0.lock().unwrap_or_else(PoisonError::into_inner) = *force_n;
            let (sine, cosine) = (RATE_RAD_S * now_s).sin_cos();
            let round_m = Vector3::new(cosine, sine, 0.0) * RADIUS_M;
            let position_m = Vector3::from(CENTRE_M) + round_m + force_n / SPRING_N_M;
            let velocity_m_s = Vector3::new(-sine, cosine, 0.0) * (RADIUS_M * RATE_RAD_S);
            let short = |vector: Vector3<f64>| -> [f32; 3] { vector.map(|axis| axis as f32).into() };
            HaplyState { position_m: short(position_m), velocity_m_s: short(velocity_m_s) }
        })
    }
}

struct HaplyDevice {
    info: DeviceInfo,
    link: Option<PathBuf>,
    body: HaplyBody,
    /// The beginning of a request.
    received: Vec<u8>,
    received_s: f64,
    force_n: Vector3<f64>,
    /// The state repeated while it is frozen.
    frozen: Option<HaplyState>,
}

impl HaplyDevice {
    /// Returns the length of a request, bytes; `None` for an unknown code.
    const fn length_of(code: u8) -> Option<usize> {
        match code {
            WAKE_UP => Some(1),
            FORCE | TORQUES | ANGLES | POSITION => Some(FORCE_BYTES),
            _ => None,
        }
    }

    fn state(&mut self, now_s: f64, fault: EmulatedFault) -> HaplyState {
        let mut state = (self.body)(now_s, &self.force_n);
        if fault == EmulatedFault::Freeze {
            state = *self.frozen.get_or_insert(state);
        } else {
            self.frozen = None;
        }
        if fault == EmulatedFault::NotANumber {
            state.position_m[1] = f32::NAN;
        }
        state
    }

    /// Answers the first received request; returns false if it is incomplete.
    fn answer(&mut self, to: WirePeer, turn: &mut EmulatorTurn<'_>) -> bool {
        let Some(code) = self.received.first().copied() else { return false };
        let Some(length) = Self::length_of(code) else {
            self.received.remove(0);
            return true;
        };
        if self.received.len() < length {
            return false;
        }
        let request: Vec<u8> = self.received.drain(..length).collect();
        let mut answer = match code {
            WAKE_UP => self.info.encode().to_vec(),
            TORQUES | ANGLES => [vec![JOINTS], vec![0; 24]].concat(),
            _ => {
                let force_n = force_of(&request).filter(|force_n| force_n.iter().all(|axis| axis.is_finite()));
                self.force_n = Vector3::from(force_n.unwrap_or_default()).map(f64::from);
                self.state(turn.now_s, turn.fault).encode().to_vec()
            }
        };
        if turn.fault == EmulatedFault::WrongFrame && answer[0] == STATE {
            answer[0] = JOINTS;
        }
        turn.send(to, &answer);
        true
    }
}

impl Emulator for HaplyDevice {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        Ok(vec![terminal(self.link.as_deref(), "haply", None)?])
    }

    fn receive(&mut self, from: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        if turn.now_s - self.received_s > PAUSE_S {
            self.received.clear();
        }
        self.received_s = turn.now_s;
        self.received.extend_from_slice(bytes);
        while self.answer(from, turn) {}
    }

    fn pass(&mut self, _: &mut EmulatorTurn<'_>) {}

    fn lose(&mut self, _: WirePeer) {
        self.received.clear();
    }
}
