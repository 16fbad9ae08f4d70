//! Position of the image on the screen: cropped, mirrored and rotated as in the rig file, as large as possible or zoomed.

use egui::{Pos2, Rect, Vec2, pos2, vec2};
use nalgebra::Vector2;
use nima_machine::config::EndoscopeConfig;

use super::aim::ImageZoom;

/// Minimum remaining part of an image along a side, as a fraction.
const MIN: f32 = 0.1;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ImagePlacement {
    /// Visible part.
    pub(super) rect: Rect,
    /// Start and end of this part in the width of the whole image.
    fraction: [f32; 2],
    /// Position of the whole uncropped area.
    pub(super) full: Rect,
    /// Uncropped area, as fractions of the image's sides.
    part: Rect,
    size_px: [usize; 2],
    rotation_deg: u16,
    mirror: bool,
}

impl ImagePlacement {
    /// In this view; `crop` cuts off these fractions at the left, top, right and bottom of the camera image, unless the rig
    /// file cuts off more.
    pub(super) fn new(
        view: Rect,
        size_px: [usize; 2],
        endoscope: &EndoscopeConfig,
        crop: [f32; 4],
        aim: ImageZoom,
    ) -> Self {
        let rotation_deg = endoscope.rotation_deg;
        let mirror = endoscope.mirror;
        let part = part(size_px, endoscope.crop_px, crop);
        let [width, height] = size_px.map(|side| side.max(1) as f32);
        let width = width * part.width();
        let height = height * part.height();
        let size = if matches!(rotation_deg, 90 | 270) { vec2(height, width) } else { vec2(width, height) };
        let scale = (view.width() / size.x).min(view.height() / size.y).max(0.0);
        let full = aim.full(view, size * scale);
        Self { rect: full.intersect(view), full, part, fraction: [0.0, 1.0], size_px, rotation_deg, mirror }
    }

    /// Creates the same position for a part of an image.
    pub(super) const fn of_fraction(self, fraction: [f32; 2]) -> Self {
        Self { fraction, ..self }
    }

    /// Returns the screen position of an image pixel.
    pub(super) fn at(&self, place_px: &Vector2<f64>) -> Pos2 {
        let [width, height] = self.size_px.map(|side| side as f64);
        self.turned(pos2((place_px.x / width) as f32, (place_px.y / height) as f32))
    }

    /// Returns the corners of the uncropped area, as fractions of the whole image's sides, and their positions.
    pub(super) fn corners(&self) -> [(Pos2, Pos2); 4] {
        let [from, to] = self.fraction;
        let Rect { min, max } = self.part;
        let corners = [min, pos2(max.x, min.y), pos2(min.x, max.y), max];
        corners.map(|corner| (pos2(from + (to - from) * corner.x, corner.y), self.turned(corner)))
    }

    fn turned(&self, fraction: Pos2) -> Pos2 {
        let fraction = (fraction - self.part.min) / self.part.size();
        let x = if self.mirror { 1.0 - fraction.x } else { fraction.x };
        let turned: Vec2 = match self.rotation_deg {
            90 => vec2(1.0 - fraction.y, x),
            180 => vec2(1.0 - x, 1.0 - fraction.y),
            270 => vec2(fraction.y, 1.0 - x),
            _ => vec2(x, fraction.y),
        };
        self.full.min + turned * self.full.size()
    }
}

/// Returns the remaining part of an image. Edges that would leave nothing along a side are not cropped there.
fn part(size_px: [usize; 2], crop_px: [usize; 4], crop: [f32; 4]) -> Rect {
    let along = |low: usize, side: usize| {
        let edge = |edge: usize| {
            let fraction = crop_px[edge] as f32 / size_px[side].max(1) as f32;
            if crop[edge].is_finite() { fraction.max(crop[edge]) } else { fraction }
        };
        let (low, high) = (edge(low), 1.0 - edge(low + 2));
        if high - low >= MIN { (low, high) } else { (0.0, 1.0) }
    };
    let (left, right) = along(0, 0);
    let (top, bottom) = along(1, 1);
    Rect::from_min_max(pos2(left, top), pos2(right, bottom))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(rotation_deg: u16, mirror: bool) -> ImagePlacement {
        let endoscope = EndoscopeConfig { rotation_deg, mirror, ..EndoscopeConfig::default() };
        ImagePlacement::new(
            Rect::from_min_size(pos2(100.0, 50.0), vec2(1000.0, 400.0)),
            [1280, 720],
            &endoscope,
            [0.0; 4],
            ImageZoom::default(),
        )
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
        let near = |place: ImagePlacement, x, y, corner: Pos2| (place.at(&Vector2::new(x, y)) - corner).length() < 1e-2;
        let turned = place(90, false);
        assert!(turned.rect.width() < turned.rect.height());
        // Rotated clockwise, the upper left corner is at the upper right.
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

    #[test]
    fn what_is_cut_off_is_not_shown_and_the_rest_fills_the_view() {
        let endoscope = EndoscopeConfig { crop_px: [160, 0, 0, 0], ..EndoscopeConfig::default() };
        let view = Rect::from_min_size(pos2(0.0, 0.0), vec2(1000.0, 360.0));
        let place = ImagePlacement::new(view, [1280, 720], &endoscope, [0.0, 0.0, 0.25, 0.0], ImageZoom::default());
        assert!((place.rect.width() - 400.0).abs() < 1e-3, "800 of 1280 columns: {:?}", place.rect);
        let near = |x, y, corner: Pos2| (place.at(&Vector2::new(x, y)) - corner).length() < 1e-2;
        assert!(near(160.0, 0.0, place.rect.left_top()) && near(960.0, 720.0, place.rect.right_bottom()));
        let expected = [pos2(0.125, 0.0), pos2(0.75, 0.0), pos2(0.125, 1.0), pos2(0.75, 1.0)];
        assert!(
            place.corners().iter().zip(expected).all(|((fraction, _), corner)| (*fraction - corner).length() < 1e-6)
        );
        // Settings that would leave nothing are ignored.
        let nothing = ImagePlacement::new(view, [100, 720], &endoscope, [0.0, 0.6, 0.0, 0.6], ImageZoom::default());
        assert_eq!(nothing.part, Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)));
    }

    #[test]
    fn a_zoomed_picture_has_its_pixels_where_the_overlay_has_them() {
        let aim = ImageZoom { zoom: 2.0, middle: vec2(0.25, 0.5) };
        let view = Rect::from_min_size(pos2(0.0, 0.0), vec2(640.0, 360.0));
        let place = ImagePlacement::new(view, [1280, 720], &EndoscopeConfig::default(), [0.0; 4], aim);
        assert_eq!(place.rect, view);
        assert!((place.at(&Vector2::new(320.0, 360.0)) - view.center()).length() < 1e-2);
        assert!((place.at(&Vector2::new(330.0, 360.0)) - view.center() - vec2(10.0, 0.0)).length() < 1e-2);
    }
}
