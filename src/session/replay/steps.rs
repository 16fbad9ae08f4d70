//! The journal of a session, step by step.

use std::{iter::Peekable, mem::take, vec};

use nima_machine::{runtime::Operation, teleop::Calibrations};

use super::ReplayError;
use crate::journal::{Block, End, Message, Noted, Row, Start, decode, number};

/// One step of a journal.
#[derive(Debug)]
pub enum Step {
    /// An operation on the loop.
    Operation(Operation),
    /// Calibrations that become active later.
    Calibrations {
        /// The number by which an operation names them.
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
    End(End),
}

/// A part of a journal.
#[derive(Debug)]
pub enum Part {
    /// Ticks without an operation between them.
    Ticks(Vec<Row>),
    /// A step between ticks.
    Between(Step),
}

/// The steps of a journal whose beginning has been read.
#[derive(Debug)]
pub struct Journal<I> {
    messages: I,
    read: u64,
    start: Start,
    open: Option<Open>,
}

/// A block that is being read.
#[derive(Debug)]
struct Open {
    rows: Vec<Row>,
    noted: Peekable<vec::IntoIter<(usize, Noted)>>,
    /// Rows that were read.
    passed: usize,
}

/// A message of a journal, and its number.
pub type Numbered = (u64, Message);

/// Messages of a journal from any source.
pub type Messages = Box<dyn Iterator<Item = Result<Numbered, ReplayError>> + Send>;

impl<I: Iterator<Item = Result<Numbered, ReplayError>>> Journal<I> {
    /// Reads the beginning.
    ///
    /// # Errors
    /// [`ReplayError`] if there is none.
    pub fn open(mut messages: I) -> Result<Self, ReplayError> {
        let mut read = 0;
        match next_message(&mut messages, &mut read)? {
            Some(Message::Start(start)) => Ok(Self { messages, read, start, open: None }),
            Some(_) => Err(ReplayError::NoStart),
            None => Err(ReplayError::NoJournal),
        }
    }

    /// Returns the next step, or all ticks before it at once.
    pub fn next_part(&mut self) -> Option<Result<Part, ReplayError>> {
        Some(match self.next()? {
            Ok(Step::Tick) => Ok(Part::Ticks(self.open.as_mut().map(Open::run).unwrap_or_default())),
            step => step.map(Part::Between),
        })
    }

    /// Origin of the loop.
    pub const fn start(&self) -> &Start {
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
    pub fn row(&self) -> Option<&Row> {
        let open = self.open.as_ref()?;
        open.rows.get(open.passed.checked_sub(1)?)
    }
}

/// Decodes the messages of these bytes after the first `read` of the journal. The bytes may begin with some of those,
/// and duplicates are skipped: if a recording continued in another location, both files may have them.
pub fn decoded(
    bytes: impl Iterator<Item = Result<Vec<u8>, ReplayError>>,
    read: u64,
) -> impl Iterator<Item = Result<Numbered, ReplayError>> {
    let mut next = read;
    bytes.filter_map(move |bytes| {
        let decoded = bytes.and_then(|bytes| match number(&bytes) {
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
pub(super) const fn go_on<I>(messages: I, start: Start, read: u64) -> Journal<I> {
    Journal { messages, read, start, open: None }
}

impl<I: Iterator<Item = Result<Numbered, ReplayError>>> Iterator for Journal<I> {
    type Item = Result<Step, ReplayError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(step) = self.open.as_mut().and_then(Open::next) {
                return Some(Ok(step));
            }
            self.open = None;
            return Some(Ok(match next_message(&mut self.messages, &mut self.read).transpose()? {
                Err(error) => return Some(Err(error)),
                Ok(Message::Start(_)) => return Some(Err(ReplayError::NoStart)),
                Ok(Message::Calibrations { number, calibrations }) => {
                    Step::Calibrations { number, calibrations: Box::new(calibrations) }
                }
                Ok(Message::End(end)) => Step::End(end),
                Ok(Message::Block(block)) => {
                    self.open = Some(Open::of(block));
                    continue;
                }
            }));
        }
    }
}

impl Open {
    fn of(block: Block) -> Self {
        let Block { rows, noted, .. } = block;
        Self { rows, noted: noted.into_iter().peekable(), passed: 0 }
    }

    fn is_read(&self) -> bool {
        self.passed == self.rows.len() && self.noted.len() == 0
    }

    fn next(&mut self) -> Option<Step> {
        let passed = self.passed;
        let last = self.passed == self.rows.len();
        if let Some((_, noted)) = self.noted.next_if(|(before, _)| last || *before <= passed) {
            return Some(step_of(noted));
        }
        if last {
            return None;
        }
        self.passed += 1;
        Some(Step::Tick)
    }

    /// Returns the tick that [`Open::next`] reached and those up to the next operation.
    fn run(&mut self) -> Vec<Row> {
        let first = self.passed.saturating_sub(1);
        let last = self.rows.len();
        let end = self.noted.peek().map_or(last, |(before, _)| (*before).clamp(self.passed, last));
        if (first, end) == (0, last) {
            self.passed = 0;
            return take(&mut self.rows);
        }
        self.passed = end;
        self.rows[first..end].to_vec()
    }
}

const fn step_of(noted: Noted) -> Step {
    match noted {
        Noted::Operation(operation) => Step::Operation(operation),
        Noted::Hole { lost } => Step::Hole { lost },
    }
}

fn next_message(
    messages: &mut impl Iterator<Item = Result<Numbered, ReplayError>>,
    read: &mut u64,
) -> Result<Option<Message>, ReplayError> {
    let Some((number, message)) = messages.next().transpose()? else { return Ok(None) };
    if number != *read {
        return Err(ReplayError::Missing { place: *read + 1 });
    }
    *read += 1;
    Ok(Some(message))
}
