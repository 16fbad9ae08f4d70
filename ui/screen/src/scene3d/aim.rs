//! Marks the instruments during mouse control: a pale circle around the tip of the other instrument; a green circle around
//! the tip of the driven one, with a line straight down to the surface below, because a flat image does not show the place
//! under the tip. Under a ring in the jaws, the outline of its hole: a peg inside it goes through.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke};
use nalgebra::Vector3;
use nima_simulation::scene::Scene;

use super::{SceneCamera, training};

/// Colour of the mark, used for nothing else in the view.
const LED: Color32 = Color32::from_rgb(0x9c, 0xe8, 0x7a);
const DOWN: Color32 = Color32::from_rgb(0x7d, 0xb0, 0x68);
/// The circle around the tip of the other instrument.
const RESTS: Color32 = Color32::from_rgb(0xd6, 0xde, 0xe6);
/// Radius of the circle around the tip, points; with a second circle while the jaws hold a ring.
pub(super) const CIRCLE: f32 = 11.0;
const SECOND: f32 = 16.0;
/// Radius of the mark below, m.
const FOOT_M: f32 = 0.001;
const CORNERS: u32 = 36;

pub(super) struct SceneAim<'a> {
    pub(super) scene: &'a Scene,
    pub(super) tip_m: Vector3<f32>,
    /// Centre of the ring in the jaws.
    pub(super) ring_m: Option<Vector3<f32>>,
}

/// Marks the tip of the other instrument, which stays where it was left.
pub(super) fn paint_other(painter: &Painter, rect: Rect, camera: &SceneCamera, tip_m: &Vector3<f32>) {
    if let Some(tip) = camera.project(tip_m, rect) {
        painter.circle_stroke(tip, CIRCLE, Stroke::new(1.5, RESTS));
    }
}

/// Returns the height of the surface below the instruments, m.
fn ground_m(scene: &Scene) -> Option<f32> {
    let tissue_m = scene.tissue.map(|tissue| tissue.surface_z_m as f32);
    training::board_of(scene).map(|board| board.z_m as f32).or(tissue_m)
}

impl SceneAim<'_> {
    pub(super) fn paint(&self, painter: &Painter, rect: Rect, camera: &SceneCamera) {
        if let Some((from, foot, outline)) = self.below(rect, camera) {
            painter.add(Shape::Vec(Shape::dashed_line(&[from, foot], Stroke::new(2.0, DOWN), 6.0, 4.0)));
            painter.add(Shape::closed_line(outline, Stroke::new(2.0, DOWN)));
        }
        let Some(tip) = camera.project(&self.tip_m, rect) else { return };
        painter.circle_stroke(tip, CIRCLE, Stroke::new(2.0, LED));
        if self.ring_m.is_some() {
            painter.circle_stroke(tip, SECOND, Stroke::new(2.0, LED));
        }
    }

    /// Returns the start and end of the line, and the shape at its end. `None` without a surface below.
    fn below(&self, rect: Rect, camera: &SceneCamera) -> Option<(Pos2, Pos2, Vec<Pos2>)> {
        let ground_m = ground_m(self.scene)?;
        let from_m = self.ring_m.unwrap_or(self.tip_m);
        let foot_m = Vector3::new(from_m.x, from_m.y, ground_m);
        let ring = self.scene.objects.as_ref().map(|setting| setting.ring).filter(|_| self.ring_m.is_some());
        let radius_m = ring.map_or(FOOT_M, |ring| (ring.major_radius_m - ring.tube_radius_m) as f32);
        let outline = (0..CORNERS).map(|i| {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / CORNERS as f32).sin_cos();
            camera.project(&(foot_m + Vector3::new(cos, sin, 0.0) * radius_m), rect)
        });
        let at = |point_m| camera.project(point_m, rect);
        (from_m.z > ground_m).then_some(())?;
        Some((at(&from_m)?, at(&foot_m)?, outline.collect::<Option<_>>()?))
    }
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn the_line_goes_straight_down_to_the_board_or_the_tissue_and_a_held_ring_shows_its_hole() {
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(800.0, 600.0));
        let tip_m = Vector3::new(0.02, 0.01, 0.03);
        for (name, has_ground) in [("rings", true), ("wire", true), ("peg_transfer", true), ("free_motion", false)] {
            let scene = Scene::load(name).unwrap();
            let camera = SceneCamera::of(&scene);
            let below = |ring_m| SceneAim { scene: &scene, tip_m, ring_m }.below(rect, &camera);
            let width = |outline: &[Pos2]| {
                let x = |i: usize| outline[i].x;
                (0..outline.len()).map(x).fold(0.0, f32::max) - (0..outline.len()).map(x).fold(1e6, f32::min)
            };
            assert_eq!(below(None).is_some(), has_ground, "{name}");
            if let Some((from, foot, outline)) = below(None) {
                let ground_m = ground_m(&scene).unwrap();
                let wanted = camera.project(&Vector3::new(tip_m.x, tip_m.y, ground_m), rect).unwrap();
                assert!((foot - wanted).length() < 0.1 && foot.y > from.y + 20.0, "{name}: {from:?} {foot:?}");
                assert!(width(&outline) < 12.0);
            }
            if scene.objects.is_some() {
                let (.., outline) = below(Some(tip_m)).unwrap();
                assert!(width(&outline) > 20.0, "11 mm");
            }
        }
    }
}
