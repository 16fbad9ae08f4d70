//! Live viewing with Foxglove and `PlotJuggler`.

use std::net::SocketAddr;

use nima_endoscope::Reel;
use nima_session::outlet::Audience;
use nima_simulation::Plan;

use super::Extra;
use crate::{
    recording::PROGRAM,
    telling::tell,
    watching::{Server, Show, Shown},
};

pub(super) struct Live;

impl Extra for Live {
    fn server(&self, show: Show, at: SocketAddr) -> Option<anyhow::Result<Box<dyn Server>>> {
        (show == Show::Live).then(|| live_at(at))
    }
}

impl Server for nima_live::Server {
    fn audience(&self, _: &Plan, _: &Reel) -> Box<dyn Audience> {
        self.audience()
    }

    fn shown(&self) -> Shown {
        Shown { at: format!("ws://{}", self.address()), watchers: self.viewers() }
    }
}

fn live_at(address: SocketAddr) -> anyhow::Result<Box<dyn Server>> {
    let server = nima_live::Server::start(address, PROGRAM)?;
    tell(format_args!("nima: live at ws://{}: open a Foxglove WebSocket connection to it", server.address()));
    Ok(Box::new(server))
}
