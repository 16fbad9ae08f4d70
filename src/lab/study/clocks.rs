//! Clocks on which the loop runs in a study.

use nima_machine::runtime::{ClockProfile, VirtualClock};

/// The default profiles of a study, in order: first the results that a user will see.
pub const USUAL: [ClockProfile; 2] = [ClockProfile::Quiet, ClockProfile::Perfect];

/// Returns the heading for the results on this clock.
pub(crate) fn heading(profile: ClockProfile) -> String {
    format!("On the clock *{profile}*:\n\n")
}

/// Returns the clock of the trial with this number, shifted so that late ticks occur at different moments in similar
/// trials.
pub(crate) const fn of_trial(clock: VirtualClock, number: u64) -> VirtualClock {
    VirtualClock { seed: clock.seed.wrapping_add(number), ..clock }
}
