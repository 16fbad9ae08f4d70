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

    /// Returns the paper's rig file with this text as one of its tables, and the line of the table's head.
    fn paper_with(table: &str, text: &str) -> (String, usize) {
        let paper = toml::to_string(&RigConfig::load("paper").unwrap()).unwrap();
        let head = format!("[{table}]\n");
        let (before, rest) = paper.split_once(head.as_str()).unwrap();
        let after = &rest[rest.find("\n[").unwrap()..];
        (format!("{before}{head}{text}\n{after}"), before.lines().count() + 1)
    }

    /// Parses this text as the arm of a rig file.
    fn arm(text: &str) -> Result<FollowerSettings, String> {
        let (whole, begin) = paper_with("devices.right.arm", text);
        let read = parse_with::<RigConfig>("rig", "paper.toml".as_ref(), &whole, take_out_makes);
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

    /// Reads a rig file with this text as its right sensor, and checks it.
    fn sensor(text: &str) -> Result<SensorSettings, String> {
        let (whole, _) = paper_with("devices.right.sensor", text);
        let read = RigConfig::parse("paper.toml".as_ref(), &whole);
        read.map(|rig| rig.devices.unwrap().right.unwrap().sensor).map_err(|error| {
            let cause = std::error::Error::source(&error).map(ToString::to_string);
            cause.unwrap_or_else(|| error.to_string())
        })
    }

    #[test]
    fn a_sensor_of_ati_is_read_from_a_rig_file_and_a_bad_value_is_refused_by_key_and_remedy() {
        let counts = "counts_per_n = 1000000.0\ncounts_per_nm = 2000000.0";
        for more in ["", "rdt_port = 1\nhttp_port = 2\nrate_hz = 7000\nserial_number = \"FT12345\"", counts] {
            let chosen = sensor(&format!("make = \"ati\"\nhost = \"192.0.2.30\"\n{more}")).unwrap();
            let SensorSettings::Ati(settings) = &chosen else { panic!("{chosen:?}") };
            assert_eq!(settings.host, "192.0.2.30");
            assert_eq!(sensor(&toml::to_string(&chosen).unwrap()).unwrap(), chosen);
            let emulated = chosen.check_emulated(true).unwrap_err().to_string();
            assert!(emulated.contains("make = ati") && emulated.contains("omit `make`"), "{emulated}");
        }
        let both = format!("host = \"a\"\nserial_number = \"FT12345\"\n{counts}");
        for (text, key, remedy) in [
            ("host = \" \"", "devices.right.sensor.host", "leaves the factory with 192.168.1.1"),
            ("host = \"a\"\nrate_hz = 5", "devices.right.sensor.rate_hz = 5", "20 to 8000 Hz"),
            ("host = \"a\"\nrate_hz = nan", "devices.right.sensor.rate_hz = NaN", "20 to 8000 Hz"),
            ("host = \"a\"\ncounts_per_nm = 1000.0", "devices.right.sensor.counts_per_nm", "both counts_per_n and"),
            (
                "host = \"a\"\ncounts_per_n = 0.5\ncounts_per_nm = 1000.0",
                "devices.right.sensor.counts_per_n = 0.5",
                "1 to 1e9, as on the sensor's page",
            ),
            (both.as_str(), "devices.right.sensor.serial_number = FT12345", "omitted with counts_per_n"),
            ("rate_hz = 1000", "missing field `host`", "line "),
            ("host = \"a\"\nrdt_port = 70000", "70000", "u16"),
            ("host = \"a\"\nport = 1", "unknown field `port`", "`rdt_port`"),
        ] {
            let report = sensor(&format!("make = \"ati\"\n{text}")).unwrap_err();
            assert!(report.contains(key) && report.contains(remedy), "{text}: {report}");
        }
    }
}
