//! The recording page: the task, the number of rows, missing goals, and three maps of the coverage.

use egui::{Align, Button, Id, Layout, RichText, Ui, vec2};
use nima_core::tip_force::TipForceCoverage;
use nima_machine::rig::Prompt;
use nima_recording::tip_force::ROW_EVERY_S;
use nima_screen::{
    steady_button::{PATIENT_S, SteadyButton},
    theme,
    widgets::{card, next_button},
};
use nima_training::MIN_ROWS;
use nima_words::{
    report_text::{goal_text, within},
    text,
};

use super::{
    super::{
        drawings::{AxisText, heat_map, progress},
        frame::{Wizard as _, WizardRequest},
        guide::beside,
    },
    Binding, TRAIN, TipForceWizard,
    ready_ui::reason_line,
    take::{drawn, words},
};

/// Number of rows of the paper's data set.
const PAPER_ROWS: usize = 30_000;

impl TipForceWizard {
    /// Draws the step; returns the request to train although not all requirements are met.
    pub(super) fn record_ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<WizardRequest> {
        let running = self.is_recording();
        let rows = self.rows();
        let mut wish = None;
        let meaning = text::tip_force::RECORD_HOVER.get();
        card(ui, text::tip_force::RECORD_TITLE, meaning, |ui| {
            beside(ui, &drawn(self.recording.as_ref()), None, |ui| self.now_ui(ui));
            ui.add_space(4.0);
            let may = if running { Ok(()) } else { self.may_record(binding) };
            ui.horizontal(|ui| {
                if self.start_ui(ui, running, rows, may) {
                    self.toggle(running, binding);
                }
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    let enough = rows >= MIN_ROWS && self.lacking().is_some();
                    let anyway =
                        ui.add_enabled(enough, Button::new(text::tip_force::TRAIN_ANYWAY).min_size(vec2(130.0, 34.0)));
                    let anyway = anyway.on_hover_text(text::tip_force::TRAIN_ANYWAY_HOVER);
                    if anyway.on_disabled_hover_text(text::tip_force::TRAIN_ANYWAY_DISABLED_HOVER).clicked() {
                        wish = Some(WizardRequest::GoTo(TRAIN));
                    }
                });
            });
            reason_line(ui, may);
            let seconds = rows as f64 * ROW_EVERY_S;
            let report = text::tip_force::rows_and_seconds(rows, seconds, PAPER_ROWS, PAPER_ROWS as f64 * ROW_EVERY_S);
            progress(ui, text::tip_force::ROWS.get(), rows as f64 / PAPER_ROWS as f64, &report);
        });
        let empty = TipForceCoverage::default();
        let coverage = self.recording.as_ref().map_or(&empty, |take| take.recorder.coverage());
        goals_ui(ui, coverage);
        maps_ui(ui, coverage);
        wish
    }

    /// Draws the person's task in large type, then the state of the recording.
    fn now_ui(&self, ui: &mut Ui) {
        let Some(take) = &self.recording else {
            ui.label(RichText::new(words(self.prompt())).font(theme::strong(19.0)));
            ui.label(text::tip_force::RECORD_FIRST_STEP);
            return;
        };
        let task = match self.lacking() {
            None => text::tip_force::RECORD_COMPLETE.get().to_owned(),
            Some(_) if !take.running => text::tip_force::RECORD_PAUSED.get().to_owned(),
            Some(_) => words(take.prompt()).to_owned(),
        };
        ui.label(RichText::new(task).font(theme::strong(19.0)));
        if let (Some(goal), true) = (self.lacking(), take.running) {
            let when = if take.prompt() == Prompt::WorkFree {
                text::tip_force::ADVICE_LATER.get()
            } else {
                text::tip_force::ADVICE_NOW.get()
            };
            let [name, advice] = goal_text(goal.what);
            let advice = text::tip_force::advice(when, advice, &within(name));
            ui.label(RichText::new(advice).font(theme::strong(16.0)));
        }
        ui.label(text::tip_force::state(&take.phase_text()));
    }

    /// Draws the start button; returns true when it is pressed.
    fn start_ui(&self, ui: &mut Ui, running: bool, rows: usize, may: Result<(), &str>) -> bool {
        let text = match (running, rows) {
            (true, _) => text::tip_force::PAUSE.get(),
            (false, 0) => text::tip_force::RECORD_START.get(),
            (false, _) => text::tip_force::RECORD_GO_ON.get(),
        };
        let next = !running && !self.is_done();
        let start = SteadyButton { id: Id::unique("record"), label: text, meaning: "", may, waits_s: PATIENT_S };
        start.ui(ui, |text, enabled| {
            let label = RichText::new(text).font(theme::strong(17.0));
            next_button(label, next && enabled).min_size(vec2(220.0, 48.0))
        })
    }

    fn toggle(&mut self, running: bool, binding: &Binding) {
        match &mut self.recording {
            Some(take) if running => take.running = false,
            _ => self.start_recording(binding),
        }
    }
}

fn goals_ui(ui: &mut Ui, coverage: &TipForceCoverage) {
    card(ui, text::tip_force::GOALS_TITLE, text::tip_force::GOALS_HOVER, |ui| {
        ui.columns(2, |columns| {
            let goals = coverage.goals();
            for (i, goal) in goals.iter().enumerate() {
                // Round down, so that 100 is shown only when the requirement is met.
                let percent = format!("{:.0} %", (100.0 * goal.fraction).floor());
                progress(
                    &mut columns[i / goals.len().div_ceil(2)],
                    goal_text(goal.what)[0],
                    goal.fraction,
                    if goal.fraction < 1.0 { &percent } else { text::wizards::MET.get() },
                );
            }
        });
    });
}

fn maps_ui(ui: &mut Ui, coverage: &TipForceCoverage) {
    let tilt: [AxisText; 2] =
        [["-53 deg", text::tip_force::TILT_X.get(), "53 deg"], ["-53", text::tip_force::TILT_Y.get(), "53"]];
    let force: [AxisText; 2] =
        [["0 N", text::tip_force::FORCE_ACROSS.get(), "5 N"], ["-5", text::tip_force::FORCE_ALONG.get(), "5"]];
    let travel: [AxisText; 2] =
        [["0 mm", text::tip_force::TRAVEL_DEPTH.get(), "300 mm"], ["-160", text::tip_force::TRAVEL_SPEED.get(), "160"]];
    let meaning = text::tip_force::COVERAGE_HOVER.get();
    card(ui, text::tip_force::COVERAGE_TITLE, meaning, |ui| {
        let width = ((ui.available_width() - 2.0 * 10.0) / 3.0).min(238.0);
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 10.0;
            heat_map(ui, width, text::tip_force::MAP_TILT.get(), &coverage.tilt, tilt);
            heat_map(ui, width, text::tip_force::MAP_FORCE.get(), &coverage.force, force);
            heat_map(ui, width, text::tip_force::MAP_TRAVEL.get(), &coverage.travel, travel);
        });
    });
}

#[cfg(test)]
mod tests {
    use nima_core::tip_force::{DEPTH_M, FORCE_N, SPEED_M_S, TILT};

    #[test]
    fn the_maps_say_what_the_library_draws() {
        assert_eq!(TILT.asin().to_degrees().round() as i32, 53);
        assert_eq!([FORCE_N, SPEED_M_S * 1e3].map(|x| x.round() as i32), [5, 160]);
        assert_eq!(DEPTH_M.map(|x| (x * 1e3).round() as i32), [0, 300]);
    }
}
