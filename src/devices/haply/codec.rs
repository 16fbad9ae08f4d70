//! Requests and answers of the protocol: little-endian, a code and its values, no checksum (reference `haply.md`,
//! section 4.2). No input or output, no clock, no allocation.
//!
//! Source of codes and layouts: the manufacturer's closed client (`HaplyHardwareAPI` 0.1.13), observed on a
//! pseudo-terminal.

use crate::stream_buffer::Unread;

/// Code of the request for the device's identity.
pub const WAKE_UP: u8 = 0x0A;
/// Code of the response.
pub const DEVICE: u8 = 0x0B;
/// Code of the request with a force.
pub const FORCE: u8 = 0x2A;
/// Code of its answer.
pub const STATE: u8 = 0x2B;
/// Length of an identity, bytes.
pub const DEVICE_BYTES: usize = 22;
/// Length of a request with a force, bytes.
pub const FORCE_BYTES: usize = 13;
/// Length of a state, bytes.
pub const STATE_BYTES: usize = 25;

/// A state beyond these limits is impossible: m, m/s. The arms of an Inverse3 are shorter than half a metre.
const REACH_MAX_M: f32 = 1.0;
// Ten times the fastest arm movement (`HAND_MAX_M_S` in `nima_core`).
const SPEED_MAX_M_S: f32 = 30.0;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeviceInfo {
    pub id: u16,
    pub model: u8,
    pub hardware: u8,
    pub firmware: u8,
    pub uuid: [u8; 16],
}

impl DeviceInfo {
    /// Encodes the identity like the device.
    pub fn encode(&self) -> [u8; DEVICE_BYTES] {
        let mut bytes = [0; DEVICE_BYTES];
        bytes[0] = DEVICE;
        bytes[1..3].copy_from_slice(&self.id.to_le_bytes());
        bytes[3..6].copy_from_slice(&[self.model, self.hardware, self.firmware]);
        bytes[6..].copy_from_slice(&self.uuid);
        bytes
    }

    /// Decodes exactly one answer; returns `None` if it is invalid.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let bytes: &[u8; DEVICE_BYTES] = bytes.try_into().ok()?;
        let [DEVICE, low, high, model, hardware, firmware, uuid @ ..] = *bytes else { return None };
        Some(Self { id: u16::from_le_bytes([low, high]), model, hardware, firmware, uuid })
    }
}

/// Position and velocity of the grip, in the device's axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HaplyState {
    /// Position, m, from the device's origin.
    pub position_m: [f32; 3],
    /// Velocity, m/s.
    pub velocity_m_s: [f32; 3],
}

impl HaplyState {
    /// Encodes the state like the device.
    pub fn encode(&self) -> [u8; STATE_BYTES] {
        let mut bytes = [0; STATE_BYTES];
        bytes[0] = STATE;
        put(&mut bytes[1..13], &self.position_m);
        put(&mut bytes[13..], &self.velocity_m_s);
        bytes
    }

    /// Decodes exactly one answer; returns `None` if it is invalid.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let bytes: &[u8; STATE_BYTES] = bytes.try_into().ok()?;
        (bytes[0] == STATE).then(|| Self { position_m: take(&bytes[1..13]), velocity_m_s: take(&bytes[13..]) })
    }

    /// Returns whether position and speed are possible.
    pub fn is_possible(&self) -> bool {
        let within = |values: &[f32; 3], limit: f32| values.iter().all(|value| value.abs() <= limit);
        within(&self.position_m, REACH_MAX_M) && within(&self.velocity_m_s, SPEED_MAX_M_S)
    }
}

/// Returns the request that applies this force (N) to the hand.
pub fn force_request(force_n: [f32; 3]) -> [u8; FORCE_BYTES] {
    let mut bytes = [FORCE; FORCE_BYTES];
    put(&mut bytes[1..], &force_n);
    bytes
}

/// Returns the force in exactly one request, N; `None` if it is invalid.
pub fn force_of(bytes: &[u8]) -> Option<[f32; 3]> {
    (bytes.len() == FORCE_BYTES && bytes[0] == FORCE).then(|| take(&bytes[1..]))
}

fn put(to: &mut [u8], values: &[f32; 3]) {
    for (bytes, value) in to.chunks_exact_mut(4).zip(values) {
        bytes.copy_from_slice(&value.to_le_bytes());
    }
}

fn take(from: &[u8]) -> [f32; 3] {
    let mut values = [0.0; 3];
    for (value, bytes) in values.iter_mut().zip(from.chunks_exact(4)) {
        *value = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    }
    values
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NextAnswer {
    /// A state with possible numbers.
    State(HaplyState),
    /// A complete answer with impossible numbers.
    Impossible,
}

/// Size of the decoder's buffer: room for several answers.
const ROOM: usize = 512;

/// Finds states in a stream of bytes. Write into [`room`](Self::room), report the number with [`filled`](Self::filled),
/// then call [`next`](Self::next) until it returns `None`.
#[derive(Debug)]
pub struct HaplyDecoder {
    unread: Unread,
    skipped: u64,
}

impl Default for HaplyDecoder {
    fn default() -> Self {
        Self { unread: Unread::with_room(ROOM), skipped: 0 }
    }
}

impl HaplyDecoder {
    /// Returns the buffer for new bytes; not empty once [`next`](Self::next) has returned `None`.
    pub fn room(&mut self) -> &mut [u8] {
        self.unread.room()
    }

    /// Reports that `count` bytes were written into the buffer.
    pub fn filled(&mut self, count: usize) {
        self.unread.filled(count);
    }

    /// Returns the next complete answer. Without a checksum, bytes with impossible numbers may not be an answer at all:
    /// they count as one only if the next answer begins behind them, or no bytes follow yet.
    #[expect(clippy::should_implement_trait, reason = "an iterator would borrow the room")]
    pub fn next(&mut self) -> Option<NextAnswer> {
        while let Some(first) = self.unread.bytes().first() {
            if *first != STATE {
                self.skip();
                continue;
            }
            let waiting = self.unread.bytes();
            let state = HaplyState::decode(waiting.get(..STATE_BYTES)?)?;
            if state.is_possible() {
                self.unread.pass(STATE_BYTES);
                return Some(NextAnswer::State(state));
            }
            if waiting.get(STATE_BYTES).is_none_or(|next| *next == STATE) {
                self.unread.pass(STATE_BYTES);
                return Some(NextAnswer::Impossible);
            }
            self.skip();
        }
        None
    }

    fn skip(&mut self) {
        self.unread.pass(1);
        self.skipped += 1;
    }

    pub const fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Discards the buffered bytes: the rest of an incomplete answer. Returns their number.
    pub const fn clear(&mut self) -> usize {
        let count = self.unread.clear();
        self.skipped += count as u64;
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATE_OF: HaplyState = HaplyState { position_m: [0.0186, -0.153, 0.151], velocity_m_s: [0.0, -0.5, 1.5] };

    #[test]
    fn what_the_reference_has_goes_both_ways() {
        let info = DeviceInfo { id: 0x049D, model: 4, hardware: 2, firmware: 9, uuid: *b"0123456789abcdef" };
        let wire = info.encode();
        assert_eq!(wire[..6], [0x0B, 0x9D, 0x04, 4, 2, 9]);
        assert_eq!(DeviceInfo::decode(&wire), Some(info));
        assert_eq!(DeviceInfo::decode(&wire[..21]), None);
        assert_eq!(HaplyState::decode(&STATE_OF.encode()), Some(STATE_OF));
        let request = force_request([1.0, -2.0, 0.5]);
        assert_eq!(request, [0x2A, 0, 0, 0x80, 0x3F, 0, 0, 0, 0xC0, 0, 0, 0, 0x3F]);
        assert_eq!(force_of(&request), Some([1.0, -2.0, 0.5]));
        assert_eq!(force_of(&request[1..]), None);
    }

    fn decoded(stream: &[u8], random: &mut fastrand::Rng) -> (Vec<NextAnswer>, u64) {
        let mut decoder = HaplyDecoder::default();
        let mut found = Vec::new();
        let mut rest = stream;
        while !rest.is_empty() {
            let count = random.usize(1..=40).min(rest.len());
            decoder.room()[..count].copy_from_slice(&rest[..count]);
            decoder.filled(count);
            rest = &rest[count..];
            found.extend(std::iter::from_fn(|| decoder.next()));
        }
        (found, decoder.skipped())
    }

    #[test]
    fn answers_are_found_in_pieces_and_between_other_bytes() {
        let mut random = fastrand::Rng::with_seed(3);
        for _ in 0..200 {
            let mut stream = vec![0x1B, 7, 0];
            for _ in 0..5 {
                stream.extend(STATE_OF.encode());
            }
            let (found, skipped) = decoded(&stream, &mut random);
            assert_eq!((found, skipped), (vec![NextAnswer::State(STATE_OF); 5], 3));
        }
    }

    #[test]
    fn impossible_numbers_are_told_and_the_answers_behind_them_are_found() {
        let mut random = fastrand::Rng::with_seed(4);
        let mut bad = STATE_OF;
        bad.velocity_m_s[1] = f32::NAN;
        let stream = [STATE_OF.encode(), bad.encode(), STATE_OF.encode()].concat();
        let (found, _) = decoded(&stream, &mut random);
        assert_eq!(found, [NextAnswer::State(STATE_OF), NextAnswer::Impossible, NextAnswer::State(STATE_OF)]);
        for far in [[2.0, 0.0, 0.0], [0.0, f32::INFINITY, 0.0]] {
            assert!(!HaplyState { position_m: far, ..STATE_OF }.is_possible());
        }
    }

    #[test]
    fn random_bytes_give_no_panic_and_an_end() {
        let mut random = fastrand::Rng::with_seed(5);
        for _ in 0..2000 {
            let stream: Vec<u8> = (0..random.usize(0..600)).map(|_| random.u8(0x20..0x30)).collect();
            decoded(&stream, &mut random);
        }
    }
}
