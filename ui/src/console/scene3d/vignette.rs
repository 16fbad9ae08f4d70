//! The round picture of an endoscope: outside of a disc with a soft rim there is nothing to see.

use egui::{Color32, Mesh, Painter, Pos2, Rect, Shape, pos2};

/// Radius of the disc, in heights of the view: the disc is a little cut off above and below, as on the monitors of an operating room.
const RADIUS: f32 = 0.60;
/// Width of the rim in which the picture fades, in radii.
const RIM: f32 = 0.05;
const SIDES: u32 = 96;

/// Radius of what is seen undimmed, and of what is seen at all, points.
fn radii(rect: Rect) -> [f32; 2] {
    // In a view that is higher than wide the disc is as wide as the view.
    let radius = (RADIUS * rect.height()).min(RADIUS * rect.width());
    [radius * (1.0 - RIM), radius]
}

/// Share of the width of a view that the disc takes.
pub(super) fn share_of_width(rect: Rect) -> f32 {
    let [_, dark] = radii(rect);
    (2.0 * dark / rect.width().max(1.0)).clamp(0.0, 1.0)
}

/// Whether a place, with so much room around it, is in the undimmed part of the picture.
#[cfg(test)]
pub(super) fn shows(rect: Rect, place: Pos2, room: f32) -> bool {
    let [clear, _] = radii(rect);
    rect.shrink(room).contains(place) && (place - rect.center()).length() + room <= clear
}

/// Covers what an endoscope does not show.
pub(super) fn paint(painter: &Painter, rect: Rect) {
    let [clear, dark] = radii(rect);
    let beyond = rect.size().length().max(dark + 1.0);
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
    painter.add(Shape::mesh(mesh));
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    #[test]
    fn the_disc_fills_the_height_of_a_wide_view_and_the_width_of_a_narrow_one() {
        for size in [vec2(1600.0, 700.0), vec2(300.0, 900.0)] {
            let [clear, dark] = radii(Rect::from_min_size(Pos2::ZERO, size));
            let least = size.x.min(size.y);
            assert!(clear < dark && clear > 0.5 * least && dark < 0.7 * least, "{size:?}: {clear} {dark}");
            let share = share_of_width(Rect::from_min_size(Pos2::ZERO, size));
            assert!((share - (2.0 * dark / size.x).min(1.0)).abs() < 1e-6, "{share}");
        }
    }
}
