//! Settings of an emulator that runs alone (`nima emulate`): without a rig, fed by a simple substitute for the world.

use std::{
    cell::RefCell,
    io::{Error, ErrorKind, Result},
    str::FromStr,
};

use nima_devices::ARM_JOINTS;

/// Settings `KEY=VALUE`. A device ignores the keys of other devices, but a key that no device has asked for is an error
/// ([`check`](Self::check)).
#[derive(Debug, Default)]
pub struct EmulatorSettings {
    given: Vec<(String, String)>,
    /// Keys that the devices have, in the order of the requests.
    known: RefCell<Vec<String>>,
}

impl EmulatorSettings {
    /// Parses texts `KEY=VALUE`.
    ///
    /// # Errors
    /// If a text has another form.
    pub fn new(texts: &[String]) -> Result<Self> {
        let pair = |text: &String| match text.split_once('=') {
            Some((key, value)) => Ok((key.to_owned(), value.to_owned())),
            None => Err(Error::new(ErrorKind::InvalidInput, format!("--set {text} is not KEY=VALUE"))),
        };
        let given = texts.iter().map(pair).collect::<Result<Vec<_>>>()?;
        for (k, (key, _)) in given.iter().enumerate() {
            if given[..k].iter().any(|(other, _)| other == key) {
                return Err(Error::new(ErrorKind::InvalidInput, format!("--set {key} is given twice: omit one")));
            }
        }
        Ok(Self { given, known: RefCell::default() })
    }

    /// Refuses a key that no device has; call it once all devices have been made.
    ///
    /// # Errors
    /// The first unknown key, with the keys of these devices.
    pub fn check(&self) -> Result<()> {
        let known = self.known.borrow();
        match self.given.iter().find(|(key, _)| !known.contains(key)) {
            None => Ok(()),
            Some((key, value)) => {
                let mut keys = known.clone();
                keys.sort();
                keys.dedup();
                let known = if keys.is_empty() { "none".to_owned() } else { keys.join(", ") };
                let words = format!("--set {key}={value}: unknown setting; known for these devices: {known}");
                Err(Error::new(ErrorKind::InvalidInput, words))
            }
        }
    }

    /// Returns the value of `key`, if given; a value that cannot be parsed is an error.
    pub(super) fn get<T: FromStr>(&self, key: &str) -> Result<Option<T>> {
        self.known.borrow_mut().push(key.to_owned());
        let Some((_, value)) = self.given.iter().find(|(known, _)| known == key) else { return Ok(None) };
        value.parse().map(Some).map_err(|_| unusable(key, value, "this value cannot be used"))
    }

    /// Returns the value of `key`, or the default.
    pub(super) fn get_or<T: FromStr>(&self, key: &str, usual: T) -> Result<T> {
        Ok(self.get(key)?.unwrap_or(usual))
    }

    /// Returns the number of joints of an arm: 7, or 6 if set.
    pub(super) fn joints(&self) -> Result<usize> {
        let joints = self.get_or("joints", ARM_JOINTS)?;
        if (ARM_JOINTS - 1..=ARM_JOINTS).contains(&joints) {
            Ok(joints)
        } else {
            Err(unusable("joints", joints, "give 6 or 7"))
        }
    }

    /// Returns one of two models by name; the first by default.
    #[cfg(target_os = "linux")]
    pub(super) fn model<T: Default>(&self, names: [(&str, T); 2]) -> Result<T> {
        let Some(name) = self.get::<String>("model")? else { return Ok(T::default()) };
        let known = names.each_ref().map(|(known, _)| *known).join(" or ");
        let model = names.into_iter().find(|(known, _)| *known == name);
        model.map(|(_, model)| model).ok_or_else(|| unusable("model", &name, &format!("use {known}")))
    }
}

pub(super) fn unusable(key: &str, value: impl std::fmt::Display, why: &str) -> Error {
    Error::new(ErrorKind::InvalidInput, format!("--set {key}={value}: {why}"))
}

#[cfg(test)]
mod tests {
    use super::super::ALONE;
    use super::*;

    #[test]
    fn a_mistyped_key_is_refused_with_the_keys_of_the_device() {
        let make = |name: &str, set: &[&str]| {
            let (_, maker) = ALONE.iter().find(|(known, _)| *known == name).unwrap();
            let texts: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
            let settings = EmulatorSettings::new(&texts)?;
            maker(&settings)?;
            settings.check()
        };
        assert!(make("bota-gen0", &["boot_s=0.8"]).is_ok());
        let mistyped = make("bota-gen0", &["boots=0.8"]).unwrap_err().to_string();
        assert!(mistyped.contains("boots=0.8") && mistyped.contains("boot_s"), "{mistyped}");
        for (name, _) in ALONE {
            assert!(make(name, &["no_such_key=1"]).is_err(), "{name}");
        }
        assert!(make("kinova", &["tcp_port=1", "tcp_port=2"]).is_err());
    }
}
