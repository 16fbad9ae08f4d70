//! Network addresses that are only examples in the chosen rig file: typed here, written into the file.

use std::{collections::BTreeMap, path::Path};

use egui::{Button, TextEdit, Ui};
use nima_machine::{
    config::{RigConfig, RigFile},
    rig::RigPart,
};
use nima_screen::widgets::small;
use nima_words::{
    report_text::{chain, part_name},
    text,
};

/// Width of a field for an address.
const FIELD: f32 = 160.0;

#[derive(Debug, Default)]
pub(super) struct ExampleAddresses {
    /// The typed address of each part, by its key in the file.
    typed: BTreeMap<String, String>,
    report: Option<String>,
}

impl ExampleAddresses {
    /// Draws a field for each part of a user's rig file with an example address; returns whether the file was changed.
    pub(super) fn ui(&mut self, ui: &mut Ui, path: &str, rig: &RigConfig) -> bool {
        let examples = rig.example_addresses();
        if examples.is_empty() {
            return false;
        }
        if !Path::new(path).exists() {
            ui.label(small(text::start::COPY_FIRST.get()));
            return false;
        }
        ui.label(text::start::ADDRESSES.get());
        let mut changed = false;
        for (part, key) in examples {
            changed |= self.address_ui(ui, path, part, &key);
        }
        if let Some(report) = &self.report {
            ui.label(report);
        }
        changed
    }

    fn address_ui(&mut self, ui: &mut Ui, path: &str, part: RigPart, key: &str) -> bool {
        let typed = self.typed.entry(key.to_owned()).or_default();
        let mut entered = false;
        ui.horizontal(|ui| {
            let label = ui.label(part_name(part));
            let field = TextEdit::singleline(typed).hint_text("192.168.1.10").desired_width(FIELD);
            ui.add(field).labelled_by(label.id);
            let enter = ui.add_enabled(!typed.trim().is_empty(), Button::new(text::start::ENTER.get()));
            let enter = enter.on_hover_text(text::start::ENTER_HOVER.get());
            entered = enter.on_disabled_hover_text(text::start::ADDRESS_FIRST.get()).clicked();
        });
        if !entered {
            return false;
        }
        self.report = enter(path, key, typed.trim()).err();
        self.report.is_none()
    }
}

/// Writes an address into the rig file, unless the file would become invalid.
fn enter(path: &str, key: &str, address: &str) -> Result<(), String> {
    let mut file = RigFile::of(path).map_err(|error| chain(&error))?;
    file.set(key, address);
    file.save(Path::new(path)).map(drop).map_err(|error| chain(&error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_example_becomes_an_address_and_a_double_one_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        RigFile::of("paper").unwrap().save(&path).unwrap();
        let path = path.to_str().unwrap();
        let keys = || -> Vec<String> {
            RigConfig::load(path).unwrap().example_addresses().into_iter().map(|(_, key)| key).collect()
        };
        assert_eq!(keys(), ["devices.right.arm.host", "devices.left.arm.host", "devices.tracker.address"]);
        enter(path, "devices.right.arm.host", "10.0.0.1").unwrap();
        assert_eq!(keys(), ["devices.left.arm.host", "devices.tracker.address"]);
        let before = std::fs::read_to_string(path).unwrap();
        let refused = enter(path, "devices.left.arm.host", "10.0.0.1").unwrap_err();
        assert!(refused.contains("right arm"), "{refused}");
        assert_eq!(std::fs::read_to_string(path).unwrap(), before);
    }
}
