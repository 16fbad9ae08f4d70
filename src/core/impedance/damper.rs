//! The least damping that takes from the hand what a model rendered from the hand's own motion gives it.

use super::regressors::Stance;
use crate::signal::{Lanes, settled};

/// Memory of the power and of what damping takes (s).
const MEMORY_S: f64 = 5.0;
/// That much more is taken than was given: the means follow late.
const MARGIN: f64 = 1.25;

/// A fixed model with passive signs gives the hand nothing, but its parameters change while it is pressed, and its force is held for a
/// tick while the hand goes on. What that gives in the mean of some seconds is measured by the leader itself, from its own force
/// and motion; viscous damping takes as much. Where the model takes more than it gives there is no damping.
///
/// The slow form of the time-domain passivity control of Hannaford and Ryu (2002), which damps at once whenever its sum is positive:
/// here what a spring returns is not mistaken for power, and the force is damped by little over the whole motion.
#[derive(Clone, Debug)]
pub(super) struct Damper {
    rate_hz: f64,
    /// Position (m) and undamped force (N) of the tick before.
    last: Option<(Lanes, Lanes)>,
    seen: f64,
    given_w: f64,
    /// Power that one newton per metre of [`velocity`] takes (W).
    taken_w: f64,
    force2_n2: f64,
}

impl Damper {
    pub(super) const fn new(rate_hz: f64) -> Self {
        Self { rate_hz, last: None, seen: 0.0, given_w: 0.0, taken_w: 0.0, force2_n2: 0.0 }
    }

    /// Takes this tick's motion and undamped force (N); returns the damping to take off (N), never larger than the usual force.
    pub(super) fn step(&mut self, now: &Stance, force_n: Lanes) -> Lanes {
        let Some((then_m, then_n)) = self.last.replace((now.x, force_n)) else { return Lanes::ZERO };
        let velocity_m_s = (now.x - then_m) * self.rate_hz;
        self.seen += 1.0;
        let share = 1.0 / self.seen.min(MEMORY_S * self.rate_hz);
        let follow = |mean: &mut f64, value: f64| *mean = settled(*mean + (value - *mean) * share);
        follow(&mut self.given_w, dot(then_n, velocity_m_s));
        follow(&mut self.taken_w, dot(velocity(now), velocity_m_s));
        follow(&mut self.force2_n2, dot(then_n, then_n));
        if self.given_w <= 0.0 || self.taken_w <= 0.0 {
            return Lanes::ZERO;
        }
        let damping_n = velocity(now) * (MARGIN * self.given_w / self.taken_w);
        let [size_n, usual_n] = [damping_n.norm(), self.force2_n2.sqrt()];
        if size_n > usual_n { damping_n * (usual_n / size_n) } else { damping_n }
    }

    /// Motion from before is forgotten; what was learnt stays.
    pub(super) const fn interrupt(&mut self) {
        self.last = None;
    }

    pub(super) const fn reset(&mut self) {
        *self = Self::new(self.rate_hz);
    }
}

/// In proportion to the velocity: the position above its 20 ms low-pass (m), hardly shaken by the steps of an encoder.
const fn velocity(now: &Stance) -> Lanes {
    now.u[1]
}

fn dot(a: Lanes, b: Lanes) -> f64 {
    (a * b).0.iter().sum()
}
