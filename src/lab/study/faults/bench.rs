//! Test bench on the virtual clock: one world, the machine with the fault, and a fault-free twin that receives the true
//! measurements.

use nalgebra::Vector3;
use nima_core::impedance::Mode;
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, Fault, LoopState, Tick},
    rig::{Inputs, Outputs, SIDES, SensedForce, Side},
    teleop::{Calibrations, Loop, Timing},
};
use nima_simulation::scene::Scene;

use super::{
    FaultKind, FaultPart, FaultPlace, FaultsError, HARMLESS_N, SensorAt,
    impaired_link::{ImpairedLink, PacketImpairment},
    inject::{FAULTY, Faulty, force_of},
    subject::FaultSubject,
};
use crate::validation::experiment;

const PERIOD_S: f64 = 1e-3;
/// Timeout for reaching a situation of the task, ticks.
const TIMEOUT: u32 = 12_000;
/// Ticks before any fault is injected. By then the monitors of stuck values have seen noise and tremor.
const WARM_UP: u32 = 10_500;
/// Interval between the tested moments, ticks.
const APART: u32 = 1300;
/// Delay of the link in the simulated rig, ticks.
const LINK_TICKS: u32 = 50;
/// A difference of forces above this is visible, N.
const HINT_N: f64 = 0.05;
/// Positions closer than this are equal, m.
const NEAR_M: f64 = 5e-4;

#[derive(Clone, Debug)]
pub(super) struct FaultBench {
    pub(super) rig: Faulty,
    pub(super) machine: Loop<ImpairedLink>,
    pub(super) twin: Loop<ImpairedLink>,
    outputs: [Outputs; SIDES],
    tick: u32,
    fault: Option<(FaultKind, u32)>,
    twin_n: Vector3<f64>,
    tip_n: Vector3<f64>,
}

/// Result of one tick of machine and twin.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "independent observations of one tick")]
pub(super) struct BenchStep {
    pub(super) machine: Tick,
    pub(super) twin: Tick,
    /// Force that the twin commanded for this tick, N.
    pub(super) twin_before_n: Vector3<f64>,
    /// Force at the tip when it was commanded, computed by the twin from the true measurements, N.
    pub(super) tip_before_n: Vector3<f64>,
    /// Outputs that the rig received.
    pub(super) applied: Outputs,
    /// Outputs that the machine sent.
    pub(super) wanted: Outputs,
    /// Whether the loop's inputs or outputs differ from the truth.
    pub(super) shows: bool,
    /// Whether the loop's force input differs from the truth at all.
    pub(super) hints: bool,
    pub(super) raised: Option<Fault>,
    pub(super) refused: bool,
    pub(super) device_lost: bool,
}

impl FaultBench {
    /// Returns an idle rig with its force sensor at this place, in this mode.
    pub(super) fn new(sensor: SensorAt, mode: Mode, seed: u64) -> Result<Self, FaultsError> {
        let mut config = RigConfig::load("simulated")?;
        config.mode = mode;
        config.gates.static_hold = true;
        let scene = Scene::load(sensor.scene())?;
        let scene = Scene { seed: scene.seed + 1000 * seed, ..scene };
        let gravity = if sensor.is_at_wrist() { Some(experiment::gravity(1)?) } else { None };
        let known = Calibrations { gravity, ..Calibrations::default() };
        let machine = Loop::over(&config, &[Some(known), None], ImpairedLink::new)?;
        let rig = Faulty::new(FaultSubject::new(sensor, &config, &scene)?);
        let outputs = [Outputs::SAFE; SIDES];
        Ok(Self {
            rig,
            twin: machine.clone(),
            machine,
            outputs,
            tick: 0,
            fault: None,
            twin_n: Vector3::zeros(),
            tip_n: Vector3::zeros(),
        })
    }

    pub(super) fn begin(&mut self, fault: FaultKind) {
        self.rig.begin(fault);
        self.fault = Some((fault, self.tick));
        let impairment = match fault {
            FaultKind::LinkSilent => PacketImpairment::LosesAll,
            FaultKind::LinkHalf => PacketImpairment::LosesHalf,
            FaultKind::LinkLate => PacketImpairment::Late(0.1),
            FaultKind::LinkJitter => PacketImpairment::Late(0.003),
            FaultKind::LinkSwaps => PacketImpairment::Swaps,
            FaultKind::LinkDoubles => PacketImpairment::Doubles,
            FaultKind::LinkPoisoned => PacketImpairment::Poisons,
            FaultKind::LinkRepeats => PacketImpairment::Repeats,
            _ => PacketImpairment::None,
        };
        if let Some(link) = self.machine.link_mut(Side::Right) {
            link.impair(impairment);
        }
    }

    pub(super) fn obey(&mut self, command: Command) {
        let now_s = f64::from(self.tick) * PERIOD_S;
        self.machine.obey(command, now_s);
        self.twin.obey(command, now_s);
    }

    /// Returns the machine's timing, altered by the fault.
    fn timing(&self, now_s: f64) -> Timing {
        let honest = Timing { now_s, ..Timing::default() };
        let Some((fault, since)) = self.fault else { return honest };
        let since_s = f64::from(since) * PERIOD_S;
        let now_s = match fault {
            FaultKind::ClockForward => now_s + 1.0,
            FaultKind::ClockBackward => now_s - 1.0,
            FaultKind::ClockStops => since_s - PERIOD_S,
            FaultKind::ClockSlow => since_s - PERIOD_S + 0.5 * (now_s - since_s + PERIOD_S),
            FaultKind::ClockNan => f64::NAN,
            FaultKind::PeriodsMissed => now_s + 0.1,
            FaultKind::FewPeriodsMissed => now_s + 0.01,
            _ => now_s,
        };
        let missed_now = match fault {
            FaultKind::PeriodsMissed if self.tick == since => 100,
            FaultKind::FewPeriodsMissed if self.tick == since => 10,
            _ => 0,
        };
        Timing { now_s, missed_now, ..honest }
    }

    /// Sends the commands of a faulty screen in this tick.
    fn mischief(&mut self, now_s: f64) {
        match self.fault {
            Some((FaultKind::CommandsPoisoned, since)) if self.tick - since < 4 => {
                let bad = [Command::SetGain(f64::NAN), Command::SetDelay(-1.0), Command::SetScale(f64::INFINITY)];
                self.machine.obey(bad[(self.tick % 3) as usize], now_s);
                self.machine.obey(Command::SetGainAboveOne(1e9), now_s);
            }
            Some((FaultKind::CommandsDoubled, since)) if self.tick - since < 4 => {
                for _ in 0..2 {
                    self.machine.obey(Command::SetStaticHold(true), now_s);
                    self.machine.obey(Command::SetGain(1.0), now_s);
                }
            }
            Some((FaultKind::SliderShakes, _)) => {
                self.machine.obey(Command::SetGain(f64::from(self.tick % 2)), now_s);
            }
            _ => {}
        }
    }

    /// Runs one tick of world, machine and twin; `None` only if the rig has no right arm pair.
    pub(super) fn step(&mut self) -> Option<BenchStep> {
        let now_s = f64::from(self.tick) * PERIOD_S;
        let timing = self.timing(now_s);
        let wanted = self.outputs[FAULTY];
        self.rig.write(&self.outputs);
        let inputs = self.rig.read(now_s);
        let truth = self.rig.truth;
        let applied = self.rig.applied;
        let mut device_lost = false;
        self.machine.clear_events();
        while let Some(event) = self.rig.event() {
            self.machine.notice(&event);
            device_lost = true;
        }
        self.mischief(timing.now_s);
        let (outputs, ticks) = self.machine.step(inputs, &timing);
        self.outputs = outputs;
        self.twin.clear_events();
        let (twin_outputs, twins) = self.twin.step(truth, &Timing { now_s, ..Timing::default() });
        let tip_n = twins[FAULTY].map_or_else(Vector3::zeros, |tick| tick.measured_n);
        let tip_before_n = std::mem::replace(&mut self.tip_n, tip_n);
        let twin_before_n = std::mem::replace(&mut self.twin_n, twin_outputs[FAULTY].hand_force_n);
        self.tick += 1;
        let raised = self.machine.events().find_map(|event| match event {
            Event::FaultRaised { fault, .. } => Some(*fault),
            _ => None,
        });
        let given = inputs[FAULTY];
        let truth = truth[FAULTY];
        Some(BenchStep {
            machine: ticks[FAULTY]?,
            twin: twins[FAULTY]?,
            twin_before_n,
            tip_before_n,
            applied,
            wanted,
            shows: self.is_elsewhere() || differs(given.as_ref(), truth.as_ref()) || altered(&wanted, &applied),
            hints: force_apart_n(given.as_ref(), truth.as_ref()) > HINT_N,
            raised,
            refused: self.machine.events().any(|event| matches!(event, Event::CommandRefused { .. })),
            device_lost,
        })
    }

    /// Returns whether the fault is outside the rig and has taken effect: packets that a link loses or corrupts are
    /// missed only when they are due.
    fn is_elsewhere(&self) -> bool {
        let Some((fault, since)) = self.fault else { return false };
        match fault.part() {
            FaultPart::Clock | FaultPart::Commands => true,
            FaultPart::Link => {
                matches!(fault, FaultKind::LinkLate | FaultKind::LinkJitter) || self.tick > since + LINK_TICKS
            }
            _ => false,
        }
    }

    /// Brings the bench into a situation; `moment` distinguishes cases in the same situation.
    pub(super) fn prepare(&mut self, place: FaultPlace, moment: u32) -> Result<(), FaultsError> {
        let engaged = !matches!(place, FaultPlace::Disconnected | FaultPlace::Idle | FaultPlace::Ready);
        if engaged {
            self.obey(Command::Engage);
        }
        self.run(WARM_UP + moment * APART);
        if engaged {
            let free = place == FaultPlace::Free;
            let mut patience = TIMEOUT;
            while !self.is_at(free) && patience > 0 {
                self.run(1);
                patience -= 1;
            }
        }
        match place {
            FaultPlace::Disconnected => self.without(30),
            FaultPlace::Ready => {
                self.rig.situation.powered = false;
                self.obey(Command::Engage);
                self.run(20);
            }
            FaultPlace::Clutched => {
                self.rig.situation.clutch = true;
                self.run(20);
            }
            FaultPlace::Stopped => {
                self.obey(Command::Stop);
                self.run(5);
            }
            FaultPlace::Faulted => {
                self.without(30);
                self.rig.situation.connected = true;
                self.run(5);
            }
            FaultPlace::Idle | FaultPlace::Free | FaultPlace::Contact => {}
        }
        let reached = self.state();
        if place.is(reached) {
            Ok(())
        } else {
            Err(FaultsError::NotReached { place: place.word(), state: format!("{reached:?}") })
        }
    }

    /// Returns whether the tip is well above the tissue (`free`), or well in it.
    fn is_at(&self, free: bool) -> bool {
        let tip_z_m = self.rig.truth[FAULTY].map_or(0.0, |seen| seen.tip_m.z);
        if free { tip_z_m > 0.008 } else { tip_z_m < -0.005 }
    }

    fn without(&mut self, ticks: u32) {
        self.rig.situation.connected = false;
        self.run(ticks);
    }

    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.step();
        }
    }

    /// Returns the force that the machine commands now, N.
    pub(super) fn wanted_n(&self) -> Vector3<f64> {
        self.outputs[FAULTY].hand_force_n
    }

    pub(super) fn state(&self) -> LoopState {
        self.machine.pair(Side::Right).map_or(LoopState::Idle, nima_machine::teleop::Pair::state)
    }
}

/// Returns the difference between the force given to the loop and the measured one, N.
fn force_apart_n(given: Option<&Inputs>, truth: Option<&Inputs>) -> f64 {
    let apart = |(given, truth): (&Inputs, &Inputs)| (force_of(&given.sensed) - force_of(&truth.sensed)).norm();
    given.zip(truth).map_or(0.0, apart)
}

/// Returns whether the loop's inputs differ from the measurements.
fn differs(given: Option<&Inputs>, truth: Option<&Inputs>) -> bool {
    let (Some(given), Some(truth)) = (given, truth) else { return given.is_some() != truth.is_some() };
    let force_n = force_apart_n(Some(given), Some(truth));
    let hand_m = (given.hand.position_m - truth.hand.position_m).norm();
    let tip_m = (given.tip_m - truth.tip_m).norm();
    let turned = match (&given.sensed, &truth.sensed) {
        (SensedForce::AtWrist(given), SensedForce::AtWrist(truth)) => {
            given.world_from_s1 != truth.world_from_s1
                || match (given.acceleration_m_s2, truth.acceleration_m_s2) {
                    (Some(given), Some(truth)) => (given - truth).norm() > 0.2 || given.sum().is_nan(),
                    (given, truth) => given.is_some() != truth.is_some(),
                }
        }
        _ => false,
    };
    let near = force_n <= HARMLESS_N && hand_m <= NEAR_M && tip_m <= NEAR_M;
    !near || turned || given.switches != truth.switches || given.powered != truth.powered || given.age_s > truth.age_s
}

/// Returns whether the rig's outputs differ from the loop's commands.
fn altered(wanted: &Outputs, applied: &Outputs) -> bool {
    let apart_m = match (wanted.tip_command_m, applied.tip_command_m) {
        (Some(wanted), Some(applied)) => (wanted - applied).norm(),
        (None, None) => 0.0,
        _ => f64::INFINITY,
    };
    apart_m > NEAR_M || (wanted.hand_force_n - applied.hand_force_n).norm() > HARMLESS_N
}
