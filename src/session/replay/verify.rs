//! Compares a session with its replay at full speed.

use std::{mem::take, ops::Range};

use super::{
    Differs, Journal, JournalGap, JournalPart, NumberedMessage, ReplayError, ReplayMachine, ReplayOutcome, ReplayStep,
    is_from, side_by_side::is_compared,
};
use crate::journal::TickRow;

/// Ticks that are stepped at once, about 25 MB of measurements: enough that copies of the loop do not matter.
const RUN_TICKS: usize = 16_000;

/// Replays a journal and compares the ticks within a range (loop time, s) with the recorded ones, up to its first gap
/// or the first tick that differs. Ticks before the range are replayed without comparison, because each tick depends on
/// all earlier ones; ticks after it are not read. `passed` is called with the number of ticks so far.
///
/// # Errors
/// [`ReplayError`] if the journal cannot be read.
pub fn verify<I: Iterator<Item = Result<NumberedMessage, ReplayError>>>(
    mut journal: Journal<I>,
    stretch_s: &Range<f64>,
    passed: impl FnMut(u64),
) -> Result<ReplayOutcome, ReplayError> {
    let machine = ReplayMachine::new(&journal.start().origin)?;
    let rows = Vec::new();
    let outcome = ReplayOutcome::default();
    let mut verifier = Verifier { machine, stretch_s, passed, rows, outcome, is_over: false };
    while let Some(part) = journal.next_part() {
        match part {
            Ok(JournalPart::Ticks(rows)) => verifier.add(rows)?,
            other => {
                // In order, so that a difference before an unreadable message is reported first.
                verifier.run()?;
                if !verifier.is_over {
                    verifier.step(other?)?;
                }
            }
        }
        if verifier.is_over {
            break;
        }
    }
    verifier.run()?;
    Ok(verifier.outcome)
}

struct Verifier<'a, F> {
    machine: ReplayMachine,
    stretch_s: &'a Range<f64>,
    passed: F,
    /// Ticks without an operation between them.
    rows: Vec<Vec<TickRow>>,
    outcome: ReplayOutcome,
    is_over: bool,
}

impl<F: FnMut(u64)> Verifier<'_, F> {
    fn add(&mut self, mut rows: Vec<TickRow>) -> Result<(), ReplayError> {
        if let Some(end) = rows.iter().position(|row| is_from(row.timing.now_s, self.stretch_s.end)) {
            rows.truncate(end);
            self.is_over = true;
        }
        self.rows.push(rows);
        if self.rows.iter().map(Vec::len).sum::<usize>() >= RUN_TICKS { self.run() } else { Ok(()) }
    }

    fn run(&mut self) -> Result<(), ReplayError> {
        let rows = take(&mut self.rows);
        let from_s = self.stretch_s.start;
        let Some(last) = rows.iter().flatten().last() else { return Ok(()) };
        let ran = self.machine.run(&rows, from_s)?;
        let ReplayOutcome { ticks, before, seconds, differs, .. } = &mut self.outcome;
        let begin = *before + *ticks;
        *before += rows.iter().flatten().filter(|row| !is_compared(row, from_s)).count() as u64;
        *seconds = last.timing.now_s;
        for (number, row, check) in ran.checks(&rows, from_s) {
            if check != row.check {
                let tick = begin + number as u64;
                let t_s = row.timing.now_s;
                *differs = Some(Differs { tick, t_s, place: check.differs(&row.check) });
                *seconds = t_s;
                self.is_over = true;
                return Ok(());
            }
            *ticks += 1;
        }
        (self.passed)(*before + *ticks);
        Ok(())
    }

    fn step(&mut self, part: JournalPart) -> Result<(), ReplayError> {
        let tick = self.outcome.before + self.outcome.ticks;
        match part {
            JournalPart::Ticks(_) | JournalPart::Between(ReplayStep::Tick) => {}
            JournalPart::Between(ReplayStep::Operation(operation)) => self.machine.apply(operation, tick)?,
            JournalPart::Between(ReplayStep::Calibrations { number, calibrations }) => {
                self.machine.know(number, *calibrations);
            }
            JournalPart::Between(ReplayStep::End(_)) => self.outcome.closed = true,
            JournalPart::Between(ReplayStep::Hole { lost }) => {
                self.outcome.hole = Some(JournalGap { tick, lost });
                self.is_over = true;
            }
        }
        Ok(())
    }
}
