//! The recording: what to do now, how much there is, what it still lacks, and three maps that fill.

use crate::console::text;
use egui::{Align, Button, Layout, RichText, Ui, vec2};
use nima::{
    device::Prompt,
    tip_force::{Coverage, MIN_ROWS, ROW_EVERY_S},
};

use super::{
    super::{
        Wish,
        pictures::{AxisWords, heat_map, progress},
    },
    Binding, TRAIN, TipForceWizard,
    take::words,
};
use crate::console::{
    theme,
    widgets::{card, small},
};

/// Rows of the paper's data set.
const PAPER_ROWS: usize = 30_000;

impl TipForceWizard {
    /// Gives the wish to train although not all goals are met.
    pub(super) fn record_ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<Wish> {
        let (running, rows) = (self.recording.as_ref().is_some_and(|take| take.running), self.rows());
        let mut wish = None;
        let meaning = text::tip_force::THE_PERSON_AT_THE;
        card(ui, text::tip_force::DO_THIS_NOW, meaning, |ui| {
            self.now_ui(ui);
            ui.add_space(4.0);
            ui.horizontal(|ui| {
                if self.start_ui(ui, running, rows, binding) {
                    self.toggle(running, binding);
                }
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    let enough = rows >= MIN_ROWS && self.lacking().is_some();
                    let anyway =
                        ui.add_enabled(enough, Button::new(text::tip_force::TRAIN_ANYWAY).min_size(vec2(130.0, 34.0)));
                    let anyway = anyway.on_hover_text(text::tip_force::TRAINS_ON_WHAT_THERE);
                    if anyway.on_disabled_hover_text(text::tip_force::FOR_A_RECORDING_THAT).clicked() {
                        wish = Some(Wish::GoTo(TRAIN));
                    }
                });
            });
            let seconds = rows as f64 * ROW_EVERY_S;
            let told = text::tip_force::rows_and_seconds(rows, seconds, PAPER_ROWS, PAPER_ROWS as f64 * ROW_EVERY_S);
            progress(ui, text::tip_force::ROWS, rows as f64 / PAPER_ROWS as f64, &told);
        });
        let empty = Coverage::default();
        let coverage = self.recording.as_ref().map_or(&empty, |take| take.recorder.coverage());
        goals_ui(ui, coverage);
        maps_ui(ui, coverage);
        wish
    }

    /// The person's task in large type, then what the recording is doing.
    fn now_ui(&self, ui: &mut Ui) {
        let Some(take) = &self.recording else {
            ui.label(RichText::new(words(self.prompt())).font(theme::strong(19.0)));
            ui.label(text::tip_force::THEN_PRESS_START_RECORDING);
            return;
        };
        let task = match self.lacking() {
            None => text::tip_force::ALL_GOALS_ARE_MET.to_owned(),
            Some(_) if !take.running => text::tip_force::PAUSED_PRESS_GO_ON_RECORDING.to_owned(),
            Some(_) => words(take.prompt()).to_owned(),
        };
        ui.label(RichText::new(task).font(theme::strong(19.0)));
        if let (Some(goal), true) = (self.lacking(), take.running) {
            let when = if take.prompt() == Prompt::WorkFree {
                text::tip_force::AFTER_THAT
            } else {
                text::tip_force::STILL_TO_DO
            };
            let advice = text::tip_force::advice(when, goal.advice, &goal.name.to_lowercase());
            ui.label(RichText::new(advice).font(theme::strong(16.0)));
        }
        ui.label(text::tip_force::state(&take.phase_words()));
    }

    /// The big button; true when it is pressed.
    fn start_ui(&self, ui: &mut Ui, running: bool, rows: usize, binding: &Binding) -> bool {
        let text = match (running, rows) {
            (true, _) => text::tip_force::PAUSE,
            (false, 0) => text::tip_force::START_RECORDING,
            (false, _) => "Go on recording",
        };
        let may = self.may_record(binding);
        let button = Button::new(RichText::new(text).font(theme::strong(17.0))).min_size(vec2(220.0, 48.0));
        let response = ui.add_enabled(running || may.is_ok(), button);
        let reason = may.err().unwrap_or_default();
        if !running && !reason.is_empty() {
            ui.label(small(reason));
        }
        response.on_disabled_hover_text(reason).clicked()
    }

    fn toggle(&mut self, running: bool, binding: &Binding) {
        match &mut self.recording {
            Some(take) if running => take.running = false,
            _ => self.start_recording(binding),
        }
    }
}

fn goals_ui(ui: &mut Ui, coverage: &Coverage) {
    card(ui, text::tip_force::GOALS, text::tip_force::WHAT_THE_NETWORK_WILL, |ui| {
        ui.columns(2, |columns| {
            for (i, goal) in coverage.goals().iter().enumerate() {
                // Never 100 before it is met.
                let percent = format!("{:.0} %", (100.0 * goal.share).floor());
                progress(&mut columns[i / 3], goal.name, goal.share, if goal.share < 1.0 { &percent } else { "met" });
            }
        });
    });
}

fn maps_ui(ui: &mut Ui, coverage: &Coverage) {
    let tilt: [AxisWords; 2] =
        [["-53 deg", text::tip_force::TOWARDS_X, "53 deg"], ["-53", text::tip_force::TOWARDS_Y_DEG, "53"]];
    let force: [AxisWords; 2] =
        [["0 N", text::tip_force::ACROSS_THE_SHAFT, "5 N"], ["-5", text::tip_force::ALONG_THE_SHAFT_N, "5"]];
    let travel: [AxisWords; 2] = [
        ["0 mm", text::tip_force::DEPTH_THROUGH_THE_TROCAR_2, "300 mm"],
        ["-80", text::tip_force::SPEED_INWARDS_MM_S, "80"],
    ];
    let meaning = text::tip_force::EACH_FIELD_IS_BRIGHTER;
    card(ui, text::tip_force::WHAT_THE_RECORDING_HOLDS, meaning, |ui| {
        let width = ((ui.available_width() - 2.0 * 10.0) / 3.0).min(238.0);
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 10.0;
            heat_map(ui, width, text::tip_force::TILT_OF_THE_SHAFT, &coverage.tilt, tilt);
            heat_map(ui, width, text::tip_force::FORCE_AT_THE_TIP, &coverage.force, force);
            heat_map(ui, width, text::tip_force::MOTION_THROUGH_THE_TROCAR, &coverage.travel, travel);
        });
    });
}

#[cfg(test)]
mod tests {
    use nima::tip_force::{DEPTH_M, FORCE_N, SPEED_M_S, TILT};

    #[test]
    fn the_maps_say_what_the_library_draws() {
        assert_eq!(TILT.asin().to_degrees().round() as i32, 53);
        assert_eq!([FORCE_N, SPEED_M_S * 1e3].map(|x| x.round() as i32), [5, 80]);
        assert_eq!(DEPTH_M.map(|x| (x * 1e3).round() as i32), [0, 300]);
    }
}
