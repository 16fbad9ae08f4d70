//! The journal of a session, step by step.

use std::{iter::Peekable, mem::take, vec};

use nima_machine::{runtime::Operation, teleop::Calibrations};

use super::ReplayError;
use crate::journal::{JournalBlock, JournalEnd, JournalMessage, JournalStart, TickNote, TickRow, decode, number};

/// One step of a journal.
#[derive(Debug)]
pub enum ReplayStep {
    /// An operation on the loop.
    Operation(Operation),
    /// Calibrations that become active later.
    Calibrations {
        /// Number used by operations to refer to it.
        number: u64,
        calibrations: Box<Calibrations>,
    },
    /// The loop is stepped with [`Journal::row`].
    Tick,
    /// Entries are missing here.
    Hole {
        /// Number of missing entries.
        lost: u64,
    },
    /// The recording was closed.
    End(JournalEnd),
}

/// A part of a journal.
#[derive(Debug)]
pub enum JournalPart {
    /// Ticks without an operation between them.
    Ticks(Vec<TickRow>),
    /// A step between ticks.
    Between(ReplayStep),
}

/// The steps of a journal whose beginning has been read.
#[derive(Debug)]
pub struct Journal<I> {
    messages: I,
    read: u64,
    start: JournalStart,
    open: Option<OpenBlock>,
}

/// A block that is being read.
#[derive(Debug)]
struct OpenBlock {
    rows: Vec<TickRow>,
    noted: Peekable<vec::IntoIter<(usize, TickNote)>>,
    /// Rows that were read.
    passed: usize,
}

/// A message of a journal, and its number.
pub type NumberedMessage = (u64, JournalMessage);

/// Messages of a journal from any source.
pub type StepsMessages = Box<dyn Iterator<Item = Result<NumberedMessage, ReplayError>> + Send>;

impl<I: Iterator<Item = Result<NumberedMessage, ReplayError>>> Journal<I> {
    /// Reads the beginning.
    ///
    /// # Errors
    /// [`ReplayError`] if there is none.
    pub fn open(mut messages: I) -> Result<Self, ReplayError> {
        let mut read = 0;
        match next_message(&mut messages, &mut read)? {
            Some(JournalMessage::Start(start)) => Ok(Self { messages, read, start, open: None }),
            Some(_) => Err(ReplayError::NoStart),
            None => Err(ReplayError::NoJournal),
        }
    }

    /// Returns the next step, or all ticks before it at once.
    pub fn next_part(&mut self) -> Option<Result<JournalPart, ReplayError>> {
        Some(match self.next()? {
            Ok(ReplayStep::Tick) => Ok(JournalPart::Ticks(self.open.as_mut().map(OpenBlock::run).unwrap_or_default())),
            step => step.map(JournalPart::Between),
        })
    }

    /// Returns the origin of the loop.
    pub const fn start(&self) -> &JournalStart {
        &self.start
    }

    /// Returns the number of messages read, if all their steps were taken: a position from which [`go_on`] can read.
    pub fn between_blocks(&self) -> Option<u64> {
        match &self.open {
            Some(open) if !open.is_read() => None,
            _ => Some(self.read),
        }
    }

    /// Returns the inputs of the loop if the last step was a tick. A reference, because it has a kilobyte.
    pub fn row(&self) -> Option<&TickRow> {
        let open = self.open.as_ref()?;
        open.rows.get(open.passed.checked_sub(1)?)
    }
}

/// Decodes the messages of these bytes after the first `read` of the journal. The bytes may begin with some of those,
/// and duplicates are skipped: if a recording continued in another location, both files may have them.
pub fn decoded(
    bytes: impl Iterator<Item = Result<Vec<u8>, ReplayError>>,
    read: u64,
) -> impl Iterator<Item = Result<NumberedMessage, ReplayError>> {
    let mut next = read;
    bytes.filter_map(move |bytes| {
        let decoded = bytes.and_then(|bytes| match number(&bytes) {
            // The state of the loop at the start already contains these messages.
            Ok(number) if number < next => Ok(None),
            _ => decode(&bytes).map(Some).map_err(|source| ReplayError::Message { place: next + 1, source }),
        });
        if let Ok(Some((number, _))) = &decoded {
            next = *number + 1;
        }
        decoded.transpose()
    })
}

/// Returns the steps of a journal with this beginning after its first `read` messages; `messages` are the ones that
/// follow.
pub(super) const fn go_on<I>(messages: I, start: JournalStart, read: u64) -> Journal<I> {
    Journal { messages, read, start, open: None }
}

impl<I: Iterator<Item = Result<NumberedMessage, ReplayError>>> Iterator for Journal<I> {
    type Item = Result<ReplayStep, ReplayError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(step) = self.open.as_mut().and_then(OpenBlock::next) {
                return Some(Ok(step));
            }
            self.open = None;
            return Some(Ok(match next_message(&mut self.messages, &mut self.read).transpose()? {
                Err(error) => return Some(Err(error)),
                Ok(JournalMessage::Start(_)) => return Some(Err(ReplayError::NoStart)),
                Ok(JournalMessage::Calibrations { number, calibrations }) => {
                    ReplayStep::Calibrations { number, calibrations: Box::new(calibrations) }
                }
                Ok(JournalMessage::End(end)) => ReplayStep::End(end),
                Ok(JournalMessage::Block(block)) => {
                    self.open = Some(OpenBlock::of(block));
                    continue;
                }
            }));
        }
    }
}

impl OpenBlock {
    fn of(block: JournalBlock) -> Self {
        let JournalBlock { rows, noted, .. } = block;
        Self { rows, noted: noted.into_iter().peekable(), passed: 0 }
    }

    fn is_read(&self) -> bool {
        self.passed == self.rows.len() && self.noted.len() == 0
    }

    fn next(&mut self) -> Option<ReplayStep> {
        let passed = self.passed;
        let last = self.passed == self.rows.len();
        // Notes after the last tick belong to the end of the block.
        if let Some((_, noted)) = self.noted.next_if(|(before, _)| last || *before <= passed) {
            return Some(step_of(noted));
        }
        if last {
            return None;
        }
        self.passed += 1;
        Some(ReplayStep::Tick)
    }

    /// Returns the tick that [`OpenBlock::next`] reached and those up to the next operation.
    fn run(&mut self) -> Vec<TickRow> {
        let first = self.passed.saturating_sub(1);
        let last = self.rows.len();
        let end = self.noted.peek().map_or(last, |(before, _)| (*before).clamp(self.passed, last));
        // The usual case, without a copy.
        if (first, end) == (0, last) {
            self.passed = 0;
            return take(&mut self.rows);
        }
        self.passed = end;
        self.rows[first..end].to_vec()
    }
}

const fn step_of(noted: TickNote) -> ReplayStep {
    match noted {
        TickNote::Operation(operation) => ReplayStep::Operation(operation),
        TickNote::Hole { lost } => ReplayStep::Hole { lost },
    }
}

fn next_message(
    messages: &mut impl Iterator<Item = Result<NumberedMessage, ReplayError>>,
    read: &mut u64,
) -> Result<Option<JournalMessage>, ReplayError> {
    let Some((number, message)) = messages.next().transpose()? else { return Ok(None) };
    if number != *read {
        return Err(ReplayError::Missing { place: *read + 1 });
    }
    *read += 1;
    Ok(Some(message))
}
