//! Arguments of `nima study network`.

use clap::Args;
use nima_core::impedance::{Mode, OwnMotion};
use nima_study::network::{NetworkOptions, PlanExtent};

use super::{ExperimentArguments, clocks::StudyClocks};

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct NetworkStudy {
    /// Run only six short cells (takes seconds)
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Run every combination of delay, jitter, loss, bursts, outages, clock faults and modes (more than 100 000 cells;
    /// takes days)
    #[arg(long)]
    full: bool,
    /// Run only this mode and delayed reflection; may be repeated; the first mode is judged (default: all modes; best
    /// is judged)
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
