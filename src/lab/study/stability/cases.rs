//! Extreme motions and forces: some that may occur in operation, and some that should not.

use std::f64::consts::TAU;

/// One sample of one axis as delivered by a device, valid or not.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawSample {
    pub(super) t_s: f64,
    pub(super) position_m: f64,
    pub(super) force_n: f64,
}

#[derive(Clone, Debug)]
pub(super) struct StabilityCase {
    pub(super) group: &'static str,
    pub(super) name: String,
    pub(super) rate_hz: f64,
    /// Samples in a window (even).
    pub(super) window: usize,
    pub(super) samples: Vec<RawSample>,
}

/// Returns the number of ticks until the differentiator has settled and both the paper's `u` and the window are filled.
pub(super) fn warm(rate_hz: f64, window: usize) -> usize {
    ((0.03 * rate_hz) as usize).max(5) + 2 * window
}

/// Returns the number of ticks from the newest sample to the horizon: 50 ms, at most half a window.
pub(super) fn horizon(rate_hz: f64, window: usize) -> usize {
    ((0.05 * rate_hz).round() as usize).clamp(1, window / 2)
}

const WINDOW: usize = 300;
const RATE_HZ: f64 = 1000.0;
/// Amplitude of a hand's slow motion about the trocar (m).
const AMPLITUDE_M: f64 = 0.02;
const FORCE_NOISE_N: f64 = 0.01;

/// Soft tissue: stiffening spring, damping, a small mass, and sensor noise.
fn tissue(x: f64, v: f64, a: f64, noise: &mut fastrand::Rng) -> f64 {
    300.0 * x + 4e3 * x * x + 8.0 * v + 0.2 * a + FORCE_NOISE_N * (noise.f64() * 2.0 - 1.0)
}

/// Returns a hand's motion of the given size at `t`: position, velocity, acceleration.
fn hand(amplitude: f64, t: f64) -> [f64; 3] {
    // The frequencies have no common period: if they had one, the paper's `u` would be zero over it.
    let waves = [(0.75, 0.713, 0.3), (0.2, 2.331, 1.1), (0.05, 6.127, 2.0)];
    waves.iter().fold([0.0; 3], |[x, v, a], (fraction, hz, phase)| {
        let size = amplitude * fraction;
        let w = TAU * hz;
        let (sin, cos) = (w * t + phase).sin_cos();
        [x + size * sin, v + size * w * cos, a - size * w * w * sin]
    })
}

fn case(
    group: &'static str,
    name: impl Into<String>,
    rate_hz: f64,
    window: usize,
    motion: impl Fn(f64) -> [f64; 3],
) -> StabilityCase {
    let mut noise = fastrand::Rng::with_seed(7);
    let count = warm(rate_hz, window) + window + horizon(rate_hz, window) + 1;
    let samples = (0..count)
        .map(|k| {
            let t_s = k as f64 / rate_hz;
            let [x, v, a] = motion(t_s);
            RawSample { t_s, position_m: x, force_n: tissue(x, v, a, &mut noise) }
        })
        .collect();
    StabilityCase { group, name: name.into(), rate_hz, window, samples }
}

fn moving(group: &'static str, name: impl Into<String>, amplitude: f64, rate_hz: f64, window: usize) -> StabilityCase {
    case(group, name, rate_hz, window, |t| hand(amplitude, t))
}

/// Returns the ordinary motion with every sample modified (arguments: tick, previous sample, sample).
fn edited(name: &str, edit: impl Fn(usize, Option<RawSample>, &mut RawSample)) -> StabilityCase {
    let mut case = moving("input", name, AMPLITUDE_M, RATE_HZ, WINDOW);
    for k in 0..case.samples.len() {
        let before = k.checked_sub(1).map(|before| case.samples[before]);
        edit(k, before, &mut case.samples[k]);
    }
    case
}

fn motions() -> Vec<StabilityCase> {
    let mut across = case("motion", "standstill while another axis moves", RATE_HZ, WINDOW, |t| hand(AMPLITUDE_M, t));
    across.samples.iter_mut().for_each(|raw| raw.position_m = 0.013);
    vec![
        case("motion", "standstill", RATE_HZ, WINDOW, |_| [0.013, 0.0, 0.0]),
        case("motion", "standstill at the origin", RATE_HZ, WINDOW, |_| [0.0; 3]),
        case("motion", "constant speed 20 mm/s", RATE_HZ, WINDOW, |t| [0.02 * (t - 0.4), 0.02, 0.0]),
        across,
    ]
}

fn inputs() -> Vec<StabilityCase> {
    let every = |k: usize, period: usize| k % period == period / 2;
    vec![
        edited("position spikes of 50 mm", |k, _, raw| {
            if every(k, 97) {
                raw.position_m += 0.05;
            }
        }),
        edited("force spikes of 400 N", |k, _, raw| {
            if every(k, 97) {
                raw.force_n += 400.0;
            }
        }),
        edited("force and position saturated", |_, _, raw| {
            raw.force_n = raw.force_n.clamp(-1.0, 1.0);
            raw.position_m = raw.position_m.clamp(-0.008, 0.008);
        }),
        edited("NaN", |k, _, raw| {
            if every(k, 97) {
                raw.position_m = f64::NAN;
            } else if every(k, 101) {
                raw.force_n = f64::NAN;
            }
        }),
        edited("infinity", |k, _, raw| {
            if every(k, 97) {
                raw.position_m = f64::INFINITY;
            } else if every(k, 101) {
                raw.force_n = f64::NEG_INFINITY;
            }
        }),
        edited("late samples", |k, before, raw| {
            // For four ticks, repeat the old sample.
            if k % 97 < 4 {
                *raw = before.unwrap_or(*raw);
            }
        }),
        edited("duplicated samples", |k, before, raw| {
            if k % 2 == 1 {
                *raw = before.unwrap_or(*raw);
            }
        }),
        edited("f32 input", |_, _, raw| {
            raw.position_m = f64::from(raw.position_m as f32);
            raw.force_n = f64::from(raw.force_n as f32);
        }),
        edited("position in steps of 0.01 mm", |_, _, raw| raw.position_m = (raw.position_m * 1e5).round() * 1e-5),
    ]
}

/// Returns all cases; `quick` leaves out those that are slow in arbitrary precision (windows and rates above 1000).
pub(super) fn all(quick: bool) -> Vec<StabilityCase> {
    let mut cases = motions();
    for (name, amplitude) in [
        ("1 um", 1e-6),
        ("10 um", 1e-5),
        ("100 um", 1e-4),
        ("1 mm", 1e-3),
        ("10 mm", 1e-2),
        ("100 mm", 0.1),
        ("200 mm", 0.2),
    ] {
        cases.push(moving("amplitude", name, amplitude, RATE_HZ, WINDOW));
    }
    for (name, rate_hz, window) in
        [("20 Hz", 20.0, 10), ("66 Hz", 66.0, 20), ("200 Hz", 200.0, 60), ("1 kHz", 1000.0, 300), ("10 kHz", 1e4, 3000)]
    {
        cases.push(moving("rate", name, AMPLITUDE_M, rate_hz, window));
    }
    for window in [10, 100, 300, 1000, 10_000] {
        cases.push(moving("window", format!("{window} samples"), AMPLITUDE_M, RATE_HZ, window));
    }
    cases.extend(inputs());
    cases.retain(|case| !quick || case.window <= 300);
    cases
}
