//! Brightness and colour differences, as cameras and video decoders give them, as red, green and blue.
//!
//! Two pixels, or four, share their colours; each takes those of its pair or square as they are. Whole numbers of 16 binary places, which err by
//! less than one step of 255 (ITU-R BT.601-7 and BT.709-6; the full range of JPEG, JFIF 1.02).

use crate::{Damage, Picture, jpeg};

/// How the bytes of a picture lie in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layout {
    /// Two pixels in four bytes, Y U Y V.
    Yuyv,
    /// Brightness, then colours for each square of four pixels, U V.
    Nv12,
    /// Brightness, then U, then V for each square of four pixels.
    I420,
}

/// How brightness is made of the colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Matrix {
    /// Of standard definition, and of JPEG.
    Bt601,
    /// Of high definition.
    Bt709,
}

/// Which values are black and white.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Range {
    /// 0 and 255.
    Full,
    /// 16 and 235; colours up to 240.
    Limited,
}

/// What the numbers of a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "their types say it")]
pub struct Colours {
    pub matrix: Matrix,
    pub range: Range,
}

/// How a picture that is not compressed lies in its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Raw {
    /// Order of the bytes.
    pub layout: Layout,
    /// What they mean.
    pub colours: Colours,
    /// Width and height, px.
    pub size_px: [usize; 2],
    /// Bytes from one row to the next; of I420 in the brightness, its colours have half of it.
    pub stride: usize,
}

/// One plane: its bytes, and how many of them one row takes.
#[derive(Clone, Copy, Debug)]
pub struct Plane<'a> {
    #[expect(missing_docs, reason = "its name says it")]
    pub bytes: &'a [u8],
    /// Bytes from one row to the next.
    pub stride: usize,
}

impl<'a> Plane<'a> {
    /// From this byte of its row on; nothing where the bytes end.
    fn row(&self, row: usize, from: usize) -> &'a [u8] {
        let begin = row * self.stride;
        let end = (begin + self.stride).min(self.bytes.len());
        self.bytes.get(begin + from..end).unwrap_or_default()
    }
}

const PLACES: u32 = 16;
const HALF: i32 = 1 << (PLACES - 1);

/// Multipliers of brightness and of the differences of colour, in 2^-16.
#[derive(Clone, Copy, Debug)]
struct Multipliers {
    black: i32,
    y: i32,
    red_of_v: i32,
    green_of_u: i32,
    green_of_v: i32,
    blue_of_u: i32,
}

impl Matrix {
    /// Shares of red and blue in the brightness.
    const fn shares(self) -> [f64; 2] {
        match self {
            Self::Bt601 => [0.299, 0.114],
            Self::Bt709 => [0.2126, 0.0722],
        }
    }
}

impl Colours {
    /// What is meant where nobody says it: as most decoders take it, by the picture's height.
    pub const fn usual(size_px: [usize; 2]) -> Self {
        let matrix = if size_px[1] >= 720 { Matrix::Bt709 } else { Matrix::Bt601 };
        Self { matrix, range: Range::Limited }
    }

    /// Black, and how many steps white is above it, and the strongest colour above none (of 127.5 or, limited, 112).
    const fn scale(self) -> [f64; 3] {
        match self.range {
            Range::Full => [0.0, 255.0, 255.0],
            Range::Limited => [16.0, 219.0, 224.0],
        }
    }

    fn multipliers(self) -> Multipliers {
        let ([red, blue], [black, white, strongest]) = (self.matrix.shares(), self.scale());
        let green = 1.0 - red - blue;
        let fixed = |value: f64| (value * f64::from(1 << PLACES)).round() as i32;
        let colour = 255.0 / strongest;
        Multipliers {
            black: black as i32,
            y: fixed(255.0 / white),
            red_of_v: fixed(2.0 * (1.0 - red) * colour),
            green_of_u: fixed(2.0 * (1.0 - blue) * blue / green * colour),
            green_of_v: fixed(2.0 * (1.0 - red) * red / green * colour),
            blue_of_u: fixed(2.0 * (1.0 - blue) * colour),
        }
    }
}

impl Raw {
    /// Bytes that a whole picture has.
    pub fn bytes(&self) -> usize {
        let Self { layout, size_px: [width, height], stride, .. } = *self;
        let halves = height.div_ceil(2);
        match layout {
            Layout::Yuyv => stride * height.saturating_sub(1) + 4 * width.div_ceil(2),
            Layout::Nv12 => stride * (height + halves.saturating_sub(1)) + 2 * width.div_ceil(2),
            Layout::I420 => stride * height + stride.div_ceil(2) * (2 * halves).saturating_sub(1) + width.div_ceil(2),
        }
    }

    /// The picture in these bytes.
    ///
    /// # Errors
    /// If bytes are missing, or the picture is larger than any camera's.
    pub fn picture(&self, bytes: &[u8]) -> Result<Picture, Damage> {
        let Self { layout, colours, size_px, stride } = *self;
        jpeg::check_size(size_px)?;
        let least = match layout {
            Layout::Yuyv => 4 * size_px[0].div_ceil(2),
            Layout::Nv12 => 2 * size_px[0].div_ceil(2),
            Layout::I420 => size_px[0],
        };
        if stride < least || bytes.len() < self.bytes() {
            return Err(Damage::Torn);
        }
        let plane = |from: usize, stride| Plane { bytes: bytes.get(from..).unwrap_or_default(), stride };
        let chroma = stride * size_px[1];
        let mut rgba = blank(size_px);
        match layout {
            Layout::Yuyv => {
                let all = plane(0, stride);
                rows(colours, size_px, &mut rgba, |row, k, out| {
                    line::<2, 4>(k, [all.row(row, 0), all.row(row, 1), all.row(row, 3)], out);
                });
            }
            Layout::Nv12 => {
                let (y, uv) = (plane(0, stride), plane(chroma, stride));
                rows(colours, size_px, &mut rgba, |row, k, out| {
                    line::<1, 2>(k, [y.row(row, 0), uv.row(row / 2, 0), uv.row(row / 2, 1)], out);
                });
            }
            Layout::I420 => {
                let half = stride.div_ceil(2);
                let planes =
                    [plane(0, stride), plane(chroma, half), plane(chroma + half * size_px[1].div_ceil(2), half)];
                return of_planes(planes, colours, size_px);
            }
        }
        Ok(Picture { size_px, rgba })
    }
}

/// The picture of three planes, the latter two with one value for each square of four pixels.
///
/// # Errors
/// If bytes are missing, or the picture is larger than any camera's.
pub fn of_planes(planes: [Plane<'_>; 3], colours: Colours, size_px: [usize; 2]) -> Result<Picture, Damage> {
    jpeg::check_size(size_px)?;
    let half_px = size_px.map(|side| side.div_ceil(2));
    for (plane, [width, height]) in planes.iter().zip([size_px, half_px, half_px]) {
        if plane.stride < width || plane.bytes.len() < plane.stride * height.saturating_sub(1) + width {
            return Err(Damage::Torn);
        }
    }
    let mut rgba = blank(size_px);
    let [y, u, v] = planes;
    rows(colours, size_px, &mut rgba, |row, k, out| {
        line::<1, 1>(k, [y.row(row, 0), u.row(row / 2, 0), v.row(row / 2, 0)], out);
    });
    Ok(Picture { size_px, rgba })
}

fn blank([width, height]: [usize; 2]) -> Vec<u8> {
    vec![255; 4 * width * height]
}

fn rows(colours: Colours, [width, _]: [usize; 2], rgba: &mut [u8], fill: impl Fn(usize, &Multipliers, &mut [u8])) {
    let multipliers = colours.multipliers();
    for (row, out) in rgba.chunks_exact_mut(4 * width).enumerate() {
        fill(row, &multipliers, out);
    }
}

/// One row: a brightness every `Y` bytes, colours for two pixels every `C` bytes.
fn line<const Y: usize, const C: usize>(k: &Multipliers, [y, u, v]: [&[u8]; 3], out: &mut [u8]) {
    let pairs = out.chunks_mut(8).zip(y.chunks(2 * Y)).zip(u.chunks(C).zip(v.chunks(C)));
    for ((pair, y), (u, v)) in pairs {
        let (u, v) = (i32::from(u[0]) - 128, i32::from(v[0]) - 128);
        let colours = [k.red_of_v * v, -k.green_of_u * u - k.green_of_v * v, k.blue_of_u * u];
        for (pixel, y) in pair.chunks_exact_mut(4).zip(y.iter().step_by(Y)) {
            let bright = (i32::from(*y) - k.black) * k.y + HALF;
            for (value, colour) in pixel.iter_mut().zip(colours) {
                *value = ((bright + colour) >> PLACES).clamp(0, 255) as u8;
            }
        }
    }
}

/// Brightness and colours of a picture of three bytes a pixel, in the layout I420 without gaps: for emulators and tests.
///
/// # Panics
/// If the bytes are not those of a picture of this size.
pub fn to_i420(rgb: &[u8], [width, height]: [usize; 2], colours: Colours) -> Vec<u8> {
    assert!(rgb.len() == 3 * width * height);
    let ([red, blue], [black, white, strongest]) = (colours.matrix.shares(), colours.scale());
    let shares = [red, 1.0 - red - blue, blue];
    let fixed = |value: f64| (value * f64::from(1 << PLACES)).round() as i32;
    let bright = shares.map(|share| fixed(share * white / 255.0));
    let half = [width.div_ceil(2), height.div_ceil(2)];
    let mut out = vec![0; width * height + 2 * half[0] * half[1]];
    let (y, uv) = out.split_at_mut(width * height);
    for (value, pixel) in y.iter_mut().zip(rgb.chunks_exact(3)) {
        let sum = HALF + pixel.iter().zip(bright).map(|(value, share)| i32::from(*value) * share).sum::<i32>();
        *value = ((sum >> PLACES) + black as i32) as u8;
    }
    let (u, v) = uv.split_at_mut(half[0] * half[1]);
    for (plane, channel) in [(u, 2), (v, 0)] {
        // Of the sum of four pixels.
        let own = |i: usize| if i == channel { 1.0 } else { 0.0 };
        let scale = 0.125 * strongest / 255.0 / (1.0 - shares[channel]);
        let weights: [i32; 3] = std::array::from_fn(|i| fixed((own(i) - shares[i]) * scale));
        for (top, row) in plane.chunks_exact_mut(half[0]).enumerate() {
            let lines = [2 * top, (2 * top + 1).min(height - 1)].map(|line| &rgb[3 * width * line..][..3 * width]);
            for (left, value) in row.iter_mut().enumerate() {
                let columns = [2 * left, (2 * left + 1).min(width - 1)];
                let of_channel = |i: usize| -> i32 {
                    lines.iter().flat_map(|line| columns.map(|column| i32::from(line[3 * column + i]))).sum()
                };
                let sum = HALF + (0..3).map(|i| of_channel(i) * weights[i]).sum::<i32>();
                *value = ((sum >> PLACES) + 128).clamp(0, 255) as u8;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests;
