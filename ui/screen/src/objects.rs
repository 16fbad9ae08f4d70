//! The objects of a simulated scene, converted for sessions and the screen.

use nalgebra::{Isometry3, Translation3};
use nima_core::task::TimedTaskEvent;
use nima_machine::rig::{SIDES, Side};
use nima_session::objects::{JawState, LumpMark, ObjectSource, ObjectStates, TaskProgress, WireLoop};
use nima_simulation::{LoopObservation, MARKS_MAX, ObjectFeed, ObjectMoment, SimulationPlan, Training};

/// Reports the objects of a simulation to its recording.
#[derive(Debug)]
pub struct OfSimulation {
    watched: ObjectFeed,
    jaws: [bool; SIDES],
}

impl OfSimulation {
    pub fn source(plan: &SimulationPlan, watched: ObjectFeed) -> Box<dyn ObjectSource> {
        let has_jaws = plan.scene.objects.is_some();
        Box::new(Self { watched, jaws: Side::ALL.map(|side| has_jaws && plan.has(side)) })
    }
}

impl ObjectSource for OfSimulation {
    fn moment(&mut self) -> Option<ObjectStates> {
        self.watched.moments().next().map(|moment| objects(&moment, self.jaws))
    }

    fn happening(&mut self) -> Option<TimedTaskEvent> {
        self.watched.happenings().next()
    }
}

pub fn objects(moment: &ObjectMoment, has_jaws: [bool; SIDES]) -> ObjectStates {
    let ObjectMoment { t_s, rings, opening_rad, loads, training } = moment;
    let known = rings.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
    let rings = rings
        .iter()
        .take(known)
        .map(|ring| ring.map(|ring| Isometry3::from_parts(Translation3::from(ring.centre_m), ring.world_from_ring)));
    let mut jaws = [None; SIDES];
    for side in Side::ALL.map(Side::index) {
        let touching = loads[side].touching;
        jaws[side] = has_jaws[side].then_some(JawState {
            opening_rad: opening_rad[side],
            opens_n: loads[side].opening_n,
            force_n: loads[side].tip_n,
            torque_nm: loads[side].torque_nm,
            touched: [touching.ring, touching.peg, touching.board, touching.other_instrument],
        });
    }
    ObjectStates { t_s: *t_s, rings: rings.collect(), jaws, task: Some(standing(training)) }
}

/// Returns the progress of a task, as a session stores it.
fn standing(training: &Training) -> TaskProgress {
    let Training { ended, marks, marked, found, loops, touches, fraction, passed, placed, dropped } = *training;
    let seen = |LoopObservation { touches, on_wire }| WireLoop { touches, on_wire };
    let mark = |nima_simulation::PlaceMark { position_m, is_true }| LumpMark { position_m, is_true };
    let marks = marks.into_iter().flatten().map(mark).collect();
    TaskProgress { ended, fraction, marked, found, touches, passed, placed, dropped, loops: loops.map(seen), marks }
}

/// Returns the progress of a task, as the screen shows it.
pub fn training(standing: &TaskProgress) -> Training {
    let TaskProgress { ended, fraction, marked, found, touches, passed, placed, dropped, loops, ref marks } = *standing;
    let mut all = [None; MARKS_MAX];
    for (place, LumpMark { position_m, is_true }) in all.iter_mut().zip(marks) {
        *place = Some(nima_simulation::PlaceMark { position_m: *position_m, is_true: *is_true });
    }
    let loops = loops.map(|WireLoop { touches, on_wire }| LoopObservation { touches, on_wire });
    Training { ended, marks: all, marked, found, loops, touches, fraction, passed, placed, dropped }
}
