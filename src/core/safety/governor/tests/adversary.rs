//! Adversarial requests that try to pump energy into a released handle, based on its observed motion.

use nalgebra::Vector1;

use crate::{
    noise::Noise,
    safety::{ChainSettings, ForceRequest, SafetyChain},
};

const PERIOD_S: f64 = 1e-3;
/// Time for which a handle is left alone before handle and chain are reset to rest, s.
pub(super) const EPISODE_S: f64 = 2.0;

/// Pattern of the requests for some time.
#[derive(Clone, Copy, Debug)]
enum Pattern {
    Steady,
    AlongMotion,
    AlongMotionWithBreaks,
    AlongMotionInBursts,
    AgainstThenAlong,
    Wave,
    Noise,
    Weak,
    NotANumber,
    Nothing,
}

const PATTERNS: [Pattern; 10] = [
    Pattern::Steady,
    Pattern::AlongMotion,
    Pattern::AlongMotionWithBreaks,
    Pattern::AlongMotionInBursts,
    Pattern::AgainstThenAlong,
    Pattern::Wave,
    Pattern::Noise,
    Pattern::Weak,
    Pattern::NotANumber,
    Pattern::Nothing,
];

struct Plan {
    pattern: Pattern,
    left: u32,
    size_n: f64,
    every: u32,
}

impl Plan {
    fn new(noise: &mut Noise) -> Self {
        let mut pick = |max: f64| (max * noise.uniform()) as u32;
        let pattern = PATTERNS[pick(10.0) as usize];
        let left = 1 + pick(400.0);
        let every = 2 + pick(40.0);
        Self { pattern, left, size_n: 5.0 * noise.uniform(), every }
    }

    fn force_n(&self, tick: u32, speed_m_s: f64, noise: &mut Noise) -> Option<f64> {
        let along = if speed_m_s >= 0.0 { self.size_n } else { -self.size_n };
        let phase = tick % self.every;
        Some(match self.pattern {
            Pattern::Steady => self.size_n,
            Pattern::AlongMotion => along,
            Pattern::AlongMotionWithBreaks => {
                if phase == 0 {
                    -0.01 * along
                } else {
                    along
                }
            }
            Pattern::AlongMotionInBursts => {
                if 2 * phase < self.every {
                    along
                } else {
                    0.0
                }
            }
            Pattern::AgainstThenAlong => {
                if 3 * phase < self.every {
                    -along
                } else {
                    along
                }
            }
            Pattern::Wave => along * (std::f64::consts::TAU * f64::from(phase) / f64::from(self.every)).sin().abs(),
            Pattern::Noise => self.size_n * noise.gaussian(),
            Pattern::Weak => along.clamp(-0.28, 0.28),
            Pattern::NotANumber => f64::NAN,
            Pattern::Nothing => return None,
        })
    }
}

/// Returns the maximum energy (J) that a released handle received in one episode, over this many adversarial requests.
pub(super) fn max_given_j(requests: u64, seed: u64, settings: ChainSettings) -> f64 {
    let mut noise = Noise::new(seed);
    let mut max_j = 0.0_f64;
    for _ in 0..requests.div_ceil((EPISODE_S / PERIOD_S) as u64) {
        max_j = max_j.max(episode_j(&mut noise, settings));
    }
    max_j
}

fn episode_j(noise: &mut Noise, settings: ChainSettings) -> f64 {
    let mut chain = SafetyChain::<1>::new(settings, PERIOD_S);
    let handle_kg = 0.2 + 0.11 * noise.uniform();
    let mut position_m = 0.0;
    let mut speed_m_s = 0.0;
    let mut given_j = 0.0;
    let mut max_j = 0.0_f64;
    let mut plan = Plan::new(noise);
    for tick in 0..(EPISODE_S / PERIOD_S) as u32 {
        if plan.left == 0 {
            plan = Plan::new(noise);
        }
        plan.left -= 1;
        let request = ForceRequest {
            t_s: f64::from(tick) * PERIOD_S,
            force_n: plan.force_n(tick, speed_m_s, noise).map(Vector1::new),
            age_s: 0.0,
            speed_m_s: 1.0,
            hand_m: Some(Vector1::new((position_m / 1e-5_f64).round() * 1e-5)),
            hand_age_s: 0.0,
            permitted: true,
        };
        let held_n = chain.step(&request).0.x;
        speed_m_s += (held_n - 0.1 * speed_m_s) / handle_kg * PERIOD_S;
        position_m += speed_m_s * PERIOD_S;
        given_j += held_n * speed_m_s * PERIOD_S;
        max_j = max_j.max(given_j);
    }
    max_j
}
