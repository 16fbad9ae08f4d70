//! `nima emulate ndi` (TCP) and `ndi-serial` (pseudo-terminal): the tracker. Setting `firmware` makes hosts choose `TX`
//! or `BX`, `missing` and `outside` hide one tool or put it out of the volume, `port` sets a fixed TCP port.

use std::io::Result;

use nima_devices::Tracked;

use super::{Body, Profile, wandering};
use crate::emulators::{Emulator, Settings};

fn profile(settings: &Settings) -> Result<Profile> {
    let usual = Profile::default();
    Ok(Profile { firmware: settings.get_or("firmware", usual.firmware.clone())?, ..usual })
}

fn body(settings: &Settings) -> Result<impl Body + use<>> {
    let missing = settings.get::<usize>("missing")?;
    let outside = settings.get::<usize>("outside")?;
    Ok(move |unit_s: f64, number: usize| {
        if missing == Some(number) || outside == Some(number) {
            Tracked::Missing { out_of_volume: outside == Some(number) }
        } else {
            wandering(unit_s, number)
        }
    })
}

pub(in crate::emulators) fn network(settings: &Settings) -> Result<Box<dyn Emulator>> {
    Ok(profile(settings)?.on_network(settings.get_or("port", 0)?, body(settings)?))
}

pub(in crate::emulators) fn line(settings: &Settings) -> Result<Box<dyn Emulator>> {
    Ok(profile(settings)?.on_line(None, body(settings)?))
}
