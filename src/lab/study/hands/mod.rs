//! Hands that hold the handle, and hands that release it, with the last gate:
//! [`Governor`](nima_core::safety::Governor).
//!
//! Takes the clocks of the loop, the number of hands and releases, and a seed; gives a [`HandReport`]: one [`HeldHands`] for every clock and
//! [`HandKind`] of hand that stays, with the tissue's late force; one [`InMode`] for every clock and mode of the whole loop; and one
//! [`Releases`] for every clock, force and time in which the fingers open. Deterministic for a seed.

mod aims;
mod hand;
mod kind;
mod modes;
mod person_parameters;
mod present;
mod present_hands;
mod released;

use nima_core::impedance::{Mode, SettingsError};
use nima_machine::runtime::{ClockProfile, VirtualClock};
use serde::Serialize;

pub use aims::Aims;
pub use kind::HandKind;
pub use modes::InMode;
pub use present_hands::HeldTally;
pub use released::{FORCES_N, OPENINGS_MS, Releases};

use self::{
    modes::in_mode,
    present_hands::{governor, held},
    released::{OPENINGS_OF_OTHERS_MS, releases},
};
use crate::{
    Experiment, clocks,
    release::{ReleaseError, pressed_tissue},
};

/// The usual hands release on every clock, the other kinds only on the first clock and this many times less often.
const OTHERS: u64 = 3;

/// Reason why the study could not be run.
#[derive(Debug, thiserror::Error)]
pub enum HandsError {
    /// The tissue that is pressed in the modes cannot be had.
    #[error(transparent)]
    Tissue(#[from] ReleaseError),
    /// Settings out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}

/// Hands of one kind that stayed, on one clock.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct HeldHands {
    /// Clock of the loop.
    pub clock: ClockProfile,
    /// Name of the kind.
    pub kind: &'static str,
    /// Events and sums.
    #[serde(flatten)]
    pub tally: HeldTally,
}

/// Options of the study.
#[derive(Clone, Debug)]
pub struct HandOptions {
    /// Clocks of the loop, in the order of the tables.
    pub clocks: Vec<VirtualClock>,
    /// Number of hands of each kind on each clock, and time for which each holds the handle, s.
    pub hands: u64,
    /// See above.
    pub seconds: f64,
    /// Releases of each force.
    pub releases: u64,
    /// Seed of the hands.
    pub seed: u64,
}

/// The study's result.
#[derive(Clone, Debug, Default, Serialize)]
pub struct HandReport {
    /// Hands that hold the handle, with the governor alone.
    pub held: Vec<HeldHands>,
    /// Hands that stayed, in the whole loop.
    pub modes: Vec<InMode>,
    /// Hands that release the handle.
    pub releases: Vec<Releases>,
}

impl Experiment for HandOptions {
    const NAME: &'static str = "hands";
    type Findings = HandReport;
    type Error = HandsError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<HandReport, HandsError> {
        let tissue = pressed_tissue()?;
        let mut report = HandReport::default();
        let steps = self.clocks.len() * (HandKind::ALL.len() + Mode::ALL.len() + 1);
        let mut done = 0;
        let mut step = |what: &str| {
            progress(done, steps, what);
            done += 1;
        };
        for (number, clock) in self.clocks.iter().enumerate() {
            for kind in &HandKind::ALL {
                step(&format!("{}, {}", clock.profile, kind.name));
                report.held.push(self.held(*clock, kind));
            }
            for mode in Mode::ALL {
                step(&format!("{}, {mode}", clock.profile));
                report.modes.push(in_mode(mode, *clock, self.seed, self.seconds, tissue)?);
            }
            step(&format!("{}, releases", clock.profile));
            report.releases.extend(self.let_go(*clock, &HandKind::USUAL, &OPENINGS_MS, self.releases));
            for kind in HandKind::ALL.iter().filter(|kind| number == 0 && kind.lets_go_otherwise()) {
                let count = self.releases.div_ceil(OTHERS);
                report.releases.extend(self.let_go(*clock, kind, &OPENINGS_OF_OTHERS_MS, count));
            }
        }
        progress(steps, steps, "done");
        Ok(report)
    }
}

impl HandOptions {
    fn held(&self, clock: VirtualClock, kind: &HandKind) -> HeldHands {
        let mut tally = HeldTally::default();
        for number in 0..self.hands {
            let clock = clocks::of_trial(clock, number);
            let seed = self.seed.wrapping_add(number);
            tally.add(&if kind.space {
                held::<3, _>(kind, clock, seed, self.seconds, || governor(kind))
            } else {
                held::<1, _>(kind, clock, seed, self.seconds, || governor(kind))
            });
        }
        HeldHands { clock: clock.profile, kind: kind.name, tally }
    }

    /// Releases every force, with a hand that opens within each of these times, ms.
    fn let_go(
        &self,
        clock: VirtualClock,
        kind: &HandKind,
        openings_ms: &[f64],
        count: u64,
    ) -> impl Iterator<Item = Releases> {
        let cells = openings_ms.iter().flat_map(|opening_ms| FORCES_N.map(|force_n| (*opening_ms, force_n)));
        cells.map(move |cell| releases(kind, clock, self.seed, count, cell))
    }
}

impl HandReport {
    /// Returns the clocks, in the order in which they were tried.
    fn clocks(&self) -> Vec<ClockProfile> {
        let mut clocks: Vec<_> = self.held.iter().map(|row| row.clock).collect();
        clocks.dedup();
        clocks
    }

    /// Returns the sum over all kinds on this clock.
    fn all_kinds(&self, clock: ClockProfile) -> HeldTally {
        let mut all = HeldTally::default();
        self.held.iter().filter(|row| row.clock == clock).for_each(|row| all.add(&row.tally));
        all
    }
}

#[cfg(test)]
mod tests;
