//! Frames of the sensors, the same on a serial line and in datagrams: decoding with checks, and encoding.
//!
//! Little-endian; the header byte determines the length (reference `bota.md`, section 1.1). No input or output, no
//! clock, no allocation. A frame is accepted only with a correct checksum. After a false header the search continues
//! one byte later, so that the decoder cannot lock onto a constant value in the payload.
//!
//! The layout was read from published ROS drivers and compared with the manufacturer's client (`tests/peers`).

use crc::{CRC_16_IBM_SDLC, Crc};

use crate::stream_buffer::Unread;

/// Header of a frame with force and torque only.
pub const HEADER_WRENCH: u8 = 0xAA;
/// Header of a frame that also has the inertial unit.
pub const HEADER_INERTIAL: u8 = 0xAB;
/// Length of a frame with force and torque only, bytes.
pub const WRENCH_BYTES: usize = 37;
/// Length of a frame that also has the inertial unit, bytes.
pub const INERTIAL_BYTES: usize = 61;
/// Bits of the status word with a meaning: throttled, overrange, invalid, raw.
pub const STATUS_BITS: u16 = 0b1111;

// The checksum covers everything between the header and itself (`bota_driver`, 34 or 58 bytes).
const CRC_BYTES: usize = 2;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BotaFrame {
    /// Status word: bit 0 throttled, 1 overrange, 2 invalid, 3 raw; the others are reserved.
    pub status: u16,
    pub force_n: [f32; 3],
    pub torque_nm: [f32; 3],
    /// The sensor's clock, us; overflows after 2^32 us (71.6 min).
    pub timestamp_us: u32,
    pub temperature_c: f32,
    /// Data of the inertial unit, in frames that contain it.
    pub inertial: Option<Inertial>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inertial {
    /// Specific force, m/s^2 (at rest +g upwards).
    pub acceleration_m_s2: [f32; 3],
    pub angular_velocity_rad_s: [f32; 3],
}

/// Returns the length of a frame with this header byte; `None` if it is not a header.
pub const fn length_of(header: u8) -> Option<usize> {
    match header {
        HEADER_WRENCH => Some(WRENCH_BYTES),
        HEADER_INERTIAL => Some(INERTIAL_BYTES),
        _ => None,
    }
}

/// CRC-16/X-25: polynomial 0x1021 reflected, initial value and output inverted.
const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_SDLC);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoFrame {
    /// The first byte is not a header, or the length does not match it.
    Shape,
    Checksum,
}

impl BotaFrame {
    /// Encodes the frame with its checksum at the start of `buffer`; returns its length.
    pub fn encode(&self, buffer: &mut [u8; INERTIAL_BYTES]) -> usize {
        let length = if self.inertial.is_some() { INERTIAL_BYTES } else { WRENCH_BYTES };
        buffer[0] = if self.inertial.is_some() { HEADER_INERTIAL } else { HEADER_WRENCH };
        buffer[1..3].copy_from_slice(&self.status.to_le_bytes());
        put(&mut buffer[3..15], &self.force_n);
        put(&mut buffer[15..27], &self.torque_nm);
        buffer[27..31].copy_from_slice(&self.timestamp_us.to_le_bytes());
        put(&mut buffer[31..35], &[self.temperature_c]);
        if let Some(inertial) = &self.inertial {
            put(&mut buffer[35..47], &inertial.acceleration_m_s2);
            put(&mut buffer[47..59], &inertial.angular_velocity_rad_s);
        }
        let crc = CRC.checksum(&buffer[1..length - CRC_BYTES]);
        buffer[length - CRC_BYTES..length].copy_from_slice(&crc.to_le_bytes());
        length
    }

    /// Decodes exactly one frame, as in a datagram.
    ///
    /// # Errors
    /// [`NoFrame`] if the header, the length or the checksum is wrong.
    ///
    /// ```
    /// use nima_devices::bota::codec::{BotaFrame, INERTIAL_BYTES, NoFrame};
    ///
    /// let frame = BotaFrame { force_n: [1.0, -2.0, 0.5], timestamp_us: 1000, ..BotaFrame::default() };
    /// let mut wire = [0; INERTIAL_BYTES];
    /// let length = frame.encode(&mut wire);
    /// assert_eq!(BotaFrame::decode(&wire[..length]), Ok(frame));
    ///
    /// wire[5] ^= 1;
    /// assert_eq!(BotaFrame::decode(&wire[..length]), Err(NoFrame::Checksum));
    /// ```
    pub fn decode(bytes: &[u8]) -> Result<Self, NoFrame> {
        let header = *bytes.first().ok_or(NoFrame::Shape)?;
        // The length follows from the header, so a frame of another length is not one.
        if length_of(header) != Some(bytes.len()) {
            return Err(NoFrame::Shape);
        }
        let (body, crc) = bytes.split_at(bytes.len() - CRC_BYTES);
        if CRC.checksum(&body[1..]).to_le_bytes() != *crc {
            return Err(NoFrame::Checksum);
        }
        let [temperature_c] = take(&body[31..35]);
        let inertial = (header == HEADER_INERTIAL)
            .then(|| Inertial { acceleration_m_s2: take(&body[35..47]), angular_velocity_rad_s: take(&body[47..59]) });
        Ok(Self {
            status: u16::from_le_bytes([body[1], body[2]]),
            force_n: take(&body[3..15]),
            torque_nm: take(&body[15..27]),
            timestamp_us: u32::from_le_bytes([body[27], body[28], body[29], body[30]]),
            temperature_c,
            inertial,
        })
    }
}

fn put(to: &mut [u8], values: &[f32]) {
    for (bytes, value) in to.chunks_exact_mut(4).zip(values) {
        bytes.copy_from_slice(&value.to_le_bytes());
    }
}

fn take<const N: usize>(from: &[u8]) -> [f32; N] {
    let mut values = [0.0; N];
    for (value, bytes) in values.iter_mut().zip(from.chunks_exact(4)) {
        *value = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    }
    values
}

/// Size of the decoder's buffer: more than 20 ms of the fastest serial line.
/// 2048 bytes are 44 ms at 460 800 bit/s.
const ROOM: usize = 2048;

/// Finds frames in a stream of bytes. Write into [`room`](Self::room), report the number with [`filled`](Self::filled),
/// then call [`next`](Self::next) until it returns `None`.
#[derive(Debug)]
pub struct BotaDecoder {
    unread: Unread,
    /// Bytes skipped since the last refused or accepted frame, so that the remainder of a refused frame is not counted
    /// again.
    since_refused: usize,
    damaged: u64,
    skipped: u64,
}

impl Default for BotaDecoder {
    fn default() -> Self {
        Self { unread: Unread::with_room(ROOM), since_refused: WRENCH_BYTES, damaged: 0, skipped: 0 }
    }
}

impl BotaDecoder {
    /// Returns the buffer for new bytes; not empty once [`next`](Self::next) has returned `None`.
    pub fn room(&mut self) -> &mut [u8] {
        self.unread.room()
    }

    /// Reports that `count` bytes were written into the buffer.
    pub fn filled(&mut self, count: usize) {
        self.unread.filled(count);
    }

    /// Returns the next complete frame; `None` when more bytes are needed. Each call advances in the stream, so the
    /// work is bounded by the bytes received.
    #[expect(clippy::should_implement_trait, reason = "an iterator would borrow the room")]
    pub fn next(&mut self) -> Option<BotaFrame> {
        while let Some(first) = self.unread.bytes().first() {
            let Some(length) = length_of(*first) else {
                self.skip();
                continue;
            };
            // `None` until the rest of the frame has arrived.
            let candidate = self.unread.bytes().get(..length)?;
            if let Ok(frame) = BotaFrame::decode(candidate) {
                self.unread.pass(length);
                self.since_refused = WRENCH_BYTES;
                return Some(frame);
            }
            // A payload may contain header bytes, so one damaged frame is refused several times; it counts once.
            if self.since_refused >= WRENCH_BYTES {
                self.damaged += 1;
                self.since_refused = 0;
            }
            self.skip();
        }
        None
    }

    fn skip(&mut self) {
        // One byte only: the true header may be the next one.
        self.unread.pass(1);
        self.skipped += 1;
        self.since_refused = self.since_refused.saturating_add(1);
    }

    /// Returns the number of frames refused because of their checksum; bytes skipped within the length of one frame
    /// count once.
    pub const fn damaged(&self) -> u64 {
        self.damaged
    }

    pub const fn skipped(&self) -> u64 {
        self.skipped
    }

    pub const fn clear(&mut self) {
        self.unread.clear();
    }
}

#[cfg(test)]
#[path = "codec_tests.rs"]
mod tests;
