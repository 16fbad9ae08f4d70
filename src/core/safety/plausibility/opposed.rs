//! Checks the sign of the force at the start of each touch: the touched object resists.
//!
//! From the moment that a free tip detects a force, the work of the force along the tip's path is compared with the
//! work that it would do if it always pointed along the motion. A force that drives the tip into the touched object has
//! the wrong sign or the wrong frame. Only the first touch is judged, because later another arm or a breathing patient
//! may drive the tip. And only a touch that the tip makes is judged: an object that moves against a resting tip does
//! not resist it. A hand that holds still trembles by a tenth of a millimetre, and the direction of that tremor
//! relative to a force is random.

use nalgebra::Vector3;

/// Time for which the tip must have been free before a touch is judged, s. Design choice, tested on the healthy minutes
/// of `docs/results/faults.md`.
const FREE_S: f64 = 0.05;
/// Work that suffices for a judgement, as the travel under the smallest force, m. Design choice, with no false alarm in
/// 136 healthy minutes (`docs/results/faults.md`).
const ENOUGH_AT_MIN_M: f64 = 1e-3;
/// Travel that suffices for a judgement, m.
const ENOUGH_M: f64 = 0.3e-3;
/// Fraction of the full work above which the force points along the motion. Design choice, with no false alarm in 136
/// healthy minutes (`docs/results/faults.md`).
const ALONG: f64 = 0.7;
/// A touch that cannot be judged within this time is not judged at all, s. Design choice, with no false alarm in 136
/// healthy minutes (`docs/results/faults.md`).
const WITHIN_S: f64 = 0.3;
/// Time constant against noise, s.
/// Two periods at 1 kHz: removes the noise of single samples, and stays far below the duration of a touch.
const SMOOTHING_S: f64 = 0.002;
/// The touch was caused by the tip if it travelled this far before, m, within about this time, s: faster than 5 mm/s. A
/// tremor of 0.15 mm per axis moves back and forth by half of that.
const MADE_M: f64 = 0.5e-3;
const BEFORE_S: f64 = 0.1;

#[derive(Clone, Copy, Debug, Default)]
pub struct TouchMemory {
    /// Recent displacement of the tip, m.
    went_m: Vector3<f64>,
    force_n: Vector3<f64>,
    free_s: f64,
    touch: Option<OpposedTouch>,
}

#[derive(Clone, Copy, Debug, Default)]
struct OpposedTouch {
    seconds: f64,
    travel_m: f64,
    work_j: f64,
    max_j: f64,
}

impl TouchMemory {
    /// Adds the force (N) and the displacement of the tip (m) since the last check `dt_s` ago; a force below `min_n`
    /// counts as zero; `led` says that the tip is commanded. Returns whether the force drives the tip into the object.
    pub fn look(&mut self, dt_s: f64, force_n: &Vector3<f64>, min_n: f64, travel_m: &Vector3<f64>, led: bool) -> bool {
        // Depends on the elapsed time and not on the number of ticks, so that a late tick smooths as much as several.
        self.force_n += (force_n - self.force_n) * -libm::expm1(-dt_s / SMOOTHING_S);
        self.went_m = self.went_m * libm::exp(-dt_s / BEFORE_S) + travel_m;
        let felt_n = self.force_n.norm();
        if felt_n < min_n || !led {
            self.free_s = if led { self.free_s + dt_s } else { 0.0 };
            // A touch that ends before it is judged leaves nothing: the next one needs its own free time.
            self.touch = None;
            return false;
        }
        // A force that appears while the tip rests is caused by the object (it moves or is moved), and may point
        // anywhere.
        if self.free_s >= FREE_S && self.went_m.norm() >= MADE_M {
            self.touch = Some(OpposedTouch::default());
        }
        // A touch that is not judged does not become one later.
        self.free_s = 0.0;
        let Some(touch) = &mut self.touch else { return false };
        touch.seconds += dt_s;
        touch.travel_m += travel_m.norm();
        // A passive object pushes against the travel, so its work on the tip is negative.
        touch.work_j += self.force_n.dot(travel_m);
        touch.max_j += felt_n * travel_m.norm();
        let OpposedTouch { seconds, travel_m, work_j, max_j } = *touch;
        // Both are required, because a strong force reaches the work within the noise of the position.
        if max_j > min_n * ENOUGH_AT_MIN_M && travel_m > ENOUGH_M {
            // Judged once per touch, so that a later part of a long contact (sliding, springing back) is not
            // compared.
            self.touch = None;
            return work_j > ALONG * max_j;
        }
        if seconds > WITHIN_S {
            self.touch = None;
        }
        false
    }
}
