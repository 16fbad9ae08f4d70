//! Opens the connection, and requests the identity and the position of the grip.

use std::{
    thread::sleep,
    time::{Duration, Instant},
};

use super::{
    codec::{DEVICE_BYTES, DeviceInfo, HaplyState, STATE, STATE_BYTES, WAKE_UP, force_request},
    settings::HaplySettings,
};
use crate::{DeviceError, DeviceIdentity, Loss, same_serial, transport::ByteStream};

/// Maximum time for one answer, and number of requests for it, because buffered data may arrive first.
const ANSWER_MAX: Duration = Duration::from_millis(100);
const ATTEMPTS: usize = 3;
// Polling faster would only cost processor time.
const NAP: Duration = Duration::from_micros(500);

impl DeviceInfo {
    fn identity(&self) -> DeviceIdentity {
        DeviceIdentity {
            // The manufacturer's model numbers are unknown to us.
            product: format!("Haply handle, model {}", self.model),
            serial: format!("{:04X}", self.id),
            firmware: self.firmware.to_string(),
        }
    }
}

/// Reads the data that arrive within the time of one answer, until there are at least `enough` bytes.
fn received(line: &mut dyn ByteStream, enough: usize) -> Result<Vec<u8>, Loss> {
    let begin = Instant::now();
    let mut received = Vec::new();
    let mut buffer = [0; 256];
    while begin.elapsed() < ANSWER_MAX && received.len() < enough {
        match line.receive(&mut buffer)? {
            0 => sleep(NAP),
            count => received.extend_from_slice(&buffer[..count]),
        }
    }
    Ok(received)
}

fn drain(line: &mut dyn ByteStream) -> Result<(), Loss> {
    let mut buffer = [0; 256];
    for _ in 0..64 {
        if line.receive(&mut buffer)? == 0 {
            break;
        }
    }
    Ok(())
}

/// Requests the device's identity, without force. Data that arrive before the request are old.
pub(super) fn meet(line: &mut dyn ByteStream, settings: &HaplySettings) -> Result<DeviceIdentity, DeviceError> {
    let place = settings.port.clone();
    let gone = |_: Loss| DeviceError::Absent { place: place.clone() };
    let mut any = false;
    let mut found = None;
    for _ in 0..ATTEMPTS {
        drain(line).map_err(gone)?;
        line.send(&[WAKE_UP]).map_err(gone)?;
        let answer = received(line, DEVICE_BYTES).map_err(gone)?;
        any |= !answer.is_empty();
        // Skip the rest of an older answer.
        found = answer.windows(DEVICE_BYTES).rev().find_map(DeviceInfo::decode);
        if found.is_some() {
            break;
        }
    }
    let Some(info) = found else {
        return Err(if any {
            DeviceError::WrongProduct {
                place,
                expected: "Haply handle".to_owned(),
                found: "device with another protocol".to_owned(),
            }
        } else {
            DeviceError::Silent { place }
        });
    };
    let identity = info.identity();
    if let Some(expected) = &settings.serial_number
        && !same_serial(expected, &identity.serial)
    {
        return Err(DeviceError::OtherSerial { place, expected: expected.clone(), found: identity.serial });
    }
    let mut answer = Vec::new();
    let mut state = None;
    for _ in 0..ATTEMPTS {
        drain(line).map_err(gone)?;
        line.send(&force_request([0.0; 3])).map_err(gone)?;
        answer = received(line, STATE_BYTES).map_err(gone)?;
        state = answer.windows(STATE_BYTES).rev().find_map(HaplyState::decode);
        if state.is_some_and(|state| state.is_possible()) {
            break;
        }
    }
    match state {
        Some(state) if state.is_possible() => Ok(identity),
        Some(_) => Err(DeviceError::NotReady {
            place,
            mode: "start-up".to_owned(),
            cure: "Put the grip into its rest position and switch the handle off and on, as described in its manual."
                .to_owned(),
        }),
        None if answer.first() == Some(&STATE) || answer.is_empty() => Err(DeviceError::NotReady {
            place,
            mode: "start-up".to_owned(),
            cure: "Plug in its power supply, put the grip into its rest position, and wait until its light is steady."
                .to_owned(),
        }),
        None => Err(DeviceError::Other { place, reason: Loss::Corrupt.cause().to_owned() }),
    }
}
