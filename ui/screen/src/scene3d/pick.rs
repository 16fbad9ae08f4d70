//! Hover texts of the 3-D view: the object under the pointer, with numbers, units and frame.

use egui::{Pos2, Rect};
use nalgebra::Vector3;
use nima_simulation::scene::Scene;
use nima_words::{report_text::side_word, text};

use super::{
    SceneCamera, arrows,
    stage::{self, StageArm},
};

/// Distance from the pointer within which an object is hit, points.
const REACH: f32 = 12.0;

/// Returns the text of the frontmost object under the pointer; `None` if there is none.
pub(super) fn pick(
    pointer: Pos2,
    rect: Rect,
    camera: &SceneCamera,
    scene: &Scene,
    arms: &[StageArm],
) -> Option<String> {
    arms.iter().find_map(|arm| of_arm(pointer, rect, camera, scene, arm, arms.len() > 1)).or_else(|| {
        let place_m = on_tissue(pointer, rect, camera, scene)?;
        Some(text::field::tissue(&place(&place_m)))
    })
}

fn of_arm(
    pointer: Pos2,
    rect: Rect,
    camera: &SceneCamera,
    scene: &Scene,
    arm: &StageArm,
    both: bool,
) -> Option<String> {
    let at = |point_m: &Vector3<f32>| camera.project(point_m, rect);
    let near = |point_m: &Vector3<f32>| at(point_m).is_some_and(|at| at.distance(pointer) < REACH);
    let StageArm { side, trocar_m, pose, targets_m, .. } = arm;
    let whose = if both { text::field::of_hand(side_word(*side)) } else { String::new() };
    let [measured, rendered] = stage::arrow_bases_m(pose, trocar_m, &camera.right());
    for (name, base_m, force_n) in [
        (text::field::ARROW_MEASURED.get(), measured, pose.measured_n),
        (text::field::ARROW_RENDERED.get(), rendered, Some(pose.rendered_n)),
    ] {
        let Some(force_n) = force_n else { continue };
        let ends = [at(&base_m), at(&(base_m + force_n * stage::ARROW_M_PER_N))];
        if let ([Some(from), Some(to)], true) = (ends, arrows::has_arrow(&force_n))
            && distance(pointer, from, to) < 0.6 * REACH
        {
            return Some(text::field::arrow(name, &whose, force_n.norm(), force_n.into()));
        }
    }
    if near(&pose.tip_m) {
        let depth_mm = scene.tissue.map_or(0.0, |tissue| (tissue.surface_z_m as f32 - pose.tip_m.z) * 1e3);
        let deep = if depth_mm > 0.0 { text::field::depth(depth_mm) } else { String::new() };
        return Some(text::field::tip(&whose, &place(&pose.tip_m), &deep));
    }
    if let Some(number) = targets_m.iter().position(near) {
        return Some(text::field::target(number + 1, &whose, &place(&targets_m[number])));
    }
    near(trocar_m).then(|| text::field::trocar(&whose, &place(trocar_m)))
}

/// Returns a position in millimetres in the base frame.
fn place(position_m: &Vector3<f32>) -> String {
    text::field::place((position_m * 1e3).into())
}

/// Returns the distance from a point to a line segment, points.
fn distance(point: Pos2, from: Pos2, to: Pos2) -> f32 {
    let way = to - from;
    let along = if way.length_sq() > 1e-6 { ((point - from).dot(way) / way.length_sq()).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(from + way * along)
}

/// Returns the intersection of the ray through the pointer with the tissue's surface at rest, m.
fn on_tissue(pointer: Pos2, rect: Rect, camera: &SceneCamera, scene: &Scene) -> Option<Vector3<f32>> {
    let tissue = scene.tissue?;
    let place_m = camera.on_level(pointer, rect, tissue.surface_z_m as f32)?;
    let [half_x, half_y] = tissue.size_m.map(|size_m| 0.5 * size_m as f32);
    (place_m.x.abs() <= half_x && place_m.y.abs() <= half_y).then_some(place_m)
}

#[cfg(test)]
mod tests {
    use egui::pos2;
    use nima_machine::rig::Side;

    use super::*;

    fn view() -> Rect {
        Rect::from_min_max(pos2(100.0, 50.0), pos2(1000.0, 650.0))
    }

    fn arm() -> StageArm {
        let pose = stage::StagePose {
            tip_m: Vector3::new(0.01, 0.018, -0.004),
            measured_n: Some(Vector3::new(0.5, 0.0, 2.0)),
            rendered_n: Vector3::zeros(),
        };
        let targets_m = vec![Vector3::new(-0.03, 0.02, 0.0)];
        StageArm {
            side: Side::Right,
            trocar_m: Vector3::new(0.0, -0.06, 0.14),
            targets_m,
            pose,
            trail_m: vec![],
            links_m: vec![],
        }
    }

    fn at(point_m: &Vector3<f32>) -> Option<String> {
        let scene = Scene::load("peg_transfer").unwrap();
        let camera = SceneCamera::of(&scene);
        pick(camera.project(point_m, view()).unwrap(), view(), &camera, &scene, &[arm()])
    }

    #[test]
    fn everything_on_the_stage_tells_its_name_and_its_numbers_where_it_is() {
        let arm = arm();
        let tip = at(&arm.pose.tip_m).unwrap();
        assert!(tip.contains("x 10.0, y 18.0, z -4.0 mm (world)") && tip.contains("4.0 mm below"), "{tip}");
        assert!(at(&arm.targets_m[0]).unwrap().starts_with("Target 1"));
        let scene = Scene::load("peg_transfer").unwrap();
        let [base_m, _] = stage::arrow_bases_m(&arm.pose, &arm.trocar_m, &SceneCamera::of(&scene).right());
        let force = at(&(base_m + arm.pose.measured_n.unwrap() * 0.5 * stage::ARROW_M_PER_N)).unwrap();
        assert!(force.contains("2.06 N") && force.contains("x +0.50"), "{force}");
        assert!(at(&arm.trocar_m).unwrap().contains("remote centre"));
    }

    #[test]
    fn the_tissue_is_found_where_it_is_pointed_at_and_nothing_beside_it() {
        let place_m = Vector3::new(0.02, -0.03, 0.0);
        assert_eq!(at(&place_m).unwrap(), "Tissue at x 20.0, y -30.0, z 0.0 mm (world)");
        assert_eq!(at(&Vector3::new(0.3, 0.0, 0.0)), None);
    }
}
