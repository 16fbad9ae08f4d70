//! The force in the hand during a run, compared with the correct force.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::bench::RATE_HZ;

/// During contact, the force of the tissue is above the first value, N; the hand counts as feeling no force below the
/// second value, N.
const CONTACT_N: f64 = 0.5;
const NOTHING_N: f64 = 0.05;
/// A command whose response takes this much longer than the previous one was lost, ticks: the follower keeps executing
/// the earlier command.
const LOST_TICKS: usize = 20;
/// Band of oscillations, Hz.
const BAND_HZ: [f64; 2] = [2.0, 50.0];

/// One tick of both machines.
#[derive(Clone, Copy, Debug)]
pub(super) struct TraceSample {
    /// True position of the hand at the beginning of the tick, m.
    pub(super) hand_m: Vector3<f64>,
    /// True force of the tissue, N.
    pub(super) tip_n: Vector3<f64>,
    /// Force in the hand, which is held until the next tick, and the mode's requested force, N.
    pub(super) rendered_n: Vector3<f64>,
    pub(super) asked_n: Vector3<f64>,
    pub(super) is_engaged: bool,
    /// Tick of the newest command that has reached the follower.
    pub(super) newest: Option<u32>,
}

#[derive(Debug)]
pub(super) struct RunTrace {
    samples: Vec<TraceSample>,
    judged_from: usize,
}

/// Measures of the force in the hand.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TraceForce {
    /// Mean error of the force, and of the mode's requested force before the gates, N; NaN if the hand was never
    /// engaged.
    pub(super) error_n: f64,
    pub(super) asked_error_n: f64,
    /// Mean of the tissue's force, N.
    pub(super) tissue_n: f64,
    /// Maximum net energy given to the hand since an engagement, and the energy that the tissue's force would have
    /// given on the same path, J.
    pub(super) injected_j: f64,
    pub(super) tissue_injected_j: f64,
    /// RMS between 2 and 50 Hz of the force in the hand and of the tissue's force, N.
    pub(super) oscillation_n: f64,
    pub(super) tissue_oscillation_n: f64,
    /// Longest time in contact without force, ms.
    pub(super) without_force_ms: f64,
    /// Fraction of the evaluated time.
    pub(super) engaged: f64,
}

impl RunTrace {
    /// Creates a trace that is evaluated from this tick on.
    pub(super) const fn new(judged_from: usize) -> Self {
        Self { samples: Vec::new(), judged_from }
    }

    pub(super) fn push(&mut self, sample: TraceSample) {
        self.samples.push(sample);
    }

    /// Returns for each tick the force of the tissue at the time when the follower had the command of that tick, N. A
    /// lost command counts as delayed like the last one that arrived. Ends with the run.
    fn due_n(&self) -> Vec<Vector3<f64>> {
        let mut due_n = Vec::with_capacity(self.samples.len());
        let mut lag = None;
        for (tick, sample) in self.samples.iter().enumerate() {
            let Some(newest) = sample.newest.map(|newest| newest as usize) else { continue };
            while due_n.len() <= newest {
                let took = tick - due_n.len();
                let lag = lag.get_or_insert(took);
                if took <= *lag + LOST_TICKS {
                    *lag = took;
                }
                due_n.push(self.samples.get(due_n.len() + *lag).unwrap_or(sample).tip_n);
            }
        }
        // The last commands never arrived, so use the last known lag.
        let lag = lag.unwrap_or(0);
        while let Some(sample) = self.samples.get(due_n.len() + lag) {
            due_n.push(sample.tip_n);
        }
        due_n
    }

    /// Returns the measures of the force in the hand.
    pub(super) fn felt(&self) -> TraceForce {
        let due_n = self.due_n();
        let mut felt = TraceForce::default();
        let mut band = Band::default();
        let mut tissue_band = Band::default();
        let mut energy_j = 0.0;
        let mut tissue_j = 0.0;
        let mut judged = 0.0;
        let mut engaged = 0.0_f64;
        let mut without = 0_u32;
        let mut was_engaged = false;
        for (tick, (pair, due_n)) in self.samples.windows(2).zip(&due_n).enumerate() {
            let [sample, next] = [pair[0], pair[1]];
            let swings_n = band.step(&sample.rendered_n);
            let tissue_swings_n = tissue_band.step(due_n);
            was_engaged |= sample.is_engaged;
            without = if was_engaged && due_n.norm() > CONTACT_N && sample.rendered_n.norm() < NOTHING_N {
                without + 1
            } else {
                0
            };
            felt.without_force_ms = felt.without_force_ms.max(f64::from(without) * 1e3 / RATE_HZ);
            let travel_m = next.hand_m - sample.hand_m;
            energy_j += sample.rendered_n.dot(&travel_m);
            tissue_j += due_n.dot(&travel_m);
            if !sample.is_engaged {
                energy_j = 0.0;
                tissue_j = 0.0;
            }
            felt.injected_j = felt.injected_j.max(energy_j);
            felt.tissue_injected_j = felt.tissue_injected_j.max(tissue_j);
            if tick < self.judged_from {
                continue;
            }
            judged += 1.0;
            if sample.is_engaged {
                engaged += 1.0;
                felt.error_n += (sample.rendered_n - due_n).norm();
                felt.asked_error_n += (sample.asked_n - due_n).norm();
                felt.tissue_n += due_n.norm();
                felt.oscillation_n += swings_n.norm_squared();
                felt.tissue_oscillation_n += tissue_swings_n.norm_squared();
            }
        }
        // Without a counted tick there is no mean: 0 / 0 is NaN.
        for sum in [&mut felt.error_n, &mut felt.asked_error_n, &mut felt.tissue_n] {
            *sum /= engaged;
        }
        for sum in [&mut felt.oscillation_n, &mut felt.tissue_oscillation_n] {
            *sum = (*sum / engaged).sqrt();
        }
        felt.engaged = engaged / judged;
        felt
    }
}

/// A band-pass of two first-order low-passes.
#[derive(Clone, Copy, Debug, Default)]
struct Band {
    slow_n: Vector3<f64>,
    fast_n: Vector3<f64>,
}

impl Band {
    fn step(&mut self, force_n: &Vector3<f64>) -> Vector3<f64> {
        let [slow, fast] = BAND_HZ.map(|hz| 1.0 - (-TAU * hz / RATE_HZ).exp());
        self.slow_n += (force_n - self.slow_n) * slow;
        self.fast_n += (force_n - self.fast_n) * fast;
        self.fast_n - self.slow_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the trace of a hand on a sine of 1 cm at this frequency over a spring of 300 N/m, whose force is felt
    /// this many ticks late.
    fn pressed(hz: f64, late: usize, travel: usize) -> TraceForce {
        let position_m = |tick: usize| Vector3::z() * 0.01 * (TAU * hz * tick as f64 / RATE_HZ).sin();
        let mut trace = RunTrace::new(1000);
        for tick in 0..20_000_usize {
            let rendered_n = position_m(tick.saturating_sub(late)) * -300.0;
            trace.push(TraceSample {
                hand_m: position_m(tick),
                // The follower is where the hand was when it received the newest command.
                tip_n: position_m(tick.saturating_sub(travel)) * -300.0,
                rendered_n,
                asked_n: rendered_n,
                is_engaged: tick >= 500,
                newest: tick.checked_sub(travel).map(|tick| tick as u32),
            });
        }
        trace.felt()
    }

    #[test]
    fn a_force_that_is_right_for_the_hand_now_has_no_error_however_long_the_way() {
        for travel in [0, 40, 300] {
            let felt = pressed(1.0, 0, travel);
            assert!(felt.error_n < 1e-9 && (felt.injected_j - felt.tissue_injected_j).abs() < 1e-9, "{felt:?}");
            assert!((felt.engaged - 1.0).abs() < 1e-9 && felt.tissue_n > 1.8, "{felt:?}");
        }
    }

    #[test]
    fn a_late_force_has_an_error_and_gives_energy() {
        let felt = pressed(1.0, 100, 40);
        // Mean of 3 N times twice the sine of half the phase, and half of k a^2 times the sine of the phase in every
        // period.
        let phase = TAU * 0.1;
        let error_n = 3.0 * 2.0 * (phase / 2.0).sin() * 2.0 / std::f64::consts::PI;
        assert!((felt.error_n - error_n).abs() < 0.01, "{felt:?}, {error_n}");
        let per_period_j = std::f64::consts::PI * 300.0 * 1e-4 * phase.sin();
        assert!((felt.injected_j / (19.5 * per_period_j) - 1.0).abs() < 0.05, "{felt:?}, {per_period_j}");
    }

    #[test]
    fn the_band_passes_what_oscillates() {
        let [slow, middle, fast] = [0.2, 10.0, 300.0].map(|hz| pressed(hz, 0, 0).oscillation_n);
        let whole_n = 3.0 / 2.0_f64.sqrt();
        assert!(slow < 0.12 * whole_n && middle > 0.9 * whole_n && fast < 0.2 * whole_n, "{slow} {middle} {fast}");
    }
}
