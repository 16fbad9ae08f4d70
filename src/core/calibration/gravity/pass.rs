//! Verifies a calibration by moving the tool freely afterwards.

use super::Compensator;
use crate::frames::WristSample;

/// Bin width of the force histogram, N: below the noise of a good sensor (0.01 to 0.05 N), so that it does not blur the
/// result.
const BIN_N: f64 = 0.01;
// Up to 5 N; larger forces count in the last bin.
const BINS: usize = 500;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassResult {
    pub samples: u64,
    /// Mean magnitude of the gravity-free force, N; near zero if nothing is touched.
    pub mean_n: f64,
    /// 95th percentile of the magnitude, N (resolution 0.01 N; 5 N stands for anything larger).
    pub p95_n: f64,
    /// Largest angle of the direction of gravity from the initial one, rad.
    pub tilt_rad: f64,
    /// Whether the error is small enough, over enough tilt.
    pub passed: bool,
    pub reason: &'static str,
}

/// Verification with the tool moved freely through the air. Steps allocate nothing.
#[derive(Clone, Debug)]
pub struct CheckPass {
    compensator: Compensator,
    limit_n: f64,
    first: Option<nalgebra::Vector3<f64>>,
    tilt_rad: f64,
    sum_n: f64,
    samples: u64,
    bins: Box<[u64; BINS]>,
}

impl CheckPass {
    /// Creates a verification in which the 95th percentile must stay below `limit_n` (N).
    pub fn new(compensator: Compensator, limit_n: f64) -> Self {
        Self { compensator, limit_n, first: None, tilt_rad: 0.0, sum_n: 0.0, samples: 0, bins: Box::new([0; BINS]) }
    }

    /// Adds a sample; returns the magnitude of its gravity-free force, N.
    pub fn step(&mut self, sample: &WristSample) -> Option<f64> {
        let force_n = self.compensator.step(sample)?.force_n.norm();
        let field = self.compensator.model().field_m_s2(sample)?;
        let first = *self.first.get_or_insert(field);
        self.tilt_rad = self.tilt_rad.max(first.angle(&field));
        self.sum_n += force_n;
        self.samples += 1;
        self.bins[((force_n / BIN_N) as usize).min(BINS - 1)] += 1;
        Some(force_n)
    }

    /// Returns the result so far; passing needs one second of samples and 45 degrees of tilt.
    pub fn result(&self) -> PassResult {
        // The 95th percentile, so that a single touch does not decide.
        let wanted = (self.samples as f64 * 0.95).ceil() as u64;
        let mut seen = 0;
        let below = |count: &u64| {
            seen += count;
            seen >= wanted
        };
        let p95_n = self.bins.iter().position(below).map_or(0.0, |bin| (bin + 1) as f64 * BIN_N);
        // A thousand samples are one second at 1 kHz.
        let reason = if self.samples < 1000 {
            "too few samples yet; keep moving"
        } else if self.tilt_rad < 45_f64.to_radians() {
            "tilt the tool by at least 45 degrees"
        } else if p95_n > self.limit_n {
            "force remains in free motion; repeat the calibration and touch nothing"
        } else {
            "free motion reads near zero"
        };
        let passed = self.samples >= 1000 && self.tilt_rad >= 45_f64.to_radians() && p95_n <= self.limit_n;
        let mean_n = if self.samples > 0 { self.sum_n / self.samples as f64 } else { 0.0 };
        PassResult { samples: self.samples, mean_n, p95_n, tilt_rad: self.tilt_rad, passed, reason }
    }
}
