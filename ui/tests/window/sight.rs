//! Vision of a player: positions of colours in an image of the screen.
#![cfg(target_os = "linux")]
use egui::{Pos2, Rect, vec2};

/// Colour of the circle around the driven tip, and the width, points, that separates it from a double circle.
const MARK: [u8; 3] = [0x9c, 0xe8, 0x7a];
const MARK_PIXELS: usize = 20;
const DOUBLE: f32 = 27.0;

/// Part of the screen.
pub(super) struct Picture {
    pub(super) corner: Pos2,
    pub(super) width: usize,
    pub(super) rgb: Vec<u8>,
}

impl Picture {
    /// Centres of the pixels of such a colour.
    pub(super) fn places(&self, is_so: impl Fn([u8; 3]) -> bool) -> Vec<Pos2> {
        let pixels = self.rgb.chunks_exact(3).enumerate();
        let wanted = pixels.filter(|(_, pixel)| is_so([pixel[0], pixel[1], pixel[2]]));
        let place = |i: usize| self.corner + vec2((i % self.width) as f32 + 0.5, (i / self.width) as f32 + 0.5);
        wanted.map(|(i, _)| place(i)).collect()
    }

    /// Returns the centre of the circle around the tip, and whether the circle is double, which means that the jaws
    /// hold a ring.
    pub(super) fn mark(&self) -> Option<(Pos2, bool)> {
        let places = self.places(|pixel| pixel == MARK);
        let around = around(&places).filter(|_| places.len() >= MARK_PIXELS)?;
        Some((around.center(), around.width() > DOUBLE))
    }
}

/// Returns the rectangle around these positions; `None` if there are none.
pub(super) fn around(places: &[Pos2]) -> Option<Rect> {
    (!places.is_empty()).then(|| Rect::from_points(places))
}

/// Returns whether this is the colour of a ring away from all jaws, whatever its lighting.
pub(super) fn is_of_ring([r, g, b]: [u8; 3]) -> bool {
    let [r, g, b] = [r, g, b].map(i32::from);
    r > g + 25 && g > b + 12
}

/// Returns the circle, the line and the mark below, where nothing else is green.
pub(super) fn is_green([r, g, b]: [u8; 3]) -> bool {
    let [r, g, b] = [r, g, b].map(i32::from);
    g > r + 20 && g > b + 25
}
