//! Converts brightness and colour differences, as delivered by cameras and video decoders, to red, green and blue.
//!
//! Two or four pixels share their colours (ITU-R BT.601-7 and BT.709-6; the full range of JPEG, JFIF 1.02). The library
//! `yuv` computes them, with errors of at most three steps of 255.

use yuv::{
    BufferStoreMut, YuvBiPlanarImage, YuvChromaSubsampling, YuvConversionMode, YuvError, YuvPackedImage,
    YuvPlanarImage, YuvPlanarImageMut, YuvRange, YuvStandardMatrix, rgb_to_yuv420, yuv_nv12_to_rgba, yuv420_to_rgba,
    yuyv422_to_rgba,
};

use crate::{Damage, DecodedImage, jpeg};

/// Memory layout of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PixelLayout {
    /// Two pixels in four bytes, Y U Y V.
    Yuyv,
    /// Brightness, then colours for each square of four pixels, U V.
    Nv12,
    /// Brightness, then U, then V for each square of four pixels.
    I420,
}

/// Weights of the colours in the brightness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColourMatrix {
    /// Standard definition, and JPEG.
    Bt601,
    /// High definition.
    Bt709,
}

/// Values of black and white.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ValueRange {
    /// Black is 0, and white 255.
    Full,
    /// Black is 16, and white 235; colour differences reach 240.
    Limited,
}

/// Interpretation of an image's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Colours {
    pub matrix: ColourMatrix,
    pub range: ValueRange,
}

/// Format of an uncompressed image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawLayout {
    pub layout: PixelLayout,
    pub colours: Colours,
    /// Width and height, px.
    pub size_px: [usize; 2],
    /// Bytes from one row to the next. For I420 this is the stride of the brightness plane; the colour planes have half
    /// of it.
    pub stride: usize,
}

/// One plane: its bytes, and the stride of its rows.
#[derive(Clone, Copy, Debug)]
pub struct ColourPlane<'a> {
    pub bytes: &'a [u8],
    /// Bytes from one row to the next.
    pub stride: usize,
}

impl Colours {
    /// Returns the default if the source does not specify the colours: like most decoders, it depends on the height of
    /// the image.
    pub const fn usual(size_px: [usize; 2]) -> Self {
        let matrix = if size_px[1] >= 720 { ColourMatrix::Bt709 } else { ColourMatrix::Bt601 };
        Self { matrix, range: ValueRange::Limited }
    }

    const fn of_library(self) -> (YuvRange, YuvStandardMatrix) {
        let range = match self.range {
            ValueRange::Full => YuvRange::Full,
            ValueRange::Limited => YuvRange::Limited,
        };
        let matrix = match self.matrix {
            ColourMatrix::Bt601 => YuvStandardMatrix::Bt601,
            ColourMatrix::Bt709 => YuvStandardMatrix::Bt709,
        };
        (range, matrix)
    }
}

impl RawLayout {
    /// Returns the bytes of a whole image, including the gap after its last row.
    pub fn bytes(&self) -> usize {
        let Self { layout, size_px: [_, height], stride, .. } = *self;
        let halves = height.div_ceil(2);
        match layout {
            PixelLayout::Yuyv => stride * height,
            PixelLayout::Nv12 => stride * (height + halves),
            PixelLayout::I420 => stride * height + stride.div_ceil(2) * 2 * halves,
        }
    }

    /// # Errors
    /// If bytes are missing, or the image is larger than that of any camera.
    pub fn image(&self, bytes: &[u8]) -> Result<DecodedImage, Damage> {
        let Self { layout, colours, size_px: size_px @ [width, height], stride } = *self;
        jpeg::check_size(size_px)?;
        let pairs = width.div_ceil(2);
        let min = match layout {
            PixelLayout::Yuyv => 4 * pairs,
            PixelLayout::Nv12 => 2 * pairs,
            PixelLayout::I420 => width,
        };
        if stride < min || bytes.len() < self.bytes() {
            return Err(Damage::Torn);
        }
        match layout {
            PixelLayout::Yuyv => painted(colours, size_px, |rgba, rgba_stride, range, matrix| {
                let yuy = &bytes[..stride * height];
                let image =
                    YuvPackedImage { yuy, yuy_stride: stride as u32, width: width as u32, height: height as u32 };
                yuyv422_to_rgba(&image, rgba, rgba_stride, range, matrix)
            }),
            PixelLayout::Nv12 => painted(colours, size_px, |rgba, rgba_stride, range, matrix| {
                let (y_plane, uv_plane) = bytes.split_at(stride * height);
                let image = YuvBiPlanarImage {
                    y_plane,
                    y_stride: stride as u32,
                    uv_plane,
                    uv_stride: stride as u32,
                    width: width as u32,
                    height: height as u32,
                };
                yuv_nv12_to_rgba(&image, rgba, rgba_stride, range, matrix, YuvConversionMode::Balanced)
            }),
            PixelLayout::I420 => {
                let half = stride.div_ceil(2);
                let (y, colour) = bytes.split_at(stride * height);
                let (u, v) = colour.split_at(half * height.div_ceil(2));
                let plane = |bytes, stride| ColourPlane { bytes, stride };
                of_planes([plane(y, stride), plane(u, half), plane(v, half)], colours, size_px)
            }
        }
    }
}

/// Returns the image of three planes; the last two have one value for each square of four pixels.
///
/// # Errors
/// If bytes are missing, or the image is larger than that of any camera.
pub fn of_planes(
    [y, u, v]: [ColourPlane<'_>; 3],
    colours: Colours,
    size_px: [usize; 2],
) -> Result<DecodedImage, Damage> {
    jpeg::check_size(size_px)?;
    let [width, height] = size_px;
    let half_px = size_px.map(|side| side.div_ceil(2));
    for (plane, [width, height]) in [y, u, v].iter().zip([size_px, half_px, half_px]) {
        // The decoder library skips rows that have no padding after them.
        if plane.stride < width || plane.bytes.len() < plane.stride * height {
            return Err(Damage::Torn);
        }
    }
    let image = YuvPlanarImage {
        y_plane: y.bytes,
        y_stride: y.stride as u32,
        u_plane: u.bytes,
        u_stride: u.stride as u32,
        v_plane: v.bytes,
        v_stride: v.stride as u32,
        width: width as u32,
        height: height as u32,
    };
    painted(colours, size_px, |rgba, rgba_stride, range, matrix| {
        yuv420_to_rgba(&image, rgba, rgba_stride, range, matrix)
    })
}

/// Returns the image that `paint` writes; `paint` receives the pixels, the bytes per row, and the interpretation of the
/// colours.
fn painted(
    colours: Colours,
    size_px @ [width, height]: [usize; 2],
    paint: impl FnOnce(&mut [u8], u32, YuvRange, YuvStandardMatrix) -> Result<(), YuvError>,
) -> Result<DecodedImage, Damage> {
    let mut rgba = vec![255; 4 * width * height];
    let (range, matrix) = colours.of_library();
    paint(&mut rgba, 4 * width as u32, range, matrix).map_err(|_| Damage::Torn)?;
    Ok(DecodedImage { size_px, rgba })
}

/// Converts an image with three bytes per pixel to the layout I420 without gaps: for emulators and tests.
///
/// # Panics
/// If the number of bytes does not match this size.
pub fn to_i420(rgb: &[u8], [width, height]: [usize; 2], colours: Colours) -> Vec<u8> {
    assert!(rgb.len() == 3 * width * height);
    let (range, matrix) = colours.of_library();
    let mut image = YuvPlanarImageMut::alloc(width as u32, height as u32, YuvChromaSubsampling::Yuv420);
    let made = rgb_to_yuv420(&mut image, rgb, 3 * width as u32, range, matrix, YuvConversionMode::Balanced);
    assert!(made.is_ok(), "{made:?}");
    [&image.y_plane, &image.u_plane, &image.v_plane].map(BufferStoreMut::borrow).concat()
}

#[cfg(test)]
mod tests;
