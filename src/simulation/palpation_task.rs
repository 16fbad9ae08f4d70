//! The task of a hand that looks for lumps: it strokes over the tissue in lanes at an even depth, records the force of
//! its handle, and then presses and marks where the force was above its surroundings.
//!
//! It has no other information about the lumps than their higher stiffness; the force it feels has passed sensor, link,
//! rendering and gates. Memory is allocated at the beginning, and every step is short: each judges one cell of the map.

use nalgebra::Vector3;
use nima_machine::rig::TaskAction;

use crate::{
    hand_task::{HandMove, HandTaskPart},
    scene::{Scene, SceneHand},
};

/// Distance between lanes, and length of a cell of the map, m.
const LANE_M: f64 = 0.004;
const CELL_M: f64 = 0.002;
/// Minimum distance of a lane from the tissue's edge, m.
const EDGE_M: f64 = 0.010;
/// Mean speed of the strokes, m/s, and time to move to the next lane, s.
const STROKES_M_S: f64 = 0.025;
const SHIFTS_S: f64 = 0.4;
/// Height at which the hand moves between positions, m.
const CARRY_M: f64 = 0.015;
/// Minimum and maximum distance of the cells that count as surroundings, m: not above the same lump.
const AROUND_M: [f64; 2] = [0.008, 0.015];
/// Minimum force above a lump as a multiple of the surrounding force.
const MORE: f64 = 1.12;
/// Cells within this distance of the maximum count as the same lump, m, when its middle is computed and when the next
/// lump is searched for.
const SAME_M: f64 = 0.006;
const NEXT_M: f64 = 0.010;
/// Maximum number of marks.
const MARKS_MAX: u32 = 16;
/// Maximum number of cells, and of cells around one.
const CELLS_MAX: usize = 8192;
const AROUND_MAX: usize = 256;
/// Rest after the task, s.
const DONE_S: f64 = 1e6;

/// The map of felt forces, and the progress of the hand's task.
#[derive(Clone, Debug)]
pub(super) struct PalpationTask {
    /// Lanes, and cells of each.
    size: [usize; 2],
    /// The middle of the first cell of the first lane, m.
    first_m: [f64; 2],
    /// Sum of the forces felt in each cell, N, and their number.
    felt_n: Vec<(f64, u32)>,
    /// Force in each cell as a multiple of the surrounding force.
    more: Vec<f64>,
    /// Surrounding cells as offsets (lanes, cells).
    around: Vec<[isize; 2]>,
    scratch: Vec<f64>,
    /// The next cell to be judged.
    judged: usize,
    marked: u32,
    /// Indices of parts of the task: the first part after the map is made, the first part of a visit, and the last
    /// part.
    stroked: usize,
    visit: usize,
    height_m: f64,
    depth_m: f64,
    hand: SceneHand,
}

/// Parts of a visit: approach, press, hold and mark, lift.
const VISIT: usize = 4;

impl PalpationTask {
    /// Returns the task of the hand in this scene, with the state of its search; `None` without tissue.
    pub(super) fn of(scene: &Scene) -> Option<(Box<Self>, Vec<HandTaskPart>)> {
        let tissue = scene.tissue?;
        let half_m = tissue.size_m.map(|size_m| (0.5 * size_m - EDGE_M).max(CELL_M));
        let [mut cells, mut lanes] = [half_m[0] / CELL_M, half_m[1] / LANE_M].map(|half| 2 * half.floor() as usize + 1);
        // If the tissue is very large, search only its middle.
        lanes = lanes.min(CELLS_MAX / 64);
        cells = cells.min(CELLS_MAX / lanes);
        let size = [lanes, cells];
        let first_m = [(lanes - 1) as f64 * -0.5 * LANE_M, (cells - 1) as f64 * -0.5 * CELL_M];
        let mut search = Box::new(Self {
            size,
            first_m,
            felt_n: vec![(0.0, 0); lanes * cells],
            more: vec![1.0; lanes * cells],
            around: around(),
            scratch: Vec::with_capacity(AROUND_MAX),
            judged: 0,
            marked: 0,
            stroked: 0,
            visit: 0,
            height_m: tissue.surface_z_m + CARRY_M,
            depth_m: tissue.surface_z_m - scene.hand.press_depth_m,
            hand: scene.hand,
        });
        let parts = search.parts();
        Some((search, parts))
    }

    /// Returns the middle of a cell, m, at the depth of the strokes.
    fn place_m(&self, [lane, cell]: [usize; 2]) -> Vector3<f64> {
        let [y_m, x_m] = self.first_m;
        Vector3::new(x_m + cell as f64 * CELL_M, y_m + lane as f64 * LANE_M, self.depth_m)
    }

    fn above(&self, position_m: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(position_m.x, position_m.y, self.height_m)
    }

    fn parts(&mut self) -> Vec<HandTaskPart> {
        let SceneHand { press_s, hold_s, .. } = self.hand;
        let [lanes, cells] = self.size;
        let begin_m = self.place_m([0, 0]);
        let mut position_m = self.above(&begin_m);
        let mut parts = Vec::with_capacity(2 * lanes + 8);
        let mut go = |to_m: Vector3<f64>, seconds: f64| {
            parts.push(part(position_m, to_m, seconds, None));
            position_m = to_m;
        };
        go(self.above(&begin_m), hold_s);
        go(begin_m, press_s);
        let stroke_s = (cells - 1) as f64 * CELL_M / STROKES_M_S;
        let mut end_m = begin_m;
        for lane in 0..lanes {
            let ends = if lane % 2 == 0 { [0, cells - 1] } else { [cells - 1, 0] };
            if lane > 0 {
                go(self.place_m([lane, ends[0]]), SHIFTS_S);
            }
            end_m = self.place_m([lane, ends[1]]);
            go(end_m, stroke_s);
        }
        let up_m = self.above(&end_m);
        go(up_m, press_s);
        // The hand waits while the map is evaluated, one cell per step of any length.
        go(up_m, 1.0 + 1e-3 * (lanes * cells) as f64);
        self.stroked = parts.len() - 2;
        self.visit = parts.len();
        for _ in 0..VISIT {
            parts.push(part(up_m, up_m, 0.0, None));
        }
        parts.push(part(up_m, up_m, hold_s, Some(TaskAction::End)));
        parts.push(part(up_m, up_m, DONE_S, None));
        parts
    }

    /// Records the force (N) that the hand feels here in this part of its task; call it once per step.
    pub(super) fn feel(&mut self, part: usize, position_m: &Vector3<f64>, force_n: &Vector3<f64>) {
        if part >= self.stroked {
            // Evaluate while waiting, and afterwards if the waiting was too short.
            self.judge();
            return;
        }
        let [y_m, x_m] = self.first_m;
        let [lane, cell] = [(position_m.y - y_m) / LANE_M, (position_m.x - x_m) / CELL_M].map(f64::round);
        let is_inside = lane >= 0.0 && cell >= 0.0 && (lane as usize) < self.size[0] && (cell as usize) < self.size[1];
        // On the way down and between lanes, the force has other causes.
        let is_stroking =
            (position_m.y - y_m - lane * LANE_M).abs() < 0.25 * LANE_M && position_m.z < self.depth_m + 0.5 * CARRY_M;
        if part > 1 && is_inside && is_stroking && force_n.z.is_finite() {
            let felt = &mut self.felt_n[lane as usize * self.size[1] + cell as usize];
            *felt = (felt.0 + force_n.z, felt.1 + 1);
        }
    }

    fn mean_n(&self, at: usize) -> Option<f64> {
        self.felt_n.get(at).filter(|(_, count)| *count > 0).map(|(sum_n, count)| sum_n / f64::from(*count))
    }

    /// Compares the next cell with the median of its surroundings.
    fn judge(&mut self) {
        let at = self.judged;
        if at >= self.felt_n.len() {
            return;
        }
        self.judged += 1;
        let Some(here_n) = self.mean_n(at) else { return };
        let [lane, cell] = [at / self.size[1], at % self.size[1]];
        self.scratch.clear();
        for step in &self.around {
            let to = [lane.checked_add_signed(step[0]), cell.checked_add_signed(step[1])];
            let [Some(lane), Some(cell)] = to else { continue };
            let is_inside = lane < self.size[0] && cell < self.size[1] && self.scratch.len() < AROUND_MAX;
            let there_n = self.mean_n(lane * self.size[1] + cell).filter(|_| is_inside);
            self.scratch.extend(there_n);
        }
        self.scratch.sort_unstable_by(f64::total_cmp);
        if let Some(middle_n) = self.scratch.get(self.scratch.len() / 2).filter(|middle_n| **middle_n > 0.05) {
            self.more[at] = here_n / middle_n;
        }
    }

    /// Returns the next part, after rewriting the parts of a visit for the next position; the last two parts if there
    /// is none.
    pub(super) fn onward(&mut self, next: usize, task: &mut [HandTaskPart]) -> usize {
        if next != self.visit && next != self.visit + VISIT {
            return next;
        }
        let place_m = self.next_place_m().filter(|_| self.marked < MARKS_MAX);
        let Some(parts) = task.get_mut(self.visit..self.visit + VISIT) else { return next };
        let from_m = match parts.last() {
            Some(last) => last.way.to_m,
            None => return next,
        };
        let Some(to_m) = place_m else { return self.visit + VISIT };
        self.marked += 1;
        let SceneHand { reach_s, press_s, hold_s, .. } = self.hand;
        let above_m = self.above(&to_m);
        parts[0] = part(from_m, above_m, reach_s, None);
        parts[1] = part(above_m, to_m, press_s, None);
        parts[2] = part(to_m, to_m, hold_s, Some(TaskAction::Mark));
        parts[3] = part(to_m, above_m, press_s, None);
        self.visit
    }

    /// Returns the middle of the strongest lump that has not been visited, and removes it from the map.
    fn next_place_m(&mut self) -> Option<Vector3<f64>> {
        let max = |best: Option<usize>, at: usize| match best {
            Some(best) if self.more[best] >= self.more[at] => Some(best),
            _ => Some(at),
        };
        let peak = (0..self.more.len()).fold(None, max).filter(|at| self.more[*at] > MORE)?;
        let of = |search: &Self, at: usize| search.place_m([at / search.size[1], at % search.size[1]]);
        let peak_m = of(self, peak);
        let mut sum_m = Vector3::zeros();
        let mut weight = 0.0;
        for at in 0..self.more.len() {
            let apart_m = (of(self, at) - peak_m).norm();
            let surplus = (self.more[at] - 1.0).max(0.0);
            if apart_m <= SAME_M {
                sum_m += of(self, at) * surplus;
                weight += surplus;
            }
            if apart_m <= NEXT_M {
                self.more[at] = 1.0;
            }
        }
        (weight > 0.0).then(|| sum_m / weight)
    }
}

fn part(from_m: Vector3<f64>, to_m: Vector3<f64>, seconds: f64, then: Option<TaskAction>) -> HandTaskPart {
    HandTaskPart { way: HandMove { from_m, to_m, seconds }, grip_rad: [0.0; 2], then }
}

/// Returns the offsets of the cells around one cell.
fn around() -> Vec<[isize; 2]> {
    let [min_m, max_m] = AROUND_M;
    let [lanes, cells] = [max_m / LANE_M, max_m / CELL_M].map(|max| max.ceil() as isize);
    let all = (-lanes..=lanes).flat_map(|lane| (-cells..=cells).map(move |cell| [lane, cell]));
    let apart_m = |step: &[isize; 2]| (step[0] as f64 * LANE_M).hypot(step[1] as f64 * CELL_M);
    all.filter(|step| (min_m..=max_m).contains(&apart_m(step))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strokes over tissue that is stiffer at a position by this factor, and returns where the hand then marks.
    fn marks(more: impl Fn(&Vector3<f64>) -> f64) -> Vec<Vector3<f64>> {
        let scene = Scene::load("find_lumps").unwrap();
        let (mut search, mut task) = PalpationTask::of(&scene).unwrap();
        let mut current = 0;
        let mut marks = Vec::new();
        while current + 1 < task.len() {
            let HandTaskPart { way, then, .. } = task[current];
            let ticks = (way.seconds * 1e3).ceil() as u32;
            for tick in 0..ticks {
                let (position_m, _) = way.at(f64::from(tick) * 1e-3);
                let depth_m = (-position_m.z).max(0.0);
                search.feel(current, &position_m, &(Vector3::z() * (200.0 * depth_m * more(&position_m))));
            }
            if then == Some(TaskAction::Mark) {
                marks.push(way.to_m);
            }
            current = search.onward(current + 1, &mut task);
        }
        marks
    }

    #[test]
    fn it_marks_each_place_that_is_stiffer_than_around_and_no_other() {
        let lumps_m = [[-0.03, 0.02], [0.01, -0.015], [0.041, 0.027], [-0.045, -0.03]];
        let more = |position_m: &Vector3<f64>| {
            // The stiffness of the whole tissue increases to the right.
            let even = 1.0 + 2.0 * position_m.x;
            let over = lumps_m.iter().any(|[x, y]| (position_m.x - x).hypot(position_m.y - y) < 0.005);
            even * if over { 1.3 } else { 1.0 }
        };
        let marks_m = marks(more);
        assert_eq!(marks_m.len(), lumps_m.len(), "{marks_m:?}");
        for [x, y] in lumps_m {
            let near = marks_m.iter().filter(|position_m| (position_m.x - x).hypot(position_m.y - y) < 0.003).count();
            assert_eq!(near, 1, "{x} {y}: {marks_m:?}");
        }
    }

    #[test]
    fn even_tissue_gets_no_mark() {
        assert!(marks(|_| 1.0).is_empty());
        assert!(marks(|position_m| 1.0 + 3.0 * position_m.y).is_empty());
    }
}
