//! Opens and configures a device with a loaded library; every failure has its cause.

use nima_core::Side;

use super::{
    sdk::{OpenDevice, Sdk},
    settings::ForceDimensionSettings,
    status::{ForceDimensionKind, ForceDimensionStatus, SdkError, fault_text},
};
use crate::{DeviceError, DeviceIdentity, Loss};

/// udev rule: every user of the computer may use USB devices of this manufacturer.
pub(super) const UDEV: &str = r#"SUBSYSTEM=="usb", ATTR{idVendor}=="1451", MODE="0666""#;

/// A device that is open and configured, but not read yet.
pub(super) struct OpenHandle {
    pub(super) device: OpenDevice,
    pub(super) identity: DeviceIdentity,
    pub(super) left_handed: bool,
    pub(super) velocity_threshold: Option<u32>,
}

pub(super) fn place(settings: &ForceDimensionSettings) -> String {
    match settings.serial {
        Some(serial) => format!("omega.7 with serial number {serial}"),
        None => "omega.7".to_owned(),
    }
}

pub(super) fn open(sdk: &'static Sdk, settings: &ForceDimensionSettings) -> Result<OpenHandle, DeviceError> {
    let place = place(settings);
    let device = sdk.open(settings.serial).map_err(|error| not_opened(sdk, &place, error))?;
    let refused = |command: &str, error: SdkError| DeviceError::Refused {
        place: place.clone(),
        command: command.to_owned(),
        answer: error.words().to_owned(),
    };
    let kind = ForceDimensionKind::of(device.kind().map_err(|error| refused("to report its type", error))?);
    let ForceDimensionKind::Omega7 { left_handed } = kind else {
        return Err(DeviceError::WrongProduct { place, expected: "omega.7".to_owned(), found: kind.name() });
    };
    let serial = device.serial().map_err(|error| refused("to report its serial number", error))?;
    if settings.serial.is_some_and(|wanted| wanted != serial) {
        let found = format!("omega.7 with serial number {serial}");
        return Err(DeviceError::WrongProduct { expected: place.clone(), place, found });
    }
    let hand = if left_handed { Side::Left } else { Side::Right };
    if settings.hand.is_some_and(|wanted| wanted != hand) {
        return Err(DeviceError::OtherHand { place, hand: hand.word().to_owned() });
    }
    check(&place, &device.status().map_err(|error| refused("to report its status", error))?)?;
    // Brake first: a handle must not push while it is being configured.
    device.stop().map_err(|error| refused("to stop", error))?;
    device.set_watchdog(settings.watchdog_steps()).map_err(|error| refused("the watchdog", error))?;
    let optional = |command: &str, outcome: Result<_, SdkError>| match outcome {
        Err(error) if !error.is_missing_feature() => Err(refused(command, error)),
        _ => Ok(()),
    };
    optional("the maximum force", device.set_force_max(settings.force_max_n))?;
    optional("gravity compensation", device.set_gravity_compensation(settings.gravity_compensation))?;
    optional("the gripper as a button", device.emulate_button(settings.gripper_is_a_button))?;
    let identity = DeviceIdentity::of_handle(kind, device.name(), Some(serial), device.firmware().ok());
    let velocity_threshold = device.velocity_threshold().ok();
    Ok(OpenHandle { device, identity, left_handed, velocity_threshold })
}

/// Maximum number of handles in a search.
const HANDLES_MAX: usize = 8;

/// Returns serial number and identity of every handle that is not open in another program. Each is opened for a moment,
/// with its brakes on; the serial number in `settings` is ignored, its library and its emulator are used.
///
/// # Errors
/// [`DeviceError`] if the library is missing or unusable.
pub fn attached(settings: &ForceDimensionSettings) -> Result<Vec<(u16, DeviceIdentity)>, DeviceError> {
    let sdk = super::library::of(settings)?;
    let look = move || {
        super::sdk::prepare_thread();
        // All stay open until the last one is found, because the library opens any free handle.
        let mut open = Vec::new();
        while open.len() < HANDLES_MAX
            && let Ok(device) = sdk.open(None)
        {
            open.push(device);
        }
        let report = |device: &OpenDevice| {
            let kind = ForceDimensionKind::of(device.kind().ok()?);
            let serial = device.serial().ok()?;
            Some((serial, DeviceIdentity::of_handle(kind, device.name(), Some(serial), device.firmware().ok())))
        };
        open.iter().filter_map(report).collect()
    };
    let failed = || DeviceError::Other { place: place(settings), reason: "the SDK's thread failed".to_owned() };
    let thread = std::thread::Builder::new().name("handles".to_owned()).spawn(look).map_err(|_| failed())?;
    thread.join().map_err(|_| failed())
}

fn check(place: &str, status: &ForceDimensionStatus) -> Result<(), DeviceError> {
    if status.reset {
        let place = place.to_owned();
        let mode = "reset (calibration)".to_owned();
        let cure = "Put the handle into its rest position, press the button on the base, then wait.".to_owned();
        return Err(DeviceError::NotReady { place, mode, cure });
    }
    status.loss().map_or(Ok(()), |loss| Err(lost_at_once(place, loss)))
}

/// Returns the error for a device that was lost before its first reading.
pub(super) fn lost_at_once(place: &str, loss: Loss) -> DeviceError {
    let place = place.to_owned();
    match loss {
        Loss::Disconnected => DeviceError::Absent { place },
        Loss::Silent => DeviceError::Silent { place },
        Loss::Corrupt => DeviceError::Other { place, reason: "communication over USB fails".to_owned() },
        Loss::Implausible => DeviceError::DeviceFault {
            place,
            words: "it reports impossible positions".to_owned(),
            cure: "Switch it off and on, and calibrate it with the manufacturer's program.".to_owned(),
        },
        Loss::Device { code } => DeviceError::DeviceFault {
            place,
            words: format!("{} (code {code})", fault_text(code)),
            cure: "Switch it off and on; if this persists, calibrate it with the manufacturer's program.".to_owned(),
        },
    }
}

fn not_opened(sdk: &Sdk, place: &str, error: SdkError) -> DeviceError {
    let place = place.to_owned();
    match error {
        SdkError::IN_USE => DeviceError::Busy { place },
        SdkError::NO_DEVICE | SdkError::NO_DRIVER if is_on_usb() && sdk.device_count() <= 0 => {
            DeviceError::Permission { place, udev: UDEV.to_owned() }
        }
        SdkError::NO_DEVICE | SdkError::NO_DRIVER => {
            DeviceError::Absent { place: format!("{place} ({} attached)", sdk.device_count().max(0)) }
        }
        SdkError::TIMED_OUT => DeviceError::Silent { place },
        error => {
            DeviceError::Other { place, reason: format!("{} (error {} of {})", error.words(), error.0, sdk.path()) }
        }
    }
}

/// Returns whether a device of this manufacturer is connected by USB. Linux lists all devices, even those that the user
/// may not open. Always false on other systems.
fn is_on_usb() -> bool {
    let Ok(devices) = std::fs::read_dir("/sys/bus/usb/devices") else { return false };
    let vendor = |entry: std::fs::DirEntry| std::fs::read_to_string(entry.path().join("idVendor"));
    devices.flatten().filter_map(|entry| vendor(entry).ok()).any(|vendor| vendor.trim() == "1451")
}
