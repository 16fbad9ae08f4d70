//! A baseline JPEG encoder for emulators and tests: one quantisation table and one pair of Huffman tables for all three
//! components, colours at half the resolution (4:2:0), as sent by cameras. ITU-T T.81 with the tables of its annex K.

/// Quantisation of brightness, by rows (table K.1).
const QUANTISATION: [u16; 64] = [
    16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56, 14, 17, 22, 29, 51,
    87, 80, 62, 18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92, 49, 64, 78, 87, 103, 121, 120, 101,
    72, 92, 95, 98, 112, 100, 103, 99,
];
const ZIGZAG: [usize; 64] = [
    0, 1, 8, 16, 9, 2, 3, 10, 17, 24, 32, 25, 18, 11, 4, 5, 12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6, 7, 14, 21,
    28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54,
    47, 55, 62, 63,
];
/// Number of codes of each length, and their values (table K.3).
const DC_LENGTHS: [u8; 16] = [0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0];
const DC_VALUES: [u8; 12] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11];
/// The same for the other coefficients (table K.5).
const AC_LENGTHS: [u8; 16] = [0, 2, 1, 3, 3, 2, 4, 3, 5, 5, 4, 4, 0, 0, 1, 125];
const AC_VALUES: [u8; 162] = [
    0x01, 0x02, 0x03, 0x00, 0x04, 0x11, 0x05, 0x12, 0x21, 0x31, 0x41, 0x06, 0x13, 0x51, 0x61, 0x07, 0x22, 0x71, 0x14,
    0x32, 0x81, 0x91, 0xa1, 0x08, 0x23, 0x42, 0xb1, 0xc1, 0x15, 0x52, 0xd1, 0xf0, 0x24, 0x33, 0x62, 0x72, 0x82, 0x09,
    0x0a, 0x16, 0x17, 0x18, 0x19, 0x1a, 0x25, 0x26, 0x27, 0x28, 0x29, 0x2a, 0x34, 0x35, 0x36, 0x37, 0x38, 0x39, 0x3a,
    0x43, 0x44, 0x45, 0x46, 0x47, 0x48, 0x49, 0x4a, 0x53, 0x54, 0x55, 0x56, 0x57, 0x58, 0x59, 0x5a, 0x63, 0x64, 0x65,
    0x66, 0x67, 0x68, 0x69, 0x6a, 0x73, 0x74, 0x75, 0x76, 0x77, 0x78, 0x79, 0x7a, 0x83, 0x84, 0x85, 0x86, 0x87, 0x88,
    0x89, 0x8a, 0x92, 0x93, 0x94, 0x95, 0x96, 0x97, 0x98, 0x99, 0x9a, 0xa2, 0xa3, 0xa4, 0xa5, 0xa6, 0xa7, 0xa8, 0xa9,
    0xaa, 0xb2, 0xb3, 0xb4, 0xb5, 0xb6, 0xb7, 0xb8, 0xb9, 0xba, 0xc2, 0xc3, 0xc4, 0xc5, 0xc6, 0xc7, 0xc8, 0xc9, 0xca,
    0xd2, 0xd3, 0xd4, 0xd5, 0xd6, 0xd7, 0xd8, 0xd9, 0xda, 0xe1, 0xe2, 0xe3, 0xe4, 0xe5, 0xe6, 0xe7, 0xe8, 0xe9, 0xea,
    0xf1, 0xf2, 0xf3, 0xf4, 0xf5, 0xf6, 0xf7, 0xf8, 0xf9, 0xfa,
];
/// Factors by which the fast cosine transform scales rows and columns (Arai, Agui and Nakajima 1988).
const SCALES: [f32; 8] = [1.0, 1.387_039_8, 1.306_563, 1.175_875_6, 1.0, 0.785_694_96, 0.541_196_1, 0.275_899_38];
/// End of block: all remaining coefficients are zero.
const END_OF_BLOCK: usize = 0x00;
const SIXTEEN_ZEROS: usize = 0xf0;
/// Side of the squares that are encoded separately, px, and blocks in each: four of brightness, two of colour.
const SQUARE_PX: usize = 16;
const BLOCKS: usize = 6;
/// Maximum number of bits of a coefficient's code and value; the number of bits is stored above them.
const CODE_BITS: u32 = 27;

type EncodeBlock = [f32; 64];
type Codes = [(u32, u32); 256];

/// Encodes an image with three bytes per pixel, row by row, at a quality of 1 to 100.
///
/// # Panics
/// If the bytes do not match this size, or a side is 0 or above 65535.
pub fn encode(rgb: &[u8], size_px: [usize; 2], quality: u8) -> Vec<u8> {
    JpegEncoder::new(size_px, quality).encode(rgb)
}

/// Encodes a sequence of images, each complete in itself. Unchanged areas cost little, which suits emulated cameras,
/// because they mostly show a still scene.
#[derive(Debug)]
pub struct JpegEncoder {
    size_px: [usize; 2],
    head: Vec<u8>,
    /// Factors of the coefficients.
    fractions: EncodeBlock,
    dc: Codes,
    ac: Codes,
    /// The previous image; empty if there was none.
    before: Vec<u8>,
    blocks: Vec<CodedBlock>,
}

/// An encoded block without the code of its mean, because that depends on the previous block.
#[derive(Clone, Debug, Default)]
struct CodedBlock {
    dc: i32,
    /// Bits, with their number above [`CODE_BITS`].
    ac: Vec<u32>,
}

impl JpegEncoder {
    /// Creates an encoder for images of this size, at a quality of 1 to 100.
    ///
    /// # Panics
    /// If a side is 0 or above 65535.
    pub fn new(size_px: [usize; 2], quality: u8) -> Self {
        assert!(size_px.iter().all(|side| (1..=65_535).contains(side)), "no size of a JPEG: {size_px:?}");
        let quality = u32::from(quality.clamp(1, 100));
        let scale = if quality < 50 { 5000 / quality } else { 200 - 2 * quality };
        let steps = QUANTISATION.map(|step| ((u32::from(step) * scale + 50) / 100).clamp(1, 255) as u8);
        let mut head = Vec::new();
        headers(&mut head, size_px, &steps);
        let fractions = std::array::from_fn(|at| 1.0 / (f32::from(steps[at]) * 8.0 * SCALES[at / 8] * SCALES[at % 8]));
        let [columns, rows] = size_px.map(|side| side.div_ceil(SQUARE_PX));
        Self {
            size_px,
            head,
            fractions,
            dc: codes(&DC_LENGTHS, &DC_VALUES),
            ac: codes(&AC_LENGTHS, &AC_VALUES),
            before: Vec::new(),
            blocks: vec![CodedBlock::default(); BLOCKS * columns * rows],
        }
    }

    /// Encodes an image with three bytes per pixel, row by row.
    ///
    /// # Panics
    /// If the bytes do not match the size.
    pub fn encode(&mut self, rgb: &[u8]) -> Vec<u8> {
        let [width, height] = self.size_px;
        assert!(rgb.len() == 3 * width * height, "{} bytes for {:?}", rgb.len(), self.size_px);
        self.renew(rgb);
        let mut out = Vec::with_capacity(width * height / 8 + 1024);
        out.extend_from_slice(&self.head);
        let mut bits = EncodeBits { out, held: 0, count: 0 };
        let mut before = [0; 3];
        for (number, block) in self.blocks.iter().enumerate() {
            let before = &mut before[(number % BLOCKS).saturating_sub(3)];
            bits.coded(&self.dc, block.dc - *before);
            *before = block.dc;
            for &code in &block.ac {
                bits.put(code & ((1 << CODE_BITS) - 1), code >> CODE_BITS);
            }
        }
        bits.end()
    }

    /// Transforms the squares that differ from the previous image.
    fn renew(&mut self, rgb: &[u8]) {
        let [width, height] = self.size_px;
        let squares =
            (0..height).step_by(SQUARE_PX).flat_map(|top| (0..width).step_by(SQUARE_PX).map(move |left| [left, top]));
        for ([left, top], blocks) in squares.zip(self.blocks.chunks_exact_mut(BLOCKS)) {
            let row = |y: usize| 3 * (width * y + left)..3 * (width * y + (left + SQUARE_PX).min(width));
            let mut rows = (top..(top + SQUARE_PX).min(height)).map(row);
            if !self.before.is_empty() && rows.all(|row| self.before[row.clone()] == rgb[row]) {
                continue;
            }
            let [y, cb, cr] = colours(rgb, self.size_px, left, top);
            for (block, corner) in blocks.iter_mut().zip([0, 8, 128, 136]) {
                let mut values = std::array::from_fn(|at| y[corner + 16 * (at / 8) + at % 8]);
                block.code(&mut values, &self.fractions, &self.ac);
            }
            for (block, plane) in blocks[4..].iter_mut().zip([cb, cr]) {
                let mut values = std::array::from_fn(|at| {
                    let at = 32 * (at / 8) + 2 * (at % 8);
                    0.25 * (plane[at] + plane[at + 1] + plane[at + 16] + plane[at + 17])
                });
                block.code(&mut values, &self.fractions, &self.ac);
            }
        }
        self.before.clear();
        self.before.extend_from_slice(rgb);
    }
}

impl CodedBlock {
    fn code(&mut self, values: &mut EncodeBlock, fractions: &EncodeBlock, codes: &Codes) {
        transform(values);
        let level = |at: usize| (values[at] * fractions[at]).round() as i32;
        self.dc = level(0);
        self.ac.clear();
        let mut zeros = 0;
        for &at in &ZIGZAG[1..] {
            let level = level(at);
            if level == 0 {
                zeros += 1;
                continue;
            }
            while zeros > 15 {
                self.put(codes[SIXTEEN_ZEROS]);
                zeros -= 16;
            }
            let (size, bits) = size_and_bits(level);
            let (code, length) = codes[zeros << 4 | size as usize];
            self.put((code << size | bits, length + size));
            zeros = 0;
        }
        if zeros > 0 {
            self.put(codes[END_OF_BLOCK]);
        }
    }

    fn put(&mut self, (bits, count): (u32, u32)) {
        self.ac.push(count << CODE_BITS | bits);
    }
}

/// Returns brightness and colours of 16 x 16 pixels (BT.601, full range), around 0; the last pixels are repeated beyond
/// the edge.
fn colours(rgb: &[u8], [width, height]: [usize; 2], left: usize, top: usize) -> [[f32; 256]; 3] {
    let mut planes = [[0.0; 256]; 3];
    for row in 0..16 {
        let line = &rgb[3 * width * (top + row).min(height - 1)..];
        for column in 0..16 {
            let at = 3 * (left + column).min(width - 1);
            let [r, g, b] = [0, 1, 2].map(|colour| f32::from(line[at + colour]));
            let place = 16 * row + column;
            planes[0][place] = 0.299 * r + 0.587 * g + 0.114 * b - 128.0;
            planes[1][place] = -0.168_736 * r - 0.331_264 * g + 0.5 * b;
            planes[2][place] = 0.5 * r - 0.418_688 * g - 0.081_312 * b;
        }
    }
    planes
}

fn headers(out: &mut Vec<u8>, [width, height]: [usize; 2], steps: &[u8; 64]) {
    let segment = |out: &mut Vec<u8>, marker: u8, body: &[u8]| {
        out.extend_from_slice(&[0xff, marker]);
        out.extend_from_slice(&(2 + body.len() as u16).to_be_bytes());
        out.extend_from_slice(body);
    };
    out.extend_from_slice(&[0xff, 0xd8]);
    segment(out, 0xe0, b"JFIF\0\x01\x01\0\0\x01\0\x01\0\0");
    let mut table = vec![0];
    table.extend(ZIGZAG.map(|at| steps[at]));
    segment(out, 0xdb, &table);
    let [[h1, h0], [w1, w0]] = [height, width].map(|side| (side as u16).to_be_bytes());
    segment(out, 0xc0, &[8, h1, h0, w1, w0, 3, 1, 0x22, 0, 2, 0x11, 0, 3, 0x11, 0]);
    segment(out, 0xc4, &[&[0x00], &DC_LENGTHS[..], &DC_VALUES].concat());
    segment(out, 0xc4, &[&[0x10], &AC_LENGTHS[..], &AC_VALUES].concat());
    segment(out, 0xda, &[3, 1, 0, 2, 0, 3, 0, 0, 63, 0]);
}

/// Returns the number of bits of a level, and the bits.
const fn size_and_bits(level: i32) -> (u32, u32) {
    let size = 32 - level.unsigned_abs().leading_zeros();
    let bits = if level < 0 { level - 1 } else { level }.cast_unsigned();
    (size, bits & ((1 << size) - 1))
}

/// Returns code and length of each value.
fn codes(lengths: &[u8; 16], values: &[u8]) -> Codes {
    let mut codes = [(0, 0); 256];
    let mut code = 0;
    let mut values = values.iter();
    for (length, &count) in (1..).zip(lengths) {
        for value in values.by_ref().take(usize::from(count)) {
            codes[usize::from(*value)] = (code, length);
            code += 1;
        }
        code <<= 1;
    }
    codes
}

struct EncodeBits {
    out: Vec<u8>,
    held: u64,
    count: u32,
}

impl EncodeBits {
    fn put(&mut self, bits: u32, count: u32) {
        self.held = self.held << count | u64::from(bits);
        self.count += count;
        while self.count >= 8 {
            self.count -= 8;
            let byte = (self.held >> self.count) as u8;
            self.out.push(byte);
            if byte == 0xff {
                self.out.push(0);
            }
        }
    }

    /// Returns the code of a level's size, followed by its bits.
    fn coded(&mut self, codes: &Codes, level: i32) {
        let (size, bits) = size_and_bits(level);
        let (code, length) = codes[size as usize];
        self.put(code << size | bits, length + size);
    }

    fn end(mut self) -> Vec<u8> {
        if self.count > 0 {
            let missing = 8 - self.count;
            self.put((1 << missing) - 1, missing);
        }
        self.out.extend_from_slice(&[0xff, 0xd9]);
        self.out
    }
}

/// Cosine transform of rows and then of columns, each coefficient multiplied by its [`SCALES`] and by 8.
fn transform(block: &mut EncodeBlock) {
    for row in 0..8 {
        line(block, 8 * row, 1);
    }
    for column in 0..8 {
        line(block, column, 8);
    }
}

/// Transforms one row or column (Arai, Agui and Nakajima).
fn line(block: &mut EncodeBlock, first: usize, step: usize) {
    let d: [f32; 8] = std::array::from_fn(|i| block[first + i * step]);
    let sums: [f32; 4] = std::array::from_fn(|i| d[i] + d[7 - i]);
    let [s0, s1, s2, s3] = sums;
    let [d4, d5, d6, d7] = [d[3] - d[4], d[2] - d[5], d[1] - d[6], d[0] - d[7]];
    let even0 = s0 + s3;
    let even1 = s1 + s2;
    let odd0 = s0 - s3;
    let odd1 = s1 - s2;
    let turned = (odd1 + odd0) * std::f32::consts::FRAC_1_SQRT_2;
    let a = d4 + d5;
    let b = d5 + d6;
    let c = d6 + d7;
    let z5 = (a - c) * 0.382_683_43;
    let z2 = 0.541_196_1 * a + z5;
    let z4 = 1.306_563 * c + z5;
    let z3 = b * std::f32::consts::FRAC_1_SQRT_2;
    let z11 = d7 + z3;
    let z13 = d7 - z3;
    let values = [even0 + even1, z11 + z4, odd0 + turned, z13 - z2, even0 - even1, z13 + z2, odd0 - turned, z11 - z4];
    for (i, value) in values.into_iter().enumerate() {
        block[first + i * step] = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jpeg::{decode, tests::pattern};

    #[test]
    fn what_is_decoded_is_what_was_encoded() {
        // Including sides that are not multiples of a block.
        for size_px in [[64, 48], [640, 361], [17, 9], [1, 1]] {
            // No fine colours: they have half the resolution.
            let grey: Vec<u8> =
                pattern(size_px).chunks_exact(3).flat_map(|pixel| [pixel[0] / 2 + pixel[1] / 4; 3]).collect();
            let image = decode(&encode(&grey, size_px, 92)).unwrap();
            assert_eq!(image.size_px, size_px);
            let pairs = image.rgba.chunks_exact(4).zip(grey.chunks_exact(3));
            let misses = pairs.flat_map(|(is, was)| (0..3).map(|i| f64::from(is[i].abs_diff(was[i]))));
            let (sum, count) = misses.fold((0.0, 0.0), |(sum, count), miss| (sum + miss * miss, count + 1.0));
            let rms = f64::sqrt(sum / count);
            assert!(rms < 4.0, "{size_px:?}: {rms}");
        }
    }

    #[test]
    fn a_picture_is_the_same_whatever_came_before() {
        let size_px = [330, 70];
        let mut encoder = JpegEncoder::new(size_px, 80);
        let mut rgb = pattern(size_px);
        for at in [0, 5, 3 * 330 * 35 + 900, 3 * 330 * 70 - 1, 3 * 330 * 69 + 1] {
            assert!(encoder.encode(&rgb) == encode(&rgb, size_px, 80), "before {at} changed");
            rgb[at] = rgb[at].wrapping_add(120);
        }
        assert!(encoder.encode(&rgb) == encode(&rgb, size_px, 80));
        assert!(encoder.encode(&rgb) == encode(&rgb, size_px, 80), "nothing changed");
    }

    #[test]
    fn test_bars_keep_their_colours_within_two_of_255() {
        let bars = [
            [255, 255, 255],
            [191, 191, 0],
            [0, 191, 191],
            [0, 191, 0],
            [191, 0, 191],
            [191, 0, 0],
            [0, 0, 191],
            [16; 3],
        ];
        let rgb: Vec<u8> = (0..64 * 512).flat_map(|at| bars[at % 512 / 64]).collect();
        let image = decode(&encode(&rgb, [512, 64], 95)).unwrap();
        for (number, bar) in bars.iter().enumerate() {
            let at = 4 * (32 * 512 + 64 * number + 32);
            for (is, was) in image.rgba[at..at + 3].iter().zip(bar) {
                assert!(is.abs_diff(*was) <= 2, "bar {number}: {:?} for {bar:?}", &image.rgba[at..at + 3]);
            }
        }
    }
}
