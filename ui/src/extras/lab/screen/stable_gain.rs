//! Shows the stability map below the gain slider: a strip that is solid where a gripping hand is stable and broken where it
//! is not, for the current mode, delay and contact stiffness.

use egui::{Rect, Sense, Stroke, Ui, pos2, vec2};
use nima_screen::{live::LiveState, theme, widgets::small};
use nima_study::stability_map::{StabilityMap, StabilityMapVerdict};

use crate::extras::lab::text;

const HEIGHT: f32 = 8.0;
/// Number of segments of the strip.
const PARTS: u32 = 60;

/// Draws the strip and its text. They have the same room before the strip is known, so that the widgets below do not
/// move. `rail` is the slider's rectangle, `limit` the gain at its right end.
///
/// In a separate scope: the content changes with the first contact, and the widgets below must keep their ids, or a slider
/// drag would end at that moment.
pub(in crate::extras::lab) fn stable_gain_ui(ui: &mut Ui, live: &LiveState, rail: Rect, limit: f64) {
    ui.scope(|ui| strip_ui(ui, live, rail, limit));
}

fn strip_ui(ui: &mut Ui, live: &LiveState, rail: Rect, limit: f64) {
    let Some(map) = StabilityMap::committed() else { return };
    let (rect, response) = ui.allocate_exact_size(vec2(rail.width(), HEIGHT), Sense::hover());
    if !StabilityMap::has(live.mode()) {
        ui.label(small(text::STABLE_GAIN_UNMEASURED)).on_hover_text(text::STABLE_GAIN_HOVER);
        return;
    }
    let Some(n_m) = live.stiffness_n_m() else {
        ui.label(small(text::STABLE_GAIN_UNKNOWN)).on_hover_text(text::STABLE_GAIN_HOVER);
        return;
    };
    let mode = live.mode();
    let delay_s = live.delay_s();
    // The slider's handle stays within the rail by half its own width.
    let ends = rail.x_range().shrink(0.3 * rail.height());
    let painter = ui.painter();
    for part in 0..PARTS {
        let gain = limit * (f64::from(part) + 0.5) / f64::from(PARTS);
        let x = |edge: u32| ends.min + ends.span() * edge as f32 / PARTS as f32;
        let cell = Rect::from_x_y_ranges(x(part)..=x(part + 1), rect.y_range());
        match map.at(mode, gain, delay_s, n_m) {
            StabilityMapVerdict::Stable => {
                painter.rect_filled(cell, 0.0, theme::now().engaged.gamma_multiply(0.8));
            }
            StabilityMapVerdict::Marginal => {
                painter.rect_filled(cell.shrink2(vec2(0.0, 2.5)), 0.0, theme::now().at_rest);
            }
            StabilityMapVerdict::Unstable if part % 2 == 0 => {
                let low = pos2(cell.left(), cell.bottom());
                let high = pos2(cell.right(), cell.top());
                painter.line_segment([low, high], Stroke::new(1.5, theme::now().text));
            }
            StabilityMapVerdict::Unstable => {}
        }
    }
    let greatest = map.greatest_stable_gain(mode, delay_s, n_m);
    let now = map.at(mode, live.gain(), delay_s, n_m);
    let words = text::stable_up_to(now, greatest, n_m);
    response.on_hover_text(text::STABLE_GAIN_HOVER);
    ui.label(small(words)).on_hover_text(text::STABLE_GAIN_HOVER);
}
