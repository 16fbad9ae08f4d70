//! JPEGs: decoded for the screen, found in a file, and encoded for emulators.

mod split;

use std::borrow::Cow;

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use zune_jpeg::{
    JpegDecoder,
    errors::DecodeErrors,
    zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions},
};

pub(crate) use split::JpegSplitter;

/// Maximum side of an image, and maximum number of pixels: somewhat more than 4096 x 2160. A larger image is refused
/// before memory is allocated for it.
const SIDE_MAX_PX: usize = 4096;
const PIXELS_MAX: usize = 9_500_000;
/// Maximum padding after the end of an image, bytes.
const PADDING_MAX: usize = 64;
const BEGIN: [u8; 2] = [0xff, 0xd8];
const END: [u8; 2] = [0xff, 0xd9];
/// A segment that makes the decoder use the standard Huffman tables.
const AVI: &[u8] = b"\xff\xe0\x00\x10AVI1\0\0\0\0\0\0\0\0\0\0";

/// A decoded image, in the screen's format.
#[derive(Clone, PartialEq, Eq)]
pub struct DecodedImage {
    /// Width and height, px.
    pub size_px: [usize; 2],
    /// Red, green, blue and 255 for each pixel, row by row from the upper left corner.
    pub rgba: Vec<u8>,
}

/// Why an image cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    #[error("it is not a JPEG")]
    NotJpeg,
    #[error("its end is missing")]
    Torn,
    #[error("{} x {} pixels exceed the limit", .size_px[0], .size_px[1])]
    TooLarge { size_px: [usize; 2] },
    #[error("it cannot be decoded: {reason}")]
    Undecodable { reason: String },
}

/// Mean brightness up to which an image is black: the level of a sensor with its cap on, of 255.
const BLACK_MEAN: u32 = 6;
/// Maximum brightness of any pixel of a black image.
const BLACK_MAX: u32 = 40;
/// One pixel in this many is checked.
const BLACK_STEP: usize = 61;

impl std::fmt::Debug for DecodedImage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Prints the size instead of millions of numbers.
        f.debug_struct("Picture").field("size_px", &self.size_px).finish_non_exhaustive()
    }
}

impl DecodedImage {
    /// Returns whether the image is black.
    pub fn is_black(&self) -> bool {
        let brightness = |pixel: &[u8]| pixel[..3].iter().map(|&value| u32::from(value)).max().unwrap_or(0);
        let mut sum = 0;
        let mut max = 0;
        let mut count = 0;
        for pixel in self.rgba.chunks_exact(4).step_by(BLACK_STEP) {
            let value = brightness(pixel);
            sum += value;
            max = max.max(value);
            count += 1;
        }
        count > 0 && sum <= BLACK_MEAN * count && max <= BLACK_MAX
    }
}

/// Decodes a JPEG to pixels. Allocates only what the header requires, within the limits.
///
/// # Errors
/// The fault of the image.
pub fn decode(jpeg: &[u8]) -> Result<DecodedImage, Damage> {
    if !jpeg.starts_with(&BEGIN) {
        return Err(Damage::NotJpeg);
    }
    let tail = &jpeg[jpeg.len().saturating_sub(PADDING_MAX)..];
    if !tail.windows(2).any(|two| two == END) {
        return Err(Damage::Torn);
    }
    // Strict, because a damaged part would otherwise appear as plain grey. If a part is cut out of the middle and the
    // end is intact, the library still shows grey and reports nothing.
    let options = DecoderOptions::new_fast()
        .set_strict_mode(true)
        .set_max_width(SIDE_MAX_PX)
        .set_max_height(SIDE_MAX_PX)
        .jpeg_set_out_colorspace(ColorSpace::RGBA);
    let jpeg = completed(jpeg);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(&*jpeg), options);
    decoder.decode_headers().map_err(damage)?;
    let info = decoder.info().ok_or(Damage::NotJpeg)?;
    let size_px = [usize::from(info.width), usize::from(info.height)];
    check_size(size_px)?;
    // The library writes four colours as stripes.
    if !matches!(info.components, 1 | 3) {
        let reason =
            format!("it has {} colour components (CMYK); set the camera to colour (YCbCr) or grey", info.components);
        return Err(Damage::Undecodable { reason });
    }
    let mut rgba = vec![255; 4 * size_px[0] * size_px[1]];
    if decoder.output_buffer_size() != Some(rgba.len()) {
        return Err(Damage::Undecodable { reason: "its colour format is not supported".to_owned() });
    }
    decoder.decode_into(&mut rgba).map_err(damage)?;
    Ok(DecodedImage { size_px, rgba })
}

/// Encodes an image with three bytes per pixel, row by row, at a quality of 1 to 100, with colours at half the resolution
/// (4:2:0) as sent by cameras: for emulators and tests.
///
/// # Panics
/// If there are fewer than three bytes for each pixel, or a side is 0 or above 65535.
pub fn encode(rgb: &[u8], size_px: [usize; 2], quality: u8) -> Vec<u8> {
    let mut jpeg = Vec::new();
    let mut encoder = Encoder::new(&mut jpeg, quality);
    encoder.set_sampling_factor(SamplingFactor::F_2_2);
    let [width, height] = size_px.map(|side| u16::try_from(side).unwrap_or(0));
    let done = encoder.encode(rgb, width, height, ColorType::Rgb);
    assert!(done.is_ok(), "{} bytes for {size_px:?}: {done:?}", rgb.len());
    jpeg
}

/// Adds the standard Huffman tables, which many USB cameras omit.
fn completed(jpeg: &[u8]) -> Cow<'_, [u8]> {
    let mut at = 2;
    while let Some([0xff, marker, high, low]) = jpeg.get(at..at + 4) {
        match marker {
            0xc4 => break,
            0xda => return Cow::Owned([&jpeg[..2], AVI, &jpeg[2..]].concat()),
            0xff => at += 1,
            _ => at += 2 + usize::from(u16::from_be_bytes([*high, *low])),
        }
    }
    Cow::Borrowed(jpeg)
}

/// Refuses an image that is larger than that of any camera, or has no pixels.
pub(crate) fn check_size(size_px: [usize; 2]) -> Result<(), Damage> {
    let [width, height] = size_px;
    if width > SIDE_MAX_PX || height > SIDE_MAX_PX || width * height > PIXELS_MAX {
        return Err(Damage::TooLarge { size_px });
    }
    if width * height == 0 {
        return Err(Damage::Undecodable { reason: "it has no pixels".to_owned() });
    }
    Ok(())
}

fn damage(error: DecodeErrors) -> Damage {
    match error {
        DecodeErrors::ExhaustedData => Damage::Torn,
        DecodeErrors::IllegalMagicBytes(_) => Damage::NotJpeg,
        DecodeErrors::LargeDimensions(side) => Damage::TooLarge { size_px: [side; 2] },
        // One line, however long the library's message is.
        other => {
            Damage::Undecodable { reason: format!("{other:?}").chars().filter(|c| !c.is_control()).take(120).collect() }
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use nima_testing::fuzz;

    use super::*;

    pub(crate) fn pattern(size_px: [usize; 2]) -> Vec<u8> {
        let value = |x: usize, y: usize| {
            if (x / 24 + y / 24).is_multiple_of(2) {
                [(4 * x % 256) as u8, (3 * y % 256) as u8, 90]
            } else {
                [200, 120, (x + y) as u8]
            }
        };
        (0..size_px[1]).flat_map(|y| (0..size_px[0]).flat_map(move |x| value(x, y))).collect()
    }

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

    #[test]
    fn what_is_cut_off_or_another_format_is_told() {
        let whole = encode(&pattern([320, 200]), [320, 200], 85);
        assert!(decode(&whole).is_ok());
        assert_eq!(decode(&whole[..whole.len() / 2]), Err(Damage::Torn));
        assert_eq!(decode(b"\x89PNG\r\n"), Err(Damage::NotJpeg));
        assert_eq!(decode(b""), Err(Damage::NotJpeg));
        let mut padded = whole;
        padded.extend_from_slice(&[0; 7]);
        assert!(decode(&padded).is_ok());
    }

    #[test]
    fn a_picture_without_its_usual_tables_is_decoded_with_them() {
        let whole = encode(&pattern([96, 64]), [96, 64], 85);
        let mut bare = whole.clone();
        while let Some(at) = bare.windows(2).position(|two| two == [0xff, 0xc4]) {
            let length = usize::from(u16::from_be_bytes([bare[at + 2], bare[at + 3]]));
            bare.drain(at..at + 2 + length);
        }
        assert!(bare.len() < whole.len() - 200);
        assert_eq!(decode(&bare), decode(&whole));
    }

    /// Returns an image with four colour components.
    pub(crate) fn four_colours() -> Vec<u8> {
        let mut jpeg = encode(&pattern([32, 32]), [32, 32], 85);
        let frame = jpeg.windows(2).position(|two| two == [0xff, 0xc0]).unwrap();
        // Another component, with the tables of the third one, in the frame and in the scan.
        let length = u16::from_be_bytes([jpeg[frame + 2], jpeg[frame + 3]]);
        let end = frame + 2 + usize::from(length);
        jpeg.splice(end..end, [4, 0x11, jpeg[end - 1]]);
        jpeg[frame + 2..frame + 4].copy_from_slice(&(length + 3).to_be_bytes());
        jpeg[frame + 9] = 4;
        let scan = jpeg.windows(2).position(|two| two == [0xff, 0xda]).unwrap();
        let tables = jpeg[scan + 10];
        jpeg.splice(scan + 11..scan + 11, [4, tables]);
        jpeg[scan + 3] += 2;
        jpeg[scan + 4] = 4;
        jpeg
    }

    #[test]
    fn four_colours_are_refused_with_their_name() {
        let refused = decode(&four_colours()).unwrap_err().to_string();
        assert!(refused.contains("4 colour components (CMYK)"), "{refused}");
    }

    #[test]
    fn a_picture_that_says_it_is_huge_takes_no_memory() {
        let mut jpeg = encode(&pattern([32, 32]), [32, 32], 85);
        let frame = jpeg.windows(2).position(|two| two == [0xff, 0xc0]).unwrap();
        for (height, width) in [(4000_u16, 4000_u16), (60_000, 60_000)] {
            jpeg[frame + 5..frame + 7].copy_from_slice(&height.to_be_bytes());
            jpeg[frame + 7..frame + 9].copy_from_slice(&width.to_be_bytes());
            let report = decode(&jpeg).unwrap_err();
            assert!(matches!(report, Damage::TooLarge { .. } | Damage::Undecodable { .. }), "{report}");
        }
    }

    #[test]
    fn black_is_black_and_dark_is_not() {
        let flat = |value: u8| decode(&encode(&vec![value; 3 * 64 * 64], [64, 64], 85)).unwrap();
        assert!(flat(0).is_black() && flat(4).is_black());
        assert!(!flat(20).is_black() && !flat(255).is_black());
        let mut lit = vec![0; 3 * 256 * 256];
        lit[..3 * 256 * 40].fill(200);
        assert!(!decode(&encode(&lit, [256, 256], 85)).unwrap().is_black());
    }

    /// Decodes this many images with random damage.
    fn mutate(seed: u64, count: usize) {
        let mut random = fastrand::Rng::with_seed(seed);
        let originals = [[64, 48], [33, 17]].map(|size_px| encode(&pattern(size_px), size_px, 80));
        for _ in 0..count {
            let mut jpeg = random.choice(&originals).unwrap().clone();
            for _ in 0..random.usize(1..6) {
                let at = random.usize(..jpeg.len());
                match random.u8(..4) {
                    0 => jpeg[at] = random.u8(..),
                    1 => jpeg[at] ^= 1 << random.u8(..8),
                    2 => drop(jpeg.drain(at..(at + random.usize(1..40)).min(jpeg.len()))),
                    _ => jpeg.insert(at, if random.bool() { 0xff } else { random.u8(..) }),
                }
                if jpeg.is_empty() {
                    jpeg.push(0xff);
                }
            }
            if let Ok(image) = decode(&jpeg) {
                assert_eq!(image.rgba.len(), 4 * image.size_px[0] * image.size_px[1]);
            }
        }
    }

    #[test]
    fn damaged_pictures_never_panic() {
        mutate(1, 3000);
    }

    #[test]
    #[ignore = "as long as ./dev fuzz asks for"]
    fn fuzz_damaged_pictures() {
        let rounds = fuzz::rounds(|seed| mutate(seed, 10_000));
        println!("{rounds} x 10000 pictures");
    }
}
