//! Detects a vector that changes faster than possible: single jumps are bridged, lasting or frequent ones reported.

use nalgebra::SVector;

use super::Fall;

/// Number of consecutive samples that are bridged; the next one is a jump.
/// Design choice: each further sample reports a real jump one period later; fewer turn single spikes into faults.
const BRIDGED: u32 = 2;
/// This many bridged samples, minus one for each [`CALM`] good samples, are no longer treated as spikes: the fourth
/// spike in a hundred samples is a fault (`docs/results/faults.md`).
const FREQUENT: f64 = 4.0;
/// Number of good samples that compensate a bridged sample. Design choice, with no false alarm in 136 healthy minutes
/// (`docs/results/faults.md`).
const CALM: f64 = 25.0;

#[derive(Clone, Copy, Debug)]
pub struct JumpDetector<const D: usize = 3> {
    last: Option<SVector<f64, D>>,
    moved: SVector<f64, D>,
    in_a_row: u32,
    level: f64,
}

impl<const D: usize> Default for JumpDetector<D> {
    fn default() -> Self {
        Self { last: None, moved: SVector::zeros(), in_a_row: 0, level: 0.0 }
    }
}

impl<const D: usize> JumpDetector<D> {
    /// Returns the vector, or the last accepted one if the vector is farther than `max` from it; and whether this is a
    /// jump instead of a spike, or one spike too many. After a jump the new vector is accepted. If the vector was
    /// computed from the same reading as before (not `is_new`), a vector that is too far away is bridged but does not
    /// count as another spike.
    pub fn admit(&mut self, now: &SVector<f64, D>, max: f64, is_new: bool) -> (SVector<f64, D>, bool) {
        self.admit_unless(now, max, is_new, |_, _, _| Fall::No)
    }

    /// Like [`JumpDetector::admit`], with an exception: a change for which `falls` holds (given the accepted vector, the new
    /// vector and whether it is too far away) is bridged until it ends, and is not a jump.
    pub fn admit_unless(
        &mut self,
        now: &SVector<f64, D>,
        max: f64,
        is_new: bool,
        falls: impl FnOnce(&SVector<f64, D>, &SVector<f64, D>, bool) -> Fall,
    ) -> (SVector<f64, D>, bool) {
        // The first vector has nothing to be compared with.
        let last = self.last.unwrap_or(*now);
        let far = (now - last).norm() > max;
        if !is_new {
            return self.between(now, &last, far);
        }
        let fall = falls(&last, now, far);
        self.level = match (far, fall) {
            (false, _) => (self.level - 1.0 / CALM).max(0.0),
            (true, Fall::No) => self.level + 1.0,
            (true, Fall::Going | Fall::Over) => self.level,
        };
        // Bridging hides spikes from everything that follows, so a device that makes many of them must be reported.
        let frequent = self.level >= FREQUENT;
        // Bridged with the last vector instead of an extrapolation, because an extrapolation could itself be far from
        // the next vector.
        if far && (self.in_a_row < BRIDGED || fall == Fall::Going) {
            self.in_a_row += 1;
            self.moved = SVector::zeros();
            return (last, frequent);
        }
        self.moved = now - last;
        self.last = Some(*now);
        self.in_a_row = 0;
        // The new vector is believed after a jump: the device may have moved, and the fault already stops the arm.
        (*now, (far && fall != Fall::Over) || frequent)
    }

    /// Handles a vector without a new reading: only its other inputs can change it.
    fn between(&mut self, now: &SVector<f64, D>, last: &SVector<f64, D>, far: bool) -> (SVector<f64, D>, bool) {
        let believed = if far || self.in_a_row > 0 { last } else { now };
        // The reading is the same, so the difference is caused by the other inputs and does not count as travel.
        self.moved = believed - last;
        self.last = Some(*believed);
        (*believed, self.level >= FREQUENT)
    }

    /// Returns the change of the accepted vector in the last step.
    pub const fn moved(&self) -> &SVector<f64, D> {
        &self.moved
    }
}
