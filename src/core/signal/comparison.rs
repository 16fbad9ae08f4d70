//! Noise and lag of the differentiators, measured on positions quantised to 0.01 mm at 1 kHz. Prints the table of `mod.rs`.

use std::f64::consts::TAU;

use super::{Differentiator, DifferentiatorKind, Lanes};

const RATE_HZ: f64 = 1000.0;
const COUNT_M: f64 = 1e-5;

fn quantised(x: f64) -> f64 {
    (x / COUNT_M).round() * COUNT_M
}

/// Returns pseudo-random numbers from -0.5 to 0.5.
fn jitter(k: usize) -> f64 {
    (k as f64 * 0.754_877_666_246_692_8).fract() - 0.5
}

struct ComparisonFigures {
    noise: [f64; 2],
    lag_ms: [f64; 2],
    error: [f64; 2],
}

/// Returns the root mean squares of the deviations of (v, a) from `truth`, which gives (x, v, a) at a time.
fn deviation(kind: DifferentiatorKind, truth: impl Fn(f64, usize) -> [f64; 3]) -> [f64; 2] {
    let mut differentiator = Differentiator::new(kind, RATE_HZ);
    let mut sums = [0.0; 2];
    let mut count = 0.0;
    for k in 0..12_000 {
        let [x, v, a] = truth(k as f64 / RATE_HZ, k);
        let found = differentiator.step(Lanes::splat(quantised(x)));
        if k > 1000 {
            count += 1.0;
            sums[0] += (found.v[0] - v).powi(2);
            sums[1] += (found.a[0] - a).powi(2);
        }
    }
    sums.map(|sum| (sum / count).sqrt())
}

/// Returns the lag of (v, a) of a sinusoid of `hz` (ms), from their phase.
fn lag_ms(kind: DifferentiatorKind, hz: f64) -> [f64; 2] {
    let mut differentiator = Differentiator::new(kind, RATE_HZ);
    let mut parts = [[0.0; 2]; 2];
    for k in 0..12_000_u32 {
        let phase = TAU * hz * f64::from(k) / RATE_HZ;
        let found = differentiator.step(Lanes::splat(quantised(0.01 * phase.sin())));
        if k >= 2000 {
            for (part, value) in parts.iter_mut().zip([found.v[0], found.a[0]]) {
                part[0] += value * phase.cos();
                part[1] += value * phase.sin();
            }
        }
    }
    let [v, a] = parts;
    let ms = 1e3 / (TAU * hz);
    [v[1].atan2(v[0]) * ms, a[0].atan2(-a[1]) * ms]
}

/// Returns the motion of a hand: reaches of 40 mm at 0.5 Hz with a tremor of 0.1 mm at 9 Hz.
fn hand(t: f64) -> [f64; 3] {
    let wave = |amplitude: f64, hz: f64| {
        let w = TAU * hz;
        [amplitude * (w * t).sin(), amplitude * w * (w * t).cos(), -amplitude * w * w * (w * t).sin()]
    };
    let reach = wave(0.02, 0.5);
    let tremor = wave(1e-4, 9.0);
    std::array::from_fn(|i| reach[i] + tremor[i])
}

fn figures(kind: DifferentiatorKind) -> ComparisonFigures {
    ComparisonFigures {
        noise: deviation(kind, |_, k| [COUNT_M * (0.5 + jitter(k)), 0.0, 0.0]),
        lag_ms: lag_ms(kind, 5.0),
        error: deviation(kind, |t, _| hand(t)),
    }
}

#[test]
fn figures_of_every_differentiator() {
    eprintln!(
        "{:<16} noise at rest v (mm/s), a (m/s2)   lag at 5 Hz v, a (ms)   error on a hand v (mm/s), a (m/s2)",
        ""
    );
    for kind in DifferentiatorKind::ALL {
        let ComparisonFigures { noise, lag_ms, error } = figures(kind);
        eprintln!(
            "{:<16} {:>22.2} {:>8.3} {:>18.1} {:>5.1} {:>24.2} {:>8.3}",
            kind.name(),
            1e3 * noise[0],
            noise[1],
            lag_ms[0],
            lag_ms[1],
            1e3 * error[0],
            error[1]
        );
        assert!(noise[0] < 5e-4 && noise[1] < 0.05, "{kind:?}");
        assert!(lag_ms[0].abs() < 2.0 && lag_ms[1].abs() < 12.0, "{kind:?}");
        assert!(error[0] < 2e-3 && error[1] < 0.3, "{kind:?}");
    }
}
