//! The first page: is everything there that a recording needs, and what to do where it is not.

use crate::console::text;
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
    (text::tip_force::WRIST_SENSOR, text::tip_force::SILENT_CONNECT_IT),
    (text::tip_force::GRAVITY, text::tip_force::NOT_IN_FORCE_PRESS),
    (text::tip_force::SENSOR_UNDER_THE_TISSUE, text::tip_force::SILENT_CONNECT_IT),
    (text::tip_force::ARM_AND_TRACKER, text::tip_force::THE_TRACKER_DOES_NOT),
    (text::tip_force::DEPTH_THROUGH_THE_TROCAR, text::tip_force::NOT_TOLD_MOUNT_THE),
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
        card(ui, text::tip_force::BEFORE_THE_RECORDING, text::tip_force::ALL_SIX_MUST_BE, |ui| {
            ui.label(text::tip_force::LAY_THE_TISSUE_ON);
            ui.add_space(6.0);
            for ((name, otherwise), there) in SOURCES.into_iter().zip(self.sources) {
                check_line(ui, name, there, otherwise);
            }
            let known = binding.correspondence.is_some();
            check_line(ui, text::tip_force::CORRESPONDENCE, known, text::tip_force::NOT_KNOWN_PRESS_CALIBRATE);
        });
    }
}
