//! The leader's half at another machine, as the follower's machine represents it: a hand that moves as commanded, and the
//! operator's commands.

use nalgebra::Vector3;
use nima_core::{
    impedance::ParameterPack,
    kinematics::HandPose,
    safety::{ChainSettings, RawReadings},
};

use super::{
    GONE_AFTER_S, HalfThere, RemoteWire,
    commanded_hand::CommandedHand,
    follower_message::{FollowerMessage, FollowerSide},
    leader_message::{Intent, LeaderMessage, LeaderSide},
};
use crate::{
    config::{RigConfig, Teleoperation},
    messages::{Command, FarStop, LoopState, PeerStatus},
    rig::{Inputs, Outputs, SIDES, Side, Switches, ViewOrientation},
};

/// The parameters of one rendering are sent once per this many ticks, in turn if several are computed. Fits are renewed
/// 200 times per second.
/// At 1 kHz every 10 ms: sending them more often would mostly repeat them.
const PARAMETERS_EVERY: u64 = 10;
/// The errors of the modes are sent once per this many ticks: they are only displayed, and nothing depends on them.
/// Ten times a second, as fast as the screen shows them.
const ERRORS_EVERY: u64 = 100;
/// Answers continue for this long after the last message, s, so that the reason for this machine's stop reaches the other one.
const ANSWERS_FOR_S: f64 = 1.0;
/// Two messages come from one loop if their time difference equals the time that passed here, within this tolerance, s.
const SAME_CLOCK_S: f64 = 0.2;
/// The identification learns for a specific delay, and restarts when the delay changes. It keeps its delay while the
/// true delay differs by at most this fraction, or this number of ticks: a connection with jitter changes the delay by
/// a tick every second.
const SAME_DELAY: f64 = 0.05;
// Two ticks: the rounding at both ends.
const SAME_DELAY_TICKS: f64 = 2.0;
/// Maximum number of commands from one message.
/// More than `follow` can push for two sides: mode, comparison, delay, a stop, and one engagement each.
const COMMANDS_MAX: usize = 8;

/// Returns the rig file adapted to the follower's machine: the commanded tip is already in the frame of the world, and
/// no hand here feels a force.
#[must_use]
pub fn at_follower(rig: &RigConfig) -> RigConfig {
    // No gain: the force for the hand is rendered at the other machine, behind its gates.
    let gates = ChainSettings { gain: 0.0, ..rig.gates.without_governor() };
    RigConfig { teleoperation: Teleoperation::default(), gates, ..rig.clone() }
}

#[derive(Debug)]
pub struct LeaderThere {
    rate_hz: f64,
    received: Option<OperatorState>,
    hands: [CommandedHand; SIDES],
    states: [Option<LoopState>; SIDES],
    commands: [Option<Command>; COMMANDS_MAX],
    /// Delay over which the identification here learns, ticks.
    learnt_ticks: Option<u16>,
    ticks: u64,
}

/// The last message of the operator's machine.
#[derive(Clone, Copy, Debug)]
struct OperatorState {
    message: LeaderMessage,
    /// Time of its playout, s.
    at_s: f64,
}

impl LeaderThere {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            received: None,
            hands: [CommandedHand::default(); SIDES],
            states: [None; SIDES],
            commands: [None; COMMANDS_MAX],
            learnt_ticks: None,
            ticks: 0,
        }
    }

    fn move_hands(&mut self, now: &LeaderMessage, before: Option<&LeaderMessage>) {
        let over_s = before.map_or(0.0, |before| now.t_s - before.t_s);
        for (side, hand) in self.hands.iter_mut().enumerate() {
            match now.sides[side].zip(before.and_then(|before| before.sides[side])) {
                // Only if both messages command following; otherwise the difference is not a motion of the hand.
                Some((now, before)) if [now.intent, before.intent] == [Intent::Follow; 2] => {
                    hand.report(&(now.tip_m - before.tip_m), over_s);
                }
                _ => hand.rest(),
            }
        }
    }

    /// Derives the commands from a message; `before`: the previous message. Without a previous message no command
    /// follows, because only counts that differ between both messages are commands.
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
        let report = |side: Side| now.sides[side.index()].zip(before.and_then(|before| before.sides[side.index()]));
        let moved_on = |count: fn(&LeaderSide) -> u8, side: Side| {
            report(side).is_some_and(|(now, before)| count(&now) != count(&before))
        };
        let intents = now.sides.map(|side| side.map_or(Intent::Rest, |side| side.intent));
        let is_driven = |side: &Side| self.states[side.index()].is_some_and(|state| state.permits().drives);
        let is_latched = |side: &Side| self.states[side.index()].is_some_and(LoopState::is_latched);
        let to_stop = Side::ALL.iter().any(|side| intents[side.index()] == Intent::Stop && !is_latched(side));
        let to_rest = Side::ALL.iter().any(|side| intents[side.index()] == Intent::Rest && is_driven(side));
        let engaged = Side::ALL.map(|side| moved_on(|side| side.engagements, side));
        let released = Side::ALL.into_iter().any(|side| moved_on(|side| side.releases, side));
        // A stop precedes a release in the same message: the safe state wins.
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

impl HalfThere for LeaderThere {
    fn receive(&mut self, now_s: f64, wire: &mut dyn RemoteWire) {
        let before = self.received.filter(|received| now_s - received.at_s <= ANSWERS_FOR_S);
        let mut newest = before;
        wire.receive(now_s, &mut |bytes| {
            let Some(message) = LeaderMessage::unpack(bytes) else { return };
            // Newer only: an overtaken message must not bring back an old command.
            if newest.is_none_or(|received| message.t_s > received.message.t_s) {
                newest = Some(OperatorState { message, at_s: now_s });
            }
        });
        self.received = newest;
        self.commands = [None; COMMANDS_MAX];
        if let Some(received) = newest.filter(|received| received.at_s >= now_s) {
            // A different or restarted console has a different clock and different counters; in that case no command
            // was given in between.
            let goes_on = |before: &OperatorState| {
                let reported_s = received.message.t_s - before.message.t_s;
                let passed_s = received.at_s - before.at_s;
                (reported_s - passed_s).abs() < SAME_CLOCK_S
            };
            let before = before.filter(goes_on).map(|before| before.message);
            self.move_hands(&received.message, before.as_ref());
            self.follow(&received.message, before.as_ref());
        }
    }

    fn join(&mut self, here: &[Option<Inputs>; SIDES], now_s: f64) -> [Option<Inputs>; SIDES] {
        let received = self.received.filter(|received| now_s - received.at_s <= GONE_AFTER_S);
        let mut inputs = [None; SIDES];
        for side in Side::ALL.map(Side::index) {
            let report = received.and_then(|received| received.message.sides[side]);
            self.hands[side].advance(1.0 / self.rate_hz);
            let hand_m = self.hands[side].position_m();
            inputs[side] = here[side].zip(report).map(|(here, report)| join_side(&here, &report, hand_m));
            if let (Some(inputs), Some(received)) = (&mut inputs[side], received) {
                inputs.silent_s = now_s - received.at_s;
            }
        }
        inputs
    }

    fn command(&mut self) -> Option<Command> {
        self.commands.iter_mut().find_map(Option::take)
    }

    fn outputs(&mut self, outputs: &[Outputs; SIDES]) -> [Outputs; SIDES] {
        // The handle is at the other machine.
        outputs.each_ref().map(|outputs| Outputs { hand_force_n: Vector3::zeros(), gripper_n: 0.0, ..*outputs })
    }

    fn report<'a>(
        &mut self,
        now_s: f64,
        here: &[Option<Inputs>; SIDES],
        bulletins: &[Option<PeerStatus<'_>>; SIDES],
        buffer: &'a mut [u8],
    ) -> Option<&'a [u8]> {
        for (state, bulletin) in self.states.iter_mut().zip(bulletins) {
            *state = bulletin.as_ref().map(|bulletin| bulletin.state);
        }
        self.ticks += 1;
        let received = self.received.filter(|received| now_s - received.at_s <= ANSWERS_FOR_S)?;
        let turn = (self.ticks.is_multiple_of(PARAMETERS_EVERY)).then_some(self.ticks / PARAMETERS_EVERY);
        // Never in the same tick as the parameters (every tenth), so that a message stays short.
        let sends_errors = self.ticks % ERRORS_EVERY == 1;
        // Add the time that has passed here since the command arrived.
        let t_s = received.message.t_s + (now_s - received.at_s);
        let mut message = FollowerMessage { t_s, sides: [None; SIDES] };
        for bulletin in bulletins.iter().flatten() {
            let side = bulletin.side.index();
            message.sides[side] = here[side].map(|inputs| answer(&inputs, bulletin, turn, sends_errors));
        }
        message.pack(buffer)
    }
}

pub(super) fn is_same_delay(learnt_ticks: u16, now_ticks: u16) -> bool {
    let learnt = f64::from(learnt_ticks);
    (f64::from(now_ticks) - learnt).abs() <= SAME_DELAY_TICKS.max(SAME_DELAY * learnt)
}

fn join_side(here: &Inputs, report: &LeaderSide, position_m: Vector3<f64>) -> Inputs {
    Inputs {
        hand: HandPose { position_m, orientation: report.world_from_jaws },
        gripper_rad: report.gripper_rad,
        view: ViewOrientation::Fixed,
        // The follower moves only while the operator's pair is engaged; the presence of a hand is checked there.
        switches: Switches { clutch: report.intent != Intent::Follow, presence: None },
        raw: RawReadings { handle: None, ..here.raw },
        ..*here
    }
}

fn answer(inputs: &Inputs, bulletin: &PeerStatus<'_>, turn: Option<u64>, sends_errors: bool) -> FollowerSide {
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
        errors_n: sends_errors.then(|| bulletin.report.horizon_error_n.map(|error_n| error_n as f32)),
        packed: turn.and_then(|turn| ParameterPack::of(parcel, turn as usize)),
    }
}
