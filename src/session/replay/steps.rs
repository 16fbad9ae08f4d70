//! The journal of a session, step by step.

use std::{iter::Peekable, vec};

use nima_machine::{runtime::Operation, teleop::Calibrations};

use super::ReplayError;
use crate::journal::{Block, End, Message, Noted, Row, Start, decode, number};

/// One step of a journal.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "nearly every step is a tick, and is used at once")]
pub enum Step {
    /// Something is done to the loop.
    Operation(Operation),
    /// Calibrations that come into force later.
    Calibrations {
        /// The number by which an operation names them.
        number: u64,
        /// The calibrations.
        calibrations: Calibrations,
    },
    /// The loop is stepped.
    Tick(Row),
    /// Entries are missing here.
    Hole {
        /// How many.
        lost: u64,
    },
    /// The recording was closed.
    End(End),
}

/// A journal whose beginning has been read: its steps.
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
    rows: vec::IntoIter<Row>,
    noted: Peekable<vec::IntoIter<(usize, Noted)>>,
    passed: usize,
}

impl<I: Iterator<Item = Result<Vec<u8>, ReplayError>>> Journal<I> {
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

    /// What the loop was made of.
    pub const fn start(&self) -> &Start {
        &self.start
    }

    /// Messages that were read, if all their steps were taken: a place from which [`go_on`] can read.
    pub const fn between_blocks(&self) -> Option<u64> {
        if self.open.is_none() { Some(self.read) } else { None }
    }
}

/// Messages of a journal from anywhere.
pub type Messages<'a> = Box<dyn Iterator<Item = Result<Vec<u8>, ReplayError>> + 'a>;

/// The steps of a journal with this beginning behind its first `read` messages; `messages` may begin with some of those.
pub(super) fn go_on<'a>(
    messages: impl Iterator<Item = Result<Vec<u8>, ReplayError>> + 'a,
    start: Start,
    read: u64,
) -> Journal<Messages<'a>> {
    let is_read = move |bytes: &Result<Vec<u8>, ReplayError>| {
        bytes.as_ref().is_ok_and(|bytes| number(bytes).is_ok_and(|number| number < read))
    };
    Journal { messages: Box::new(messages.skip_while(is_read)), read, start, open: None }
}

impl<I: Iterator<Item = Result<Vec<u8>, ReplayError>>> Iterator for Journal<I> {
    type Item = Result<Step, ReplayError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(open) = &mut self.open {
                let step = open.next();
                if open.is_read() {
                    self.open = None;
                }
                if let Some(step) = step {
                    return Some(Ok(step));
                }
            }
            return Some(Ok(match next_message(&mut self.messages, &mut self.read).transpose()? {
                Err(error) => return Some(Err(error)),
                Ok(Message::Start(_)) => return Some(Err(ReplayError::NoStart)),
                Ok(Message::Calibrations { number, calibrations }) => Step::Calibrations { number, calibrations },
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
        Self { rows: rows.into_iter(), noted: noted.into_iter().peekable(), passed: 0 }
    }

    fn is_read(&self) -> bool {
        self.rows.len() == 0 && self.noted.len() == 0
    }

    fn next(&mut self) -> Option<Step> {
        let (passed, last) = (self.passed, self.rows.len() == 0);
        if let Some((_, noted)) = self.noted.next_if(|(before, _)| last || *before <= passed) {
            return Some(step_of(noted));
        }
        self.passed += 1;
        self.rows.next().map(Step::Tick)
    }
}

const fn step_of(noted: Noted) -> Step {
    match noted {
        Noted::Operation(operation) => Step::Operation(operation),
        Noted::Hole { lost } => Step::Hole { lost },
    }
}

fn next_message(
    messages: &mut impl Iterator<Item = Result<Vec<u8>, ReplayError>>,
    read: &mut u64,
) -> Result<Option<Message>, ReplayError> {
    let Some(bytes) = messages.next().transpose()? else { return Ok(None) };
    let place = *read + 1;
    let (number, message) = decode(&bytes).map_err(|source| ReplayError::Message { place, source })?;
    if number != *read {
        return Err(ReplayError::Missing { place });
    }
    *read += 1;
    Ok(Some(message))
}
