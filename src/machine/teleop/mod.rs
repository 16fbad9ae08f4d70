//! One tick of the whole loop for both arm pairs: measurements in, force and motion out.
//!
//! Takes [`Inputs`] (m, N, workspace frame) of each side and the time (s); returns [`Outputs`] and a [`Tick`] for each
//! side. The same code runs on the real and on the virtual clock. Deterministic, without input or output; nothing is
//! allocated after construction. If a measurement is missing or not finite, the force is zero at once, and a fault
//! follows if this lasts. A fault of one pair disengages the other one too, so that the operator is never left with one
//! hand by surprise.

mod accuracy;
pub mod even;
mod far_link;
mod follower_half;
mod force_path;
mod leader_half;
mod link;
mod origin;
mod pair;
mod samples;
mod timing;
mod tracking;

use nima_core::impedance::SettingsError;

pub use crate::{
    config::RigConfig,
    messages::{Command, Event, Fault, LoopState, PeerStatus, Refusal, Tick, Watchdog},
    rig::{DeviceEvent, EngageBlocker, GUIDE_MAX_M, Inputs, Outputs, SIDES, Side},
};
pub use accuracy::{Accuracy, ErrorStats};
pub use force_path::{Calibrations, ForcePath, GravityCheck};
pub use link::{Link, ProgrammedLink};
pub use origin::LoopOrigin;
pub use pair::{EVENTS_PER_TICK_MAX, Pair};
pub use timing::Timing;
pub use tracking::TrackingLag;

#[derive(Clone, Debug)]
pub struct Loop<L: Link = ProgrammedLink> {
    /// Boxed, because a pair is too large for a thread's stack.
    pairs: [Option<Box<Pair<L>>>; SIDES],
    refused: [Option<Event>; REFUSALS_PER_TICK_MAX],
}

/// Maximum number of refused commands reported in one tick: at most two commands are executed per tick, each by both
/// sides.
const REFUSALS_PER_TICK_MAX: usize = 2 * SIDES;

impl Loop {
    /// Creates a loop for the sides that have calibrations (which may be empty if the force is measured at the tip),
    /// with leader and follower in this process. All memory is allocated here.
    ///
    /// # Errors
    /// [`SettingsError`] if the settings of the identification are invalid.
    pub fn new(rig: &RigConfig, calibrations: &[Option<Calibrations>; SIDES]) -> Result<Self, SettingsError> {
        Self::over(rig, calibrations, ProgrammedLink::new)
    }
}

impl<L: Link> Loop<L> {
    /// Creates a loop with another kind of link; `link` creates one for a rate (Hz) and a delay (s).
    ///
    /// # Errors
    /// The errors of [`Loop::new`].
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

    pub fn link_mut(&mut self, side: Side) -> Option<&mut L> {
        self.pairs[side.index()].as_mut().map(|pair| pair.link_mut())
    }

    pub fn pair(&self, side: Side) -> Option<&Pair<L>> {
        self.pairs[side.index()].as_deref()
    }

    pub fn pairs(&self) -> impl Iterator<Item = &Pair<L>> {
        self.pairs.iter().flatten().map(Box::as_ref)
    }

    /// Returns the state of each pair for the machine at the other end of a network.
    pub fn bulletins(&self) -> [Option<PeerStatus<'_>>; SIDES] {
        self.pairs.each_ref().map(|pair| pair.as_ref().map(|pair| pair.bulletin()))
    }

    /// Returns the pairs of the rig, so that [`Pair::step`] can run on a separate thread for each.
    pub fn pairs_mut(&mut self) -> [Option<&mut Box<Pair<L>>>; SIDES] {
        self.pairs.each_mut().map(Option::as_mut)
    }

    /// Returns the events since [`Loop::clear_events`], oldest first for each pair.
    pub fn events(&self) -> impl Iterator<Item = &Event> {
        self.refusals().chain(self.pairs().flat_map(Pair::events))
    }

    /// Returns the events that belong to no pair: refused commands.
    pub fn refusals(&self) -> impl Iterator<Item = &Event> {
        self.refused.iter().flatten()
    }

    /// Removes all events; call before the commands of the next tick are handled.
    pub fn clear_events(&mut self) {
        self.refused = [None; REFUSALS_PER_TICK_MAX];
        self.pairs.iter_mut().flatten().for_each(|pair| pair.clear_events());
    }

    /// Carries out one command in every pair that it concerns, and reports which pair refused it and why.
    pub fn obey(&mut self, command: Command, t_s: f64) {
        let busy = self.pairs().find(|pair| pair.state() != LoopState::Idle).map(|pair| (pair.side(), pair.state()));
        // A test of a watchdog stops an arm on purpose, so no arm may be in use.
        if let (Command::TestWatchdog(_), Some((side, state))) = (command, busy) {
            return self.refuse(side, command, Refusal::State(state), t_s);
        }
        let mut answers = [None; SIDES];
        for pair in self.pairs.iter_mut().flatten().filter(|pair| command.concerns(pair.side())) {
            answers[pair.side().index()] = Some(pair.obey(command, t_s));
        }
        // A command that one arm carried out is not a failure because the other one is already in that state.
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
        // A full list loses the refusal, not the tick: nothing is allocated here.
        if let Some(free) = self.refused.iter_mut().find(|slot| slot.is_none()) {
            *free = Some(Event::CommandRefused { t_s, side, command, why });
        }
    }

    /// Returns whether every pair is idle, has a known force at its tip, and can compute it from these inputs too.
    /// Calibrations that were activated in this tick have not computed a force yet.
    pub fn is_idle_with(&self, inputs: &[Option<Inputs>; SIDES]) -> bool {
        self.pairs().all(|pair| {
            let inputs = inputs[pair.side().index()].as_ref();
            let knows = |inputs: &Inputs| {
                pair.force_path().knows(&inputs.sensed) && !matches!(inputs.obstacle, Some(EngageBlocker::Waiting(_)))
            };
            pair.state() == LoopState::Idle && pair.may_know_force() && !pair.is_waiting() && inputs.is_some_and(knows)
        })
    }

    pub fn notice(&mut self, event: &DeviceEvent) {
        for pair in self.pairs.iter_mut().flatten().filter(|pair| event.of_side[pair.side().index()]) {
            pair.notice(event);
        }
    }

    /// Suspends the calibrations of a side: its wrist sensor was connected or lost, and may now be a different one.
    pub fn suspend_calibrations(&mut self, side: Side) {
        if let Some(pair) = &mut self.pairs[side.index()] {
            pair.suspend_calibrations();
        }
    }

    /// Swaps the force path of this side with `path`, which then contains the old one. Returns false while the drives
    /// of the side are on.
    pub fn exchange_force_path(&mut self, side: Side, path: &mut ForcePath) -> bool {
        self.pairs[side.index()].as_mut().is_some_and(|pair| pair.exchange_force_path(path))
    }

    /// Returns whether the loop must appear to its supervisor as if it stood still with its drives on, because that
    /// watchdog is tested.
    pub fn withholds_beat(&self) -> bool {
        self.pairs().any(|pair| pair.withholds(Watchdog::Loop))
    }

    /// Handles a report of the supervisor that the loop was silent for `silent_s` and that the drives were switched
    /// off.
    pub fn notice_stall(&mut self, silent_s: f64, t_s: f64) {
        for pair in self.pairs.iter_mut().flatten() {
            // In whole periods, as the loop itself counts missed ones.
            let periods = (silent_s * pair.rate_hz()).round() as u64;
            pair.fail_if_driven(Fault::LoopStalled { periods }, t_s);
        }
    }

    /// Executes one tick of each pair. A side without a pair returns [`Outputs::SAFE`] and no tick.
    ///
    /// ```
    /// use nima_machine::{
    ///     config::RigConfig,
    ///     rig::{Outputs, SIDES},
    ///     teleop::{Calibrations, Loop, Timing},
    /// };
    ///
    /// let rig = RigConfig::load("simulated")?;
    /// let mut control = Loop::new(&rig, &[Some(Calibrations::default()), None])?;
    /// let (outputs, ticks) = control.step([None; SIDES], &Timing::default());
    /// assert_eq!(outputs, [Outputs::SAFE; SIDES], "no measurement, so no force and no motion");
    /// assert!(ticks[0].is_some() && ticks[1].is_none(), "this loop has the right arm pair only");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn step(
        &mut self,
        inputs: [Option<Inputs>; SIDES],
        timing: &Timing,
    ) -> ([Outputs; SIDES], [Option<Tick>; SIDES]) {
        // Taken before any pair steps, so that both sides see the same state in the same tick, whatever their order.
        let have_failed = self.pairs.each_ref().map(|pair| pair.as_ref().is_some_and(|pair| pair.has_failed()));
        let mut outputs = [Outputs::SAFE; SIDES];
        let mut ticks = [None; SIDES];
        for (i, pair) in self.pairs.iter_mut().enumerate() {
            let Some(pair) = pair else { continue };
            let (output, tick) = pair.step(have_failed[pair.side().other().index()], inputs[i], timing);
            outputs[i] = output;
            ticks[i] = Some(tick);
        }
        (outputs, ticks)
    }
}
