//! A reading that repeats itself to the last bit, number by number.

/// Numbers of a force sensor: force, torque, acceleration.
pub const CHANNELS: usize = 9;
/// A live sensor's number is another one after this time at the latest, s.
const FROZEN_S: f64 = 0.015;
/// A number that has once stood for longer than this has no noise to be missed, s.
const RESTLESS_S: f64 = 0.008;
/// So long a number must have been restless before its rest is a fault, s.
const LIVELY_S: f64 = 3.0;

/// The memory of `N` numbers. A number that is NaN is not there.
#[derive(Clone, Copy, Debug)]
pub struct Frozen<const N: usize> {
    last: [f64; N],
    since_s: [f64; N],
    /// Since when no number stood longer than [`RESTLESS_S`].
    lively_since_s: [f64; N],
    t_s: f64,
}

impl<const N: usize> Default for Frozen<N> {
    fn default() -> Self {
        Self { last: [f64::NAN; N], since_s: [0.0; N], lively_since_s: [0.0; N], t_s: f64::NEG_INFINITY }
    }
}

impl<const N: usize> Frozen<N> {
    /// Takes the numbers at this time (s); says whether one that has noise is frozen. A time that does not advance is no look.
    ///
    /// A saturated number is frozen too: at the end of its range noise is cut off.
    pub fn look(&mut self, now: &[f64; N], t_s: f64) -> bool {
        if t_s.is_nan() || t_s <= self.t_s {
            return false;
        }
        self.t_s = t_s;
        let mut frozen = false;
        for i in 0..N {
            if now[i].to_bits() != self.last[i].to_bits() || now[i].is_nan() {
                if self.last[i].is_nan() {
                    self.lively_since_s[i] = t_s;
                }
                (self.last[i], self.since_s[i]) = (now[i], t_s);
                continue;
            }
            let stood_s = t_s - self.since_s[i];
            let lively = self.since_s[i] - self.lively_since_s[i] >= LIVELY_S;
            if !lively && stood_s > RESTLESS_S {
                self.lively_since_s[i] = t_s;
            }
            frozen |= lively && stood_s > FROZEN_S;
        }
        frozen
    }
}
