//! The first page: is everything there that a recording needs, and what to do where it is not.

use egui::Ui;
use nima::runtime::Tick;

use super::{
    super::{Binding, checks::check_line},
    TipForceWizard,
};
use crate::console::widgets::card;

/// Which of [`SOURCES`] came with a tick.
pub(super) type Sources = [bool; SOURCES.len()];

/// What a tick must bring: name, and what is wrong without it and what to do.
const SOURCES: [(&str, &str); 5] = [
    ("Wrist sensor", "silent; connect it"),
    ("Gravity", "not in force; press \"Calibrate gravity...\" on the left"),
    ("Sensor under the tissue", "silent; connect it"),
    ("Arm and tracker", "the tracker does not see the marker, or the arm is silent; clear its sight"),
    ("Depth through the trocar", "not told; mount the trocar and check the arm"),
];

/// What this tick brought.
pub(super) fn sources(tick: &Tick) -> Sources {
    tick.wrist.as_ref().map_or_else(Sources::default, |sample| {
        let gravity = tick.force.gravity_free.is_some();
        [true, gravity, sample.tissue_n.is_some(), sample.s1_from_c().is_some(), sample.insertion_m.is_some()]
    })
}

impl TipForceWizard {
    pub(super) fn ready_ui(&self, ui: &mut Ui, binding: &Binding) {
        card(ui, "Before the recording", "All six must be met before rows are taken.", |ui| {
            ui.label(
                "Lay the tissue on its sensor, put the instrument through the trocar, and hold its tip above the tissue.",
            );
            ui.add_space(6.0);
            for ((name, otherwise), there) in SOURCES.into_iter().zip(self.sources) {
                check_line(ui, name, there, otherwise);
            }
            let known = binding.correspondence.is_some();
            check_line(ui, "Correspondence", known, "not known; press \"Calibrate correspondence...\" on the left");
        });
    }
}
