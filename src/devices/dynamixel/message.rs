//! Instructions of Protocol 2.0 as types, in both directions (e-manual, "Instruction Packet").

use super::codec::{OutgoingPackets, STATUS};

/// An instruction packet. Lists remain encoded; [`Instruction::decode`] has checked their lengths.
///
/// ```
/// use nima_devices::dynamixel::{
///     codec::{IncomingPackets, OutgoingPackets},
///     message::Instruction,
/// };
///
/// let mut out = OutgoingPackets::new(32);
/// Instruction::Ping.encode(1, &mut out);
/// assert_eq!(out.bytes(), [0xFF, 0xFF, 0xFD, 0, 1, 3, 0, 1, 0x19, 0x4E], "the example of the e-manual");
///
/// let mut incoming = IncomingPackets::new(64);
/// incoming.feed(&[0x55, 0xFF]);
/// incoming.feed(out.bytes());
/// let packet = incoming.next().expect("a packet behind two bytes of noise");
/// assert_eq!((packet.id, Instruction::decode(packet.instruction, packet.body)), (1, Ok(Instruction::Ping)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instruction<'a> {
    Ping,
    Read {
        address: u16,
        count: u16,
    },
    Write {
        address: u16,
        data: &'a [u8],
    },
    RegWrite {
        address: u16,
        data: &'a [u8],
    },
    Action,
    FactoryReset {
        keep: Keep,
    },
    /// Restart; the only way to clear a shutdown.
    Reboot,
    /// Reset the count of whole turns.
    ClearTurns,
    /// Save or restore the control table.
    Backup {
        /// Restore instead of save.
        restore: bool,
    },
    /// Read the same registers of several servos.
    SyncRead {
        address: u16,
        /// Bytes per servo.
        count: u16,
        ids: &'a [u8],
        /// All servos answer in one packet.
        fast: bool,
    },
    /// Write the same registers of several servos; see [`sync_items`].
    SyncWrite {
        address: u16,
        /// Bytes per servo.
        count: u16,
        /// Id and data of each servo.
        items: &'a [u8],
    },
    /// Read different registers of several servos; see [`bulk_reads`].
    BulkRead {
        /// Id, address and count of each servo.
        items: &'a [u8],
        /// All servos answer in one packet.
        fast: bool,
    },
    /// Write different registers of several servos; see [`bulk_writes`].
    BulkWrite {
        /// Id, address, count and data of each servo.
        items: &'a [u8],
    },
}

/// Settings that a factory reset keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    Nothing,
    Id,
    /// The id and the line speed.
    IdAndBaud,
}

/// Reason why a servo refuses an instruction (low seven bits of the error byte).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum ServoRefusal {
    Failed = 1,
    Instruction = 2,
    Checksum = 3,
    Range = 4,
    /// Too few or too many bytes.
    Length = 5,
    /// Value outside the limits set in the servo.
    Limit = 6,
    /// Read-only register, no register, or EEPROM while the torque is on.
    Access = 7,
}

impl ServoRefusal {
    /// Decodes an error byte: `Ok(None)` without an error, `Err` with the byte if the error is unknown.
    ///
    /// # Errors
    /// The byte itself if it is not a known error.
    pub const fn of(error: u8) -> Result<Option<Self>, u8> {
        Ok(Some(match error & !ALERT {
            0 => return Ok(None),
            1 => Self::Failed,
            2 => Self::Instruction,
            3 => Self::Checksum,
            4 => Self::Range,
            5 => Self::Length,
            6 => Self::Limit,
            7 => Self::Access,
            other => return Err(other),
        }))
    }

    /// Returns the text for a message.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Failed => "the instruction failed",
            Self::Instruction => "the instruction is unknown",
            Self::Checksum => "the checksum was wrong",
            Self::Range => "the value is out of the register's range",
            Self::Length => "the length is wrong",
            Self::Limit => "the value is beyond a limit set in the servo",
            Self::Access => "the register cannot be written now",
        }
    }
}

/// Bit of the error byte that is set if there is a hardware error (ROBOTIS e-manual, protocol 2.0).
pub const ALERT: u8 = 0x80;

/// Key that [`Instruction::ClearTurns`] must carry: 1, "DXL" and 0x22.
const CLEAR_KEY: [u8; 5] = [0x01, 0x44, 0x58, 0x4C, 0x22];
/// Key that [`Instruction::Backup`] must carry: 1 and "CTRL".
const BACKUP_KEY: [u8; 5] = [0x01, 0x43, 0x54, 0x52, 0x4C];

fn pair(body: &[u8]) -> Option<(u16, u16, &[u8])> {
    let (head, rest) = body.split_first_chunk::<4>()?;
    Some((u16::from_le_bytes([head[0], head[1]]), u16::from_le_bytes([head[2], head[3]]), rest))
}

impl<'a> Instruction<'a> {
    /// Decodes the instruction and body of a packet.
    ///
    /// # Errors
    /// [`ServoRefusal`] with which a servo answers: unknown instruction, wrong length or wrong key.
    pub fn decode(instruction: u8, body: &'a [u8]) -> Result<Self, ServoRefusal> {
        let bare = |it: Self| if body.is_empty() { Ok(it) } else { Err(ServoRefusal::Length) };
        match instruction {
            0x01 => bare(Self::Ping),
            0x05 => bare(Self::Action),
            0x08 => bare(Self::Reboot),
            0x02 => match pair(body) {
                Some((address, count, [])) => Ok(Self::Read { address, count }),
                _ => Err(ServoRefusal::Length),
            },
            0x03 | 0x04 => {
                let (address, data) = body.split_first_chunk().ok_or(ServoRefusal::Length)?;
                let address = u16::from_le_bytes(*address);
                let write = Self::Write { address, data };
                Ok(if instruction == 0x03 { write } else { Self::RegWrite { address, data } })
            }
            0x06 => match body {
                [0xFF] => Ok(Self::FactoryReset { keep: Keep::Nothing }),
                [0x01] => Ok(Self::FactoryReset { keep: Keep::Id }),
                [0x02] => Ok(Self::FactoryReset { keep: Keep::IdAndBaud }),
                [_] => Err(ServoRefusal::Range),
                _ => Err(ServoRefusal::Length),
            },
            0x10 if body == CLEAR_KEY => Ok(Self::ClearTurns),
            0x20 | 0x21 if body == BACKUP_KEY => Ok(Self::Backup { restore: instruction == 0x21 }),
            0x10 | 0x20 | 0x21 => Err(ServoRefusal::Range),
            0x82 | 0x8A => {
                let (address, count, ids) = pair(body).ok_or(ServoRefusal::Length)?;
                Ok(Self::SyncRead { address, count, ids, fast: instruction == 0x8A })
            }
            0x83 => {
                let (address, count, items) = pair(body).ok_or(ServoRefusal::Length)?;
                let fits = items.len().is_multiple_of(usize::from(count) + 1);
                if fits { Ok(Self::SyncWrite { address, count, items }) } else { Err(ServoRefusal::Length) }
            }
            0x92 | 0x9A if body.len().is_multiple_of(5) => {
                Ok(Self::BulkRead { items: body, fast: instruction == 0x9A })
            }
            0x93 if bulk_writes(body).map(|(_, _, data)| 5 + data.len()).sum::<usize>() == body.len() => {
                Ok(Self::BulkWrite { items: body })
            }
            0x92 | 0x93 | 0x9A => Err(ServoRefusal::Length),
            _ => Err(ServoRefusal::Instruction),
        }
    }

    pub const fn code(&self) -> u8 {
        match self {
            Self::Ping => 0x01,
            Self::Read { .. } => 0x02,
            Self::Write { .. } => 0x03,
            Self::RegWrite { .. } => 0x04,
            Self::Action => 0x05,
            Self::FactoryReset { .. } => 0x06,
            Self::Reboot => 0x08,
            Self::ClearTurns => 0x10,
            Self::Backup { restore } => 0x20 + *restore as u8,
            Self::SyncRead { fast, .. } => 0x82 + 8 * *fast as u8,
            Self::SyncWrite { .. } => 0x83,
            Self::BulkRead { fast, .. } => 0x92 + 8 * *fast as u8,
            Self::BulkWrite { .. } => 0x93,
        }
    }

    /// Appends the instruction to `out` as a packet for `id`.
    pub fn encode(&self, id: u8, out: &mut OutgoingPackets) {
        out.begin(id, self.code());
        match *self {
            Self::Ping | Self::Action | Self::Reboot => {}
            Self::Read { address, count } => {
                out.put_u16(address).put_u16(count);
            }
            Self::Write { address, data } | Self::RegWrite { address, data } => {
                out.put_u16(address).put(data);
            }
            Self::FactoryReset { keep } => {
                out.put(match keep {
                    Keep::Nothing => &[0xFF],
                    Keep::Id => &[0x01],
                    Keep::IdAndBaud => &[0x02],
                });
            }
            Self::ClearTurns => {
                out.put(&CLEAR_KEY);
            }
            Self::Backup { .. } => {
                out.put(&BACKUP_KEY);
            }
            Self::SyncRead { address, count, ids: rest, .. } | Self::SyncWrite { address, count, items: rest } => {
                out.put_u16(address).put_u16(count).put(rest);
            }
            Self::BulkRead { items, .. } | Self::BulkWrite { items } => {
                out.put(items);
            }
        }
        out.end();
    }
}

/// Returns id and data of each servo in a sync write.
pub fn sync_items(items: &[u8], count: u16) -> impl Iterator<Item = (u8, &[u8])> {
    items.chunks_exact(usize::from(count) + 1).map(|item| (item[0], &item[1..]))
}

/// Returns id, address and count of each servo in a bulk read.
pub fn bulk_reads(items: &[u8]) -> impl Iterator<Item = (u8, u16, u16)> + Clone {
    let number = |low, high| u16::from_le_bytes([low, high]);
    items.chunks_exact(5).map(move |item| (item[0], number(item[1], item[2]), number(item[3], item[4])))
}

/// Returns id, address and data of each servo in a bulk write; stops at an incomplete item.
pub fn bulk_writes(mut items: &[u8]) -> impl Iterator<Item = (u8, u16, &[u8])> {
    std::iter::from_fn(move || {
        let (head, rest) = items.split_first_chunk::<5>()?;
        let (data, rest) = rest.split_at_checked(usize::from(u16::from_le_bytes([head[3], head[4]])))?;
        items = rest;
        Some((head[0], u16::from_le_bytes([head[1], head[2]]), data))
    })
}

pub fn encode_status(id: u8, error: u8, parameters: &[u8], out: &mut OutgoingPackets) {
    out.begin(id, STATUS).put(&[error]).put(parameters).end();
}
