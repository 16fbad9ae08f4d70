//! `--live`, `--share`, `--igtl` and `--lsl`: others watch while it happens, through extras.

use std::{
    net::SocketAddr,
    path::{Path, PathBuf},
};

use clap::Args;
use nima_endoscope::Reel;
use nima_session::outlet::Audience;
use nima_simulation::Plan;

use crate::extras;

/// In place of a file: the library that is installed.
pub(crate) const INSTALLED: &str = "liblsl";
const LIVE_HELP: &str =
    "Let Foxglove and PlotJuggler watch at this address (without one: 127.0.0.1:8765, from this computer only)";
const SHARE_HELP: &str =
    "Let the department watch and record this rig, at this address of it (without one: all, port 7447)";
const IGTL_HELP: &str = "Let OpenIGTLink clients (3D Slicer, pyigtl) read poses, forces and the endoscope's picture at this address (without one: 127.0.0.1:18944, from this computer only)";
const LSL_HELP: &str = "Send marks of what happens over the Lab Streaming Layer, with this file of liblsl (without one: the installed one)";

/// Who may watch.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct Watching {
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "127.0.0.1:8765", help = LIVE_HELP)]
    live: Option<SocketAddr>,
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "0.0.0.0:7447", help = SHARE_HELP)]
    share: Option<SocketAddr>,
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "127.0.0.1:18944", help = IGTL_HELP)]
    igtl: Option<SocketAddr>,
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = INSTALLED, help = LSL_HELP)]
    lsl: Option<PathBuf>,
}

/// How others watch at an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Show {
    /// Foxglove and `PlotJuggler`.
    Live,
    /// The department.
    Share,
    /// `OpenIGTLink` clients.
    Igtl,
}

impl Show {
    /// The option that asks for it, and the feature that builds it.
    const fn names(self) -> [&'static str; 2] {
        match self {
            Self::Live => ["`--live`", "live"],
            Self::Share => ["`--share`", "department"],
            Self::Igtl => ["`--igtl`", "bridges"],
        }
    }

    fn start(self, at: SocketAddr) -> anyhow::Result<Box<dyn Server>> {
        let [option, feature] = self.names();
        extras::part(|extra| extra.server(self, at)).unwrap_or_else(|| Err(extras::not_built(option, feature)))
    }
}

fn marks_by(library: &Path) -> anyhow::Result<Box<dyn Server>> {
    extras::part(|extra| extra.marks(library)).unwrap_or_else(|| Err(extras::not_built("`--lsl`", "bridges")))
}

/// One of those who let others watch.
pub(crate) trait Server: std::fmt::Debug {
    /// For the recorder of the next session, of this plan; the endoscope's pictures of it come through this reel.
    fn audience(&self, plan: &Plan, reel: &Reel) -> Box<dyn Audience>;
    /// The same for a trial of a blind study, which is called this: who watches must not learn its condition. `None`: it is not shown.
    fn blind_audience(&self, _plan: &Plan, _trial: &str) -> Option<Box<dyn Audience>> {
        None
    }
    /// Whether it shows the endoscope's pictures.
    fn shows_pictures(&self) -> bool {
        false
    }
    /// Where, and how many watch.
    fn shown(&self) -> Shown;
}

/// Where others can watch, and how many do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Shown {
    /// The address, as who watches gives it.
    pub(crate) at: String,
    pub(crate) watchers: usize,
}

/// Those who let others watch, for one session after the other.
#[derive(Debug, Default)]
pub(crate) struct Servers(Vec<Box<dyn Server>>);

impl Watching {
    /// Starts the servers that are asked for.
    pub(crate) fn start(&self) -> anyhow::Result<Servers> {
        let places = [(self.live, Show::Live), (self.share, Show::Share), (self.igtl, Show::Igtl)];
        let servers = places.into_iter().filter_map(|(at, show)| Some(show.start(at?)));
        Ok(Servers(servers.chain(self.lsl.as_deref().map(marks_by)).collect::<anyhow::Result<_>>()?))
    }
}

impl Servers {
    /// For the recorder of the next session, of this plan; the endoscope's pictures of it come through this reel.
    pub(crate) fn audiences(&self, plan: &Plan, reel: &Reel) -> Vec<Box<dyn Audience>> {
        self.0.iter().map(|server| server.audience(plan, reel)).collect()
    }

    /// For the recorder of a trial of a blind study, which is called this: those of them from whom nobody learns its condition.
    pub(crate) fn blind_audiences(&self, plan: &Plan, trial: &str) -> Vec<Box<dyn Audience>> {
        self.0.iter().filter_map(|server| server.blind_audience(plan, trial)).collect()
    }

    /// Whether somebody may want the endoscope's pictures.
    pub(crate) fn show_pictures(&self) -> bool {
        self.0.iter().any(|server| server.shows_pictures())
    }

    /// Whether nobody can watch.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Where others can watch, and how many do.
    pub(crate) fn shown(&self) -> Vec<Shown> {
        self.0.iter().map(|server| server.shown()).collect()
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::config::RigConfig;
    use nima_simulation::scene::Scene;

    use super::*;

    /// It would show forces as they are rendered, and with them the condition.
    #[test]
    fn a_trial_of_a_blind_study_is_not_shown_by_openigtlink() {
        let servers = Servers(vec![Show::Igtl.start("127.0.0.1:0".parse().unwrap()).unwrap()]);
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load("rings").unwrap();
        let plan = Plan { rig, scene, calibrations: Default::default(), engage: false };
        assert!(servers.blind_audiences(&plan, "P03 4").is_empty());
        assert_eq!(servers.audiences(&plan, &Reel::default()).len(), 1);
        assert!(servers.shown()[0].at.starts_with("igtl://127.0.0.1:"));
    }
}
