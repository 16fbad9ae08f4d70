//! The makes of handle, arm and force sensor that a rig file can choose with `make = "..."`; the first one listed is
//! the default.
//!
//! Each kind of device has one file, and only that file depends on the makes: a new make is a variant there and an arm
//! in each `match`.

mod follower;
mod leader;
mod sensor;

use std::ops::Range;

pub use follower::FollowerSettings;
pub use leader::LeaderSettings;
use nima_devices::{ClearFaults, DeviceError};
pub use sensor::SensorSettings;
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use crate::rig::Side;

/// Opens a device; `P` is `Box<dyn Leader>` and so on.
pub(super) struct Opener<P> {
    /// Name of the driver, for the screen.
    pub(super) driver: String,
    /// Opens the device; called again whenever the connection was lost.
    pub(super) open: Box<dyn FnMut() -> Result<P, DeviceError> + Send>,
    pub(super) clear_faults: Option<ClearFaults>,
}

/// Refuses a make that an emulated rig cannot have: its devices belong to one emulated world, which does not include
/// this make.
fn not_emulated(make: &str, rig_is_emulated: bool) -> Result<(), DeviceError> {
    if !rig_is_emulated {
        return Ok(());
    }
    Err(DeviceError::Setting {
        key: "make".to_owned(),
        value: make.to_owned(),
        allowed: "omit `make` on an emulated rig (emulated = true), which emulates every device".to_owned(),
    })
}

/// Position of an error in a rig file, as a range of bytes in its text, and the reason.
pub(crate) type Misread = (Range<usize>, String);

/// Rewrites every part of a rig file as `arm = { kinova = { ... } }`, the form that serde reads as an enum. Each value
/// keeps its position in the text, so that faults below a make are reported with their line.
pub(crate) fn take_out_makes(rig: &mut DeTable<'_>) -> Result<(), Misread> {
    if let Some(desk) = below(rig, "desk") {
        choose(desk, "handle", LeaderSettings::MAKES)?;
    }
    let Some(devices) = below(rig, "devices") else { return Ok(()) };
    for side in Side::ALL {
        let Some(set) = below(devices, side.word()) else { continue };
        for (part, known) in
            [("handle", LeaderSettings::MAKES), ("arm", FollowerSettings::MAKES), ("sensor", SensorSettings::MAKES)]
        {
            choose(set, part, known)?;
        }
    }
    choose(devices, "tissue_sensor", SensorSettings::MAKES)
}

fn below<'a, 'i>(table: &'a mut DeTable<'i>, key: &str) -> Option<&'a mut DeTable<'i>> {
    match table.get_mut(key)?.get_mut() {
        DeValue::Table(table) => Some(table),
        _ => None,
    }
}

/// Returns the make of one part, by default the first of these.
fn choose(table: &mut DeTable<'_>, part: &str, known: &[&'static str]) -> Result<(), Misread> {
    let Some(settings) = below(table, part) else { return Ok(()) };
    let make = match settings.remove("make") {
        None => known[0],
        Some(make) => {
            let named = known.iter().find(|name| make.get_ref().as_str() == Some(name));
            named.ok_or_else(|| (make.span(), format!("make must be one of: {}", known.join(", "))))?
        }
    };
    let settings = std::mem::take(settings);
    if let Some(part) = table.get_mut(part) {
        let span = part.span();
        let of_make = (Spanned::new(span.clone(), make.into()), Spanned::new(span, DeValue::Table(settings)));
        *part.get_mut() = DeValue::Table(DeTable::from_iter([of_make]));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::config::{RigConfig, parse_with};

    const SIMULATED: &str = "make = \"simulated\"\nstart_rad = [2.38, -1.34, -1.37, 1.91, -1.28, 1.68, 0.92]\n";

    /// Parses this text as the arm of a rig file.
    fn arm(text: &str) -> Result<FollowerSettings, String> {
        let paper = toml::to_string(&RigConfig::load("paper").unwrap()).unwrap();
        let (before, rest) = paper.split_once("[devices.right.arm]\n").unwrap();
        let after = &rest[rest.find("\n[").unwrap()..];
        let whole = format!("{before}[devices.right.arm]\n{text}\n{after}");
        let read = parse_with::<RigConfig>("rig", "paper.toml".as_ref(), &whole, take_out_makes);
        let begin = before.lines().count() + 1;
        read.map(|rig| rig.devices.unwrap().right.unwrap().arm).map_err(|error| {
            let words = error.to_string();
            let (line, words) = words.strip_prefix("rig file paper.toml: line ").unwrap().split_once(": ").unwrap();
            format!("{}: {words}", line.parse::<usize>().unwrap() - begin)
        })
    }

    #[test]
    fn the_usual_make_needs_no_name_and_another_one_has_its_own_settings() {
        let unnamed = arm("host = \"10.0.0.1\"\nspeed_fraction = 1").unwrap();
        let named = arm("host = \"10.0.0.1\"\nmake = \"kinova\"\nspeed_fraction = 1").unwrap();
        assert_eq!(unnamed, named);
        assert_eq!(unnamed.kinova().unwrap().host, "10.0.0.1");
        let simulated = arm(SIMULATED).unwrap();
        assert!(matches!(simulated, FollowerSettings::Simulated(_)), "{simulated:?}");
        for chosen in [unnamed, simulated] {
            let written = toml::to_string(&chosen).unwrap();
            assert_eq!(arm(&written).unwrap(), chosen, "{written}");
        }
    }

    #[test]
    fn what_is_wrong_below_a_make_is_told_with_its_line() {
        let report = |text: &str| arm(text).unwrap_err();
        for wrong in ["host = \"10.0.0.1\"\nmake = \"acme\"", "host = \"10.0.0.1\"\nmake = 1"] {
            assert_eq!(report(wrong), "2: make must be one of: kinova, simulated, external");
        }
        let other = report(&format!("{SIMULATED}host = \"10.0.0.1\""));
        assert!(other.starts_with("3: unknown field `host`"), "{other}");
        let missing = report("make = \"simulated\"");
        assert!(missing.contains("missing field `start_rad`"), "{missing}");
        let key = report("# the arm\n\nhosts = \"10.0.0.1\"");
        assert!(key.starts_with("3: unknown field `hosts`"), "{key}");
        let value = report("host = \"10.0.0.1\"\nspeed_fraction = \"half\"");
        assert!(value.starts_with("2: invalid type: string"), "{value}");
    }
}
