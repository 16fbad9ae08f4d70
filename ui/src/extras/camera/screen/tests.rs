use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use nima_endoscope::{Bend, board::Portrait};

use super::*;

fn board() -> Checkerboard {
    Checkerboard::new([9, 6], 0.01).unwrap()
}

fn lens() -> Lens {
    Lens { bend: Bend::radial(-0.25), ..Lens::simple([1280, 720], 740.0, 0.0) }
}

/// Returns the result of the detector for a board at this pose, without an image.
fn found(camera_from_board: &Isometry3<f64>) -> BoardImage {
    let place = |place_m: &Vector3<f64>| lens().project(&(camera_from_board * nalgebra::Point3::from(*place_m)).coords);
    let corners_px: Option<Vec<_>> = board().places_m().iter().map(place).collect();
    let light = nima_camera::Grey::new([64, 36], vec![200.0; 64 * 36]).unwrap();
    let small: Vec<_> = corners_px.as_ref().unwrap().iter().map(|at| at / 20.0).collect();
    let coverage = nima_camera::CameraCoverage::of(&light, &small);
    let sight = Ok(BoardSight { corners_px: corners_px.unwrap(), blur_px: 1.0, coverage });
    let image = Arc::new(DecodedImage { size_px: [1280, 720], rgba: Vec::new() });
    BoardImage { image, board: board(), sight }
}

fn pose(position_m: [f64; 3], turn: [f64; 3]) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]);
    Isometry3::from_parts(Translation3::from(Vector3::from(position_m) - rotation * board().middle_m()), rotation)
}

fn shown(wizard: &mut CameraWizard, camera_from_board: &Isometry3<f64>) {
    wizard.take(found(camera_from_board));
    wizard.take(found(camera_from_board));
}

/// Returns a wizard with a lens.
fn with_lens() -> CameraWizard {
    let mut wizard = CameraWizard::default();
    wizard.go_to(VIEWS);
    for k in 0..22 {
        let turn = 0.9 * f64::from(k);
        let position_m = [0.055 * (2.0 * turn).cos(), 0.032 * (3.0 * turn).sin(), 0.15];
        shown(&mut wizard, &pose(position_m, [0.5 * turn.cos(), 0.5 * turn.sin(), 0.1]));
    }
    assert!(wizard.views() >= 12 && wizard.views() <= 22, "{}", wizard.views());
    wizard.go_to(LENS);
    wizard
}

#[test]
fn a_board_that_moves_is_not_taken_and_one_that_rests_is_taken_once() {
    let mut wizard = CameraWizard::default();
    wizard.go_to(VIEWS);
    for k in 0..5 {
        wizard.take(found(&pose([0.004 * f64::from(k), 0.0, 0.15], [0.0; 3])));
        assert_eq!((wizard.views(), wizard.last), (0, Some(Ok(ViewOutcome::Moving))));
    }
    for _ in 0..4 {
        wizard.take(found(&pose([0.016, 0.0, 0.15], [0.0; 3])));
    }
    assert_eq!((wizard.views(), wizard.last), (1, Some(Ok(ViewOutcome::TakenHere))));
    wizard.start_over();
    assert_eq!(wizard.views(), 0);
}

#[test]
fn lens_and_touched_corners_place_the_camera_and_a_board_that_moved_does_not() {
    let mut wizard = with_lens();
    let report = wizard.report.as_ref().unwrap();
    assert!(is_good(report), "{:?}", report.cause);
    assert!((wizard.lens().unwrap().focal_px.x - 740.0).abs() < 1.0);
    wizard.go_to(TOUCH);
    let lies = pose([0.0, 0.01, 0.14], [0.4, 0.1, 0.2]);
    assert_eq!(wizard.next_corner(), None, "not before the board lies still");
    shown(&mut wizard, &lies);
    let world_from_camera = Isometry3::new([0.01, -0.09, 0.09].into(), [-2.1, 0.1, 0.0].into());
    let binding = Binding::default();
    assert!(wizard.may_go_on(&binding).is_ok(), "the lens alone may be saved");
    for touched in 0..5 {
        let corner = wizard.next_corner().unwrap();
        let tip_m = (world_from_camera * lies * nalgebra::Point3::from(board().places_m()[corner])).coords;
        let begin_s = f64::from(touched) * 2.0;
        for step in 0..60 {
            let from_m = tip_m + Vector3::x() * 1e-3 * f64::from(60 - step);
            wizard.tip.note(begin_s + 0.01 * f64::from(step), from_m);
        }
        assert_eq!(wizard.tip.still_m(), None, "the tip moves");
        for step in 60..130 {
            wizard.tip.note(begin_s + 0.01 * f64::from(step), tip_m);
        }
        wizard.take_touch();
        assert_eq!(wizard.touches.len(), touched as usize + 1);
        assert_eq!(wizard.may_go_on(&binding).is_ok(), touched >= 3, "{touched}");
    }
    let placed = wizard.good_place().unwrap();
    let moved = placed.world_from_camera.inverse() * world_from_camera;
    assert!(moved.translation.vector.norm() < 0.2e-3 && moved.rotation.angle() < 2e-3, "{moved}");
    assert_eq!(wizard.next_corner(), None);
    assert!(wizard.proof().unwrap().contains("touched corners"));
    let place = wizard.found_place().unwrap();
    assert!(!place.on_marker && place.pose == placed_at(&wizard));
    // A tracker sees the endoscope's marker: the pose is relative to the marker.
    let world_from_n = Isometry3::new([0.0, -0.2, 0.3].into(), [0.4, 1.0, -2.0].into());
    for step in 0..200 {
        wizard.marker.note(f64::from(step) * 0.01, Some(&world_from_n));
    }
    let place = wizard.found_place().unwrap();
    assert!(place.on_marker && wizard.proof().unwrap().contains("follows the endoscope's marker"));
    let again = world_from_n * place.pose;
    let off = again.inverse() * placed_at(&wizard);
    assert!(off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-9, "{off}");
    // The endoscope has been pushed.
    shown(&mut wizard, &pose([0.002, 0.01, 0.14], [0.4, 0.1, 0.2]));
    assert!(wizard.moved && wizard.good_place().is_none() && wizard.may_go_on(&binding).is_err());
    wizard.lay_anew();
    assert!(!wizard.moved && wizard.touches.is_empty());
}

fn placed_at(wizard: &CameraWizard) -> Isometry3<f64> {
    wizard.good_place().unwrap().world_from_camera
}

#[test]
fn the_thread_finds_the_board_in_a_picture() {
    let ctx = egui::Context::default();
    let mut wizard = CameraWizard::default();
    let camera_from_board = pose([0.0, 0.0, 0.16], [0.2, -0.1, 0.1]);
    let greys = Portrait::new(&lens()).draw(&board(), &camera_from_board);
    let rgba = greys.iter().flat_map(|grey| [*grey as u8, *grey as u8, *grey as u8, 255]).collect();
    let image = Arc::new(DecodedImage { size_px: [1280, 720], rgba });
    for _ in 0..3000 {
        wizard.see(Some((1, Arc::clone(&image))), &ctx);
        if wizard.sight.is_some() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let real_px = lens().project(&(camera_from_board * nalgebra::Point3::origin()).coords).unwrap();
    assert!((wizard.sight.unwrap().corners_px[0] - real_px).norm() < 0.3);
}
