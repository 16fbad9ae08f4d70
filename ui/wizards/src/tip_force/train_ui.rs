//! The training page: size, start and cancel, progress, and the losses.

use egui::{Button, Ui, vec2};
use egui_plot::{AxisHints, Corner, GridInput, GridMark, Legend, Line, LineStyle, Plot, PlotPoints};
use nima_recording::tip_force::ROW_EVERY_S;
use nima_screen::{
    theme,
    widgets::{card, figure, next_button, small},
};
use nima_words::{
    report_text::{goal_text, within},
    text,
};

use super::{
    super::drawings::progress,
    Binding, Size, TipForceWizard,
    job::{Curves, look},
};

const HEIGHT: f32 = 330.0;

impl TipForceWizard {
    pub(super) fn train_ui(&mut self, ui: &mut Ui, binding: &Binding) {
        card(ui, text::tip_force::STEP_TRAIN, text::tip_force::TRAIN_HOVER, |ui| {
            self.size_ui(ui);
            let rows = self.rows();
            let report = text::tip_force::rows_and_time(rows, rows as f64 * ROW_EVERY_S);
            figure(ui, text::tip_force::TRAIN_DATA, report, text::tip_force::TRAIN_DATA_HOVER);
            let (fraction, elapsed_s) = self.progress();
            ui.horizontal(|ui| {
                if self.is_training() {
                    if ui.add(Button::new(text::tip_force::TRAIN_CANCEL).min_size(vec2(180.0, 40.0))).clicked() {
                        self.cancel_training();
                    }
                    return;
                }
                let text = if self.trained.is_some() {
                    text::tip_force::TRAIN_AGAIN.get()
                } else {
                    text::tip_force::TRAIN_START.get()
                };
                let button =
                    ui.add_enabled(rows > 0, next_button(text, self.trained.is_none()).min_size(vec2(180.0, 40.0)));
                if button.on_disabled_hover_text(text::tip_force::TRAIN_DISABLED_HOVER).clicked() {
                    self.start_training(binding);
                }
            });
            progress(ui, text::tip_force::TRAIN_PROGRESS.get(), fraction, &self.progress_text(fraction, elapsed_s));
        });
        self.outcome_ui(ui);
        let meaning = text::tip_force::LOSS_HOVER.get();
        card(ui, text::tip_force::LOSS_TITLE, meaning, |ui| curves_ui(ui, &look(&self.curves)));
    }

    fn cancel_training(&self) {
        if let Some((job, _)) = &self.training {
            job.cancel();
        }
    }

    fn size_ui(&mut self, ui: &mut Ui) {
        let training = self.is_training();
        ui.horizontal(|ui| {
            ui.label(text::tip_force::SIZE);
            for size in Size::ALL {
                let hidden = size.settings().hidden.iter().map(usize::to_string).collect::<Vec<_>>().join("-");
                let chosen = self.size == size;
                let words = format!("{} ({hidden})", size.name());
                let response = ui.add_enabled(!training, Button::selectable(chosen, words));
                let response = response.on_hover_text(text::tip_force::SIZE_HOVER);
                if response.on_disabled_hover_text(text::tip_force::NEEDS_TRAINING_END).clicked() {
                    self.size = size;
                }
            }
        });
    }

    fn progress_text(&self, fraction: f64, elapsed_s: f64) -> String {
        match &self.training {
            Some((job, _)) if job.is_cancelled() => text::tip_force::TRAIN_STOPPING.get().to_owned(),
            Some(_) if fraction <= 0.0 => text::tip_force::TRAIN_STARTING.get().to_owned(),
            Some(_) => {
                let left_s = elapsed_s * (1.0 - fraction) / fraction;
                text::tip_force::time_left(100.0 * fraction, elapsed_s, left_s)
            }
            None if self.trained.is_some() => text::tip_force::TRAIN_DONE.get().to_owned(),
            None => text::tip_force::TRAIN_NOT_STARTED.get().to_owned(),
        }
    }

    fn outcome_ui(&self, ui: &mut Ui) {
        let Some(trained) = &self.trained else { return };
        card(ui, text::tip_force::TRAINED_TITLE, text::tip_force::TRAINED_HOVER, |ui| {
            let origin = &trained.model.origin;
            let losses = origin.figures.iter().map(|member| member.validation_loss);
            let mean = losses.sum::<f64>() / origin.figures.len().max(1) as f64;
            let report = text::tip_force::networks_on_rows(origin.figures.len(), origin.rows);
            figure(ui, text::tip_force::ENSEMBLE, report, text::tip_force::ENSEMBLE_HOVER);
            figure(ui, text::tip_force::HELD_OUT_LOSS, format!("{mean:.4}"), text::tip_force::HELD_OUT_LOSS_HOVER);
            if let Some(goal) = trained.narrow {
                let [goal, _] = goal_text(goal);
                ui.label(text::tip_force::not_complete(&within(goal)));
            }
            if origin.rows < self.rows() {
                ui.label(small(text::tip_force::TRAINED_STALE));
            }
        });
    }
}

fn curves_ui(ui: &mut Ui, curves: &Curves) {
    let decades = |mark: GridMark| power_of_ten(mark.value);
    let plot = Plot::new("losses")
        .height(HEIGHT)
        .custom_x_axes(vec![AxisHints::new_x().label(text::tip_force::EPOCH_AXIS)])
        .custom_y_axes(vec![
            AxisHints::new_y()
                .label(text::tip_force::LOSS_AXIS)
                .min_thickness(52.0)
                .formatter(move |mark, _| decades(mark)),
        ])
        .y_grid_spacer(|grid| whole_decades(&grid))
        .grid_color(theme::now().line)
        .allow_scroll(false)
        .include_x(0.0)
        .include_x(10.0)
        .include_y(0.0)
        .include_y(-2.0)
        .show_crosshair(false)
        .legend(Legend::default().position(Corner::RightTop).follow_insertion_order(true));
    let response = plot.show(ui, |plot| {
        for (i, member) in curves.members.iter().enumerate() {
            let colour = theme::now().series[i % theme::now().series.len()];
            let held_out = Line::new(text::tip_force::held_out(i + 1), PlotPoints::from(member.held_out.clone()));
            plot.line(held_out.color(colour).width(2.0));
            let training = Line::new(text::tip_force::training(i + 1), PlotPoints::from(member.training.clone()));
            plot.line(training.color(colour.gamma_multiply(0.7)).width(1.0).style(LineStyle::dashed_dense()));
        }
    });
    let epochs = curves.members.iter().map(|member| member.training.len()).max().unwrap_or_default();
    let described = text::tip_force::losses(curves.members.len(), epochs);
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, described.clone()));
}

/// Returns the marks at 1, 2 and 5 in each decade; values are in decades.
fn whole_decades(grid: &GridInput) -> Vec<GridMark> {
    let low = grid.bounds.0.max(-12.0);
    let high = grid.bounds.1.min(12.0);
    let fine = high - low < 3.0;
    let decades = (low.floor() as i32)..=(high.ceil() as i32);
    let within = |decade: i32| {
        let parts: &[f64] = if fine { &[1.0, 2.0, 5.0] } else { &[1.0] };
        parts.iter().map(move |part| f64::from(decade) + part.log10())
    };
    let marks = decades.flat_map(within).filter(|value| (low..=high).contains(value));
    marks.map(|value| GridMark { value, step_size: 1.0 }).collect()
}

fn power_of_ten(decades: f64) -> String {
    let value = 10f64.powf(decades);
    let places = (-(decades + 1e-9).floor()).clamp(0.0, 6.0) as usize;
    if decades < -6.0 { format!("{value:.0e}") } else { format!("{value:.places$}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_stand_at_round_losses() {
        let marks = whole_decades(&GridInput { bounds: (-2.1, 0.2), base_step_size: 0.1 });
        let words: Vec<String> = marks.iter().map(|mark| power_of_ten(mark.value)).collect();
        assert_eq!(words, ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1"]);
        assert_eq!(whole_decades(&GridInput { bounds: (-6.0, 0.0), base_step_size: 0.1 }).len(), 7);
    }
}
