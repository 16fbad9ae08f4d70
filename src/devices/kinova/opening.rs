//! Opens a driver at a network address: logs in and requests the arm's identity and state. Blocks, so it runs on its
//! own thread.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::sleep,
    time::Duration,
};

use nima_core::kinematics::ArmModel;
use prost::Message;

use super::{
    driver::KinovaDriver,
    faults::KinovaFaults,
    feedback::KinovaFeedback,
    messages::{ArmState, KinovaNumber, KinovaText, Rpc, ServoingMode, sub},
    session::{KinovaFailure, KinovaLines},
    settings::KinovaSettings,
};
use crate::{ARM_JOINTS, ArmReading, Device, DeviceError, DeviceIdentity, same_serial};

/// A person's request to clear the faults of an arm. It is kept until the arm is next opened, because an arm in fault
/// is never connected.
#[derive(Clone, Debug, Default)]
pub struct FaultClearing(Arc<AtomicBool>);

impl FaultClearing {
    /// Requests that the next opening clears the faults, once.
    pub fn command(&self) {
        self.0.store(true, Ordering::Release);
    }
}

/// Time that the arm needs after clearing.
const CLEARED: Duration = Duration::from_millis(100);

/// Opens a Gen3 with seven joints. Faults are reported, not cleared.
///
/// # Errors
/// [`DeviceError`] if the arm cannot be reached, refuses the user, or is in a fault or another state in which it cannot be
/// used.
pub fn open(settings: &KinovaSettings) -> Result<KinovaDriver, DeviceError> {
    open_clearing(settings, &ArmModel::GEN3, &FaultClearing::default())
}

/// Opens an arm of this model, after clearing its faults if that was requested.
///
/// # Errors
/// The errors of [`open`].
pub fn open_clearing(
    settings: &KinovaSettings,
    model: &ArmModel,
    clearing: &FaultClearing,
) -> Result<KinovaDriver, DeviceError> {
    open_with(settings, model, Some(model.joints()), clearing)
}

/// Opens an arm with six or seven joints, for a test without a rig file.
///
/// # Errors
/// The errors of [`open`], except for the number of joints.
pub fn open_to_read(settings: &KinovaSettings) -> Result<impl Device<Reading = ArmReading> + use<>, DeviceError> {
    open_with(settings, &ArmModel::GEN3, None, &FaultClearing::default())
}

fn open_with(
    settings: &KinovaSettings,
    model: &ArmModel,
    joints: Option<usize>,
    clearing: &FaultClearing,
) -> Result<KinovaDriver, DeviceError> {
    settings.check()?;
    let mut lines = KinovaLines::connect(settings)?;
    lines.log_in(settings)?;
    let opened = prepare(&mut lines, settings, joints, clearing);
    match opened {
        Ok((identity, feedback)) => Ok(KinovaDriver::new(settings, model, lines, identity, &feedback)),
        Err(trouble) => {
            // Close the sessions, because the arm would otherwise keep them until they time out.
            super::driver::close_sessions(&mut lines);
            Err(trouble)
        }
    }
}

fn prepare(
    lines: &mut KinovaLines,
    settings: &KinovaSettings,
    expected: Option<usize>,
    clearing: &FaultClearing,
) -> Result<(DeviceIdentity, KinovaFeedback), DeviceError> {
    let joints = ask::<KinovaNumber>(lines, Rpc::ACTUATOR_COUNT)?.value as usize;
    let expected = expected.unwrap_or_else(|| joints.clamp(6, ARM_JOINTS));
    if joints != expected {
        let expected = format!("arm with {expected} joints");
        let found = format!("arm with {joints} joints");
        return Err(DeviceError::WrongProduct { place: lines.place.clone(), expected, found });
    }
    let identity = identity(lines)?;
    check_serial(settings, &identity, &lines.place)?;
    let mode: KinovaNumber = ask(lines, Rpc::GET_SERVOING_MODE)?;
    if mode.value != ServoingMode::Single as u32 {
        // A client that disconnected may have left the arm in low-level servoing.
        call(lines, Rpc::SET_SERVOING_MODE, &KinovaNumber { value: ServoingMode::Single as u32 })?;
    }
    if clearing.0.swap(false, Ordering::AcqRel) {
        call(lines, Rpc::CLEAR_FAULTS, &())?;
        sleep(CLEARED);
    }
    let state: KinovaNumber = ask(lines, Rpc::ARM_STATE)?;
    let state = ArmState(state.value);
    if state.is_unready() {
        let cure = "Wait until the arm has started, or stop its current action on its web page.".to_owned();
        return Err(DeviceError::NotReady { place: lines.place.clone(), mode: state.words().to_owned(), cure });
    }
    let feedback = first_feedback(lines, joints)?;
    let faults = KinovaFaults { in_fault: state == ArmState::IN_FAULT, ..KinovaFaults::of(&feedback) };
    if faults.any() {
        return Err(DeviceError::DeviceFault {
            place: lines.place.clone(),
            words: faults.to_string(),
            cure: "Remove the cause, make sure that the arm can move safely, then clear its faults by command."
                .to_owned(),
        });
    }
    Ok((identity, feedback))
}

fn check_serial(settings: &KinovaSettings, identity: &DeviceIdentity, place: &str) -> Result<(), DeviceError> {
    let Some(wanted) = settings.serial_number.as_ref().filter(|wanted| !same_serial(wanted, &identity.serial)) else {
        return Ok(());
    };
    let found = if identity.serial.is_empty() { "unknown" } else { &identity.serial };
    Err(DeviceError::OtherSerial { place: place.to_owned(), expected: wanted.clone(), found: found.to_owned() })
}

fn first_feedback(lines: &mut KinovaLines, joints: usize) -> Result<KinovaFeedback, DeviceError> {
    let answer = lines.ask_cyclic(Rpc::REFRESH_FEEDBACK, &());
    let payload = answer.map_err(|failure| failure.trouble(&lines.place, Rpc::REFRESH_FEEDBACK))?;
    let feedback = KinovaFeedback::decode(&payload).ok().filter(|report| report.is_finite() && report.count == joints);
    feedback.ok_or_else(|| KinovaFailure::Nonsense.trouble(&lines.place, Rpc::REFRESH_FEEDBACK))
}

/// Returns the identity of the arm; fields that the firmware does not report are empty.
fn identity(lines: &mut KinovaLines) -> Result<DeviceIdentity, DeviceError> {
    let known = |answer: Result<Vec<u8>, KinovaFailure>, place: &str, rpc| match answer {
        Ok(payload) => Ok(payload),
        Err(KinovaFailure::Refused(_, sub::UNSUPPORTED_METHOD | sub::UNSUPPORTED_SERVICE | 2)) => Ok(Vec::new()),
        Err(failure) => Err(failure.trouble(place, rpc)),
    };
    let mut report = [Rpc::MODEL_NUMBER, Rpc::SERIAL_NUMBER].map(|rpc| (rpc, String::new()));
    for (rpc, text) in &mut report {
        let payload = known(lines.ask(*rpc, &()), &lines.place, *rpc)?;
        *text = KinovaText::decode(payload.as_slice()).unwrap_or_default().value;
    }
    let payload = known(lines.ask(Rpc::FIRMWARE_VERSION, &()), &lines.place, Rpc::FIRMWARE_VERSION)?;
    let firmware = KinovaNumber::decode(payload.as_slice()).unwrap_or_default().value;
    let [(_, model), (_, serial)] = report;
    let product = format!("Kinova Gen3 {model}").trim_end().to_owned();
    Ok(DeviceIdentity { product, serial, firmware: format!("{firmware:#010x}") })
}

fn call(lines: &mut KinovaLines, rpc: Rpc, question: &impl Message) -> Result<Vec<u8>, DeviceError> {
    lines.ask(rpc, question).map_err(|failure| failure.trouble(&lines.place, rpc))
}

fn ask<T: Message + Default>(lines: &mut KinovaLines, rpc: Rpc) -> Result<T, DeviceError> {
    let payload = call(lines, rpc, &())?;
    T::decode(payload.as_slice()).map_err(|_| KinovaFailure::Nonsense.trouble(&lines.place, rpc))
}
