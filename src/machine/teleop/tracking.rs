//! Estimates how far the follower lags behind its command, and from that the follower's current motion as known to the
//! leader.
//!
//! An impedance identified from the follower's motion must be rendered with the follower's motion, but the leader has
//! only its own command. The lag is the time shift between command and tip with the smallest mean square difference
//! over the last seconds of motion, refined by a parabola through the minimum. With a network between them, the tip is
//! compared with the commands of one round trip ago, so that the lag excludes the network.

use nalgebra::Vector3;
use nima_core::impedance::MAX_DELAY_S;

/// Number of time shifts compared: with [`LAG_MAX_S`], steps of 2 ms at 1 kHz. Comparing all 128 ticks would cost twice
/// as much.
const CANDIDATES: usize = 64;
/// Maximum lag that can be found, s. Twice the 60 ms that are assumed for the slowest arm (`ASTRAY_M` in the
/// plausibility check).
const LAG_MAX_S: f64 = 0.128;
/// Averaging time of the comparison, s of motion: long enough for some changes of direction, which a lag shows in.
/// Design choice.
const MEMORY_S: f64 = 2.0;
/// Speed below which the shifts cannot be distinguished, m/s, because the noise of the tip's position would decide.
/// Design choice.
const MOVING_M_S: f64 = 0.005;
/// The lag in use changes by at most this fraction of a tick per tick, so that the estimated motion is at most a fifth faster or
/// slower than the command. A jump of the estimate, as when the lag is first known, would look like an impact to the
/// identification: the force of a pressing hand fell by up to 3 N for 7 ms on the emulated arm, which lags by 36 ms.
const GLIDE: f64 = 0.2;

#[derive(Clone, Debug)]
pub struct TrackingLag {
    ring: Vec<Vector3<f64>>,
    newest: usize,
    filled: usize,
    stride: usize,
    forget: f64,
    step_min_m: f64,
    cost_m2: [f64; CANDIDATES],
    moving_ticks: u64,
    warm_up_ticks: u64,
    /// The lag with the smallest cost.
    found_samples: f64,
    /// The lag in use.
    lag_samples: f64,
    /// Maximum change of the lag in use in one tick.
    glide: f64,
}

impl TrackingLag {
    /// Starts without a known lag, for a loop of this rate (Hz). `jumps`: a lag that was found is used at once, as in sessions
    /// with a journal of version 5; for their replay only.
    pub fn new(rate_hz: f64, jumps: bool) -> Self {
        // At low rates one tick is longer than the steps, so it is the step.
        let stride = ((LAG_MAX_S * rate_hz / CANDIDATES as f64).round() as usize).max(1);
        let far = (MAX_DELAY_S * rate_hz).ceil() as usize;
        Self {
            // Room for the longest lag beyond the longest delay of a remote follower.
            ring: vec![Vector3::zeros(); stride * CANDIDATES + 1 + far],
            newest: 0,
            filled: 0,
            stride,
            forget: (1.0 / (MEMORY_S * rate_hz)).min(1.0),
            // Compared per tick, so that `span` ticks need `span` times as much.
            step_min_m: MOVING_M_S / rate_hz,
            cost_m2: [0.0; CANDIDATES],
            moving_ticks: 0,
            // A quarter of a second of motion: before that, the smallest cost is decided by a single stroke.
            warm_up_ticks: (0.25 * rate_hz) as u64,
            found_samples: 0.0,
            lag_samples: 0.0,
            glide: if jumps { f64::INFINITY } else { GLIDE },
        }
    }

    /// Discards the commands so far because the follower was not following them; the lag is kept.
    pub fn interrupt(&mut self) {
        self.filled = 0;
    }

    pub const fn lag_samples(&self) -> f64 {
        self.lag_samples
    }

    fn back(&self, samples: usize) -> &Vector3<f64> {
        let room = self.ring.len();
        // Not farther than the oldest stored command.
        &self.ring[(self.newest + room - samples.min(self.filled.saturating_sub(1))) % room]
    }

    /// Returns the command of `ago` ticks ago, m, if it was followed then.
    pub fn command_m(&self, ago: usize) -> Option<Vector3<f64>> {
        (ago < self.filled).then(|| *self.back(ago))
    }

    /// Adds the command (m) of this tick, and the tip (m), measured when the command of `behind` ticks ago was active.
    /// Returns the estimated position to which the current command moves the tip, m; in one place that is its current
    /// position.
    pub fn step(&mut self, command_m: &Vector3<f64>, tip_m: &Vector3<f64>, behind: usize) -> Vector3<f64> {
        self.newest = (self.newest + 1) % self.ring.len();
        self.ring[self.newest] = *command_m;
        self.filled = (self.filled + 1).min(self.ring.len());
        // Over several ticks, because the noise of one tick is faster than a slow hand.
        let span = self.stride * 4;
        let moving = (command_m - self.back(span)).norm() > self.step_min_m * span as f64;
        // Each candidate lag is compared with the command of that time, so the command must exist.
        if moving && self.filled > behind + self.stride * CANDIDATES {
            self.compare(tip_m, behind);
        }
        let change = self.found_samples - self.lag_samples;
        // Assigned, not added, where it is reached: a replay needs the same bits.
        self.lag_samples =
            if change.abs() < self.glide { self.found_samples } else { self.lag_samples + self.glide.copysign(change) };
        let whole = self.lag_samples.floor();
        let late = self.back(whole as usize);
        let later = self.back(whole as usize + 1);
        late + (later - late) * (self.lag_samples - whole)
    }

    fn compare(&mut self, tip_m: &Vector3<f64>, behind: usize) {
        self.moving_ticks += 1;
        // A plain mean until the averaging time is reached, then an exponentially weighted one. Otherwise the costs,
        // which start at zero, would favour whatever was seen first.
        let weight = self.forget.max(1.0 / self.moving_ticks as f64);
        let mut best = 0;
        for candidate in 0..CANDIDATES {
            let difference_m2 = (self.back(behind + candidate * self.stride) - tip_m).norm_squared();
            self.cost_m2[candidate] += (difference_m2 - self.cost_m2[candidate]) * weight;
            if self.cost_m2[candidate] < self.cost_m2[best] {
                best = candidate;
            }
        }
        if self.moving_ticks >= self.warm_up_ticks {
            // The parabola through the three lowest costs finds the lag between two candidates.
            self.found_samples = (best as f64 + self.vertex(best)) * self.stride as f64;
        }
    }

    /// Returns the position of the parabola's minimum through `best` and its neighbours, relative to `best`, in
    /// candidates, -0.5 to 0.5.
    fn vertex(&self, best: usize) -> f64 {
        if best == 0 || best + 1 >= CANDIDATES {
            return 0.0;
        }
        let [before, lowest, after] = [self.cost_m2[best - 1], self.cost_m2[best], self.cost_m2[best + 1]];
        let curvature = before - 2.0 * lowest + after;
        // Equal costs have no minimum: a flat parabola would give an infinite vertex.
        // Half a step at most: the minimum is within the neighbours of the best candidate.
        if curvature <= 0.0 { 0.0 } else { (0.5 * (before - after) / curvature).clamp(-0.5, 0.5) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(t_s: f64) -> Vector3<f64> {
        Vector3::new((3.0 * t_s).sin(), (5.0 * t_s).cos(), 0.3 * (7.0 * t_s).sin()) * 0.03
    }

    #[test]
    fn a_pure_lag_is_found_and_the_tip_predicted() {
        for rate_hz in [100.0, 1000.0, 4000.0] {
            for lag_s in [0.0, 0.021, 0.0605] {
                let mut tracking = TrackingLag::new(rate_hz, false);
                let mut error_m = 0.0;
                for i in 0..(4.0 * rate_hz) as usize {
                    let t_s = i as f64 / rate_hz;
                    let tip_m = command(t_s - lag_s);
                    error_m = (tracking.step(&command(t_s), &tip_m, 0) - tip_m).norm();
                }
                assert!(error_m < 0.2e-3, "{rate_hz} Hz, lag {lag_s} s: {error_m} m, {} ticks", tracking.lag_samples());
            }
        }
    }

    #[test]
    fn over_a_network_the_lag_is_still_the_followers_alone() {
        for behind in [1, 40, 600] {
            let mut tracking = TrackingLag::new(1000.0, false);
            let lag_s = 0.021;
            let mut error_m = 0.0;
            for i in 0..5000 {
                let t_s = f64::from(i) * 1e-3;
                let seen_m = command(t_s - behind as f64 * 1e-3 - lag_s);
                error_m = (tracking.step(&command(t_s), &seen_m, behind) - command(t_s - lag_s)).norm();
            }
            assert!(error_m < 0.2e-3, "{behind}: {error_m} m, {} ticks", tracking.lag_samples());
            assert_eq!(tracking.command_m(behind), Some(command((4999 - behind) as f64 * 1e-3)));
        }
    }

    #[test]
    fn the_estimate_does_not_jump_when_the_lag_is_first_known() {
        let largest_step_m = |jumps: bool| {
            let mut tracking = TrackingLag::new(1000.0, jumps);
            let at_m: Vec<_> = (0..2000)
                .map(|i| {
                    let t_s = f64::from(i) * 1e-3;
                    tracking.step(&command(t_s), &command(t_s - 0.0605), 0)
                })
                .collect();
            at_m.windows(2).map(|two| (two[1] - two[0]).norm()).fold(0.0, f64::max)
        };
        let fastest_m = (0..2000).map(|i| (command(f64::from(i + 1) * 1e-3) - command(f64::from(i) * 1e-3)).norm());
        let fastest_m = fastest_m.fold(0.0, f64::max);
        let [glides_m, jumps_m] = [false, true].map(largest_step_m);
        assert!(glides_m < 1.25 * fastest_m, "{glides_m} m in a tick; the command moves by {fastest_m} m");
        assert!(jumps_m > 10.0 * fastest_m, "{jumps_m} m");
    }

    #[test]
    fn standstill_teaches_nothing_and_breaks_nothing() {
        let mut tracking = TrackingLag::new(1000.0, false);
        for _ in 0..5000 {
            let at = tracking.step(&Vector3::repeat(0.01), &Vector3::repeat(0.02), 0);
            assert!(at == Vector3::repeat(0.01));
        }
        assert!(tracking.lag_samples().abs() < f64::EPSILON);
    }
}
