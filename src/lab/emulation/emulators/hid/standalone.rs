//! Emulated caps and pedals. Settings: `path` of the socket (by default in its own folder), `model` of a cap (`split`,
//! `combined`) or of a pedal (`keyboard`, `switches`); `x, y, z, rx, ry, rz` (-1 to 1) and `buttons` hold a cap still,
//! `pressed` (bits) holds a pedal.

use std::io::Result;

use nima_devices::{CapReading, PedalReading};

use super::{CapBody, CapModel, PedalBody, PedalModel};
use crate::emulators::{Emulator, EmulatorSettings, standalone::unusable};

fn cap_body(settings: &EmulatorSettings) -> Result<CapBody> {
    let mut reading = CapReading::default();
    let mut held = false;
    let CapReading { translation, rotation, buttons } = &mut reading;
    for (key, axis) in ["x", "y", "z", "rx", "ry", "rz"].into_iter().zip(translation.iter_mut().chain(rotation)) {
        if let Some(value) = settings.get::<f64>(key)? {
            if !(-1.0..=1.0).contains(&value) {
                return Err(unusable(key, value, "enter a number from -1 to 1"));
            }
            *axis = value;
            held = true;
        }
    }
    if let Some(bits) = settings.get("buttons")? {
        *buttons = bits;
        held = true;
    }
    Ok(if held { CapBody::moved_by(move |_| reading) } else { CapBody::alone() })
}

pub(in crate::emulators) fn cap(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let model = settings.model([("split", CapModel::Split), ("combined", CapModel::Combined)])?;
    Ok(super::cap(settings.get("path")?, model, cap_body(settings)?))
}

pub(in crate::emulators) fn spacenavd(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    Ok(super::spacenavd(settings.get("path")?, cap_body(settings)?))
}

pub(in crate::emulators) fn pedal(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let model = settings.model([("keyboard", PedalModel::Keyboard), ("switches", PedalModel::Switches)])?;
    let body = match settings.get("pressed")? {
        Some(pressed) => PedalBody::pressed_by(move |_| PedalReading { pressed }),
        None => PedalBody::alone(),
    };
    Ok(super::pedal(settings.get("path")?, model, body))
}
