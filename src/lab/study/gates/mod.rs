//! Tests the gates with random requests, most of which no real mode would make; every force that leaves the chain is
//! checked.
//!
//! Takes a number of requests and a seed; returns the number of [`Breaches`] (must be 0) and how often each gate acted,
//! which shows that the requests reach every gate. After every 2000 requests a chain is built with other settings
//! (valid and invalid ones), one or three axes and another rate; in between, gain, dead band and permission are changed
//! at random.

mod adversary;
mod watch;

use std::{convert::Infallible, time::Instant};

use fastrand::Rng;
use nalgebra::SVector;
use nima_core::safety::{GATES, Gate, SafetyChain};
use serde::Serialize;

pub use watch::Breaches;
pub(crate) use watch::GateWatch;

use self::adversary::{Adversary, ChainChange, settings};
use crate::{Experiment, Findings};

/// Requests to one chain.
const PER_CHAIN: u64 = 2000;

#[derive(Clone, Copy, Debug)]
pub struct GateOptions {
    /// Number of requests.
    pub requests: u64,
    /// Seed of the random requests.
    pub seed: u64,
}

/// Activity of a gate.
#[derive(Clone, Debug, Serialize)]
pub struct GateActions {
    pub gate: Gate,
    /// Number of requests that the gate changed.
    pub requests: u64,
}

#[derive(Clone, Debug, Serialize)]
pub struct GateStudyReport {
    pub requests: u64,
    pub chains: u64,
    /// Seed of the random requests.
    pub seed: u64,
    /// Violated limits; all must be 0.
    pub breaches: Breaches,
    /// Number of actions of each gate, in the order of the gates.
    pub acted: Vec<GateActions>,
    /// Number of forces other than zero that left a chain.
    pub forces: u64,
    /// Duration of the study, s.
    pub seconds: f64,
}

/// Runs `requests` requests; `progress` is called from time to time with the number done and the total, both in
/// thousands.
///
/// ```
/// let report = nima_study::gates::study(20_000, 1, |_, _, _| {});
/// assert_eq!(report.breaches.total(), 0);
/// assert!(report.forces > 0, "some forces passed");
/// ```
pub fn study(requests: u64, seed: u64, mut progress: impl FnMut(usize, usize, &str)) -> GateStudyReport {
    let start = Instant::now();
    let mut rng = Rng::with_seed(seed);
    let mut tally = GateTally::default();
    while tally.requests < requests {
        if tally.chains % 500 == 0 {
            progress((tally.requests / 1000) as usize, (requests / 1000) as usize, "thousand requests");
        }
        let count = PER_CHAIN.min(requests - tally.requests);
        if rng.bool() { tally.chain::<3>(&mut rng, count) } else { tally.chain::<1>(&mut rng, count) }
    }
    progress(1, 1, "done");
    GateStudyReport {
        requests,
        chains: tally.chains,
        seed,
        breaches: tally.breaches,
        acted: Gate::ALL.map(|gate| GateActions { gate, requests: tally.acted[gate.index()] }).into(),
        forces: tally.forces,
        seconds: start.elapsed().as_secs_f64(),
    }
}

#[derive(Default)]
struct GateTally {
    requests: u64,
    chains: u64,
    breaches: Breaches,
    acted: [u64; GATES],
    forces: u64,
}

impl GateTally {
    fn chain<const D: usize>(&mut self, rng: &mut Rng, count: u64) {
        let period_s = [1e-4, 1e-3, 1e-2][rng.usize(..3)];
        let mut chain = SafetyChain::<D>::new(settings(rng), period_s);
        let active = *chain.settings();
        let mut watch = GateWatch::of(&active, period_s);
        let mut adversary = Adversary::<D>::new(rng);
        for _ in 0..count {
            meddle(&mut chain, &mut watch, adversary.meddling());
            let request = adversary.request();
            let (force_n, report) = chain.step(&request);
            watch.look(request.t_s, &force_n, &report, chain.settings().gain, &mut self.breaches);
            self.forces += u64::from(force_n.norm() > 0.0);
        }
        for (sum, acted) in self.acted.iter_mut().zip(chain.counts().acted) {
            *sum += acted;
        }
        self.requests += count;
        self.chains += 1;
    }
}

fn meddle<const D: usize>(chain: &mut SafetyChain<D>, watch: &mut GateWatch<D>, meddling: ChainChange) {
    match meddling {
        ChainChange::Nothing => {}
        ChainChange::OrdinaryGain(gain) => {
            chain.set_ordinary_gain(gain);
            watch.above_one &= gain.is_nan() || gain > 1.0;
        }
        ChainChange::GainAboveOne(gain) => {
            chain.set_gain_above_one(gain);
            watch.above_one = if gain.is_nan() { watch.above_one } else { gain > 1.0 };
        }
        ChainChange::DeadBand(m_s) => chain.set_dead_band(m_s),
        ChainChange::StaticHold(hold) => chain.set_static_hold(hold),
        ChainChange::Reset => {
            chain.reset();
            watch.last_n = SVector::zeros();
            watch.let_go = false;
        }
    }
}

impl Experiment for GateOptions {
    const NAME: &'static str = "gates";
    const FILES: &'static [&'static str] = &[];
    type Findings = GateStudyReport;
    type Error = Infallible;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<GateStudyReport, Infallible> {
        Ok(study(self.requests, self.seed, progress))
    }
}

impl Findings for GateStudyReport {
    fn text(&self) -> String {
        let Breaches { not_finite, ceiling, slew, gain_rate, gain_range, uncalled, energy } = self.breaches;
        let lines = [
            format!(
                "{} requests to {} chains in {:.1} s (seed {})",
                self.requests, self.chains, self.seconds, self.seed
            ),
            format!("{} resulted in a force other than zero", self.forces),
            "gate            acted on".to_owned(),
        ];
        let gates = self.acted.iter().map(|acted| format!("{:14} {:9}", acted.gate.name(), acted.requests));
        let breaches = [
            format!("breaches        {}", self.breaches.total()),
            format!(
                "  not finite {not_finite}, ceiling {ceiling}, slew {slew}, gain rate {gain_rate}, gain range {gain_range}"
            ),
            format!("  without permission, hand or valid request {uncalled}, stored energy {energy}"),
        ];
        lines.into_iter().chain(gates).chain(breaches).collect::<Vec<_>>().join("\n")
    }

    fn files(&self) -> Vec<(String, String)> {
        Vec::new()
    }

    fn judge(&self) -> Result<(), String> {
        let breaches = self.breaches.total();
        if breaches > 0 {
            return Err(format!("{breaches} of {} requests broke a limit of the gates", self.requests));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_million_adversarial_requests_breach_nothing_and_find_every_gate() {
        let report = study(500_000, 3, |_, _, _| {});
        assert_eq!(report.breaches, Breaches::default());
        // Otherwise a chain that never outputs a force would pass.
        assert!(report.forces > 50_000, "{}", report.forces);
        for acted in &report.acted {
            assert!(acted.requests > 100, "{acted:?}");
        }
        assert_eq!(report.requests, 500_000);
    }
}
