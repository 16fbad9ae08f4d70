//! Checks of a pair's measurements and of the time before they are used: short impossible jumps are bridged,
//! implausible values are faults.

use nalgebra::Vector3;
use nima_core::{
    impedance::{Parcel, Sample},
    safety::{Observed, Seen, Why},
};

use super::{
    AT_REST_M, LINK_SILENT_AFTER_S, Pair, STALLED_AFTER_S, Timing,
    even::{deadlines, stacked},
};
use crate::{
    messages::{Command, Event, Fault, Watchdog},
    rig::{Inputs, Sensed, Switches, View},
    teleop::{Link, LoopState},
};

impl<L: Link> Pair<L> {
    /// Checks a sample; returns it with impossible jumps replaced by the last plausible value.
    pub(super) fn take_in(&mut self, mut inputs: Inputs, timing: &Timing) -> Inputs {
        let now_s = timing.now_s;
        let was_usable = self.force.source.is_usable();
        self.force = match &inputs.sensed {
            Sensed::FarEnd(identified) => self.hear(identified),
            sensed => self.force_path.step(now_s, sensed),
        };
        let is_usable = self.force.source.is_usable();
        if is_usable && !was_usable {
            self.plausibility.force_is_new();
        }
        let admitted = self.plausibility.step(&Observed {
            t_s: now_s,
            raw: inputs.raw,
            // An unknown force is none to this check; the first known one begins it anew.
            force_n: if is_usable { self.force.tip_n } else { Vector3::zeros() },
            least_n: self.force.source.least_n(),
            world_from_s1: inputs.sensed.wrist().and_then(|sample| sample.world_from_s1),
            tip_m: inputs.tip_m,
            hand_m: inputs.hand.position_m,
            command_m: self.command_in_force(inputs.silent_s),
            hand_force_n: self.hand_force_n,
            guided: self.guide_m.is_some(),
            tip_silent_s: if self.far.is_there { inputs.silent_s } else { 0.0 },
            hand_silent_s: if self.far.is_there { 0.0 } else { inputs.silent_s },
        });
        (inputs.tip_m, inputs.hand.position_m) = (admitted.tip_m, admitted.hand_m);
        if is_usable {
            self.force.tip_n = admitted.force_n;
        }
        self.hand_speed_m_s = self.speed.step(inputs.hand_s(now_s), inputs.hand.position_m);
        if !self.far.is_there {
            self.identify(&inputs.tip_m, is_usable, timing);
        } else if is_usable {
            self.far.parcel.force_n = self.force.tip_n;
        }
        self.last_inputs = Some(inputs);
        self.last_input_s = now_s - inputs.age_s;
        inputs
    }

    /// Identifies at every deadline that has passed, and sends a parcel for each.
    fn identify(&mut self, tip_m: &Vector3<f64>, is_usable: bool, timing: &Timing) {
        let now = (timing.now_s, stacked([tip_m, &self.force.tip_n]));
        for t_s in deadlines(timing, 1.0 / self.rate_hz) {
            let at = self.measured.at(t_s, now);
            let [position_m, force_n] = [0, 3].map(|from| at.fixed_rows::<3>(from).into_owned());
            self.identifier.step(&Sample { t_s, position_m, force_n });
            // An unusable force is a missing sample: no parcel is sent for it. One that nobody measured may be rendered, and is no judge.
            if is_usable && !self.withholds(Watchdog::Link) {
                let parcel = self.identifier.parcel();
                let fresh = parcel.fresh && self.force.source.is_known();
                self.link.send(&Parcel { fresh, ..*parcel });
            }
        }
        self.measured.keep(now);
    }

    /// The command that the follower had when the tip was measured, m; `None` where the tip is not measured now.
    fn command_in_force(&self, silent_s: f64) -> Option<Vector3<f64>> {
        if silent_s * self.rate_hz > 1.5 {
            return None;
        }
        match self.ticks_behind(silent_s) {
            0 => self.command_m,
            // The newest one is of the tick before.
            behind => self.command_m.and_then(|_| self.tracking.command_m(behind - 1)),
        }
    }

    /// Ticks since the command was given that was in force when the tip was measured; `silent_s` is how long nothing came.
    pub(super) fn ticks_behind(&self, silent_s: f64) -> usize {
        self.far.behind + (silent_s * self.rate_hz).round() as usize
    }

    /// Time must advance by one period plus those missed, and each tick may wake up to a period after its deadline. Otherwise it
    /// is a fault. Where time stands or goes back, the identification is reset: parcels with a time in the future would never
    /// grow old.
    pub(super) fn check_clock(&mut self, timing: &Timing) {
        let period_s = 1.0 / self.rate_hz;
        let Some(last_s) = self.last_now_s.replace(timing.now_s) else { return };
        let surplus_s = timing.now_s - last_s - period_s * (1 + timing.missed_now) as f64;
        // A tenth more for a loop that moves its phase.
        if surplus_s.abs() <= 1.1 * period_s && timing.now_s > last_s {
            return;
        }
        self.fail_if_driven(Fault::ClockJumped, timing.now_s);
        if timing.now_s.is_nan() || timing.now_s <= last_s {
            self.identifier.reset();
            self.renderer.reset();
            self.link.clear();
            self.last_input_s = timing.now_s;
        }
    }

    /// Raises faults, then steps the interlock.
    pub(super) fn watch(&mut self, inputs: Option<&Inputs>, moved_m: f64, timing: &Timing) {
        let now_s = timing.now_s;
        if timing.missed_now as f64 / self.rate_hz > STALLED_AFTER_S {
            self.fail_if_driven(Fault::LoopStalled { periods: timing.missed_now }, now_s);
        }
        let connected = !self.is_silent(now_s);
        if !connected {
            self.fail_if_driven(Fault::SourceSilent, now_s);
        }
        let coupled = matches!(self.state(), LoopState::Engaged | LoopState::Clutched);
        if self.loses_samples(inputs.is_some()) {
            self.fail_if_driven(Fault::SamplesLost, now_s);
        }
        if inputs.is_some_and(|inputs| inputs.silent_s > LINK_SILENT_AFTER_S) {
            self.fail_if_driven(Fault::LinkSilent, now_s);
        }
        if let Some(fault) = self.far_fault() {
            self.fail_if_driven(fault, now_s);
        }
        if coupled && !self.force.source.is_usable() {
            self.fail(Fault::ForceUnknown { source: self.force.source }, now_s);
        }
        if coupled && inputs.is_some_and(|inputs| !inputs.powered) {
            self.fail(Fault::DrivesOff, now_s);
        }
        if let Some(what) = self.plausibility.doubt() {
            self.fail_if_driven(Fault::Implausible { what }, now_s);
        }
        let switches = self.last_inputs.map_or_else(Switches::default, |seen| seen.switches);
        let seen = Seen {
            connected,
            powered: inputs.is_some_and(|inputs| inputs.powered),
            agreed: inputs.is_some_and(|inputs| inputs.view != View::Unseen)
                && self.force.source.is_usable()
                && !self.link_is_old()
                && moved_m <= AT_REST_M,
            present: switches.presence.unwrap_or(true) && !self.hand_is_gone,
            clutch: switches.clutch,
        };
        if let Some(change) = self.interlock.step(&seen, now_s) {
            self.enter(change, now_s);
            if change.why == Why::Late {
                let why = self.waits_for(seen, inputs);
                self.tell(Event::CommandRefused { t_s: now_s, side: self.side, command: Command::Engage, why });
            }
        }
    }

    /// Whether what the link within this process delivers is from before a silence.
    pub(super) fn link_is_old(&self) -> bool {
        self.link_age_s > LINK_SILENT_AFTER_S
    }

    /// Whether so many samples are missing that the identification would learn from interpolated data: more than one in
    /// six; detected within 20 ms if every second one is missing. A continuous silence counts as one gap.
    fn loses_samples(&mut self, there: bool) -> bool {
        const TOO_MANY: f64 = 8.0;
        const FORGIVEN: f64 = 0.2;
        match (there, self.was_there) {
            (true, _) => self.gaps = (self.gaps - FORGIVEN).max(0.0),
            (false, true) => self.gaps += 1.0,
            (false, false) => {}
        }
        self.was_there = there;
        self.gaps >= TOO_MANY
    }
}
