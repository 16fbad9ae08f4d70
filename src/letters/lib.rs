//! The picture of a letter from its outline: what egui asks of `vello_cpu`, whose place this takes.
//!
//! That renderer can do whatever a page may hold, once for each kind of processor: 4 MB of a program that only needs letters, each drawn once.
//! Here a pixel gets the part of its area that the outline covers, exactly for straight edges; curves are cut into such.
//! Only what egui calls is here, by the names that it calls.
#![warn(missing_docs)]

mod coverage;

pub use kurbo;
use kurbo::{Affine, BezPath};

use coverage::Coverage;

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
#[derive(Debug)]
pub struct RenderContext {
    coverage: Coverage,
    transform: Affine,
}

impl RenderContext {
    /// Nothing yet.
    pub fn new(width: u16, height: u16) -> Self {
        Self { coverage: Coverage::new(width.into(), height.into()), transform: Affine::IDENTITY }
    }

    /// Where the outlines that follow lie.
    pub fn set_transform(&mut self, transform: Affine) {
        self.transform = transform;
    }

    /// The colour of what follows: there is one only.
    pub fn set_paint(&mut self, _: color::OpaqueColor<color::Srgb>) {}

    /// An outline; what it goes around at least once is inside.
    pub fn fill_path(&mut self, path: &BezPath) {
        self.coverage.fill(self.transform * path);
    }

    /// The picture of it.
    pub fn render(&self, picture: &mut Pixmap, _: &mut Resources) {
        for (pixel, part) in picture.0.as_chunks_mut::<4>().0.iter_mut().zip(self.coverage.parts()) {
            *pixel = [(part * 255.0).round() as u8; 4];
        }
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
    use super::*;

    #[test]
    fn a_picture_is_white_by_as_much_as_the_outline_covers() {
        let mut context = RenderContext::new(3, 2);
        context.set_transform(Affine::translate((-10.0, 5.0)));
        context.set_paint(color::OpaqueColor::WHITE);
        let mut path = BezPath::new();
        path.move_to((11.0, -5.0));
        path.line_to((12.5, -5.0));
        path.line_to((12.5, -4.0));
        path.line_to((11.0, -4.0));
        path.close_path();
        context.fill_path(&path);
        let mut picture = Pixmap::new(3, 2);
        context.render(&mut picture, &mut Resources::new());
        let rows: Vec<&[u8]> = picture.data_as_u8_slice().chunks(12).collect();
        assert_eq!(rows, [[0, 0, 0, 0, 255, 255, 255, 255, 128, 128, 128, 128], [0; 12]]);
    }
}
