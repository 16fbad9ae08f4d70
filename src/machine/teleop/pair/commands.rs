//! Commands and faults: the changes of state of a pair.

use std::ops::RangeInclusive;

use nima_core::{
    impedance::Mode,
    limits::{DEAD_BAND_M_S, DELAY_S, GAIN, GAIN_ABOVE_ONE, Limits},
    safety::{InterlockRequest, StateChange},
};

use super::Pair;
use crate::{
    messages::{Command, Event, Fault, ForceReport, LoopState, Refusal, Watchdog},
    rig::{GRIP_MAX_RAD, GUIDE_MAX_M, Prompt, RemoteIdentification},
    teleop::Link,
};

impl<L: Link> Pair<L> {
    /// Carries out one command, or returns the reason for a refusal. [`Command::Shutdown`] is handled by the runtime.
    ///
    /// # Errors
    /// [`Refusal`] if the command is not allowed in this state, its value is out of range, or a measurement forbids it.
    pub fn obey(&mut self, command: Command, t_s: f64) -> Result<(), Refusal> {
        match command {
            Command::SetMode(mode) => return self.set_mode(mode),
            Command::Compare(compares) => {
                self.leader.modes.compares = compares;
                // The set of computed modes follows from mode and comparison, so it is derived again after each
                // change.
                self.compute();
            }
            Command::SetGain(gain) => self.leader.gates.chain.set_ordinary_gain(within(&GAIN, gain)?),
            Command::SetGainAboveOne(gain) => {
                self.leader.gates.chain.set_gain_above_one(within(&GAIN_ABOVE_ONE, gain)?);
            }
            // The link to another machine has its real delay.
            Command::SetDelay(_) if self.link.is_far() => return Err(Refusal::DelayIsMeasured),
            Command::SetDelay(delay_s) => self.set_delay(within(&DELAY_S, delay_s)?),
            Command::SetDeadBand(speed_m_s) => {
                self.leader.gates.chain.set_dead_band(within(&DEAD_BAND_M_S, speed_m_s)?);
            }
            Command::SetStaticHold(hold) => self.leader.gates.chain.set_static_hold(hold),
            Command::SetScale(scale) => {
                let mapping = self.leader.hand_eye.mapping().scaled(scale).map_err(|_| Refusal::OutOfRange)?;
                self.leader.hand_eye.set_mapping(mapping);
            }
            Command::Prompt(_, prompt) => return self.prompt(prompt),
            Command::Guide(_, guide_m) => {
                // Nothing may move while a stop or a fault is latched.
                self.is_not_latched()?;
                let coordinates_m = guide_m.iter().flat_map(|position_m| position_m.iter());
                all_within(-GUIDE_MAX_M..=GUIDE_MAX_M, coordinates_m)?;
                self.screen.guide_m = guide_m;
            }
            Command::Grip(_, grip_rad) => {
                self.has_simulated_hand()?;
                self.is_not_latched()?;
                all_within(0.0..=GRIP_MAX_RAD, grip_rad.iter())?;
                self.screen.grip_rad = grip_rad;
            }
            Command::Task(_, act) => {
                self.has_simulated_hand()?;
                self.is_not_latched()?;
                self.screen.acts.note(act);
            }
            Command::LetGo(lets_go) => {
                self.has_simulated_hand()?;
                self.screen.lets_go = Some(lets_go);
            }
            Command::SetGovernor(on) => {
                self.has_simulated_hand()?;
                self.leader.gates.chain.set_governor(on);
            }
            Command::Engage | Command::EngageOne(_) => {
                self.may_engage()?;
                if self.has_short_stall() {
                    // One deliberate step. If a condition of either half is not met, the fault remains.
                    self.release(t_s)?;
                }
                return self.ask(InterlockRequest::Engage, t_s);
            }
            Command::Rest => return self.ask(InterlockRequest::Rest, t_s),
            Command::Stop => return self.ask(InterlockRequest::Stop, t_s),
            Command::ReleaseStop => return self.release(t_s),
            Command::TestWatchdog(watchdog) => return self.test_watchdog(watchdog, t_s),
            Command::Checked(passed) => self.checked = self.checked.map(|_| passed),
            Command::Shutdown => {}
        }
        Ok(())
    }

    fn has_simulated_hand(&self) -> Result<(), Refusal> {
        self.screen.lets_go.map(|_| ()).ok_or(Refusal::SimulatedOnly)
    }

    fn is_not_latched(&self) -> Result<(), Refusal> {
        if self.state().is_latched() { Err(Refusal::State(self.state())) } else { Ok(()) }
    }

    /// Refused unless idle, because a person who handles the arm must be safe from its motion.
    fn prompt(&mut self, prompt: Prompt) -> Result<(), Refusal> {
        if !prompt.is_finite() {
            return Err(Refusal::OutOfRange);
        }
        // A prompt in an engaged arm would ask a person to move an arm that is under control.
        if self.state() != LoopState::Idle {
            return Err(Refusal::State(self.state()));
        }
        self.screen.prompt = prompt;
        Ok(())
    }

    fn set_mode(&mut self, mode: Mode) -> Result<(), Refusal> {
        if !self.settings.modes.contains(mode) {
            return Err(Refusal::OutOfRange);
        }
        if mode != self.leader.modes.mode {
            self.leader.modes.choose(mode);
            self.compute();
        }
        Ok(())
    }

    pub(super) fn compute(&mut self) {
        self.follower.identifier.compute(self.leader.modes.computed());
    }

    /// Rounds the delay to a whole number of samples; the screen shows the rounded delay.
    pub(super) fn set_delay(&mut self, delay_s: f64) {
        // Rounded to whole ticks once, so that link, identifier and renderer use the same delay.
        let delay_s = self.settings.delay_ticks(delay_s) as f64 / self.settings.rate_hz;
        self.link.set_delay(delay_s);
        self.follower.identifier.set_delay(delay_s);
        self.leader.renderer.set_delay(delay_s);
    }

    /// Stores data of the follower's half at the other machine; returns its force.
    pub(super) fn receive_identified(&mut self, identified: &RemoteIdentification) -> ForceReport {
        if let Some(delay_s) = self.link.turn_far(identified, &self.settings) {
            self.leader.renderer.set_delay(delay_s);
        }
        // The packets of a local identification are suppressed in the same way.
        // A test of the link's watchdog suppresses reports as a broken cable would.
        let is_withheld = self.withholds(Watchdog::Link);
        self.link.receive_identified((!is_withheld).then_some(identified))
    }

    fn ask(&mut self, wish: InterlockRequest, t_s: f64) -> Result<(), Refusal> {
        let change = self.interlock.ask(wish, t_s).map_err(|_| Refusal::State(self.state()))?;
        if let Some(change) = change {
            self.enter(change, t_s);
        }
        Ok(())
    }

    /// Releases a stop or a fault here, otherwise the stop of the other machine, which follows the count.
    fn release(&mut self, t_s: f64) -> Result<(), Refusal> {
        // This machine is fine: only the other one has to be released.
        let is_of_other_machine = self.link.far_stop().is_some() && !self.state().is_latched();
        if !is_of_other_machine {
            self.may_release(t_s)?;
            self.ask(InterlockRequest::Release, t_s)?;
        }
        // A count, so that a lost or repeated message neither loses nor repeats a release.
        self.releases = self.releases.wrapping_add(1);
        Ok(())
    }

    pub(super) fn fail(&mut self, fault: Fault, t_s: f64) {
        if let Some(change) = self.interlock.fail(fault) {
            self.note(Event::FaultRaised { t_s, side: self.side, fault });
            self.enter(change, t_s);
        }
    }

    /// Raises a fault that matters only while drives are on or its watchdog is tested.
    pub(in crate::teleop) fn fail_if_driven(&mut self, fault: Fault, t_s: f64) {
        // Without drives a fault harms nothing, and would only have to be released again.
        if self.state().permits().drives || self.is_tested(fault) {
            self.fail(fault, t_s);
        }
    }

    /// Enters a state: every state starts from zero force and a follower at rest.
    pub(super) fn enter(&mut self, change: StateChange<Fault>, t_s: f64) {
        let StateChange { from, to, why } = change;
        self.note(Event::StateChanged { t_s, side: self.side, from, to, why });
        self.leader.rest();
        // A test ends with the state that it was started in.
        self.watchdog_test = None;
        if !to.permits().drives || !from.permits().drives {
            self.screen.prompt = Prompt::Rest;
        }
        // A latched pair forgets every request of the screen: nothing resumes by itself after the release.
        if to.is_latched() {
            self.screen.guide_m = None;
            self.screen.grip_rad = None;
            self.screen.lets_go = self.screen.lets_go.map(|_| false);
        }
        if let (LoopState::Engaged, Some(seen)) = (to, &self.samples.last) {
            self.leader.engage(seen, t_s);
            self.plausibility.engage();
        }
    }
}

fn within(limits: &Limits, value: f64) -> Result<f64, Refusal> {
    if limits.contains(value) { Ok(value) } else { Err(Refusal::OutOfRange) }
}

fn all_within<'a>(range: RangeInclusive<f64>, mut values: impl Iterator<Item = &'a f64>) -> Result<(), Refusal> {
    if values.all(|value| range.contains(value)) { Ok(()) } else { Err(Refusal::OutOfRange) }
}
