//! Arguments of `nima study network`.

use clap::Args;
use nima_core::impedance::Mode;
use nima_study::network::{Extent, Options};

use super::Asked;

#[derive(Debug, Args)]
pub(in crate::command) struct Network {
    /// Six short cells, in seconds
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Every combination of delay, jitter, loss, bursts, outages, faults of the clock and modes (more than 100 000 cells: days)
    #[arg(long)]
    full: bool,
    /// Only in this mode, beside delayed reflection; may be given several times, and the first is judged (default: all modes, and best
    /// is judged)
    #[arg(long, value_name = "M")]
    mode: Vec<Mode>,
}

impl Asked for Network {
    type Experiment = Options;

    fn experiment(&self) -> anyhow::Result<Options> {
        let extent = match (self.quick, self.full) {
            (true, _) => Extent::Quick,
            (_, true) => Extent::Full,
            _ => Extent::Usual,
        };
        Ok(Options { extent, modes: self.mode.clone() })
    }
}
