//! The visible part of the image: chosen with wheel and mouse.

use egui::{Pos2, Rect, Response, Vec2, vec2};

use super::place::ImagePlacement;

/// Maximum zoom.
const ZOOM_MAX: f32 = 8.0;
const TWICE: f32 = 250.0;

/// Zoom, and centre of the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ImageZoom {
    /// 1: the whole image.
    pub(super) zoom: f32,
    /// Position in the displayed image, as fractions of its sides.
    pub(super) middle: Vec2,
}

impl Default for ImageZoom {
    fn default() -> Self {
        Self { zoom: 1.0, middle: vec2(0.5, 0.5) }
    }
}

impl ImageZoom {
    pub(super) fn is_zoomed(&self) -> bool {
        self.zoom > 1.001
    }

    /// Returns the position of the whole image, if it fits into the view as `whole` without zoom. It never leaves a gap
    /// that zoom 1 does not have.
    pub(super) fn full(&self, view: Rect, whole: Vec2) -> Rect {
        let size = whole * self.zoom;
        let along = |view: egui::Rangef, size: f32, middle: f32| {
            let free = view.span() - size;
            let min = view.center() - middle * size;
            if free >= 0.0 { view.min + 0.5 * free } else { min.clamp(view.min + free, view.min) }
        };
        let min =
            egui::pos2(along(view.x_range(), size.x, self.middle.x), along(view.y_range(), size.y, self.middle.y));
        Rect::from_min_size(min, size)
    }

    /// Applies wheel, drag and double click over the image.
    pub(super) fn obey(&mut self, response: &Response, view: Rect, place: &ImagePlacement) {
        if response.double_clicked() {
            *self = Self::default();
            return;
        }
        // Store the clamped position.
        self.middle = fraction(place.full, view.center());
        if response.dragged() && self.is_zoomed() {
            self.middle -= response.drag_delta() / place.full.size();
        }
        let turned = if response.hovered() { response.ctx.input(|input| input.smooth_scroll_delta.y) } else { 0.0 };
        let pointer = response.hover_pos().filter(|_| turned != 0.0);
        if let Some(pointer) = pointer {
            self.zoom_at(pointer, 2.0_f32.powf(turned / TWICE), view, place);
        }
    }

    /// Keeps the point under the pointer in place.
    fn zoom_at(&mut self, pointer: Pos2, factor: f32, view: Rect, place: &ImagePlacement) {
        let before = self.zoom;
        self.zoom = (self.zoom * factor).clamp(1.0, ZOOM_MAX);
        let size = place.full.size() * (self.zoom / before);
        self.middle = fraction(place.full, pointer) + (view.center() - pointer) / size;
    }
}

/// Returns a screen position as fractions of a rectangle.
fn fraction(of: Rect, at: Pos2) -> Vec2 {
    (at - of.min) / of.size().max(Vec2::splat(1.0))
}

#[cfg(test)]
mod tests {
    use egui::pos2;
    use nima_machine::config::EndoscopeConfig;

    use super::*;

    const SIZE_PX: [usize; 2] = [1280, 720];

    fn view() -> Rect {
        Rect::from_min_size(pos2(100.0, 50.0), vec2(1000.0, 400.0))
    }

    fn place(aim: ImageZoom) -> ImagePlacement {
        ImagePlacement::new(view(), SIZE_PX, &EndoscopeConfig::default(), [0.0; 4], aim)
    }

    #[test]
    fn what_is_under_the_pointer_stays_there() {
        let mut aim = ImageZoom::default();
        let under = |place: &ImagePlacement, at: Pos2| fraction(place.full, at);
        let pointer = pos2(560.0, 300.0);
        for factor in [1.7, 1.5, 2.0, 0.6] {
            let before = place(aim);
            aim.zoom_at(pointer, factor, view(), &before);
            let after = place(aim);
            // An image narrower than the view stays centred.
            if after.full.width() > view().width() {
                let miss = under(&before, pointer) - under(&after, pointer);
                assert!(before.full.width() < view().width() || miss.length() < 1e-4, "{miss:?}");
            }
        }
        assert!((aim.zoom - 1.7 * 1.5 * 2.0 * 0.6).abs() < 1e-3);
    }

    #[test]
    fn it_ends_at_the_picture_and_at_eight_times() {
        let mut aim = ImageZoom::default();
        aim.zoom_at(view().center(), 0.3, view(), &place(aim));
        assert!((aim.zoom - 1.0).abs() < 1e-6);
        aim.zoom_at(view().center(), 100.0, view(), &place(aim));
        assert!((aim.zoom - ZOOM_MAX).abs() < 1e-6);
        aim.middle = vec2(-3.0, 9.0);
        let full = place(aim).full;
        assert!(full.contains_rect(view()), "no gap: {full:?}");
        assert!((full.min.x - view().min.x).abs() < 1e-3 && (full.max.y - view().max.y).abs() < 1e-3);
    }
}
