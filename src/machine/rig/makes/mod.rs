//! The makes of handle, arm and force sensor that a rig file can choose with `make = "..."`; the first one listed is
//! the default.
//!
//! There is one file for each kind of device, and only that file knows the makes: a new make is a variant there and an
//! arm in each `match`.

mod follower;
mod leader;
mod sensor;

pub use follower::FollowerSettings;
pub use leader::LeaderSettings;
use nima_devices::{ClearFaults, Trouble};
pub use sensor::SensorSettings;
use serde::{Deserialize, Deserializer, de::Error};

/// How a device is opened; `P` is `Box<dyn Leader>` and so on.
pub(super) struct Opener<P> {
    /// Name of the driver, for the screen.
    pub(super) driver: String,
    /// Opens it; called again whenever the connection was lost.
    pub(super) open: Box<dyn FnMut() -> Result<P, Trouble> + Send>,
    pub(super) clear_faults: Option<ClearFaults>,
}

/// A device's table of the rig file, without the key `make`.
struct Chosen {
    /// Index of the make in the list of known makes.
    make: usize,
    table: toml::Table,
}

impl Chosen {
    fn read<'de, D: Deserializer<'de>>(deserializer: D, known: &[&str]) -> Result<Self, D::Error> {
        let mut table = toml::Table::deserialize(deserializer)?;
        let make = match table.remove("make") {
            None => Some(0),
            Some(make) => known.iter().position(|name| make.as_str() == Some(name)),
        };
        let make = make.ok_or_else(|| D::Error::custom(format!("make is one of: {}", known.join(", "))))?;
        Ok(Self { make, table })
    }

    fn settings<T: for<'de> Deserialize<'de>, E: Error>(self) -> Result<T, E> {
        T::deserialize(self.table).map_err(|error| E::custom(error.message()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIMULATED: &str = "make = \"simulated\"\nstart_rad = [2.38, -1.34, -1.37, 1.91, -1.28, 1.68, 0.92]\n";

    #[test]
    fn the_usual_make_needs_no_name_and_another_one_has_its_own_settings() {
        let unnamed: FollowerSettings = toml::from_str("host = \"10.0.0.1\"\nspeed_fraction = 1").unwrap();
        let named: FollowerSettings =
            toml::from_str("host = \"10.0.0.1\"\nmake = \"kinova\"\nspeed_fraction = 1").unwrap();
        assert_eq!(unnamed, named);
        assert_eq!(unnamed.kinova().unwrap().host, "10.0.0.1");
        let simulated: FollowerSettings = toml::from_str(SIMULATED).unwrap();
        assert!(matches!(simulated, FollowerSettings::Simulated(_)), "{simulated:?}");
        for arm in [unnamed, simulated] {
            let written = toml::to_string(&arm).unwrap();
            assert_eq!(toml::from_str::<FollowerSettings>(&written).unwrap(), arm, "{written}");
        }
        let handle: LeaderSettings = toml::from_str("make = \"force_dimension\"\nserial = 7").unwrap();
        assert_eq!(handle.force_dimension().unwrap().serial, Some(7));
    }

    #[test]
    fn an_unknown_make_and_a_setting_of_another_make_are_told() {
        let told = |text: &str| toml::from_str::<FollowerSettings>(text).unwrap_err().message().to_owned();
        for wrong in ["make = \"acme\"", "make = 1"] {
            assert_eq!(told(wrong), "make is one of: kinova, simulated");
        }
        let other = told(&format!("{SIMULATED}host = \"10.0.0.1\""));
        assert!(other.contains("unknown field `host`"), "{other}");
        let missing = told("make = \"simulated\"");
        assert!(missing.contains("missing field `start_rad`"), "{missing}");
        let key = told("hosts = \"10.0.0.1\"");
        assert!(key.contains("unknown field `hosts`"), "{key}");
    }
}
