//! The journal of a session: the messages from which the loop is replayed.
//!
//! Each message carries the journal's version, its number in the journal and its own CRC-32, so that a lost or changed
//! message is always detected and located. A [`JournalStart`] comes first, a [`JournalEnd`] last if the recording was
//! closed; between them are [`JournalBlock`]s of ticks, and calibrations before the block that activates them.

mod block;
mod parts;
#[cfg(test)]
mod tests;

use nima_core::{
    impedance::SLOTS,
    safety::{GATES, Reason},
};
use nima_machine::teleop::Calibrations;

pub use block::{BLOCK_TICKS, BlockWriter, JournalBlock, TickNote, TickRow};
pub use parts::{JournalEnd, JournalStart};

use crate::codec::CodecError;
use parts::ByteWriter;

/// Version of the journal that this program writes.
///
/// Version 5 contains the raw readings of the devices and the true time of each tick; version 6 also the commanded tip
/// positions. It was introduced when `best` began to hold forces that motion does not explain, when `matched` began to
/// restart on other tissue, when wrong positions and gaps were bridged, and when the lag of the follower began to glide. A
/// journal of version 5 is replayed without these changes
/// ([`earlier_forces`](nima_core::impedance::ImpedanceSettings::earlier_forces)), because they would give other forces
/// than the hand felt.
pub const VERSION: u16 = 6;
/// The oldest version that is read.
const OLDEST: u16 = 5;
/// The oldest version with [`PlannedTip`](nima_machine::rig::PlannedTip)s.
const PLANS_FROM: u16 = 6;

// A tick has a column for each mode and gate, and a number for each reason, so the journal's format depends on these
// counts.
const _: () = assert!(
    SLOTS == 8 && GATES == 9 && Reason::ALL.len() == 18,
    "a mode, a gate or a reason was added: raise VERSION, and correct these numbers"
);

const MAGIC: [u8; 4] = *b"NIMJ";
/// Magic, version, CRC.
const HEAD: usize = 10;

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum JournalError {
    #[error("it was not written by this program")]
    Foreign,
    #[error(
        "its journal has version {found}, but this program reads versions {OLDEST} and {VERSION}; replay it with the program that recorded it"
    )]
    Version { found: u16 },
    #[error("its content does not match its checksum: the file was changed or damaged")]
    Damaged,
    #[error("its content is invalid: {0}")]
    Wrong(#[from] CodecError),
    #[error("its {what} cannot be used: {why}")]
    Part { what: &'static str, why: String },
}

#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "one at a time")]
pub enum JournalMessage {
    /// Origin of the loop.
    Start(JournalStart),
    /// Calibrations that become active later, by their number.
    Calibrations {
        number: u64,
        calibrations: Calibrations,
    },
    Block(JournalBlock),
    /// The recording was closed.
    End(JournalEnd),
}

// Kinds of messages in a file: never renumber one.
const START: u8 = 0;
const CALIBRATIONS: u8 = 1;
const BLOCK: u8 = 2;
const END: u8 = 3;

/// Encodes messages and numbers them.
#[derive(Clone, Copy, Debug, Default)]
pub struct JournalEncoder {
    next: u64,
}

impl JournalEncoder {
    /// Encodes the origin of the loop.
    ///
    /// # Errors
    /// [`JournalError::Part`] if a rig or calibration cannot be written and read back unchanged.
    pub fn start(&mut self, start: &JournalStart) -> Result<Vec<u8>, JournalError> {
        let mut body = ByteWriter::default();
        start.put(&mut body)?;
        Ok(self.message(START, &body.0))
    }

    /// # Errors
    /// As [`JournalEncoder::start`].
    pub fn calibrations(&mut self, number: u64, calibrations: &Calibrations) -> Result<Vec<u8>, JournalError> {
        let mut body = ByteWriter::default();
        body.number(number);
        parts::put_calibrations(calibrations, &mut body)?;
        Ok(self.message(CALIBRATIONS, &body.0))
    }

    /// Encodes the ticks so far and empties the writer.
    pub fn block(&mut self, block: &mut BlockWriter) -> Vec<u8> {
        self.message(BLOCK, &block.take())
    }

    pub fn end(&mut self, end: &JournalEnd) -> Vec<u8> {
        let mut body = ByteWriter::default();
        end.put(&mut body);
        self.message(END, &body.0)
    }

    fn message(&mut self, kind: u8, body: &[u8]) -> Vec<u8> {
        let mut content = self.next.to_le_bytes().to_vec();
        self.next += 1;
        content.push(kind);
        content.extend_from_slice(body);
        let mut all = MAGIC.to_vec();
        all.extend(VERSION.to_le_bytes());
        all.extend(crc32fast::hash(&content).to_le_bytes());
        all.append(&mut content);
        all
    }
}

/// A message without its ticks and calibrations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MessageOutline {
    /// Origin of the loop.
    Start,
    /// Calibrations that become active later.
    Calibrations,
    Block {
        /// Number of dropped entries for each gap.
        lost: Vec<u64>,
    },
    /// The recording was closed.
    End(JournalEnd),
}

/// Returns the outline of a message, for readers that do not replay it.
///
/// # Errors
/// The errors of [`decode`], except for ticks and calibrations, which are not read.
pub fn outline(bytes: &[u8]) -> Result<MessageOutline, JournalError> {
    let OpenedMessage { kind, body, .. } = opened(bytes)?;
    Ok(match kind {
        START => MessageOutline::Start,
        CALIBRATIONS => MessageOutline::Calibrations,
        BLOCK => MessageOutline::Block { lost: block::holes(body)? },
        END => MessageOutline::End(JournalEnd::take(&mut &*body)?),
        _ => return Err(CodecError::NoSuchValue.into()),
    })
}

/// Returns the number of a message in its journal.
///
/// # Errors
/// The errors of [`decode`], except for the content, which is not read.
pub fn number(bytes: &[u8]) -> Result<u64, JournalError> {
    opened(bytes).map(|opened| opened.number)
}

/// # Errors
/// [`JournalError`] if the bytes are not a message, or are damaged.
pub fn decode(bytes: &[u8]) -> Result<(u64, JournalMessage), JournalError> {
    let OpenedMessage { version, number, kind, mut body } = opened(bytes)?;
    let body = &mut body;
    let message = match kind {
        START => {
            let mut start = JournalStart::take(body)?;
            // A part of an older session that this version wrote again already has it.
            start.origin.rig.identification.earlier_forces |= version < VERSION;
            JournalMessage::Start(start)
        }
        CALIBRATIONS => {
            let number = crate::codec::take_number(body)?;
            JournalMessage::Calibrations { number, calibrations: parts::take_calibrations(body)? }
        }
        BLOCK => JournalMessage::Block(JournalBlock::take(body, version >= PLANS_FROM)?),
        END => JournalMessage::End(JournalEnd::take(body)?),
        _ => return Err(CodecError::NoSuchValue.into()),
    };
    if body.is_empty() { Ok((number, message)) } else { Err(CodecError::Long.into()) }
}

/// A message whose checksum is correct.
struct OpenedMessage<'a> {
    version: u16,
    number: u64,
    kind: u8,
    body: &'a [u8],
}

fn opened(bytes: &[u8]) -> Result<OpenedMessage<'_>, JournalError> {
    let (head, content) = bytes.split_at_checked(HEAD).ok_or(JournalError::Foreign)?;
    if head[..4] != MAGIC {
        return Err(JournalError::Foreign);
    }
    let found = u16::from_le_bytes([head[4], head[5]]);
    if !(OLDEST..=VERSION).contains(&found) {
        return Err(JournalError::Version { found });
    }
    if crc32fast::hash(content).to_le_bytes() != head[6..] {
        return Err(JournalError::Damaged);
    }
    let (number, rest) = content.split_first_chunk::<8>().ok_or(CodecError::Short)?;
    let (&kind, body) = rest.split_first().ok_or(CodecError::Short)?;
    Ok(OpenedMessage { version: found, number: u64::from_le_bytes(*number), kind, body })
}
