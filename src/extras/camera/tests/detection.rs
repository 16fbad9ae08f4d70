use super::*;
use crate::DetectionFailure;

/// Returns the root mean square and maximum distance of the detected corners from the true ones, px.
fn errors_px(sight: &BoardSight, real: &[Vector2<f64>]) -> [f64; 2] {
    let squares: Vec<f64> = sight.corners_px.iter().zip(real).map(|(a, b)| (a - b).norm_squared()).collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    [mean.sqrt(), squares.into_iter().fold(0.0, f64::max).sqrt()]
}

#[test]
fn corners_are_found_through_any_lens_blur_noise_and_light() {
    let mut rng = Rng::with_seed(1);
    let board = board();
    for (k1, sensor, largest_px) in [
        (-0.3, Sensor { blur_px: 0.0, noise: 0.0, edge: 1.0 }, 0.05),
        (0.0, Sensor::USUAL, 0.12),
        (0.3, Sensor { blur_px: 1.5, noise: 6.0, edge: 0.3 }, 0.2),
        (-0.3, Sensor { blur_px: 3.0, noise: 5.0, edge: 0.4 }, 0.3),
    ] {
        let lens = lens(k1);
        let portrait = Portrait::new(&lens);
        for pose in usual(&mut rng, &lens, &board, 4) {
            let sight = find(&sensor.image(&mut rng, &portrait, &board, &pose), &board).unwrap();
            let [rms_px, max_px] = errors_px(&sight, &corners_px(&lens, &board, &pose).unwrap());
            println!(
                "k1 {k1} blur {} noise {}: {rms_px:.3} px, most {max_px:.3} px; blur {:.2} px",
                sensor.blur_px, sensor.noise, sight.blur_px
            );
            assert!(rms_px < largest_px && max_px < 6.0 * largest_px, "k1 {k1}: {rms_px} {max_px}");
            // The pixel size itself contributes to the blur.
            assert!(
                (sight.blur_px - f64::from(sensor.blur_px)).abs() < 0.75 + 0.1 * f64::from(sensor.blur_px),
                "{}",
                sight.blur_px
            );
        }
    }
}

#[test]
fn a_board_is_the_right_way_up_however_it_is_turned() {
    let lens = lens(-0.2);
    let board = board();
    let portrait = Portrait::new(&lens);
    let mut rng = Rng::with_seed(2);
    for turn in [0.0, 90.0, 180.0, 270.0, 45.0, 200.0] {
        let pose = pose(&lens, &board, [0.0, 0.0], 0.12, [10.0, -12.0, turn]);
        let sight = find(&Sensor::USUAL.image(&mut rng, &portrait, &board, &pose), &board).unwrap();
        let [rms_px, _] = errors_px(&sight, &corners_px(&lens, &board, &pose).unwrap());
        assert!(rms_px < 0.2, "{turn}: {rms_px}");
    }
}

#[test]
fn what_is_not_the_whole_board_is_refused_and_told() {
    let lens = lens(0.0);
    let board = board();
    let portrait = Portrait::new(&lens);
    let mut rng = Rng::with_seed(3);
    let whole = pose(&lens, &board, [0.0, 0.0], 0.1, [12.0, 8.0, 5.0]);
    let mut image = Sensor::USUAL.image(&mut rng, &portrait, &board, &whole);
    assert!(find(&image, &board).is_ok());
    // A finger over two corners.
    let covered = corners_px(&lens, &board, &whole).unwrap()[22];
    let near = |at: usize| Vector2::new((at % 1280) as f64, (at / 1280) as f64);
    let values = image.values().iter().enumerate();
    let values = values.map(|(at, value)| if (near(at) - covered).norm() < 35.0 { 150.0 } else { *value });
    image = Grey::new(SIZE_PX, values.collect()).unwrap();
    let report = find(&image, &board).unwrap_err();
    assert!(matches!(report, DetectionFailure::Part { seen: 30..=53, of: 54 }), "{report:?}");
    // The board is half outside the image.
    let beside = pose(&lens, &board, [0.95, 0.0], 0.1, [0.0, 0.0, 0.0]);
    let report = find(&Sensor::USUAL.image(&mut rng, &portrait, &board, &beside), &board).unwrap_err();
    assert!(matches!(report, DetectionFailure::Part { seen: 10..=45, of: 54 }), "{report:?}");
    // Another board.
    let other = Checkerboard::new([10, 7], 0.006).unwrap();
    let there = pose(&lens, &other, [0.0, 0.0], 0.12, [12.0, 8.0, 5.0]);
    let report = find(&Sensor::USUAL.image(&mut rng, &portrait, &other, &there), &board).unwrap_err();
    assert_eq!(report, DetectionFailure::Other([10, 7]));
    // No board: noise, a blank image, and an image of a few pixels.
    let noise = (0..SIZE_PX[0] * SIZE_PX[1]).map(|_| (90.0 + 25.0 * normal(&mut rng)) as f32).collect();
    assert!(matches!(
        find(&Grey::new(SIZE_PX, noise).unwrap(), &board),
        Err(DetectionFailure::Nothing | DetectionFailure::Part { seen: 0..=8, .. })
    ));
    assert_eq!(
        find(&Grey::new(SIZE_PX, vec![0.0; SIZE_PX[0] * SIZE_PX[1]]).unwrap(), &board),
        Err(DetectionFailure::Nothing)
    );
    assert_eq!(find(&Grey::new([3, 1], vec![f32::NAN; 3]).unwrap(), &board), Err(DetectionFailure::Nothing));
    assert_eq!(Grey::new([3, 1], vec![0.0; 4]), None);
}
