//! `nima emulate ndi` (TCP) and `ndi-serial` (pseudo-terminal): the tracker. `--set firmware=TAG` determines whether
//! hosts choose `TX` or `BX`, `--set missing=N` and `--set outside=N` hide a tool or move it out of the volume, `--set
//! port=N` uses a fixed TCP port.

use nima_devices::Tracked;
use nima_world::emulators::ndi::{Profile, serve_line, serve_network, wandering};

use super::{Emulated, Settings};

fn profile(settings: &Settings) -> anyhow::Result<Profile> {
    let mut profile = Profile::default();
    if let Some(firmware) = settings.get("firmware")? {
        profile.firmware = firmware;
    }
    Ok(profile)
}

type Look = Box<dyn FnMut(f64, usize) -> Tracked + Send>;

fn body(settings: &Settings) -> anyhow::Result<Look> {
    let (missing, outside) = (settings.get::<usize>("missing")?, settings.get::<usize>("outside")?);
    Ok(Box::new(move |unit_s, number| {
        if missing == Some(number) || outside == Some(number) {
            Tracked::Missing { out_of_volume: outside == Some(number) }
        } else {
            wandering(unit_s, number)
        }
    }))
}

pub(super) fn network(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    let port = settings.get("port")?.unwrap_or(0);
    Ok(vec![Emulated::new("ndi", serve_network(port, profile(settings)?, body(settings)?)?)])
}

pub(super) fn line(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    Ok(vec![Emulated::new("ndi-serial", serve_line(None, profile(settings)?, body(settings)?)?)])
}
