//! Clocks on which the loop runs in a study.

use clap::Args;
use nima_machine::runtime::{ClockProfile, VirtualClock};
use nima_study::clocks::USUAL;

/// One value of `--clock`.
#[derive(Clone, Copy, Debug)]
enum ClockName {
    One(ClockProfile),
    All,
}

#[derive(Debug, Args)]
pub(super) struct StudyClocks {
    /// Wake-up times of the loop's ticks: perfect, quiet or busy (recorded on such a computer), late-PERCENT (this
    /// percentage of ticks is 0.5 to 4 ms late), stall-MS (a pause about once per second), or all; may be repeated
    /// (default: quiet and perfect)
    #[arg(long, value_name = "NAME", value_parser = named)]
    clock: Vec<ClockName>,
    /// Random seed for the times of late ticks
    #[arg(long, value_name = "N", default_value_t = 1)]
    clock_seed: u64,
}

fn named(text: &str) -> Result<ClockName, String> {
    match text {
        "all" => Ok(ClockName::All),
        _ => text
            .parse()
            .map(ClockName::One)
            .map_err(|error: nima_machine::runtime::ParseClockProfileError| error.to_string()),
    }
}

impl StudyClocks {
    /// Returns the clocks, each once, in the order of the arguments.
    pub(super) fn chosen(&self) -> Vec<VirtualClock> {
        let mut chosen: Vec<ClockProfile> = Vec::new();
        let named = self.clock.iter().flat_map(|named| match named {
            ClockName::One(profile) => vec![*profile],
            ClockName::All => ClockProfile::ALL.to_vec(),
        });
        for profile in named {
            if !chosen.contains(&profile) {
                chosen.push(profile);
            }
        }
        if chosen.is_empty() {
            chosen.extend(USUAL);
        }
        chosen.into_iter().map(|profile| VirtualClock { profile, seed: self.clock_seed }).collect()
    }
}
