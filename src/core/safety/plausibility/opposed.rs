//! The sign of the force, at each first touch: whatever is touched resists.
//!
//! From the moment that a free tip begins to feel something, the work of the force along the tip's way is compared with what it would
//! be were the force along the motion all the time. A force that drives the tip into what it touches has the wrong sign, or the
//! wrong frame. Only the first touch is judged: later another arm or a breathing patient may drive the tip. And only one that the tip makes:
//! what comes to a tip that stands does not resist it. A hand that holds still trembles by a tenth of a millimetre, and whether that goes
//! with a force or against it is chance.

use nalgebra::Vector3;

/// The tip must have been free for so long before a touch is judged, s.
const FREE_S: f64 = 0.05;
/// Work that is enough for a judgement: that of the least force over this way, m.
const ENOUGH_AT_LEAST_M: f64 = 1e-3;
/// Way that is enough, m.
const ENOUGH_M: f64 = 0.3e-3;
/// Share of that work which the force must give to be along the motion.
const ALONG: f64 = 0.7;
/// A touch that is not judged by then will not be, s.
const WITHIN_S: f64 = 0.3;
/// Time constant against noise, s.
const SMOOTHING_S: f64 = 0.002;
/// The tip made a touch if it went so far before, m, in about this time, s: faster than 5 mm/s. Tremor of 0.15 mm an axis goes to and fro by
/// half of that.
const MADE_M: f64 = 0.5e-3;
const BEFORE_S: f64 = 0.1;

/// The memory of one touch.
#[derive(Clone, Copy, Debug, Default)]
pub struct Opposed {
    /// How far the tip went lately, from where to where, m.
    went_m: Vector3<f64>,
    force_n: Vector3<f64>,
    free_s: f64,
    touch: Option<Touch>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Touch {
    seconds: f64,
    way_m: f64,
    work_j: f64,
    most_j: f64,
}

impl Opposed {
    /// Takes the force (N) and the way of the tip (m) since the last look `dt_s` ago; `least_n`: a force below it is none; `led`: the tip
    /// is commanded. Says whether a touch drives the tip into what it touches.
    pub fn look(&mut self, dt_s: f64, force_n: &Vector3<f64>, least_n: f64, way_m: &Vector3<f64>, led: bool) -> bool {
        self.force_n += (force_n - self.force_n) * -libm::expm1(-dt_s / SMOOTHING_S);
        self.went_m = self.went_m * libm::exp(-dt_s / BEFORE_S) + way_m;
        let felt_n = self.force_n.norm();
        if felt_n < least_n || !led {
            self.free_s = if led { self.free_s + dt_s } else { 0.0 };
            self.touch = None;
            return false;
        }
        if self.free_s >= FREE_S && self.went_m.norm() >= MADE_M {
            self.touch = Some(Touch::default());
        }
        self.free_s = 0.0;
        let Some(touch) = &mut self.touch else { return false };
        touch.seconds += dt_s;
        touch.way_m += way_m.norm();
        touch.work_j += self.force_n.dot(way_m);
        touch.most_j += felt_n * way_m.norm();
        let Touch { seconds, way_m, work_j, most_j } = *touch;
        if most_j > least_n * ENOUGH_AT_LEAST_M && way_m > ENOUGH_M {
            self.touch = None;
            return work_j > ALONG * most_j;
        }
        if seconds > WITHIN_S {
            self.touch = None;
        }
        false
    }
}
