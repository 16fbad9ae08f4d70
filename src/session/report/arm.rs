//! Statistics of one arm.

use nalgebra::Vector3;
use nima_core::{
    impedance::{MAX_DEGREE, MODES, SLOTS},
    safety::{GATES, Gate},
};
use serde::Serialize;

use super::{
    force::{ForceFigures, ForceStatistics},
    trace::SignalTrace,
};

/// Numbers of the states, as stored in the file, that affect the statistics.
const ENGAGED: u8 = 3;
/// Number of states, from disconnected to faulted.
pub const STATES: usize = crate::topics::STATES.len();
/// Samples farther apart than this are not contiguous, s: some are missing.
const HOLE_S: f64 = 0.02;
/// Columns of the degrees in the file: anchored, matched, nima, the paper's choice.
pub const DEGREE_COLUMNS: [&str; 4] = ["anchored", "matched", "nima", "paper"];

/// A period in one state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StateSpan {
    /// 0 disconnected, 1 idle, 2 ready, 3 engaged, 4 clutched, 5 stopped, 6 faulted.
    pub state: u8,
    /// Start, s since the start of the session.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
}

/// Activity of one gate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GateFraction {
    pub gate: Gate,
    /// Fraction of the engaged time in which it acted, 0 to 1; for the first gate, fraction of all time.
    #[serde(rename = "share")]
    pub fraction: f64,
}

/// Statistics of the identification and the network while engaged.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct IdentificationFigures {
    /// Mean prediction error at the horizon of each computed mode, N; the last one is the baseline.
    pub error_n: [Option<f64>; SLOTS],
    /// Fractions of the degrees 0 to 5 for each of [`DEGREE_COLUMNS`], where they were computed.
    #[serde(rename = "degree_shares")]
    pub degree_fractions: [Option<[f64; MAX_DEGREE + 1]>; DEGREE_COLUMNS.len()],
    /// Fraction of the time without motion to learn from, 0 to 1.
    #[serde(rename = "resting_share")]
    pub resting_fraction: f64,
    /// `None` without a network.
    pub network: Option<NetworkFigures>,
}

/// Uncertainty of the network while engaged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct NetworkFigures {
    /// Mean weight in the force, 0 to 1.
    #[serde(rename = "share")]
    pub fraction: f64,
    /// Fraction of the time outside the training data, 0 to 1.
    #[serde(rename = "outside_share")]
    pub outside_fraction: f64,
    /// Maximum distance from the training data, relative to the permitted distance.
    pub doubt_max: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmFigures {
    /// `right` or `left`.
    pub side: &'static str,
    pub states: Vec<StateSpan>,
    /// s.
    pub seconds: [f64; STATES],
    /// Measured, delayed and rendered force while engaged.
    pub forces: [Option<ForceFigures>; 3],
    /// Lengths of these forces over time, N.
    pub traces: [SignalTrace; 3],
    pub gates: Vec<GateFraction>,
    /// Minimum energy that the hand might still get back, J.
    #[serde(rename = "stored_least_j")]
    pub stored_min_j: f64,
    /// Mean force that the dead band withheld while engaged, N.
    pub withheld_mean_n: f64,
    /// Maximum of that force, N.
    pub withheld_max_n: f64,
    /// Name and result; `None` if the file does not contain it.
    pub identified: Option<IdentificationFigures>,
}

/// Names of the forces in [`ArmFigures::forces`].
pub const FORCES: [&str; 3] = ["measured", "delayed", "rendered"];

pub(super) struct ArmCollector {
    figures: ArmFigures,
    period_s: f64,
    forces: [ForceStatistics; 3],
    newest: Option<(f64, [Vector3<f64>; 3])>,
    last_s: Option<f64>,
    last_engaged: bool,
    ticks: u64,
    engaged: u64,
    acted: [u64; GATES],
    withheld_sum_n: f64,
    identified: IdentificationSamples,
}

impl ArmCollector {
    pub(super) fn new(side: &'static str, length_s: f64, period_s: f64) -> Self {
        let figures = ArmFigures {
            side,
            states: Vec::new(),
            seconds: [0.0; STATES],
            forces: [None; 3],
            traces: [0; 3].map(|_| SignalTrace::over(length_s)),
            gates: Vec::new(),
            stored_min_j: f64::INFINITY,
            withheld_mean_n: 0.0,
            withheld_max_n: 0.0,
            identified: None,
        };
        Self {
            figures,
            period_s,
            forces: Default::default(),
            newest: None,
            last_s: None,
            last_engaged: false,
            ticks: 0,
            engaged: 0,
            acted: [0; GATES],
            withheld_sum_n: 0.0,
            identified: IdentificationSamples::default(),
        }
    }

    /// Adds measured, delayed, requested and rendered force of a tick, N; its gates follow.
    pub(super) fn forces(&mut self, t_s: f64, values: &[f64]) {
        if let [mx, my, mz, dx, dy, dz, _, _, _, rx, ry, rz] = *values {
            let forces = [Vector3::new(mx, my, mz), Vector3::new(dx, dy, dz), Vector3::new(rx, ry, rz)];
            for (trace, force) in self.figures.traces.iter_mut().zip(&forces) {
                trace.add(t_s, force.norm());
            }
            self.newest = Some((t_s, forces));
        }
    }

    /// Adds the gates and the state of a tick.
    pub(super) fn gates(&mut self, t_s: f64, values: &[f64]) {
        let Some((acted, &[_gain, stored_j, withheld_n, _governed, state])) = values.split_at_checked(GATES) else {
            return;
        };
        let state = (state as u8).min(STATES as u8 - 1);
        let follows = self.last_s.is_some_and(|last_s| t_s - last_s < HOLE_S);
        let dt_s = self.last_s.filter(|_| follows).map_or(self.period_s, |last_s| t_s - last_s);
        self.last_s = Some(t_s);
        self.state(t_s, dt_s, state, follows);
        self.ticks += 1;
        self.acted[Gate::Permission.index()] += u64::from(acted[Gate::Permission.index()] > 0.5);
        let was_engaged = std::mem::replace(&mut self.last_engaged, state == ENGAGED);
        if state != ENGAGED {
            return;
        }
        self.engaged += 1;
        for (count, acted) in self.acted.iter_mut().zip(acted).skip(1) {
            *count += u64::from(*acted > 0.5);
        }
        self.figures.stored_min_j = self.figures.stored_min_j.min(stored_j);
        self.figures.withheld_max_n = self.figures.withheld_max_n.max(withheld_n);
        self.withheld_sum_n += withheld_n;
        if let Some((_, forces)) = self.newest.filter(|&(of_s, _)| of_s.total_cmp(&t_s).is_eq()) {
            for (measured, force_n) in self.forces.iter_mut().zip(forces) {
                measured.add(t_s, dt_s, force_n, !(follows && was_engaged));
            }
        }
    }

    fn state(&mut self, t_s: f64, dt_s: f64, state: u8, follows: bool) {
        self.figures.seconds[usize::from(state)] += dt_s;
        match self.figures.states.last_mut() {
            Some(span) if span.state == state && follows => span.to_s = t_s,
            last => {
                if let (Some(span), true) = (last, follows) {
                    span.to_s = t_s;
                }
                self.figures.states.push(StateSpan { state, from_s: t_s, to_s: t_s });
            }
        }
    }

    /// Adds a sample of the identification, ten times a second.
    pub(super) fn identified(&mut self, values: &[f64]) {
        self.identified.is_there = true;
        if self.last_engaged {
            self.identified.add(values);
        }
    }

    pub(super) fn figures(self) -> ArmFigures {
        let mut figures = self.figures;
        figures.forces = self.forces.each_ref().map(ForceStatistics::figures);
        let of_all = |gate: Gate| if gate == Gate::Permission { self.ticks } else { self.engaged };
        let fraction = |gate: Gate| self.acted[gate.index()] as f64 / of_all(gate).max(1) as f64;
        figures.gates = Gate::ALL.iter().map(|&gate| GateFraction { gate, fraction: fraction(gate) }).collect();
        figures.withheld_mean_n = self.withheld_sum_n / self.engaged.max(1) as f64;
        if !figures.stored_min_j.is_finite() {
            figures.stored_min_j = 0.0;
        }
        figures.identified = self.identified.figures();
        figures
    }
}

/// Mean of the values that are present.
#[derive(Clone, Copy, Debug, Default)]
struct ArmMean {
    sum: f64,
    count: u64,
}

impl ArmMean {
    fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.sum += value;
            self.count += 1;
        }
    }

    fn mean(self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}

/// Samples of the identification.
#[derive(Clone, Debug, Default)]
struct IdentificationSamples {
    is_there: bool,
    errors_n: [ArmMean; SLOTS],
    degrees: [[u64; MAX_DEGREE + 1]; DEGREE_COLUMNS.len()],
    resting: ArmMean,
    network: [ArmMean; 2],
    doubt_max: f64,
}

impl IdentificationSamples {
    fn add(&mut self, values: &[f64]) {
        let Some((errors_n, &[a, m, n, p, resting, fraction, outside, doubt])) = values.split_at_checked(MODES + 1)
        else {
            return;
        };
        for (mean, error_n) in self.errors_n.iter_mut().zip(errors_n) {
            mean.add(*error_n);
        }
        for (counts, degree) in self.degrees.iter_mut().zip([a, m, n, p]) {
            if let Some(count) = counts.get_mut(degree as usize).filter(|_| degree >= 0.0) {
                *count += 1;
            }
        }
        self.resting.add(resting);
        self.network[0].add(fraction);
        self.network[1].add(outside);
        self.doubt_max = self.doubt_max.max(doubt);
    }

    fn figures(&self) -> Option<IdentificationFigures> {
        let fractions = |counts: &[u64; MAX_DEGREE + 1]| {
            let total: u64 = counts.iter().sum();
            (total > 0).then(|| counts.map(|count| count as f64 / total as f64))
        };
        let network = self.network[0].mean().map(|fraction| NetworkFigures {
            fraction,
            outside_fraction: self.network[1].mean().unwrap_or_default(),
            doubt_max: self.doubt_max,
        });
        self.is_there.then(|| IdentificationFigures {
            error_n: self.errors_n.map(ArmMean::mean),
            degree_fractions: self.degrees.each_ref().map(fractions),
            resting_fraction: self.resting.mean().unwrap_or_default(),
            network,
        })
    }
}
