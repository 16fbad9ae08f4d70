//! Draws the scene through the lens: the ground once, then the instruments over it in each image. Simple, on one
//! processor, without a display.

use nalgebra::{Vector2, Vector3};
use nima_endoscope::Camera;
use nima_simulation::scene::Scene;

use super::EndoscopeInstrument;

type Colour = [f64; 3];

const TISSUE_DARK: Colour = [150.0, 72.0, 66.0];
const TISSUE_PALE: Colour = [206.0, 122.0, 110.0];
const TARGET: Colour = [217.0, 222.0, 227.0];
const AROUND: Colour = [52.0, 30.0, 32.0];
const BEYOND_THE_LENS: [u8; 3] = [4, 4, 5];
const STEEL: Colour = [176.0, 184.0, 194.0];
const SHAFT: Colour = [98.0, 106.0, 118.0];
/// The mark at the tip, in a colour that tissue never has. Tests find the tip in an image by it.
pub(super) const MARK: [u8; 3] = [0, 230, 70];
/// Radius of the mark, of the shaft, and of a target's ring, m.
const MARK_M: f64 = 0.001_2;
const SHAFT_M: f64 = 0.002_5;
const RING_M: [f64; 2] = [0.005_5, 0.000_8];
/// Length of bare steel behind the tip, m.
const STEEL_M: f64 = 0.012;
/// Width of the shadow under a tip, m, and height above the tissue at which it disappears, m.
const SHADOW_M: f64 = 0.006;
const SHADOW_HEIGHT_M: f64 = 0.03;
/// Distance at which the light of the lens has full strength, m.
const LIT_M: f64 = 0.11;
/// Length of the pieces in which a shaft is drawn, m, and length that is drawn, m.
const PIECE_M: f64 = 0.002_5;
const FOLLOWED_M: f64 = 0.25;
/// A piece of a shaft extends slightly beyond its ends, as a fraction of its length, so that bent shafts have no gaps.
const BESIDE: std::ops::RangeInclusive<f64> = -0.25..=1.25;
/// Objects farther outside the image than this are not drawn, px. A margin is needed because lens distortion moves
/// points near the edge.
const OUTSIDE_PX: f64 = 300.0;

/// Draws images with three bytes per pixel.
pub(super) struct Painter {
    camera: Camera,
    surface_m: f64,
    ground: Vec<u8>,
    image: Vec<u8>,
}

impl Painter {
    /// Takes some tenths of a second, for the ground.
    pub(super) fn new(camera: Camera, scene: &Scene) -> Self {
        let ground = DrawGround::of(scene);
        let [width, height] = camera.lens.size_px;
        let places = (0..height).flat_map(|y| (0..width).map(move |x| Vector2::new(x as f64 + 0.5, y as f64 + 0.5)));
        let pixels: Vec<u8> = places.flat_map(|place_px| ground.pixel(&camera, &place_px)).collect();
        Self { camera, surface_m: ground.surface_m, image: pixels.clone(), ground: pixels }
    }

    /// Draws the image with these instruments.
    pub(super) fn draw(&mut self, instruments: &[EndoscopeInstrument]) -> &[u8] {
        self.image.copy_from_slice(&self.ground);
        for instrument in instruments {
            self.shadow(instrument);
        }
        for instrument in instruments {
            self.shaft(instrument);
            self.mark(instrument);
        }
        &self.image
    }

    /// Darkens the tissue under a tip: the closer, the darker.
    fn shadow(&mut self, EndoscopeInstrument { tip_m, .. }: &EndoscopeInstrument) {
        let below_m = Vector3::new(tip_m.x, tip_m.y, self.surface_m);
        let fraction = 1.0 - ((tip_m.z - self.surface_m) / SHADOW_HEIGHT_M).clamp(0.0, 1.0);
        if fraction <= 0.0 {
            return;
        }
        let Some((middle_px, radius_px)) = self.disc(&below_m, SHADOW_M) else { return };
        self.near([middle_px; 2], radius_px, |pixel, away| {
            let keep = 1.0 - 0.6 * fraction * (1.0 - away * away);
            *pixel = pixel.map(|value| (f64::from(value) * keep) as u8);
        });
    }

    /// Draws a shaft from the far end to the tip, so that near parts cover far ones.
    fn shaft(&mut self, EndoscopeInstrument { tip_m, trocar_m }: &EndoscopeInstrument) {
        let Some(axis) = (trocar_m - tip_m).try_normalize(1e-6) else { return };
        let [width, height] = self.camera.lens.size_px.map(|side| side as f64);
        let inside = |place_px: &Vector2<f64>| {
            (-OUTSIDE_PX..width + OUTSIDE_PX).contains(&place_px.x)
                && (-OUTSIDE_PX..height + OUTSIDE_PX).contains(&place_px.y)
        };
        let pieces = (FOLLOWED_M / PIECE_M) as usize;
        let discs = (0..pieces).map_while(|piece| {
            let along_m = piece as f64 * PIECE_M;
            let radius_m = if along_m < STEEL_M { 0.8 * SHAFT_M } else { SHAFT_M };
            let (place_px, radius_px) = self.disc(&(tip_m + axis * along_m), radius_m)?;
            inside(&place_px).then_some((place_px, radius_px, along_m))
        });
        let discs: Vec<_> = discs.collect();
        for pair in discs.windows(2).rev() {
            let [(near_px, ..), (far_px, radius_px, along_m)] = [pair[0], pair[1]];
            let colour = if along_m <= STEEL_M { STEEL } else { SHAFT };
            self.near([near_px, far_px], radius_px, |pixel, away| {
                // Shade it like a round rod lit from the lens.
                let light = 0.25 + 0.75 * (1.0 - away * away).max(0.0).sqrt();
                *pixel = colour.map(|value| (value * light) as u8);
            });
        }
    }

    fn mark(&mut self, EndoscopeInstrument { tip_m, .. }: &EndoscopeInstrument) {
        let Some((middle_px, radius_px)) = self.disc(tip_m, MARK_M) else { return };
        self.near([middle_px; 2], radius_px, |pixel, _| *pixel = MARK);
    }

    /// Returns the position and radius of a ball in the image, px.
    fn disc(&self, middle_m: &Vector3<f64>, radius_m: f64) -> Option<(Vector2<f64>, f64)> {
        let middle_px = self.camera.project(middle_m)?;
        let beside_px = self.camera.project(&(middle_m + self.camera.right() * radius_m))?;
        Some((middle_px, (beside_px - middle_px).norm()))
    }

    /// Visits every pixel that is nearer than `radius_px` to a line; `paint` gets its distance in radii.
    fn near(&mut self, ends_px: [Vector2<f64>; 2], radius_px: f64, mut paint: impl FnMut(&mut [u8; 3], f64)) {
        let [width, height] = self.camera.lens.size_px;
        let range = |of: fn(&Vector2<f64>) -> f64, max: usize| {
            let [a, b] = ends_px.each_ref().map(of);
            let from = (a.min(b) - radius_px).floor().clamp(0.0, max as f64) as usize;
            from..(a.max(b) + radius_px + 1.0).ceil().clamp(0.0, max as f64) as usize
        };
        let way = ends_px[1] - ends_px[0];
        let square = way.norm_squared();
        let columns = range(|place| place.x, width);
        for y in range(|place| place.y, height) {
            for x in columns.clone() {
                let from = Vector2::new(x as f64 + 0.5, y as f64 + 0.5) - ends_px[0];
                let along = if square > 0.0 { from.dot(&way) / square } else { 0.0 };
                if !BESIDE.contains(&along) {
                    continue;
                }
                let away = (from - way * along).norm() / radius_px;
                let at = 3 * (width * y + x);
                if away <= 1.0
                    && let Some(pixel) = self.image[at..].first_chunk_mut()
                {
                    paint(pixel, away);
                }
            }
        }
    }
}

/// The surface under the instruments.
#[expect(clippy::struct_field_names, reason = "the unit")]
struct DrawGround {
    surface_m: f64,
    /// Half the sides of the tissue, m; `None` without tissue.
    half_m: Option<[f64; 2]>,
    targets_m: Vec<Vector3<f64>>,
}

impl DrawGround {
    fn of(scene: &Scene) -> Self {
        let of_left = scene.left.iter().flat_map(|left| &left.targets_m);
        Self {
            surface_m: scene.tissue.map_or(0.0, |tissue| tissue.surface_z_m),
            half_m: scene.tissue.map(|tissue| tissue.size_m.map(|side_m| 0.5 * side_m)),
            targets_m: scene.targets_m.iter().chain(of_left).copied().collect(),
        }
    }

    fn pixel(&self, camera: &Camera, place_px: &Vector2<f64>) -> [u8; 3] {
        let Some([eye_m, direction]) = camera.sight(place_px) else { return BEYOND_THE_LENS };
        let colour = |position_m: Vector3<f64>, colour: Colour| {
            let light = (LIT_M / (position_m - eye_m).norm()).powi(2).min(1.1);
            colour.map(|value| (value * light).clamp(0.0, 255.0) as u8)
        };
        let steps = (self.surface_m - eye_m.z) / direction.z;
        if !(steps > 0.0 && steps < 10.0) {
            return AROUND.map(|value| (0.3 * value) as u8);
        }
        let position_m = eye_m + direction * steps;
        let on_tissue = self.half_m.is_some_and(|[x_m, y_m]| position_m.x.abs() <= x_m && position_m.y.abs() <= y_m);
        let [ring_m, wide_m] = RING_M;
        let on_ring = |target_m: &Vector3<f64>| ((target_m - position_m).xy().norm() - ring_m).abs() <= wide_m;
        if self.targets_m.iter().any(on_ring) {
            colour(position_m, TARGET)
        } else if on_tissue {
            colour(position_m, mottled(position_m.x, position_m.y))
        } else {
            colour(position_m, AROUND)
        }
    }
}

/// Returns slow and fine variations, as of blood below a surface.
fn mottled(x: f64, y: f64) -> Colour {
    let wave = (x * 97.0 + 2.1 * (y * 61.0).sin()).sin() + (y * 83.0 - 2.3 * (x * 53.0).sin() + 1.0).sin();
    let fine = ((x + 0.7 * y) * 671.0 + (y * 490.0).sin()).sin();
    let fraction = (0.5 + 0.20 * wave + 0.12 * fine).clamp(0.0, 1.0);
    std::array::from_fn(|i| TISSUE_DARK[i] + fraction * (TISSUE_PALE[i] - TISSUE_DARK[i]))
}
