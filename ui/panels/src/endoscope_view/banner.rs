//! Texts over the image, away from the tips.

use egui::{Align2, Color32, Painter, Rect, vec2};
use nima_screen::theme;

/// Font sizes of problem and remedy, points.
const WRONG_SIZE: f32 = 24.0;
const CURE_SIZE: f32 = 16.0;
/// Distance of a text from the edge of the image, and from a tip, points.
pub(super) const MARGIN: f32 = 16.0;
const CLEAR: f32 = 24.0;

/// Draws the problem, large, and the remedy.
pub(super) fn wrong_ui(painter: &Painter, over: Rect, tips: &[egui::Pos2], [report, cure]: [&str; 2], colour: Color32) {
    let inner = over.shrink(MARGIN);
    let places = [
        (inner.center_top() + vec2(0.0, MARGIN), Align2::CENTER_TOP),
        (inner.center_bottom() - vec2(0.0, 4.0 * MARGIN), Align2::CENTER_BOTTOM),
        (inner.left_center(), Align2::LEFT_CENTER),
        (inner.right_center(), Align2::RIGHT_CENTER),
    ];
    plate(painter, &places, tips, &[(report, WRONG_SIZE, colour), (cure, CURE_SIZE, theme::DARK.text)]);
}

/// Draws text on a dark ground, readable over any tissue, at the first of these places that covers no tip.
pub(super) fn plate(
    painter: &Painter,
    places: &[(egui::Pos2, Align2)],
    tips: &[egui::Pos2],
    lines: &[(&str, f32, Color32)],
) {
    let width = (painter.clip_rect().width() - 4.0 * MARGIN).max(100.0);
    let lines = lines.iter().filter(|(words, ..)| !words.is_empty()).map(|(words, size, colour)| {
        let font = if *size > CURE_SIZE { theme::strong(*size) } else { theme::regular(*size) };
        (painter.layout((*words).to_owned(), font, *colour, width), *colour)
    });
    let lines: Vec<_> = lines.collect();
    let size =
        lines.iter().fold(egui::Vec2::ZERO, |size, (line, _)| vec2(size.x.max(line.size().x), size.y + line.size().y));
    let rects = places.iter().map(|(at, align)| (align.anchor_size(*at, size + vec2(20.0, 12.0)), *align));
    let is_clear = |rect: &Rect| !tips.iter().any(|tip| rect.expand(CLEAR).contains(*tip));
    let mut rects = rects.collect::<Vec<_>>().into_iter();
    let Some(first) = rects.clone().find(|(rect, _)| is_clear(rect)).or_else(|| rects.next()) else { return };
    let (rect, align) = first;
    painter.rect_filled(rect, theme::CORNER, theme::VEIL);
    let mut top = rect.top() + 6.0;
    for (line, colour) in lines {
        let inner = rect.shrink2(vec2(10.0, 0.0));
        let left = match align.x() {
            egui::Align::Min => inner.left(),
            egui::Align::Center => inner.center().x - 0.5 * line.size().x,
            egui::Align::Max => inner.right() - line.size().x,
        };
        let height = line.size().y;
        painter.galley(egui::pos2(left, top), line, colour);
        top += height;
    }
}
