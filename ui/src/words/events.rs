//! Sentences for the events of the loop, for the log of a session.

use nima_devices::Standing;
use nima_machine::{
    messages::{Event, Fault},
    rig::{DeviceEvent, DeviceName},
};

use super::{Remedy as _, commands, device_name, loss_words, refused_because, scheduling_words, side_word, state_name};
use crate::language::{told, word};

/// `devices`: names of the rig's devices, in the order of its roster.
pub(crate) fn event(event: &Event, devices: &[DeviceName]) -> String {
    match *event {
        Event::StateChanged { side, from, to, .. } => {
            told!("{} arm: from {} to {}", "Arm {}: von {} zu {}", side_word(side), state_name(from), state_name(to))
        }
        Event::FaultRaised { side, fault, .. } => {
            let of = match fault {
                Fault::DeviceLost { device, .. } => told!(" of the {}", ", {}", name_of(device, devices)),
                _ => String::new(),
            };
            told!("{} arm: fault{of}: {}", "Arm {}: Störung{of}: {}", side_word(side), fault.cause())
        }
        Event::CommandRefused { side, command, why, .. } => {
            told!(
                "{} arm: refused: {}: {}",
                "Arm {}: abgelehnt: {}: {}",
                side_word(side),
                commands::command(command),
                refused_because(why)
            )
        }
        Event::Device(event) => device(&event, devices),
        Event::Scheduling(granted) => scheduling_words(granted)
            .unwrap_or_else(|| word("real-time scheduling granted", "Echtzeitpriorität gewährt").to_owned()),
    }
}

pub(super) fn device(event: &DeviceEvent, devices: &[DeviceName]) -> String {
    let standing = match event.standing {
        Standing::Closed => word("closed", "geschlossen"),
        Standing::Opening => word("is being opened", "wird geöffnet"),
        Standing::Connected => word("connected", "verbunden"),
        Standing::Lost(loss) => loss_words(loss),
    };
    format!("{}: {standing}", name_of(event.device, devices))
}

/// Name of a device by its index in the roster.
fn name_of(device: u8, devices: &[DeviceName]) -> String {
    devices
        .get(usize::from(device))
        .map_or_else(|| told!("device {device}", "Gerät {device}"), |name| device_name(*name))
}

#[cfg(test)]
mod tests {
    use nima_devices::Loss;
    use nima_machine::{
        config::RigConfig,
        rig::{SIDES, Side},
    };

    use nima_simulation::{Plan, scene::Scene};

    use super::*;

    #[test]
    fn the_names_stand_in_the_order_of_the_roster() {
        for name in ["emulated", "paper", "desk"] {
            let rig = RigConfig::load(name).unwrap();
            let names = rig.device_names();
            let scene = Scene::load("bimanual").unwrap();
            let plan = Plan { rig, scene, calibrations: Default::default(), engage: false };
            let roster = plan.assembly().unwrap().roster;
            assert_eq!(names.len(), roster.len(), "{name}: {names:?}");
            assert!(names.iter().zip(&roster).all(|(name, entry)| name.role == entry.role), "{name}: {names:?}");
        }
    }

    #[test]
    fn a_device_is_told_by_its_role_and_make() {
        let devices = RigConfig::load("paper").unwrap().device_names();
        let told = |place: u8| {
            let standing = Standing::Lost(Loss::Silent);
            event(&Event::Device(DeviceEvent { t_s: 0.0, device: place, standing, of_side: [true; SIDES] }), &devices)
        };
        assert_eq!(told(0), "right handle (Force Dimension): it sends no data");
        assert_eq!(told(6), "left sensor (Bota): it sends no data");
        assert_eq!(told(200), "device 200: it sends no data", "no such device");
        let fault = Fault::DeviceLost { device: 1, loss: Loss::Silent };
        let raised = event(&Event::FaultRaised { t_s: 0.0, side: Side::Right, fault }, &devices);
        assert_eq!(raised, "right arm: fault of the right arm (Kinova): A device was lost: it sends no data");
    }
}
