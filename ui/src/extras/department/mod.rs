//! View and record the rigs of a department from other machines.

mod engine;

use std::net::SocketAddr;

use nima_endoscope::Reel;
use nima_session::outlet::Audience;
use nima_simulation::Plan;

use super::Extra;
use crate::{
    command::department::DepartmentCommand,
    telling::tell,
    watching::{Server, Show, Shown},
};

pub(super) struct Department;

impl Extra for Department {
    fn department(&self, command: &DepartmentCommand) -> Option<anyhow::Result<()>> {
        Some(engine::run(command))
    }

    fn server(&self, show: Show, at: SocketAddr) -> Option<anyhow::Result<Box<dyn Server>>> {
        (show == Show::Share).then(|| share_at(at))
    }
}

impl Server for nima_department::Share {
    fn audience(&self, _: &Plan, _: &Reel) -> Box<dyn Audience> {
        self.audience()
    }

    fn shown(&self) -> Shown {
        Shown { at: format!("{} ({})", self.address(), self.name()), watchers: self.watchers() }
    }
}

fn share_at(address: SocketAddr) -> anyhow::Result<Box<dyn Server>> {
    let own = engine::own_identity()?;
    let share = nima_department::Share::start(&own, address, !address.ip().is_loopback())?;
    tell(format_args!("nima: shared with department {} as {} at {}", own.department, share.name(), share.address()));
    Ok(Box::new(share))
}
