//! First page of the wizard: the sources required for a recording, with remedies for missing ones.

use egui::{TextStyle, Ui, vec2};
use nima_machine::messages::Tick;
use nima_screen::widgets::{card, small};
use nima_words::{language::Text, text};

use super::{
    super::{
        Binding,
        checks::{check_line, waiting_line},
    },
    TipForceWizard,
};

/// Which of [`SOURCES`] delivered in a tick.
pub(super) type ReadySources = [bool; SOURCES.len()];

/// Required sources: name, and the text if it is missing.
const SOURCES: [(Text, Text); 5] = [
    (text::tip_force::SOURCE_WRIST, text::tip_force::SOURCE_SILENT),
    (text::tip_force::SOURCE_GRAVITY, text::tip_force::SOURCE_NO_GRAVITY),
    (text::tip_force::SOURCE_TISSUE, text::tip_force::SOURCE_SILENT),
    (text::tip_force::SOURCE_TRACKER, text::tip_force::SOURCE_NO_TRACKER),
    (text::tip_force::SOURCE_DEPTH, text::tip_force::SOURCE_NO_DEPTH),
];

/// Returns the sources that delivered in this tick.
pub(super) fn sources(tick: &Tick) -> ReadySources {
    tick.calibration.wrist.as_ref().map_or_else(ReadySources::default, |sample| {
        let gravity = tick.force.gravity_free.is_some();
        [true, gravity, sample.tissue_n.is_some(), sample.s1_from_c().is_some(), sample.insertion_m.is_some()]
    })
}

/// Draws the reason why the controls above are disabled. Without a reason the line is empty: nothing may move while a
/// sensor is lost for a moment.
pub(super) fn reason_line(ui: &mut Ui, may: Result<(), &str>) {
    match may {
        Ok(()) => {
            let height = ui.text_style_height(&TextStyle::Small);
            ui.allocate_space(vec2(1.0, height));
        }
        Err(reason) => {
            ui.label(small(reason));
        }
    }
}

impl TipForceWizard {
    /// Returns whether the wrist sensor delivers and has reported its serial number.
    pub(super) const fn has_sensor(&self, binding: &Binding) -> bool {
        self.sources[0] && !binding.sensor.is_empty()
    }

    /// Checks whether a recording can start; the error is the first reason.
    pub(super) fn may_record(&self, binding: &Binding) -> Result<(), &'static str> {
        if !self.has_sensor(binding) {
            return Err(text::correspondence::NEEDS_WRIST_SENSOR.get());
        }
        if binding.correspondence.is_none() {
            return Err(text::tip_force::NEEDS_CORRESPONDENCE.get());
        }
        if self.sources.iter().all(|there| *there) { Ok(()) } else { Err(text::wizards::NEEDS_CHECKS.get()) }
    }

    pub(super) fn ready_ui(&self, ui: &mut Ui, binding: &Binding) {
        card(ui, text::tip_force::CHECKS_TITLE, text::tip_force::CHECKS_HOVER, |ui| {
            ui.label(text::tip_force::CHECKS_TASK);
            ui.add_space(6.0);
            let known = binding.correspondence.is_some();
            let correspondence = (text::tip_force::SOURCE_CORRESPONDENCE, text::tip_force::SOURCE_NO_CORRESPONDENCE);
            let lines = SOURCES.into_iter().zip(self.sources).chain([(correspondence, known)]);
            // Without the wrist sensor, the other checks and the calibrations of this arm are unknown.
            let has_sensor = self.has_sensor(binding);
            for (place, ((name, otherwise), there)) in lines.enumerate() {
                match (place, has_sensor) {
                    (0, _) => check_line(ui, name.get(), has_sensor, otherwise.get()),
                    (_, true) => check_line(ui, name.get(), there, otherwise.get()),
                    (_, false) => waiting_line(ui, name.get()),
                }
            }
        });
    }
}
