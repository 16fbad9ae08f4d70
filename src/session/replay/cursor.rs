//! The loop of a session at one of its ticks, which advances tick by tick.

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

/// A loop that advances through a journal.
#[derive(Debug)]
pub struct Cursor<I> {
    journal: Journal<I>,
    machine: Machine,
    /// Calibrations that became active since the last tick.
    in_force: Vec<(Side, u64)>,
    /// Boxed, because the last tick has kilobytes, and moving it would take as long as a stage of the loop.
    came: Box<Came>,
    ticks: u64,
    t_s: f64,
}

/// State of a loop between two blocks of its journal. A cursor can continue from it.
#[derive(Clone, Debug)]
pub struct Keyframe {
    machine: Machine,
    /// Number of journal messages that were read.
    read: u64,
    ticks: u64,
    t_s: f64,
}

impl Keyframe {
    /// The state before the first tick of a journal with this beginning.
    ///
    /// # Errors
    /// [`ReplayError::Settings`] if the settings of the identification are invalid.
    pub fn first(start: &Start) -> Result<Self, ReplayError> {
        Ok(Self { machine: Machine::new(&start.origin)?, read: 1, ticks: 0, t_s: 0.0 })
    }

    /// Makes a cursor here, in a journal with this beginning; `messages` are those after the first [`Self::read`] ones.
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

    /// Number of journal messages before it.
    pub const fn read(&self) -> u64 {
        self.read
    }

    /// Loop time of its last tick, s.
    pub const fn t_s(&self) -> f64 {
        self.t_s
    }
}

/// One step of a cursor.
#[derive(Debug)]
pub enum Passed<'a> {
    Tick(Moment<'a>),
    /// Entries are missing: everything after them cannot be replayed.
    Hole(Hole),
    /// The recording was closed.
    Closed,
}

/// Outputs of a tick.
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
    /// The inputs of the loop.
    pub row: &'a Row,
    /// Calibrations that became active before it: the side, and their number in the journal.
    pub in_force: &'a [(Side, u64)],
    /// The events reported in it.
    pub events: &'a [Event],
    /// The commands of the loop.
    pub outputs: &'a [Outputs; SIDES],
    /// The displayed state.
    pub ticks: &'a [Option<Tick>; SIDES],
}

impl Moment<'_> {
    /// Returns where it differs from the recording, if it does.
    pub fn differs(&self) -> Option<Differs> {
        let Self { number, row, events, outputs, ticks, in_force: _ } = self;
        let check = Check::of(events.iter(), outputs, ticks);
        (check != row.check).then(|| Differs { tick: *number, t_s: row.timing.now_s, place: check.differs(&row.check) })
    }
}

impl<I: Iterator<Item = Result<Numbered, ReplayError>>> Cursor<I> {
    /// Starts at the beginning of a journal.
    ///
    /// # Errors
    /// [`ReplayError::Settings`] if the settings of the identification are invalid.
    pub fn new(journal: Journal<I>) -> Result<Self, ReplayError> {
        let machine = Machine::new(&journal.start().origin)?;
        Ok(Self { journal, machine, in_force: Vec::new(), came: Box::default(), ticks: 0, t_s: 0.0 })
    }

    /// Whether a block of the journal has just been completed.
    pub fn is_between_blocks(&self) -> bool {
        self.journal.between_blocks().is_some()
    }

    /// Returns the current loop, if a block of the journal has just been completed.
    pub fn keyframe(&self) -> Option<Keyframe> {
        let read = self.journal.between_blocks()?;
        Some(Keyframe { machine: self.machine.clone(), read, ticks: self.ticks, t_s: self.t_s })
    }

    /// Advances; `None` at the end of the journal.
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
