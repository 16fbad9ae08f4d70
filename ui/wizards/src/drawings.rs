//! Drawings for guidance: the tool in the requested orientation, a sphere with the recorded directions, and maps of the
//! coverage.

use egui::{
    Align, Align2, Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, epaint::TextShape, lerp, pos2,
    text::LayoutJob, vec2,
};
use nalgebra::{UnitQuaternion, Vector3};
use nima_core::tip_force::{CoverageMap, MAP};
use nima_screen::{theme, widgets::fitting};
use nima_words::text;

/// Projection for a viewer in front of the base, slightly to the right and above (`world`: x to the right, z up).
pub(super) fn on_paper(centre: Pos2, scale: f32, point: &Vector3<f64>) -> (Pos2, f64) {
    let turn = 0.45_f64;
    let raise = 0.38_f64;
    let right = point.x * turn.cos() + point.y * turn.sin();
    let away = -point.x * turn.sin() + point.y * turn.cos();
    let up = point.z * raise.cos() + away * raise.sin();
    let depth = away * raise.cos() - point.z * raise.sin();
    (pos2(centre.x + right as f32 * scale, centre.y - up as f32 * scale), depth)
}

/// Height of the drawing of a pose.
pub(super) const POSE_HEIGHT: f32 = 250.0;

/// Draws the tool in its current orientation (solid) and in the requested one (outline), with the angle between them.
pub(super) fn pose_image(ui: &mut Ui, target: Option<&UnitQuaternion<f64>>, held: Option<&UnitQuaternion<f64>>) {
    let size = vec2(ui.available_width().min(320.0), POSE_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, text::wizards::POSE_IMAGE.get()));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, theme::CORNER, theme::now().groove);
    let centre = rect.center() - vec2(0.0, 22.0);
    let scale = rect.height() * 0.31;
    ground(&painter, centre, scale);
    if let Some(target) = target {
        tool(&painter, centre, scale, target, false);
    }
    if let Some(held) = held {
        tool(&painter, centre, scale, held, true);
    }
    let caption = match (target, held) {
        (Some(target), Some(held)) => {
            let tilt = (target.inverse() * -Vector3::z()).angle(&(held.inverse() * -Vector3::z()));
            text::wizards::tilt_off(tilt.to_degrees())
        }
        (None, Some(_)) => text::wizards::POSE_HELD.get().to_owned(),
        _ => text::wizards::POSE_UNKNOWN.get().to_owned(),
    };
    caption_below(&painter, rect, &caption);
}

fn caption_below(painter: &Painter, rect: Rect, words: &str) {
    let place = rect.center_bottom() - vec2(0.0, 8.0);
    let ink = theme::now().text_weak;
    let mut job = LayoutJob::simple(words.to_owned(), theme::regular(12.5), ink, rect.width() - 8.0);
    job.halign = Align::Center;
    let galley = painter.layout_job(job);
    painter.galley(place - vec2(0.0, galley.size().y), galley, ink);
}

/// Draws a square on the floor and a vertical line, to show the orientation.
fn ground(painter: &Painter, centre: Pos2, scale: f32) {
    let corner = |x: f64, y: f64| on_paper(centre, scale, &Vector3::new(x, y, -1.15)).0;
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    painter.add(Shape::convex_polygon(corners, theme::now().panel, Stroke::new(1.0, theme::now().line)));
    let top = on_paper(centre, scale, &Vector3::z()).0;
    let bottom = corner(0.0, 0.0);
    painter.extend(Shape::dashed_line(&[top, bottom], Stroke::new(1.0, theme::now().line), 5.0, 5.0));
}

/// Draws the sensor (a disc with its x axis marked), the shaft along z, and a jaw at the end.
fn tool(painter: &Painter, centre: Pos2, scale: f32, world_from_s1: &UnitQuaternion<f64>, solid: bool) {
    let at = |x: f64, y: f64, z: f64| on_paper(centre, scale, &(world_from_s1 * Vector3::new(x, y, z))).0;
    let (colour, width) = if solid { (theme::now().measured, 3.0) } else { (theme::now().rendered, 1.5) };
    let stroke = Stroke::new(width, colour);
    let ring = (0..24).map(|i| {
        let angle = std::f64::consts::TAU * f64::from(i) / 24.0;
        at(0.28 * angle.cos(), 0.28 * angle.sin(), 0.0)
    });
    let fill = if solid { theme::now().control } else { egui::Color32::TRANSPARENT };
    painter.add(Shape::convex_polygon(ring.collect(), fill, stroke));
    let shaft = [at(0.0, 0.0, 0.0), at(0.0, 0.0, 0.95)];
    if solid {
        painter.line_segment(shaft, stroke);
    } else {
        painter.extend(Shape::dashed_line(&shaft, stroke, 7.0, 4.0));
    }
    for side in [-0.08, 0.08] {
        painter.line_segment([at(0.0, 0.0, 0.95), at(side, 0.0, 1.12)], stroke);
    }
    // The sensor's x axis, which shows rotation about the shaft; the required pose has the names of the sides.
    painter.line_segment([at(0.28, 0.0, 0.0), at(0.46, 0.0, 0.0)], stroke);
    if !solid {
        painter.line_segment([at(0.0, 0.28, 0.0), at(0.0, 0.46, 0.0)], stroke);
        for (place, name) in [(at(0.62, 0.0, 0.0), "+x"), (at(0.0, 0.62, 0.0), "+y")] {
            painter.text(place, Align2::CENTER_CENTER, name, theme::strong(14.0), colour);
        }
    }
}

/// Draws directions on a sphere: requested ones as rings, recorded ones as discs; hollow on the far side.
pub(super) fn sphere_image(
    ui: &mut Ui,
    name: &str,
    wanted: &[Vector3<f64>],
    taken: &[Vector3<f64>],
    now: Option<Vector3<f64>>,
) {
    let size = vec2(ui.available_width().min(320.0), 250.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let words = text::wizards::recorded(name, taken.len());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, words.clone()));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, theme::CORNER, theme::now().groove);
    let centre = rect.center() - vec2(0.0, 6.0);
    let scale = rect.height() * 0.37;
    painter.circle_stroke(centre, scale, Stroke::new(1.0, theme::now().text_weak));
    graticule(&painter, centre, scale);
    for direction in wanted {
        dot(&painter, centre, scale, direction, 7.0, Stroke::new(1.2, theme::now().reference), false);
    }
    for direction in taken {
        dot(&painter, centre, scale, direction, 4.5, Stroke::new(1.5, theme::now().engaged), true);
    }
    if let Some(direction) = now {
        dot(&painter, centre, scale, &direction, 3.5, Stroke::new(1.5, theme::now().measured), true);
    }
    let caption = text::wizards::rings_and_discs(name);
    caption_below(&painter, rect, &caption);
}

/// Draws the equator and two meridians; only their front parts.
fn graticule(painter: &Painter, centre: Pos2, scale: f32) {
    let circles: [fn(f64) -> Vector3<f64>; 3] = [
        |a| Vector3::new(a.cos(), a.sin(), 0.0),
        |a| Vector3::new(a.cos(), 0.0, a.sin()),
        |a| Vector3::new(0.0, a.cos(), a.sin()),
    ];
    for circle in circles {
        let points: Vec<(Pos2, f64)> =
            (0..=72).map(|i| on_paper(centre, scale, &circle(std::f64::consts::TAU * f64::from(i) / 72.0))).collect();
        for pair in points.windows(2).filter(|pair| pair[0].1 <= 0.0 && pair[1].1 <= 0.0) {
            painter.line_segment([pair[0].0, pair[1].0], Stroke::new(1.0, theme::now().line));
        }
    }
}

fn dot(
    painter: &Painter,
    centre: Pos2,
    scale: f32,
    direction: &Vector3<f64>,
    radius: f32,
    stroke: Stroke,
    filled: bool,
) {
    let Some(direction) = direction.try_normalize(1e-9) else { return };
    let (place, depth) = on_paper(centre, scale, &direction);
    if filled && depth <= 0.0 {
        painter.circle_filled(place, radius, stroke.color);
    } else {
        painter.circle_stroke(place, radius, stroke);
    }
}

/// Draws a progress bar with a text inside.
pub fn progress(ui: &mut Ui, name: &str, fraction: f64, words: &str) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 24.0), Sense::hover());
    let label = format!("{name}: {words}");
    response.widget_info(|| WidgetInfo::labeled(egui::Role::ProgressIndicator, true, label.clone()));
    let painter = ui.painter();
    painter.rect_filled(rect, 4.0, theme::now().groove);
    let fraction = if fraction.is_finite() { fraction.clamp(0.0, 1.0) as f32 } else { 0.0 };
    let filled = Rect::from_min_size(rect.min, vec2(rect.width() * fraction, rect.height()));
    painter.rect_filled(filled, 4.0, theme::now().selected);
    let font = fitting(painter, &label, theme::regular(13.0), rect.width() - 8.0);
    painter.text(rect.center(), Align2::CENTER_CENTER, label, font, theme::now().text);
}

/// Number of rows in a cell of a map at which it has full brightness.
const BRIGHTEST: f32 = 1000.0;
/// Space for the texts below and left of a map.
const BELOW: f32 = 34.0;
const LEFT: f32 = 34.0;

/// Texts of an axis of a map: lowest value, name with unit, highest value.
pub(super) type AxisText = [&'static str; 3];

/// Draws a map of numbers of rows: dark where there are none, brighter with their number (logarithmic).
pub(super) fn heat_map(ui: &mut Ui, width: f32, title: &str, map: &CoverageMap, [across, up]: [AxisText; 2]) {
    let (rect, response) = ui.allocate_exact_size(vec2(width, width - LEFT + BELOW + 20.0), Sense::hover());
    let words = text::wizards::fields_filled(title, map.filled(), MAP * MAP);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, words.clone()));
    response.on_hover_text(words);
    let painter = ui.painter_at(rect);
    let side = width - LEFT - 2.0;
    let field = Rect::from_min_size(rect.min + vec2(LEFT, 20.0), vec2(side, side));
    let heading = fitting(&painter, title, theme::strong(13.0), side);
    painter.text(rect.left_top() + vec2(LEFT, 0.0), Align2::LEFT_TOP, title, heading, theme::now().text);
    painter.rect_filled(field, 2.0, theme::now().groove);
    let cell = side / MAP as f32;
    for (row, counts) in map.counts.iter().enumerate() {
        for (column, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let corner = pos2(field.left() + column as f32 * cell, field.bottom() - (row + 1) as f32 * cell);
            let fraction = ((1.0 + *count as f32).ln() / (1.0 + BRIGHTEST).ln()).min(1.0);
            painter.rect_filled(Rect::from_min_size(corner, vec2(cell - 0.5, cell - 0.5)), 0.0, heat(fraction));
        }
    }
    painter.rect_stroke(field, 2.0, Stroke::new(1.0, theme::now().line), egui::StrokeKind::Outside);
    axis_text(&painter, field, across, up);
}

/// Returns the colour of a cell, from dark to bright.
fn heat(fraction: f32) -> Color32 {
    let [from, to] = [theme::now().selected, theme::now().measured].map(|colour| colour.to_array());
    let mix = |k: usize| lerp(f32::from(from[k])..=f32::from(to[k]), fraction) as u8;
    Color32::from_rgb(mix(0), mix(1), mix(2))
}

fn axis_text(painter: &Painter, field: Rect, across: AxisText, up: AxisText) {
    let font = theme::regular(11.5);
    let below = field.bottom() + 3.0;
    let places = [
        (field.left(), Align2::LEFT_TOP, across[0], 0.0),
        (field.right(), Align2::RIGHT_TOP, across[2], 0.0),
        (field.center().x, Align2::CENTER_TOP, across[1], 14.0),
    ];
    for (x, anchor, words, lower) in places {
        let font = fitting(painter, words, font.clone(), field.width());
        painter.text(pos2(x, below + lower), anchor, words, font, theme::now().text_weak);
    }
    let left = field.left() - 3.0;
    for (y, anchor, words) in [(field.bottom(), Align2::RIGHT_BOTTOM, up[0]), (field.top(), Align2::RIGHT_TOP, up[2])] {
        painter.text(pos2(left, y), anchor, words, font.clone(), theme::now().text_weak);
    }
    let font = fitting(painter, up[1], font, field.height());
    let name = painter.layout_no_wrap(up[1].to_owned(), font, theme::now().text_weak);
    let place = pos2(field.left() - 18.0 - 0.5 * name.size().y, field.center().y + 0.5 * name.size().x);
    painter.add(TextShape::new(place, name, theme::now().text_weak).with_angle(-std::f32::consts::FRAC_PI_2));
}
