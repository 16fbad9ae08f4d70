//! Rig files that the program changes: the author's comments, order and layout are kept.

use std::{
    io,
    path::{Path, PathBuf},
};

use toml_edit::{DocumentMut, Item, Table, Value};

use super::{ConfigError, RIGS, RigConfig, text};
use crate::rig::{DeviceOffer, PartKind, RigPart, Side};

/// A rig file in memory.
///
/// ```
/// use nima_machine::config::RigFile;
///
/// let mut file = RigFile::of("emulated")?;
/// file.set("devices.right.sensor.serial_number", "4711");
/// assert_eq!(file.rig()?.name, "Emulated rig");
/// assert!(file.text().contains("# Mirror image of the right arm's mount."), "comments are kept");
///
/// file.set("rate_hz", 1.0);
/// assert!(file.rig().is_err(), "an impossible rig is refused");
/// # Ok::<(), nima_machine::config::RigFileError>(())
/// ```
#[derive(Clone, Debug)]
pub struct RigFile {
    path: PathBuf,
    document: DocumentMut,
}

/// A device for a part of a rig.
#[derive(Clone, Debug)]
pub enum ChosenDevice {
    /// The current device of another part.
    Of(RigPart),
    /// A device that was found and is not used yet.
    Found(DeviceOffer),
}

/// Reason why a rig file cannot be changed or saved.
#[derive(Debug, thiserror::Error)]
pub enum RigFileError {
    /// The file cannot be used, or would no longer be usable.
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error("cannot write the rig file {path}")]
    Write { path: PathBuf, source: io::Error },
}

impl RigFile {
    /// Loads the embedded rig of this name, or a file.
    ///
    /// # Errors
    /// The errors of [`RigConfig::load`].
    pub fn of(name: &str) -> Result<Self, RigFileError> {
        let (path, text) = text("rig", name, &RIGS)?;
        // The settings' own parser runs first, because its errors name the line and the key.
        RigConfig::parse(&path, &text)?;
        let document = text.parse().map_err(|error: toml_edit::TomlError| ConfigError::Parse {
            kind: "rig",
            path: path.clone(),
            message: error.message().to_owned(),
        })?;
        Ok(Self { path, document })
    }

    /// Sets the value of a dotted key (`devices.right.sensor.port`) and keeps the comment next to it. Creates missing
    /// tables.
    pub fn set(&mut self, key: &str, value: impl Into<Value>) {
        let (tables, last) = key.rsplit_once('.').map_or(("", key), |(tables, last)| (tables, last));
        let mut table: &mut dyn toml_edit::TableLike = self.document.as_table_mut();
        for name in tables.split('.').filter(|name| !name.is_empty()) {
            let item = table.entry(name).or_insert(Item::Table(Table::new()));
            if !item.is_table_like() {
                *item = Item::Table(Table::new());
            }
            let Some(next) = item.as_table_like_mut() else { return };
            table = next;
        }
        let mut value = value.into();
        if let Some(before) = table.get(last).and_then(Item::as_value) {
            *value.decor_mut() = before.decor().clone();
        }
        // An existing key is kept unchanged, because the lines above it, such as the head of the file, belong to it.
        match table.get_mut(last) {
            Some(item) => *item = Item::Value(value),
            None => {
                table.insert(last, Item::Value(value));
            }
        }
    }

    /// Sets a list of texts.
    pub fn set_all(&mut self, key: &str, values: impl IntoIterator<Item = String>) {
        self.set(key, values.into_iter().collect::<Value>());
    }

    /// Returns the value of a dotted key as TOML text, without its comment; `None` if the key does not exist.
    pub fn value(&self, key: &str) -> Option<String> {
        let mut value = self.item(key)?.as_value()?.clone();
        value.decor_mut().clear();
        Some(value.to_string())
    }

    /// Sets the value of a dotted key from TOML text, as returned by [`value`](Self::value); returns false if the text
    /// is not a value.
    pub fn set_text(&mut self, key: &str, text: &str) -> bool {
        let value = text.parse::<Value>();
        value.map(|value| self.set(key, value)).is_ok()
    }

    /// Removes a dotted key and everything below it.
    pub fn remove(&mut self, key: &str) {
        let (tables, last) = key.rsplit_once('.').map_or(("", key), |(tables, last)| (tables, last));
        let mut table: &mut dyn toml_edit::TableLike = self.document.as_table_mut();
        for name in tables.split('.').filter(|name| !name.is_empty()) {
            let Some(next) = table.get_mut(name).and_then(Item::as_table_like_mut) else { return };
            table = next;
        }
        table.remove(last);
    }

    /// Swaps the values of two dotted keys; does nothing if one of them is missing. Comments move with the lines below
    /// them, and the order of the keys is kept.
    pub fn swap(&mut self, one: &str, other: &str) {
        let (Some(mut first), Some(mut second)) = (self.item(one).cloned(), self.item(other).cloned()) else { return };
        let [of_first, of_second] = [&first, &second].map(|item| item.as_table().and_then(Table::position));
        set_position(&mut first, of_second);
        set_position(&mut second, of_first);
        self.put(one, second);
        self.put(other, first);
    }

    /// Replaces the device of this part by `chosen`: the device of another part of the same kind, which then gets this
    /// part's device, or a device that was found.
    pub fn choose(&mut self, part: RigPart, chosen: &ChosenDevice) {
        match chosen {
            ChosenDevice::Of(other) => self.swap(part.key(), other.key()),
            ChosenDevice::Found(offer) => {
                // A tracker has either an address or a port: remove the other one.
                for (key, other) in [("address", "port"), ("port", "address")] {
                    if part == RigPart::Tracker && offer.changes.iter().any(|(changed, _)| *changed == key) {
                        self.remove(&format!("{}.{other}", part.key()));
                    }
                }
                for (key, value) in &offer.changes {
                    self.set(&format!("{}.{key}", part.key()), value.clone());
                }
            }
        }
    }

    /// Swaps the devices of this kind between right and left.
    pub fn exchange_sides(&mut self, kind: PartKind) {
        if let (Some(right), Some(left)) = (kind.of(Side::Right), kind.of(Side::Left)) {
            self.swap(right.key(), left.key());
        }
    }

    fn item(&self, key: &str) -> Option<&Item> {
        let mut item = self.document.as_item();
        for name in key.split('.') {
            item = item.as_table_like()?.get(name)?;
        }
        Some(item)
    }

    fn put(&mut self, key: &str, new: Item) {
        let mut item = self.document.as_item_mut();
        for name in key.split('.') {
            let Some(next) = item.as_table_like_mut().and_then(|table| table.get_mut(name)) else { return };
            item = next;
        }
        *item = new;
    }

    pub fn text(&self) -> String {
        self.document.to_string()
    }

    /// Returns the rig that the file describes now.
    ///
    /// # Errors
    /// The errors of [`RigConfig::load`].
    pub fn rig(&self) -> Result<RigConfig, ConfigError> {
        RigConfig::parse(&self.path, &self.text())
    }

    /// Writes the file to `path`, completely or not at all; an invalid rig is not written.
    ///
    /// # Errors
    /// [`RigFileError`].
    pub fn save(&self, path: &Path) -> Result<RigConfig, RigFileError> {
        let rig = self.rig()?;
        let text = self.in_folder_of(path).text();
        let written = path
            .parent()
            .map_or(Ok(()), std::fs::create_dir_all)
            .and_then(|()| nima_files::write_atomically(path, |file| file.write_all(text.as_bytes())));
        written.map_err(|source| RigFileError::Write { path: path.to_owned(), source })?;
        Ok(rig)
    }

    /// Returns the file for another folder: a description of an arm with a relative path stays where it is.
    fn in_folder_of(&self, path: &Path) -> Self {
        let folder =
            |file: &Path| file.parent().and_then(|folder| std::path::absolute(Path::new(".").join(folder)).ok());
        let mut moved = self.clone();
        let Some(from) = folder(&self.path).filter(|from| folder(path).as_ref() != Some(from)) else { return moved };
        for side in Side::ALL {
            let key = format!("devices.{}.model.urdf", side.word());
            let urdf = self.item(&key).and_then(Item::as_str).filter(|urdf| Path::new(urdf).is_relative());
            if let Some(urdf) = urdf {
                moved.set(&key, from.join(urdf).display().to_string());
            }
        }
        moved
    }
}

/// Moves a table to the position of another table in the text; its content moves with it.
fn set_position(item: &mut Item, position: Option<isize>) {
    match item {
        Item::Table(table) => {
            table.set_position(position);
            table.iter_mut().for_each(|(_, item)| set_position(item, None));
        }
        Item::ArrayOfTables(tables) => {
            for table in tables.iter_mut() {
                table.set_position(None);
                table.iter_mut().for_each(|(_, item)| set_position(item, None));
            }
        }
        Item::None | Item::Value(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use nima_devices::DeviceIdentity;

    use super::*;

    #[test]
    fn a_person_s_comments_and_order_stay() {
        let mut file = RigFile::of("paper").unwrap();
        let before = file.text();
        file.set("name", "Rig of theatre 3");
        let after = file.text();
        let changed: Vec<_> = before.lines().zip(after.lines()).filter(|(before, after)| before != after).collect();
        assert_eq!(changed.len(), 1, "{changed:?}");
        assert_eq!(changed[0].1, "name = \"Rig of theatre 3\"");
        assert_eq!(before.lines().count(), after.lines().count());
    }

    #[test]
    fn what_was_not_there_is_made_and_what_is_taken_away_is_gone() {
        let mut file = RigFile::of("simulated").unwrap();
        file.set("desk.cap.source", "any");
        assert!(file.rig().unwrap().desk.is_some());
        file.remove("desk");
        file.remove("desk.cap");
        assert_eq!(file.text(), RigFile::of("simulated").unwrap().text());
    }

    #[test]
    fn a_value_is_read_as_text_and_written_back_as_it_was() {
        let mut file = RigFile::of("emulated").unwrap();
        let before = file.text();
        let key = "devices.right.mount.sensor_m";
        let was = file.value(key).unwrap();
        assert_eq!(was, "[0.00, 0.00, 0.05]");
        assert!(file.set_text(key, "[0.001, 0.0, 0.05]"));
        let right = file.rig().unwrap().devices.unwrap().right.unwrap();
        assert!((right.mount.sensor_m.x - 0.001).abs() < 1e-12);
        assert!(file.set_text(key, &was) && file.text() == before, "{}", file.text());
        assert!(!file.set_text(key, "[0.001,") && file.text() == before);
        assert_eq!(file.value("devices.right.base_from_c_m"), None);
        assert!(file.set_text("devices.right.base_from_c_m", "[1.0, 2.0, 3.0]"));
        file.remove("devices.right.base_from_c_m");
        assert_eq!(file.text(), before);
    }

    #[test]
    fn two_sides_are_exchanged_whole() {
        let mut file = RigFile::of("emulated").unwrap();
        let was = file.rig().unwrap().devices.unwrap();
        file.swap("devices.right.handle", "devices.left.handle");
        file.swap("devices.right.sensor", "devices.left.sensor");
        let now = file.rig().unwrap().devices.unwrap();
        let right = now.right.unwrap();
        let left = now.left.unwrap();
        let right_was = was.right.unwrap();
        let left_was = was.left.unwrap();
        assert_eq!((&right.handle, &left.handle), (&left_was.handle, &right_was.handle));
        assert_eq!((&right.sensor, &left.sensor), (&left_was.sensor, &right_was.sensor));
        assert_eq!(right.arm, right_was.arm);
        file.swap("devices.right.handle", "devices.third.handle");
        assert_eq!(file.rig().unwrap().devices.unwrap().right.unwrap().handle, right.handle);
    }

    #[test]
    fn an_exchange_keeps_the_order_and_a_second_one_takes_it_back() {
        let mut file = RigFile::of("emulated").unwrap();
        let before = file.text();
        let headers =
            |text: &str| text.lines().filter(|line| line.starts_with('[')).map(str::to_owned).collect::<Vec<_>>();
        for kind in PartKind::OF_A_SIDE {
            file.exchange_sides(kind);
            assert_eq!(headers(&file.text()), headers(&before), "{kind:?}");
        }
        let comment = before.lines().take_while(|line| *line != "[devices.left.sensor]").last().unwrap();
        assert!(comment.starts_with("# "), "the left sensor has a comment: {comment}");
        let moved = format!("{comment}\n[devices.right.sensor]");
        assert!(file.text().contains(&moved), "a comment goes with its device:\n{}", file.text());
        for kind in PartKind::OF_A_SIDE {
            file.exchange_sides(kind);
        }
        assert_eq!(file.text(), before);
        file.exchange_sides(PartKind::Tracker);
        assert_eq!(file.text(), before, "there is only one");
    }

    #[test]
    fn the_device_of_another_part_is_chosen_by_exchanging_the_two() {
        let mut file = RigFile::of("emulated").unwrap();
        let was = file.rig().unwrap().devices.unwrap();
        file.choose(RigPart::Sensor(Side::Right), &ChosenDevice::Of(RigPart::TissueSensor));
        let now = file.rig().unwrap().devices.unwrap();
        assert_eq!(now.right.as_ref().map(|set| &set.sensor), was.tissue_sensor.as_ref());
        assert_eq!(now.tissue_sensor.as_ref(), was.right.as_ref().map(|set| &set.sensor));
        assert_eq!(now.left, was.left);
    }

    #[test]
    fn a_device_that_was_found_is_chosen_by_its_place_and_serial_number() {
        let offer = |changes| DeviceOffer { place: String::new(), identity: DeviceIdentity::default(), changes };
        let mut file = RigFile::of("paper").unwrap();
        let sensor = offer(vec![
            ("transport", "gen-a".into()),
            ("port", "/dev/ttyACM7".into()),
            ("serial_number", "853".into()),
        ]);
        file.choose(RigPart::Sensor(Side::Left), &ChosenDevice::Found(sensor));
        file.choose(RigPart::Handle(Side::Left), &ChosenDevice::Found(offer(vec![("serial", 815.into())])));
        let other_place = |file: &RigFile| {
            let tracker = file.rig().unwrap().devices.unwrap().tracker.unwrap();
            if tracker.port.is_some() { "address" } else { "port" }
        };
        let tracker = other_place(&file);
        file.choose(RigPart::Tracker, &ChosenDevice::Found(offer(vec![(tracker, "/dev/ttyUSB9".into())])));
        assert_ne!(other_place(&file), tracker, "one of the two keys exists");
        let left = file.rig().unwrap().devices.unwrap().left.unwrap();
        let sensor = left.sensor.bota().unwrap();
        assert_eq!((sensor.port.as_str(), sensor.serial_number.as_deref()), ("/dev/ttyACM7", Some("853")));
        assert_eq!(left.handle.force_dimension().unwrap().serial, Some(815));
    }

    #[test]
    fn two_handles_of_one_serial_number_are_refused() {
        let mut file = RigFile::of("paper").unwrap();
        let right = file.rig().unwrap().devices.unwrap().right.unwrap().handle;
        let taken = i64::from(right.force_dimension().unwrap().serial.unwrap());
        let offer = DeviceOffer {
            place: String::new(),
            identity: DeviceIdentity::default(),
            changes: vec![("serial", taken.into())],
        };
        file.choose(RigPart::Handle(Side::Left), &ChosenDevice::Found(offer));
        assert!(file.rig().is_err());
    }

    #[test]
    fn a_file_is_written_whole_and_only_if_it_can_be_used() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rigs/mine.toml");
        let mut file = RigFile::of("simulated").unwrap();
        file.set("name", "Mine");
        assert_eq!(file.save(&path).unwrap().name, "Mine");
        assert_eq!(RigConfig::load(path.to_str().unwrap()).unwrap().name, "Mine");
        file.set("delay_s", 1000.0);
        let report = file.save(&path).unwrap_err().to_string();
        assert!(report.contains("delay_s"), "{report}");
        assert!(RigConfig::load(path.to_str().unwrap()).is_ok(), "the file of before stays");
        let nowhere = folder.path().join("rigs/mine.toml/below.toml");
        file.set("delay_s", 0.05);
        assert!(matches!(file.save(&nowhere), Err(RigFileError::Write { .. })));
    }
}
