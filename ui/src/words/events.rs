//! Sentences for the events of the loop, for the log of a session.

use nima_devices::Standing;
use nima_machine::messages::Event;

use super::{Remedy as _, refused_because};

/// What happened.
pub(crate) fn event(event: &Event) -> String {
    match *event {
        Event::StateChanged { side, from, to, .. } => {
            format!("{} arm: from {} to {}", side.word(), from.word(), to.word())
        }
        Event::FaultRaised { side, fault, .. } => format!("{} arm: fault: {}", side.word(), fault.cause()),
        Event::CommandRefused { side, command, why, .. } => {
            format!("{} arm: refused {command:?}: {}", side.word(), refused_because(why))
        }
        Event::Device(device) => {
            let standing = match device.standing {
                Standing::Closed => "closed",
                Standing::Opening => "is being opened",
                Standing::Connected => "connected",
                Standing::Lost(loss) => loss.cause(),
            };
            format!("device {}: {standing}", device.device)
        }
        Event::Scheduling(granted) => {
            granted.advice().map_or_else(|| "real-time scheduling granted".to_owned(), str::to_owned)
        }
    }
}
