//! `--live`, `--share`, `--igtl` and `--lsl`: others watch while it happens. The first two in programs that were built with the features `live` and
//! `department`.

mod bridges;

use std::{net::SocketAddr, path::PathBuf};

use clap::Args;
use nima_endoscope::Reel;
use nima_session::outlet::Audience;
use nima_simulation::Plan;

#[cfg(any(feature = "live", feature = "department"))]
use crate::telling::tell;

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
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = bridges::INSTALLED, help = LSL_HELP)]
    lsl: Option<PathBuf>,
}

/// One of those who let others watch.
trait Server: std::fmt::Debug {
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
        let lsl = self.lsl.as_deref().map(bridges::marks_by);
        let servers = [self.live.map(live_at), self.share.map(share_at), self.igtl.map(bridges::igtl_at), lsl];
        Ok(Servers(servers.into_iter().flatten().collect::<anyhow::Result<_>>()?))
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

#[cfg(feature = "live")]
impl Server for nima_live::Server {
    fn audience(&self, _: &Plan, _: &Reel) -> Box<dyn Audience> {
        self.audience()
    }

    fn shown(&self) -> Shown {
        Shown { at: format!("ws://{}", self.address()), watchers: self.viewers() }
    }
}

#[cfg(feature = "live")]
fn live_at(address: SocketAddr) -> anyhow::Result<Box<dyn Server>> {
    let server = nima_live::Server::start(address, crate::recording::PROGRAM)?;
    tell(format_args!("nima: live at ws://{}: open a Foxglove WebSocket connection to it", server.address()));
    Ok(Box::new(server))
}

#[cfg(not(feature = "live"))]
fn live_at(_: SocketAddr) -> anyhow::Result<Box<dyn Server>> {
    anyhow::bail!(
        "this program was built without live viewing; build it with `cargo build --release --locked -p nima-console --features live`"
    )
}

#[cfg(feature = "department")]
impl Server for nima_department::Share {
    fn audience(&self, _: &Plan, _: &Reel) -> Box<dyn Audience> {
        self.audience()
    }

    fn shown(&self) -> Shown {
        Shown { at: format!("{} ({})", self.address(), self.name()), watchers: self.watchers() }
    }
}

#[cfg(feature = "department")]
fn share_at(address: SocketAddr) -> anyhow::Result<Box<dyn Server>> {
    let own = crate::command::department::own_identity()?;
    let share = nima_department::Share::start(&own, address, !address.ip().is_loopback())?;
    tell(format_args!("nima: shared with department {} as {} at {}", own.department, share.name(), share.address()));
    Ok(Box::new(share))
}

#[cfg(not(feature = "department"))]
fn share_at(_: SocketAddr) -> anyhow::Result<Box<dyn Server>> {
    anyhow::bail!(crate::command::department::NO_DEPARTMENT)
}

#[cfg(test)]
mod tests {
    use nima_machine::config::RigConfig;
    use nima_simulation::scene::Scene;

    use super::*;

    /// It would show forces as they are rendered, and with them the condition.
    #[test]
    fn a_trial_of_a_blind_study_is_not_shown_by_openigtlink() {
        let server = bridges::igtl_at("127.0.0.1:0".parse().unwrap()).unwrap();
        let servers = Servers(vec![server]);
        let (rig, scene) = (RigConfig::load("simulated").unwrap(), Scene::load("rings").unwrap());
        let plan = Plan { rig, scene, calibrations: Default::default(), engage: false };
        assert!(servers.blind_audiences(&plan, "P03 4").is_empty());
        assert_eq!(servers.audiences(&plan, &Reel::default()).len(), 1);
        assert!(servers.shown()[0].at.starts_with("igtl://127.0.0.1:"));
    }
}
