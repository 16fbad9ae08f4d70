//! The journal of a session, step by step.

use std::ops::ControlFlow;

use nima_machine::{runtime::Operation, teleop::Calibrations};

use super::ReplayError;
use crate::journal::{Block, End, Message, Noted, Row, Start, decode};

/// One step of a journal.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "one at a time")]
pub enum Step<'a> {
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
    Tick(&'a Row),
    /// Entries are missing here.
    Hole {
        /// How many.
        lost: u64,
    },
    /// The recording was closed.
    End(End),
}

/// A journal whose beginning has been read.
#[derive(Debug)]
pub struct Journal<I> {
    messages: I,
    read: u64,
    start: Start,
}

impl<I: Iterator<Item = Result<Vec<u8>, ReplayError>>> Journal<I> {
    /// Reads the beginning.
    ///
    /// # Errors
    /// [`ReplayError`] if there is none.
    pub fn open(mut messages: I) -> Result<Self, ReplayError> {
        let mut read = 0;
        match next_message(&mut messages, &mut read)? {
            Some(Message::Start(start)) => Ok(Self { messages, read, start }),
            Some(_) => Err(ReplayError::NoStart),
            None => Err(ReplayError::NoJournal),
        }
    }

    /// What the loop was made of.
    pub const fn start(&self) -> &Start {
        &self.start
    }

    /// Calls `each` with every step, until it breaks or the journal ends.
    ///
    /// # Errors
    /// [`ReplayError`] if a message cannot be read, or what `each` returns.
    pub fn each_step(
        &mut self,
        mut each: impl FnMut(Step<'_>) -> Result<ControlFlow<()>, ReplayError>,
    ) -> Result<(), ReplayError> {
        while let Some(message) = next_message(&mut self.messages, &mut self.read)? {
            let flow = match message {
                Message::Start(_) => return Err(ReplayError::NoStart),
                Message::Calibrations { number, calibrations } => each(Step::Calibrations { number, calibrations })?,
                Message::Block(block) => each_of_block(&block, &mut each)?,
                Message::End(end) => each(Step::End(end))?,
            };
            if flow.is_break() {
                break;
            }
        }
        Ok(())
    }
}

fn each_of_block(
    block: &Block,
    each: &mut impl FnMut(Step<'_>) -> Result<ControlFlow<()>, ReplayError>,
) -> Result<ControlFlow<()>, ReplayError> {
    let mut noted = block.noted.iter().peekable();
    for (i, row) in block.rows.iter().enumerate() {
        while let Some((_, noted)) = noted.next_if(|(before, _)| *before <= i) {
            if each(step_of(noted))?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        if each(Step::Tick(row))?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
    }
    for (_, noted) in noted {
        if each(step_of(noted))?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
    }
    Ok(ControlFlow::Continue(()))
}

const fn step_of(noted: &Noted) -> Step<'static> {
    match *noted {
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
