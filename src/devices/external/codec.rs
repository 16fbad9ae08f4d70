//! Datagrams of an external device: encoding, and decoding with checks. No input or output, no clock, no allocation.
//!
//! Little-endian; a header of 48 bytes, in readings 40 bytes of names, then numbers (`f64`), then the checksum.

use super::settings::ExternalKind;
use crate::ARM_JOINTS;

/// First bytes of every datagram.
pub const MAGIC: [u8; 4] = *b"NIMX";
/// Version of this format.
pub const VERSION: u8 = 1;
/// Maximum length of a datagram, bytes: the reading of an arm.
pub const BYTES_MAX: usize = HEADER_BYTES + NAMES_BYTES + 8 * NUMBERS_MAX + CRC_BYTES;
/// Maximum number of values in a datagram: angle, speed and torque of seven joints.
pub const NUMBERS_MAX: usize = 3 * ARM_JOINTS;
/// Numbers of joints that an arm may have; the length of its datagrams shows which.
const JOINTS: [usize; 2] = [ARM_JOINTS, ARM_JOINTS - 1];

// Lengths of the parts of a datagram (`docs/external-device.md`); changing one makes a new version of the protocol.
const HEADER_BYTES: usize = 48;
const PRODUCT_BYTES: usize = 24;
const SERIAL_BYTES: usize = 16;
const NAMES_BYTES: usize = PRODUCT_BYTES + SERIAL_BYTES;
const CRC_BYTES: usize = 4;

/// Bits of the status word.
pub mod status {
    /// Reading: force is on, or the arm follows commands. Command: the requested state.
    pub const ON: u16 = 1;
    /// The device itself reports a fault; its code is in the header.
    pub const FAULT: u16 = 1 << 1;
    /// Sensor: it skips measurements.
    pub const THROTTLED: u16 = 1 << 2;
    /// Sensor: above its range.
    pub const OVERRANGE: u16 = 1 << 3;
    /// Sensor: saturated or damaged.
    pub const INVALID: u16 = 1 << 4;
    /// Sensor: not in newtons.
    pub const RAW: u16 = 1 << 5;
    /// Handle: the orientation is measured.
    pub const HAS_ORIENTATION: u16 = 1 << 8;
    /// Handle: the velocity is measured.
    pub const HAS_VELOCITY: u16 = 1 << 9;
    /// Handle: there is a gripper.
    pub const HAS_GRIPPER: u16 = 1 << 10;
    /// Sensor: there is an accelerometer.
    pub const HAS_ACCELERATION: u16 = 1 << 11;
    /// Sensor: there is a gyroscope.
    pub const HAS_ANGULAR_VELOCITY: u16 = 1 << 12;
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExternalMessage {
    /// A reading, sent by the device.
    Reading(ExternalKind),
    /// A command, sent to the device.
    Command(ExternalKind),
}

impl ExternalMessage {
    // The highest bit distinguishes the datagrams to a device from those of the device.
    const COMMAND: u8 = 0x80;

    const fn code(self) -> u8 {
        match self {
            Self::Reading(kind) => kind.code(),
            Self::Command(kind) => kind.code() | Self::COMMAND,
        }
    }

    fn of(code: u8) -> Option<Self> {
        let kind = ExternalKind::ALL.into_iter().find(|kind| kind.code() == code & !Self::COMMAND)?;
        Some(if code & Self::COMMAND == 0 { Self::Reading(kind) } else { Self::Command(kind) })
    }

    /// Returns the number of values; `joints` counts only for an arm.
    pub const fn numbers(self, joints: usize) -> usize {
        match self {
            // Position, orientation (w, x, y, z), velocity, gripper.
            Self::Reading(ExternalKind::Handle) => 11,
            // Angle, speed and torque of each joint.
            Self::Reading(ExternalKind::Arm) => 3 * joints,
            // Force, torque, acceleration, angular velocity, temperature.
            Self::Reading(ExternalKind::Sensor) => 13,
            // Force on the hand, force on the gripper.
            Self::Command(ExternalKind::Handle) => 4,
            // Angle of each joint.
            Self::Command(ExternalKind::Arm) => joints,
            Self::Command(ExternalKind::Sensor) => 0,
        }
    }

    const fn names_bytes(self) -> usize {
        match self {
            Self::Reading(_) => NAMES_BYTES,
            Self::Command(_) => 0,
        }
    }

    pub const fn bytes(self, joints: usize) -> usize {
        HEADER_BYTES + self.names_bytes() + 8 * self.numbers(joints) + CRC_BYTES
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Datagram {
    pub message: ExternalMessage,
    /// The device program's random number, which changes with every restart. Commands repeat it.
    pub session: u32,
    /// Counts the sender's datagrams, by one.
    pub sequence: u32,
    /// The sender's monotonic clock at creation, us; never 0.
    pub time_us: u64,
    /// `time_us` of the newest datagram that the sender has received; 0 before the first.
    pub echo_us: u64,
    /// Reading: time without a command after which the device switches itself off. Command: the maximum of that time,
    /// us.
    pub watchdog_us: u32,
    pub status: u16,
    /// The device's own code of a fault.
    pub fault: u16,
    /// Pressed buttons of a handle, the first one in the lowest bit.
    pub buttons: u32,
    /// Name of the device, padded with zeros; in readings only.
    pub product: [u8; PRODUCT_BYTES],
    /// Serial number, padded with zeros; only in readings.
    pub serial: [u8; SERIAL_BYTES],
    /// Number of an arm's joints, 6 or 7; 7 in datagrams of other devices.
    pub joints: usize,
    /// The values, see [`ExternalMessage::numbers`]; the others are 0.
    pub numbers: [f64; NUMBERS_MAX],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoDatagram {
    /// The first bytes are wrong, or the length does not match the type.
    Shape,
    Version(u8),
    Checksum,
}

impl Datagram {
    pub const fn blank(message: ExternalMessage) -> Self {
        Self {
            message,
            session: 0,
            sequence: 0,
            time_us: 0,
            echo_us: 0,
            watchdog_us: 0,
            status: 0,
            fault: 0,
            buttons: 0,
            product: [0; PRODUCT_BYTES],
            serial: [0; SERIAL_BYTES],
            joints: ARM_JOINTS,
            numbers: [0.0; NUMBERS_MAX],
        }
    }

    /// Returns whether all of these bits are set.
    pub const fn has(&self, bits: u16) -> bool {
        self.status & bits == bits
    }

    pub const fn three(&self, first: usize) -> [f64; 3] {
        [self.numbers[first], self.numbers[first + 1], self.numbers[first + 2]]
    }

    /// Writes the datagram with its checksum to the beginning of `buffer`; returns its length.
    pub fn encode(&self, buffer: &mut [u8; BYTES_MAX]) -> usize {
        let length = self.message.bytes(self.joints);
        let body = length - CRC_BYTES;
        buffer[..4].copy_from_slice(&MAGIC);
        buffer[4] = VERSION;
        buffer[5] = self.message.code();
        buffer[6..8].copy_from_slice(&((body - HEADER_BYTES) as u16).to_le_bytes());
        buffer[8..12].copy_from_slice(&self.session.to_le_bytes());
        buffer[12..16].copy_from_slice(&self.sequence.to_le_bytes());
        buffer[16..24].copy_from_slice(&self.time_us.to_le_bytes());
        buffer[24..32].copy_from_slice(&self.echo_us.to_le_bytes());
        buffer[32..36].copy_from_slice(&self.watchdog_us.to_le_bytes());
        buffer[36..38].copy_from_slice(&self.status.to_le_bytes());
        buffer[38..40].copy_from_slice(&self.fault.to_le_bytes());
        buffer[40..44].copy_from_slice(&self.buttons.to_le_bytes());
        buffer[44..48].fill(0);
        let names = HEADER_BYTES + self.message.names_bytes();
        if names > HEADER_BYTES {
            buffer[HEADER_BYTES..HEADER_BYTES + PRODUCT_BYTES].copy_from_slice(&self.product);
            buffer[HEADER_BYTES + PRODUCT_BYTES..names].copy_from_slice(&self.serial);
        }
        for (bytes, number) in buffer[names..body].chunks_exact_mut(8).zip(&self.numbers) {
            bytes.copy_from_slice(&number.to_le_bytes());
        }
        let crc = crc32fast::hash(&buffer[..body]);
        buffer[body..length].copy_from_slice(&crc.to_le_bytes());
        length
    }

    /// Decodes exactly one datagram.
    ///
    /// # Errors
    /// [`NoDatagram`] if beginning, version, length or checksum are wrong.
    ///
    /// ```
    /// use nima_devices::external::{
    ///     ExternalKind,
    ///     codec::{BYTES_MAX, Datagram, ExternalMessage, NoDatagram},
    /// };
    ///
    /// let mut reading = Datagram { session: 7, time_us: 1, ..Datagram::blank(ExternalMessage::Reading(ExternalKind::Handle)) };
    /// reading.numbers[2] = 0.05;
    /// let mut wire = [0; BYTES_MAX];
    /// let length = reading.encode(&mut wire);
    /// assert_eq!(Datagram::decode(&wire[..length]), Ok(reading));
    ///
    /// wire[60] ^= 1;
    /// assert_eq!(Datagram::decode(&wire[..length]), Err(NoDatagram::Checksum));
    /// ```
    pub fn decode(bytes: &[u8]) -> Result<Self, NoDatagram> {
        if bytes.len() < HEADER_BYTES + CRC_BYTES || bytes[..4] != MAGIC {
            return Err(NoDatagram::Shape);
        }
        if bytes[4] != VERSION {
            return Err(NoDatagram::Version(bytes[4]));
        }
        let message = ExternalMessage::of(bytes[5]).ok_or(NoDatagram::Shape)?;
        let (body, crc) = bytes.split_at(bytes.len() - CRC_BYTES);
        let report = usize::from(u16::from_le_bytes([body[6], body[7]]));
        let joints = JOINTS.into_iter().find(|joints| message.bytes(*joints) == bytes.len());
        let joints = joints.filter(|_| report == body.len() - HEADER_BYTES).ok_or(NoDatagram::Shape)?;
        if crc32fast::hash(body).to_le_bytes() != *crc {
            return Err(NoDatagram::Checksum);
        }
        let mut datagram = Self {
            session: u32::from_le_bytes(part(body, 8)),
            sequence: u32::from_le_bytes(part(body, 12)),
            time_us: u64::from_le_bytes(part(body, 16)),
            echo_us: u64::from_le_bytes(part(body, 24)),
            watchdog_us: u32::from_le_bytes(part(body, 32)),
            status: u16::from_le_bytes(part(body, 36)),
            fault: u16::from_le_bytes(part(body, 38)),
            buttons: u32::from_le_bytes(part(body, 40)),
            joints,
            ..Self::blank(message)
        };
        let names = HEADER_BYTES + message.names_bytes();
        if names > HEADER_BYTES {
            datagram.product = part(body, HEADER_BYTES);
            datagram.serial = part(body, HEADER_BYTES + PRODUCT_BYTES);
        }
        for (number, bytes) in datagram.numbers.iter_mut().zip(body[names..].chunks_exact(8)) {
            *number = f64::from_le_bytes(part(bytes, 0));
        }
        Ok(datagram)
    }
}

fn part<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut part = [0; N];
    part.copy_from_slice(&bytes[at..at + N]);
    part
}

/// Returns a name of a datagram as text, without characters other than printable ASCII.
pub fn name(bytes: &[u8]) -> String {
    let text = bytes.iter().take_while(|byte| **byte != 0).filter(|byte| byte.is_ascii_graphic() || **byte == b' ');
    text.map(|byte| char::from(*byte)).collect::<String>().trim().to_owned()
}

/// Returns a text as a name of a datagram, truncated to its length.
pub fn padded<const N: usize>(text: &str) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.iter_mut().zip(text.bytes()).for_each(|(to, byte)| *to = byte);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every() -> impl Iterator<Item = ExternalMessage> {
        ExternalKind::ALL.into_iter().flat_map(|kind| [ExternalMessage::Reading(kind), ExternalMessage::Command(kind)])
    }

    #[test]
    fn every_kind_goes_to_the_wire_and_back_and_no_changed_byte_passes() {
        for (message, joints) in every().flat_map(|message| JOINTS.map(|joints| (message, joints))) {
            // Only an arm's datagrams depend on its joints.
            let joints = if message.bytes(joints) == message.bytes(ARM_JOINTS) { ARM_JOINTS } else { joints };
            let mut datagram = Datagram {
                session: 0x0102_0304,
                sequence: u32::MAX,
                time_us: 1 << 40,
                echo_us: 3,
                watchdog_us: 20_000,
                status: status::ON | status::HAS_GRIPPER,
                fault: 0xBEEF,
                buttons: 5,
                joints,
                ..Datagram::blank(message)
            };
            if matches!(message, ExternalMessage::Reading(_)) {
                datagram.product = padded("a handle");
                datagram.serial = padded("SN-1");
            }
            for (place, number) in datagram.numbers.iter_mut().take(message.numbers(joints)).enumerate() {
                *number = place as f64 - 0.125;
            }
            let mut wire = [0xAA; BYTES_MAX];
            let length = datagram.encode(&mut wire);
            assert_eq!(length, message.bytes(joints));
            assert_eq!(Datagram::decode(&wire[..length]), Ok(datagram));
            for place in 0..length {
                let mut changed = wire;
                changed[place] ^= 0x10;
                assert!(Datagram::decode(&changed[..length]).is_err(), "{message:?}, byte {place}");
            }
            for short in 0..length {
                assert!(Datagram::decode(&wire[..short]).is_err());
            }
            wire[4] = 2;
            assert_eq!(Datagram::decode(&wire[..length]), Err(NoDatagram::Version(2)));
        }
    }

    #[test]
    fn random_bytes_are_no_datagram_and_no_panic() {
        let mut random = fastrand::Rng::with_seed(21);
        for _ in 0..20_000 {
            let mut bytes: Vec<u8> = (0..random.usize(0..BYTES_MAX + 9)).map(|_| random.u8(..)).collect();
            if bytes.len() > 8 && random.bool() {
                bytes[..4].copy_from_slice(&MAGIC);
                bytes[4] = VERSION;
                bytes[5] = random.u8(..);
            }
            assert!(Datagram::decode(&bytes).is_err());
        }
    }

    #[test]
    fn a_name_is_cut_to_its_place_and_shown_without_control_characters() {
        assert_eq!(name(&padded::<16>("SN-0001")), "SN-0001");
        assert_eq!(name(&padded::<4>("longer")), "long");
        assert_eq!(name(b"a\x1b[31m\0rest"), "a[31m");
    }
}
