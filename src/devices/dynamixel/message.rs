//! Instructions of Protocol 2.0 as types, both ways (e-manual, "Instruction Packet").

use super::codec::{Outgoing, STATUS};

/// What a controller asks. Lists stay as they are on the wire; [`Instruction::decode`] has checked their lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instruction<'a> {
    /// Who are you.
    Ping,
    /// Read `count` bytes.
    Read {
        /// First address.
        address: u16,
        count: u16,
    },
    /// Write at once.
    Write {
        /// First address.
        address: u16,
        data: &'a [u8],
    },
    /// Write when [`Instruction::Action`] comes.
    RegWrite {
        /// First address.
        address: u16,
        data: &'a [u8],
    },
    /// Do what was registered.
    Action,
    /// Back to the factory's values.
    FactoryReset { keep: Keep },
    /// Start again; the only way out of a shutdown.
    Reboot,
    /// Forget whole turns of the shaft.
    ClearTurns,
    /// Save the control table, or take it back.
    Backup {
        /// Take it back.
        restore: bool,
    },
    /// Read the same of several servos.
    SyncRead {
        /// First address.
        address: u16,
        /// Bytes of each.
        count: u16,
        /// Servos.
        ids: &'a [u8],
        /// One packet answers for all.
        fast: bool,
    },
    /// Write the same of several servos; see [`sync_items`].
    SyncWrite {
        /// First address.
        address: u16,
        /// Bytes of each.
        count: u16,
        /// Id and data of each.
        items: &'a [u8],
    },
    /// Read something of several servos; see [`bulk_reads`].
    BulkRead {
        /// Id, address and count of each.
        items: &'a [u8],
        /// One packet answers for all.
        fast: bool,
    },
    /// Write something of several servos; see [`bulk_writes`].
    BulkWrite {
        /// Id, address, count and data of each.
        items: &'a [u8],
    },
}

/// What a factory reset keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    Nothing,
    Id,
    /// The id and the line speed.
    IdAndBaud,
}

/// Why a servo refuses an instruction (low seven bits of the error byte).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Refusal {
    /// It tried and failed.
    Failed = 1,
    /// No such instruction.
    Instruction = 2,
    /// Wrong checksum.
    Checksum = 3,
    /// A value out of the register's range.
    Range = 4,
    /// Too few or too many bytes.
    Length = 5,
    /// A value out of the limits set in the servo.
    Limit = 6,
    /// Read-only, no register, or EEPROM while the torque is on.
    Access = 7,
}

impl Refusal {
    /// Of an error byte; `Ok` when it tells none, the byte itself when it is none of those known.
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

    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Failed => "it could not do it",
            Self::Instruction => "it does not know this instruction",
            Self::Checksum => "the checksum was wrong",
            Self::Range => "the value is out of the register's range",
            Self::Length => "the length does not fit",
            Self::Limit => "the value is beyond a limit set in the servo",
            Self::Access => "the register cannot be written now",
        }
    }
}

/// Bit of the error byte that tells of a hardware error.
pub const ALERT: u8 = 0x80;

/// "DXD" with a one before it, which [`Instruction::ClearTurns`] has to carry.
const CLEAR_KEY: [u8; 5] = [0x01, 0x44, 0x58, 0x4C, 0x22];
/// "CTRL", which [`Instruction::Backup`] has to carry.
const BACKUP_KEY: [u8; 5] = [0x01, 0x43, 0x54, 0x52, 0x4C];

fn pair(body: &[u8]) -> Option<(u16, u16, &[u8])> {
    let (head, rest) = body.split_first_chunk::<4>()?;
    Some((u16::from_le_bytes([head[0], head[1]]), u16::from_le_bytes([head[2], head[3]]), rest))
}

impl<'a> Instruction<'a> {
    /// Of a packet's instruction and body.
    pub fn decode(instruction: u8, body: &'a [u8]) -> Result<Self, Refusal> {
        let bare = |it: Self| if body.is_empty() { Ok(it) } else { Err(Refusal::Length) };
        match instruction {
            0x01 => bare(Self::Ping),
            0x05 => bare(Self::Action),
            0x08 => bare(Self::Reboot),
            0x02 => match pair(body) {
                Some((address, count, [])) => Ok(Self::Read { address, count }),
                _ => Err(Refusal::Length),
            },
            0x03 | 0x04 => {
                let (address, data) = body.split_first_chunk().ok_or(Refusal::Length)?;
                let address = u16::from_le_bytes(*address);
                let write = Self::Write { address, data };
                Ok(if instruction == 0x03 { write } else { Self::RegWrite { address, data } })
            }
            0x06 => match body {
                [0xFF] => Ok(Self::FactoryReset { keep: Keep::Nothing }),
                [0x01] => Ok(Self::FactoryReset { keep: Keep::Id }),
                [0x02] => Ok(Self::FactoryReset { keep: Keep::IdAndBaud }),
                [_] => Err(Refusal::Range),
                _ => Err(Refusal::Length),
            },
            0x10 if body == CLEAR_KEY => Ok(Self::ClearTurns),
            0x20 | 0x21 if body == BACKUP_KEY => Ok(Self::Backup { restore: instruction == 0x21 }),
            0x10 | 0x20 | 0x21 => Err(Refusal::Range),
            0x82 | 0x8A => {
                let (address, count, ids) = pair(body).ok_or(Refusal::Length)?;
                Ok(Self::SyncRead { address, count, ids, fast: instruction == 0x8A })
            }
            0x83 => {
                let (address, count, items) = pair(body).ok_or(Refusal::Length)?;
                let fits = items.len().is_multiple_of(usize::from(count) + 1);
                if fits { Ok(Self::SyncWrite { address, count, items }) } else { Err(Refusal::Length) }
            }
            0x92 | 0x9A if body.len().is_multiple_of(5) => {
                Ok(Self::BulkRead { items: body, fast: instruction == 0x9A })
            }
            0x93 if bulk_writes(body).map(|(_, _, data)| 5 + data.len()).sum::<usize>() == body.len() => {
                Ok(Self::BulkWrite { items: body })
            }
            0x92 | 0x93 | 0x9A => Err(Refusal::Length),
            _ => Err(Refusal::Instruction),
        }
    }

    /// Its byte on the wire.
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

    /// Puts it as a packet for `id`.
    pub fn encode(&self, id: u8, out: &mut Outgoing) {
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

/// Id and data of each servo in a sync write.
pub fn sync_items(items: &[u8], count: u16) -> impl Iterator<Item = (u8, &[u8])> {
    items.chunks_exact(usize::from(count) + 1).map(|item| (item[0], &item[1..]))
}

/// Id, address and count of each servo in a bulk read.
pub fn bulk_reads(items: &[u8]) -> impl Iterator<Item = (u8, u16, u16)> + Clone {
    let number = |low, high| u16::from_le_bytes([low, high]);
    items.chunks_exact(5).map(move |item| (item[0], number(item[1], item[2]), number(item[3], item[4])))
}

/// Id, address and data of each servo in a bulk write, as far as they are whole.
pub fn bulk_writes(mut items: &[u8]) -> impl Iterator<Item = (u8, u16, &[u8])> {
    std::iter::from_fn(move || {
        let (head, rest) = items.split_first_chunk::<5>()?;
        let (data, rest) = rest.split_at_checked(usize::from(u16::from_le_bytes([head[3], head[4]])))?;
        items = rest;
        Some((head[0], u16::from_le_bytes([head[1], head[2]]), data))
    })
}

/// Puts a status packet.
pub fn encode_status(id: u8, error: u8, parameters: &[u8], out: &mut Outgoing) {
    out.begin(id, STATUS).put(&[error]).put(parameters).end();
}
