//! A loop with synthetic measurements, a person who follows the instructions, and the ready check.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_core::{
    calibration::{
        frames::{FrameSample, ViewMove},
        gravity::{GravityModel, GravityParameters, GravitySource},
    },
    frames::{GRAVITY_M_S2, Wrench, WristSample},
    kinematics::HandPose,
    noise::Noise,
};
use nima_devices::Health;

use crate::{
    config::RigConfig,
    messages::{Command, LoopState, Tick},
    ready::{CheckSubject, PersonRequest, ReadyArm, ReadyPoint, ReadySession, ReadyState},
    rig::{DEVICES_MAX, Gauge, Gauges, Healths, Inputs, RigPart, SensedForce, Side},
    runtime::STALL_MAX_S,
    teleop::{Calibrations, Loop, Timing},
};

pub(super) const SIDE: Side = Side::Right;
const TOOL_KG: f64 = 0.4;
/// Maximum duration of a test, ms.
const OVER_MS: u64 = 400_000;

/// Flaws of the rig or the person; none by default.
#[derive(Clone, Debug)]
pub(super) struct Flaws {
    pub(super) bias_n: Vector3<f64>,
    /// Measurement of a push by the sensor.
    pub(super) pushed: fn(Vector3<f64>) -> Vector3<f64>,
    /// Measurement of a move of the hand in the image by the handle.
    pub(super) moved: fn(Vector3<f64>) -> Vector3<f64>,
    /// Speed at which the handle moves by itself, m/s.
    pub(super) pulls_m_s: f64,
    pub(super) trocar_m: Vector3<f64>,
    pub(super) sensor_hz: u32,
    /// Number of damaged frames of the sensor at a time, s, since the start.
    pub(super) damaged: fn(f64) -> u64,
    /// One period in this many is missed.
    pub(super) missed_every: u64,
    pub(super) obeys: fn(&PersonRequest) -> bool,
    pub(super) supervised: bool,
    /// Nothing is measured while the arm is stopped.
    pub(super) silent_when_stopped: bool,
}

impl Default for Flaws {
    fn default() -> Self {
        Self {
            bias_n: Vector3::zeros(),
            pushed: |force_n| force_n,
            moved: |travel_m| travel_m,
            pulls_m_s: 0.0,
            trocar_m: Vector3::zeros(),
            sensor_hz: 1000,
            damaged: |_| 0,
            missed_every: u64::MAX,
            obeys: |_| true,
            supervised: true,
            silent_when_stopped: false,
        }
    }
}

fn gravity() -> GravityModel {
    let s1_from_source_wxyz = [1.0, 0.0, 0.0, 0.0];
    let parameters =
        GravityParameters::Physical { mass_kg: TOOL_KG, s1_from_source_wxyz, bias_n: [0.0; 3], torque: None };
    GravityModel { source: GravitySource::Imu, imu_sign: 1, parameters }
}

/// Returns the right arm of the emulated rig with a calibrated sensor.
pub(super) fn subject() -> CheckSubject {
    let mut rig = RigConfig::load("emulated").unwrap();
    rig.devices.as_mut().unwrap().left = None;
    let gates = rig.gates;
    let arm = ReadyArm { at_wrist: true, gravity: Some((gravity(), 0.2)), has_person: true };
    let parts = vec![Some(RigPart::Sensor(SIDE))];
    CheckSubject { rig, arms: [Some(arm), None], parts, gates_in_file: Some(gates), is_date_behind: false }
}

pub(super) struct Fixture {
    pub(super) session: ReadySession,
    pub(super) control: Loop,
    pub(super) flaws: Flaws,
    noise: Noise,
    ms: u64,
    readings: u64,
    silent_s: f64,
    is_out: bool,
    push_n: Vector3<f64>,
    handle_m: Vector3<f64>,
    pub(super) standing: Health,
}

impl Fixture {
    pub(super) fn new(subject: CheckSubject, flaws: Flaws) -> Self {
        let calibrations = Calibrations { gravity: Some(gravity()), ..Calibrations::default() };
        let mut standing = Health::default();
        standing.accept(0.0);
        Self {
            control: Loop::new(&subject.rig, &[Some(calibrations), None]).unwrap(),
            session: ReadySession::new(subject),
            flaws,
            noise: Noise::new(7),
            ms: 0,
            readings: 0,
            silent_s: 0.0,
            is_out: false,
            push_n: Vector3::zeros(),
            handle_m: Vector3::zeros(),
            standing,
        }
    }

    /// Runs the check on a rig with these flaws.
    pub(super) fn judged(flaws: Flaws) -> ReadySession {
        let mut bench = Self::new(subject(), flaws);
        bench.run();
        bench.session
    }

    pub(super) fn now_s(&self) -> f64 {
        self.ms as f64 * 1e-3
    }

    pub(super) fn run(&mut self) {
        while !self.session.is_finished() {
            assert!(self.ms < OVER_MS, "{:?}", self.session.list());
            self.step();
        }
    }

    pub(super) fn step(&mut self) {
        self.ms += 1;
        let missed_now = u64::from(self.ms.is_multiple_of(self.flaws.missed_every));
        self.ms += missed_now;
        self.tick(missed_now);
        if self.ms.is_multiple_of(10) {
            self.look();
        }
        if self.ms.is_multiple_of(100) {
            self.deliver();
        }
    }

    pub(super) fn some_tick(&mut self) -> Tick {
        let inputs = self.inputs();
        self.control.step([Some(inputs), None], &Timing::default()).1[0].unwrap()
    }

    fn tick(&mut self, missed_now: u64) {
        let now_s = self.now_s();
        self.handle_m.y += self.flaws.pulls_m_s * 1e-3;
        let is_stopped = self.control.pair(SIDE).is_some_and(|pair| pair.state() == LoopState::Stopped);
        let inputs = Some(self.inputs()).filter(|_| !(self.flaws.silent_when_stopped && is_stopped));
        self.control.clear_events();
        // Behaves like the supervisor.
        self.silent_s = if self.control.withholds_beat() && self.flaws.supervised { self.silent_s + 1e-3 } else { 0.0 };
        if self.silent_s > STALL_MAX_S {
            self.control.notice_stall(self.silent_s, now_s);
        }
        let timing = Timing { now_s, missed_now, ..Timing::default() };
        let (outputs, [tick, _]) = self.control.step([inputs, None], &timing);
        let tick = tick.unwrap();
        assert!(outputs[0].hand_force_n.norm() == 0.0 || tick.state == LoopState::Engaged, "{now_s} s: {outputs:?}");
        self.session.tick(&tick);
        self.control.events().for_each(|event| self.session.event(event));
    }

    fn look(&mut self) {
        let now_s = self.now_s();
        if let Some(command) = self.session.look(now_s) {
            self.control.obey(command, now_s);
            self.control.events().for_each(|event| self.session.event(event));
        }
        let ask = self.session.ask();
        self.push_n = Vector3::zeros();
        if !(self.flaws.obeys)(&ask) {
            return;
        }
        match ask {
            PersonRequest::Move(_) | PersonRequest::TakeOut(_) => self.is_out = true,
            PersonRequest::PutBack(_) => self.is_out = false,
            PersonRequest::Push(_, direction) => self.push_n = (self.flaws.pushed)(-2.0 * direction.into_inner()),
            PersonRequest::MoveHandle(_, way) => self.move_handle(way),
            PersonRequest::PressStop => self.control.obey(Command::Stop, now_s),
            PersonRequest::Release => self.control.obey(Command::ReleaseStop, now_s),
            PersonRequest::Nothing | PersonRequest::LeaveAlone(_) | PersonRequest::LetGo(_) => {}
        }
        self.control.events().for_each(|event| self.session.event(event));
    }

    /// Moves by 1 mm in 10 ms.
    fn move_handle(&mut self, way: ViewMove) {
        let leader_from_view = self.session.subject().rig.teleoperation.view_from_leader().inverse();
        self.handle_m += leader_from_view * (self.flaws.moved)(way.in_view() * 1e-3);
    }

    fn deliver(&mut self) {
        let mut healths = Healths::default();
        healths.devices[0] = self.standing;
        self.session.healths(&healths);
        let now_s = self.now_s();
        let mut gauge = Gauge::NONE;
        for _ in 0..self.flaws.sensor_hz / 10 {
            self.readings += 1;
            for channel in 0..9 {
                let mean = if channel == 8 { GRAVITY_M_S2 } else { 0.1 };
                gauge.channels[channel].add(mean + 1e-3 * self.noise.gaussian());
            }
        }
        gauge.ages[0] = 100;
        gauge.readings = self.readings;
        gauge.damaged = (self.flaws.damaged)(now_s);
        let mut gauges = Gauges { from_s: now_s - 0.1, to_s: now_s, devices: [Gauge::NONE; DEVICES_MAX] };
        gauges.devices[0] = gauge;
        self.session.gauges(&gauges);
    }

    fn inputs(&mut self) -> Inputs {
        let noise_n = Vector3::from_fn(|_, _| 0.01 * self.noise.gaussian());
        let weight_n = Vector3::new(0.0, 0.0, -TOOL_KG * GRAVITY_M_S2);
        let force_n = weight_n + noise_n + self.flaws.bias_n + self.push_n;
        let wrench = Wrench { force_n, torque_nm: Vector3::zeros() };
        let set = self.session.subject().rig.devices.as_ref().unwrap().right.clone().unwrap();
        let arm = set.kinematics().unwrap();
        let down = set.rcm.inward.normalize();
        let trocar_m =
            set.rcm.trocar_m + self.flaws.trocar_m + if self.is_out { Vector3::x() * 0.1 } else { Vector3::zeros() };
        let turn = UnitQuaternion::rotation_between(&Vector3::z(), &down).unwrap();
        let world_from_s1 = Isometry3::from_parts((trocar_m - down * 0.3).into(), turn);
        let pose = |isometry: &nalgebra::IsometryMatrix3<f64>| {
            Isometry3::from_parts(isometry.translation, UnitQuaternion::from_rotation_matrix(&isometry.rotation))
        };
        let world_from_flange = world_from_s1 * pose(arm.flange_from_s1()).inverse();
        let handle_m = self.handle_m + Vector3::from_fn(|_, _| 1e-5 * self.noise.gaussian());
        let frames = FrameSample {
            base_from_flange: Some(pose(arm.world_from_base()).inverse() * world_from_flange),
            ..FrameSample::from(handle_m)
        };
        let sample = WristSample {
            acceleration_m_s2: Some(Vector3::new(0.0, 0.0, GRAVITY_M_S2) + noise_n),
            world_from_s1: Some(UnitQuaternion::identity()),
            insertion_m: (!self.is_out).then_some(0.1),
            ..WristSample::of(wrench)
        };
        Inputs {
            hand: HandPose::at(handle_m),
            tip_m: trocar_m + down * 0.1,
            sensed: SensedForce::AtWrist(sample),
            frames,
            powered: true,
            ..Inputs::NOTHING
        }
    }
}

pub(super) fn state_of(session: &ReadySession, check: ReadyPoint) -> ReadyState {
    session.list().iter().find(|entry| entry.check == check).unwrap().state
}
