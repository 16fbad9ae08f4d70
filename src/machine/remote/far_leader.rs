//! The follower's rig: arm and sensor here, the hand at the other end of a network.

use nalgebra::Vector3;
use nima_core::{
    impedance::Packed,
    kinematics::Hand,
    safety::{ChainSettings, RawReadings},
};

use super::{
    GONE_AFTER_S, MESSAGE_MAX, Wire,
    far_hand::FarHand,
    follower_message::{FollowerMessage, FollowerSide},
    leader_message::{Intent, LeaderMessage, LeaderSide},
};
use crate::{
    config::{RigConfig, Teleoperation},
    messages::{Bulletin, Command, FarStop, LoopState},
    rig::{Inputs, Outputs, Rig, SIDES, Side, Switches, View, devices_of},
};

/// The parameters of one rendering are sent every so many ticks, in turn where several are computed. Fits are renewed 200 times a
/// second.
const PARAMETERS_EVERY: u64 = 10;
/// The errors of the modes are told every so many ticks: they are read, and nothing depends on them.
const ERRORS_EVERY: u64 = 100;
/// Answers go on for so long after the last message, s: so the other machine hears why this one stopped.
const ANSWERS_FOR_S: f64 = 1.0;
/// Two messages are of one loop if their times differ by what passed here, to this, s.
const SAME_CLOCK_S: f64 = 0.2;
/// The identification learns what happens over the delay, and begins anew with another one. It keeps the one that it has while the true one
/// differs by no more than this share, or these ticks: a line with jitter changes it by a tick every second.
const SAME_DELAY: f64 = 0.05;
const SAME_DELAY_TICKS: f64 = 2.0;
/// Most commands that follow from one message.
const COMMANDS_MAX: usize = 8;

/// The rig file as the follower's machine uses it: the commanded tip comes in the frame of the world already, and no hand here feels a
/// force.
#[must_use]
pub fn at_follower(rig: &RigConfig) -> RigConfig {
    let gates = ChainSettings { gain: 0.0, ..rig.gates.without_governor() };
    RigConfig { teleoperation: Teleoperation::default(), gates, ..rig.clone() }
}

/// Joins a rig's arms with hands at another machine. What the rig itself measures of handles is not used, and they get no force.
#[derive(Debug)]
pub struct FarLeader<R, W> {
    local: R,
    wire: W,
    rate_hz: f64,
    heard: Option<Heard>,
    /// The hands as the loop here sees them.
    hands: [FarHand; SIDES],
    /// What this machine's pairs were last.
    states: [Option<LoopState>; SIDES],
    inputs: [Option<Inputs>; SIDES],
    commands: [Option<Command>; COMMANDS_MAX],
    /// Delay over which the identification here learns, ticks.
    learnt_ticks: Option<u16>,
    ticks: u64,
    buffer: [u8; MESSAGE_MAX],
}

/// What the operator's machine told last.
#[derive(Clone, Copy, Debug)]
struct Heard {
    message: LeaderMessage,
    /// When it was played out, s.
    at_s: f64,
}

impl<R: Rig, W: Wire> FarLeader<R, W> {
    /// Joins the arms of `local` with the hands behind `wire`, for a loop of this rate (Hz) that is made of [`at_follower`].
    pub fn new(local: R, wire: W, rate_hz: f64) -> Self {
        Self {
            local,
            wire,
            rate_hz,
            heard: None,
            hands: [FarHand::default(); SIDES],
            states: [None; SIDES],
            inputs: [None; SIDES],
            commands: [None; COMMANDS_MAX],
            learnt_ticks: None,
            ticks: 0,
            buffer: [0; MESSAGE_MAX],
        }
    }

    /// What the rig here measured last: the hands there have no part in it.
    pub const fn measured(&self) -> &[Option<Inputs>; SIDES] {
        &self.inputs
    }

    /// The rig that is at this machine.
    pub const fn local(&self) -> &R {
        &self.local
    }

    /// The rig that is at this machine.
    pub const fn local_mut(&mut self) -> &mut R {
        &mut self.local
    }

    /// What carries the messages.
    pub const fn wire(&self) -> &W {
        &self.wire
    }

    /// What carries the messages.
    pub const fn wire_mut(&mut self) -> &mut W {
        &mut self.wire
    }

    fn receive(&mut self, now_s: f64) {
        let before = self.heard.filter(|heard| now_s - heard.at_s <= ANSWERS_FOR_S);
        let mut newest = before;
        self.wire.receive(now_s, &mut |bytes| {
            let Some(message) = LeaderMessage::unpack(bytes) else { return };
            if newest.is_none_or(|heard| message.t_s > heard.message.t_s) {
                newest = Some(Heard { message, at_s: now_s });
            }
        });
        self.heard = newest;
        self.commands = [None; COMMANDS_MAX];
        if let Some(heard) = newest.filter(|heard| heard.at_s >= now_s) {
            // Another console, or one that was started anew, has another clock and other counts: nothing was asked for in between.
            let goes_on = |before: &Heard| {
                let told_s = heard.message.t_s - before.message.t_s;
                let passed_s = heard.at_s - before.at_s;
                (told_s - passed_s).abs() < SAME_CLOCK_S
            };
            let before = before.filter(goes_on).map(|before| before.message);
            self.move_hands(&heard.message, before.as_ref());
            self.follow(&heard.message, before.as_ref());
        }
    }

    fn move_hands(&mut self, now: &LeaderMessage, before: Option<&LeaderMessage>) {
        let over_s = before.map_or(0.0, |before| now.t_s - before.t_s);
        for (side, hand) in self.hands.iter_mut().enumerate() {
            match now.sides[side].zip(before.and_then(|before| before.sides[side])) {
                Some((now, before)) if [now.intent, before.intent] == [Intent::Follow; 2] => {
                    hand.told(&(now.tip_m - before.tip_m), over_s);
                }
                _ => hand.rest(),
            }
        }
    }

    /// The commands that follow from a message; `before`: the one before it. Without one nothing begins: only what both messages count
    /// differently was asked for in between.
    fn follow(&mut self, now: &LeaderMessage, before: Option<&LeaderMessage>) {
        if before.is_none_or(|before| before.mode != now.mode) {
            self.push(Command::SetMode(now.mode));
        }
        if before.is_none_or(|before| before.compares != now.compares) {
            self.push(Command::Compare(now.compares));
        }
        if before.is_none() || !self.learnt_ticks.is_some_and(|learnt| is_same_delay(learnt, now.delay_ticks)) {
            self.learnt_ticks = Some(now.delay_ticks);
            self.push(Command::SetDelay(f64::from(now.delay_ticks) / self.rate_hz));
        }
        let told = |side: Side| now.sides[side.index()].zip(before.and_then(|before| before.sides[side.index()]));
        let moved_on = |count: fn(&LeaderSide) -> u8, side: Side| {
            told(side).is_some_and(|(now, before)| count(&now) != count(&before))
        };
        let intents = now.sides.map(|side| side.map_or(Intent::Rest, |side| side.intent));
        let is_driven = |side: &Side| self.states[side.index()].is_some_and(|state| state.permits().drives);
        let is_latched = |side: &Side| self.states[side.index()].is_some_and(LoopState::is_latched);
        let to_stop = Side::ALL.iter().any(|side| intents[side.index()] == Intent::Stop && !is_latched(side));
        let to_rest = Side::ALL.iter().any(|side| intents[side.index()] == Intent::Rest && is_driven(side));
        let engaged = Side::ALL.map(|side| moved_on(|side| side.engagements, side));
        let released = Side::ALL.into_iter().any(|side| moved_on(|side| side.releases, side));
        if to_stop {
            self.push(Command::Stop);
        } else if released {
            self.push(Command::ReleaseStop);
        } else if to_rest {
            self.push(Command::Rest);
        }
        for side in Side::ALL {
            let intent = intents[side.index()];
            if engaged[side.index()] && matches!(intent, Intent::Hold | Intent::Follow) {
                self.push(Command::EngageOne(side));
            }
        }
    }

    fn push(&mut self, command: Command) {
        if let Some(free) = self.commands.iter_mut().find(|slot| slot.is_none()) {
            *free = Some(command);
        }
    }
}

impl<R: Rig, W: Wire> Rig for FarLeader<R, W> {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        self.inputs = self.local.read(now_s);
        self.receive(now_s);
        let heard = self.heard.filter(|heard| now_s - heard.at_s <= GONE_AFTER_S);
        let mut inputs = [None; SIDES];
        for side in Side::ALL.map(Side::index) {
            let told = heard.and_then(|heard| heard.message.sides[side]);
            self.hands[side].advance(1.0 / self.rate_hz);
            let hand_m = self.hands[side].at_m();
            inputs[side] = self.inputs[side].zip(told).map(|(here, told)| join(&here, &told, hand_m));
            if let (Some(inputs), Some(heard)) = (&mut inputs[side], heard) {
                inputs.silent_s = now_s - heard.at_s;
            }
        }
        inputs
    }

    fn command(&mut self) -> Option<Command> {
        self.commands.iter_mut().find_map(Option::take)
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        let without_force = |outputs: &Outputs| Outputs { hand_force_n: Vector3::zeros(), gripper_n: 0.0, ..*outputs };
        self.local.write(now_s, &outputs.each_ref().map(without_force));
    }

    fn hear(&mut self, now_s: f64, bulletins: &[Option<Bulletin<'_>>; SIDES]) {
        for (state, bulletin) in self.states.iter_mut().zip(bulletins) {
            *state = bulletin.as_ref().map(|bulletin| bulletin.state);
        }
        self.ticks += 1;
        let Some(heard) = self.heard.filter(|heard| now_s - heard.at_s <= ANSWERS_FOR_S) else { return };
        let turn = (self.ticks.is_multiple_of(PARAMETERS_EVERY)).then_some(self.ticks / PARAMETERS_EVERY);
        let tells_errors = self.ticks % ERRORS_EVERY == 1;
        // Since the command came it has grown older here.
        let t_s = heard.message.t_s + (now_s - heard.at_s);
        let mut message = FollowerMessage { t_s, sides: [None; SIDES] };
        for bulletin in bulletins.iter().flatten() {
            let side = bulletin.side.index();
            message.sides[side] = self.inputs[side].map(|inputs| answer(&inputs, bulletin, turn, tells_errors));
        }
        if let Some(bytes) = message.pack(&mut self.buffer) {
            self.wire.send(now_s, bytes);
        }
    }

    devices_of!(self, self.local);
}

pub(super) fn is_same_delay(learnt_ticks: u16, now_ticks: u16) -> bool {
    let learnt = f64::from(learnt_ticks);
    (f64::from(now_ticks) - learnt).abs() <= SAME_DELAY_TICKS.max(SAME_DELAY * learnt)
}

fn join(here: &Inputs, told: &LeaderSide, position_m: Vector3<f64>) -> Inputs {
    Inputs {
        hand: Hand { position_m, orientation: told.world_from_jaws },
        gripper_rad: told.gripper_rad,
        view: View::Fixed,
        // The follower moves only while the operator's pair is engaged; who holds the handle is judged there.
        switches: Switches { clutch: told.intent != Intent::Follow, presence: None },
        raw: RawReadings { handle: None, ..here.raw },
        ..*here
    }
}

fn answer(inputs: &Inputs, bulletin: &Bulletin<'_>, turn: Option<u64>, tells_errors: bool) -> FollowerSide {
    let parcel = bulletin.parcel;
    FollowerSide {
        tip_m: inputs.tip_m,
        world_from_jaws: inputs.world_from_jaws,
        grip_n: inputs.grip_n,
        powered: inputs.powered,
        is_obstructed: inputs.obstacle.is_some(),
        stop: FarStop::of(bulletin.state),
        source: bulletin.source,
        force_n: parcel.force_n,
        fresh: parcel.fresh && bulletin.source.is_known(),
        resting: parcel.resting,
        modes: parcel.modes,
        errors_n: tells_errors.then(|| bulletin.report.horizon_error_n.map(|error_n| error_n as f32)),
        packed: turn.and_then(|turn| Packed::of(parcel, turn as usize)),
    }
}
