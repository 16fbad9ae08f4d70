//! Palpation: positions on the tissue are marked, and each mark is on a lump or not.

use nalgebra::Vector3;
use nima_core::task::TaskEvent;
use nima_machine::rig::Side;

use crate::{
    object_feed::{MARKS_MAX, PlaceMark, Training},
    scene::{Lump, Scene},
};

/// The lumps, and the marks.
#[derive(Clone, Debug)]
pub(super) struct Palpation {
    lumps: Vec<Lump>,
    found: Vec<bool>,
    tolerance_m: f64,
    half_m: [f64; 2],
    surface_m: f64,
    marks: [Option<PlaceMark>; MARKS_MAX],
    marked: u32,
    ended: bool,
}

impl Palpation {
    /// Returns the palpation of this scene; `None` if its task is not to find lumps.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let tissue = scene.tissue?;
        let task = scene.task.as_ref()?;
        let lumps = scene.placed_lumps().filter(|_| scene.is_searched())?.list;
        Some(Self {
            found: vec![false; lumps.len()],
            lumps,
            tolerance_m: task.mark_tolerance_m,
            half_m: tissue.size_m.map(|size_m| 0.5 * size_m),
            surface_m: tissue.surface_z_m,
            marks: [None; MARKS_MAX],
            marked: 0,
            ended: false,
        })
    }

    /// Starts the trial again.
    pub(super) fn begin(&mut self) {
        self.found.fill(false);
        self.marks = [None; MARKS_MAX];
        self.marked = 0;
        self.ended = false;
    }

    /// Marks the position under a tip, if the tip is above the tissue. Finding the last lump ends the trial.
    pub(super) fn mark(&mut self, side: Side, tip_m: &Vector3<f64>, report: &mut dyn FnMut(f64, TaskEvent)) {
        if self.ended || tip_m.x.abs() > self.half_m[0] || tip_m.y.abs() > self.half_m[1] {
            return;
        }
        let lump = self.lump_at(tip_m);
        let mark = PlaceMark { position_m: Vector3::new(tip_m.x, tip_m.y, self.surface_m), is_true: lump.is_some() };
        if let Some(free) = self.marks.iter_mut().find(|mark| mark.is_none()) {
            *free = Some(mark);
        }
        self.marked = self.marked.saturating_add(1);
        report(0.0, TaskEvent::LumpMarked { side, lump });
        if let Some(found) = lump.and_then(|lump| self.found.get_mut(lump)) {
            *found = true;
        }
        if self.found.iter().all(|found| *found) {
            self.ended = true;
            report(0.0, TaskEvent::Ended);
        }
    }

    /// Ends the trial.
    pub(super) const fn end(&mut self) {
        self.ended = true;
    }

    /// Returns the nearest lump that this position hits, within the tolerance.
    fn lump_at(&self, position_m: &Vector3<f64>) -> Option<usize> {
        let apart_m =
            |lump: &Lump| (position_m.x - lump.position_m[0]).hypot(position_m.y - lump.position_m[1]) - lump.radius_m;
        let near = self.lumps.iter().enumerate().map(|(i, lump)| (i, apart_m(lump)));
        let nearest = near.min_by(|one, other| one.1.total_cmp(&other.1))?;
        (nearest.1 <= self.tolerance_m).then_some(nearest.0)
    }

    pub(super) fn training(&self) -> Training {
        let found = self.found.iter().filter(|found| **found).count() as u32;
        Training { marks: self.marks, marked: self.marked, found, ..Training::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(palpation: &mut Palpation, position_m: [f64; 3]) -> Vec<TaskEvent> {
        let mut events = Vec::new();
        palpation.mark(Side::Right, &Vector3::from(position_m), &mut |_, event| events.push(event));
        events
    }

    #[test]
    fn a_mark_is_true_within_the_radius_and_the_tolerance_and_every_lump_is_found_once() {
        let mut scene = Scene::load("find_lumps").unwrap();
        scene.lumps.iter_mut().for_each(|lumps| {
            lumps.drawn = None;
            lumps.list = [[-0.02, 0.0], [0.02, 0.01]]
                .map(|position_m| Lump { position_m, radius_m: 0.005, times_stiffer: 10.0 })
                .to_vec();
        });
        let mut palpation = Palpation::of(&scene).unwrap();
        let marked = |lump| vec![TaskEvent::LumpMarked { side: Side::Right, lump }];
        // Within the tolerance of 5 mm plus 3 mm, at any height.
        assert_eq!(report(&mut palpation, [-0.0121, 0.0, -0.004]), marked(Some(0)));
        assert_eq!(report(&mut palpation, [-0.0119, 0.0, 0.03]), marked(None));
        assert_eq!(report(&mut palpation, [-0.02, 0.0, 0.0]), marked(Some(0)), "again");
        assert_eq!(report(&mut palpation, [0.061, 0.0, 0.0]), [], "beside the tissue");
        let before = palpation.training();
        assert_eq!((before.marked, before.found), (3, 1));
        assert_eq!(before.marks[1].map(|mark| mark.is_true), Some(false));
        let last = report(&mut palpation, [0.02, 0.01, 0.0]);
        assert_eq!(last, [marked(Some(1)), vec![TaskEvent::Ended]].concat());
        assert_eq!(report(&mut palpation, [0.0, 0.0, 0.0]), [], "the trial is over");
        palpation.begin();
        assert_eq!((palpation.training().marked, palpation.training().found), (0, 0));
        assert_eq!(report(&mut palpation, [0.0, 0.0, 0.0]), marked(None));
    }

    #[test]
    fn there_is_nothing_to_mark_where_nobody_looks_for_lumps() {
        for scene in ["lumps", "peg_transfer", "rings", "wire"] {
            assert!(Palpation::of(&Scene::load(scene).unwrap()).is_none(), "{scene}");
        }
    }
}
