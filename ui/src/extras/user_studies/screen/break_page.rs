//! A participant's break.

use std::time::{Duration, Instant};

use egui::{Align, Button, Layout, RichText, Ui, vec2};
use nima_screen::{
    theme,
    widgets::{next_button, small, weak},
};

use crate::extras::user_studies::text;

/// Update interval of the clock.
const AGAIN: Duration = Duration::from_millis(250);

#[derive(Debug)]
pub(super) struct BreakPage {
    began: Instant,
    min_s: f64,
}

/// The chosen action.
pub(super) enum BreakChoice {
    /// Back to the experimenter's page, without counting the break.
    Back,
    /// Ended after this time, s.
    Over(f64),
}

impl BreakPage {
    pub(super) fn begin(min_s: f64) -> Self {
        Self { began: Instant::now(), min_s }
    }

    pub(super) fn ui(&self, ui: &mut Ui) -> Option<BreakChoice> {
        let seconds = self.began.elapsed().as_secs_f64();
        let left_s = self.min_s - seconds;
        let mut done = None;
        ui.ctx().request_repaint_after(AGAIN);
        ui.add_space(0.25 * ui.available_height());
        ui.with_layout(Layout::top_down(Align::Center), |ui| {
            ui.label(RichText::new(text::studies::BREAK).font(theme::strong(34.0)));
            let words = if left_s > 0.0 {
                text::studies::clock(left_s.ceil())
            } else {
                text::studies::BREAK_OVER.get().to_owned()
            };
            ui.label(RichText::new(words).font(theme::strong(46.0)));
            let min = text::studies::break_min(self.min_s);
            ui.label(weak(if left_s > 0.0 { min.as_str() } else { text::studies::BREAK_MAY_END.get() }));
            ui.add_space(24.0);
            let end = RichText::new(text::studies::BREAK_END).font(theme::strong(17.0));
            let button = next_button(end, left_s <= 0.0).min_size(vec2(220.0, 48.0));
            if ui.add_enabled(left_s <= 0.0, button).clicked() {
                done = Some(BreakChoice::Over(seconds));
            }
            ui.add_space(8.0);
            if ui.add(Button::new(text::studies::BACK).min_size(vec2(220.0, 36.0))).clicked() {
                done = Some(BreakChoice::Back);
            }
            ui.label(small(text::studies::BREAK_BACK));
        });
        done
    }
}
