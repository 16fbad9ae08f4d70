//! A checkerboard in front of the lens, held by a person during the camera calibration.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector2};
use nima_endoscope::{Checkerboard, Lens, board::Portrait};

/// Function that returns the pose of the board in front of the lens at a time, s since the emulator began.
pub type BoardHands = Box<dyn FnMut(f64) -> Isometry3<f64> + Send>;

/// Duration of holding a pose, and of the movement to the next one, s. Long enough for the console to notice that the
/// board is held still and to capture it.
const HELD_S: f64 = 1.8;
const WAY_S: f64 = 0.4;
/// Fraction of the image width that the board covers, and margin around its corners, px.
const WIDE: f64 = 0.4;
const FREE_PX: f64 = 16.0;
/// Barrel distortion compresses squares to nothing where it folds back, so the board stays within this fraction of the
/// tangent at that point.
const SQUEEZED: f64 = 0.8;
/// Positions of the middle of the board in the image, -1 to 1 horizontally and vertically.
const PLACES: [[f64; 2]; 9] = [
    [0.0, 0.0],
    [-0.62, -0.6],
    [0.62, -0.6],
    [0.62, 0.6],
    [-0.62, 0.6],
    [0.0, -0.6],
    [0.62, 0.0],
    [0.0, 0.6],
    [-0.62, 0.0],
];
/// Tilt about the horizontal and the vertical axis, and its rotation, degrees.
const TURNS_DEG: [[f64; 3]; 5] =
    [[0.0, 0.0, 4.0], [26.0, 0.0, -6.0], [-26.0, 0.0, 8.0], [0.0, 26.0, 0.0], [0.0, -26.0, -10.0]];
const POSES: usize = 20;
/// Noise of the sensor, of 255. Without noise, all images of a still board would be equal, like those of a frozen
/// camera.
const NOISE: f32 = 2.0;

/// Returns a person who holds the board at one position after the other, over the whole image, and tilts it in every
/// direction.
pub fn held(board: Checkerboard, lens: &Lens) -> BoardHands {
    let poses: Vec<_> = (0..POSES).map(|k| pose(&board, lens, k)).collect();
    Box::new(move |now_s| {
        let at = (now_s / (HELD_S + WAY_S)).max(0.0);
        let [from, to] = [0, 1].map(|more| poses[(at as usize + more) % POSES]);
        let fraction = (at.fract() * (HELD_S + WAY_S) - HELD_S) / WAY_S;
        from.lerp_slerp(&to, fraction.clamp(0.0, 1.0))
    })
}

/// Returns a pose of the list, as close to its position as possible with the whole board visible.
fn pose(board: &Checkerboard, lens: &Lens, k: usize) -> Isometry3<f64> {
    let [width, height] = lens.size_px.map(|side| side as f64);
    let side_m = board.corners()[0] as f64 * board.square_m();
    let far_m = lens.focal_px.x * side_m / (WIDE * width);
    let [level, upright, turn] = TURNS_DEG[k % TURNS_DEG.len()].map(f64::to_radians);
    let rotation = UnitQuaternion::from_euler_angles(level, upright, turn);
    let [x, y] = PLACES[k % PLACES.len()];
    let at = |fraction: f64| {
        let place_px = Vector2::new(0.5 * width * (1.0 + fraction * x), 0.5 * height * (1.0 + fraction * y));
        let middle_m = lens.direction(&place_px)? * far_m;
        Some(Isometry3::from_parts(Translation3::from(middle_m - rotation * board.middle_m()), rotation))
    };
    let inside = |place_px: Vector2<f64>| {
        (FREE_PX..width - FREE_PX).contains(&place_px.x) && (FREE_PX..height - FREE_PX).contains(&place_px.y)
    };
    let max = SQUEEZED * lens.bend.tangent_max();
    let is_whole = |pose: &Isometry3<f64>| {
        board.places_m().into_iter().all(|place_m| {
            let position_m = (pose * nalgebra::Point3::from(place_m)).coords;
            (position_m.xy() / position_m.z).norm() < max && lens.project(&position_m).is_some_and(inside)
        })
    };
    let fractions = (0..=20).rev().map(|k| f64::from(k) / 20.0);
    let far = Isometry3::from_parts(Translation3::new(0.0, 0.0, far_m), rotation);
    fractions.filter_map(at).find(is_whole).unwrap_or(far)
}

/// Draws the board into images with three bytes per pixel.
pub(super) struct BoardDrawing {
    board: Checkerboard,
    portrait: Portrait,
    image: Vec<u8>,
    noise: u32,
}

impl BoardDrawing {
    /// Takes some tenths of a second.
    pub(super) fn new(board: Checkerboard, lens: &Lens) -> Self {
        let [width, height] = lens.size_px;
        Self { board, portrait: Portrait::new(lens), image: vec![0; 3 * width * height], noise: 1 }
    }

    pub(super) fn draw(&mut self, camera_from_board: &Isometry3<f64>) -> &mut [u8] {
        let greys = self.portrait.draw(&self.board, camera_from_board);
        for (pixel, grey) in self.image.chunks_exact_mut(3).zip(greys) {
            // The quick generator from Numerical Recipes is good enough here.
            self.noise = self.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = ((self.noise >> 16) as f32 / 65_536.0 - 0.5) * 2.0 * NOISE;
            pixel.fill((grey + noise).clamp(0.0, 255.0) as u8);
        }
        &mut self.image
    }
}
