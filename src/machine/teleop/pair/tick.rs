//! One tick of an arm pair, from top to bottom: readings in, force and motion out.

use nalgebra::Vector3;
use nima_core::{
    calibration::frames::FrameSample,
    impedance::RenderedForces,
    safety::{ForceRequest, GateReport, InterlockInput, PlausibilityInput, TransitionCause},
};

use super::Pair;
use crate::{
    messages::{
        CalibrationReadings, Command, Event, Fault, ForceReport, Guidance, LoopState, Tick, TickForces, TickPositions,
        TickTiming, UNKNOWN_N, Watchdog,
    },
    rig::{Inputs, Outputs, SensedForce, Switches, ViewOrientation},
    teleop::{
        Link, Timing, far_link::LINK_SILENT_AFTER_S, follower_half::NO_FORCE, leader_half::TipLead,
        samples::SILENT_AFTER_S, timing::TickSpacing,
    },
};

/// Time of consecutive missed periods that is a fault while drives are on, s.
const STALLED_AFTER_S: f64 = 0.050;
/// If a tip moved more than this within a tick, it is not at rest, and the pair is not engaged, m.
/// A tip at rest shows its encoder noise; 0.2 mm in a tick of 1 ms would be 0.2 m/s.
const AT_REST_M: f64 = 0.2e-3;

#[derive(Clone, Copy, Debug)]
struct Delivery {
    /// Age beyond the delay, s; infinite without a packet.
    age_s: f64,
    /// The force measured one delay ago, N, if known.
    delayed_n: Vector3<f64>,
}

#[derive(Clone, Copy, Debug)]
struct HandForce {
    /// Force after the gates, N, in the workspace.
    rendered_n: Vector3<f64>,
    gates: GateReport,
    gripper_n: f64,
}

impl<L: Link> Pair<L> {
    /// Executes one tick: measurements in, commands out, and everything to display or record in the [`Tick`]. The only
    /// information about the other pair is whether it had failed after the previous tick.
    pub fn step(&mut self, other_has_failed: bool, inputs: Option<Inputs>, timing: &Timing) -> (Outputs, Tick) {
        let now_s = timing.now_s;
        // Before anything else: an operator who lost one hand must not pull with the other.
        if other_has_failed {
            self.fail_if_driven(Fault::OtherArm, now_s);
        }
        self.check_clock(timing);
        self.end_late_test(now_s);
        // A sample with a number that is not finite counts as no sample.
        let inputs = inputs.filter(|inputs| inputs.is_finite() && !self.withholds(Watchdog::Source));
        let moved_m = self.samples.moved_m(inputs.as_ref());

        // The follower's half: readings, tip force, identification, packets into the link.
        let inputs = inputs.map(|inputs| self.take_in(inputs, timing));
        // The clock of the identification continues without a sample; over a network it runs at the other machine.
        if inputs.is_none() {
            self.link.miss(&mut self.follower, timing);
        }

        // The permissions of the interlock.
        self.raise_faults(inputs.as_ref(), timing);
        // After the faults, so that a fault of this tick prevents an engagement in it.
        self.step_interlock(inputs.as_ref(), moved_m, now_s);
        self.drop_old_force(now_s);

        // The leader's half: hand to command, packets and motion to a force, gates, handle. Without a new sample the
        // link keeps delivering packets in transit; these grow older, and the age gate removes the force.
        // Outputs are computed in every tick, also without a sample: the gates then let the force fade.
        let seen = self.samples.last.unwrap_or(Inputs::NOTHING);
        let lead = self.leader.lead(&seen);
        let rendered = self.leader.render(&seen, &lead, &mut self.link, timing);
        let delivery = self.receive(&seen, now_s);
        let felt = self.feel(inputs.as_ref(), &seen, &rendered, &delivery, now_s);
        self.judge_modes(inputs.is_some(), &rendered);

        let outputs = self.outputs(&seen, &lead, &felt);
        let tick = self.report(&seen, &lead, &rendered, &delivery, &felt, timing);
        self.ticks.executed += 1;
        (outputs, tick)
    }

    /// Raises a fault if the time does not advance by whole periods. If it stops or goes back, the identification is
    /// reset, because packets with a time in the future would never grow old.
    fn check_clock(&mut self, timing: &Timing) {
        let passed = self.ticks.pass(timing);
        if passed != TickSpacing::Evenly {
            self.fail_if_driven(Fault::ClockJumped, timing.now_s);
        }
        if passed == TickSpacing::Backwards {
            // Everything that is ordered by time starts again; the settings stay.
            self.follower.identifier.reset();
            self.leader.renderer.reset();
            self.link.clear();
            self.samples.begin_at(timing.now_s);
        }
    }

    /// Passes a sample through the follower's half; returns it with impossible jumps replaced by the last plausible
    /// value.
    fn take_in(&mut self, mut inputs: Inputs, timing: &Timing) -> Inputs {
        let now_s = timing.now_s;
        let was_usable = self.follower.force.source.is_usable();
        self.follower.force = match &inputs.sensed {
            SensedForce::FarEnd(identified) => self.receive_identified(identified),
            sensed => self.follower.force_path.step(now_s, sensed),
        };
        let is_usable = self.follower.force.source.is_usable();
        // The last force is from before the gap: compared with it, the new one would look like a jump.
        if is_usable && !was_usable {
            self.plausibility.force_is_new();
        }
        let observed = self.observed(&inputs, now_s);
        let admitted = self.plausibility.step(&observed);
        // From here on only admitted values are used, so that a spike that is bridged reaches neither the link nor the
        // hand.
        inputs.tip_m = admitted.tip_m;
        inputs.hand.position_m = admitted.hand_m;
        if is_usable {
            self.follower.force.tip_n = admitted.force_n;
        }
        self.leader.gates.move_hand(inputs.hand_s(now_s), inputs.hand.position_m);
        // Packets without a usable force would be rendered as a contact that ended.
        // A sample with an unusable force counts as missing: no packet is sent for it.
        let sends = is_usable && !self.withholds(Watchdog::Link);
        self.link.identify(&mut self.follower, &inputs.tip_m, timing, sends);
        self.samples.keep(&inputs, now_s);
        inputs
    }

    /// Returns the input of the plausibility check for this sample.
    fn observed(&self, inputs: &Inputs, now_s: f64) -> PlausibilityInput {
        let force = &self.follower.force;
        let silent_s = inputs.silent_s;
        let is_far = self.link.is_far();
        PlausibilityInput {
            t_s: now_s,
            raw: inputs.raw,
            // An unknown force counts as zero for this check, which restarts at the first known force.
            force_n: if force.source.is_usable() { force.tip_n } else { Vector3::zeros() },
            min_n: force.source.min_n(),
            world_from_s1: inputs.sensed.wrist().and_then(|sample| sample.world_from_s1),
            // With a delay between command and tip, the command to which this tip responds is an older one.
            tip_m: inputs.tip_m,
            hand_m: inputs.hand.position_m,
            command_m: match inputs.planned.0 {
                // The plan is the command sent to the arm; the arm's limits may make it lag behind the hand's command.
                Some(planned_m) => self.leader.command_m.map(|_| planned_m),
                None => self.leader.command_behind_m(self.link.behind(silent_s), silent_s),
            },
            hand_force_n: self.leader.hand_force_n,
            guided: self.screen.guide_m.is_some(),
            // Only one half is remote, and only its data can be silent.
            tip_silent_s: if is_far { silent_s } else { 0.0 },
            hand_silent_s: if is_far { 0.0 } else { silent_s },
        }
    }

    fn raise_faults(&mut self, inputs: Option<&Inputs>, timing: &Timing) {
        let now_s = timing.now_s;
        if timing.missed_now as f64 / self.settings.rate_hz > STALLED_AFTER_S {
            // `fail_if_driven` also covers `Ready`: an arm that starts with a stalled loop stops again.
            self.fail_if_driven(Fault::LoopStalled { periods: timing.missed_now }, now_s);
        }
        // The order is the order of causes: only the first fault is reported, and the later ones follow from it.
        if self.samples.are_silent(now_s) {
            self.fail_if_driven(Fault::SourceSilent, now_s);
        }
        // In `Ready` the drives are still starting, and neither power nor force is required yet.
        let coupled = matches!(self.state(), LoopState::Engaged | LoopState::Clutched);
        if self.samples.count(inputs.is_some()) {
            self.fail_if_driven(Fault::SamplesLost, now_s);
        }
        if inputs.is_some_and(|inputs| inputs.silent_s > LINK_SILENT_AFTER_S) {
            self.fail_if_driven(Fault::LinkSilent, now_s);
        }
        if let Some(fault) = self.far_fault() {
            self.fail_if_driven(fault, now_s);
        }
        let source = self.follower.force.source;
        if coupled && !source.is_usable() {
            self.fail(Fault::ForceUnknown { source }, now_s);
        }
        if coupled && inputs.is_some_and(|inputs| !inputs.powered) {
            self.fail(Fault::DrivesOff, now_s);
        }
        if let Some(what) = self.plausibility.doubt() {
            self.fail_if_driven(Fault::Implausible { what }, now_s);
        }
    }

    fn step_interlock(&mut self, inputs: Option<&Inputs>, moved_m: f64, now_s: f64) {
        let switches = self.samples.last.map_or_else(Switches::default, |seen| seen.switches);
        let seen = InterlockInput {
            connected: !self.samples.are_silent(now_s),
            powered: inputs.is_some_and(|inputs| inputs.powered),
            agreed: inputs.is_some_and(|inputs| inputs.view != ViewOrientation::Unseen)
                && self.follower.force.source.is_usable()
                && !self.link.is_old()
                && moved_m <= AT_REST_M,
            // A handle without a presence sensor cannot report a hand; the governor then decides from the motion.
            present: switches.presence.unwrap_or(true) && !self.leader.gates.hand_is_gone,
            clutch: switches.clutch,
        };
        if let Some(change) = self.interlock.step(&seen, now_s) {
            self.enter(change, now_s);
            if change.why == TransitionCause::Late {
                let why = self.waits_for(seen, inputs);
                self.note(Event::CommandRefused { t_s: now_s, side: self.side, command: Command::Engage, why });
            }
        }
    }

    /// Called after the fault for the silence, which is the cause.
    fn drop_old_force(&mut self, now_s: f64) {
        if !self.samples.are_silent(now_s) {
            // A force that is still fresh is kept between samples: some rigs are slower than the loop.
            return;
        }
        self.follower.force = NO_FORCE;
        // The other machine repeats nothing, but its last force would otherwise remain the current one.
        self.link.mute();
    }

    /// Receives the current packet, checks it, and raises a fault if it is too old.
    fn receive(&mut self, seen: &Inputs, now_s: f64) -> Delivery {
        let delay_s = self.link.delay_s();
        // Until the first packet arrives, the delay line is still filling.
        // Infinite age closes the gates.
        let Some(parcel) = self.link.receive(now_s) else {
            self.link.note_age(None);
            return Delivery { age_s: f64::INFINITY, delayed_n: UNKNOWN_N };
        };
        self.plausibility.delivered(&parcel.force_n, parcel.t_s);
        // Over a network a packet may be younger than its delay; its force still ends when the connection does. `max`,
        // not a sum: the silence is already contained in the age of the newest packet.
        let age_s = (now_s - parcel.t_s - delay_s + seen.age_s).max(seen.silent_s);
        // From this age on the gates pass nothing, so the screen shows an unknown force as well.
        let is_known = parcel.fresh && age_s < self.leader.gates.chain.settings().zero_after_s;
        let delayed_n = if is_known { parcel.force_n } else { UNKNOWN_N };
        self.link.note_age(Some(age_s));
        // Engagement waits for the first new packet.
        let is_awaited = self.link.is_old() && self.state() == LoopState::Ready;
        if age_s > LINK_SILENT_AFTER_S && !is_awaited {
            self.fail_if_driven(Fault::LinkSilent, now_s);
        }
        Delivery { age_s, delayed_n }
    }

    /// Passes the force of the mode through the gates to the handle, and the force on the jaws to the gripper.
    fn feel(
        &mut self,
        inputs: Option<&Inputs>,
        seen: &Inputs,
        rendered: &RenderedForces,
        delivery: &Delivery,
        now_s: f64,
    ) -> HandForce {
        // Both: the interlock permits the coupling, and the force at this moment has to be known.
        let permitted = self.state().permits().coupled && self.follower.force.source.is_usable();
        let force_n = self.leader.modes.force_n(rendered);
        // After a change of mode both modes are computed until the new one is ready; only then is the old one no longer
        // needed.
        if self.leader.modes.settle(rendered) {
            self.compute();
        }
        let age_s = delivery.age_s;
        let mapping = self.leader.hand_eye.mapping();
        let (rendered_n, gates) = self.leader.gates.step(ForceRequest {
            t_s: now_s,
            force_n,
            age_s,
            speed_m_s: self.leader.gates.hand_speed_m_s,
            // In the axes of the force: the travel of the hand itself, before scaling. A missing sample loses no
            // travel, because the next one includes it.
            hand_m: self.samples.recent(now_s).map(|seen| mapping.world_from_leader() * seen.hand.position_m),
            hand_age_s: now_s - seen.hand_s(now_s),
            permitted,
        });
        let gripper_n = self.leader.gates.grip(inputs, now_s, age_s, permitted);
        // In the frame of the device; not scaled, because the operator's gain has been applied.
        self.leader.hand_force_n = mapping.force_to_hand(&rendered_n);
        HandForce { rendered_n, gates, gripper_n }
    }

    /// Compares the force of each mode with the current force, if known: if the follower's half is at another machine,
    /// that machine evaluates the modes.
    fn judge_modes(&mut self, came: bool, rendered: &RenderedForces) {
        let force = &self.follower.force;
        // An error against an estimated force would only measure the estimate.
        if came && force.source.is_known() && !self.link.is_far() {
            self.accuracy.add(rendered, self.follower.identifier.report().modes, &force.tip_n);
        }
    }

    fn outputs(&self, seen: &Inputs, lead: &TipLead, felt: &HandForce) -> Outputs {
        Outputs {
            drives: self.state().permits().drives,
            tip_command_m: lead.tip_m,
            // Without a measured wrist there is no starting point for a command.
            world_from_jaws: lead.tip_m.and(seen.world_from_jaws).map(|_| lead.target.world_from_jaws),
            hand_force_n: self.leader.hand_force_n,
            gripper_n: felt.gripper_n,
            prompt: self.screen.prompt,
            guide_m: self.screen.guide_m,
            grip_rad: self.screen.grip_rad,
            acts: self.screen.acts,
            lets_go: self.screen.lets_go.unwrap_or(false),
        }
    }

    fn report(
        &self,
        seen: &Inputs,
        lead: &TipLead,
        rendered: &RenderedForces,
        delivery: &Delivery,
        felt: &HandForce,
        timing: &Timing,
    ) -> Tick {
        let force = self.force_now(seen);
        let recent = self.samples.recent(timing.now_s);
        Tick {
            index: self.ticks.executed,
            t_s: timing.now_s,
            side: self.side,
            state: self.state(),
            mode: self.leader.modes.mode,
            delay_s: self.link.delay_s(),
            positions: TickPositions {
                // At rest the leader's motion is the tip's own, so that no difference is shown.
                leader_m: if lead.tip_m.is_some() { lead.target.tip_m } else { seen.tip_m },
                tip_m: seen.tip_m,
            },
            measured_n: force.measured_n(),
            force,
            calibration: CalibrationReadings {
                wrist: recent.and_then(|seen| seen.sensed.wrist()).copied(),
                // A repeated pose would look like one that is held still.
                frames: if self.samples.came { seen.frames } else { FrameSample::default() },
                view: seen.view,
            },
            guidance: Guidance { prompt: self.screen.prompt, guide_m: self.screen.guide_m },
            rendering: TickForces {
                delayed_n: delivery.delayed_n,
                asked_n: rendered.force_n,
                rendered_n: felt.rendered_n,
            },
            gates: felt.gates,
            identification: *self.link.report(&self.follower),
            timing: TickTiming {
                wake_s: timing.wake_s,
                work_s: timing.work_s,
                sample_to_force_s: timing.sample_to_force_s,
                missed: self.ticks.missed,
                dropped: 0,
            },
        }
    }

    /// Over a network a gap is a fault only after [`LINK_SILENT_AFTER_S`], but its force is not the current one.
    fn force_now(&self, seen: &Inputs) -> ForceReport {
        if seen.silent_s > SILENT_AFTER_S { NO_FORCE } else { self.follower.force }
    }
}
