//! Changes the devices of the rig in use: writes the rig file and restarts the machine idle.

use std::path::{Path, PathBuf};

use nima_machine::config::{RigConfig, RigFile, own_copy};
use nima_panels::{
    devices::{RigEdit, why_not_to_change},
    rig_choice::RigChoice,
};
use nima_words::{report_text::chain, text};

use super::{ConsoleApp, starting::Undo};

impl ConsoleApp {
    /// Changes the rig file and restarts the machine; shows the result or the reason for a refusal on the panel.
    pub(super) fn connect(&mut self, change: &RigEdit) {
        // Use the newest state, because a side may have been engaged since the panel was drawn.
        self.take_in();
        let report = match why_not_to_change(&self.live, self.starting.is_some()) {
            Some(reason) => Err(reason.to_owned()),
            None => write(self.settings.folder(), &self.running.rig, change),
        };
        match report {
            Ok(RigFileUpdate { path, report, undo }) => {
                self.panels.devices.notify(report);
                let choice = RigChoice { rig: path.display().to_string(), ..self.running.clone() };
                self.begin_changed(choice, undo);
            }
            Err(cause) => self.panels.devices.notify(text::devices::not_changed(&cause)),
        }
    }
}

#[derive(Debug)]
struct RigFileUpdate {
    path: PathBuf,
    report: String,
    undo: Undo,
}

/// Writes the changed rig to its own file, or to a new one in `folder` if it is built in.
fn write(folder: Option<&Path>, rig: &str, change: &RigEdit) -> Result<RigFileUpdate, String> {
    let mut file = RigFile::of(rig).map_err(|error| chain(&error))?;
    let before = file.text();
    match change {
        RigEdit::ExchangeSides(kind) => file.exchange_sides(*kind),
        RigEdit::Choose(part, chosen) => file.choose(*part, chosen),
    }
    let changed = file.rig().map_err(|error| chain(&error))?;
    let is_built_in = RigConfig::names().any(|name| name == rig);
    // A user's file needs no folder.
    let folder = if is_built_in { folder.ok_or(text::start::NO_FOLDER.get())? } else { Path::new("") };
    let (path, new_name) = own_copy(&changed, rig, &folder.join("rigs"));
    if let Some(new_name) = new_name {
        file.set("name", new_name);
    }
    let name = file.save(&path).map_err(|error| chain(&error))?.name;
    let report = if is_built_in { text::devices::saved_as(&name, &path) } else { text::devices::saved(&path) };
    let undo = Undo { path: path.clone(), text: (!is_built_in).then_some(before) };
    Ok(RigFileUpdate { path, report, undo })
}

#[cfg(test)]
mod tests {
    use nima_machine::{
        config::ChosenDevice,
        rig::{PartKind, RigPart, RigSettings, Side},
    };

    use super::*;

    fn devices(path: &Path) -> RigSettings {
        RigConfig::load(path.to_str().unwrap()).unwrap().devices.unwrap()
    }

    #[test]
    fn a_built_in_rig_is_copied_and_the_copy_is_changed_in_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let was = RigConfig::load("emulated").unwrap().devices.unwrap();
        let handles = RigEdit::ExchangeSides(PartKind::Handle);
        let first = write(Some(folder.path()), "emulated", &handles).unwrap();
        assert_eq!(first.path, folder.path().join("rigs/emulated-2.toml"));
        assert!(
            first.report.contains("\"Emulated rig 2\"") && first.report.contains("emulated-2.toml"),
            "{}",
            first.report
        );
        assert_eq!(devices(&first.path).right.unwrap().handle, was.left.as_ref().unwrap().handle);
        let second = write(Some(folder.path()), "emulated", &handles).unwrap();
        assert_eq!(second.path, folder.path().join("rigs/emulated-3.toml"), "nothing is written over");

        let sensor = RigEdit::Choose(RigPart::Sensor(Side::Left), ChosenDevice::Of(RigPart::TissueSensor));
        let again = write(None, first.path.to_str().unwrap(), &sensor).unwrap();
        assert_eq!(again.path, first.path);
        let now = devices(&first.path);
        assert_eq!(now.left.as_ref().map(|set| &set.sensor), was.tissue_sensor.as_ref());
        assert_eq!(now.right.unwrap().handle, was.left.unwrap().handle);

        again.undo.take_back();
        assert_eq!(devices(&first.path).tissue_sensor, was.tissue_sensor);
        first.undo.take_back();
        assert!(!first.path.exists(), "a missing device is missing again");
    }

    #[test]
    fn without_a_folder_or_a_file_nothing_is_written_and_the_cause_is_told() {
        let handles = RigEdit::ExchangeSides(PartKind::Handle);
        assert_eq!(write(None, "emulated", &handles).unwrap_err(), text::start::NO_FOLDER.get());
        assert!(write(None, "/no/such/rig.toml", &handles).unwrap_err().contains("/no/such/rig.toml"));
    }
}
