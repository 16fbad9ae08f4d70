//! Sentences for the events of the loop, for the log of a session.

use nima_devices::Standing;
use nima_machine::{messages::Event, rig::DeviceEvent};

use super::{Remedy as _, commands, refused_because};

/// What happened.
pub(crate) fn event(event: &Event) -> String {
    match *event {
        Event::StateChanged { side, from, to, .. } => {
            format!("{} arm: from {} to {}", side.word(), from.word(), to.word())
        }
        Event::FaultRaised { side, fault, .. } => format!("{} arm: fault: {}", side.word(), fault.cause()),
        Event::CommandRefused { side, command, why, .. } => {
            format!("{} arm: refused: {}: {}", side.word(), commands::command(command), refused_because(why))
        }
        Event::Device(event) => device(&event),
        Event::Scheduling(granted) => {
            granted.advice().map_or_else(|| "real-time scheduling granted".to_owned(), str::to_owned)
        }
    }
}

/// What became of a device.
pub(super) fn device(event: &DeviceEvent) -> String {
    let standing = match event.standing {
        Standing::Closed => "closed",
        Standing::Opening => "is being opened",
        Standing::Connected => "connected",
        Standing::Lost(loss) => loss.cause(),
    };
    format!("device {}: {standing}", event.device)
}
