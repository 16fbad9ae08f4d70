//! The arrows of the forces, which never cover the tip.

use nalgebra::Vector3;

use super::{
    mesh::{Material, Mesh, Paint},
    stage::ARROW_M_PER_N,
};
use crate::theme;

/// A smaller force is drawn without an arrow, because that would show noise, N.
const ARROW_MIN_N: f32 = 0.06;
/// Force at which an arrow reaches its maximum length, N.
const ARROW_MAX_N: f32 = 8.0;
/// Returns the size and direction of an arrow; `None` for a force too small to be shown, or not finite.
fn size_and_direction(force_n: &Vector3<f32>) -> Option<(f32, Vector3<f32>)> {
    let size_n = force_n.norm();
    // A force far above the force limit would otherwise fill the view.
    (size_n.is_finite() && size_n >= ARROW_MIN_N).then(|| (size_n.min(ARROW_MAX_N), force_n / size_n))
}

/// Returns whether the force is large enough for an arrow.
pub(super) fn has_arrow(force_n: &Vector3<f32>) -> bool {
    size_and_direction(force_n).is_some()
}

/// Lengths of the heads of long arrows, and their radius; a short arrow is thinner in the same proportion, or it would be a disc.
const MEASURED_HEAD_M: f32 = 0.007;
const RENDERED_HEAD_M: f32 = 0.009;
const HEAD_RADIUS_M: f32 = 0.0023;

/// Radius around the tip that no arrow covers, m.
const CLEAR_M: f32 = 0.0035;

/// A tip that must stay visible from this eye.
#[derive(Clone, Copy)]
pub(super) struct ClearTip<'a> {
    pub(super) tip_m: &'a Vector3<f32>,
    pub(super) eye_m: &'a Vector3<f32>,
}

impl ClearTip<'_> {
    /// Returns whether this part of an arrow would cover the tip.
    fn is_covered(&self, [from_m, to_m]: [Vector3<f32>; 2]) -> bool {
        let Some(sight) = (self.tip_m - self.eye_m).try_normalize(1e-6) else { return false };
        let flat = |point_m: Vector3<f32>| {
            let offset_m = point_m - self.tip_m;
            offset_m - sight * sight.dot(&offset_m)
        };
        let [from_m, to_m] = [from_m, to_m].map(flat);
        let way_m = to_m - from_m;
        let nearest = (-from_m.dot(&way_m) / way_m.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        (from_m + way_m * nearest).norm() < CLEAR_M
    }

    /// Adds a part of an arrow, unless it would cover the tip.
    fn part(&self, mesh: &mut Mesh, ends_m: [Vector3<f32>; 2], radii_m: [f32; 2], sides: u32, paint: Paint) {
        if !self.is_covered(ends_m) {
            mesh.tube(ends_m, radii_m, sides, paint);
        }
    }
}

/// Adds a plain shaft with one cone. The shaft is drawn in pieces, so that only those over the tip are left out.
pub(super) fn measured_arrow(mesh: &mut Mesh, base: Vector3<f32>, force_n: &Vector3<f32>, clear: ClearTip<'_>) {
    // Shorter pieces would leave out less of the shaft in front of the tip, but need more triangles.
    const PIECE_M: f32 = 0.004;
    let paint = Paint(theme::DARK.measured, Material::Plain);
    let Some((size_n, along)) = size_and_direction(force_n) else { return };
    let length = size_n * ARROW_M_PER_N;
    let head = MEASURED_HEAD_M.min(length * 0.6);
    let thin = head / MEASURED_HEAD_M;
    let shaft = length - head;
    let pieces = (shaft / PIECE_M).ceil().max(1.0) as u32;
    for piece in 0..pieces {
        let ends = [piece, piece + 1].map(|end| base + along * (end as f32 * shaft / pieces as f32));
        clear.part(mesh, ends, [0.0008 * thin; 2], 14, paint);
    }
    clear.part(mesh, [base + along * shaft, base + along * length], [HEAD_RADIUS_M * thin, 0.0], 18, paint);
}

/// Draws a beaded shaft with a double cone: the shape alone distinguishes it from the other arrow.
pub(super) fn rendered_arrow(mesh: &mut Mesh, base: Vector3<f32>, force_n: &Vector3<f32>, clear: ClearTip<'_>) {
    // About three beads for each newton.
    const BEAD_M: f32 = 0.0055;
    let paint = Paint(theme::DARK.rendered, Material::Plain);
    let Some((size_n, along)) = size_and_direction(force_n) else { return };
    let length = size_n * ARROW_M_PER_N;
    let head = RENDERED_HEAD_M.min(length * 0.6);
    let thin = head / RENDERED_HEAD_M;
    let shaft = length - head;
    let beads = (shaft / BEAD_M).ceil().max(1.0) as u32;
    for bead in 0..beads {
        let from = bead as f32 * shaft / beads as f32;
        let to = from + 0.62 * shaft / beads as f32;
        clear.part(mesh, [base + along * from, base + along * to], [0.0011 * thin; 2], 14, paint);
    }
    for half in [0.0, 0.45] {
        let from = shaft + head * half;
        let ends = [base + along * from, base + along * (from + head * 0.55)];
        clear.part(mesh, ends, [HEAD_RADIUS_M * thin, 0.0], 18, paint);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EYE_M: Vector3<f32> = Vector3::new(0.0, -0.3, 0.2);
    const RIGHT: Vector3<f32> = Vector3::new(1.0, 0.0, 0.0);

    #[test]
    fn the_head_of_a_short_arrow_is_no_disc() {
        let far = Vector3::new(1.0, 1.0, 0.0);
        let clear = ClearTip { tip_m: &far, eye_m: &EYE_M };
        let width_m = |force_n: f32| {
            let mut mesh = Mesh::default();
            rendered_arrow(&mut mesh, Vector3::zeros(), &(Vector3::z() * force_n), clear);
            let across = mesh.vertices.iter().map(|vertex| vertex.position[0].abs()).fold(0.0, f32::max);
            (across, mesh.vertices.iter().map(|vertex| vertex.position[2]).fold(0.0, f32::max))
        };
        let (across_m, length_m) = width_m(4.0);
        assert!(across_m < 0.2 * length_m);
        let (across_m, length_m) = width_m(0.1);
        assert!(across_m < 0.3 * length_m, "{across_m} {length_m}");
    }

    #[test]
    fn no_arrow_covers_the_tip() {
        let tip_m = Vector3::new(0.0, 0.018, 0.01);
        let clear = ClearTip { tip_m: &tip_m, eye_m: &EYE_M };
        let base_m = tip_m + RIGHT * 0.006 + Vector3::z() * 0.002;
        let vertices = |along: Vector3<f32>| {
            let mut mesh = Mesh::default();
            measured_arrow(&mut mesh, base_m, &(along * 3.0), clear);
            rendered_arrow(&mut mesh, base_m, &(along * 3.0), clear);
            mesh.vertices.len()
        };
        assert!(vertices(-RIGHT) < vertices(RIGHT), "the parts over the tip are left out");
        let seen = |point_m: Vector3<f32>| clear.is_covered([point_m, point_m]);
        assert!(seen(tip_m + (EYE_M - tip_m) * 0.1) && !seen(base_m + RIGHT * 0.01));
    }
}
