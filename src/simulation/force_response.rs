//! A person's response to the force in the hand: yields to a force above the intended one, and moves more slowly.
//!
//! With force feedback people press less: without it the mean force of a blunt dissection was at least 1.5 times, the
//! peak at least twice as large (Wagner, Stylopoulos, Jackson and Howe 2007, Presence 16:252-262). This is the simplest
//! model with this effect: the person intends a force, perceives the excess with a reaction time and an error, and
//! moves the hand back and slows down in proportion to it. A person without force feedback follows the visual target at
//! constant pace. Takes the force of the handle (N, workspace frame); returns a pace and an offset (m). Not a model of
//! a surgeon: two of its constants are from the literature, the others are our choice.

use nalgebra::Vector3;
use nima_core::noise::Noise;

/// From a force on the hand to the responding movement, s: 119 ms (Chernikoff and Taylor 1952, J. Exp. Psychol.
/// 43:1-8).
const REACTION_S: f64 = 0.12;
/// Relative error in judging a force: the just noticeable difference is 7 % (Pang, Tan and Durlach 1991, Percept.
/// Psychophys. 49:531-540).
const JUDGED: f64 = 0.07;
/// Speed at which the hand yields, per newton above the intended force, m/s.
const YIELDS_M_S: f64 = 0.006;
/// Maximum distance by which the hand yields, m.
const YIELDS_MAX_M: f64 = 0.02;
/// Below this fraction of the intended force the contact is over, and the hand returns to its target with this time
/// constant, s.
const OVER: f64 = 0.5;
const RETURNS_S: f64 = 0.3;
/// At twice the intended force the person is slowest, by this factor.
const SLOWEST: f64 = 0.3;
/// Step in which the reaction time is counted, s, and number of steps.
const STEP_S: f64 = 1e-3;
const STEPS: usize = (REACTION_S / STEP_S) as usize;
/// Makes the errors of judgement independent of the other random sequences of the seed.
const LOT: u64 = 0xfee1;

/// A person with force perception.
#[derive(Clone, Debug)]
pub(super) struct ForceResponse {
    intended_n: f64,
    /// Ring buffer of the felt forces, one per step, and the index of the oldest.
    felt_n: Vec<Vector3<f64>>,
    oldest: usize,
    since_s: f64,
    /// Factor of the person's judgement of the force in this movement.
    judged: f64,
    lot: Noise,
    offset_m: Vector3<f64>,
    pace: f64,
}

impl ForceResponse {
    /// Creates a person who intends this force, N.
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

    /// Starts a new movement with its own error of judgement.
    pub(super) fn judge_anew(&mut self) {
        self.judged = (1.0 + JUDGED * self.lot.gaussian()).max(0.5);
    }

    /// Called while the hand is guided or waits, so that it resumes its task without an offset.
    pub(super) fn rest(&mut self) {
        self.offset_m = Vector3::zeros();
        self.pace = 1.0;
    }

    /// Processes this force on the handle (N) for `dt_s`, at most a step; returns the pace of the task.
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
            self.offset_m = offset_m * (YIELDS_MAX_M / offset_m.norm().max(YIELDS_MAX_M));
        } else if size_n < OVER * self.intended_n {
            self.offset_m *= 1.0 - (dt_s / RETURNS_S).min(1.0);
        }
        self.pace = (1.0 - more_n / self.intended_n).clamp(SLOWEST, 1.0);
        self.pace
    }

    /// Returns how far the hand has yielded, m.
    pub(super) const fn offset_m(&self) -> Vector3<f64> {
        self.offset_m
    }

    /// Returns the pace of the task; 1 if nothing slows it.
    pub(super) const fn pace(&self) -> f64 {
        self.pace
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn felt(feeling: &mut ForceResponse, force_n: f64, seconds: f64) {
        (0..(seconds * 1e3) as u32).for_each(|_| {
            feeling.feel(&(Vector3::z() * force_n), 1e-3);
        });
    }

    #[test]
    fn no_more_than_intended_changes_nothing() {
        let mut feeling = ForceResponse::new(1.0, 3);
        felt(&mut feeling, 0.99, 2.0);
        assert_eq!((feeling.pace(), feeling.offset_m()), (1.0, Vector3::zeros()));
    }

    #[test]
    fn twice_the_intended_force_slows_and_moves_the_hand_back_after_the_reaction_time() {
        let mut feeling = ForceResponse::new(1.0, 3);
        felt(&mut feeling, 2.0, 0.119);
        assert_eq!((feeling.pace(), feeling.offset_m()), (1.0, Vector3::zeros()), "not yet");
        felt(&mut feeling, 2.0, 1.001);
        assert!((feeling.pace() - SLOWEST).abs() < 1e-12);
        assert!((feeling.offset_m().z - YIELDS_M_S).abs() < 1e-4, "1 N more for 1 s: {}", feeling.offset_m());
        felt(&mut feeling, 2.0, 60.0);
        assert!((feeling.offset_m().z - YIELDS_MAX_M).abs() < 1e-9);
        felt(&mut feeling, 0.0, 0.12 + 5.0 * RETURNS_S);
        assert!(feeling.pace() > 0.999 && feeling.offset_m().z < 0.01 * YIELDS_MAX_M, "{}", feeling.offset_m());
    }

    #[test]
    fn other_rates_react_in_the_same_time() {
        for dt_s in [2.5e-4, 1e-3] {
            let mut feeling = ForceResponse::new(1.0, 3);
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
        let mut feeling = ForceResponse::new(1.0, 3);
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
