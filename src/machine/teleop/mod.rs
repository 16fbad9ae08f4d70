//! One tick of the whole loop for both arm pairs: measurements in, force and motion out.
//!
//! Takes [`Inputs`] (m, N, workspace frame) of each side and the time (s); gives [`Outputs`] and a [`Tick`] for each side.
//! The same code runs on the real and on the virtual clock. Pure and deterministic; nothing is allocated after
//! construction. Bad input (missing or not finite) means no force at once and a fault if it lasts. A fault of one pair takes the
//! other one out of engagement too: nobody operates with one hand by surprise.

mod accuracy;
mod force_path;
mod link;
mod pair;
mod tracking;

use nima_core::impedance::SettingsError;

pub use crate::{
    config::RigConfig,
    messages::{Command, Event, Fault, LoopState, Refusal, Tick},
    rig::{DeviceEvent, GUIDE_MAX_M, Inputs, Outputs, SIDES, Side},
};
pub use accuracy::{Accuracy, ErrorStats};
pub use force_path::{Calibrations, ForcePath};
pub use link::{Link, ProgrammedLink};
pub use pair::{EVENTS_PER_TICK_MAX, Pair, Timing};
pub use tracking::Tracking;

/// The pairs of a rig.
#[derive(Clone, Debug)]
pub struct Loop<L: Link = ProgrammedLink> {
    /// Boxed: a pair is large, and a thread's stack is not.
    pairs: [Option<Box<Pair<L>>>; SIDES],
    refused: [Option<Event>; REFUSALS_PER_TICK_MAX],
}

/// Refused commands told in one tick: two commands at most are obeyed in one, by each side.
const REFUSALS_PER_TICK_MAX: usize = 2 * SIDES;

impl Loop {
    /// A loop for the sides that have calibrations (empty ones, where the force is measured at the tip), both ends in this process.
    /// Everything is allocated here.
    ///
    /// # Errors
    /// [`SettingsError`] for an identification that cannot be.
    pub fn new(rig: &RigConfig, calibrations: &[Option<Calibrations>; SIDES]) -> Result<Self, SettingsError> {
        Self::over(rig, calibrations, ProgrammedLink::new)
    }
}

impl<L: Link> Loop<L> {
    /// The same over links of another kind, made for a rate (Hz) and a delay (s).
    ///
    /// # Errors
    /// As [`Loop::new`].
    pub fn over(
        rig: &RigConfig,
        calibrations: &[Option<Calibrations>; SIDES],
        link: impl Fn(f64, f64) -> L,
    ) -> Result<Self, SettingsError> {
        let mut pairs = [None, None];
        for (side, known) in Side::ALL.into_iter().zip(calibrations) {
            if let Some(known) = known {
                pairs[side.index()] = Some(Box::new(Pair::over(rig, side, known, link(rig.rate_hz, rig.delay_s))?));
            }
        }
        Ok(Self { pairs, refused: [None; REFUSALS_PER_TICK_MAX] })
    }

    /// The link of this side.
    pub fn link_mut(&mut self, side: Side) -> Option<&mut L> {
        self.pairs[side.index()].as_mut().map(|pair| pair.link_mut())
    }

    /// The pair of this side.
    pub fn pair(&self, side: Side) -> Option<&Pair<L>> {
        self.pairs[side.index()].as_deref()
    }

    /// The pairs there are.
    pub fn pairs(&self) -> impl Iterator<Item = &Pair<L>> {
        self.pairs.iter().flatten().map(Box::as_ref)
    }

    /// What happened since [`Loop::clear_events`], oldest first for each pair.
    pub fn events(&self) -> impl Iterator<Item = &Event> {
        self.refused.iter().flatten().chain(self.pairs().flat_map(Pair::events))
    }

    /// Forgets the events; call before handling commands of the next tick.
    pub fn clear_events(&mut self) {
        self.refused = [None; REFUSALS_PER_TICK_MAX];
        self.pairs.iter_mut().flatten().for_each(|pair| pair.clear_events());
    }

    /// Carries out one command in every pair that it concerns, and tells which of them refused it and why.
    pub fn obey(&mut self, command: Command, t_s: f64) {
        let mut answers = [None; SIDES];
        for pair in self.pairs.iter_mut().flatten().filter(|pair| command.concerns(pair.side())) {
            answers[pair.side().index()] = Some(pair.obey(command, t_s));
        }
        let done = answers.contains(&Some(Ok(())));
        for (side, answer) in Side::ALL.into_iter().zip(answers) {
            match answer {
                Some(Err(why)) if !(done && why.is_already_so()) => self.refuse(side, command, why, t_s),
                None if command == Command::EngageOne(side) => self.refuse(side, command, Refusal::NoSuchArm, t_s),
                _ => {}
            }
        }
    }

    fn refuse(&mut self, side: Side, command: Command, why: Refusal, t_s: f64) {
        if let Some(free) = self.refused.iter_mut().find(|slot| slot.is_none()) {
            *free = Some(Event::CommandRefused { t_s, side, command, why });
        }
    }

    /// Every pair is idle, and can tell the force at its tip from these inputs.
    pub fn is_idle_with(&self, inputs: &[Option<Inputs>; SIDES]) -> bool {
        self.pairs().all(|pair| {
            let inputs = inputs[pair.side().index()].as_ref();
            let knows = |inputs: &Inputs| pair.force_path().knows(&inputs.sensed);
            pair.state() == LoopState::Idle && inputs.is_some_and(knows)
        })
    }

    /// Takes in that a device came or went.
    pub fn notice(&mut self, event: &DeviceEvent) {
        for pair in self.pairs.iter_mut().flatten().filter(|pair| event.of_side[pair.side().index()]) {
            pair.notice(event);
        }
    }

    /// Puts the calibrations of a side out of force: its wrist sensor came or went, and may be another one now.
    pub fn suspend_calibrations(&mut self, side: Side) {
        if let Some(pair) = &mut self.pairs[side.index()] {
            pair.suspend_calibrations();
        }
    }

    /// Puts the calibrations of this path in force and hands those before back in it; refused while the drives of the side are on.
    pub fn exchange_force_path(&mut self, side: Side, path: &mut ForcePath) -> bool {
        self.pairs[side.index()].as_mut().is_some_and(|pair| pair.exchange_force_path(path))
    }

    /// Takes in that the supervisor found the loop silent for so long, s, and switched the drives off.
    pub fn notice_stall(&mut self, silent_s: f64, t_s: f64) {
        for pair in self.pairs.iter_mut().flatten() {
            let periods = (silent_s * pair.rate_hz()).round() as u64;
            pair.fail_if_driven(Fault::LoopStalled { periods }, t_s);
        }
    }

    /// One tick of each pair. Sides without a pair rest and tell nothing.
    pub fn step(
        &mut self,
        inputs: [Option<Inputs>; SIDES],
        timing: &Timing,
    ) -> ([Outputs; SIDES], [Option<Tick>; SIDES]) {
        self.share_faults(timing.now_s);
        let (mut outputs, mut ticks) = ([Outputs::SAFE; SIDES], [None; SIDES]);
        for (i, pair) in self.pairs.iter_mut().enumerate() {
            let Some(pair) = pair else { continue };
            let (output, tick) = pair.step(inputs[i], timing);
            (outputs[i], ticks[i]) = (output, Some(tick));
        }
        (outputs, ticks)
    }

    fn share_faults(&mut self, t_s: f64) {
        let faulted = self.pairs.each_ref().map(|pair| {
            matches!(pair.as_ref().map(|pair| pair.state()), Some(LoopState::Faulted(fault)) if fault != Fault::OtherArm)
        });
        for side in Side::ALL {
            if let (true, Some(pair)) = (faulted[side.other().index()], &mut self.pairs[side.index()]) {
                pair.fail_if_driven(Fault::OtherArm, t_s);
            }
        }
    }
}
