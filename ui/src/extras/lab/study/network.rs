//! Arguments of `nima study network`.

use clap::Args;
use nima_core::impedance::{Mode, OwnMotion};
use nima_study::network::{NetworkOptions, PlanExtent};

use super::{ExperimentArguments, clocks::StudyClocks};

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct NetworkStudy {
    /// Six short cells, in seconds
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Every combination of delay, jitter, loss, bursts, outages, faults of the clock and modes (more than 100 000 cells: days)
    #[arg(long)]
    full: bool,
    /// Only this mode, in addition to delayed reflection; may be given several times, and the first one is judged (default:
    /// all modes, and best is judged)
    #[arg(long, value_name = "M")]
    mode: Vec<Mode>,
    /// Compute the force from the motion of the handle, as the rig key `own_motion = "handle"` does
    #[arg(long)]
    own_motion_handle: bool,
    #[command(flatten)]
    clocks: StudyClocks,
}

impl ExperimentArguments for NetworkStudy {
    type Experiment = NetworkOptions;

    fn experiment(&self) -> anyhow::Result<NetworkOptions> {
        let extent = match (self.quick, self.full) {
            (true, _) => PlanExtent::Quick,
            (_, true) => PlanExtent::Full,
            _ => PlanExtent::Usual,
        };
        let own_motion = if self.own_motion_handle { OwnMotion::Handle } else { OwnMotion::Follower };
        Ok(NetworkOptions { extent, clocks: self.clocks.chosen(), modes: self.mode.clone(), own_motion })
    }
}
