//! The check: a new guided recording, then the network's errors compared with the paper's and with simpler methods.

use egui::{Button, Grid, Id, RichText, TextStyle, Ui, vec2};
use egui_plot::{AxisHints, Bar, BarChart, Corner, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points};
use nima_core::calibration::Verdict;
use nima_core::tip_force::{FRICTION, NO_MODEL};
use nima_machine::rig::Prompt;
use nima_recording::tip_force::ROW_EVERY_S;
use nima_screen::{
    steady_button::{PATIENT_S, SteadyButton},
    theme,
    widgets::{card, figure, fitting_style, next_button, small, weak},
};
use nima_training::EvaluationPart;
use nima_words::text;

use super::{
    super::{drawings::progress, frame::WizardRequest, guide::beside, report::verdict_card},
    Binding, CHECK_ROWS, CHECK_WORK, RECORD, TipForceWizard,
    job::{BIN_N, BINS, CheckResult},
    ready_ui::reason_line,
    take::{drawn, words},
};

const AXES: [&str; 3] = ["x", "y", "z"];
/// The paper's mean absolute error per axis, and standard deviation of the error, N.
const PAPER_MAE_N: [f64; 3] = [0.19, 0.16, 0.16];
const PAPER_SD_N: f64 = 0.20;
const HEIGHT: f32 = 228.0;

impl TipForceWizard {
    /// Draws the step; returns the request to go back and record more.
    pub(super) fn check_ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<WizardRequest> {
        let mut wish = None;
        card(ui, text::tip_force::CHECK_TITLE, text::tip_force::CHECK_HOVER, |ui| {
            let work_s = CHECK_WORK as f64 * ROW_EVERY_S;
            let free_s = (CHECK_ROWS - CHECK_WORK) as f64 * ROW_EVERY_S;
            let drawn = if self.checked.is_some() { Prompt::Rest } else { drawn(self.proof.as_ref()) };
            beside(ui, &drawn, None, |ui| {
                ui.label(RichText::new(self.task(work_s, free_s)).font(theme::strong(18.0)));
                if let Some(take) = &self.proof {
                    ui.label(text::tip_force::state(&take.phase_text()));
                }
            });
            let may = self.may_check(binding);
            ui.horizontal(|ui| {
                self.check_button_ui(ui, binding, may);
                if ui
                    .add(Button::new(text::tip_force::RECORD_MORE).min_size(vec2(130.0, 40.0)))
                    .on_hover_text(text::tip_force::RECORD_MORE_HOVER)
                    .clicked()
                {
                    wish = Some(WizardRequest::GoTo(RECORD));
                }
            });
            reason_line(ui, may);
            let judged = self.judging.is_some() || self.checked.is_some();
            let none = if judged { CHECK_ROWS } else { 0 };
            let rows = self.proof.as_ref().map_or(none, |take| take.recorder.rows());
            progress(
                ui,
                text::tip_force::CHECK_PROGRESS.get(),
                rows as f64 / CHECK_ROWS as f64,
                &text::tip_force::rows_of(rows, CHECK_ROWS),
            );
        });
        if let Some(checked) = &self.checked {
            verdict_ui(ui, checked);
            figures_ui(ui, checked);
            plots_ui(ui, checked);
        }
        wish
    }

    fn task(&self, work_s: f64, free_s: f64) -> String {
        match &self.proof {
            _ if self.judging.is_some() => text::tip_force::CHECK_JUDGING.get().to_owned(),
            Some(take) if take.running => words(take.prompt()).to_owned(),
            Some(_) => text::tip_force::CHECK_PAUSED.get().to_owned(),
            None if self.checked.is_some() => text::tip_force::CHECK_DONE.get().to_owned(),
            None => text::tip_force::check_task(work_s, free_s),
        }
    }

    /// Checks whether the check can be started or paused; the error is the reason why not.
    fn may_check(&self, binding: &Binding) -> Result<(), &'static str> {
        if self.proof.as_ref().is_some_and(|take| take.running) {
            Ok(())
        } else if self.judging.is_some() {
            Err(text::tip_force::CHECK_WAIT.get())
        } else {
            self.may_record(binding)
        }
    }

    fn check_button_ui(&mut self, ui: &mut Ui, binding: &Binding, may: Result<(), &str>) {
        let running = self.proof.as_ref().is_some_and(|take| take.running);
        let text = match &self.proof {
            Some(_) if running => text::tip_force::PAUSE.get(),
            Some(_) => text::tip_force::CHECK_GO_ON.get(),
            None if self.checked.is_some() => text::tip_force::CHECK_AGAIN.get(),
            None => text::tip_force::CHECK_START.get(),
        };
        let next = !running && self.checked.is_none();
        let check = SteadyButton { id: Id::unique("check"), label: text, meaning: "", may, waits_s: PATIENT_S };
        let wanted = check.ui(ui, |text, enabled| {
            let label = RichText::new(text).font(theme::strong(16.0));
            next_button(label, next && enabled).min_size(vec2(220.0, 40.0))
        });
        if wanted {
            match &mut self.proof {
                Some(take) if running => take.running = false,
                _ => self.start_check(binding),
            }
        }
    }
}

fn verdict_ui(ui: &mut Ui, checked: &CheckResult) {
    let check = &checked.check;
    verdict_card(ui, check.judgement.verdict, text::tip_force::VERDICT_HOVER.get(), |ui| {
        let words = text::tip_force::verdict(&check.judgement.reason);
        ui.label(RichText::new(words).font(theme::strong(14.0)));
        if check.judgement.verdict != Verdict::Accepted {
            ui.label(small(text::tip_force::VERDICT_OVERRIDE));
        }
        let doubt = text::tip_force::doubt(100.0 * check.doubt_fraction, check.rows);
        figure(ui, text::tip_force::DOUBT, doubt, text::tip_force::DOUBT_HOVER);
    });
}

/// Returns the mean absolute error of another method on an axis, N, as text.
fn mae_of(part: &EvaluationPart, method: &str, axis: usize) -> String {
    let figures = part.methods.iter().find(|figures| figures.method == method);
    let stats = figures.and_then(|figures| figures.outputs.get(axis).copied().flatten());
    stats.map_or_else(|| "-".to_owned(), |stats| format!("{:.3}", stats.mae))
}

/// Maximum width of the header of an error column.
const HEAD: f32 = 100.0;

fn figures_ui(ui: &mut Ui, checked: &CheckResult) {
    let meaning = text::tip_force::ERRORS_HOVER.get();
    card(ui, text::tip_force::ERRORS_TITLE, meaning, |ui| {
        let check = &checked.check;
        Grid::new("tip_force_check").num_columns(9).spacing(vec2(14.0, 5.0)).show(ui, |ui| {
            let heads = [
                text::tip_force::AXIS.get(),
                "MAE",
                text::tip_force::PAPER.get(),
                "SD",
                text::tip_force::PAPER.get(),
                text::tip_force::WRIST_ALONE_MAE.get(),
                text::tip_force::FRICTION_MODEL_MAE.get(),
            ];
            for head in
                heads.into_iter().chain([text::tip_force::NO_CONTACT_MEAN.get(), text::tip_force::NO_CONTACT_SD.get()])
            {
                let font = fitting_style(ui, head, &TextStyle::Small, HEAD);
                ui.label(weak(head).font(font));
            }
            ui.end_row();
            for (axis, name) in AXES.into_iter().enumerate() {
                ui.label(name);
                let strong = |value: f64| RichText::new(format!("{value:.3}")).font(theme::strong(14.0));
                ui.label(strong(check.mae_n[axis]));
                ui.label(small(format!("{:.2}", PAPER_MAE_N[axis])));
                ui.label(strong(check.sd_n[axis]));
                ui.label(small(format!("{PAPER_SD_N:.2}")));
                ui.label(mae_of(&checked.part, NO_MODEL, axis));
                ui.label(mae_of(&checked.part, FRICTION, axis));
                ui.label(strong(check.free_mean_n[axis]));
                ui.label(strong(check.free_sd_n[axis]));
                ui.end_row();
            }
        });
    });
}

fn plots_ui(ui: &mut Ui, checked: &CheckResult) {
    ui.columns(2, |columns| {
        card(&mut columns[0], text::tip_force::REGRESSION_TITLE, text::tip_force::REGRESSION_HOVER, |ui| {
            regression_ui(ui, checked);
        });
        card(&mut columns[1], text::tip_force::NO_CONTACT_TITLE, text::tip_force::NO_CONTACT_HOVER, |ui| {
            free_ui(ui, checked);
        });
    });
}

fn plot<'a>(name: &str, x: &str, y: &str) -> Plot<'a> {
    Plot::new(name)
        .height(HEIGHT)
        .custom_x_axes(vec![AxisHints::new_x().label(x)])
        .custom_y_axes(vec![AxisHints::new_y().label(y).min_thickness(44.0)])
        .grid_color(theme::now().line)
        .allow_scroll(false)
        .show_crosshair(false)
        .legend(Legend::default().position(Corner::LeftTop).follow_insertion_order(true))
}

fn regression_ui(ui: &mut Ui, checked: &CheckResult) {
    let all = || checked.points.iter().flatten().flatten();
    // At least from -1 to 1 N, so that noise does not fill the plot.
    let (low, high) = all().fold((-1.0_f64, 1.0_f64), |(low, high), value| (low.min(*value), high.max(*value)));
    let response =
        plot("tip_force_regression", text::tip_force::MEASURED_AXIS.get(), text::tip_force::PREDICTED_AXIS.get()).show(
            ui,
            |plot| {
                let ends = PlotPoints::from(vec![[low, low], [high, high]]);
                plot.line(Line::new("perfect", ends).color(theme::now().reference).style(LineStyle::dashed_loose()));
                for ((axis, points), colour) in AXES.iter().zip(&checked.points).zip(theme::now().series) {
                    let marks = Points::new(*axis, PlotPoints::from(points.clone())).shape(MarkerShape::Circle);
                    plot.points(marks.radius(1.6).color(colour));
                }
            },
        );
    let described = text::tip_force::REGRESSION_PLOT.get();
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, described));
}

fn free_ui(ui: &mut Ui, checked: &CheckResult) {
    let response = plot("tip_force_free", text::tip_force::NO_CONTACT_AXIS.get(), text::tip_force::FRACTION_AXIS.get())
        .show(ui, |plot| {
            for (k, ((axis, bins), colour)) in AXES.iter().zip(&checked.bins).zip(theme::now().series).enumerate() {
                // Three narrow bars side by side for each bin.
                let bar = |(i, fraction): (usize, &f64)| {
                    let middle_n = (i as f64 - (BINS / 2) as f64) * BIN_N;
                    Bar::new(middle_n + (k as f64 - 1.0) * BIN_N / 3.0, 100.0 * fraction).width(BIN_N / 3.0)
                };
                let bars = bins.iter().enumerate().filter(|(_, fraction)| **fraction > 0.0).map(bar).collect();
                plot.bar_chart(BarChart::new(*axis, bars).color(colour));
            }
        });
    let described = text::tip_force::NO_CONTACT_PLOT.get();
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, described));
}

#[cfg(test)]
mod tests {
    use egui::Rect;
    use egui_kittest::{Harness, kittest::Queryable as _};

    use super::*;

    #[test]
    fn a_sensor_that_flickers_moves_no_button() {
        let draw = |ui: &mut Ui, (wizard, binding): &mut (TipForceWizard, Binding)| {
            if theme::is_applied(ui.ctx()) {
                wizard.check_ui(ui, binding);
            }
        };
        let shown = (TipForceWizard::default(), Binding::default());
        let mut window = Harness::builder().with_size([1000.0, 700.0]).build_ui_state(draw, shown);
        window.run_steps(2);
        let places = |window: &Harness<'_, (TipForceWizard, Binding)>| -> [Rect; 2] {
            [text::tip_force::RECORD_MORE, text::tip_force::CHECK_PROGRESS]
                .map(|words| window.get_by_label_contains(words.get()).rect())
        };
        let without = places(&window);
        // The next reason is shorter or longer.
        let (wizard, binding) = window.state_mut();
        wizard.sources[0] = true;
        "S1-0001".clone_into(&mut binding.sensor);
        window.run_steps(2);
        assert!(window.query_by_label_contains("The correspondence is unknown").is_some());
        assert_eq!(places(&window), without);
    }

    #[test]
    fn the_line_of_a_reason_keeps_its_height() {
        let height = |may: Result<(), &'static str>| {
            let draw = move |ui: &mut Ui, height: &mut f32| {
                if theme::is_applied(ui.ctx()) {
                    let top = ui.cursor().top();
                    reason_line(ui, may);
                    *height = ui.cursor().top() - top;
                }
            };
            let mut window = Harness::builder().with_size([400.0, 100.0]).build_ui_state(draw, 0.0);
            window.run_steps(2);
            *window.state()
        };
        let [empty, full] = [Ok(()), Err("a device is missing")].map(height);
        assert!((empty - full).abs() < 1.0 && empty > 8.0, "{empty} and {full} points");
    }
}
