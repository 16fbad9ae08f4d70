//! `--live`: others watch while it happens. In programs that were built with the feature `live`.

use std::net::SocketAddr;

use clap::Args;

#[cfg(feature = "live")]
pub(crate) use nima_live::Server;

/// A server in a program without one.
#[cfg(not(feature = "live"))]
#[derive(Debug)]
pub(crate) enum Server {}

#[cfg(not(feature = "live"))]
impl Server {
    pub(crate) fn audience(&self) -> Box<dyn nima_session::outlet::Audience> {
        match *self {}
    }

    pub(crate) fn viewers(&self) -> usize {
        match *self {}
    }

    pub(crate) fn address(&self) -> SocketAddr {
        match *self {}
    }
}

const HELP: &str =
    "Let Foxglove and PlotJuggler watch at this address (without one: 127.0.0.1:8765, from this computer only)";

/// Who may watch.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct Live {
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "127.0.0.1:8765", help = HELP)]
    live: Option<SocketAddr>,
}

impl Live {
    /// Starts the server, if one is asked for.
    pub(crate) fn start(&self) -> anyhow::Result<Option<Server>> {
        self.live.map(server_at).transpose()
    }
}

#[cfg(feature = "live")]
fn server_at(address: SocketAddr) -> anyhow::Result<Server> {
    let server = Server::start(address, crate::recording::PROGRAM)?;
    crate::telling::tell(format_args!(
        "nima: live at ws://{}: open a Foxglove WebSocket connection to it",
        server.address()
    ));
    Ok(server)
}

#[cfg(not(feature = "live"))]
fn server_at(_: SocketAddr) -> anyhow::Result<Server> {
    anyhow::bail!(
        "this program was built without live viewing; build it with `cargo build --release --locked -p nima-console --features live`"
    )
}
