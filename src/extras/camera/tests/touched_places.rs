use nalgebra::Point3;
use nima_core::calibration::Verdict;

use super::*;
use crate::{CameraPlacement, PlaceError, PlaceLack, TouchedCorner, place};

/// Returns a camera above a board that lies on the table.
fn scene() -> (Lens, Isometry3<f64>, Isometry3<f64>) {
    let lens = lens(-0.3);
    let camera_from_board = pose(&lens, &board(), [0.1, -0.1], 0.1, [25.0, -10.0, 30.0]);
    let rotation = UnitQuaternion::from_euler_angles(-2.2, 0.1, 0.2);
    (lens, camera_from_board, Isometry3::from_parts(Translation3::new(0.01, -0.09, 0.09), rotation))
}

fn touches(rng: &mut Rng, corners: &[[usize; 2]], noise_m: f64) -> Vec<TouchedCorner> {
    let (_, camera_from_board, world_from_camera) = scene();
    let touch = |corner: &[usize; 2]| {
        let on_board = Point3::new(corner[0] as f64 * 0.006, corner[1] as f64 * 0.006, 0.0);
        let tip = world_from_camera * camera_from_board * on_board;
        TouchedCorner { corner: *corner, tip_m: tip.coords + Vector3::from_fn(|_, _| normal(rng)) * noise_m }
    };
    corners.iter().map(touch).collect()
}

fn placed(rng: &mut Rng, touches: &[TouchedCorner]) -> Result<CameraPlacement, PlaceError> {
    let (lens, camera_from_board, _) = scene();
    place(&board(), &lens, &noisy(rng, &lens, &[camera_from_board], 0.05)[0], touches)
}

const OUTER: [[usize; 2]; 5] = [[0, 0], [8, 0], [8, 5], [0, 5], [4, 2]];

#[test]
fn the_camera_is_found_from_touched_corners() {
    let mut rng = Rng::with_seed(31);
    for _ in 0..20 {
        let touched = touches(&mut rng, &OUTER, 0.2e-3);
        let placed = placed(&mut rng, &touched).unwrap();
        let (lens, camera_from_board, world_from_camera) = scene();
        assert_eq!(placed.verdict(), Verdict::Accepted, "{placed:?}");
        // The result that matters: where a tip is drawn on the board, and 1 cm in front of it.
        let camera = nima_endoscope::Camera { lens, world_from_camera: placed.world_from_camera };
        for z in [0.0, -0.01] {
            let tip_m = world_from_camera * camera_from_board * Point3::new(0.02, 0.012, z);
            let drawn_px = camera.project(&tip_m.coords).unwrap();
            let seen_px = lens.project(&(world_from_camera.inverse() * tip_m).coords).unwrap();
            assert!((drawn_px - seen_px).norm() < 5.0, "{}", (drawn_px - seen_px).norm());
        }
        assert!(placed.held_out_px < 10.0 && placed.held_out_px > 0.3 && placed.fitted_m < 0.5e-3, "{placed:?}");
    }
}

#[test]
fn touches_that_cannot_place_a_camera_are_refused() {
    let mut rng = Rng::with_seed(32);
    let few = touches(&mut rng, &OUTER[..3], 0.0);
    assert_eq!(placed(&mut rng, &few).unwrap_err(), PlaceError::TooFew { touched: 3, needed: 4 });
    let line = touches(&mut rng, &[[0, 2], [2, 2], [5, 2], [8, 2]], 0.0);
    assert_eq!(placed(&mut rng, &line).unwrap_err(), PlaceError::OneLine);
    // The next corner was touched by mistake.
    let mut wrong = touches(&mut rng, &OUTER, 0.0);
    wrong[2].corner = [7, 5];
    let lack = placed(&mut rng, &wrong).unwrap().lack;
    assert!(matches!(lack, Some(PlaceLack::NotRigid { corner: [7, 5], by_m }) if by_m > 0.002), "{lack:?}");
    let poor = touches(&mut rng, &OUTER, 3e-3);
    assert_eq!(placed(&mut rng, &poor).unwrap().verdict(), Verdict::PoorData);
    let (lens, camera_from_board, _) = scene();
    let mut elsewhere = noisy(&mut rng, &lens, &[camera_from_board], 0.0).remove(0);
    elsewhere.corners_px.iter_mut().for_each(|corner| *corner = Vector2::new(f64::NAN, 0.0));
    let good = touches(&mut rng, &OUTER, 0.0);
    assert_eq!(place(&board(), &lens, &elsewhere, &good).unwrap_err(), PlaceError::NotSeen);
}
