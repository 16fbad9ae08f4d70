//! Hands of every kind that hold the handle: light and heavy, with loose and stiff grips that change, calm and
//! trembling, up to 350 mm/s.

use crate::noise::Noise;

use super::bench::Person;

/// Uniform, and uniform in the logarithm, between two values.
fn between(noise: &mut Noise, [low, high]: [f64; 2]) -> f64 {
    low + (high - low) * noise.uniform()
}

pub(super) fn spread(noise: &mut Noise, range: [f64; 2]) -> f64 {
    between(noise, range.map(f64::ln)).exp()
}

pub(super) fn person(noise: &mut Noise) -> Person {
    let mass_kg = spread(noise, [0.04, 0.6]) + Person::STANDARD.handle_kg;
    let grip_n_m = spread(noise, [150.0, 2500.0]);
    let zeta = between(noise, [0.25, 1.2]);
    Person {
        mass_kg,
        grip_n_m,
        grip_n_s_m: 2.0 * zeta * (grip_n_m * mass_kg).sqrt(),
        tremor_m: spread(noise, [1e-5, 3e-4]),
        ..Person::STANDARD
    }
}

/// Where the hand means to be in each tick (m): reaches of minimum jerk at random speeds, pauses, palpation. It aims deeper where its
/// grip is softer, as one who wants to press does.
pub(super) fn way(noise: &mut Noise, ticks: usize, grip_n_m: f64) -> Vec<f64> {
    let mut travel_m = Vec::with_capacity(ticks);
    let mut position_m = 0.005;
    while travel_m.len() < ticks {
        let kind = noise.uniform();
        if kind < 0.7 {
            let to_m = if noise.uniform() < 0.6 {
                -between(noise, [0.002, 0.014]) - between(noise, [0.0, 4.0]) / grip_n_m
            } else {
                between(noise, [-0.006, 0.015])
            };
            let fastest_m_s = spread(noise, [0.01, 0.35]);
            let seconds = (1.875 * (to_m - position_m).abs() / fastest_m_s).max(0.04);
            let count = (1e3 * seconds) as usize + 1;
            travel_m
                .extend((0..count).map(|tick| position_m + (to_m - position_m) * reach(tick as f64 / (1e3 * seconds))));
            position_m = to_m;
        } else if kind < 0.85 {
            let count = (1e3 * between(noise, [0.05, 1.5])) as usize;
            travel_m.extend(std::iter::repeat_n(position_m, count));
        } else {
            let count = (1e3 * between(noise, [0.5, 2.0])) as usize;
            let hz = spread(noise, [0.5, 5.0]);
            let size_m = between(noise, [0.5e-3, 6e-3]);
            travel_m.extend((0..count).map(|tick| {
                let ends = (tick as f64 / 200.0).min((count - tick) as f64 / 200.0).min(1.0);
                position_m + size_m * ends * (std::f64::consts::TAU * hz * tick as f64 * 1e-3).sin()
            }));
        }
    }
    travel_m.truncate(ticks);
    travel_m
}

pub(super) fn reach(fraction: f64) -> f64 {
    let s = fraction.clamp(0.0, 1.0);
    s.powi(3) * (10.0 + s * (-15.0 + 6.0 * s))
}

/// Returns a factor on the grip's stiffness in each tick: now tighter, now looser, each change within 30 to 300 ms.
pub(super) fn grip(noise: &mut Noise, ticks: usize) -> Vec<f64> {
    let mut grip = Vec::with_capacity(ticks);
    let mut now = 1.0;
    while grip.len() < ticks {
        let count = (1e3 * between(noise, [0.3, 1.5])) as usize;
        let to = between(noise, [0.25, 1.5]);
        let within = 1e3 * between(noise, [0.03, 0.3]);
        grip.extend((0..count).map(|tick| now + (to - now) * (tick as f64 / within).min(1.0)));
        now = to;
    }
    grip.truncate(ticks);
    grip
}
