//! Finds the program of an external device: the first one that sends a valid datagram and receives the answer.

use std::{
    thread::sleep,
    time::{Duration, Instant, SystemTime},
};

use super::{
    codec::{self, BYTES_MAX, Datagram, ExternalMessage, NoDatagram, VERSION},
    line::{ExternalLine, command_of, is_watched},
    settings::{ExternalKind, ExternalSettings},
};
use crate::{
    DeviceError, DeviceIdentity, same_serial,
    transport::{TransportDatagrams, Udp},
};

/// Time limit for the first datagram, and then for one that shows that our answer was received.
const FIRST_MAX: Duration = Duration::from_millis(300);
const ANSWER_MAX: Duration = Duration::from_millis(200);
// Half a period of a 1 kHz device.
const NAP: Duration = Duration::from_micros(500);

/// Listens at the address of the rig file. `joints`: of the arm, `None` for any number. May take half a second.
pub(super) fn open(
    kind: ExternalKind,
    settings: &ExternalSettings,
    joints: Option<usize>,
) -> Result<ExternalLine, DeviceError> {
    settings.check(kind)?;
    let udp = Udp::listen(settings.listen, settings.peer())?;
    meet(Box::new(udp), kind, settings, joints, begins_us())
}

/// Returns the start of our time stamps: after all of an earlier opening, which the device's program may still
/// remember.
fn begins_us() -> u64 {
    let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    since_1970.map_or(0, |time| time.as_micros() as u64)
}

pub(super) fn meet(
    mut datagrams: Box<dyn TransportDatagrams>,
    kind: ExternalKind,
    settings: &ExternalSettings,
    joints: Option<usize>,
    begins_us: u64,
) -> Result<ExternalLine, DeviceError> {
    let place = settings.place();
    let first = first_of(&mut *datagrams, kind, settings, joints)?;
    datagrams.keep_to_sender();
    let identity = DeviceIdentity {
        product: codec::name(&first.product),
        serial: codec::name(&first.serial),
        firmware: format!("protocol {VERSION}"),
    };
    if let Some(expected) = &settings.serial_number
        && !same_serial(expected, &identity.serial)
    {
        let found = if identity.serial.is_empty() { "unknown".to_owned() } else { identity.serial };
        return Err(DeviceError::OtherSerial { place, expected: expected.clone(), found });
    }
    let watchdog_us = (settings.watchdog_ms * 1e3) as u32;
    if kind.is_driven() && !is_watched(&first, watchdog_us) {
        return Err(DeviceError::DeviceFault {
            place,
            words: format!("its watchdog time is {} ms", f64::from(first.watchdog_us) * 1e-3),
            cure: format!(
                "Configure the device program to switch the device off after {} ms without a command and to report that time, or raise watchdog_ms in the rig file.",
                settings.watchdog_ms
            ),
        });
    }
    let met = shake_hands(&mut *datagrams, &first, watchdog_us, begins_us).ok_or(DeviceError::Unheard { place })?;
    Ok(ExternalLine::new(datagrams, kind, settings, &met, identity))
}

fn first_of(
    datagrams: &mut dyn TransportDatagrams,
    kind: ExternalKind,
    settings: &ExternalSettings,
    joints: Option<usize>,
) -> Result<Datagram, DeviceError> {
    let place = settings.place();
    let begin = Instant::now();
    let mut buffer = [0; BYTES_MAX + 1];
    let mut trouble = DeviceError::NobodySends { place: place.clone() };
    let wrong = |found: String| DeviceError::WrongProduct {
        place: place.clone(),
        expected: format!("program for {} (protocol {VERSION})", kind.word()),
        found,
    };
    let wanted = |datagram: &Datagram| joints.filter(|joints| datagram.joints != *joints);
    while begin.elapsed() < FIRST_MAX {
        let lost = |loss: crate::Loss| DeviceError::Other { place: place.clone(), reason: loss.cause().to_owned() };
        let Some(count) = datagrams.receive(&mut buffer).map_err(lost)? else {
            sleep(NAP);
            continue;
        };
        trouble = match Datagram::decode(&buffer[..count]) {
            Ok(datagram) if datagram.message == ExternalMessage::Reading(kind) => match wanted(&datagram) {
                None => return Ok(datagram),
                Some(joints) => DeviceError::WrongProduct {
                    place: place.clone(),
                    expected: format!("program for an arm with {joints} joints"),
                    found: format!("program for an arm with {} joints", datagram.joints),
                },
            },
            Ok(Datagram { message: ExternalMessage::Reading(found), .. }) => {
                wrong(format!("program for {}", found.word()))
            }
            Ok(_) => wrong("program that sends commands".to_owned()),
            Err(NoDatagram::Version(version)) => wrong(format!("program of protocol {version}")),
            Err(NoDatagram::Shape | NoDatagram::Checksum) => {
                DeviceError::Other { place: place.clone(), reason: crate::Loss::Corrupt.cause().to_owned() }
            }
        };
    }
    Err(trouble)
}

pub(super) struct OpeningResult {
    /// The newest datagram of the program.
    pub(super) newest: Datagram,
    /// Sequence number of our newest answer.
    pub(super) sequence: u32,
    /// Lower bound of our time stamps, us.
    pub(super) begins_us: u64,
}

/// Answers until a datagram shows that the program has received an answer.
fn shake_hands(
    datagrams: &mut dyn TransportDatagrams,
    first: &Datagram,
    watchdog_us: u32,
    begins_us: u64,
) -> Option<OpeningResult> {
    let ExternalMessage::Reading(kind) = first.message else { return None };
    let begin = Instant::now();
    let mut buffer = [0; BYTES_MAX + 1];
    let mut wire = [0; BYTES_MAX];
    let mut sequence = 0;
    let mut newest = *first;
    while begin.elapsed() < ANSWER_MAX {
        sequence += 1;
        let command = Datagram {
            session: first.session,
            sequence,
            time_us: begins_us + u64::from(sequence),
            echo_us: newest.time_us,
            watchdog_us,
            joints: first.joints,
            ..command_of(kind, false, &[])
        };
        let length = command.encode(&mut wire);
        datagrams.send(&wire[..length]).ok()?;
        sleep(NAP);
        while let Some(count) = datagrams.receive(&mut buffer).ok()? {
            let received = Datagram::decode(&buffer[..count]).ok();
            let own = |received: &Datagram| {
                received.session == first.session
                    && received.message == first.message
                    && received.joints == first.joints
            };
            newest = received.filter(own).unwrap_or(newest);
            if newest.echo_us > begins_us && newest.sequence != first.sequence {
                return Some(OpeningResult { newest, sequence, begins_us });
            }
            if begin.elapsed() > ANSWER_MAX {
                return None;
            }
        }
    }
    None
}
