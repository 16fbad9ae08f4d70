//! Where the picture is on the screen: as large as it can be, mirrored and turned as the rig file says.

use egui::{Pos2, Rect, Vec2, pos2, vec2};
use nalgebra::Vector2;
use nima_machine::config::Endoscope;

/// The picture on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) rect: Rect,
    size_px: [usize; 2],
    rotation_deg: u16,
    mirror: bool,
}

impl Place {
    pub(super) fn new(view: Rect, size_px: [usize; 2], endoscope: &Endoscope) -> Self {
        let (rotation_deg, mirror) = (endoscope.rotation_deg, endoscope.mirror);
        let [width, height] = size_px.map(|side| side.max(1) as f32);
        let size = if matches!(rotation_deg, 90 | 270) { vec2(height, width) } else { vec2(width, height) };
        let scale = (view.width() / size.x).min(view.height() / size.y).max(0.0);
        Self { rect: Rect::from_center_size(view.center(), size * scale), size_px, rotation_deg, mirror }
    }

    /// Where a pixel of the picture is.
    pub(super) fn at(&self, place_px: &Vector2<f64>) -> Pos2 {
        let [width, height] = self.size_px.map(|side| side as f64);
        self.of_share(pos2((place_px.x / width) as f32, (place_px.y / height) as f32))
    }

    /// The corners of the picture, as shares of its sides, and where they are.
    pub(super) fn corners(&self) -> [(Pos2, Pos2); 4] {
        [pos2(0.0, 0.0), pos2(1.0, 0.0), pos2(0.0, 1.0), pos2(1.0, 1.0)].map(|corner| (corner, self.of_share(corner)))
    }

    fn of_share(&self, share: Pos2) -> Pos2 {
        let x = if self.mirror { 1.0 - share.x } else { share.x };
        let turned: Vec2 = match self.rotation_deg {
            90 => vec2(1.0 - share.y, x),
            180 => vec2(1.0 - x, 1.0 - share.y),
            270 => vec2(share.y, 1.0 - x),
            _ => vec2(x, share.y),
        };
        self.rect.min + turned * self.rect.size()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(rotation_deg: u16, mirror: bool) -> Place {
        let endoscope = Endoscope { rotation_deg, mirror, ..Endoscope::default() };
        Place::new(Rect::from_min_size(pos2(100.0, 50.0), vec2(1000.0, 400.0)), [1280, 720], &endoscope)
    }

    #[test]
    fn the_picture_fills_the_view_with_its_own_proportions() {
        let place = place(0, false);
        assert!((place.rect.height() - 400.0).abs() < 1e-3 && (place.rect.width() - 711.1).abs() < 0.1);
        assert_eq!(place.rect.center(), pos2(600.0, 250.0));
        assert!((place.at(&Vector2::new(640.0, 360.0)) - place.rect.center()).length() < 1e-3);
    }

    #[test]
    fn a_turned_and_a_mirrored_picture_has_its_corners_where_they_belong() {
        let near = |place: Place, x, y, corner: Pos2| (place.at(&Vector2::new(x, y)) - corner).length() < 1e-2;
        let turned = place(90, false);
        assert!(turned.rect.width() < turned.rect.height());
        // Turned clockwise, the upper left corner is on the upper right.
        assert!(
            near(turned, 0.0, 0.0, turned.rect.right_top()) && near(turned, 1280.0, 0.0, turned.rect.right_bottom())
        );
        let back = place(270, false);
        assert!(near(back, 0.0, 0.0, back.rect.left_bottom()));
        let over = place(180, false);
        assert!(near(over, 0.0, 0.0, over.rect.right_bottom()));
        let mirrored = place(0, true);
        assert!(
            near(mirrored, 0.0, 0.0, mirrored.rect.right_top())
                && near(mirrored, 0.0, 720.0, mirrored.rect.right_bottom())
        );
    }
}
