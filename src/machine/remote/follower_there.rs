//! The follower's half at another machine, as the operator's machine represents it.

use nima_core::{
    calibration::frames::FrameSample,
    impedance::{Mode, ParameterPack},
    safety::RawReadings,
};

use super::{
    GONE_AFTER_S, HalfThere, RemoteWire,
    follower_message::{FollowerMessage, FollowerSide},
    leader_message::{Intent, LeaderMessage, LeaderSide},
};
use crate::{
    messages::{LoopState, PeerStatus},
    rig::{
        EngageBlocker, Inputs, Outputs, PlannedTip, RemoteIdentification, SIDES, SensedForce, Side, ViewOrientation,
    },
};

#[derive(Debug)]
pub struct FollowerThere {
    rate_hz: f64,
    received: Option<PeerState>,
    sides: [SideStatus; SIDES],
}

#[derive(Clone, Copy, Debug)]
struct PeerState {
    message: FollowerMessage,
    /// Playout time of the message, s.
    at_s: f64,
    delay: RoundTrip,
}

/// State of one side that this machine sends.
#[derive(Clone, Copy, Debug, Default)]
struct SideStatus {
    state: Option<LoopState>,
    engagements: u8,
    /// Opening of the gripper at its last reading, rad.
    gripper_rad: Option<f64>,
    outputs: Option<Outputs>,
}

/// Time from a command to its answer, in whole ticks. The playout delay keeps it constant except for slow changes.
#[derive(Clone, Copy, Debug)]
struct RoundTrip {
    mean_s: f64,
    ticks: u16,
}

impl RoundTrip {
    /// Averaging, in messages. Design choice.
    /// 200 messages: a fifth of a second at 1 kHz.
    const MEMORY: f64 = 200.0;

    fn first(seconds: f64, rate_hz: f64) -> Self {
        Self { mean_s: seconds, ticks: (seconds * rate_hz).round() as u16 }
    }

    /// Changes by whole ticks, and only when the mean is clearly nearer to another tick: each change makes the follower
    /// restart its evaluation of the past.
    fn step(&mut self, seconds: f64, rate_hz: f64) {
        self.mean_s += (seconds - self.mean_s) / Self::MEMORY;
        let ticks = self.mean_s * rate_hz;
        // Half a tick would be the nearest one, but jitter would then switch between two values.
        if (ticks - f64::from(self.ticks)).abs() > 0.75 {
            self.ticks = ticks.round() as u16;
        }
    }
}

impl FollowerThere {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self { rate_hz, received: None, sides: [SideStatus::default(); SIDES] }
    }

    fn join_side(&self, side: Side, here: &Inputs, now_s: f64) -> Option<Inputs> {
        let received = self.received.as_ref()?;
        let far = received.message.sides[side.index()]?;
        let identified = RemoteIdentification {
            t_s: received.message.t_s,
            delay_s: f64::from(received.delay.ticks) / self.rate_hz,
            force_n: far.force_n,
            source: far.source,
            fresh: far.fresh,
            resting: far.resting,
            modes: far.modes,
            packed: far.packed.unwrap_or(ParameterPack::NONE),
            errors_n: far.errors_n,
            stop: far.stop,
        };
        Some(Inputs {
            hand: here.hand,
            gripper_rad: here.gripper_rad,
            grip_n: far.grip_n,
            tip_m: far.tip_m,
            planned: PlannedTip::default(),
            world_from_jaws: far.world_from_jaws,
            sensed: SensedForce::FarEnd(identified),
            // No view crosses the link, so the mapping of the rig file applies.
            view: ViewOrientation::Fixed,
            frames: FrameSample { leader_from_handle: here.frames.leader_from_handle, ..FrameSample::default() },
            switches: here.switches,
            // Both ends may switch drives off: the handle here and the arm there.
            powered: here.powered && far.powered,
            obstacle: far.is_obstructed.then_some(EngageBlocker::FarEnd),
            age_s: here.age_s,
            silent_s: now_s - received.at_s,
            // The other machine checks its devices for plausibility itself.
            raw: RawReadings { handle: here.raw.handle, ..RawReadings::NONE },
        })
    }
}

fn keep_parameters(now: &mut [Option<FollowerSide>; SIDES], before: &[Option<FollowerSide>; SIDES]) {
    for (now, before) in now.iter_mut().zip(before) {
        if let (Some(now), Some(before)) = (now, before) {
            now.packed = now.packed.or(before.packed);
            // The newest message may omit what the previous one of the same tick contained: parameters take turns.
            now.errors_n = now.errors_n.or(before.errors_n);
        }
    }
}

impl HalfThere for FollowerThere {
    fn receive(&mut self, now_s: f64, wire: &mut dyn RemoteWire) {
        let received = &mut self.received;
        let rate_hz = self.rate_hz;
        wire.receive(now_s, &mut |bytes| {
            let Some(mut message) = FollowerMessage::unpack(bytes) else { return };
            let round_trip_s = now_s - message.t_s;
            // An echo of a command that was not sent yet: it answers an earlier run of this console.
            if round_trip_s < 0.0 {
                return;
            }
            let Some(last) = received else {
                *received = Some(PeerState { message, at_s: now_s, delay: RoundTrip::first(round_trip_s, rate_hz) });
                return;
            };
            // Datagrams may overtake each other; the older state must not return.
            if message.t_s <= last.message.t_s {
                return;
            }
            // Two messages may arrive in one tick: keep the parameters of the first.
            if last.at_s >= now_s {
                keep_parameters(&mut message.sides, &last.message.sides);
            }
            last.message = message;
            last.at_s = now_s;
            last.delay.step(round_trip_s, rate_hz);
        });
        if self.received.is_some_and(|received| now_s - received.at_s > GONE_AFTER_S) {
            self.received = None;
        }
    }

    fn join(&mut self, here: &[Option<Inputs>; SIDES], now_s: f64) -> [Option<Inputs>; SIDES] {
        let mut inputs = [None; SIDES];
        for side in Side::ALL {
            let Some(here) = &here[side.index()] else { continue };
            self.sides[side.index()].gripper_rad = here.gripper_rad;
            inputs[side.index()] = self.join_side(side, here, now_s);
        }
        inputs
    }

    fn outputs(&mut self, outputs: &[Outputs; SIDES]) -> [Outputs; SIDES] {
        for (report, outputs) in self.sides.iter_mut().zip(outputs) {
            report.outputs = Some(*outputs);
        }
        *outputs
    }

    fn report<'a>(
        &mut self,
        now_s: f64,
        _here: &[Option<Inputs>; SIDES],
        bulletins: &[Option<PeerStatus<'_>>; SIDES],
        buffer: &'a mut [u8],
    ) -> Option<&'a [u8]> {
        let mut message =
            LeaderMessage { t_s: now_s, delay_ticks: 0, mode: Mode::Dfr, compares: false, sides: [None; SIDES] };
        message.delay_ticks = self.received.map_or(0, |received| received.delay.ticks);
        for bulletin in bulletins.iter().flatten() {
            let side = bulletin.side.index();
            message.mode = bulletin.mode;
            message.compares = bulletin.compares;
            let far = self.received.and_then(|received| received.message.sides[side]);
            message.sides[side] = Some(self.sides[side].report(bulletin, far.as_ref()));
        }
        message.pack(buffer)
    }
}

impl SideStatus {
    fn report(&mut self, bulletin: &PeerStatus<'_>, far: Option<&FollowerSide>) -> LeaderSide {
        let was_driven = self.state.is_some_and(|state| state.permits().drives);
        if bulletin.state.permits().drives && !was_driven {
            // A count instead of a flag: a message that is lost or repeated then neither loses nor repeats the command.
            self.engagements = self.engagements.wrapping_add(1);
        }
        self.state = Some(bulletin.state);
        let commanded = self.outputs.and_then(|outputs| outputs.tip_command_m);
        let turned = self.outputs.and_then(|outputs| outputs.world_from_jaws);
        LeaderSide {
            intent: match bulletin.state {
                LoopState::Disconnected | LoopState::Idle => Intent::Rest,
                LoopState::Ready | LoopState::Clutched => Intent::Hold,
                LoopState::Engaged => Intent::Follow,
                LoopState::Stopped | LoopState::Faulted(_) => Intent::Stop,
            },
            engagements: self.engagements,
            releases: bulletin.releases,
            tip_m: commanded.or(far.map(|far| far.tip_m)).unwrap_or_default(),
            world_from_jaws: turned.or(far.and_then(|far| far.world_from_jaws)),
            gripper_rad: self.gripper_rad,
        }
    }
}
