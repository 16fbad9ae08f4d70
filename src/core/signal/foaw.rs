//! First-order adaptive windowing (Janabi-Sharifi, Hayward, Chen 2000).

use super::{DelayLine, LANES, Lanes, Motion};

/// Slope of the longest straight line that passes within a noise band of all its samples, per axis.
///
/// Velocity is computed from positions, acceleration from those velocities in the same way. Windows are short in fast
/// motion and long at rest, so a step of one encoder count at standstill gives no velocity spike.
#[derive(Clone, Debug)]
pub(super) struct Foaw {
    position: AdaptiveSlope,
    velocity: AdaptiveSlope,
}

impl Foaw {
    /// Creates windows of up to `n` samples at `rate_hz`; `band_m` is the half width of the position noise.
    pub(super) fn new(n: usize, rate_hz: f64, band_m: f64) -> Self {
        // Fewer than three samples leave no sample between the two ends to test.
        let n = n.max(3);
        // The slope uncertainty of a line over the full window with noise `band_m` is the noise band of the second
        // stage.
        let velocity_band = 4.0 * band_m * rate_hz / n as f64;
        Self {
            position: AdaptiveSlope::new(n, rate_hz, band_m),
            velocity: AdaptiveSlope::new(n, rate_hz, velocity_band),
        }
    }

    /// Adds the newest position, which is returned unchanged.
    pub(super) fn step(&mut self, position: Lanes) -> Motion {
        let v = self.position.step(position);
        let a = self.velocity.step(v);
        Motion { x: position, v, a }
    }

    pub(super) fn settled(&self) -> bool {
        self.velocity.samples.len() > self.velocity.samples.max_delay()
    }

    pub(super) fn reset(&mut self) {
        self.position.samples.clear();
        self.velocity.samples.clear();
    }
}

#[derive(Clone, Debug)]
struct AdaptiveSlope {
    samples: DelayLine<Lanes>,
    rate_hz: f64,
    band: f64,
}

impl AdaptiveSlope {
    fn new(n: usize, rate_hz: f64, band: f64) -> Self {
        // One slot less than the window, because a delay line also stores the newest value.
        Self { samples: DelayLine::new(n - 1, Lanes::ZERO), rate_hz, band }
    }

    fn step(&mut self, value: Lanes) -> Lanes {
        self.samples.push(value);
        let mut slope = Lanes::ZERO;
        for lane in 0..LANES {
            slope[lane] = self.lane_slope(lane);
        }
        slope
    }

    /// Returns the least-squares slope of the longest window whose end-to-end line keeps every sample within the band.
    fn lane_slope(&self, lane: usize) -> f64 {
        let at = |k: usize| self.samples.get(k).map_or(0.0, |sample| sample[lane]);
        let newest = at(0);
        let mut slope_per_tick = 0.0;
        let mut sum = 0.0;
        let mut weighted = 0.0;
        for length in 1..self.samples.len() {
            let oldest = at(length);
            let line = (newest - oldest) / length as f64;
            // A line through the two ends that leaves the band shows that the motion is not straight over this
            // window.
            let fits = (1..length).all(|k| (newest - line * k as f64 - at(k)).abs() <= self.band);
            if !fits {
                break;
            }
            sum += oldest - newest;
            weighted += (oldest - newest) * length as f64;
            let n = (length + 1) as f64;
            // Slope over k = 0..length against age. Age increases backwards in time, hence the sign.
            let mean_age = (n - 1.0) / 2.0;
            // The least-squares slope of equally spaced samples; `n (n^2 - 1) / 12` is the sum of their squared
            // distances from the mean.
            slope_per_tick = -(weighted - mean_age * sum) / (n * (n * n - 1.0) / 12.0);
        }
        slope_per_tick * self.rate_hz
    }
}
