//! The picture of a letter from its outline: what egui asks of `vello_cpu`, whose place this takes.
//!
//! That renderer can do whatever a page may hold, once for each kind of processor: 4 MB of a program that only needs letters, each drawn once,
//! and 40 s of a processor in each clean build. Here `ab_glyph_rasterizer` finds the part of each pixel that an outline covers.
//! Only what egui calls is here, by the names that it calls.
#![warn(missing_docs)]

use ab_glyph_rasterizer::{Rasterizer, point};
pub use kurbo;
use kurbo::{Affine, BezPath, PathEl, Point};

/// An edge stays so close to its curve, pixels.
const TOLERANCE: f64 = 0.02;

/// Colours, as far as they are named.
pub mod color {
    use std::marker::PhantomData;

    /// The usual space of colours.
    #[derive(Clone, Copy, Debug)]
    pub struct Srgb;

    /// A colour. Letters are drawn white: who shows them colours them.
    #[derive(Clone, Copy, Debug)]
    pub struct OpaqueColor<Space>(PhantomData<Space>);

    impl<Space> OpaqueColor<Space> {
        /// White.
        pub const WHITE: Self = Self(PhantomData);
    }
}

/// What is to be drawn, on so many pixels.
pub struct RenderContext {
    rasterizer: Rasterizer,
    transform: Affine,
}

impl RenderContext {
    /// Nothing yet.
    pub fn new(width: u16, height: u16) -> Self {
        Self { rasterizer: Rasterizer::new(width.into(), height.into()), transform: Affine::IDENTITY }
    }

    /// Where the outlines that follow lie.
    pub fn set_transform(&mut self, transform: Affine) {
        self.transform = transform;
    }

    /// The colour of what follows: there is one only.
    pub fn set_paint(&mut self, _: color::OpaqueColor<color::Srgb>) {}

    /// An outline within the picture; what it goes around at least once is inside. Its parts are closed, as letters are.
    pub fn fill_path(&mut self, path: &BezPath) {
        let (mut first, mut last) = (Point::ZERO, Point::ZERO);
        kurbo::flatten(self.transform * path, TOLERANCE, |element| match element {
            PathEl::LineTo(to) => {
                self.edge(last, to);
                last = to;
            }
            PathEl::ClosePath => {
                self.edge(last, first);
                last = first;
            }
            PathEl::MoveTo(to) => {
                self.edge(last, first);
                (first, last) = (to, to);
            }
            // Curves come as lines.
            PathEl::QuadTo(..) | PathEl::CurveTo(..) => {}
        });
        self.edge(last, first);
    }

    fn edge(&mut self, from: Point, to: Point) {
        if from.is_finite() && to.is_finite() {
            self.rasterizer.draw_line(point(from.x as f32, from.y as f32), point(to.x as f32, to.y as f32));
        }
    }

    /// The picture of it.
    pub fn render(&self, picture: &mut Pixmap, _: &mut Resources) {
        let (pixels, _) = picture.0.as_chunks_mut::<4>();
        self.rasterizer.for_each_pixel(|at, part| {
            if let Some(pixel) = pixels.get_mut(at) {
                // Parts of a letter that overlap are no fuller than full.
                *pixel = [(part.min(1.0) * 255.0).round() as u8; 4];
            }
        });
    }
}

/// Pixels of red, green, blue and alpha, each colour multiplied by alpha, from the top left along the rows.
#[derive(Debug)]
pub struct Pixmap(Vec<u8>);

impl Pixmap {
    /// Transparent ones.
    pub fn new(width: u16, height: u16) -> Self {
        Self(vec![0; usize::from(width) * usize::from(height) * 4])
    }

    /// Four bytes for each pixel.
    pub fn data_as_u8_slice(&self) -> &[u8] {
        &self.0
    }
}

/// What is kept between two pictures: nothing.
#[derive(Debug, Default)]
pub struct Resources;

impl Resources {
    /// Nothing.
    pub const fn new() -> Self {
        Self
    }
}

#[cfg(test)]
mod tests {
    use kurbo::{Circle, Rect, Shape as _};

    use super::*;

    /// How white each pixel is.
    fn drawn(width: u16, height: u16, transform: Affine, paths: &[BezPath]) -> Vec<u8> {
        let mut context = RenderContext::new(width, height);
        context.set_transform(transform);
        context.set_paint(color::OpaqueColor::WHITE);
        for path in paths {
            context.fill_path(path);
        }
        let mut picture = Pixmap::new(width, height);
        context.render(&mut picture, &mut Resources::new());
        picture.data_as_u8_slice().chunks(4).map(|pixel| pixel[0]).collect()
    }

    #[test]
    fn a_picture_is_white_by_as_much_as_the_outline_covers() {
        let path = Rect::new(11.0, -5.0, 12.5, -4.0).to_path(0.1);
        let there = Affine::translate((-10.0, 5.0));
        assert_eq!(drawn(3, 2, there, std::slice::from_ref(&path)), [0, 255, 128, 0, 0, 0]);
        assert_eq!(drawn(3, 2, there, &[path.reverse_subpaths()]), [0, 255, 128, 0, 0, 0], "whichever way it goes");
    }

    #[test]
    fn a_circle_has_its_area_and_a_hole_is_empty() {
        let outer = Circle::new((8.0, 8.0), 7.0).to_path(1e-3);
        let hole = Rect::new(6.0, 6.0, 10.0, 10.0).to_path(0.1);
        let hole = if outer.area() * hole.area() < 0.0 { hole } else { hole.reverse_subpaths() };
        let disc = drawn(16, 16, Affine::IDENTITY, std::slice::from_ref(&outer));
        let area = disc.iter().map(|part| f64::from(*part) / 255.0).sum::<f64>();
        assert!((area / (std::f64::consts::PI * 49.0) - 1.0).abs() < 0.005, "{area}");
        let ring = drawn(16, 16, Affine::IDENTITY, &[outer, hole]);
        assert_eq!((ring[8 * 16 + 8], ring[8 * 16 + 4]), (0, 255));
    }

    #[test]
    fn what_overlaps_is_full_and_what_is_no_number_does_no_harm() {
        let [one, other] = [Rect::new(0.0, 0.0, 2.0, 1.0), Rect::new(1.0, 0.0, 3.0, 1.0)].map(|rect| rect.to_path(0.1));
        assert_eq!(drawn(3, 1, Affine::IDENTITY, &[one, other]), [255; 3]);
        let mut path = BezPath::new();
        path.move_to((f64::NAN, 0.0));
        path.line_to((1.0, f64::INFINITY));
        path.line_to((0.0, 1.0));
        assert_eq!(drawn(2, 2, Affine::IDENTITY, &[path]), [0; 4]);
    }
}
