//! Replays a session with one setting changed.
//!
//! Both loops get the recorded inputs. A recording cannot show more: with another force the hand would have moved
//! differently, and so the tissue's force would have differed too. The comparison shows the force that the hand would
//! have felt at each moment if it had moved as it did.

use std::ops::Range;

use nalgebra::Vector3;
use nima_core::impedance::Mode;
use nima_machine::{
    messages::{Command, LoopState, Tick},
    rig::{SIDES, Side},
    runtime::Operation,
    teleop::LoopOrigin,
};

use super::{Journal, JournalGap, NumberedMessage, ReplayError, ReplayMachine, ReplayStep, is_from};

/// The changed settings; `None` leaves a setting as recorded. Recorded commands that would set a changed setting are
/// ignored.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WhatIfChange {
    pub mode: Option<Mode>,
    /// Delay of the link, s.
    pub delay_s: Option<f64>,
    /// The operator's gain, 0 to 1.
    pub gain: Option<f64>,
}

impl WhatIfChange {
    /// Returns whether any setting is changed.
    pub fn is_any(&self) -> bool {
        *self != Self::default()
    }

    /// Returns the origin of the changed loop.
    fn origin(&self, origin: &LoopOrigin) -> LoopOrigin {
        let mut origin = origin.clone();
        let rig = &mut origin.rig;
        rig.mode = self.mode.unwrap_or(rig.mode);
        rig.delay_s = self.delay_s.unwrap_or(rig.delay_s);
        rig.gates.gain = self.gain.unwrap_or(rig.gates.gain);
        origin
    }

    /// Returns whether the changed loop gets this command too.
    const fn lets(&self, command: Command) -> bool {
        match command {
            Command::SetMode(_) => self.mode.is_none(),
            Command::SetDelay(_) => self.delay_s.is_none(),
            Command::SetGain(_) | Command::SetGainAboveOne(_) => self.gain.is_none(),
            Command::Compare(_)
            | Command::SetDeadBand(_)
            | Command::SetStaticHold(_)
            | Command::Prompt(..)
            | Command::Guide(..)
            | Command::Grip(..)
            | Command::Task(..)
            | Command::LetGo(_)
            | Command::SetGovernor(_)
            | Command::SetScale(_)
            | Command::Engage
            | Command::EngageOne(_)
            | Command::Rest
            | Command::Stop
            | Command::ReleaseStop
            | Command::TestWatchdog(_)
            | Command::Checked(_)
            | Command::Shutdown => true,
        }
    }
}

/// Mean, mean square and maximum of vectors' lengths, N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Number of vectors.
    pub count: u64,
    pub mean_n: f64,
    /// Maximum length, N.
    pub max_n: f64,
    squares_n2: f64,
}

impl Difference {
    /// Adds a vector. A vector that is not finite is left out: the force was unknown.
    fn add(&mut self, difference_n: &Vector3<f64>) {
        let length_n = difference_n.norm();
        // An unknown force has no difference.
        if !length_n.is_finite() {
            return;
        }
        self.count += 1;
        self.mean_n += (length_n - self.mean_n) / self.count as f64;
        self.max_n = self.max_n.max(length_n);
        self.squares_n2 += (length_n * length_n - self.squares_n2) / self.count as f64;
    }

    /// Returns the root mean square, N.
    pub fn rms_n(&self) -> f64 {
        self.squares_n2.sqrt()
    }
}

/// Comparison of one side; forces over the ticks in which both loops were engaged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ComparedSide {
    /// Ticks in which both were engaged.
    pub engaged: u64,
    /// Ticks in which only one was engaged.
    pub apart: u64,
    /// Rendered force: changed minus recorded.
    pub rendered: Difference,
    /// Rendered force of the recorded session minus the force at the tip at the same instant.
    pub recorded_error: Difference,
    /// The same with the change.
    pub changed_error: Difference,
}

/// Feeds a journal to the loop that recorded it and to a changed one, both from its beginning, and compares them within
/// a range (loop time, s). `each` is called with both loops' ticks of each side. Returns the comparison of each side of
/// the rig, the number of ticks in the range, and the gap at which it ended, if there is one.
///
/// # Errors
/// [`ReplayError`] if the journal cannot be read or the changed settings are not usable.
#[expect(clippy::type_complexity, reason = "three answers")]
pub fn compare<I: Iterator<Item = Result<NumberedMessage, ReplayError>>>(
    journal: &mut Journal<I>,
    change: &WhatIfChange,
    stretch_s: &Range<f64>,
    mut each: impl FnMut(&Tick, &Tick),
) -> Result<([Option<ComparedSide>; SIDES], u64, Option<JournalGap>), ReplayError> {
    let origin = &journal.start().origin;
    let mut recorded = ReplayMachine::new(origin)?;
    let mut changed = ReplayMachine::new(&change.origin(origin))?;
    let mut sides = [None; SIDES];
    let mut ticks = 0;
    let mut before = 0;
    let mut hole = None;
    let mut events = Vec::new();
    while let Some(step) = journal.next() {
        match step? {
            ReplayStep::Operation(operation) => {
                recorded.apply(operation, before + ticks)?;
                if !matches!(operation, Operation::Command { command, .. } if !change.lets(command)) {
                    changed.apply(operation, before + ticks)?;
                }
            }
            ReplayStep::Calibrations { number, calibrations } => {
                recorded.know(number, (*calibrations).clone());
                changed.know(number, *calibrations);
            }
            ReplayStep::Hole { lost } => {
                hole = Some(JournalGap { tick: before + ticks, lost });
                break;
            }
            ReplayStep::End(_) => {}
            ReplayStep::Tick => {
                let Some(row) = journal.row() else { continue };
                let now_s = row.timing.now_s;
                if is_from(now_s, stretch_s.end) {
                    break;
                }
                let (_, as_was) = recorded.step(row);
                let (_, as_if) = changed.step(row);
                recorded.take_events(&mut events);
                changed.take_events(&mut events);
                if !is_from(now_s, stretch_s.start) {
                    before += 1;
                    continue;
                }
                ticks += 1;
                for side in Side::ALL {
                    if let (Some(was), Some(would)) = (&as_was[side.index()], &as_if[side.index()]) {
                        add(sides[side.index()].get_or_insert_default(), was, would);
                        each(was, would);
                    }
                }
            }
        }
    }
    Ok((sides, ticks, hole))
}

fn add(compared: &mut ComparedSide, was: &Tick, would: &Tick) {
    let engaged = [was, would].map(|tick| tick.state == LoopState::Engaged);
    match engaged {
        [true, true] => {
            compared.engaged += 1;
            compared.rendered.add(&(would.rendering.rendered_n - was.rendering.rendered_n));
            compared.recorded_error.add(&(was.rendering.rendered_n - was.measured_n));
            compared.changed_error.add(&(would.rendering.rendered_n - would.measured_n));
        }
        [false, false] => {}
        _ => compared.apart += 1,
    }
}
