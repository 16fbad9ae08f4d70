//! Range of recent forces; a rendered force stays close to it.

use crate::signal::Lanes;

/// Memory of the range (s), and how far a rendered force may exceed the range, as a fraction of its width. Chosen as in
/// `anchored.rs`.
/// A shorter memory would clip the first push after a pause; a longer one lets an old impact widen the range.
const MEMORY_S: f64 = 5.0;
const MARGIN: f64 = 0.1;

/// Minimum and maximum force per axis, leaking towards their middle.
#[derive(Clone, Debug)]
pub struct Envelope {
    leak: f64,
    edges_n: Option<[Lanes; 2]>,
}

impl Envelope {
    /// Creates an envelope at this rate (Hz) that has no samples yet.
    pub const fn new(rate_hz: f64) -> Self {
        Self { leak: 1.0 / (MEMORY_S * rate_hz), edges_n: None }
    }

    /// Takes a force (N); `pace`: how fast time runs, 1 by the clock on the wall.
    pub fn see(&mut self, force_n: Lanes, pace: f64) {
        let [low, high] = self.edges_n.unwrap_or([force_n; 2]);
        // Both edges leak towards their middle and not towards zero, because the range may lie far from zero (a held
        // load).
        let middle = (low + high) * 0.5;
        let leak = self.leak * pace;
        let leaked = |edge: Lanes| (edge + (middle - edge) * leak).settled();
        // A force outside the range widens it at once.
        self.edges_n = Some([leaked(low).zip(force_n, f64::min), leaked(high).zip(force_n, f64::max)]);
    }

    /// Returns the minimum and maximum force to render (N): the range with its margin; zero before any force was
    /// measured.
    pub fn bounds_n(&self) -> [Lanes; 2] {
        let [low, high] = self.edges_n.unwrap_or_default();
        let margin = (high - low) * MARGIN;
        [low - margin, high + margin]
    }

    /// Discards all stored data.
    pub fn reset(&mut self) {
        self.edges_n = None;
    }
}
