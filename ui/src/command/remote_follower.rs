//! Option of a command whose arm may be at another machine.

use clap::Args;
use nima_machine::config::RigConfig;
use nima_screen::link::RemoteLine;
use nima_simulation::scene::Scene;

use crate::{
    by_itself::ArmLocation,
    extras::{self, Extra},
};

#[derive(Clone, Debug, Default, Args)]
pub(crate) struct ToFollower {
    /// Use the arm and sensor on another machine (HOST), where `nima follower` runs; handle and screen are on this one
    #[arg(long, value_name = "HOST[:PORT]")]
    follower: Option<String>,
}

impl ToFollower {
    pub(super) fn arm(&self) -> ArmLocation {
        let Some(host) = &self.follower else { return ArmLocation::Here };
        let is_loopback = extras::part(Extra::way).is_some_and(|way| way.is_loopback(host));
        if is_loopback { ArmLocation::Loopback } else { ArmLocation::Elsewhere }
    }

    /// Opens the link, if requested; reduces the rig to the parts at this machine.
    pub(super) fn open(&self, rig: &mut RigConfig, scene: &Scene) -> anyhow::Result<Option<Box<dyn RemoteLine>>> {
        let Some(host) = &self.follower else { return Ok(None) };
        let way = extras::part(Extra::way).ok_or_else(|| extras::not_built("`--follower`", "two-machines"))?;
        way.open(host, rig, scene).map(Some)
    }
}
