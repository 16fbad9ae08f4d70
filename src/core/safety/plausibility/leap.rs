//! A vector that changes faster than it can: single leaps are bridged, lasting and frequent ones told.

use nalgebra::SVector;

use super::Fall;

/// Samples in a row that are bridged; the next one is a jump.
const BRIDGED: u32 = 2;
/// So many bridged samples, less one for each [`CALM`] good ones, are no spikes any more.
const FREQUENT: f64 = 4.0;
/// Good samples that make up for a bridged one.
const CALM: f64 = 25.0;

/// The last vector that was believed.
#[derive(Clone, Copy, Debug)]
pub struct Leap<const D: usize = 3> {
    last: Option<SVector<f64, D>>,
    moved: SVector<f64, D>,
    in_a_row: u32,
    level: f64,
}

impl<const D: usize> Default for Leap<D> {
    fn default() -> Self {
        Self { last: None, moved: SVector::zeros(), in_a_row: 0, level: 0.0 }
    }
}

impl<const D: usize> Leap<D> {
    /// Gives the vector, or the last believed one in its place when it lies farther than `most` from it; and whether this is no spike
    /// but a jump, or one spike too many. What has jumped is believed from then on. Where it is made of the same reading as before
    /// (not `is_new`), what lies too far is bridged, but is no further spike.
    pub fn admit(&mut self, now: &SVector<f64, D>, most: f64, is_new: bool) -> (SVector<f64, D>, bool) {
        self.admit_unless(now, most, is_new, |_, _, _| Fall::No)
    }

    /// The same with an excuse: what `falls` (from the believed vector, the new one, and whether that is far) is bridged until its end, which is
    /// no jump.
    pub fn admit_unless(
        &mut self,
        now: &SVector<f64, D>,
        most: f64,
        is_new: bool,
        falls: impl FnOnce(&SVector<f64, D>, &SVector<f64, D>, bool) -> Fall,
    ) -> (SVector<f64, D>, bool) {
        let last = self.last.unwrap_or(*now);
        let far = (now - last).norm() > most;
        if !is_new {
            return self.between(now, &last, far);
        }
        let fall = falls(&last, now, far);
        self.level = match (far, fall) {
            (false, _) => (self.level - 1.0 / CALM).max(0.0),
            (true, Fall::No) => self.level + 1.0,
            (true, Fall::Going | Fall::Over) => self.level,
        };
        let frequent = self.level >= FREQUENT;
        if far && (self.in_a_row < BRIDGED || fall == Fall::Going) {
            self.in_a_row += 1;
            self.moved = SVector::zeros();
            return (last, frequent);
        }
        self.moved = now - last;
        self.last = Some(*now);
        self.in_a_row = 0;
        (*now, (far && fall != Fall::Over) || frequent)
    }

    /// Between two readings the vector changes only by what else it is made of.
    fn between(&mut self, now: &SVector<f64, D>, last: &SVector<f64, D>, far: bool) -> (SVector<f64, D>, bool) {
        let believed = if far || self.in_a_row > 0 { last } else { now };
        self.moved = believed - last;
        self.last = Some(*believed);
        (*believed, self.level >= FREQUENT)
    }

    /// How far the believed vector went in the last step.
    pub const fn moved(&self) -> &SVector<f64, D> {
        &self.moved
    }
}
