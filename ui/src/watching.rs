//! `--live`, `--share`, `--igtl` and `--lsl`: live viewers, served by extras.

use std::{
    net::SocketAddr,
    path::{Path, PathBuf},
};

use clap::Args;
use nima_endoscope::FrameQueue;
use nima_session::sinks::Audience;
use nima_simulation::SimulationPlan;
use nima_words::text::current_session::WatchStatus;

use crate::extras;

/// Selects the installed library instead of a file.
pub(crate) const INSTALLED: &str = "liblsl";
const LIVE_HELP: &str = "Serve live data to Foxglove and PlotJuggler at this address (without a value: 127.0.0.1:8765, this computer \
     only)";
const SHARE_HELP: &str =
    "Let the department view and record this rig at this address (without a value: all addresses, port 7447)";
const IGTL_HELP: &str = "Serve poses, forces and endoscope images to OpenIGTLink clients (3D Slicer, pyigtl) at this address (without a \
 value: 127.0.0.1:18944, this computer only)";
const LSL_HELP: &str =
    "Send event marks over the Lab Streaming Layer, with this liblsl file (without a value: the installed one)";

#[derive(Clone, Debug, Default, Args)]
pub(crate) struct WatchArguments {
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "127.0.0.1:8765", help = LIVE_HELP)]
    live: Option<SocketAddr>,
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "0.0.0.0:7447", help = SHARE_HELP)]
    share: Option<SocketAddr>,
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "127.0.0.1:18944", help = IGTL_HELP)]
    igtl: Option<SocketAddr>,
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = INSTALLED, help = LSL_HELP)]
    lsl: Option<PathBuf>,
}

/// Kind of live viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    Live,
    Share,
    Igtl,
}

impl Show {
    /// Returns the option that requests it, and the feature or extra that provides it.
    const fn names(self) -> [&'static str; 2] {
        match self {
            Self::Live => ["`--live`", "live"],
            Self::Share => ["`--share`", extras::DEPARTMENT],
            Self::Igtl => ["`--igtl`", "bridges"],
        }
    }

    fn start(self, at: SocketAddr) -> anyhow::Result<Box<dyn WatchServer>> {
        let [option, feature] = self.names();
        extras::part(|extra| extra.server(self, at)).unwrap_or_else(|| Err(extras::not_built(option, feature)))
    }
}

fn marks_by(library: &Path) -> anyhow::Result<Box<dyn WatchServer>> {
    extras::part(|extra| extra.marks(library)).unwrap_or_else(|| Err(extras::not_built("`--lsl`", "bridges")))
}

/// A server for viewers of one kind.
pub trait WatchServer: std::fmt::Debug {
    /// Returns the audience for the recorder of the next session, of this plan; its endoscope images arrive through
    /// this queue.
    fn audience(&self, plan: &SimulationPlan, reel: &FrameQueue) -> Box<dyn Audience>;
    /// Returns the audience for a trial of a blind study with this name, whose condition must stay hidden from viewers.
    /// `None`: the trial is not shown.
    fn blind_audience(&self, _plan: &SimulationPlan, _trial: &str) -> Option<Box<dyn Audience>> {
        None
    }
    fn shows_images(&self) -> bool {
        false
    }
    fn shown(&self) -> WatchStatus;
}

/// Servers for live viewers, for all sessions of this process.
#[derive(Debug, Default)]
pub(crate) struct Servers(Vec<Box<dyn WatchServer>>);

impl WatchArguments {
    /// Starts the requested servers.
    pub(crate) fn start(&self) -> anyhow::Result<Servers> {
        let places = [(self.live, Show::Live), (self.share, Show::Share), (self.igtl, Show::Igtl)];
        let servers = places.into_iter().filter_map(|(at, show)| Some(show.start(at?)));
        Ok(Servers(servers.chain(self.lsl.as_deref().map(marks_by)).collect::<anyhow::Result<_>>()?))
    }
}

impl Servers {
    /// For the recorder of the next session, of this plan; its endoscope images come through this queue.
    pub(crate) fn audiences(&self, plan: &SimulationPlan, reel: &FrameQueue) -> Vec<Box<dyn Audience>> {
        self.0.iter().map(|server| server.audience(plan, reel)).collect()
    }

    /// Returns the audiences for the recorder of a trial of a blind study with this name: only servers that hide its
    /// condition.
    pub(crate) fn blind_audiences(&self, plan: &SimulationPlan, trial: &str) -> Vec<Box<dyn Audience>> {
        self.0.iter().filter_map(|server| server.blind_audience(plan, trial)).collect()
    }

    pub(crate) fn show_images(&self) -> bool {
        self.0.iter().any(|server| server.shows_images())
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn shown(&self) -> Vec<WatchStatus> {
        self.0.iter().map(|server| server.shown()).collect()
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::config::RigConfig;
    use nima_simulation::scene::Scene;

    use super::*;

    /// Each of them would show the rendered forces, and thereby the condition. The test of the department's server is in
    /// its own program.
    #[test]
    fn a_trial_of_a_blind_study_is_shown_neither_live_nor_by_openigtlink() {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load("rings").unwrap();
        let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: false };
        let mut shown = vec![(Show::Igtl, "igtl://127.0.0.1:")];
        if cfg!(feature = "live") {
            shown.push((Show::Live, "ws://127.0.0.1:"));
        }
        for (show, at) in shown {
            let servers = Servers(vec![show.start("127.0.0.1:0".parse().unwrap()).unwrap()]);
            assert!(servers.blind_audiences(&plan, "P03 4").is_empty(), "{show:?}");
            assert_eq!(servers.audiences(&plan, &FrameQueue::default()).len(), 1);
            assert!(servers.shown()[0].at.starts_with(at), "{:?}", servers.shown());
        }
    }
}
