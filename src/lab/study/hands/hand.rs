//! One hand on one handle, integrated in steps of 20 us.

use nalgebra::SVector;
use nima_core::noise::Noise;

use super::person_parameters::{GRIPPER_N_M, PersonMotion, PersonParameters};

/// Step of the integration, s.
pub(super) const STEP_S: f64 = 2e-5;
/// Tremor: amplitude, m, and angular frequency, 1/s.
const TREMOR_M: f64 = 50e-6;
const TREMOR_PER_S: f64 = std::f64::consts::TAU * 9.0;
/// Below this speed, Coulomb friction holds as far as it can, m/s.
const STICKS_M_S: f64 = 1e-4;
/// Steps that are kept: 0.41 s.
const PAST: usize = 20_480;

/// Intended position of the hand.
#[derive(Clone, Copy, Debug)]
pub(super) enum Intention<const D: usize> {
    /// Motions to random targets.
    Reaches(PersonMotion<D>),
    /// A steady motion from the start on, m/s.
    Drifts(SVector<f64, D>),
}

/// A hand with its handle.
#[derive(Clone, Debug)]
pub(super) struct StudyHand<const D: usize> {
    pub(super) person: PersonParameters<D>,
    intention: Intention<D>,
    gripper: Option<PersonMotion<D>>,
    pub(super) position_m: SVector<f64, D>,
    pub(super) velocity_m_s: SVector<f64, D>,
    /// Force that is applied to the handle, N.
    pub(super) force_n: SVector<f64, D>,
    /// Force that the hand carries intentionally, N, in addition to the force of its grip.
    pub(super) carried_n: SVector<f64, D>,
    /// Fraction of the hand that still holds the handle.
    pub(super) holds: f64,
    /// Tremor as sine and cosine, turned by a fixed angle in each step.
    tremor: [f64; 2],
    turn: [f64; 2],
    past_m: Vec<SVector<f64, D>>,
    steps: usize,
}

impl<const D: usize> StudyHand<D> {
    /// Creates a hand at rest at the start position of its person.
    pub(super) fn new(person: PersonParameters<D>, intention: Intention<D>, gripper: bool) -> Self {
        let position_m = person.start_m();
        let pair = |(sin, cos): (f64, f64)| [sin, cos];
        Self {
            person,
            intention,
            gripper: gripper.then(PersonParameters::grips),
            position_m,
            velocity_m_s: SVector::zeros(),
            force_n: SVector::zeros(),
            carried_n: SVector::zeros(),
            holds: 1.0,
            tremor: pair(person.tremor_phase.sin_cos()),
            turn: pair((TREMOR_PER_S * STEP_S).sin_cos()),
            past_m: vec![position_m; PAST],
            steps: 0,
        }
    }

    /// Returns the time of the last step, s.
    pub(super) fn now_s(&self) -> f64 {
        self.steps as f64 * STEP_S
    }

    /// Returns the position this time ago (s, up to 0.4), m.
    pub(super) fn before_m(&self, ago_s: f64) -> SVector<f64, D> {
        let ago = (ago_s / STEP_S).round() as usize;
        self.past_m[(self.steps + PAST - ago) % PAST]
    }

    /// Advances everything by [`STEP_S`].
    pub(super) fn step(&mut self, noise: &mut Noise) {
        self.steps += 1;
        let (mut aim_m, mut aim_m_s) = self.aim(noise);
        let [sin, cos] = self.tremor;
        let [turn_sin, turn_cos] = self.turn;
        self.tremor = [sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin];
        aim_m += self.person.tremor_axis * (TREMOR_M * self.tremor[0]);
        aim_m_s += self.person.tremor_axis * (TREMOR_M * TREMOR_PER_S * self.tremor[1]);
        let mut hand_n = -self.carried_n;
        if let Some(gripper) = &mut self.gripper {
            let (moved_m, moved_m_s) = gripper.at(self.steps as f64 * STEP_S, noise);
            aim_m += moved_m;
            aim_m_s += moved_m_s;
            hand_n -= moved_m * GRIPPER_N_M;
        }
        let PersonParameters { handle_kg, hand_kg, damping_n_s_m, coulomb_n, grip_n_m, grip_n_s_m, .. } = self.person;
        hand_n += (aim_m - self.position_m) * grip_n_m + (aim_m_s - self.velocity_m_s) * grip_n_s_m;
        let drive_n = self.force_n + hand_n * self.holds - self.velocity_m_s * damping_n_s_m;
        let speed_m_s = self.velocity_m_s.norm();
        let rubbed_n = if speed_m_s > STICKS_M_S {
            self.velocity_m_s * (coulomb_n / speed_m_s)
        } else {
            within(drive_n, coulomb_n)
        };
        self.velocity_m_s += (drive_n - rubbed_n) * (STEP_S / (handle_kg + self.holds * hand_kg));
        self.position_m += self.velocity_m_s * STEP_S;
        self.past_m[self.steps % PAST] = self.position_m;
    }

    fn aim(&mut self, noise: &mut Noise) -> (SVector<f64, D>, SVector<f64, D>) {
        let t_s = self.now_s();
        match &mut self.intention {
            Intention::Reaches(motion) => motion.at(t_s, noise),
            Intention::Drifts(m_s) => (self.person.start_m() + *m_s * t_s, *m_s),
        }
    }
}

/// Returns the vector, shortened to this length.
pub(super) fn within<const D: usize>(vector: SVector<f64, D>, max: f64) -> SVector<f64, D> {
    let norm = vector.norm();
    if norm > max { vector * (max / norm) } else { vector }
}
