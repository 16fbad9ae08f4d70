//! Emulates caps and pedals. Settings: `path=PATH` of the socket (by default in a folder of its own),
//! `model=split|combined` for a cap, `model=keyboard|switches` for a pedal; `x, y, z, rx, ry, rz` (-1 to 1) and
//! `buttons` set a constant state of a cap, `pressed` (bits) of a pedal.

use std::path::PathBuf;

use anyhow::bail;
use nima_devices::{CapReading, PedalReading};
use nima_world::emulators::hid::{
    CapBody, CapModel, PedalBody, PedalModel, Place, serve_cap, serve_pedal, serve_spacenavd,
};

use super::{Emulated, Settings};

fn place(settings: &Settings) -> anyhow::Result<Place> {
    Ok(settings.get::<PathBuf>("path")?.map_or(Place::Temporary, Place::Path))
}

/// One of two models by name; the first one by default.
fn model<T: Default>(settings: &Settings, names: [(&str, T); 2]) -> anyhow::Result<T> {
    let Some(name) = settings.get::<String>("model")? else { return Ok(T::default()) };
    let known = names.each_ref().map(|(known, _)| *known).join(" or ");
    match names.into_iter().find(|(known, _)| *known == name) {
        Some((_, model)) => Ok(model),
        None => bail!("--set model={name}: use {known}"),
    }
}

fn cap_body(settings: &Settings) -> anyhow::Result<CapBody> {
    let mut reading = CapReading::default();
    let mut held = false;
    let CapReading { translation, rotation, buttons } = &mut reading;
    for (key, axis) in ["x", "y", "z", "rx", "ry", "rz"].into_iter().zip(translation.iter_mut().chain(rotation)) {
        if let Some(value) = settings.get::<f64>(key)? {
            if !(-1.0..=1.0).contains(&value) {
                bail!("--set {key}={value}: give a number from -1 to 1");
            }
            (*axis, held) = (value, true);
        }
    }
    if let Some(bits) = settings.get("buttons")? {
        (*buttons, held) = (bits, true);
    }
    Ok(if held { CapBody::moved_by(move |_| reading) } else { CapBody::alone() })
}

pub(super) fn cap(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    let model = model(settings, [("split", CapModel::Split), ("combined", CapModel::Combined)])?;
    Ok(vec![Emulated::new("spacemouse", serve_cap(place(settings)?, model, cap_body(settings)?)?)])
}

pub(super) fn spacenavd(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    Ok(vec![Emulated::new("spacenavd", serve_spacenavd(place(settings)?, cap_body(settings)?)?)])
}

pub(super) fn pedal(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    let model = model(settings, [("keyboard", PedalModel::Keyboard), ("switches", PedalModel::Switches)])?;
    let body = match settings.get("pressed")? {
        Some(pressed) => PedalBody::pressed_by(move |_| PedalReading { pressed }),
        None => PedalBody::alone(),
    };
    Ok(vec![Emulated::new("pedal", serve_pedal(place(settings)?, model, body)?)])
}
