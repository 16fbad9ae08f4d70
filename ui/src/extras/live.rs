//! Live viewing with Foxglove and `PlotJuggler`.

use std::net::SocketAddr;

use nima_endoscope::FrameQueue;
use nima_screen::{recording::PROGRAM, stderr::print_line};
use nima_session::sinks::Audience;
use nima_simulation::SimulationPlan;
use nima_words::text::current_session::WatchStatus;

use super::Extra;
use crate::watching::{Show, WatchServer};

pub(super) struct LiveExtra;

impl Extra for LiveExtra {
    fn server(&self, show: Show, at: SocketAddr) -> Option<anyhow::Result<Box<dyn WatchServer>>> {
        (show == Show::Live).then(|| live_at(at))
    }
}

impl WatchServer for nima_live::LiveServer {
    fn audience(&self, _: &SimulationPlan, _: &FrameQueue) -> Box<dyn Audience> {
        self.audience()
    }

    fn shown(&self) -> WatchStatus {
        WatchStatus { at: format!("ws://{}", self.address()), watchers: self.viewers() }
    }
}

fn live_at(address: SocketAddr) -> anyhow::Result<Box<dyn WatchServer>> {
    let server = nima_live::LiveServer::start(address, PROGRAM)?;
    print_line(format_args!("nima: live at ws://{}: open a Foxglove WebSocket connection to it", server.address()));
    Ok(Box::new(server))
}
