//! Friction across a contact: the tip drags along the surface under a load that only the other axes measure.

use super::{
    super::{messages::Posture, motion_clock::fraction},
    form::{FormRow, product},
    model::MatchedModel,
};
use crate::signal::{Lanes, settled};

/// Number of slip columns of an axis.
pub(super) const SLIPS: usize = 2;
/// Length at which each spring slips under the usual force, in usual motions (rms of the position above its 20 ms
/// low-pass). Halving or doubling it changes the error by less than 3 %, because the fit weighs the columns.
/// One spring slips within a usual motion, one beyond it: friction that builds up fast and slowly.
const GIVES_IN_USUAL_MOTIONS: [f64; SLIPS] = [0.5, 2.0];
/// Memory of the usual motion and load (s by the clock).
const USUAL_S: f64 = 20.0;

/// Values of the slip columns, one lane per axis.
pub(super) type SlipLanes = [Lanes; SLIPS];

/// Springs (m) that follow the tip and slip at a length in proportion to the force along the other axes: Maxwell slip
/// under a changing load. Without a load they hold no force, so they reset when contact ends.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SlipSprings {
    held: SlipLanes,
    last: Option<Lanes>,
}

impl SlipSprings {
    /// Adds a position, the force (N) on all axes, and the lengths per force (m/N) at which the springs slip.
    pub(super) fn step(&mut self, x: Lanes, force_n: Lanes, gives: &[f64; SLIPS]) -> &SlipLanes {
        // The first position only sets the start: there is no travel before it.
        let way = self.last.replace(x).map_or(Lanes::ZERO, |last| x - last);
        let load_n = load(force_n);
        for (held, give) in self.held.iter_mut().zip(gives) {
            let limit = load_n * *give;
            // Clamped after the travel is added: a spring at its limit slips, and turns back at once when the motion
            // reverses.
            *held = (*held + way).within(-limit, limit);
        }
        &self.held
    }
}

/// The springs at the leader, and the follower's copy of them: their load is the force computed from the parameters.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slip {
    stretch: SlipSprings,
    /// The force of the previous tick (N): the newest force depends on the springs.
    said_n: Lanes,
}

impl Slip {
    /// Advances with the newest received model. Returns the columns of this motion and the force computed with them
    /// (N).
    pub(super) fn step(&mut self, model: &MatchedModel, now: &Posture) -> (FormRow, Lanes) {
        let held = self.stretch.step(now.stance.x, self.said_n, &model.gives);
        let row = model.form.row(now, model.one, model.origin, held);
        let said_n = product(&model.parameters, &row, model.form.columns());
        // A force of zero unloads the springs, so one number that is not finite does not stay in them.
        self.said_n = if said_n.is_finite() { model.clipped(said_n) } else { Lanes::ZERO };
        (row, said_n)
    }
}

/// Usual magnitudes of motion (m) and force (N), over all axes, which make the springs independent of units.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct UsualSizes {
    motion2: f64,
    force2: f64,
    passed: f64,
}

impl UsualSizes {
    /// Adds the position above its 20 ms low-pass and the force (N); returns the lengths per force (m/N) at which the
    /// springs slip.
    pub(super) fn step(&mut self, motion: Lanes, force_n: Lanes, pace: f64, rate_hz: f64) -> [f64; SLIPS] {
        self.passed += pace;
        let fraction = fraction(pace, self.passed, USUAL_S * rate_hz);
        for (mean, size) in [(&mut self.motion2, motion.norm()), (&mut self.force2, force_n.norm())] {
            *mean = settled(*mean + (size * size - *mean) * fraction);
        }
        // Without any force so far no length is known, and a spring of length zero holds nothing.
        let give = if self.force2 > 0.0 { (self.motion2 / self.force2).sqrt() } else { 0.0 };
        GIVES_IN_USUAL_MOTIONS.map(|times| give * times)
    }
}

/// Returns the magnitude of the force along the two other axes (N).
fn load(force_n: Lanes) -> Lanes {
    let [x, y, z, _] = force_n.0;
    let next = Lanes([y, z, x, 0.0]);
    let last = Lanes([z, x, y, 0.0]);
    (next * next + last * last).sqrt()
}

/// The springs at the follower, where the force is measured.
#[derive(Clone, Debug, Default)]
pub(super) struct FollowerSlip {
    stretch: SlipSprings,
    usual: UsualSizes,
    /// Lengths per force at which the springs slip, m/N.
    pub(super) gives: [f64; SLIPS],
    /// The leader's springs, one delay ahead of their current state at the leader.
    pub(super) twin: Slip,
}

impl FollowerSlip {
    /// Loads the springs with the measured force (N).
    pub(super) fn step(&mut self, posture: &Posture, force_n: Lanes, rate_hz: f64) -> &SlipLanes {
        let stance = &posture.stance;
        self.gives = self.usual.step(stance.u[1], force_n, stance.pace, rate_hz);
        self.stretch.step(stance.x, force_n, &self.gives)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIVES: [f64; SLIPS] = [0.001, 0.01];

    fn at(x: f64) -> Lanes {
        Lanes([x, 0.0, 0.0, 0.0])
    }

    #[test]
    fn a_spring_holds_slips_under_its_load_turns_round_and_forgets_without_a_load() {
        let mut stretch = SlipSprings::default();
        // Force along x itself does not load x.
        let pressed_n = Lanes([50.0, 0.0, 2.0, 0.0]);
        let mut held_m = |x: f64, force_n: Lanes| stretch.step(at(x), force_n, &GIVES).map(|held| held[0]);
        let unpressed_n = Lanes([50.0, 0.0, 0.0, 0.0]);
        for (what, x, force_n, expected_m) in [
            ("begins where it is", 0.1, pressed_n, [0.0, 0.0]),
            ("holds", 0.101, pressed_n, [0.001, 0.001]),
            ("slips", 0.105, pressed_n, [0.002, 0.005]),
            ("turns round", 0.104, pressed_n, [0.001, 0.004]),
            ("forgets", 0.102, unpressed_n, [0.0, 0.0]),
        ] {
            for (held, expected) in held_m(x, force_n).into_iter().zip(expected_m) {
                assert!((held - expected).abs() < 1e-12, "it {what}: {held}, not {expected}");
            }
        }
    }

    #[test]
    fn gives_are_those_of_usual_motion_and_force_whatever_the_units() {
        let gives = |per_m: f64, per_n: f64| {
            let mut usual = UsualSizes::default();
            let step = |_| usual.step(at(0.002 * per_m), Lanes([0.0, 0.0, 4.0 * per_n, 0.0]), 1.0, 1000.0);
            (0..100).map(step).last().unwrap()
        };
        let expected = GIVES_IN_USUAL_MOTIONS.map(|times| times * 0.002 / 4.0);
        for (per_m, per_n) in [(1.0, 1.0), (1e3, 1.0), (1.0, 1e3)] {
            for (give, expected) in gives(per_m, per_n).into_iter().zip(expected) {
                assert!((give * per_n / per_m - expected).abs() < 1e-12, "{give} at {per_m}/m and {per_n}/N");
            }
        }
    }
}
