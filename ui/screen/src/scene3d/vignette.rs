//! The round image of an endoscope: black outside a disc with a soft rim.

use egui::{Color32, Mesh, Painter, Pos2, Rect, Shape, layers::ShapeIdx, pos2};
use nalgebra::Matrix4;

/// Radius of the disc, in heights of the view: the disc is slightly cut off above and below, as on the monitors of an
/// operating room.
const RADIUS: f32 = 0.60;
/// Width of the rim in which the image fades, in radii.
const RIM: f32 = 0.05;
const SIDES: u32 = 96;

/// Returns the radius of the undimmed part, and of the visible part, points.
fn radii(rect: Rect) -> [f32; 2] {
    // In a view that is higher than wide, the disc is as wide as the view.
    let radius = (RADIUS * rect.height()).min(RADIUS * rect.width());
    [radius * (1.0 - RIM), radius]
}

/// Returns the part of a view with the disc: nothing is drawn or changes outside it.
pub(super) fn part_of(rect: Rect) -> Rect {
    let [_, dark] = radii(rect);
    // Round to whole points, so that the edges coincide with pixel edges.
    let half = (dark.ceil() + 1.0).min(0.5 * rect.width());
    let left = (rect.center().x - half).floor();
    let right = (rect.center().x + half).ceil();
    Rect::from_x_y_ranges(left.max(rect.left())..=right.min(rect.right()), rect.y_range())
}

/// Returns the transformation from the clip space of a view to that of a part of its width.
pub(super) fn part_from_whole(part: Rect, whole: Rect) -> Matrix4<f32> {
    let wider = whole.width() / part.width().max(1.0);
    let aside = 2.0 * (whole.center().x - part.center().x) / part.width().max(1.0);
    let mut matrix = Matrix4::identity();
    matrix[(0, 0)] = wider;
    matrix[(0, 3)] = aside;
    matrix
}

/// Returns whether a position, with this much room around it, is in the undimmed part of the image.
#[cfg(test)]
pub(super) fn shows(rect: Rect, place: Pos2, room: f32) -> bool {
    let [clear, _] = radii(rect);
    rect.shrink(room).contains(place) && (place - rect.center()).length() + room <= clear
}

/// Reserves the place of the vignette, below everything that is painted after this call.
pub(super) fn reserve(painter: &Painter) -> [ShapeIdx; 2] {
    [painter.add(Shape::Noop), painter.add(Shape::Noop)]
}

/// Covers the area outside the disc, in the reserved place.
pub(super) fn paint(painter: &Painter, rect: Rect, [at_sides, at_rim]: [ShapeIdx; 2]) {
    let [clear, dark] = radii(rect);
    let part = part_of(rect);
    let sides = [rect.left()..=part.left(), part.right()..=rect.right()];
    let black = |x: std::ops::RangeInclusive<f32>| {
        Shape::rect_filled(Rect::from_x_y_ranges(x, rect.y_range()), 0.0, Color32::BLACK)
    };
    painter.set(at_sides, Shape::Vec(sides.map(black).into()));
    let beyond = part.size().length().max(dark + 1.0);
    let mut mesh = Mesh::default();
    let rings = [(clear, Color32::TRANSPARENT), (dark, Color32::BLACK), (beyond, Color32::BLACK)];
    for side in 0..=SIDES {
        let (sin, cos) = (std::f32::consts::TAU * side as f32 / SIDES as f32).sin_cos();
        for (radius, colour) in rings {
            let place: Pos2 = pos2(rect.center().x + radius * cos, rect.center().y + radius * sin);
            mesh.colored_vertex(place, colour);
        }
    }
    for side in 0..SIDES {
        for ring in 0..2 {
            let [a, b] = [3 * side + ring, 3 * (side + 1) + ring];
            mesh.add_triangle(a, b, a + 1);
            mesh.add_triangle(a + 1, b, b + 1);
        }
    }
    painter.with_clip_rect(part).set(at_rim, Shape::mesh(mesh));
}

#[cfg(test)]
mod tests {
    use egui::vec2;
    use nalgebra::Vector4;

    use super::*;

    #[test]
    fn the_disc_fills_the_height_of_a_wide_view_and_the_width_of_a_narrow_one() {
        for size in [vec2(1600.0, 700.0), vec2(300.0, 900.0)] {
            let [clear, dark] = radii(Rect::from_min_size(Pos2::ZERO, size));
            let min = size.x.min(size.y);
            assert!(clear < dark && clear > 0.5 * min && dark < 0.7 * min, "{size:?}: {clear} {dark}");
            let rect = Rect::from_min_size(pos2(13.0, 7.0), size);
            let part = part_of(rect);
            assert!(rect.contains_rect(part) && (part.height() - size.y).abs() < 1e-6, "{part}");
            let whole = (2.0 * dark).min(size.x);
            assert!((whole..=whole + 5.0).contains(&part.width()), "{part}");
            assert!((part.center().x - rect.center().x).abs() <= 0.5, "{part}");
            let (place, clip) =
                (rect.center() + vec2(0.2 * size.y, 0.0), Vector4::new(0.4 * size.y / size.x, 0.0, 0.0, 1.0));
            let x = (part_from_whole(part, rect) * clip).x;
            assert!((part.center().x + 0.5 * x * part.width() - place.x).abs() < 0.01, "the same place in the window");
        }
    }
}
