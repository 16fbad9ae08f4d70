//! What a person makes of the force in the hand: gives way to more than was intended, and goes on more slowly.
//!
//! With force feedback people press less: without it the mean force of a blunt dissection was at least 1.5 times, the peak at least twice as large
//! (Wagner, Stylopoulos, Jackson and Howe 2007, Presence 16:252-262). The model is the plainest that does so: the person means to use a force, feels
//! a reaction time late and with an error how much more it is, and moves the hand back and slows down in proportion to that. Whoever feels
//! nothing goes where the eyes lead, at the same pace all the time. Takes the force of the handle (N, workspace frame); gives a pace and an
//! offset (m). It is no model of a surgeon: two of its constants are from the literature, the rest is ours.

use nalgebra::Vector3;
use nima_core::noise::Noise;

/// From a force on the hand to the movement that answers it, s: 119 ms (Chernikoff and Taylor 1952, J. Exp. Psychol. 43:1-8).
const REACTION_S: f64 = 0.12;
/// A force is judged with an error of this share: the least difference that is felt is 7 % (Pang, Tan and Durlach 1991, Percept. Psychophys.
/// 49:531-540).
const JUDGED: f64 = 0.07;
/// How fast the hand gives way to each newton above what was intended, m/s.
const YIELDS_M_S: f64 = 0.006;
/// It gives way by no more than this, m.
const YIELDS_MOST_M: f64 = 0.02;
/// Below this share of what was intended the contact is over, and the hand goes back to its aim with this time constant, s.
const OVER: f64 = 0.5;
const RETURNS_S: f64 = 0.3;
/// At twice the intended force the person is slowest, by this factor.
const SLOWEST: f64 = 0.3;
/// Steps in which the reaction time is counted, s, and their number.
const STEP_S: f64 = 1e-3;
const STEPS: usize = (REACTION_S / STEP_S) as usize;
/// Keeps the errors of judgement apart from the other lots of the seed.
const LOT: u64 = 0xfee1;

/// A person who feels.
#[derive(Clone, Debug)]
pub(super) struct Feeling {
    intended_n: f64,
    /// What was felt, in steps, and the place of the oldest.
    felt_n: Vec<Vector3<f64>>,
    oldest: usize,
    since_s: f64,
    /// What the force is multiplied by where it is judged, in this movement.
    judged: f64,
    lot: Noise,
    offset_m: Vector3<f64>,
    pace: f64,
}

impl Feeling {
    /// A person who means to use this force, N.
    pub(super) fn new(intended_n: f64, seed: u64) -> Self {
        Self {
            intended_n,
            felt_n: vec![Vector3::zeros(); STEPS],
            oldest: 0,
            since_s: 0.0,
            judged: 1.0,
            lot: Noise::new(seed ^ LOT),
            offset_m: Vector3::zeros(),
            pace: 1.0,
        }
    }

    /// A new movement begins, with a judgement of its own.
    pub(super) fn judge_anew(&mut self) {
        self.judged = (1.0 + JUDGED * self.lot.gaussian()).max(0.5);
    }

    /// The hand is led, or waits: it takes up its task without an offset.
    pub(super) fn rest(&mut self) {
        self.offset_m = Vector3::zeros();
        self.pace = 1.0;
    }

    /// Feels this force of the handle (N) for `dt_s`, at most a step; gives the pace of the task.
    pub(super) fn feel(&mut self, force_n: &Vector3<f64>, dt_s: f64) -> f64 {
        self.since_s += dt_s;
        if self.since_s > 0.5 * STEP_S {
            self.since_s -= STEP_S;
            self.felt_n[self.oldest] = *force_n;
            self.oldest = (self.oldest + 1) % STEPS;
        }
        let felt_n = self.felt_n[self.oldest] * self.judged;
        let size_n = felt_n.norm();
        let more_n = size_n - self.intended_n;
        if more_n > 0.0 {
            let offset_m = self.offset_m + felt_n * (YIELDS_M_S * more_n / size_n * dt_s);
            self.offset_m = offset_m * (YIELDS_MOST_M / offset_m.norm().max(YIELDS_MOST_M));
        } else if size_n < OVER * self.intended_n {
            self.offset_m *= 1.0 - (dt_s / RETURNS_S).min(1.0);
        }
        self.pace = (1.0 - more_n / self.intended_n).clamp(SLOWEST, 1.0);
        self.pace
    }

    /// How far the hand has given way, m.
    pub(super) const fn offset_m(&self) -> Vector3<f64> {
        self.offset_m
    }

    /// How fast the task goes on, 1 where nothing slows it.
    pub(super) const fn pace(&self) -> f64 {
        self.pace
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn felt(feeling: &mut Feeling, force_n: f64, seconds: f64) {
        (0..(seconds * 1e3) as u32).for_each(|_| {
            feeling.feel(&(Vector3::z() * force_n), 1e-3);
        });
    }

    #[test]
    fn no_more_than_intended_changes_nothing() {
        let mut feeling = Feeling::new(1.0, 3);
        felt(&mut feeling, 0.99, 2.0);
        assert_eq!((feeling.pace(), feeling.offset_m()), (1.0, Vector3::zeros()));
    }

    #[test]
    fn twice_the_intended_force_slows_and_moves_the_hand_back_after_the_reaction_time() {
        let mut feeling = Feeling::new(1.0, 3);
        felt(&mut feeling, 2.0, 0.119);
        assert_eq!((feeling.pace(), feeling.offset_m()), (1.0, Vector3::zeros()), "not yet");
        felt(&mut feeling, 2.0, 1.001);
        assert!((feeling.pace() - SLOWEST).abs() < 1e-12);
        assert!((feeling.offset_m().z - YIELDS_M_S).abs() < 1e-4, "1 N more for 1 s: {}", feeling.offset_m());
        felt(&mut feeling, 2.0, 60.0);
        assert!((feeling.offset_m().z - YIELDS_MOST_M).abs() < 1e-9);
        felt(&mut feeling, 0.0, 0.12 + 5.0 * RETURNS_S);
        assert!(feeling.pace() > 0.999 && feeling.offset_m().z < 0.01 * YIELDS_MOST_M, "{}", feeling.offset_m());
    }

    #[test]
    fn other_rates_react_in_the_same_time() {
        for dt_s in [2.5e-4, 1e-3] {
            let mut feeling = Feeling::new(1.0, 3);
            let mut t_s = 0.0;
            while feeling.offset_m() == Vector3::zeros() {
                feeling.feel(&(Vector3::x() * 3.0), dt_s);
                t_s += dt_s;
            }
            assert!((t_s - REACTION_S).abs() < 2.5e-3, "{t_s} s in steps of {dt_s} s");
        }
    }

    #[test]
    fn each_movement_judges_with_an_error_of_seven_percent() {
        let mut feeling = Feeling::new(1.0, 3);
        let errors: Vec<f64> = (0..2000)
            .map(|_| {
                feeling.judge_anew();
                feeling.judged - 1.0
            })
            .collect();
        let mean = errors.iter().sum::<f64>() / 2000.0;
        let deviation = (errors.iter().map(|error| (error - mean) * (error - mean)).sum::<f64>() / 2000.0).sqrt();
        assert!(mean.abs() < 0.006 && (deviation - JUDGED).abs() < 0.004, "{mean} {deviation}");
    }
}
