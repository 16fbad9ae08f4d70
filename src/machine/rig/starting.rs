//! Starts opening the devices of one side, each in a separate slot.

use nima_devices::{ClearFaults, Device, DeviceSlot, SERVOS, dynamixel};

use super::{RigPart, Roster, device_identity::DeviceIdentities, devices::enrol, makes::Opener};

/// Starts opening a device and adds it to the roster; `attach` is called with the device once it is open.
pub(super) fn start<P>(
    part: RigPart,
    opener: Opener<P>,
    known: &DeviceIdentities,
    roster: &mut Roster,
    attach: impl Fn(&P) + Send + 'static,
) -> std::io::Result<DeviceSlot<P>>
where
    P: Device + 'static,
{
    let Opener { driver, mut open, clear_faults } = opener;
    let known = known.clone();
    let slot = DeviceSlot::start(part.name(), move || known.admit(part, &mut open).inspect(&attach))?;
    enrol(roster, part, driver, &slot);
    if let Some(entry) = roster.last_mut() {
        entry.clear_faults = clear_faults;
    }
    Ok(slot)
}

pub(super) fn servos_opener(settings: dynamixel::DynamixelSettings) -> Opener<dynamixel::DynamixelDriver> {
    let driver = format!("DYNAMIXEL servos, {}", settings.port);
    let reboots = dynamixel::Reboots::default();
    let of_opening = reboots.clone();
    Opener {
        driver,
        open: Box::new(move || dynamixel::open_with(&settings, &of_opening)),
        clear_faults: Some(ClearFaults::by(move || (0..SERVOS).for_each(|servo| reboots.ask(servo)))),
    }
}
