//! The loop of a session at one of its ticks, which moves on tick by tick.

use nima_machine::{
    messages::{Event, Tick},
    rig::{Outputs, SIDES, Side},
    runtime::Operation,
};

use super::{Differs, Hole, Journal, Machine, Numbered, ReplayError, Step, steps::go_on};
use crate::{
    digest::Check,
    journal::{Row, Start},
};

/// A loop that moves through a journal.
#[derive(Debug)]
pub struct Cursor<I> {
    journal: Journal<I>,
    machine: Machine,
    /// Calibrations that came into force since the last tick.
    in_force: Vec<(Side, u64)>,
    /// The last tick takes kilobytes, and stays where it is: to move it about takes as long as a part of the loop.
    came: Box<Came>,
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

    /// A cursor here, in a journal with this beginning; `messages` are those behind the [`Self::read`] ones.
    pub fn cursor<I>(self, start: Start, messages: I) -> Cursor<I> {
        let Self { machine, read, ticks, t_s } = self;
        Cursor {
            journal: go_on(messages, start, read),
            machine,
            in_force: Vec::new(),
            came: Box::default(),
            ticks,
            t_s,
        }
    }

    /// Messages of the journal before it.
    pub const fn read(&self) -> u64 {
        self.read
    }

    /// Loop time of its last tick, s.
    pub const fn t_s(&self) -> f64 {
        self.t_s
    }
}

/// What a cursor comes to.
#[derive(Debug)]
pub enum Passed<'a> {
    /// A tick.
    Tick(Moment<'a>),
    /// Entries are missing: what comes after them cannot be replayed.
    Hole(Hole),
    /// The recording was closed.
    Closed,
}

/// What comes out of a tick.
#[derive(Debug)]
struct Came {
    in_force: Vec<(Side, u64)>,
    events: Vec<Event>,
    outputs: [Outputs; SIDES],
    ticks: [Option<Tick>; SIDES],
}

impl Default for Came {
    fn default() -> Self {
        Self { in_force: Vec::new(), events: Vec::new(), outputs: [Outputs::SAFE; SIDES], ticks: [None; SIDES] }
    }
}

/// One tick of a session.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Its number in the journal, from 0.
    pub number: u64,
    /// What the loop was given.
    pub row: &'a Row,
    /// Calibrations that came into force before it: the side, and their number in the journal.
    pub in_force: &'a [(Side, u64)],
    /// What it told.
    pub events: &'a [Event],
    /// Its commands.
    pub outputs: &'a [Outputs; SIDES],
    /// What it shows.
    pub ticks: &'a [Option<Tick>; SIDES],
}

impl Moment<'_> {
    /// Where it is not as it was recorded.
    pub fn differs(&self) -> Option<Differs> {
        let Self { number, row, events, outputs, ticks, in_force: _ } = self;
        let check = Check::of(events.iter(), outputs, ticks);
        (check != row.check).then(|| Differs { tick: *number, t_s: row.timing.now_s, place: check.differs(&row.check) })
    }
}

impl<I: Iterator<Item = Result<Numbered, ReplayError>>> Cursor<I> {
    /// At the beginning of a journal.
    ///
    /// # Errors
    /// [`ReplayError::Settings`] if the settings of the identification are invalid.
    pub fn new(journal: Journal<I>) -> Result<Self, ReplayError> {
        let machine = Machine::new(&journal.start().origin)?;
        Ok(Self { journal, machine, in_force: Vec::new(), came: Box::default(), ticks: 0, t_s: 0.0 })
    }

    /// Whether a block of the journal has just been passed.
    pub fn is_between_blocks(&self) -> bool {
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
    pub fn step(&mut self) -> Result<Option<Passed<'_>>, ReplayError> {
        let Self { journal, machine, in_force, came, ticks, t_s } = self;
        for step in journal.by_ref() {
            match step? {
                Step::Operation(operation) => {
                    if let Operation::Calibrations { side, number } = operation {
                        in_force.push((side, number));
                    }
                    machine.apply(operation, *ticks)?;
                }
                Step::Calibrations { number, calibrations } => machine.know(number, *calibrations),
                Step::Hole { lost } => return Ok(Some(Passed::Hole(Hole { tick: *ticks, lost }))),
                Step::End(_) => return Ok(Some(Passed::Closed)),
                Step::Tick => break,
            }
        }
        let Some(row) = journal.row() else { return Ok(None) };
        let Came { in_force: came_in_force, events, outputs, ticks: shown } = &mut **came;
        (*outputs, *shown) = machine.step(row);
        machine.take_events(events);
        came_in_force.clear();
        came_in_force.append(in_force);
        let number = *ticks;
        *ticks += 1;
        *t_s = row.timing.now_s;
        let in_force = &*came_in_force;
        let ticks = &*shown;
        Ok(Some(Passed::Tick(Moment { number, row, in_force, events, outputs, ticks })))
    }
}
