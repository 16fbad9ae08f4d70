//! Checks that the loop meets its deadlines, that its clock agrees with the computer's, and that the computer's date is
//! possible.

use super::{
    CheckSubject, FigureUnit, PersonRequest, ReadyCause, ReadyFigure,
    item::{Item, PointProgress},
};
use crate::messages::Tick;

/// Duration of the measurement, s: 2000 ticks at 1 kHz, so that the limit of one missed period in a hundred is not
/// decided by a single pause of the computer.
const TAKES_S: f64 = 2.0;
/// More than one missed period in a hundred is felt as roughness.
const MISSED_MAX: f64 = 0.01;
/// Maximum difference between the two clocks, s; ticks wait until they are read. Otherwise the queue to the screen
/// would already look like two clocks.
const APART_MAX_S: f64 = 0.25;

#[derive(Debug)]
pub(super) struct ReadyClocks {
    is_date_behind: bool,
    newest: Option<Tick>,
    /// The first tick, and the time at which it was read.
    first: Option<(Tick, f64)>,
}

impl ReadyClocks {
    pub(super) const fn of(subject: &CheckSubject) -> Self {
        Self { is_date_behind: subject.is_date_behind, newest: None, first: None }
    }
}

impl Item for ReadyClocks {
    // Ticks of the other arm have the same times.
    fn tick(&mut self, tick: &Tick) {
        // One arm is enough, because both arms use the same clock.
        if self.newest.is_none_or(|newest| newest.side == tick.side) {
            self.newest = Some(*tick);
        }
    }

    fn look(&mut self, now_s: f64) -> PointProgress {
        if self.is_date_behind {
            return PointProgress::Failed(ReadyCause::DateBehind);
        }
        let Some(newest) = self.newest else { return PointProgress::Asking(PersonRequest::Nothing) };
        let (first, first_s) = self.first.get_or_insert((newest, now_s));
        let took_s = now_s - *first_s;
        let loop_s = newest.t_s - first.t_s;
        if took_s < TAKES_S {
            return PointProgress::Asking(PersonRequest::Nothing);
        }
        let by_s = (took_s - loop_s).abs();
        if by_s.is_nan() || by_s > APART_MAX_S {
            return PointProgress::Failed(ReadyCause::LoopClock { by_s });
        }
        let missed = newest.timing.missed.saturating_sub(first.timing.missed);
        let made = newest.index.saturating_sub(first.index);
        // At least one tick, so that a loop that stands still is not divided by zero.
        let fraction = missed as f64 / (missed + made).max(1) as f64;
        if fraction > MISSED_MAX {
            return PointProgress::Failed(ReadyCause::Missed { fraction });
        }
        PointProgress::Passed(ReadyFigure {
            value: 100.0 * fraction,
            limit: 100.0 * MISSED_MAX,
            unit: FigureUnit::Percent,
        })
    }

    fn late(&self) -> ReadyCause {
        ReadyCause::NoTicks
    }

    fn patience_s(&self) -> f64 {
        8.0
    }
}
