//! Both instruments of a simulation with their shared objects, and the training task performed with them.

mod lumps;

use nima_core::task::{TaskEvent, TimedTaskEvent};
use nima_machine::rig::{Acts, SIDES, Side, TaskAction};

use crate::{
    object_feed::{LoopObservation, ObjectMoment, ObjectPublisher, RINGS_MAX, Training},
    physics::{
        Instrument, InstrumentLoads, ObjectSettings, Objects, PegTransfer, RingActivity, RingWatch, Wire, WireSetting,
        WireState, WireTask,
    },
    scene::Scene,
};
use lumps::Palpation;

/// Interval between two reported states, s; within a microsecond, because times of the loop are rounded.
const MOMENT_EVERY_S: f64 = 0.01;
const ROUNDING_S: f64 = 1e-6;

/// The objects, their events, and whether the task is done.
#[derive(Clone, Debug)]
pub(super) struct TrainingTask {
    game: Game,
    acts: [Acts; SIDES],
    is_done: bool,
    reported_s: f64,
    publisher: ObjectPublisher,
}

/// The kind of task.
#[derive(Clone, Debug)]
enum Game {
    Rings(Box<Rings>),
    Wire(Box<(Wire, WireTask)>),
    Lumps(Box<Palpation>),
}

#[derive(Clone, Debug)]
struct Rings {
    objects: Objects,
    /// The objects at the beginning of a trial.
    start: Objects,
    watch: RingWatch,
    task: PegTransfer,
    /// Progress for the screen.
    counted: Training,
}

impl Game {
    fn of(scene: &Scene, period_s: f64) -> Option<Self> {
        let rings = |setting: &ObjectSettings| {
            let objects = Objects::new(setting, period_s);
            let watch = RingWatch::new(&objects);
            let task = PegTransfer::new(setting);
            let start = objects.clone();
            Self::Rings(Box::new(Rings { objects, start, watch, task, counted: Training::default() }))
        };
        let wire = |setting: &WireSetting| Self::Wire(Box::new((Wire::new(setting, period_s), WireTask::new(setting))));
        let lumps = || Palpation::of(scene).map(|palpation| Self::Lumps(Box::new(palpation)));
        scene.objects.as_ref().map(rings).or_else(|| scene.wire.as_ref().map(wire)).or_else(lumps)
    }

    /// Simulates one period; `report` receives each event with its age, s.
    fn step(
        &mut self,
        instruments: &[Option<Instrument>; SIDES],
        report: &mut dyn FnMut(f64, TaskEvent),
    ) -> [InstrumentLoads; SIDES] {
        match self {
            Self::Rings(rings) => rings.step(instruments, report),
            Self::Wire(both) => {
                let (wire, task) = both.as_mut();
                let loads = wire.step(instruments);
                task.look(wire, report);
                loads
            }
            Self::Lumps(_) => [InstrumentLoads::default(); SIDES],
        }
    }

    /// Performs the action if the task has it; returns whether it has.
    fn act(&mut self, act: TaskAction, side: Side, at: &Instrument, report: &mut dyn FnMut(f64, TaskEvent)) {
        match (self, act) {
            (Self::Lumps(palpation), TaskAction::Mark) => palpation.mark(side, &at.tip_m, report),
            (Self::Lumps(palpation), TaskAction::Begin) => {
                palpation.begin();
                report(0.0, TaskEvent::Begun);
            }
            (Self::Lumps(palpation), TaskAction::End) => {
                palpation.end();
                report(0.0, TaskEvent::Ended);
            }
            (Self::Wire(both), TaskAction::Begin) => {
                both.1.begin();
                report(0.0, TaskEvent::Begun);
            }
            (Self::Rings(rings), TaskAction::Begin) => {
                rings.begin();
                report(0.0, TaskEvent::Begun);
            }
            // Rings and wires cannot be marked, and reaching the goal ends the trial.
            (Self::Rings(_) | Self::Wire(_), TaskAction::Mark | TaskAction::End) => {}
        }
    }

    fn training(&self) -> Training {
        match self {
            Self::Rings(rings) => Training { fraction: rings.task.fraction(), ..rings.counted },
            Self::Lumps(palpation) => palpation.training(),
            Self::Wire(both) => {
                let (wire, task) = both.as_ref();
                let seen =
                    |state: &WireState| LoopObservation { touches: state.touches, on_wire: state.along_m.is_some() };
                let loops = wire.states().each_ref().map(seen);
                Training { touches: task.touches(), fraction: task.fraction(), loops, ..Training::default() }
            }
        }
    }
}

impl Rings {
    fn step(
        &mut self,
        instruments: &[Option<Instrument>; SIDES],
        report: &mut dyn FnMut(f64, TaskEvent),
    ) -> [InstrumentLoads; SIDES] {
        let loads = self.objects.step(instruments);
        self.watch.look(&self.objects);
        let mut done = false;
        while let Some(event) = self.watch.next_event() {
            report(0.0, event);
            self.task.take(event);
            self.count(event);
            done = true;
        }
        if done && self.task.is_done() {
            report(0.0, TaskEvent::Ended);
        }
        loads
    }

    fn begin(&mut self) {
        self.objects.begin_as(&self.start);
        self.watch.begin(&self.objects);
        self.task.begin();
        self.counted = Training::default();
    }

    fn count(&mut self, event: TaskEvent) {
        let Training { passed, placed, dropped, .. } = &mut self.counted;
        match event {
            TaskEvent::RingTransferred { .. } => *passed += 1,
            TaskEvent::RingPlaced { .. } => *placed += 1,
            TaskEvent::RingDropped { .. } => *dropped += 1,
            _ => {}
        }
    }
}

impl TrainingTask {
    /// Creates the game of this scene; `None` if it has no objects.
    pub(super) fn of(scene: &Scene, period_s: f64, publisher: ObjectPublisher) -> Option<Self> {
        let game = Game::of(scene, period_s)?;
        Some(Self { game, acts: [Acts::NONE; SIDES], is_done: false, reported_s: f64::NEG_INFINITY, publisher })
    }

    /// Simulates one period that ends at `t_s` on the loop's clock, with the instruments at these poses and these
    /// actions done.
    pub(super) fn step(
        &mut self,
        t_s: f64,
        instruments: &[Option<Instrument>; SIDES],
        acts: [Acts; SIDES],
    ) -> [InstrumentLoads; SIDES] {
        let Self { game, is_done, publisher, .. } = self;
        let mut report = |age_s: f64, event: TaskEvent| {
            // A task ends only once; actions after its end are not part of the trial.
            let again = *is_done && event == TaskEvent::Ended;
            *is_done = event != TaskEvent::Begun && (*is_done || event == TaskEvent::Ended);
            if !again {
                publisher.happening(TimedTaskEvent { t_s: t_s - age_s, event });
            }
        };
        let loads = game.step(instruments, &mut report);
        for side in Side::ALL {
            let before = std::mem::replace(&mut self.acts[side.index()], acts[side.index()]);
            let Some(at) = &instruments[side.index()] else { continue };
            for act in TaskAction::ALL {
                for _ in 0..acts[side.index()].since(&before, act) {
                    game.act(act, side, at, &mut report);
                }
            }
        }
        if t_s - self.reported_s >= MOMENT_EVERY_S - ROUNDING_S {
            self.reported_s = t_s;
            self.publisher.moment(&self.moment(t_s, loads));
        }
        loads
    }

    fn moment(&self, t_s: f64, loads: [InstrumentLoads; SIDES]) -> ObjectMoment {
        let mut rings = [None; RINGS_MAX];
        let mut opening_rad = [0.0; SIDES];
        if let Game::Rings(game) = &self.game {
            for (place, ring) in rings.iter_mut().zip(game.objects.rings()) {
                *place = (ring.doing != RingActivity::OutOfView).then_some(*ring);
            }
            opening_rad = game.objects.openings_rad().map(Option::unwrap_or_default);
        }
        let training = Training { ended: self.is_done, ..self.game.training() };
        ObjectMoment { t_s, rings, opening_rad, loads, training }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};

    use super::*;

    #[test]
    fn a_trial_with_rings_begins_again_where_they_were() {
        let scene = Scene::load("rings").unwrap();
        let mut game = Game::of(&scene, 1e-3).unwrap();
        let Game::Rings(rings) = &mut game else { panic!("the scene has rings") };
        let start_m: Vec<_> = rings.objects.rings().iter().map(|ring| ring.centre_m).collect();
        rings.start = rings.objects.clone();
        let mut events = Vec::new();
        for _ in 0..500 {
            game.step(&[None; SIDES], &mut |_, event| events.push(event));
        }
        let Game::Rings(rings) = &mut game else { unreachable!() };
        rings.count(TaskEvent::RingPlaced { ring: 0, side: Side::Right, peg: 7 });
        assert_eq!(game.training().placed, 1);
        let at = Instrument {
            tip_m: Vector3::zeros(),
            world_from_jaws: UnitQuaternion::identity(),
            trocar_m: 0.15 * Vector3::z(),
            opening_rad: 0.0,
        };
        game.act(TaskAction::Begin, Side::Right, &at, &mut |_, event| events.push(event));
        assert_eq!(events.last(), Some(&TaskEvent::Begun));
        let Game::Rings(rings) = &game else { unreachable!() };
        let now_m: Vec<_> = rings.objects.rings().iter().map(|ring| ring.centre_m).collect();
        assert_eq!((now_m, game.training().placed), (start_m, 0));
    }
}
