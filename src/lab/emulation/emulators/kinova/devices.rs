//! The devices within the arm, reached by the device id of a request: base, actuators, interconnect.
//!
//! Ids of the actuators: 1 to 7, as in the manufacturer's examples. The id of the interconnect is assumed to be the
//! next one; clients read it from `ReadAllDevices`. There is no gripper and no vision module.

use nima_devices::kinova::messages::{KinovaNumber, KinovaText, Rpc};
use prost::Message;

use super::{
    forms::{DeviceHandle, DeviceHandles, FormBits, FormNumbers, MacAddress, Offsets, Real},
    interconnect::Interconnect,
    interface::{
        ALL_DEVICES, AXIS_OFFSETS, AnswerPayload, BOOTLOADER_VERSION, DEVICE_DISCONNECTED, DEVICE_TYPE, InterfaceError,
        MAC_ADDRESS, PART_NUMBER, PART_REVISION, RUN_MODE, UNSUPPORTED_METHOD, UNSUPPORTED_SERVICE,
    },
    setting::KinovaSetting,
};

/// Firmware of every device: 2.5.2 in the manufacturer's encoding.
const FIRMWARE: u32 = 0x0205_0002;
/// Actuators up to this one are the large ones.
const LARGE_ACTUATORS: u8 = 4;
/// `ControlLoopSelection`: joint position, motor position, motor velocity and motor current.
const POSITION_LOOPS: u32 = 0x1 | 0x2 | 0x8 | 0x20;

/// `DeviceTypes`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum KinovaDeviceKind {
    Base = 1,
    Large = 3,
    Small = 4,
    Interconnect = 5,
}

pub(super) struct KinovaDevices {
    joints: u8,
    serial: String,
    actuators: Vec<Vec<KinovaSetting>>,
    interconnect: Interconnect,
}

impl KinovaDevices {
    pub(super) fn new(joints: u32, serial: String) -> Self {
        let joints = joints.min(32) as u8;
        let actuators = (0..joints).map(|_| actuator()).collect();
        Self { joints, serial, actuators, interconnect: Interconnect::new() }
    }

    fn kind(&self, device: u8) -> Result<KinovaDeviceKind, InterfaceError> {
        match device {
            0 => Ok(KinovaDeviceKind::Base),
            id if id <= self.joints.min(LARGE_ACTUATORS) => Ok(KinovaDeviceKind::Large),
            id if id <= self.joints => Ok(KinovaDeviceKind::Small),
            id if id == self.joints + 1 => Ok(KinovaDeviceKind::Interconnect),
            _ => Err(DEVICE_DISCONNECTED),
        }
    }

    /// Refuses a call of a service of the base that was sent to another device.
    pub(super) fn check_base(&self, device: u8) -> Result<(), InterfaceError> {
        if self.kind(device)? == KinovaDeviceKind::Base { Ok(()) } else { Err(UNSUPPORTED_SERVICE) }
    }

    /// `DeviceManager`.
    pub(super) fn manager(&self, rpc: Rpc) -> AnswerPayload {
        if rpc != ALL_DEVICES {
            return Err(UNSUPPORTED_METHOD);
        }
        let handle = |id: u8| {
            let kind = self.kind(id).ok()?;
            Some(DeviceHandle { kind: kind as u32, identifier: u32::from(id), order: u32::from(id) })
        };
        Ok(DeviceHandles { devices: (0..=self.joints + 1).filter_map(handle).collect() }.encode_to_vec())
    }

    /// `DeviceConfig` of any device.
    pub(super) fn config(&self, rpc: Rpc, device: u8) -> AnswerPayload {
        let kind = self.kind(device)?;
        let number = |value: u32| Ok(KinovaNumber { value }.encode_to_vec());
        let text = |value: String| Ok(KinovaText { value }.encode_to_vec());
        match rpc {
            RUN_MODE => number(0),
            DEVICE_TYPE => number(kind as u32),
            Rpc::FIRMWARE_VERSION | BOOTLOADER_VERSION => number(FIRMWARE),
            Rpc::MODEL_NUMBER => text("emulated".to_owned()),
            PART_NUMBER => text(format!("emulated-{}", kind as u32)),
            PART_REVISION => text("1".to_owned()),
            Rpc::SERIAL_NUMBER if kind == KinovaDeviceKind::Base => text(self.serial.clone()),
            Rpc::SERIAL_NUMBER => text(format!("{}-{device}", self.serial)),
            // Locally administered, not a manufacturer's address.
            MAC_ADDRESS => Ok(MacAddress { bytes: vec![2, 0, 0, 0, 0, device] }.encode_to_vec()),
            _ => Err(UNSUPPORTED_METHOD),
        }
    }

    /// `ActuatorConfig`, except the faults, which belong to the robot.
    pub(super) fn actuator(&mut self, rpc: Rpc, device: u8, payload: &[u8]) -> AnswerPayload {
        self.actuator_index(device)?;
        if rpc == AXIS_OFFSETS {
            return Ok(Offsets::default().encode_to_vec());
        }
        let settings = &mut self.actuators[usize::from(device) - 1];
        let answered = settings.iter_mut().find_map(|setting| setting.answer(rpc.function, payload));
        answered.unwrap_or(Err(UNSUPPORTED_METHOD))
    }

    /// Returns the joint that the device moves.
    pub(super) fn actuator_index(&self, device: u8) -> Result<usize, InterfaceError> {
        match self.kind(device)? {
            KinovaDeviceKind::Large | KinovaDeviceKind::Small => Ok(usize::from(device) - 1),
            KinovaDeviceKind::Base | KinovaDeviceKind::Interconnect => Err(UNSUPPORTED_SERVICE),
        }
    }

    /// `InterconnectConfig`.
    pub(super) fn interconnect(&mut self, rpc: Rpc, device: u8, payload: &[u8]) -> AnswerPayload {
        match self.kind(device)? {
            KinovaDeviceKind::Interconnect => self.interconnect.answer(rpc.function, payload),
            _ => Err(UNSUPPORTED_SERVICE),
        }
    }
}

/// Returns the settings of an actuator. The emulated joints follow positions in every control mode; in the
/// manufacturer's torque control example, these are the measured positions.
fn actuator() -> Vec<KinovaSetting> {
    let number = |value| KinovaNumber { value };
    vec![
        KinovaSetting::new(6, 7, &number(1), |mode: &KinovaNumber| (1..=6).contains(&mode.value)),
        KinovaSetting::new(8, 9, &FormBits { value: POSITION_LOOPS }, |loops| loops.value <= 0x7f),
        KinovaSetting::new(23, 22, &FormNumbers::default(), |channels: &FormNumbers| channels.values.len() <= 16),
        KinovaSetting::new(28, 24, &number(0), |mode: &KinovaNumber| mode.value <= 5),
        KinovaSetting::new(29, 26, &number(1), |on: &KinovaNumber| on.value <= 1),
        KinovaSetting::new(30, 5, &Real::default(), |offset: &Real| offset.value.is_finite()),
        KinovaSetting::new(32, 31, &number(0), |mode: &KinovaNumber| mode.value <= 2),
    ]
}
