//! Sentences for the events of the loop, for the log of a session.

use nima_devices::ConnectionState;
use nima_machine::{
    messages::{Event, Fault},
    rig::{DeviceEvent, DeviceName},
};

use super::{Remedy as _, commands, device_name, loss_text, refused_because, scheduling_text, side_word, state_name};
use crate::language::{text_format, word};

/// `devices`: names of the rig's devices, in the order of its roster.
pub fn event(event: &Event, devices: &[DeviceName]) -> String {
    match *event {
        Event::StateChanged { side, from, to, .. } => {
            text_format!(
                "{} arm: from {} to {}",
                "Arm {}: von {} zu {}",
                side_word(side),
                state_name(from),
                state_name(to)
            )
        }
        Event::FaultRaised { side, fault, .. } => {
            let of = match fault {
                Fault::DeviceLost { device, .. } => text_format!(" of the {}", ", {}", name_of(device, devices)),
                _ => String::new(),
            };
            text_format!("{} arm: fault{of}: {}", "Arm {}: Störung{of}: {}", side_word(side), fault.cause())
        }
        Event::CommandRefused { side, command, why, .. } => {
            text_format!(
                "{} arm: refused: {}: {}",
                "Arm {}: abgelehnt: {}: {}",
                side_word(side),
                commands::command(command),
                refused_because(why)
            )
        }
        Event::Device(event) => device(&event, devices),
        Event::Scheduling(granted) => scheduling_text(granted)
            .unwrap_or_else(|| word("real-time scheduling granted", "Echtzeitpriorität gewährt").to_owned()),
    }
}

pub(super) fn device(event: &DeviceEvent, devices: &[DeviceName]) -> String {
    let standing = match event.standing {
        ConnectionState::Closed => word("closed", "geschlossen"),
        ConnectionState::Opening => word("is being opened", "wird geöffnet"),
        ConnectionState::Connected => word("connected", "verbunden"),
        ConnectionState::Lost(loss) => loss_text(loss),
    };
    format!("{}: {standing}", name_of(event.device, devices))
}

/// Returns the name of a device by its index in the roster.
fn name_of(device: u8, devices: &[DeviceName]) -> String {
    devices
        .get(usize::from(device))
        .map_or_else(|| text_format!("device {device}", "Gerät {device}"), |name| device_name(*name))
}

#[cfg(test)]
mod tests {
    use nima_devices::Loss;
    use nima_machine::{
        config::RigConfig,
        rig::{SIDES, Side},
    };

    use nima_simulation::{SimulationPlan, scene::Scene};

    use super::*;

    #[test]
    fn the_names_stand_in_the_order_of_the_roster() {
        for name in ["emulated", "paper", "desk"] {
            let rig = RigConfig::load(name).unwrap();
            let names = rig.device_names();
            let scene = Scene::load("bimanual").unwrap();
            let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: false };
            let roster = plan.assembly().unwrap().roster;
            assert_eq!(names.len(), roster.len(), "{name}: {names:?}");
            assert!(names.iter().zip(&roster).all(|(name, entry)| name.role == entry.role), "{name}: {names:?}");
        }
    }

    #[test]
    fn a_device_is_told_by_its_role_and_make() {
        let devices = RigConfig::load("paper").unwrap().device_names();
        let report = |place: u8| {
            let standing = ConnectionState::Lost(Loss::Silent);
            event(&Event::Device(DeviceEvent { t_s: 0.0, device: place, standing, of_side: [true; SIDES] }), &devices)
        };
        assert_eq!(report(0), "right handle (Force Dimension): it sends no data");
        assert_eq!(report(6), "left sensor (Bota): it sends no data");
        assert_eq!(report(200), "device 200: it sends no data", "no such device");
        let fault = Fault::DeviceLost { device: 1, loss: Loss::Silent };
        let raised = event(&Event::FaultRaised { t_s: 0.0, side: Side::Right, fault }, &devices);
        assert_eq!(raised, "right arm: fault of the right arm (Kinova): A device was lost: it sends no data");
    }
}
