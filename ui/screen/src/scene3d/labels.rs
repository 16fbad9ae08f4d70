//! Texts on the view: names and numbers next to the objects, the forces in large figures with their gauges, axes, and a hint.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Vec2, pos2, vec2};
use nalgebra::Vector3;
use nima_machine::{messages::Tick, rig::Side};
use nima_words::{
    report_text::{newtons, side_name},
    text,
};

use super::{CameraLook, SceneCamera, SceneView, stage, stage::StageArm, training};
use crate::{
    live::LiveState,
    scene3d::release_trail::ReleaseTrail,
    theme,
    widgets::{fitting, force_sign, width_of},
};

/// Distance up the shaft at which the name of a hand is shown, m: above the numbers of the forces or, without them, low
/// enough for the endoscope to see it.
const NAME_ABOVE_M: [f32; 2] = [0.05, 0.085];

/// Minimum distance between the names of a hand and of its trocar, points.
const NAMES_APART: f32 = 30.0;

/// Names and numbers next to the objects of one side.
pub(super) fn labels(
    painter: &Painter,
    rect: Rect,
    live: &LiveState,
    camera: &SceneCamera,
    arm: &StageArm,
    view: &SceneView,
) {
    let figures = view.figures;
    let at = |point_m: Vector3<f32>| camera.project(&point_m, rect);
    let StageArm { trocar_m, pose, side, .. } = arm;
    // Keep clear of the readings at the top left.
    let free = |place: &Pos2| {
        !figures || place.y > rect.top() + READINGS_HEIGHT || place.x > rect.left() + readings_width(live)
    };
    let along = (trocar_m - pose.tip_m).try_normalize(1e-4).unwrap_or_else(Vector3::z);
    let (align, shift) = match side {
        Side::Right => (Align2::LEFT_CENTER, vec2(20.0, 0.0)),
        Side::Left => (Align2::RIGHT_CENTER, vec2(-20.0, 0.0)),
    };
    let name_at = at(pose.tip_m + along * NAME_ABOVE_M[usize::from(figures)]);
    let name_at = name_at.filter(|place| live.is_bimanual() && free(place));
    // A raised hand shows its name at this place.
    let beside_name = |place: &Pos2| name_at.is_none_or(|name| name.distance(*place) > NAMES_APART);
    if let Some(place) = at(*trocar_m).filter(free).filter(beside_name) {
        label(
            painter,
            place + vec2(18.0, 0.0),
            Align2::LEFT_CENTER,
            text::field::TROCAR.get(),
            theme::regular(13.0),
            theme::DARK.text_weak,
        );
    }
    if let Some(place) = name_at {
        let name = side_name(*side);
        let words = if view.lead.side() == Some(*side) { text::field::led(name) } else { name.to_owned() };
        label(painter, place + shift, align, &words, theme::strong(15.0), theme::DARK.text);
    }
    // Not for a participant of a study, to whom a force would reveal the condition.
    if !figures
        && view.arrows
        && let Some(tip) = at(pose.tip_m)
    {
        tip_bars(painter, live, *side, tip);
    }
    let right = camera.right();
    let [measured, rendered] = stage::arrow_bases_m(pose, trocar_m, &right);
    // The number of the outer arrow is placed outside and that of the inner one above its tip, so that they do not
    // overlap.
    let (outside, shift) = if (measured - rendered).dot(&right) < 0.0 {
        (Align2::RIGHT_CENTER, vec2(-9.0, -6.0))
    } else {
        (Align2::LEFT_CENTER, vec2(9.0, -6.0))
    };
    for (base, force_n, colour, align, shift) in [
        (measured, pose.measured_n, theme::DARK.measured, outside, shift),
        (rendered, Some(pose.rendered_n), theme::DARK.rendered, Align2::CENTER_BOTTOM, vec2(0.0, -4.0)),
    ] {
        let size_n = force_n.map(|force_n| f64::from(force_n.norm()));
        if !figures || size_n.is_some_and(|size_n| !(0.15..1e6).contains(&size_n)) {
            continue;
        }
        if let Some(place) = at(base + force_n.unwrap_or_default() * stage::ARROW_M_PER_N) {
            label(painter, place + shift, align, &newtons(size_n, 1), theme::strong(15.0), colour);
        }
    }
}

/// Draws text with a dark outline, readable on any background.
pub(super) fn label(painter: &Painter, place: Pos2, align: Align2, text: &str, font: FontId, colour: Color32) {
    for shift in [vec2(1.0, 1.0), vec2(-1.0, 1.0), vec2(0.0, -1.0)] {
        painter.text(place + shift, align, text, font.clone(), theme::VEIL);
    }
    painter.text(place, align, text, font, colour);
}

/// Positions of the columns of the readings, from the left of the view, points.
const COLUMN: f32 = 226.0;
const COLUMNS_APART: f32 = 112.0;

/// Height of the large figures at the upper left.
const READINGS_HEIGHT: f32 = 116.0;

/// Returns the width of the readings with their distance from the left of the view, points.
pub(super) fn readings_width(live: &LiveState) -> f32 {
    COLUMN + COLUMNS_APART * f32::from(u8::from(live.is_bimanual())) + 20.0
}

/// Draws the forces in large figures, one column for each hand in their order on the screen, and gauges of both with
/// the ceiling.
pub(super) fn readings(painter: &Painter, rect: Rect, live: &LiveState) {
    let mut sides: Vec<Side> = live.sides().collect();
    sides.reverse();
    let both = sides.len() > 1;
    let corner = rect.left_top() + vec2(16.0, if both { 36.0 } else { 14.0 });
    let figures = &live.figures;
    let column = |i: usize| rect.left() + COLUMN + COLUMNS_APART * i as f32;
    let plate =
        Rect::from_min_max(rect.left_top() + vec2(8.0, 8.0), pos2(column(sides.len() - 1) + 12.0, corner.y + 72.0));
    painter.rect_filled(plate, theme::CORNER, theme::VEIL);
    let rows =
        [(text::common::MEASURED.get(), theme::DARK.measured), (text::common::RENDERED.get(), theme::DARK.rendered)];
    for (i, (name, colour)) in rows.into_iter().enumerate() {
        let y = corner.y + 14.0 + 34.0 * i as f32;
        force_sign(painter, &theme::DARK, Rect::from_center_size(pos2(corner.x + 18.0, y), vec2(36.0, 16.0)), i == 1);
        painter.text(pos2(corner.x + 48.0, y), Align2::LEFT_CENTER, name, theme::regular(15.0), theme::DARK.text);
        for (k, side) in sides.iter().enumerate() {
            let force_n = if i == 1 { live.rendered_n(*side) } else { figures.measured_n[side.index()] };
            let number = newtons(force_n, 2);
            painter.text(pos2(column(k), y), Align2::RIGHT_CENTER, number, theme::strong(25.0), colour);
        }
    }
    let height = (rect.height() - 150.0).clamp(60.0, 300.0);
    let ceiling_n = live.gate_settings().ceiling_n;
    let first = rect.right() - 46.0 - 38.0 * (sides.len() - 1) as f32;
    let gauges = Rect::from_min_size(pos2(first, rect.top() + 36.0), vec2(26.0, height));
    for (k, side) in sides.iter().enumerate() {
        let place = gauges.translate(vec2(38.0 * k as f32, 0.0));
        let measured_n = live.tick_of(*side).and_then(Tick::known_n).map(|force_n| force_n.norm());
        let rendered_n = live.tick_of(*side).map(|tick| tick.rendering.rendered_n.norm());
        gauge(painter, place, [measured_n, rendered_n], ceiling_n, live.is_limited(*side));
        if both {
            let over = pos2(column(k), corner.y - 13.0);
            painter.text(over, Align2::RIGHT_CENTER, side_name(*side), theme::regular(15.0), theme::DARK.text_weak);
            let under = place.center_bottom() + vec2(0.0, 11.0);
            label(painter, under, Align2::CENTER_CENTER, side_name(*side), theme::regular(12.5), theme::DARK.text_weak);
        }
    }
    let line_y = gauges.bottom() - gauges.height() / 1.25;
    let words = text::field::ceiling_mark(ceiling_n);
    let at = pos2(first - 8.0, line_y);
    label(painter, at, Align2::RIGHT_CENTER, &words, theme::regular(12.5), theme::DARK.text_weak);
}

/// Draws a vertical gauge of measured and rendered force and the ceiling, in `rect`; an unknown force has the sign for
/// it. The mark of a ceiling that acts is coloured.
fn gauge(painter: &Painter, rect: Rect, forces_n: [Option<f64>; 2], ceiling_n: f64, acts: bool) {
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(120));
    let top_n = ceiling_n * 1.25;
    let y = |force_n: f64| rect.bottom() - rect.height() * (force_n / top_n).clamp(0.0, 1.0) as f32;
    let half = 0.5 * rect.width();
    let columns = [(rect.left(), theme::DARK.measured), (rect.left() + half, theme::DARK.rendered)];
    for (force_n, (left, colour)) in forces_n.into_iter().zip(columns) {
        let Some(force_n) = force_n else {
            let at = pos2(left + 0.5 * half, rect.bottom() - 2.0);
            painter.text(at, Align2::CENTER_BOTTOM, newtons(None, 0), theme::strong(15.0), colour);
            continue;
        };
        let filled = Rect::from_min_max(pos2(left + 2.0, y(force_n)), pos2(left + half - 2.0, rect.bottom() - 2.0));
        painter.rect_filled(filled, 1.0, colour);
    }
    let mark = if acts { theme::DARK.alarm_medium } else { theme::DARK.text };
    painter.hline(rect.x_range(), y(ceiling_n), egui::Stroke::new(2.0, mark));
}

/// Size of the bars next to a tip, and their distance from it, points.
const BARS: Vec2 = vec2(20.0, 56.0);
const BARS_AWAY: f32 = 34.0;

/// Draws the forces of a hand as bars next to its tip, on its own side, and names a ceiling that acts.
pub fn tip_bars(painter: &Painter, live: &LiveState, side: Side, tip: Pos2) {
    let away = BARS_AWAY + 0.5 * BARS.x;
    let outside = if side == Side::Right { away } else { -away };
    let rect = Rect::from_center_size(tip + vec2(outside, 0.0), BARS);
    let hand = side.index();
    let forces_n = [live.figures.measured_n[hand], live.rendered_n(side)];
    let ceiling_n = live.gate_settings().ceiling_n;
    let acts = live.is_limited(side);
    gauge(painter, rect, forces_n, ceiling_n, acts);
    if acts {
        let (words, below) = (text::roles::limited(ceiling_n), rect.center_bottom() + vec2(0.0, 4.0));
        label(painter, below, Align2::CENTER_TOP, &words, theme::strong(14.0), theme::DARK.alarm_medium);
    }
}

/// Draws the way of a released handle with its length.
pub(super) fn release(painter: &Painter, rect: Rect, camera: &SceneCamera, trail: &ReleaseTrail) {
    let points: Vec<Pos2> =
        trail.points_m().iter().filter_map(|point_m| camera.project(&point_m.cast(), rect)).collect();
    let (Some(&from), Some(&to)) = (points.first(), points.last()) else { return };
    for (width, colour) in [(6.0, theme::VEIL), (3.0, theme::DARK.watching)] {
        painter.line(points.clone(), egui::Stroke::new(width, colour));
    }
    painter.circle_stroke(from, 6.0, egui::Stroke::new(2.0, theme::DARK.watching));
    painter.circle_filled(to, 4.0, theme::DARK.watching);
    let words = text::roles::travel(1e3 * trail.travel_m());
    label(painter, to + vec2(12.0, 0.0), Align2::LEFT_CENTER, &words, theme::strong(20.0), theme::DARK.watching);
}

/// Draws the directions of the traces' x, y and z, in the lower right corner.
pub(super) fn axes(painter: &Painter, rect: Rect, camera: &SceneCamera) {
    const LENGTH: f32 = 26.0;
    let origin = rect.right_bottom() - vec2(54.0, 40.0);
    for (name, axis) in [("x", Vector3::x()), ("y", Vector3::y()), ("z", Vector3::z())] {
        let way = LENGTH * vec2(axis.dot(&camera.right()), -axis.dot(&camera.up()));
        let stroke = egui::Stroke::new(1.5, theme::DARK.text_weak);
        painter.line_segment([origin, origin + way], stroke);
        painter.circle_filled(origin + way, 2.5, theme::DARK.text_weak);
        let place = origin + way + way.normalized() * 10.0;
        painter.text(place, Align2::CENTER_CENTER, name, theme::regular(13.0), theme::DARK.text);
    }
}

/// Width of the buttons at the lower right, with the margins of the hint.
const BUTTONS: f32 = 360.0;

/// Returns what mouse and keys do in this view while no instrument is driven: the endoscope's camera does not turn.
fn controls(live: &LiveState, view: &SceneView) -> String {
    let camera = match view.look {
        CameraLook::Endoscope => text::field::RESET_VIEW.get(),
        CameraLook::Free => text::field::VIEW_HOVER.get(),
    };
    if view.lead.restarts(live) { text::field::with_restart(camera) } else { camera.to_owned() }
}

/// Draws the hint at the bottom: possible actions, or the reason why nothing is drawn.
pub(super) fn hint(painter: &Painter, rect: Rect, live: &LiveState, view: &SceneView) {
    let (words, colour) = match &view.problem {
        Some(problem) => (text::field::not_drawn(problem), theme::DARK.text),
        None if view.lead.is_on() => {
            (text::field::lead_hover(live.scene.objects.is_some(), live.is_bimanual()), theme::DARK.text)
        }
        // Not during a study trial, where it would reveal the mode.
        None if view.arrows && training::needs_another_mode(live) => {
            (format!("{}\n{}", text::training::CHOOSE_MATCHED.get(), controls(live, view)), theme::DARK.text)
        }
        None => (controls(live, view), theme::DARK.text_weak),
    };
    let font = theme::regular(12.5);
    // A hint that would reach the buttons is drawn above them.
    let reaches = width_of(painter, &words, font.clone()) > rect.width() - BUTTONS;
    let up = if reaches { 54.0 } else { 12.0 };
    let font = fitting(painter, &words, font, rect.width() - 32.0);
    // In a low view, the figures need the room more than a hint that only helps.
    let lines = words.lines().count() as f32;
    let is_weak = colour == theme::DARK.text_weak;
    if is_weak && view.figures && rect.height() < READINGS_HEIGHT + up + lines * 1.3 * font.size {
        return;
    }
    label(painter, rect.left_bottom() + vec2(16.0, -up), Align2::LEFT_BOTTOM, &words, font, colour);
}
