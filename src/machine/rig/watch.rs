//! Detects that devices connect or are lost.

use nima_devices::ConnectionState;

use crate::rig::{DEVICES_MAX, DeviceEvent, SIDES};

/// Capacity for pending events. Further events are dropped; the published health still shows the state of every device.
const WAITING: usize = 32;

/// Last known state of every device, and the events not yet reported.
#[derive(Debug)]
pub struct DeviceWatch {
    before: [ConnectionState; DEVICES_MAX],
    events: [Option<DeviceEvent>; WAITING],
    first: usize,
    count: usize,
}

impl Default for DeviceWatch {
    fn default() -> Self {
        Self { before: [ConnectionState::Opening; DEVICES_MAX], events: [None; WAITING], first: 0, count: 0 }
    }
}

impl DeviceWatch {
    /// Compares the state of a device with the last known one.
    pub fn look(&mut self, t_s: f64, device: usize, standing: ConnectionState, of_side: [bool; SIDES]) {
        let Some(before) = self.before.get_mut(device) else { return };
        if *before == standing {
            return;
        }
        *before = standing;
        if self.count < WAITING {
            let event = DeviceEvent { t_s, device: device as u8, standing, of_side };
            self.events[(self.first + self.count) % WAITING] = Some(event);
            self.count += 1;
        }
    }

    pub const fn take(&mut self) -> Option<DeviceEvent> {
        if self.count == 0 {
            return None;
        }
        let event = self.events[self.first].take();
        self.first = (self.first + 1) % WAITING;
        self.count -= 1;
        event
    }
}

#[cfg(test)]
mod tests {
    use nima_devices::Loss;

    use super::*;

    #[test]
    fn each_change_is_told_once_and_in_order() {
        let mut watch = DeviceWatch::default();
        for round in 0..100 {
            let t_s = f64::from(round);
            watch.look(t_s, 3, ConnectionState::Connected, [true, false]);
            watch.look(t_s, 3, ConnectionState::Connected, [true, false]);
            watch.look(t_s, 3, ConnectionState::Lost(Loss::Silent), [true, false]);
            assert_eq!(watch.take().map(|event| event.standing), Some(ConnectionState::Connected));
            assert_eq!(watch.take().map(|event| event.standing), Some(ConnectionState::Lost(Loss::Silent)));
            assert_eq!(watch.take(), None);
        }
        watch.look(0.0, DEVICES_MAX, ConnectionState::Connected, [true, true]);
        assert_eq!(watch.take(), None, "there is no such device");
    }
}
