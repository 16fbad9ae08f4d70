//! Working space of a person who records data for the tip force: that of the later task.

use crate::scene::Scene;

/// The tip moves this far beyond the task's targets on every side, m: more than a drag, an overshoot, or the distance
/// from the pose in which the arm was left.
const MARGIN_M: f64 = 0.015;
/// The person presses deeper than the task intends by this factor, because a hand overshoots.
const DEEPER: f64 = 1.2;
/// Minimum depth of a press, m.
const PRESS_MIN_M: f64 = 0.002;

/// Working space of the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Workspace {
    /// Limits in x and y, m.
    pub across_m: [[f64; 2]; 2],
    /// Range of the depth to which the tip presses below the tissue's surface, m.
    pub press_m: [f64; 2],
}

impl Workspace {
    /// Creates the space of the scene's task: the box around its targets, limited to the tissue.
    pub(super) fn of(scene: &Scene) -> Self {
        let across_m = [0, 1].map(|axis| {
            let at = scene.targets_m.iter().map(|target_m| target_m[axis]);
            let edge_m = scene.tissue.map_or(f64::INFINITY, |tissue| 0.5 * tissue.size_m[axis]);
            let low_m = at.clone().fold(f64::INFINITY, f64::min) - MARGIN_M;
            let high_m = at.fold(f64::NEG_INFINITY, f64::max) + MARGIN_M;
            [low_m.max(-edge_m), high_m.min(edge_m)]
        });
        let surface_z_m = scene.tissue.map_or(0.0, |tissue| tissue.surface_z_m);
        let lowest_m = scene.targets_m.iter().map(|target_m| target_m.z).fold(f64::INFINITY, f64::min);
        let deepest_m = DEEPER * scene.hand.press_depth_m - (lowest_m - surface_z_m);
        Self { across_m, press_m: [PRESS_MIN_M, deepest_m.max(PRESS_MIN_M)] }
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::rig::Side;

    use super::*;

    #[test]
    fn he_works_where_the_pegs_of_his_side_are() {
        let scene = Scene::load("bimanual").unwrap();
        for side in Side::ALL {
            let scene = scene.of_side(side).unwrap();
            let at = Workspace::of(&scene);
            for target_m in &scene.targets_m {
                for axis in [0, 1] {
                    let [low_m, high_m] = at.across_m[axis];
                    let drag_m = scene.hand.drag_m;
                    let inside = low_m + drag_m..=high_m - drag_m;
                    assert!(inside.contains(&target_m[axis]), "{side:?}: {target_m} is outside of {at:?}");
                }
            }
            let [_, deepest_m] = at.press_m;
            assert!(deepest_m > scene.hand.press_depth_m, "the task presses to {} m", scene.hand.press_depth_m);
        }
    }
}
