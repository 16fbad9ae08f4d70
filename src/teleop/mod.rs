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

pub use crate::device::GUIDE_MAX_M;
pub use accuracy::{Accuracy, ErrorStats};
pub use force_path::{Calibrations, ForcePath, ForceReport, ForceSource};
pub use link::{Link, Weather};
pub use pair::{EVENTS_PER_TICK_MAX, Pair, Timing};
pub use tracking::Tracking;

use crate::{
    config::Rig as RigConfig,
    device::{DeviceEvent, Inputs, Outputs, SIDES, Side},
    impedance::SettingsError,
    runtime::{Command, Event, Fault, Tick},
    safety,
};

/// State of an arm pair.
pub type LoopState = safety::State<Fault>;

/// The pairs of a rig.
#[derive(Clone, Debug)]
pub struct Loop {
    /// Boxed: a pair is large, and a thread's stack is not.
    pairs: [Option<Box<Pair>>; SIDES],
    refused: Option<Event>,
}

impl Loop {
    /// A loop for the sides that have calibrations (empty ones, where the force is measured at the tip). Everything is
    /// allocated here.
    pub fn new(rig: &RigConfig, calibrations: &[Option<Calibrations>; SIDES]) -> Result<Self, SettingsError> {
        let mut pairs = [None, None];
        for (side, known) in Side::ALL.into_iter().zip(calibrations) {
            if let Some(known) = known {
                pairs[side.index()] = Some(Box::new(Pair::new(rig, side, known)?));
            }
        }
        Ok(Self { pairs, refused: None })
    }

    /// The pair of this side.
    pub fn pair(&self, side: Side) -> Option<&Pair> {
        self.pairs[side.index()].as_deref()
    }

    /// The pairs there are.
    pub fn pairs(&self) -> impl Iterator<Item = &Pair> {
        self.pairs.iter().flatten().map(Box::as_ref)
    }

    /// What happened since [`Loop::clear_events`], oldest first for each pair.
    pub fn events(&self) -> impl Iterator<Item = &Event> {
        self.refused.iter().chain(self.pairs().flat_map(Pair::events))
    }

    /// Forgets the events; call before handling commands of the next tick.
    pub fn clear_events(&mut self) {
        self.refused = None;
        self.pairs.iter_mut().flatten().for_each(|pair| pair.clear_events());
    }

    /// Carries out one command in every pair that it concerns, or tells that none could.
    pub fn obey(&mut self, command: Command, t_s: f64) {
        let mut done = false;
        for pair in self.pairs.iter_mut().flatten().filter(|pair| command.concerns(pair.side())) {
            done |= pair.obey(command, t_s);
        }
        if !done {
            self.refused = Some(Event::CommandRefused { t_s, command });
        }
    }

    /// Every pair is idle, and these inputs are there for each.
    pub fn is_idle_with(&self, inputs: &[Option<Inputs>; SIDES]) -> bool {
        self.pairs().all(|pair| pair.state() == LoopState::Idle && inputs[pair.side().index()].is_some())
    }

    /// Takes in that a device came or went.
    pub fn notice(&mut self, event: &DeviceEvent) {
        for pair in self.pairs.iter_mut().flatten().filter(|pair| event.of_side[pair.side().index()]) {
            pair.notice(event);
        }
    }

    /// Takes in that the supervisor found the loop silent for so long, s, and switched the drives off.
    pub fn notice_stall(&mut self, silent_s: f64, t_s: f64) {
        for pair in self.pairs.iter_mut().flatten() {
            let periods = (silent_s * pair.rate_hz()).round() as u64;
            pair.fail_if_driven(Fault::LoopStalled { periods }, t_s);
        }
    }

    /// Makes the link of this side a bad one, for studies of faults.
    pub fn disturb(&mut self, side: Side, weather: Weather) {
        if let Some(pair) = &mut self.pairs[side.index()] {
            pair.disturb(weather);
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
