//! Injects faults between a rig and the loop: from a given tick on, the loop's inputs and the rig's outputs are
//! altered.

use std::collections::VecDeque;

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::noise::Noise;
use nima_devices::{ConnectionState, Loss};
use nima_machine::rig::{DeviceEvent, Inputs, Outputs, RemoteIdentification, SIDES, SensedForce};

use super::{FaultKind, subject::FaultSubject};

/// Side whose devices fail.
pub(super) const FAULTY: usize = 0;
/// Delay of late data, ticks.
const LATE: usize = 50;

/// State of the devices that belongs to the situation and is not a fault.
#[derive(Clone, Copy, Debug)]
pub(super) struct InjectSituation {
    pub(super) connected: bool,
    pub(super) powered: bool,
    pub(super) clutch: bool,
}

impl InjectSituation {
    /// Returns these inputs in the situation; `None` if no device is connected.
    fn of(self, inputs: &Inputs) -> Option<Inputs> {
        let mut inputs = *inputs;
        inputs.powered &= self.powered;
        inputs.switches.clutch |= self.clutch;
        self.connected.then_some(inputs)
    }
}

/// Number of ticks in which a force falls to its noise.
const FALLS_IN: f64 = 3.0;

/// A rig with a fault inserted between it and the loop.
#[derive(Clone, Debug)]
pub(super) struct Faulty {
    rig: FaultSubject,
    pub(super) situation: InjectSituation,
    fault: Option<FaultKind>,
    /// Number of ticks since the fault began.
    age: u32,
    noise: Noise,
    first: Option<(Inputs, Outputs)>,
    before: Option<Inputs>,
    late: VecDeque<Inputs>,
    /// The repeated block.
    block: Vec<Inputs>,
    event: Option<DeviceEvent>,
    /// Last measurements of the rig, before the fault is applied.
    pub(super) truth: [Option<Inputs>; SIDES],
    wanted: [Outputs; SIDES],
    /// The outputs that the rig last received.
    pub(super) applied: Outputs,
}

impl Faulty {
    pub(super) fn new(rig: FaultSubject) -> Self {
        Self {
            rig,
            situation: InjectSituation { connected: true, powered: true, clutch: false },
            fault: None,
            age: 0,
            noise: Noise::new(99),
            first: None,
            before: None,
            late: VecDeque::new(),
            block: Vec::new(),
            event: None,
            truth: [None; SIDES],
            wanted: [Outputs::SAFE; SIDES],
            applied: Outputs::SAFE,
        }
    }

    /// Applies this fault from the next tick on, also to the outputs already written.
    pub(super) fn begin(&mut self, fault: FaultKind) {
        self.fault = Some(fault);
        self.age = 0;
        self.first = None;
        self.before = None;
        self.late.clear();
        self.block.clear();
        self.rig.begin();
    }

    fn for_rig(&self, mut outputs: Outputs) -> Outputs {
        match self.fault {
            Some(FaultKind::HandleWithoutForce) => outputs.hand_force_n = Vector3::zeros(),
            Some(FaultKind::HandleInverted) => outputs.hand_force_n = -outputs.hand_force_n,
            // Even with this fault, the motors obey the drive switch.
            Some(FaultKind::HandleKeepsForce) if outputs.drives => {
                outputs.hand_force_n = self.first.map_or(outputs, |(_, first)| first).hand_force_n;
            }
            Some(FaultKind::ArmIgnores) => {
                let stays_m = self.first.map(|(first, _)| first.tip_m);
                outputs.tip_command_m = outputs.tip_command_m.map(|command_m| stays_m.unwrap_or(command_m));
            }
            Some(FaultKind::ArmAxes) => outputs.tip_command_m = outputs.tip_command_m.map(exchanged),
            _ => {}
        }
        outputs
    }

    fn for_loop(&mut self, inputs: &Inputs, outputs: &Outputs) -> Option<Inputs> {
        let inputs = *inputs;
        let Some(fault) = self.fault else { return Some(inputs) };
        self.age += 1;
        let (first, _) = *self.first.get_or_insert((inputs, *outputs));
        self.late.push_back(inputs);
        let late = if self.late.len() > LATE { self.late.pop_front() } else { self.late.front().copied() };
        let before = self.before.replace(inputs).unwrap_or(inputs);
        match fault {
            FaultKind::ForceSilent => None,
            FaultKind::ForceGaps => (self.age.is_multiple_of(2)).then_some(inputs),
            FaultKind::ForceFrozen => Some(Inputs { sensed: first.sensed, ..inputs }),
            FaultKind::ForceLate => Some(Inputs { sensed: late.unwrap_or(inputs).sensed, ..inputs }),
            FaultKind::ForceLateTold => Some(Inputs { age_s: 0.015, ..inputs }),
            FaultKind::ForceDoubled => {
                let sensed = if self.age.is_multiple_of(2) { before.sensed } else { inputs.sensed };
                Some(Inputs { sensed, ..inputs })
            }
            FaultKind::ForceReordered => Some(Inputs { sensed: self.reordered(&inputs, &before), ..inputs }),
            FaultKind::HandLate => Some(Inputs { hand: late.unwrap_or(inputs).hand, ..inputs }),
            FaultKind::HandFrozen => Some(Inputs { hand: first.hand, ..inputs }),
            FaultKind::TipFrozen => Some(Inputs { tip_m: first.tip_m, ..inputs }),
            FaultKind::ForceBlock => Some(Inputs { sensed: self.again(&inputs).sensed, ..inputs }),
            FaultKind::HandBlock => Some(Inputs { hand: self.again(&inputs).hand, ..inputs }),
            FaultKind::TipBlock => Some(Inputs { tip_m: self.again(&inputs).tip_m, ..inputs }),
            FaultKind::DrivesOff => Some(Inputs { powered: false, ..inputs }),
            _ => Some(self.edited(fault, inputs, &first)),
        }
    }

    /// Repeats the block that was recorded first.
    fn again(&mut self, inputs: &Inputs) -> Inputs {
        let place = self.age as usize - 1;
        if place < FaultKind::BLOCK {
            self.block.push(*inputs);
        }
        self.block.get(place % FaultKind::BLOCK).copied().unwrap_or(*inputs)
    }

    /// Swaps neighbouring samples: returns the current sample and the one before the previous in turn.
    fn reordered(&self, inputs: &Inputs, before: &Inputs) -> SensedForce {
        let two_ago = self.late.iter().rev().nth(2).unwrap_or(before);
        match self.age % 2 {
            0 => inputs.sensed,
            _ => two_ago.sensed,
        }
    }

    fn edited(&mut self, fault: FaultKind, mut inputs: Inputs, first: &Inputs) -> Inputs {
        let since_s = f64::from(self.age) * 1e-3;
        let white = |noise: &mut Noise, sigma: f64| Vector3::from_fn(|_, _| sigma * noise.gaussian());
        match fault {
            FaultKind::HandJump => inputs.hand.position_m.x += 0.02,
            FaultKind::HandSpike if self.age == 1 => inputs.hand.position_m.x += 0.02,
            FaultKind::HandSign => inputs.hand.position_m = -inputs.hand.position_m,
            FaultKind::HandAxes => inputs.hand.position_m = exchanged(inputs.hand.position_m),
            FaultKind::HandNan => inputs.hand.position_m.y = f64::NAN,
            FaultKind::HandNoise => inputs.hand.position_m += white(&mut self.noise, 3e-4),
            FaultKind::HandDrift => inputs.hand.position_m.x += 0.005 * since_s,
            FaultKind::TipJump => inputs.tip_m.z += 0.01,
            FaultKind::TipDrift => inputs.tip_m.x += 0.005 * since_s,
            FaultKind::TipSign => inputs.tip_m = -inputs.tip_m,
            FaultKind::TipNan => inputs.tip_m.z = f64::NAN,
            FaultKind::PedalDown => inputs.switches.clutch = true,
            FaultKind::PedalUp => inputs.switches.clutch = false,
            FaultKind::PedalBounces => inputs.switches.clutch = (self.age / 20).is_multiple_of(2),
            FaultKind::HandAbsent => inputs.switches.presence = Some(false),
            FaultKind::ImuStops
            | FaultKind::ImuFrozen
            | FaultKind::ImuSign
            | FaultKind::ImuNan
            | FaultKind::ImuDead => {
                turn_imu(fault, &mut inputs.sensed, first);
            }
            FaultKind::OrientationMissing | FaultKind::OrientationJump => turn_arm(fault, &mut inputs.sensed),
            _ => {
                let now = force_of(&inputs.sensed);
                let then = force_of(&first.sensed);
                let bad_n = self.bad_force(fault, now, &then, since_s);
                set_force(&mut inputs.sensed, bad_n);
            }
        }
        inputs
    }

    fn bad_force(&mut self, fault: FaultKind, now: Vector3<f64>, then: &Vector3<f64>, since_s: f64) -> Vector3<f64> {
        let down = -Vector3::z();
        match fault {
            FaultKind::ForceAxisFrozen => Vector3::new(now.x, now.y, then.z),
            FaultKind::ForceDead => Vector3::zeros(),
            FaultKind::ForceFalls => {
                let left = (1.0 - f64::from(self.age) / FALLS_IN).max(0.0);
                then * left + Vector3::from_fn(|_, _| 0.02 * self.noise.gaussian())
            }
            FaultKind::ForceStep => now + down * 1.5,
            FaultKind::ForceSmallStep => now + down * 0.3,
            FaultKind::ForceDrift => now + down * (0.5 * since_s),
            FaultKind::ForceSlowDrift => now + down * (0.05 * since_s),
            FaultKind::ForceSign => -now,
            FaultKind::ForceAxes => exchanged(now),
            FaultKind::ForceSpike if self.age == 1 => now + down * 10.0,
            FaultKind::ForceSpikes if self.age % 50 == 1 => now + down * 10.0,
            FaultKind::ForceSaturated => now.zip_map(then, |now, then| now.clamp(then - 1.0, then + 1.0)),
            FaultKind::ForceNoise => now + Vector3::from_fn(|_, _| 0.4 * self.noise.gaussian()),
            FaultKind::ForceNan => Vector3::new(now.x, f64::NAN, now.z),
            FaultKind::ForceInfinite => Vector3::new(now.x, now.y, f64::INFINITY),
            FaultKind::ForceAbsurd => now + down * 1e18,
            FaultKind::ForceGain => now * 2.0,
            _ => now,
        }
    }
}

impl Faulty {
    pub(super) fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let mut to_rig = self.wanted;
        to_rig[FAULTY] = self.for_rig(self.wanted[FAULTY]);
        self.applied = to_rig[FAULTY];
        let situation = self.situation;
        let (mut inputs, seen) = self.rig.read(now_s, &to_rig, &self.wanted[FAULTY]);
        inputs[FAULTY] = inputs[FAULTY].and_then(|seen| situation.of(&seen));
        self.truth = inputs;
        let seen = seen.and_then(|seen| situation.of(&seen));
        let altered = seen.and_then(|seen| self.for_loop(&seen, &to_rig[FAULTY]));
        let given = self.rig.give(now_s, altered.as_ref(), self.fault, self.age);
        inputs[FAULTY] = given.filter(|_| situation.connected);
        if let (Some(given), true) = (&mut inputs[FAULTY], self.rig.is_arm()) {
            given.powered &= situation.powered;
            given.switches.clutch |= situation.clutch;
        }
        if self.fault == Some(FaultKind::ForceLost) {
            if self.age == 1 {
                let standing = ConnectionState::Lost(Loss::Disconnected);
                self.event = Some(DeviceEvent { t_s: now_s, device: 2, standing, of_side: [true, false] });
            }
            inputs[FAULTY] = None;
        }
        inputs
    }

    pub(super) const fn write(&mut self, outputs: &[Outputs; SIDES]) {
        self.wanted = *outputs;
    }

    pub(super) const fn event(&mut self) -> Option<DeviceEvent> {
        self.event.take()
    }
}

/// Swaps x and z.
fn exchanged(v: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(v.z, v.y, v.x)
}

/// Returns the force read by the force sensor, N.
pub(super) fn force_of(sensed: &SensedForce) -> Vector3<f64> {
    match sensed {
        SensedForce::AtTip(force_n) | SensedForce::FarEnd(RemoteIdentification { force_n, .. }) => *force_n,
        SensedForce::AtWrist(sample) => sample.raw.force_n,
    }
}

fn set_force(sensed: &mut SensedForce, force_n: Vector3<f64>) {
    match sensed {
        SensedForce::AtTip(at) | SensedForce::FarEnd(RemoteIdentification { force_n: at, .. }) => *at = force_n,
        SensedForce::AtWrist(sample) => sample.raw.force_n = force_n,
    }
}

fn turn_imu(fault: FaultKind, sensed: &mut SensedForce, first: &Inputs) {
    let (SensedForce::AtWrist(sample), SensedForce::AtWrist(then)) = (sensed, &first.sensed) else { return };
    sample.acceleration_m_s2 = match fault {
        FaultKind::ImuStops => None,
        FaultKind::ImuFrozen => then.acceleration_m_s2,
        FaultKind::ImuSign => sample.acceleration_m_s2.map(|a| -a),
        FaultKind::ImuNan => Some(Vector3::repeat(f64::NAN)),
        _ => Some(Vector3::zeros()),
    };
}

fn turn_arm(fault: FaultKind, sensed: &mut SensedForce) {
    let SensedForce::AtWrist(sample) = sensed else { return };
    let quarter = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    sample.world_from_s1 =
        sample.world_from_s1.filter(|_| fault == FaultKind::OrientationJump).map(|turn| turn * quarter);
}
