//! View and record the rigs of a department from other machines.

mod engine;

use std::net::SocketAddr;

use nima_endoscope::FrameQueue;
use nima_screen::stderr::print_line;
use nima_session::sinks::Audience;
use nima_simulation::SimulationPlan;
use nima_words::text::current_session::WatchStatus;

use super::Extra;
use crate::{
    command::department::DepartmentCommand,
    watching::{Show, WatchServer},
};

pub(super) struct Department;

impl Extra for Department {
    fn department(&self, command: &DepartmentCommand) -> Option<anyhow::Result<()>> {
        Some(engine::run(command))
    }

    fn server(&self, show: Show, at: SocketAddr) -> Option<anyhow::Result<Box<dyn WatchServer>>> {
        (show == Show::Share).then(|| fraction_at(at))
    }
}

impl WatchServer for nima_department::SharedRig {
    fn audience(&self, _: &SimulationPlan, _: &FrameQueue) -> Box<dyn Audience> {
        self.audience()
    }

    fn shown(&self) -> WatchStatus {
        WatchStatus { at: format!("{} ({})", self.address(), self.name()), watchers: self.watchers() }
    }
}

fn fraction_at(address: SocketAddr) -> anyhow::Result<Box<dyn WatchServer>> {
    let own = engine::own_identity()?;
    let share = nima_department::SharedRig::start(&own, address, !address.ip().is_loopback())?;
    print_line(format_args!(
        "nima: shared with department {} as {} at {}",
        own.department,
        share.name(),
        share.address()
    ));
    Ok(Box::new(share))
}
