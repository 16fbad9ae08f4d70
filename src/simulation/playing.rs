//! Both instruments of a simulation with their shared objects, and the training task performed with them.

mod lumps;

use nima_core::task::{Event, Happening};
use nima_machine::rig::{Act, Acts, SIDES, Side};

use crate::{
    physics::{Doing, Instrument, Loads, Objects, PegTransfer, Setting, Watch, Wire, WireSetting, WireState, WireTask},
    scene::Scene,
    watched::{LoopSeen, Moment, RINGS_MAX, Teller, Training},
};
use lumps::Palpation;

/// Interval between two reported states, s; within a microsecond, because times of the loop are rounded.
const MOMENT_EVERY_S: f64 = 0.01;
const ROUNDING_S: f64 = 1e-6;

/// The objects, their events, and whether the task is done.
#[derive(Clone, Debug)]
pub(super) struct Playing {
    game: Game,
    acts: [Acts; SIDES],
    is_done: bool,
    told_s: f64,
    teller: Teller,
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
    watch: Watch,
    task: PegTransfer,
    /// Progress for the screen.
    counted: Training,
}

impl Game {
    fn of(scene: &Scene, period_s: f64) -> Option<Self> {
        let rings = |setting: &Setting| {
            let objects = Objects::new(setting, period_s);
            let watch = Watch::new(&objects);
            let task = PegTransfer::new(setting);
            Self::Rings(Box::new(Rings { objects, watch, task, counted: Training::default() }))
        };
        let wire = |setting: &WireSetting| Self::Wire(Box::new((Wire::new(setting, period_s), WireTask::new(setting))));
        let lumps = || Palpation::of(scene).map(|palpation| Self::Lumps(Box::new(palpation)));
        scene.objects.as_ref().map(rings).or_else(|| scene.wire.as_ref().map(wire)).or_else(lumps)
    }

    /// Simulates one period; `tell` receives each event with its age, s.
    fn step(&mut self, instruments: &[Option<Instrument>; SIDES], tell: &mut dyn FnMut(f64, Event)) -> [Loads; SIDES] {
        match self {
            Self::Rings(rings) => rings.step(instruments, tell),
            Self::Wire(both) => {
                let (wire, task) = both.as_mut();
                let loads = wire.step(instruments);
                task.look(wire, tell);
                loads
            }
            Self::Lumps(_) => [Loads::default(); SIDES],
        }
    }

    /// Performs the action if the task has it; returns whether it has.
    fn act(&mut self, act: Act, side: Side, at: &Instrument, tell: &mut dyn FnMut(f64, Event)) {
        match (self, act) {
            (Self::Lumps(palpation), Act::Mark) => palpation.mark(side, &at.tip_m, tell),
            (Self::Lumps(palpation), Act::Begin) => {
                palpation.begin();
                tell(0.0, Event::Begun);
            }
            (Self::Lumps(palpation), Act::End) => {
                palpation.end();
                tell(0.0, Event::Ended);
            }
            (Self::Wire(both), Act::Begin) => {
                both.1.begin();
                tell(0.0, Event::Begun);
            }
            // Rings cannot be marked; on a wire there is nothing to mark, and reaching the goal ends the trial.
            (Self::Rings(_), _) | (Self::Wire(_), Act::Mark | Act::End) => {}
        }
    }

    fn training(&self) -> Training {
        match self {
            Self::Rings(rings) => rings.counted,
            Self::Lumps(palpation) => palpation.training(),
            Self::Wire(both) => {
                let (wire, task) = both.as_ref();
                let seen = |state: &WireState| LoopSeen { touches: state.touches, on_wire: state.along_m.is_some() };
                let loops = wire.states().each_ref().map(seen);
                Training { touches: task.touches(), share: task.share(), loops, ..Training::default() }
            }
        }
    }
}

impl Rings {
    fn step(&mut self, instruments: &[Option<Instrument>; SIDES], tell: &mut dyn FnMut(f64, Event)) -> [Loads; SIDES] {
        let loads = self.objects.step(instruments);
        self.watch.look(&self.objects);
        let mut done = false;
        while let Some(event) = self.watch.next_event() {
            tell(0.0, event);
            self.task.take(event);
            self.count(event);
            done = true;
        }
        if done && self.task.is_done() {
            tell(0.0, Event::Ended);
        }
        loads
    }

    fn count(&mut self, event: Event) {
        let Training { passed, placed, dropped, .. } = &mut self.counted;
        match event {
            Event::RingTransferred { .. } => *passed += 1,
            Event::RingPlaced { .. } => *placed += 1,
            Event::RingDropped { .. } => *dropped += 1,
            _ => {}
        }
    }
}

impl Playing {
    /// Makes the game of this scene; `None` if it has no objects.
    pub(super) fn of(scene: &Scene, period_s: f64, teller: Teller) -> Option<Self> {
        let game = Game::of(scene, period_s)?;
        Some(Self { game, acts: [Acts::NONE; SIDES], is_done: false, told_s: f64::NEG_INFINITY, teller })
    }

    /// Simulates one period that ends at `t_s` on the loop's clock, with the instruments at these poses and these
    /// actions done.
    pub(super) fn step(
        &mut self,
        t_s: f64,
        instruments: &[Option<Instrument>; SIDES],
        acts: [Acts; SIDES],
    ) -> [Loads; SIDES] {
        let Self { game, is_done, teller, .. } = self;
        let mut tell = |age_s: f64, event: Event| {
            // A task ends once; actions after the end are not part of the trial.
            let again = *is_done && event == Event::Ended;
            *is_done = event != Event::Begun && (*is_done || event == Event::Ended);
            if !again {
                teller.happening(Happening { t_s: t_s - age_s, event });
            }
        };
        let loads = game.step(instruments, &mut tell);
        for side in Side::ALL {
            let before = std::mem::replace(&mut self.acts[side.index()], acts[side.index()]);
            let Some(at) = &instruments[side.index()] else { continue };
            for act in Act::ALL {
                for _ in 0..acts[side.index()].since(&before, act) {
                    game.act(act, side, at, &mut tell);
                }
            }
        }
        if t_s - self.told_s >= MOMENT_EVERY_S - ROUNDING_S {
            self.told_s = t_s;
            self.teller.moment(&self.moment(t_s, loads));
        }
        loads
    }

    fn moment(&self, t_s: f64, loads: [Loads; SIDES]) -> Moment {
        let mut rings = [None; RINGS_MAX];
        let mut opening_rad = [0.0; SIDES];
        if let Game::Rings(game) = &self.game {
            for (place, ring) in rings.iter_mut().zip(game.objects.rings()) {
                *place = (ring.doing != Doing::OutOfView).then_some(*ring);
            }
            opening_rad = game.objects.openings_rad().map(Option::unwrap_or_default);
        }
        let training = Training { ended: self.is_done, ..self.game.training() };
        Moment { t_s, rings, opening_rad, loads, training }
    }
}
