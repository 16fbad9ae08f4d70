//! Assigns devices to parts by the serial numbers in the rig file and, without a number in the file, by those of the
//! last passed ready check. A device that answers at the address of another part is refused and reported as swapped
//! with that part.

use std::sync::{
    Arc,
    atomic::{AtomicU8, Ordering},
};

use nima_devices::{Device, DeviceError, same_serial};
use nima_recording::store::ReadyRecord;

use super::{
    AwaitedDevice, EngageBlocker, PartKind, RigPart, RigSettings, SIDES, Side, SideSwap, doubles::ReportedSerials,
};

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CheckedDevices {
    date: String,
    /// Serial numbers of the parts; parts whose device reports no serial number are omitted.
    serials: Vec<(RigPart, String)>,
}

impl CheckedDevices {
    pub fn of(record: &ReadyRecord) -> Self {
        let part = |name: &str| RigPart::ALL.into_iter().find(|part| part.name() == name);
        let report = record.devices.iter().filter(|device| !device.serial.trim().is_empty());
        let serials = report.filter_map(|device| Some((part(&device.name)?, device.serial.clone()))).collect();
        Self { date: record.date.clone(), serials }
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct DeviceIdentities {
    has_both_sides: bool,
    /// Serial numbers from the rig file.
    named: Vec<(RigPart, String)>,
    checked: CheckedDevices,
    /// The servos of each side, for the real-time thread: force and motion do not need them, but must not begin while
    /// they belong to the other side.
    servos: [Arc<AtomicU8>; SIDES],
    reported: ReportedSerials,
}

/// The servos have not been opened yet; are connected or missing; or belong to the other side.
/// Numbers of an atomic: the driver's thread stores them, the loop reads them.
const UNASKED: u8 = 0;
const ASKED: u8 = 1;
const EXCHANGED: u8 = 2;

/// Objection of a side's servos to an engagement.
#[derive(Clone, Debug)]
pub(super) struct ServoObjections(Arc<AtomicU8>);

impl ServoObjections {
    pub(super) fn obstacle(&self) -> Option<EngageBlocker> {
        match self.0.load(Ordering::Acquire) {
            UNASKED => Some(EngageBlocker::Waiting(AwaitedDevice::Servos)),
            EXCHANGED => Some(EngageBlocker::Exchanged(SideSwap::Servos)),
            _ => None,
        }
    }
}

fn serial_of(serials: &[(RigPart, String)], part: RigPart) -> Option<&str> {
    serials.iter().find(|(known, _)| *known == part).map(|(_, serial)| serial.as_str())
}

impl DeviceIdentities {
    pub(super) fn of(settings: &RigSettings) -> Self {
        let has_both_sides = settings.right.is_some() && settings.left.is_some();
        let named = |part: RigPart| Some((part, settings.serial(part)?));
        Self {
            has_both_sides,
            named: RigPart::ALL.into_iter().filter_map(named).collect(),
            checked: settings.checked.clone().unwrap_or_default(),
            servos: Default::default(),
            reported: ReportedSerials::default(),
        }
    }

    pub(super) fn servos_of(&self, side: Side) -> ServoObjections {
        ServoObjections(Arc::clone(&self.servos[side.index()]))
    }

    pub(super) const fn has_both_sides(&self) -> bool {
        self.has_both_sides
    }

    /// Returns the other part to which a device belongs that answers as this part with this serial number, and the date
    /// of the ready check from which this is known; `None` if it belongs to this part.
    fn whose(&self, part: RigPart, serial: &str) -> Option<(RigPart, Option<&str>)> {
        let is_it = |known: Option<&str>| known.is_some_and(|known| same_serial(known, serial));
        let others = || RigPart::ALL.into_iter().filter(|other| *other != part && other.kind() == part.kind());
        // A number in the rig file is the most certain one; the last check counts only for a part without it.
        if is_it(serial_of(&self.named, part)) {
            return None;
        }
        if let Some(other) = others().find(|other| is_it(serial_of(&self.named, *other))) {
            return Some((other, None));
        }
        let by_check = |part: RigPart| serial_of(&self.checked.serials, part);
        if serial_of(&self.named, part).is_some() || is_it(by_check(part)) {
            return None;
        }
        let other = others().find(|other| is_it(by_check(*other)))?;
        Some((other, Some(&self.checked.date)))
    }

    pub(super) const fn reported(&self) -> &ReportedSerials {
        &self.reported
    }

    /// Opens the device of this part and accepts it unless it belongs to another part; reports that part also if the
    /// driver has refused the serial number.
    pub(super) fn admit<D: Device>(
        &self,
        part: RigPart,
        open: impl FnOnce() -> Result<D, DeviceError>,
    ) -> Result<D, DeviceError> {
        self.reported.forget(part);
        let admitted = self.identified(part, open());
        if let Ok(device) = &admitted {
            self.reported.report(part, &device.identity().serial);
        }
        if let RigPart::Servos(side) = part {
            let known = if matches!(admitted, Err(DeviceError::Exchanged { .. })) { EXCHANGED } else { ASKED };
            self.servos[side.index()].store(known, Ordering::Release);
        }
        admitted
    }

    fn identified<D: Device>(&self, part: RigPart, opened: Result<D, DeviceError>) -> Result<D, DeviceError> {
        let serial = match &opened {
            Ok(device) => device.about().1.serial.clone(),
            Err(DeviceError::OtherSerial { found, .. }) => found.clone(),
            Err(_) => return opened,
        };
        match self.whose(part, &serial) {
            None => opened,
            Some((other, checked)) => Err(DeviceError::Exchanged {
                part: part.name(),
                other: other.name(),
                serial: serial.into(),
                checked: checked.map(Into::into),
            }),
        }
    }
}

impl RigSettings {
    /// Returns whether the file distinguishes right from left for every device and marker in the path of force and
    /// motion: by serial numbers, the hands of the handles, ids of servos, and the hand-eye calibration. With one arm
    /// nothing can be swapped.
    pub(crate) fn names_sides(&self) -> bool {
        let (Some(right), Some(left)) = (&self.right, &self.left) else { return true };
        let is_named = |kind: PartKind| {
            Side::ALL.into_iter().all(|side| kind.of(side).is_some_and(|part| self.serial(part).is_some()))
        };
        let arms = [right, left].into_iter().all(|set| set.arm.is_simulated()) || is_named(PartKind::Arm);
        let hands = right.handle.for_hand_of(Side::Right).hand() != left.handle.for_hand_of(Side::Left).hand();
        let markers = self.endoscope.is_none() || right.hand_eye().is_some() && left.hand_eye().is_some();
        hands && arms && markers && is_named(PartKind::Handle) && is_named(PartKind::Sensor)
    }

    /// Returns the serial number of a part in the rig file, or the ids of servos.
    pub(super) fn serial(&self, part: RigPart) -> Option<String> {
        let set = part.side().and_then(|side| self.arm(side));
        match part {
            RigPart::Handle(_) => set?.handle.serial(),
            RigPart::Arm(_) => set?.arm.serial(),
            RigPart::Sensor(_) => set?.sensor.serial(),
            RigPart::Servos(_) => set?.servos.as_ref().map(nima_devices::dynamixel::DynamixelSettings::ids_text),
            RigPart::TissueSensor => self.tissue_sensor.as_ref()?.serial(),
            RigPart::Tracker | RigPart::Pedal => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::RigConfig;

    fn known(change: impl FnOnce(&mut RigSettings)) -> DeviceIdentities {
        let mut settings = RigConfig::load("paper").unwrap().devices.unwrap();
        change(&mut settings);
        DeviceIdentities::of(&settings)
    }

    fn checked() -> CheckedDevices {
        let serials = [
            (RigPart::Sensor(Side::Right), "SN000853"),
            (RigPart::Sensor(Side::Left), "SN000854"),
            (RigPart::TissueSensor, "SN000855"),
            (RigPart::Arm(Side::Right), "KP-1"),
            (RigPart::Arm(Side::Left), "KP-2"),
        ];
        let serials = serials.map(|(part, serial)| (part, serial.to_owned())).into();
        CheckedDevices { date: "2026-08-21T10:20:30Z".to_owned(), serials }
    }

    const SENSOR: RigPart = RigPart::Sensor(Side::Right);

    #[test]
    fn a_ready_check_tells_right_from_left_where_the_file_is_silent() {
        let known = known(|settings| settings.checked = Some(checked()));
        let date = Some("2026-08-21T10:20:30Z");
        assert_eq!(known.whose(SENSOR, "853"), None);
        assert_eq!(known.whose(SENSOR, "854"), Some((RigPart::Sensor(Side::Left), date)));
        assert_eq!(known.whose(SENSOR, "855"), Some((RigPart::TissueSensor, date)));
        assert_eq!(known.whose(SENSOR, "856"), None, "a new sensor belongs to no part");
        assert_eq!(known.whose(SENSOR, ""), None);
        assert_eq!(known.whose(RigPart::Arm(Side::Left), "KP-1"), Some((RigPart::Arm(Side::Right), date)));
        assert_eq!(known.whose(RigPart::Handle(Side::Left), "853"), None, "of another kind");
    }

    #[test]
    fn what_the_file_names_counts_more_than_a_check() {
        let name = |settings: &mut RigSettings, serial: &str| {
            let right = settings.right.as_mut().unwrap().sensor.bota_mut().unwrap();
            right.serial_number = Some(serial.to_owned());
        };
        let moved = known(|settings| {
            settings.checked = Some(checked());
            name(settings, "854");
        });
        assert_eq!(moved.whose(SENSOR, "SN000854"), None, "the rig file was changed on purpose");
        assert_eq!(moved.whose(RigPart::Sensor(Side::Left), "854"), Some((SENSOR, None)));
        let without_check = known(|settings| name(settings, "853"));
        assert_eq!(without_check.whose(RigPart::TissueSensor, "853"), Some((SENSOR, None)));
    }

    #[test]
    fn a_rig_of_real_devices_without_their_numbers_requires_the_check() {
        let mut rig = RigConfig::load("paper").unwrap();
        assert!(rig.requires_check());
        let one_arm = |rig: &RigConfig| {
            let mut rig = rig.clone();
            rig.devices.as_mut().unwrap().left = None;
            rig
        };
        assert!(!one_arm(&rig).requires_check(), "there is nothing to exchange");
        let devices = rig.devices.as_mut().unwrap();
        for (set, serial) in [&mut devices.right, &mut devices.left].into_iter().flatten().zip(["1", "2"]) {
            set.arm.kinova_mut().unwrap().serial_number = Some(serial.to_owned());
            set.sensor.bota_mut().unwrap().serial_number = Some(serial.to_owned());
        }
        assert!(!rig.requires_check());
        let left = rig.devices.as_mut().unwrap().left.as_mut().unwrap();
        left.handle.force_dimension_mut().unwrap().hand = Some(Side::Right);
        assert!(rig.requires_check(), "two handles for the same hand");
        assert!(
            !RigConfig::load("emulated").unwrap().requires_check()
                && !RigConfig::load("simulated").unwrap().requires_check()
        );
    }

    /// An open device with a serial number.
    struct Numbered(nima_devices::DeviceIdentity, nima_devices::Health);

    impl Device for Numbered {
        type Reading = ();

        fn poll(&mut self, _: f64) -> Option<nima_devices::TimedReading<()>> {
            None
        }

        fn about(&self) -> (&nima_devices::Health, &nima_devices::DeviceIdentity) {
            (&self.1, &self.0)
        }
    }

    #[test]
    fn two_arms_that_report_one_number_object_to_an_engagement() {
        let known = known(|_| ());
        let open = |serial: &str| {
            let identity = nima_devices::DeviceIdentity { serial: serial.to_owned(), ..Default::default() };
            Ok(Numbered(identity, nima_devices::Health::default()))
        };
        let [right, left] = Side::ALL.map(RigPart::Arm);
        assert!(known.admit(right, || open("PJ1")).is_ok() && known.admit(left, || open("PJ1")).is_ok());
        assert_eq!(known.reported().obstacle(), Some(EngageBlocker::OneArm));
        assert!(known.admit(left, || open("PJ2")).is_ok());
        assert_eq!(known.reported().obstacle(), None, "its address was corrected");
    }
}
