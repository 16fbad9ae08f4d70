//! First page of the wizard: whether everything for a recording is present, and what to do if not.

use egui::Ui;
use nima_machine::messages::Tick;

use super::{
    super::{Binding, checks::check_line},
    TipForceWizard,
};
use crate::console::{text, widgets::card};
use crate::language::Text;

/// Which of [`SOURCES`] delivered in a tick.
pub(super) type Sources = [bool; SOURCES.len()];

/// Required sources: name, and the text if it is missing.
const SOURCES: [(Text, Text); 5] = [
    (text::tip_force::SOURCE_WRIST, text::tip_force::SOURCE_SILENT),
    (text::tip_force::SOURCE_GRAVITY, text::tip_force::SOURCE_NO_GRAVITY),
    (text::tip_force::SOURCE_TISSUE, text::tip_force::SOURCE_SILENT),
    (text::tip_force::SOURCE_TRACKER, text::tip_force::SOURCE_NO_TRACKER),
    (text::tip_force::SOURCE_DEPTH, text::tip_force::SOURCE_NO_DEPTH),
];

/// Sources that delivered in this tick.
pub(super) fn sources(tick: &Tick) -> Sources {
    tick.wrist.as_ref().map_or_else(Sources::default, |sample| {
        let gravity = tick.force.gravity_free.is_some();
        [true, gravity, sample.tissue_n.is_some(), sample.s1_from_c().is_some(), sample.insertion_m.is_some()]
    })
}

impl TipForceWizard {
    pub(super) fn ready_ui(&self, ui: &mut Ui, binding: &Binding) {
        card(ui, text::tip_force::CHECKS_TITLE.get(), text::tip_force::CHECKS_HOVER.get(), |ui| {
            ui.label(text::tip_force::CHECKS_TASK.get());
            ui.add_space(6.0);
            for ((name, otherwise), there) in SOURCES.into_iter().zip(self.sources) {
                check_line(ui, name.get(), there, otherwise.get());
            }
            let known = binding.correspondence.is_some();
            check_line(
                ui,
                text::tip_force::SOURCE_CORRESPONDENCE.get(),
                known,
                text::tip_force::SOURCE_NO_CORRESPONDENCE.get(),
            );
        });
    }
}
