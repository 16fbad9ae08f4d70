//! `--live` and `--share`: others watch while it happens. In programs that were built with the features `live` and `department`.

use std::net::SocketAddr;

use clap::Args;
use nima_session::outlet::Audience;

#[cfg(any(feature = "live", feature = "department"))]
use crate::telling::tell;

const LIVE_HELP: &str =
    "Let Foxglove and PlotJuggler watch at this address (without one: 127.0.0.1:8765, from this computer only)";
const SHARE_HELP: &str =
    "Let the department watch and record this rig, at this address of it (without one: all, port 7447)";

/// Who may watch.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct Watching {
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "127.0.0.1:8765", help = LIVE_HELP)]
    live: Option<SocketAddr>,
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "0.0.0.0:7447", help = SHARE_HELP)]
    share: Option<SocketAddr>,
}

/// One of those who let others watch.
trait Server: std::fmt::Debug {
    /// For the recorder of the next session.
    fn audience(&self) -> Box<dyn Audience>;
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
        let servers = [self.live.map(live_at), self.share.map(share_at)];
        Ok(Servers(servers.into_iter().flatten().collect::<anyhow::Result<_>>()?))
    }
}

impl Servers {
    /// For the recorder of the next session.
    pub(crate) fn audiences(&self) -> Vec<Box<dyn Audience>> {
        self.0.iter().map(|server| server.audience()).collect()
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
    fn audience(&self) -> Box<dyn Audience> {
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
    fn audience(&self) -> Box<dyn Audience> {
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
