//! Hands that are there, and hands that let go, in front of the last gate: [`Governor`](nima_core::safety::Governor).
//!
//! Takes the clocks of the loop, the number of hands and releases, and a seed; gives a [`Report`]: one [`Held`] for every clock and
//! [`Kind`] of hand that stays, with the tissue's late force; one [`InMode`] for every clock and mode of the whole loop; and one
//! [`Releases`] for every clock, force and time in which the fingers open. Deterministic for a seed.

mod aims;
mod hand;
mod held;
mod kind;
mod modes;
mod person;
mod present;
mod released;

use nima_core::impedance::{Mode, SettingsError};
use nima_machine::runtime::{ClockProfile, VirtualClock};
use serde::Serialize;

pub use aims::Aims;
pub use held::Tally;
pub use kind::Kind;
pub use modes::InMode;
pub use released::{FORCES_N, OPENINGS_MS, Releases};

use self::{
    held::{governor, held},
    modes::in_mode,
    released::{OPENINGS_OF_OTHERS_MS, releases},
};
use crate::{
    Experiment, clocks,
    release::{ReleaseError, pressed_tissue},
};

/// The usual hands let go on every clock; the other kinds on the first clock only, this many times less often.
const OTHERS: u64 = 3;

/// Why the study could not be made.
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
pub struct Held {
    /// Clock of the loop.
    pub clock: ClockProfile,
    /// Name of the kind.
    pub kind: &'static str,
    /// What happened.
    #[serde(flatten)]
    pub tally: Tally,
}

/// What to do.
#[derive(Clone, Debug)]
pub struct Options {
    /// Clocks of the loop, in the order of the tables.
    pub clocks: Vec<VirtualClock>,
    /// Hands of each kind on each clock, and how long each is there, s.
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
pub struct Report {
    /// Hands that stayed, in front of the governor alone.
    pub held: Vec<Held>,
    /// Hands that stayed, in the whole loop.
    pub modes: Vec<InMode>,
    /// Hands that let go.
    pub releases: Vec<Releases>,
}

impl Experiment for Options {
    const NAME: &'static str = "hands";
    type Findings = Report;
    type Error = HandsError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<Report, HandsError> {
        let tissue = pressed_tissue()?;
        let mut report = Report::default();
        let steps = self.clocks.len() * (Kind::ALL.len() + Mode::ALL.len() + 1);
        let mut done = 0;
        let mut step = |what: &str| {
            progress(done, steps, what);
            done += 1;
        };
        for (number, clock) in self.clocks.iter().enumerate() {
            for kind in &Kind::ALL {
                step(&format!("{}, {}", clock.profile, kind.name));
                report.held.push(self.held(*clock, kind));
            }
            for mode in Mode::ALL {
                step(&format!("{}, {mode}", clock.profile));
                report.modes.push(in_mode(mode, *clock, self.seed, self.seconds, tissue)?);
            }
            step(&format!("{}, releases", clock.profile));
            report.releases.extend(self.let_go(*clock, &Kind::USUAL, &OPENINGS_MS, self.releases));
            for kind in Kind::ALL.iter().filter(|kind| number == 0 && kind.lets_go_otherwise()) {
                let count = self.releases.div_ceil(OTHERS);
                report.releases.extend(self.let_go(*clock, kind, &OPENINGS_OF_OTHERS_MS, count));
            }
        }
        progress(steps, steps, "done");
        Ok(report)
    }
}

impl Options {
    fn held(&self, clock: VirtualClock, kind: &Kind) -> Held {
        let mut tally = Tally::default();
        for number in 0..self.hands {
            let clock = clocks::of_trial(clock, number);
            let seed = self.seed.wrapping_add(number);
            tally.add(&if kind.space {
                held::<3, _>(kind, clock, seed, self.seconds, || governor(kind))
            } else {
                held::<1, _>(kind, clock, seed, self.seconds, || governor(kind))
            });
        }
        Held { clock: clock.profile, kind: kind.name, tally }
    }

    /// Releases of every force within each of these times, ms.
    fn let_go(
        &self,
        clock: VirtualClock,
        kind: &Kind,
        openings_ms: &[f64],
        count: u64,
    ) -> impl Iterator<Item = Releases> {
        let cells = openings_ms.iter().flat_map(|opening_ms| FORCES_N.map(|force_n| (*opening_ms, force_n)));
        cells.map(move |cell| releases(kind, clock, self.seed, count, cell))
    }
}

impl Report {
    /// The clocks, in the order in which they were tried.
    fn clocks(&self) -> Vec<ClockProfile> {
        let mut clocks: Vec<_> = self.held.iter().map(|row| row.clock).collect();
        clocks.dedup();
        clocks
    }

    /// The sum over all kinds on this clock.
    fn all_kinds(&self, clock: ClockProfile) -> Tally {
        let mut all = Tally::default();
        self.held.iter().filter(|row| row.clock == clock).for_each(|row| all.add(&row.tally));
        all
    }
}

#[cfg(test)]
mod tests;
