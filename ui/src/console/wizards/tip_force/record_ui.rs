//! The recording: what to do now, how much there is, what it still lacks, and three maps that fill.

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
        let meaning = "The person at the arm does what stands here. A pause keeps all rows.";
        card(ui, "Do this now", meaning, |ui| {
            self.now_ui(ui);
            ui.add_space(4.0);
            ui.horizontal(|ui| {
                if self.start_ui(ui, running, rows, binding) {
                    self.toggle(running, binding);
                }
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    let enough = rows >= MIN_ROWS && self.lacking().is_some();
                    let anyway = ui.add_enabled(enough, Button::new("Train anyway").min_size(vec2(130.0, 34.0)));
                    let anyway = anyway.on_hover_text(
                        "Trains on what there is. Such a network is not proven: it can be kept only under a name.",
                    );
                    if anyway.on_disabled_hover_text("For a recording that is not complete.").clicked() {
                        wish = Some(Wish::GoTo(TRAIN));
                    }
                });
            });
            let seconds = rows as f64 * ROW_EVERY_S;
            let told = format!(
                "{rows}, {seconds:.0} s (the paper has {PAPER_ROWS}, {:.0} s)",
                PAPER_ROWS as f64 * ROW_EVERY_S
            );
            progress(ui, "Rows", rows as f64 / PAPER_ROWS as f64, &told);
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
            ui.label("Then press \"Start recording\": the zero of the sensor under the tissue is taken first.");
            return;
        };
        let task = match self.lacking() {
            None => "All goals are met: go on to the training, or record more".to_owned(),
            Some(_) if !take.running => "Paused: press \"Go on recording\"".to_owned(),
            Some(_) => words(take.prompt()).to_owned(),
        };
        ui.label(RichText::new(task).font(theme::strong(19.0)));
        if let (Some(goal), true) = (self.lacking(), take.running) {
            let when = if take.prompt() == Prompt::WorkFree { "After that" } else { "Still to do" };
            let advice = format!("{when}: {} ({}).", goal.advice, goal.name.to_lowercase());
            ui.label(RichText::new(advice).font(theme::strong(16.0)));
        }
        ui.label(format!("State: {}.", take.phase_words()));
    }

    /// The big button; true when it is pressed.
    fn start_ui(&self, ui: &mut Ui, running: bool, rows: usize, binding: &Binding) -> bool {
        let text = match (running, rows) {
            (true, _) => "Pause",
            (false, 0) => "Start recording",
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
    card(ui, "Goals", "What the network will meet must be in the recording, in all of these respects.", |ui| {
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
    let tilt: [AxisWords; 2] = [["-53 deg", "towards x", "53 deg"], ["-53", "towards y (deg)", "53"]];
    let force: [AxisWords; 2] = [["0 N", "across the shaft", "5 N"], ["-5", "along the shaft (N)", "5"]];
    let travel: [AxisWords; 2] =
        [["0 mm", "depth through the trocar", "300 mm"], ["-80", "speed inwards (mm/s)", "80"]];
    let meaning =
        "Each field is brighter the more rows lie in it. The network may be trusted only where there are some.";
    card(ui, "What the recording holds (brighter: more rows)", meaning, |ui| {
        let width = ((ui.available_width() - 2.0 * 10.0) / 3.0).min(238.0);
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 10.0;
            heat_map(ui, width, "Tilt of the shaft", &coverage.tilt, tilt);
            heat_map(ui, width, "Force at the tip", &coverage.force, force);
            heat_map(ui, width, "Motion through the trocar", &coverage.travel, travel);
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
