//! Frames of an emulated sensor at its own rate, with faults of their content.

use nalgebra::Vector3;
use nima_devices::bota::codec::{BotaFrame, INERTIAL_BYTES, Inertial};

use super::{BotaBody, BotaWire};
use crate::emulators::{EmulatedFault, EmulatorTurn, WirePeer};

/// Maximum backlog that a delayed thread makes up, s; earlier frames are lost.
const BACKLOG_S: f64 = 0.5;
const INVALID: u16 = 1 << 2;
/// Number of readings in a repeated block, and size of a jump, N.
const BLOCK: usize = 32;
const JUMP_N: f32 = 1.5;

/// Makes the frames that are due.
pub(super) struct BotaFrames {
    body: BotaBody,
    zero_us: u32,
    status: u16,
    next_s: Option<f64>,
    frozen: Option<BotaFrame>,
    /// The first [`BLOCK`] frames after a sensor fault began; some faults repeat them.
    since: Vec<BotaFrame>,
    in_block: usize,
    made: u64,
}

impl BotaFrames {
    pub(super) fn new(body: BotaBody, zero_us: u32, status: u16) -> Self {
        Self { body, zero_us, status, next_s: None, frozen: None, since: Vec::new(), in_block: 0, made: 0 }
    }

    /// Sends every frame that is due, with its bytes completed by `finish`.
    pub(super) fn due(
        &mut self,
        turn: &mut EmulatorTurn<'_>,
        wire: &dyn BotaWire,
        to: WirePeer,
        finish: impl Fn(&mut [u8]),
    ) {
        let Some(period_s) = wire.period_s() else {
            self.next_s = None;
            return;
        };
        let mut next_s = self.next_s.unwrap_or(turn.now_s + period_s).max(turn.now_s - BACKLOG_S);
        while next_s <= turn.now_s {
            let frame = self.frame(next_s, wire, turn.fault);
            let mut bytes = [0; INERTIAL_BYTES];
            let length = frame.encode(&mut bytes);
            let length = self.spoil(&mut bytes, length, turn.fault);
            finish(&mut bytes[..length]);
            turn.send(to, &bytes[..length]);
            next_s += period_s;
        }
        self.next_s = Some(next_s);
    }

    pub(super) const fn next_s(&self) -> Option<f64> {
        self.next_s
    }

    fn frame(&mut self, t_s: f64, wire: &dyn BotaWire, fault: EmulatedFault) -> BotaFrame {
        if fault == EmulatedFault::Freeze
            && let Some(frozen) = self.frozen
        {
            return frozen;
        }
        let felt = (self.body)(t_s);
        let array = |vector: Vector3<f64>| <[f64; 3]>::from(vector).map(|x| x as f32);
        let inertial = wire.is_inertial().then(|| Inertial {
            acceleration_m_s2: array(felt.acceleration_m_s2.unwrap_or_default()),
            angular_velocity_rad_s: array(felt.angular_velocity_rad_s.unwrap_or_default()),
        });
        let bits = [felt.status.throttled, felt.status.overrange, felt.status.invalid, felt.status.raw];
        let report = bits.iter().enumerate().fold(0, |sum, (bit, set)| sum | (u16::from(*set) << bit));
        let mut frame = BotaFrame {
            status: self.status | report,
            force_n: array(felt.wrench.force_n),
            torque_nm: array(felt.wrench.torque_nm),
            timestamp_us: self.zero_us.wrapping_add((t_s * 1e6).round() as u64 as u32),
            temperature_c: felt.temperature_c as f32,
            inertial,
        };
        wire.finish(&mut frame);
        self.fail(&mut frame, fault);
        match fault {
            EmulatedFault::DeviceFault => frame.status |= INVALID,
            EmulatedFault::NotANumber => frame.force_n[0] = f32::NAN,
            _ => {}
        }
        self.frozen = Some(frame);
        frame
    }

    /// Applies faults of the sensor itself; its clock keeps running.
    fn fail(&mut self, frame: &mut BotaFrame, fault: EmulatedFault) {
        if !EmulatedFault::OF_SENSORS.contains(&fault) {
            self.since.clear();
            self.in_block = 0;
            return;
        }
        if self.since.len() < BLOCK {
            self.since.push(*frame);
        }
        let first = self.since[0];
        let time = frame.timestamp_us;
        match fault {
            EmulatedFault::Repeat => *frame = first,
            EmulatedFault::Block => {
                // Until the block is filled, it equals the sensor's readings.
                *frame = self.since[self.in_block];
                self.in_block = (self.in_block + 1) % BLOCK;
            }
            EmulatedFault::EndOfRange => {
                for (now, max) in frame.force_n.iter_mut().zip(first.force_n) {
                    *now = now.min(max);
                }
            }
            _ => frame.force_n[2] += JUMP_N,
        }
        frame.timestamp_us = time;
    }

    /// Applies transmission faults that only the emulator can create; returns the remaining length.
    fn spoil(&mut self, bytes: &mut [u8; INERTIAL_BYTES], length: usize, fault: EmulatedFault) -> usize {
        self.made += 1;
        match fault {
            EmulatedFault::BadChecksum => bytes[length - 1] ^= 0x55,
            EmulatedFault::WrongFrame if self.made.is_multiple_of(2) => return length - 3,
            EmulatedFault::WrongFrame => bytes[0] = 0xAC,
            _ => {}
        }
        length
    }
}
