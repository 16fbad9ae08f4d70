//! Shadows on a board: objects between the board and the lamp, projected along the light. A few triangles each, because a
//! software renderer could not trace rays for every pixel of a board. On tissue, the shader computes the shadows of the
//! shafts.

use egui::Color32;
use nalgebra::{UnitQuaternion, Vector3};

use super::{
    mesh::{Mesh, Paint},
    objects::BOARD,
};

/// Direction to the lamp, as in the shader.
const LAMP: Vector3<f32> = Vector3::new(-0.42, 0.30, 0.857);
/// Increase of a shadow's half width, and decrease of its core's, per height above the board.
const BLUR: f32 = 0.035;
/// Minimum width of the core, as a fraction of the object's width.
const CORE_MIN: f32 = 0.35;
/// Height of the edges of shadows and of their cores above the board, m: the core is above all edges.
const LIFT_M: [f32; 2] = [4e-5, 8e-5];
/// Brightness of edge and core.
const SHADE: [f32; 2] = [0.80, 0.56];
/// Number of points around a ring, and along a rod.
const AROUND: u32 = 28;
const ALONG: u32 = 16;
/// Corners of a round end.
const CAP: u32 = 12;

/// Shadows on one board, collected while objects are drawn.
#[derive(Debug)]
pub(super) struct Shadows {
    board: Option<nima_simulation::physics::BoardSettings>,
    edges: Mesh,
    cores: Mesh,
}

impl Shadows {
    /// Returns the shadows on a board; none without a board.
    pub(super) fn on(board: Option<&nima_simulation::physics::BoardSettings>) -> Self {
        Self { board: board.copied(), edges: Mesh::default(), cores: Mesh::default() }
    }

    /// Adds a tube along points.
    pub(super) fn line(&mut self, points_m: impl IntoIterator<Item = Vector3<f32>>, radius_m: f32) {
        let Some(board) = self.board else { return };
        let fallen: Vec<(Vector3<f32>, f32)> =
            points_m.into_iter().filter_map(|point_m| fallen(&point_m, board.z_m as f32)).collect();
        let half_m = board.size_m.map(|size_m| 0.5 * size_m as f32);
        for (layer, mesh) in [&mut self.edges, &mut self.cores].into_iter().enumerate() {
            let paint = Paint(shaded(BOARD.0, SHADE[layer]), BOARD.1);
            let width_m = |height_m: f32| match layer {
                0 => radius_m + BLUR * height_m,
                _ => (radius_m - BLUR * height_m).max(CORE_MIN * radius_m),
            };
            band(mesh, &fallen, half_m, LIFT_M[layer], width_m, paint);
        }
    }

    /// Adds a straight rod.
    pub(super) fn rod(&mut self, from_m: &Vector3<f32>, to_m: &Vector3<f32>, radius_m: f32) {
        let travel_m = to_m - from_m;
        self.line((0..=ALONG).map(|step| from_m + travel_m * (step as f32 / ALONG as f32)), radius_m);
    }

    /// Adds a ring about its own z axis, rotated.
    pub(super) fn circle(&mut self, centre_m: &Vector3<f32>, turn: &UnitQuaternion<f32>, [major_m, tube_m]: [f32; 2]) {
        let place = |step: u32| {
            let (sin, cos) = (std::f32::consts::TAU * step as f32 / AROUND as f32).sin_cos();
            centre_m + turn * Vector3::new(cos * major_m, sin * major_m, 0.0)
        };
        self.line((0..=AROUND).map(place), tube_m);
    }

    /// Draws them on the board.
    pub(super) fn lay(self, mesh: &mut Mesh) {
        for part in [self.cores, self.edges] {
            let first = mesh.vertices.len() as u32;
            mesh.vertices.extend(part.vertices);
            mesh.indices.extend(part.indices.into_iter().map(|index| first + index));
        }
    }
}

/// Returns the position of a point's shadow on a plane of this height, m, and height of the point above it.
fn fallen(point_m: &Vector3<f32>, plane_m: f32) -> Option<(Vector3<f32>, f32)> {
    let height_m = (point_m.z - plane_m).max(0.0);
    let position_m = point_m - LAMP * (height_m / LAMP.z);
    position_m.iter().all(|x| x.is_finite()).then_some((Vector3::new(position_m.x, position_m.y, plane_m), height_m))
}

fn shaded(colour: Color32, fraction: f32) -> Color32 {
    let [r, g, b, _] = colour.to_array().map(|part| (f32::from(part) * fraction).round() as u8);
    Color32::from_rgb(r, g, b)
}

/// Adds a flat band along points, with the width that `width_m` gives for each height, cut off at the edges of the
/// board.
fn band(
    mesh: &mut Mesh,
    points: &[(Vector3<f32>, f32)],
    half_m: [f32; 2],
    lift_m: f32,
    width_m: impl Fn(f32) -> f32,
    paint: Paint,
) {
    if points.len() < 2 {
        return;
    }
    let first = mesh.vertices.len() as u32;
    let mut across = Vector3::x();
    for (i, (point_m, height_m)) in points.iter().enumerate() {
        let travel_m = points[(i + 1).min(points.len() - 1)].0 - points[i.saturating_sub(1)].0;
        across = Vector3::z().cross(&travel_m).try_normalize(1e-7).unwrap_or(across);
        for side in [-1.0, 1.0] {
            let corner_m = point_m + across * (side * width_m(*height_m));
            let [x, y] = [corner_m.x.clamp(-half_m[0], half_m[0]), corner_m.y.clamp(-half_m[1], half_m[1])];
            mesh.vertex(Vector3::new(x, y, point_m.z + lift_m), Vector3::z(), paint);
        }
    }
    mesh.sheet(first, points.len() as u32 - 1, 1);
    for (point_m, height_m) in [points.first(), points.last()].into_iter().flatten() {
        cap(mesh, point_m, half_m, lift_m, width_m(*height_m), paint);
    }
}

/// Adds a flat disc, cut off at the edges of the board: the round end of a band.
fn cap(mesh: &mut Mesh, position_m: &Vector3<f32>, half_m: [f32; 2], lift_m: f32, radius_m: f32, paint: Paint) {
    let mut corner = |out: Vector3<f32>| {
        let corner_m = position_m + out * radius_m;
        let [x, y] = [corner_m.x.clamp(-half_m[0], half_m[0]), corner_m.y.clamp(-half_m[1], half_m[1])];
        mesh.vertex(Vector3::new(x, y, position_m.z + lift_m), Vector3::z(), paint)
    };
    let middle = corner(Vector3::zeros());
    for side in 0..=CAP {
        let (sin, cos) = (std::f32::consts::TAU * side as f32 / CAP as f32).sin_cos();
        corner(Vector3::new(cos, sin, 0.0));
    }
    mesh.indices.extend((1..=CAP).flat_map(|side| [middle, middle + side, middle + side + 1]));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laid(shadows: Shadows) -> Mesh {
        let mut mesh = Mesh::default();
        shadows.lay(&mut mesh);
        mesh
    }

    #[test]
    fn a_shadow_falls_away_from_the_lamp_and_never_beyond_the_board() {
        let board = nima_simulation::physics::BoardSettings { z_m: 0.01, size_m: [0.1, 0.1] };
        let mut shadows = Shadows::on(Some(&board));
        let foot_m = Vector3::new(0.0, 0.0, 0.01);
        shadows.rod(&foot_m, &(foot_m + Vector3::z() * 0.02), 0.001);
        let mesh = laid(shadows);
        let end = mesh.vertices.iter().map(|vertex| vertex.position[0]).fold(0.0, f32::max);
        // The lamp is at negative x; the edge of the shadow is wider than the rod.
        assert!((end - 0.02 * 0.42 / 0.857).abs() < 0.002, "{end}");
        assert!(mesh.vertices.iter().all(|vertex| (vertex.position[2] - 0.01 - 6e-5).abs() < 3e-5));
        let mut shadows = Shadows::on(Some(&board));
        shadows.rod(&foot_m, &Vector3::new(0.0, -3.0, 5.0), 0.001);
        shadows.circle(&Vector3::new(0.049, 0.0, 0.02), &UnitQuaternion::identity(), [0.007, 0.001]);
        let mesh = laid(shadows);
        assert!(!mesh.indices.is_empty() && mesh.indices.iter().all(|i| (*i as usize) < mesh.vertices.len()));
        assert!(mesh.vertices.iter().all(|vertex| vertex.position[..2].iter().all(|x| x.abs() <= 0.05)));
    }

    #[test]
    fn without_a_board_and_for_what_is_not_finite_there_is_none() {
        let mut shadows = Shadows::on(None);
        shadows.rod(&Vector3::zeros(), &Vector3::z(), 0.001);
        assert!(laid(shadows).vertices.is_empty());
        let mut shadows = Shadows::on(Some(&nima_simulation::physics::BoardSettings::default()));
        shadows.line([Vector3::repeat(f32::NAN), Vector3::repeat(f32::INFINITY)], 0.001);
        assert!(laid(shadows).vertices.is_empty());
    }
}
