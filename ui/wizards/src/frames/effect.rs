//! A drawing of a change: the previous and the new point or frame, with a scale.

use egui::{Align2, Color32, Painter, Pos2, Sense, Shape, Stroke, Ui, WidgetInfo, vec2};
use nalgebra::{Isometry3, Vector3};
use nima_screen::{theme, widgets::fitting};
use nima_words::text::frames as texts;

use nima_calibrations::frames::numbers::FrameEffect;

use crate::drawings::on_paper;

const HEIGHT: f32 = 250.0;
/// Length of an axis, in half heights.
const AXIS: f64 = 0.62;
/// Distance between the drawn points before and after, in half heights; smaller changes than this length are drawn to its
/// scale, m.
const APART: f64 = 0.55;
const MIN_M: f64 = 0.2e-3;
/// Lengths of the scale, m.
const SCALES_M: [f64; 8] = [1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 1e-1];

pub(super) fn effect_image(ui: &mut Ui, effect: &FrameEffect) {
    let size = vec2(ui.available_width().min(420.0), HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let words = texts::effect(effect.change());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, words.clone()));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, theme::CORNER, theme::now().groove);
    let half = f64::from(rect.height()) * 0.5;
    let travel_m = effect.change().map_or(0.0, |[travel_m, _]| travel_m);
    let points_per_m = APART * half / travel_m.max(MIN_M);
    // The new frame is at the centre, because it is known best.
    let centre = rect.center() + vec2(0.0, 18.0);
    let middle_m = effect.after.translation.vector;
    let place = |frame: &Isometry3<f64>| {
        let offset = (frame.translation.vector - middle_m) * points_per_m;
        on_paper(centre, 1.0, &offset).0
    };
    if let Some(before) = &effect.before {
        painter.line_segment([place(before), place(&effect.after)], Stroke::new(1.0, theme::now().text_weak));
        axes(&painter, place(before), half * AXIS, before, true);
    }
    axes(&painter, place(&effect.after), half * AXIS, &effect.after, false);
    scale_bar(&painter, rect, points_per_m);
    let below = rect.center_bottom() - vec2(0.0, 8.0);
    let font = fitting(&painter, &words, theme::regular(12.5), rect.width() - 8.0);
    painter.text(below, Align2::CENTER_BOTTOM, words, font, theme::now().text_weak);
}

/// Draws three axes of a frame: dashed before, solid after.
fn axes(painter: &Painter, at: Pos2, length: f64, frame: &Isometry3<f64>, before: bool) {
    let colour: Color32 = if before { theme::now().reference } else { theme::now().measured };
    for (name, axis) in [("x", Vector3::x()), ("y", Vector3::y()), ("z", Vector3::z())] {
        let end = on_paper(at, length as f32, &(frame.rotation * axis)).0;
        if before {
            painter.extend(Shape::dashed_line(&[at, end], Stroke::new(1.5, colour), 6.0, 4.0));
        } else {
            painter.line_segment([at, end], Stroke::new(2.5, colour));
            let out = (end - at).normalized() * 9.0;
            // An axis towards the viewer has no direction on the drawing.
            let out = if out.is_finite() { out } else { vec2(0.0, -9.0) };
            painter.text(end + out, Align2::CENTER_CENTER, name, theme::regular(13.0), theme::now().text);
        }
    }
    if before {
        painter.circle_stroke(at, 5.0, Stroke::new(1.5, colour));
    } else {
        painter.circle_filled(at, 4.5, colour);
    }
}

fn scale_bar(painter: &Painter, rect: egui::Rect, points_per_m: f64) {
    let fits = |m: &f64| m * points_per_m <= 110.0;
    let Some(length_m) = SCALES_M.into_iter().rev().find(fits) else { return };
    let left = rect.left_top() + vec2(12.0, 18.0);
    let stroke = Stroke::new(1.5, theme::now().text_weak);
    let right = left + vec2((length_m * points_per_m) as f32, 0.0);
    painter.line_segment([left, right], stroke);
    for end in [left, right] {
        painter.line_segment([end - vec2(0.0, 3.0), end + vec2(0.0, 3.0)], stroke);
    }
    let words = texts::scale(length_m);
    painter.text(right + vec2(8.0, 0.0), Align2::LEFT_CENTER, words, theme::regular(12.0), theme::now().text_weak);
}
