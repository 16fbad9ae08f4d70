use nima_testing::fuzz;

use super::*;
use crate::{CompressedFrame, Damage, Format, jpeg::tests::pattern};

/// Returns a few moving images.
fn stream(size_px: [usize; 2], count: usize) -> Vec<Vec<u8>> {
    let mut encoder = H264Encoder::new(30.0).unwrap();
    let image = |number: usize| {
        let mut rgb = pattern(size_px);
        rgb.rotate_right(3 * 2 * number);
        rgb
    };
    (0..count).map(|number| encoder.encode(&image(number), size_px, false).unwrap()).collect()
}

#[test]
fn a_stream_comes_back_with_its_colours() {
    let bars = |size_px: [usize; 2]| -> Vec<u8> {
        let bar = |x: usize| [x * 4 / size_px[0], x * 2 / size_px[0] % 2, x * 8 / size_px[0] % 2];
        let colour = |x: usize| bar(x).map(|level| [40, 210, 120, 250][level % 4]);
        (0..size_px[0] * size_px[1]).flat_map(|at| colour(at % size_px[0])).collect()
    };
    // The encoder marks the colours as BT.709, which no decoder would assume for such a small image.
    for size_px in [[128, 96], [640, 360]] {
        let mut encoder = H264Encoder::new(30.0).unwrap();
        let mut decoder = H264Decoder::default();
        let rgb = bars(size_px);
        for number in 0..3 {
            let unit = encoder.encode(&rgb, size_px, false).unwrap();
            assert_eq!(is_key(&unit), number == 0);
            let image = decoder.take(&unit, is_key(&unit), true).unwrap().unwrap().image.unwrap();
            assert_eq!(image.size_px, size_px);
            let middle = size_px[0] / 8 * size_px[1] / 2;
            for x in (size_px[0] / 16..size_px[0]).step_by(size_px[0] / 8) {
                let at = size_px[0] * (middle / size_px[0]) + x;
                let [is, was] = [&image.rgba[4 * at..][..3], &rgb[3 * at..][..3]];
                assert!(is.iter().zip(was).all(|(a, b)| a.abs_diff(*b) <= 6), "{x}: {is:?} {was:?}");
            }
        }
    }
}

#[test]
fn the_same_picture_is_told_and_another_one_too() {
    let size_px = [160, 96];
    let mut encoder = H264Encoder::new(30.0).unwrap();
    let mut decoder = H264Decoder::default();
    let mut hash = |rgb: &[u8]| {
        let unit = encoder.encode(rgb, size_px, true).unwrap();
        let taken = decoder.take(&unit, is_key(&unit), false).unwrap().unwrap();
        assert!(taken.image.is_none());
        taken.hash
    };
    let rgb = pattern(size_px);
    let first: Vec<u64> = (0..4).map(|_| hash(&rgb)).collect();
    assert!(first.iter().all(|next| *next == first[0]), "{first:?}");
    let mut other = rgb;
    other[..3000].fill(250);
    assert_ne!(hash(&other), first[0]);
}

#[test]
fn it_begins_with_a_key_picture_and_after_a_damage_with_the_next_one() {
    let size_px = [96, 64];
    let stream = stream(size_px, 35);
    let mut decoder = H264Decoder::default();
    assert!(decoder.take(&stream[1], false, true).unwrap().is_none());
    assert!(decoder.take(&stream[0], true, true).unwrap().is_some());
    let torn = &stream[1][..stream[1].len() / 2];
    let report = decoder.take(torn, false, true);
    assert!(matches!(report, Err(Damage::Undecodable { .. })), "{report:?}");
    assert!(decoder.take(&stream[2], false, true).unwrap().is_none());
    let next = stream.iter().skip(1).find(|unit| is_key(unit)).unwrap();
    assert!(decoder.take(next, true, true).unwrap().is_some());
}

#[test]
fn parameters_of_a_huge_picture_are_refused_before_memory_is_taken() {
    let huge = H264Encoder::new(30.0).unwrap().encode(&vec![90; 3 * 3840 * 2160], [3840, 2160], false).unwrap();
    assert!(H264Decoder::default().take(&huge, true, true).unwrap().is_some());
    // The maximum number of macroblocks that can be written, as a flipped bit may produce.
    let mut parameters = vec![0, 0, 0, 1, 0x67, 66, 0xc0, 52];
    parameters.extend_from_slice(&[0b1010_0000, 0x00, 0x7f, 0xff, 0x00, 0x01, 0xff, 0xf8, 0x80]);
    let report = H264Decoder::default().take(&[&parameters[..], &huge].concat(), true, true);
    assert!(matches!(report, Err(Damage::TooLarge { .. } | Damage::Undecodable { .. })), "{report:?}");
}

/// Damages frames of a stream at random; returns how many were decoded.
fn mutate(seed: u64, count: usize) -> usize {
    let mut random = fastrand::Rng::with_seed(seed);
    let stream = stream([64, 48], 6);
    let mut decoder = H264Decoder::default();
    let mut decoded = 0;
    for number in 0..count {
        let mut unit = stream[number % stream.len()].clone();
        for _ in 0..random.usize(0..4) {
            let at = random.usize(..unit.len());
            match random.u8(..4) {
                0 => unit[at] = random.u8(..),
                1 => unit[at] ^= 1 << random.u8(..8),
                2 => unit.truncate(at.max(1)),
                _ => drop(unit.drain(at..(at + random.usize(1..20)).min(unit.len()))),
            }
            if unit.is_empty() {
                unit.push(0);
            }
        }
        let compressed = CompressedFrame {
            format: Format::H264 { is_key: is_key(&unit) },
            bytes: unit,
            arrived: std::time::Instant::now(),
            stamp_s: None,
            taken: None,
        };
        if let Ok(Some(taken)) = decoder.take(&compressed.bytes, is_key(&compressed.bytes), true) {
            decoded += usize::from(taken.image.is_some());
        }
    }
    decoded
}

#[test]
fn damaged_streams_never_panic() {
    assert!(mutate(1, 600) > 20);
}

#[test]
#[ignore = "as long as ./dev fuzz asks for"]
fn fuzz_damaged_streams() {
    let rounds = fuzz::rounds(|seed| {
        mutate(seed, 10_000);
    });
    println!("{rounds} x 10000 pictures");
}

#[test]
#[ignore = "figures of docs/results/endoscope.md: some seconds, alone"]
fn figures_of_h264() {
    for size_px in [[1280, 720], [1920, 1080]] {
        let stream = stream(size_px, 40);
        let mut decoder = H264Decoder::default();
        let mut times_ms: Vec<f64> = stream
            .iter()
            .map(|unit| {
                let begin = std::time::Instant::now();
                decoder.take(unit, is_key(unit), true).unwrap();
                begin.elapsed().as_secs_f64() * 1e3
            })
            .collect();
        times_ms.sort_by(f64::total_cmp);
        println!("{size_px:?}: p50 {:.1} ms, max {:.1} ms, with colours", times_ms[20], times_ms[39]);
    }
}
