//! Tests with rendered boards, whose lens and poses are known.

mod degenerate;
mod detection;
mod lenses;
mod touched_places;

use fastrand::Rng;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector2, Vector3};
use nima_endoscope::{Bend, Checkerboard, Lens, board::Portrait};

use crate::{BoardSight, CameraCoverage, Grey, find};

const SIZE_PX: [usize; 2] = [1280, 720];

fn board() -> Checkerboard {
    Checkerboard::new([9, 6], 0.006).unwrap()
}

fn lens(k1: f64) -> Lens {
    let centre_px = Vector2::new(655.0, 349.0);
    Lens { centre_px, ..Lens::simple(SIZE_PX, 760.0, k1) }
}

fn normal(rng: &mut Rng) -> f64 {
    (-2.0 * (1.0 - rng.f64()).ln()).sqrt() * (std::f64::consts::TAU * rng.f64()).cos()
}

/// Returns a board whose middle is seen at this position in the image (-1 to 1 each), tilted about x and y and rotated
/// about z, degrees.
fn pose(
    lens: &Lens,
    board: &Checkerboard,
    [x, y]: [f64; 2],
    far_m: f64,
    [tilt_x, tilt_y, turn]: [f64; 3],
) -> Isometry3<f64> {
    let [width, height] = lens.size_px.map(|side| side as f64);
    let at_px = Vector2::new(0.5 * width * (1.0 + x), 0.5 * height * (1.0 + y));
    let middle_m = lens.direction(&at_px).unwrap() * far_m;
    let angles = [tilt_x, tilt_y, turn].map(f64::to_radians);
    let rotation = UnitQuaternion::from_euler_angles(angles[0], angles[1], angles[2]);
    Isometry3::from_parts(Translation3::from(middle_m - rotation * board.middle_m()), rotation)
}

/// Returns typical poses of a person: over the whole image, some of them tilted in each direction. Every corner is
/// within the image.
fn usual(rng: &mut Rng, lens: &Lens, board: &Checkerboard, count: usize) -> Vec<Isometry3<f64>> {
    let mut poses = Vec::new();
    let mut spread = |k: usize| {
        let fractions = [
            [-0.6, -0.5],
            [0.6, -0.5],
            [0.6, 0.5],
            [-0.6, 0.5],
            [0.0, 0.0],
            [0.0, -0.5],
            [0.6, 0.0],
            [0.0, 0.5],
            [-0.6, 0.0],
        ];
        let tilts = [[0.0, 0.0], [28.0, 0.0], [-28.0, 0.0], [0.0, 28.0], [0.0, -28.0], [20.0, 20.0]];
        let fraction = fractions[k % fractions.len()];
        let tilt = tilts[k % tilts.len()];
        let mut vary = |by: f64| by * (2.0 * rng.f64() - 1.0);
        let fraction = fraction.map(|fraction| fraction + vary(0.12));
        let far_m = 0.085 + vary(0.02);
        pose(lens, board, fraction, far_m, [tilt[0] + vary(8.0), tilt[1] + vary(8.0), vary(25.0)])
    };
    for k in 0..400 {
        if poses.len() == count {
            break;
        }
        let pose = spread(k);
        if is_whole(lens, board, &pose) {
            poses.push(pose);
        }
    }
    assert_eq!(poses.len(), count);
    poses
}

fn corners_px(lens: &Lens, board: &Checkerboard, pose: &Isometry3<f64>) -> Option<Vec<Vector2<f64>>> {
    board.places_m().iter().map(|place_m| lens.project(&(pose.rotation * place_m + pose.translation.vector))).collect()
}

/// Returns whether all corners are in the image, with a margin for a window around them.
fn is_whole(lens: &Lens, board: &Checkerboard, pose: &Isometry3<f64>) -> bool {
    let [width, height] = lens.size_px.map(|side| side as f64);
    let inside = |at: &Vector2<f64>| (14.0..width - 14.0).contains(&at.x) && (14.0..height - 14.0).contains(&at.y);
    // Where barrel distortion folds back, squares are compressed to nothing; real lenses have further terms there.
    let max = 0.8 * lens.bend.tangent_max();
    let places_m = board.places_m();
    let mut before = places_m.iter().map(|place_m| pose.rotation * place_m + pose.translation.vector);
    let is_seen = before.all(|position_m| position_m.z > 0.0 && (position_m.xy() / position_m.z).norm() < max);
    is_seen && corners_px(lens, board, pose).is_some_and(|all| all.iter().all(inside))
}

/// Imperfections of a camera.
#[derive(Clone, Copy)]
struct Sensor {
    blur_px: f32,
    noise: f64,
    /// Brightness at the edge of the image, relative to the middle.
    edge: f64,
}

impl Sensor {
    const USUAL: Self = Self { blur_px: 1.0, noise: 3.0, edge: 0.5 };

    fn image(self, rng: &mut Rng, portrait: &Portrait, board: &Checkerboard, pose: &Isometry3<f64>) -> Grey {
        let sharp = Grey::new(SIZE_PX, portrait.draw(board, pose)).unwrap();
        let smooth = if self.blur_px > 0.0 { sharp.smooth(self.blur_px) } else { sharp };
        let [width, height] = SIZE_PX.map(|side| side as f64);
        let half = 0.5 * width.hypot(height);
        let values = smooth.values().iter().enumerate().map(|(at, value)| {
            let from = Vector2::new((at % SIZE_PX[0]) as f64 - 0.4 * width, (at / SIZE_PX[0]) as f64 - 0.6 * height);
            let light = 1.0 - (1.0 - self.edge) * (from.norm() / half).powi(2);
            (f64::from(*value) * light + self.noise * normal(rng)).round().clamp(0.0, 255.0) as f32
        });
        Grey::new(SIZE_PX, values.collect()).unwrap()
    }
}

/// Views found in rendered images.
fn rendered(rng: &mut Rng, lens: &Lens, poses: &[Isometry3<f64>], sensor: Sensor) -> Vec<BoardSight> {
    let board = board();
    let portrait = Portrait::new(lens);
    let views = poses.iter().map(|pose| find(&sensor.image(rng, &portrait, &board, pose), &board));
    views.enumerate().map(|(at, view)| view.unwrap_or_else(|why| panic!("view {at}: {why:?}"))).collect()
}

/// Returns the same without images: true corners with noise.
fn noisy(rng: &mut Rng, lens: &Lens, poses: &[Isometry3<f64>], noise_px: f64) -> Vec<BoardSight> {
    let light = Grey::new(SIZE_PX, vec![200.0; SIZE_PX[0] * SIZE_PX[1]]).unwrap();
    let view = |pose| {
        let mut corners_px = corners_px(lens, &board(), pose).unwrap();
        for corner in &mut corners_px {
            *corner += Vector2::new(normal(rng), normal(rng)) * noise_px;
        }
        let coverage = CameraCoverage::of(&light, &corners_px);
        BoardSight { corners_px, blur_px: 1.0, coverage }
    };
    poses.iter().map(view).collect()
}

/// Returns the maximum error of focal lengths and centre, relative to the focal length.
fn error(found: &Lens, real: &Lens) -> f64 {
    let focal = (found.focal_px - real.focal_px).abs().max();
    focal.max((found.centre_px - real.centre_px).abs().max()) / real.focal_px.x
}

/// Returns the maximum distance in the image between the positions of the same direction, px.
fn bend_px(found: &Lens, real: &Lens) -> f64 {
    let at = |column: usize, row: usize| Vector2::new(column as f64 * 128.0, row as f64 * 120.0);
    let places = (0..=10).flat_map(|column| (0..=6).map(move |row| at(column, row)));
    let miss = places.filter_map(|place| {
        let shown: Vector3<f64> = real.direction(&place)?;
        Some((found.project(&shown)? - place).norm())
    });
    miss.fold(0.0, f64::max)
}

#[test]
fn the_tests_own_lenses_bend_both_ways() {
    assert!((lens(0.3).bend, lens(-0.3).bend) == (Bend::radial(0.3), Bend::radial(-0.3)));
    assert!(bend_px(&lens(0.3), &lens(-0.3)) > 100.0);
}
