//! Opens the line, and asks who is there and where the grip is.

use std::{
    thread::sleep,
    time::{Duration, Instant},
};

use super::{
    codec::{DEVICE_BYTES, DeviceInfo, STATE, STATE_BYTES, State, WAKE_UP, force_request},
    settings::Settings,
};
use crate::{Identity, Loss, Trouble, same_serial, transport::Bytes};

/// How long one answer is waited for, and how often it is asked for: what the line still holds may come first.
const ANSWER_MAX: Duration = Duration::from_millis(100);
const ATTEMPTS: usize = 3;
const NAP: Duration = Duration::from_micros(500);

impl DeviceInfo {
    fn identity(&self) -> Identity {
        Identity {
            // The manufacturer's numbers of models are not known to us.
            product: format!("Haply handle, model {}", self.model),
            serial: format!("{:04X}", self.id),
            firmware: self.firmware.to_string(),
        }
    }
}

/// Reads what comes within the time of one answer, at most until `enough`.
fn heard(line: &mut dyn Bytes, enough: usize) -> Result<Vec<u8>, Loss> {
    let begin = Instant::now();
    let mut heard = Vec::new();
    let mut buffer = [0; 256];
    while begin.elapsed() < ANSWER_MAX && heard.len() < enough {
        match line.receive(&mut buffer)? {
            0 => sleep(NAP),
            count => heard.extend_from_slice(&buffer[..count]),
        }
    }
    Ok(heard)
}

/// Discards what the line still holds.
fn drain(line: &mut dyn Bytes) -> Result<(), Loss> {
    let mut buffer = [0; 256];
    for _ in 0..64 {
        if line.receive(&mut buffer)? == 0 {
            break;
        }
    }
    Ok(())
}

/// Asks the device who it is, and puts no force on it. What it answers before the question is old.
pub(super) fn meet(line: &mut dyn Bytes, settings: &Settings) -> Result<Identity, Trouble> {
    let place = settings.port.clone();
    let gone = |_: Loss| Trouble::Absent { place: place.clone() };
    let mut any = false;
    let mut found = None;
    for _ in 0..ATTEMPTS {
        drain(line).map_err(gone)?;
        line.send(&[WAKE_UP]).map_err(gone)?;
        let answer = heard(line, DEVICE_BYTES).map_err(gone)?;
        any |= !answer.is_empty();
        // Behind the rest of an older answer.
        found = answer.windows(DEVICE_BYTES).rev().find_map(DeviceInfo::decode);
        if found.is_some() {
            break;
        }
    }
    let Some(info) = found else {
        return Err(if any {
            Trouble::WrongProduct {
                place,
                expected: "Haply handle".to_owned(),
                found: "device that answers otherwise".to_owned(),
            }
        } else {
            Trouble::Silent { place }
        });
    };
    let identity = info.identity();
    if let Some(expected) = &settings.serial_number
        && !same_serial(&expected.to_uppercase(), &identity.serial)
    {
        return Err(Trouble::OtherSerial { place, expected: expected.clone(), found: identity.serial });
    }
    drain(line).map_err(gone)?;
    line.send(&force_request([0.0; 3])).map_err(gone)?;
    let answer = heard(line, STATE_BYTES).map_err(gone)?;
    match State::decode(&answer) {
        Some(state) if state.is_possible() => Ok(identity),
        Some(_) => Err(Trouble::NotReady {
            place,
            mode: "start-up".to_owned(),
            cure: "Put the grip into its rest and switch the handle off and on, as its manual says.".to_owned(),
        }),
        None if answer.first() == Some(&STATE) || answer.is_empty() => Err(Trouble::NotReady {
            place,
            mode: "start-up".to_owned(),
            cure: "Plug in its power supply, put the grip into its rest, and wait until its light is steady."
                .to_owned(),
        }),
        None => Err(Trouble::Other { place, reason: Loss::Corrupt.cause().to_owned() }),
    }
}
