//! Clocks on which the loop runs in a study.

use nima_machine::runtime::{ClockProfile, VirtualClock};

/// The profiles that a study shows unless it is told others, in their order: first the figures that a user will see.
pub const USUAL: [ClockProfile; 2] = [ClockProfile::Quiet, ClockProfile::Perfect];

/// The heading of what was measured on this clock.
pub(crate) fn heading(profile: ClockProfile) -> String {
    format!("On the clock *{profile}*:\n\n")
}

/// The clock of the trial with this number, so that late ticks meet different moments of alike trials.
pub(crate) const fn of_trial(clock: VirtualClock, number: u64) -> VirtualClock {
    VirtualClock { seed: clock.seed.wrapping_add(number), ..clock }
}
