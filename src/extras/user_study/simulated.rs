//! Simulated people: skill, learning, fatigue and answers, reproducible with the same seed.
//!
//! They test the whole procedure from a study file to its report before the first participant arrives. They feel: what
//! is more than the force that a person means to use slows the hand down, and it gives way (`docs/simulated.md`). They
//! are not a model of surgeons: the spread of skill and intended force is made up, and their answers do not depend on the
//! condition.

use fastrand::Rng;

use crate::{PAIRS, Questionnaire, QuestionnaireAnswers, Ratings};

#[derive(Clone, Debug)]
pub struct SimulatedParticipant {
    seed: u64,
    /// Factor on an expert's pace.
    skill: f64,
    /// Relative slowness of the first trial, and number of trials in which it falls to 1/e.
    slower: f64,
    learns_in: f64,
    /// Relative slowdown per trial since the last break.
    tires: f64,
    tremor_m: f64,
    /// The intended force, N.
    intended_n: f64,
    /// Mean answers.
    load: [f64; 6],
    realism: f64,
}

/// A hand in one trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedHand {
    /// Speed of all movements, 1 as in the scene.
    pub pace: f64,
    /// Amplitude of the tremor, m.
    pub tremor_m: f64,
    /// Intended force, N: a higher force slows the hand down, and the hand yields. `None` for a hand without force
    /// perception.
    pub intended_n: Option<f64>,
    /// Seed of its random sequences.
    pub seed: u64,
}

/// Returns an approximately standard normal number: the sum of twelve uniform ones.
fn normal(rng: &mut Rng) -> f64 {
    (0..12).map(|_| rng.f64()).sum::<f64>() - 6.0
}

fn between(rng: &mut Rng, from: f64, to: f64) -> f64 {
    from + (to - from) * rng.f64()
}

impl SimulatedParticipant {
    /// Creates the participant with this number, from 0.
    pub fn new(seed: u64, number: u64) -> Self {
        let seed = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(number);
        let mut rng = Rng::with_seed(seed);
        Self {
            seed,
            skill: 1.0 + (0.10 * normal(&mut rng)).clamp(-0.25, 0.25),
            slower: between(&mut rng, 0.2, 0.6),
            learns_in: between(&mut rng, 2.0, 6.0),
            tires: between(&mut rng, 0.002, 0.010),
            tremor_m: between(&mut rng, 0.000_05, 0.000_15),
            load: std::array::from_fn(|_| between(&mut rng, 20.0, 70.0)),
            realism: between(&mut rng, 3.0, 6.0),
            intended_n: between(&mut rng, 0.8, 1.6),
        }
    }

    /// Returns the hand after this many trials, including practice, after this many since the last break, and in this
    /// attempt (from 1).
    pub fn hand(&self, made: u32, since_break: u32, attempt: u32) -> SimulatedHand {
        let learning = 1.0 + self.slower * (-f64::from(made) / self.learns_in).exp();
        let fatigue = 1.0 + self.tires * f64::from(since_break);
        SimulatedHand {
            pace: (self.skill / (learning * fatigue)).clamp(0.4, 1.3),
            tremor_m: self.tremor_m * fatigue,
            intended_n: Some(self.intended_n),
            seed: self.seed.wrapping_add(u64::from(made) * 7919 + u64::from(attempt) * 104_729),
        }
    }

    /// Returns answers after this many trials.
    pub fn answers(&self, questionnaire: Questionnaire, made: u32) -> QuestionnaireAnswers {
        let mut rng = Rng::with_seed(self.seed ^ (u64::from(made) << 32) ^ questionnaire as u64);
        let ratings = Ratings::of(self.load.map(|load| {
            let rating = (load + 10.0 * normal(&mut rng)).clamp(0.0, 100.0);
            5 * (rating / 5.0).round() as u8
        }));
        match questionnaire {
            Questionnaire::NasaTlx => QuestionnaireAnswers::NasaTlx(ratings),
            Questionnaire::NasaTlxWeighted => {
                let chosen = PAIRS.map(|(first, second)| if rng.bool() { first } else { second });
                QuestionnaireAnswers::NasaTlxWeighted { ratings, chosen }
            }
            Questionnaire::Sus => QuestionnaireAnswers::Sus(std::array::from_fn(|at| {
                let agrees = (3.5 + 0.8 * normal(&mut rng)).clamp(1.0, 5.0).round() as u8;
                if at % 2 == 0 { agrees } else { 6 - agrees }
            })),
            Questionnaire::Realism => {
                QuestionnaireAnswers::Realism((self.realism + 0.8 * normal(&mut rng)).clamp(1.0, 7.0).round() as u8)
            }
            Questionnaire::FreeText => QuestionnaireAnswers::FreeText("(simulated)".to_owned()),
        }
    }
}
