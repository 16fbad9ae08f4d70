//! The loop of a session at one of its ticks, which advances tick by tick.

use nima_machine::{
    messages::{Event, Tick},
    rig::{Outputs, SIDES, Side},
    runtime::Operation,
};

use super::{Differs, Journal, JournalGap, NumberedMessage, ReplayError, ReplayMachine, ReplayStep, steps::go_on};
use crate::{
    digest::DigestCheck,
    journal::{JournalStart, TickRow},
};

/// A loop that advances through a journal.
#[derive(Debug)]
pub struct ReplayCursor<I> {
    journal: Journal<I>,
    machine: ReplayMachine,
    /// Calibrations that became active since the last tick.
    active: Vec<(Side, u64)>,
    /// Boxed, because the last tick has kilobytes, and moving it would take as long as a stage of the loop.
    came: Box<TickOutput>,
    ticks: u64,
    t_s: f64,
}

/// State of a loop between two blocks of its journal. A cursor can continue from it.
#[derive(Clone, Debug)]
pub struct Keyframe {
    machine: ReplayMachine,
    /// Number of journal messages that were read.
    read: u64,
    ticks: u64,
    t_s: f64,
}

impl Keyframe {
    /// Returns the state before the first tick of a journal with this beginning.
    ///
    /// # Errors
    /// [`ReplayError::Settings`] if the settings of the identification are invalid.
    pub fn first(start: &JournalStart) -> Result<Self, ReplayError> {
        Ok(Self { machine: ReplayMachine::new(&start.origin)?, read: 1, ticks: 0, t_s: 0.0 })
    }

    /// Creates a cursor here, in a journal with this beginning; `messages` are those after the first [`Self::read`]
    /// ones.
    pub fn cursor<I>(self, start: JournalStart, messages: I) -> ReplayCursor<I> {
        let Self { machine, read, ticks, t_s } = self;
        ReplayCursor {
            journal: go_on(messages, start, read),
            machine,
            active: Vec::new(),
            came: Box::default(),
            ticks,
            t_s,
        }
    }

    /// Returns the number of journal messages before it.
    pub const fn read(&self) -> u64 {
        self.read
    }

    /// Returns the loop time of its last tick, s.
    pub const fn t_s(&self) -> f64 {
        self.t_s
    }
}

/// One step of a cursor.
#[derive(Debug)]
pub enum CursorEvent<'a> {
    Tick(SessionMoment<'a>),
    /// Entries are missing, so everything after them cannot be replayed.
    Hole(JournalGap),
    /// The recording was closed.
    Closed,
}

/// Outputs of a tick.
#[derive(Debug)]
struct TickOutput {
    active: Vec<(Side, u64)>,
    events: Vec<Event>,
    outputs: [Outputs; SIDES],
    ticks: [Option<Tick>; SIDES],
}

impl Default for TickOutput {
    fn default() -> Self {
        Self { active: Vec::new(), events: Vec::new(), outputs: [Outputs::SAFE; SIDES], ticks: [None; SIDES] }
    }
}

/// One tick of a session.
#[derive(Clone, Copy, Debug)]
pub struct SessionMoment<'a> {
    /// Number in the journal, from 0.
    pub number: u64,
    /// The inputs of the loop.
    pub row: &'a TickRow,
    /// Calibrations that became active before it: the side, and their number in the journal.
    pub active: &'a [(Side, u64)],
    /// Events reported in the tick.
    pub events: &'a [Event],
    /// The commands of the loop.
    pub outputs: &'a [Outputs; SIDES],
    /// The displayed state.
    pub ticks: &'a [Option<Tick>; SIDES],
}

impl SessionMoment<'_> {
    /// Returns where it differs from the recording, if it does.
    pub fn differs(&self) -> Option<Differs> {
        let Self { number, row, events, outputs, ticks, active: _ } = self;
        let check = DigestCheck::of(events.iter(), outputs, ticks);
        (check != row.check).then(|| Differs { tick: *number, t_s: row.timing.now_s, place: check.differs(&row.check) })
    }
}

impl<I: Iterator<Item = Result<NumberedMessage, ReplayError>>> ReplayCursor<I> {
    /// Starts at the beginning of a journal.
    ///
    /// # Errors
    /// [`ReplayError::Settings`] if the settings of the identification are invalid.
    pub fn new(journal: Journal<I>) -> Result<Self, ReplayError> {
        let machine = ReplayMachine::new(&journal.start().origin)?;
        Ok(Self { journal, machine, active: Vec::new(), came: Box::default(), ticks: 0, t_s: 0.0 })
    }

    /// Returns whether a block of the journal has just been completed.
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
    pub fn step(&mut self) -> Result<Option<CursorEvent<'_>>, ReplayError> {
        let Self { journal, machine, active, came, ticks, t_s } = self;
        for step in journal.by_ref() {
            match step? {
                ReplayStep::Operation(operation) => {
                    if let Operation::Calibrations { side, number } = operation {
                        active.push((side, number));
                    }
                    machine.apply(operation, *ticks)?;
                }
                ReplayStep::Calibrations { number, calibrations } => machine.know(number, *calibrations),
                ReplayStep::Hole { lost } => return Ok(Some(CursorEvent::Hole(JournalGap { tick: *ticks, lost }))),
                ReplayStep::End(_) => return Ok(Some(CursorEvent::Closed)),
                ReplayStep::Tick => break,
            }
        }
        let Some(row) = journal.row() else { return Ok(None) };
        let TickOutput { active: became_active, events, outputs, ticks: shown } = &mut **came;
        (*outputs, *shown) = machine.step(row);
        machine.take_events(events);
        became_active.clear();
        became_active.append(active);
        let number = *ticks;
        *ticks += 1;
        *t_s = row.timing.now_s;
        let active = &*became_active;
        let ticks = &*shown;
        Ok(Some(CursorEvent::Tick(SessionMoment { number, row, active, events, outputs, ticks })))
    }
}
