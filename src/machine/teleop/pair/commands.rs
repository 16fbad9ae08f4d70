//! Commands and faults: the changes of state of a pair.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{
    impedance::{Mode, ModeSet, Rendered},
    kinematics::Target,
    limits::{DEAD_BAND_M_S, DELAY_S, GAIN, GAIN_ABOVE_ONE},
    safety::{Change, Wish},
};

use super::Pair;
use crate::{
    messages::{Command, Event, Fault, LoopState, Refusal},
    rig::{GRIP_MAX_RAD, GUIDE_MAX_M, Prompt},
    teleop::Link,
};

impl<L: Link> Pair<L> {
    fn ask(&mut self, wish: Wish, t_s: f64) -> Result<(), Refusal> {
        let change = self.interlock.ask(wish, t_s).map_err(|_| Refusal::State(self.state()))?;
        if let Some(change) = change {
            self.enter(change, t_s);
        }
        Ok(())
    }

    /// Carries out one command, or returns why it cannot. [`Command::Shutdown`] is handled by the runtime.
    ///
    /// # Errors
    /// [`Refusal`] if the command is not allowed in this state, its value is out of range, or a measurement forbids it.
    pub fn obey(&mut self, command: Command, t_s: f64) -> Result<(), Refusal> {
        match command {
            Command::SetMode(mode) if self.settings.modes.contains(mode) => self.set_mode(mode),
            Command::Compare(compares) => {
                self.compares = compares;
                self.compute();
            }
            Command::SetGain(gain) if GAIN.contains(gain) => self.chain.set_ordinary_gain(gain),
            Command::SetGainAboveOne(gain) if GAIN_ABOVE_ONE.contains(gain) => {
                self.chain.set_gain_above_one(gain);
            }
            Command::SetDelay(_) if self.far.is_there => return Err(Refusal::DelayIsMeasured),
            Command::SetDelay(delay_s) if DELAY_S.contains(delay_s) => self.set_delay(delay_s),
            Command::SetDeadBand(speed_m_s) if DEAD_BAND_M_S.contains(speed_m_s) => self.chain.set_dead_band(speed_m_s),
            Command::SetStaticHold(hold) => self.chain.set_static_hold(hold),
            Command::SetScale(scale) => match self.hand_eye.mapping().scaled(scale) {
                Ok(mapping) => self.hand_eye.set_mapping(mapping),
                Err(_) => return Err(Refusal::OutOfRange),
            },
            // In idle only: a person who handles the arm must be safe from its motion.
            Command::Prompt(_, prompt) if self.state() == LoopState::Idle && prompt.is_finite() => self.prompt = prompt,
            Command::Guide(_, guide_m)
                if !self.state().is_latched()
                    && guide_m.is_none_or(|at_m| at_m.iter().all(|x| x.abs() <= GUIDE_MAX_M)) =>
            {
                self.guide_m = guide_m;
            }
            Command::LetGo(_) | Command::SetGovernor(_) | Command::Grip(..) | Command::Task(..)
                if self.lets_go.is_none() =>
            {
                return Err(Refusal::SimulatedOnly);
            }
            Command::LetGo(lets_go) => self.lets_go = Some(lets_go),
            Command::SetGovernor(on) => self.chain.set_governor(on),
            Command::Prompt(_, prompt) if prompt.is_finite() => return Err(Refusal::State(self.state())),
            Command::Grip(_, grip_rad)
                if !self.state().is_latched() && grip_rad.is_none_or(|rad| (0.0..=GRIP_MAX_RAD).contains(&rad)) =>
            {
                self.grip_rad = grip_rad;
            }
            Command::Task(_, act) if !self.state().is_latched() => self.acts.note(act),
            Command::Guide(..) | Command::Grip(..) | Command::Task(..) if self.state().is_latched() => {
                return Err(Refusal::State(self.state()));
            }
            Command::Engage | Command::EngageOne(_) => {
                self.may_engage()?;
                return self.ask(Wish::Engage, t_s);
            }
            Command::Rest => return self.ask(Wish::Rest, t_s),
            Command::Stop => return self.ask(Wish::Stop, t_s),
            Command::ReleaseStop => {
                if let Some(answer) = self.release_far() {
                    return answer;
                }
                self.may_release(t_s)?;
                self.ask(Wish::Release, t_s)?;
                self.releases = self.releases.wrapping_add(1);
            }
            Command::Checked(passed) => self.checked = self.checked.map(|_| passed),
            Command::TestWatchdog(watchdog) => return self.test_watchdog(watchdog, t_s),
            Command::Shutdown => {}
            _ => return Err(Refusal::OutOfRange),
        }
        Ok(())
    }

    fn set_mode(&mut self, mode: Mode) {
        let last = std::mem::replace(&mut self.mode, mode);
        if last != mode {
            self.before = Some(last);
            self.compute();
        }
    }

    /// The force of the mode chosen; until it has one, that of the mode before, so that a change of mode takes no force from
    /// the hand.
    pub(super) fn in_force(&mut self, rendered: &Rendered) -> Option<Vector3<f64>> {
        let force_n = rendered.force(self.mode);
        let Some(before) = self.before else { return force_n };
        if force_n.is_some() {
            self.before = None;
            self.compute();
        }
        force_n.or_else(|| rendered.force(before))
    }

    /// Computes the modes that are asked for, and no others.
    pub(super) fn compute(&mut self) {
        let chosen = ModeSet::only(self.mode);
        let both = self.before.map_or(chosen, |before| chosen.with(before));
        self.identifier.compute(if self.compares { self.settings.modes } else { both });
    }

    pub(super) fn set_delay(&mut self, delay_s: f64) {
        // The delay is a whole number of samples; this is the delay that is shown on the screen.
        self.delay_s = self.settings.delay_ticks(delay_s) as f64 / self.rate_hz;
        self.link.set_delay(self.delay_s);
        self.identifier.set_delay(self.delay_s);
        self.renderer.set_delay(self.delay_s);
    }

    pub(super) fn fail(&mut self, fault: Fault, t_s: f64) {
        if let Some(change) = self.interlock.fail(fault) {
            self.tell(Event::FaultRaised { t_s, side: self.side, fault });
            self.enter(change, t_s);
        }
    }

    /// Raises a fault that matters only while drives are on, or while its watchdog is tested.
    pub(in crate::teleop) fn fail_if_driven(&mut self, fault: Fault, t_s: f64) {
        if self.state().permits().drives || self.is_tested(fault) {
            self.fail(fault, t_s);
        }
    }

    /// Actions on entering a state: everything starts from zero force and a follower at rest.
    pub(super) fn enter(&mut self, change: Change<Fault>, t_s: f64) {
        let Change { from, to, why } = change;
        self.tell(Event::StateChanged { t_s, side: self.side, from, to, why });
        self.chain.reset();
        self.gripper_chain.reset();
        self.hand_is_gone = false;
        self.watchdog_test = None;
        self.command_m = None;
        self.hand_eye.release();
        if !to.permits().drives || !from.permits().drives {
            self.prompt = Prompt::Rest;
        }
        if to.is_latched() {
            (self.guide_m, self.grip_rad, self.lets_go) = (None, None, self.lets_go.map(|_| false));
        }
        if let (LoopState::Engaged, Some(seen)) = (to, self.last_inputs) {
            // Only here: if the endoscope turns while engaged, the mapping must not turn the motion under the
            // operator's hand.
            if let Some(world_from_view) = seen.view.world_from_view() {
                let mapping = self.teleoperation.seen(world_from_view, self.hand_eye.mapping().scale());
                self.hand_eye.set_mapping(mapping);
            }
            // The mapping starts at the present positions of hand and tip, so the first command is the present tip
            // position.
            let world_from_jaws = seen.world_from_jaws.unwrap_or_else(UnitQuaternion::identity);
            self.hand_eye.engage(Target { tip_m: seen.tip_m, world_from_jaws });
            self.engaged_s = t_s;
            self.plausibility.engage();
        }
    }
}
