//! The loop of a session at one of its ticks, which moves on tick by tick.

use nima_machine::{
    messages::{Event, Tick},
    rig::{Outputs, SIDES},
};

use super::{
    Differs, Hole, Journal, Machine, ReplayError, Step,
    steps::{Messages, go_on},
};
use crate::{
    digest::Check,
    journal::{Row, Start},
};

/// A loop that moves through a journal.
#[derive(Debug)]
pub struct Cursor<I> {
    journal: Journal<I>,
    machine: Machine,
    ticks: u64,
    t_s: f64,
}

/// A loop between two blocks of its journal, from which a cursor can go on.
#[derive(Clone, Debug)]
pub struct Keyframe {
    machine: Machine,
    /// Messages of the journal that were read.
    read: u64,
    ticks: u64,
    t_s: f64,
}

impl Keyframe {
    /// Before the first tick of a journal with this beginning.
    ///
    /// # Errors
    /// [`ReplayError::Settings`] if the settings of the identification are invalid.
    pub fn first(start: &Start) -> Result<Self, ReplayError> {
        Ok(Self { machine: Machine::new(&start.origin)?, read: 1, ticks: 0, t_s: 0.0 })
    }

    /// A cursor here, in a journal with this beginning; its messages may begin before it.
    pub fn cursor<'a>(
        self,
        start: Start,
        messages: impl Iterator<Item = Result<Vec<u8>, ReplayError>> + 'a,
    ) -> Cursor<Messages<'a>> {
        let Self { machine, read, ticks, t_s } = self;
        Cursor { journal: go_on(messages, start, read), machine, ticks, t_s }
    }

    /// Loop time of its last tick, s.
    pub const fn t_s(&self) -> f64 {
        self.t_s
    }
}

/// What a cursor comes to.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "one at a time")]
pub enum Passed {
    /// A tick.
    Tick(Moment),
    /// Entries are missing: what comes after them cannot be replayed.
    Hole(Hole),
    /// The recording was closed.
    Closed,
}

/// One tick of a session.
#[derive(Debug)]
pub struct Moment {
    /// Its number in the journal, from 0.
    pub number: u64,
    /// What the loop was given.
    pub row: Row,
    /// What it told.
    pub events: Vec<Event>,
    /// Its commands.
    pub outputs: [Outputs; SIDES],
    /// What it shows.
    pub ticks: [Option<Tick>; SIDES],
}

impl Moment {
    /// Where it is not as it was recorded.
    pub fn differs(&self) -> Option<Differs> {
        let Self { number, row, events, outputs, ticks } = self;
        let check = Check::of(events.iter(), outputs, ticks);
        (check != row.check).then(|| Differs { tick: *number, t_s: row.timing.now_s, place: check.differs(&row.check) })
    }
}

impl<I: Iterator<Item = Result<Vec<u8>, ReplayError>>> Cursor<I> {
    /// At the beginning of a journal.
    ///
    /// # Errors
    /// [`ReplayError::Settings`] if the settings of the identification are invalid.
    pub fn new(journal: Journal<I>) -> Result<Self, ReplayError> {
        let machine = Machine::new(&journal.start().origin)?;
        Ok(Self { journal, machine, ticks: 0, t_s: 0.0 })
    }

    /// Whether a block of the journal has just been passed.
    pub const fn is_between_blocks(&self) -> bool {
        self.journal.between_blocks().is_some()
    }

    /// The loop as it is now, if a block of the journal has just been passed.
    pub fn keyframe(&self) -> Option<Keyframe> {
        let read = self.journal.between_blocks()?;
        Some(Keyframe { machine: self.machine.clone(), read, ticks: self.ticks, t_s: self.t_s })
    }

    /// Moves on; `None` at the end of the journal.
    ///
    /// # Errors
    /// [`ReplayError`] if the journal cannot be read.
    pub fn step(&mut self) -> Result<Option<Passed>, ReplayError> {
        for step in &mut self.journal {
            match step? {
                Step::Operation(operation) => self.machine.apply(operation, self.ticks)?,
                Step::Calibrations { number, calibrations } => self.machine.know(number, calibrations),
                Step::Hole { lost } => return Ok(Some(Passed::Hole(Hole { tick: self.ticks, lost }))),
                Step::End(_) => return Ok(Some(Passed::Closed)),
                Step::Tick(row) => {
                    let (outputs, ticks) = self.machine.step(&row);
                    let events = self.machine.take_events();
                    let number = self.ticks;
                    self.ticks += 1;
                    self.t_s = row.timing.now_s;
                    return Ok(Some(Passed::Tick(Moment { number, row, events, outputs, ticks })));
                }
            }
        }
        Ok(None)
    }
}
