//! The driver against the emulator over real sockets. Loop time is counted in ticks, but the emulator's timeouts are
//! real.

use std::{
    sync::{Arc, Mutex},
    thread::sleep,
    time::{Duration, Instant},
};

use nalgebra::Vector3;
use nima_core::kinematics::ArmModel;
use nima_devices::{
    ARM_JOINTS, ArmReading, ConnectionState, Device as _, DeviceError, Loss, TimedReading,
    kinova::{
        FaultClearing, KinovaDriver, KinovaRefusal, KinovaSettings, ToolTwist, TwistFrame, faults,
        kinematics::tool,
        limits::{ExceededLimit, GEN3, STEP_MAX_S, unwrapped, wire_degrees},
        messages::{ActuatorCommand, KinovaCommand, KinovaNumber, Rpc, sub},
        open, open_clearing,
        session::{KinovaFailure, KinovaLines},
    },
};
use nima_testing::real_time::judged;

use crate::emulators::{
    EmulatorThread,
    kinova::{BodyCommand, EmulatedKinova, KinovaBody, StandIn},
};

const TICK_S: f64 = 1e-3;
const HOME_RAD: [f64; ARM_JOINTS] = [0.0, 0.26, 3.12, -2.27, 0.0, 0.96, 1.57];

/// Returns an arm that tolerates pauses of a busy machine.
pub(super) fn patient() -> EmulatedKinova {
    EmulatedKinova { watchdog_ms: 5_000.0, ..EmulatedKinova::default() }
}

pub(super) fn started(arm: EmulatedKinova) -> (EmulatorThread, KinovaSettings) {
    started_with(arm, StandIn::at(HOME_RAD))
}

pub(super) fn started_with(arm: EmulatedKinova, body: impl KinovaBody + 'static) -> (EmulatorThread, KinovaSettings) {
    let serving = arm.with(body).serve().unwrap();
    let settings = KinovaSettings::at(&serving.endpoint).unwrap();
    (serving, KinovaSettings { speed_fraction: 1.0, lead_rad: 0.2, ..settings })
}

/// A driver with its own clock of ticks.
pub(super) struct Ticking {
    pub(super) driver: KinovaDriver,
    pub(super) now_s: f64,
    pub(super) reading: Option<TimedReading<ArmReading>>,
}

impl Ticking {
    pub(super) fn open(settings: &KinovaSettings) -> Self {
        Self { driver: open(settings).unwrap(), now_s: 0.0, reading: None }
    }

    fn tick(&mut self) -> Option<ArmReading> {
        self.now_s += TICK_S;
        let reading = self.driver.poll(self.now_s);
        self.reading = reading.or(self.reading);
        sleep(Duration::from_millis(1));
        reading.map(|stamped| stamped.value)
    }

    pub(super) fn latest(&self) -> ArmReading {
        self.reading.unwrap().value
    }

    /// Runs ticks until `good`, at most `ticks` of them.
    pub(super) fn until(&mut self, ticks: u32, good: impl Fn(&Self) -> bool) -> bool {
        (0..ticks).any(|_| {
            self.tick();
            good(self)
        })
    }

    /// One tick towards a target, with no joint faster than 1 rad/s.
    pub(super) fn lead(&mut self, target_rad: &[f64; ARM_JOINTS]) {
        let at = *self.driver.command_rad();
        let furthest = target_rad.iter().zip(&at).map(|(to, at)| (to - at).abs()).fold(0.0, f64::max);
        let fraction = (TICK_S / furthest).min(1.0);
        self.driver.aim(&std::array::from_fn(|j| at[j] + (target_rad[j] - at[j]) * fraction)).unwrap();
        self.tick();
    }

    pub(super) fn enter_low_level(&mut self) {
        assert!(self.until(500, |ticking| ticking.reading.is_some()), "{:?}", self.driver.health());
        self.driver.enter_low_level().unwrap();
        let servoing = self.until(1000, |ticking| ticking.reading.is_some_and(|reading| reading.value.servoing));
        assert!(servoing, "{:?} {:?}", self.driver.answer(), self.driver.health());
    }
}

/// Returns the sessions without a driver, for calls that the driver never makes.
fn raw(settings: &KinovaSettings) -> KinovaLines {
    let mut lines = KinovaLines::connect(settings).unwrap();
    lines.log_in(settings).unwrap();
    lines
}

fn mode(settings: &KinovaSettings) -> u32 {
    use prost::Message as _;
    let payload = raw(settings).ask(Rpc::GET_SERVOING_MODE, &()).unwrap();
    KinovaNumber::decode(payload.as_slice()).unwrap().value
}

fn refresh(frame_id: u32, joint_rad: &[f64; ARM_JOINTS]) -> KinovaCommand {
    let actuators = joint_rad.map(|angle| ActuatorCommand {
        command_id: frame_id,
        flags: 1,
        position_deg: wire_degrees(angle),
        ..ActuatorCommand::default()
    });
    KinovaCommand { frame_id, actuators: actuators.to_vec() }
}

/// The commands to the body over time.
type Log = Arc<Mutex<Vec<BodyCommand>>>;

fn logged() -> (Log, impl KinovaBody) {
    let log = Log::default();
    let kept = Arc::clone(&log);
    let mut arm = StandIn::at(HOME_RAD);
    let body = move |elapsed_s: f64, asked: &BodyCommand| {
        let mut log = kept.lock().unwrap();
        if log.last() != Some(asked) {
            log.push(*asked);
        }
        arm.step(elapsed_s, asked)
    };
    (log, body)
}

#[test]
fn it_connects_and_loses_nothing() {
    judged(|| {
        let (_serving, settings) = started(patient());
        let mut ticking = Ticking::open(&settings);
        assert_eq!(ticking.driver.identity().serial, "EMULATED-1");
        assert_eq!(ticking.driver.identity().firmware, "0x02050002");
        for _ in 0..800 {
            ticking.tick();
        }
        let health = ticking.driver.health();
        assert!(health.readings > 700, "{health:?}");
        assert_eq!((health.lost, health.damaged, health.out_of_order, health.refused), (0, 0, 0, 0), "{health:?}");
        assert_eq!(health.standing, ConnectionState::Connected);
        let reading = ticking.latest();
        assert!(!reading.servoing && reading.joint_rad.iter().zip(&HOME_RAD).all(|(is, was)| (is - was).abs() < 1e-6));
        let report = ticking.driver.tool();
        let expected = tool(&HOME_RAD);
        assert!((report.position_m - expected.translation.vector).amax() < 1e-6);
        assert!(report.orientation.angle_to(&expected.rotation) < 1e-5);
        assert_eq!(ticking.driver.aim(&HOME_RAD), Err(KinovaRefusal::NotServoing));
    });
}

#[test]
fn low_level_moves_to_targets_over_the_turn_without_jumps() {
    judged(|| {
        let (log, body) = logged();
        let (serving, settings) = started_with(patient(), body);
        let mut ticking = Ticking::open(&settings);
        ticking.enter_low_level();
        assert_eq!(ticking.driver.twist(&ToolTwist::default()), Err(KinovaRefusal::NotSingleLevel));
        assert_eq!(ticking.driver.aim(&[f64::NAN; ARM_JOINTS]), Err(KinovaRefusal::NotFinite));
        // The first joint crosses from 0 to 360 degrees on the wire, the third from below half a turn to above it.
        let mut target = HOME_RAD;
        target[0] = -0.15;
        target[2] = 3.3;
        target[6] = 1.2;
        let near = |reading: &ArmReading| reading.joint_rad.iter().zip(&target).all(|(is, to)| (is - to).abs() < 1e-3);
        let arrived = (0..2000).any(|_| {
            ticking.lead(&target);
            near(&ticking.latest())
        });
        assert!(arrived, "{:?}", ticking.latest());
        for _ in 0..100 {
            ticking.lead(&HOME_RAD);
        }
        // Drop the driver in full motion.
        assert_eq!(ticking.driver.health().lost, 0);
        drop(ticking);
        assert_eq!(mode(&settings), 2, "back in single level");
        let log = log.lock().unwrap().clone();
        let mut last = HOME_RAD;
        for asked in &log {
            if let BodyCommand::Joints(angles) = asked {
                for j in 0..ARM_JOINTS {
                    let step = (angles[j] - last[j]).abs();
                    // On a busy machine several commands arrive between two steps of the body.
                    assert!(step <= GEN3[j].speed_rad_s * STEP_MAX_S * 20.0, "joint {j} jumps by {step}");
                }
                last = *angles;
            }
        }
        assert_eq!(log.last(), Some(&BodyCommand::Rest));
        assert!(serving.is_serving());
        let mut lines = raw(&settings);
        assert!(lines.ask(Rpc::ARM_STATE, &()).is_ok_and(|payload| payload == [8, 7]), "ready, without a fault");
    });
}

#[test]
fn a_command_beyond_the_limits_is_refused_counted_and_ends_the_servoing() {
    judged(|| {
        let (_serving, settings) = started(patient());
        let mut ticking = Ticking::open(&KinovaSettings { speed_fraction: 0.3, ..settings });
        ticking.enter_low_level();
        let mut jump = *ticking.driver.command_rad();
        jump[4] += 0.02;
        let refused = Err(KinovaRefusal::Beyond { joint: 5, beyond: ExceededLimit::Speed });
        assert_eq!(ticking.driver.aim(&jump), refused);
        assert_eq!(ticking.driver.health().refused, 1);
        assert!(ticking.until(1000, |ticking| !ticking.latest().servoing));
        assert!(
            ticking.latest().joint_rad.iter().zip(&HOME_RAD).all(|(is, was)| (is - was).abs() < 1e-6),
            "it did not move"
        );
        assert_eq!(ticking.driver.health().standing, ConnectionState::Connected);
        ticking.enter_low_level();
    });
}

#[test]
fn leaving_brakes_first_and_the_arm_can_be_taken_over_by_others() {
    judged(|| {
        let (_serving, settings) = started(patient());
        let mut ticking = Ticking::open(&settings);
        ticking.enter_low_level();
        for _ in 0..50 {
            ticking.lead(&[0.3; ARM_JOINTS]);
        }
        ticking.driver.leave_low_level();
        assert!(ticking.until(1000, |ticking| !ticking.latest().servoing));
        assert!(ticking.until(1000, |_| mode(&settings) == 2));
        ticking.enter_low_level();
        // Another client switches the arm back to single-level servoing.
        let mut other = raw(&settings);
        other.ask(Rpc::SET_SERVOING_MODE, &KinovaNumber { value: 2 }).unwrap();
        assert!(ticking.until(500, |ticking| ticking.driver.ousted() == 1));
        assert!(ticking.until(500, |ticking| !ticking.latest().servoing));
        assert_eq!(ticking.driver.health().standing, ConnectionState::Connected);
        assert_eq!(ticking.driver.answer().unwrap().sub_error, sub::WRONG_SERVOING_MODE);
    });
}

#[test]
fn a_twist_moves_the_tool_and_ends_when_it_is_not_renewed() {
    judged(|| {
        let (log, body) = logged();
        let (_serving, settings) = started_with(patient(), body);
        let settings = KinovaSettings { twist_m_s: 0.05, ..settings };
        let mut ticking = Ticking::open(&settings);
        assert!(ticking.until(500, |ticking| ticking.reading.is_some()));
        let begin_m = ticking.driver.tool().position_m;
        let twist = ToolTwist { linear_m_s: Vector3::new(0.0, 0.0, 3.0), ..ToolTwist::default() };
        for _ in 0..300 {
            ticking.driver.twist(&twist).unwrap();
            ticking.tick();
        }
        assert_eq!(ticking.driver.enter_low_level(), Err(KinovaRefusal::Moving));
        let moved_m = ticking.driver.tool().position_m - begin_m;
        assert!(moved_m.z > 0.005 && moved_m.xy().amax() < 0.2 * moved_m.z, "{moved_m}");
        let moving = BodyCommand::Twist {
            frame: TwistFrame::Base,
            linear_m_s: Vector3::new(0.0, 0.0, f64::from(0.05_f32)),
            angular_rad_s: Vector3::zeros(),
        };
        assert_eq!(log.lock().unwrap().last(), Some(&moving), "cut to the setting");
        assert!(ticking.until(1000, |_| log.lock().unwrap().last() == Some(&BodyCommand::Rest)), "not renewed");
        ticking.driver.twist(&twist).unwrap();
        assert!(ticking.until(500, |_| log.lock().unwrap().last() == Some(&moving)));
        ticking.driver.stop();
        assert!(ticking.until(50, |_| log.lock().unwrap().last() == Some(&BodyCommand::Rest)), "stopped");
        ticking.driver.twist(&twist).unwrap();
        assert!(ticking.until(500, |_| log.lock().unwrap().last() == Some(&moving)));
        drop(ticking);
        let end = Instant::now() + Duration::from_secs(2);
        while log.lock().unwrap().last() != Some(&BodyCommand::Rest) {
            assert!(Instant::now() < end, "released when dropped");
            sleep(Duration::from_millis(1));
        }
    });
}

#[test]
fn the_emulator_refuses_what_the_arm_refuses() {
    judged(|| {
        let (_serving, settings) = started(patient());
        let mut stranger = KinovaLines::connect(&settings).unwrap();
        assert_eq!(stranger.ask(Rpc::ARM_STATE, &()), Err(KinovaFailure::Refused(3, sub::INVALID_SESSION)));
        let mut lines = raw(&settings);
        let wrong_mode = Err(KinovaFailure::Refused(3, sub::WRONG_SERVOING_MODE));
        assert_eq!(lines.ask_cyclic(Rpc::REFRESH, &refresh(1, &HOME_RAD)), wrong_mode);
        assert_eq!(lines.ask_cyclic(Rpc::ARM_STATE, &()), Err(KinovaFailure::Refused(1, sub::UNSUPPORTED_SERVICE)));
        assert_eq!(
            lines.ask(Rpc { service: 2, function: 160 }, &()),
            Err(KinovaFailure::Refused(1, sub::UNSUPPORTED_METHOD))
        );
        lines.ask(Rpc::SET_SERVOING_MODE, &KinovaNumber { value: 3 }).unwrap();
        assert!(lines.ask_cyclic(Rpc::REFRESH, &refresh(1, &HOME_RAD)).is_ok());
        assert_eq!(lines.ask(Rpc::SEND_TWIST, &nima_devices::kinova::messages::TwistCommand::default()), wrong_mode);
        // A jump trips the following error, which stays until it is cleared.
        let mut jump = HOME_RAD;
        jump[4] += 0.2;
        lines.ask_cyclic(Rpc::REFRESH, &refresh(2, &jump)).unwrap();
        let payload = lines.ask_cyclic(Rpc::REFRESH, &refresh(3, &HOME_RAD)).unwrap();
        let report = nima_devices::kinova::feedback::KinovaFeedback::decode(&payload).unwrap();
        assert_eq!(report.actuators[4].banks.fault[0], faults::FOLLOWING_ERROR);
        assert!((unwrapped(report.actuators[4].position_deg, 0.0) - HOME_RAD[4]).abs() < 1e-6, "it did not move");
        assert_eq!(report.state, nima_devices::kinova::messages::ArmState::IN_FAULT);
        lines.ask(Rpc::SET_SERVOING_MODE, &KinovaNumber { value: 2 }).unwrap();
        let in_fault = Err(KinovaFailure::Refused(3, sub::IN_FAULT));
        assert_eq!(lines.ask(Rpc::SET_SERVOING_MODE, &KinovaNumber { value: 3 }), in_fault);
        lines.ask(Rpc::CLEAR_FAULTS, &()).unwrap();
        assert!(lines.ask(Rpc::SET_SERVOING_MODE, &KinovaNumber { value: 3 }).is_ok());
    });
}

#[test]
fn a_missed_cycle_is_a_fault_that_only_a_command_clears() {
    judged(|| {
        let (_serving, settings) = started(EmulatedKinova { watchdog_ms: 200.0, ..EmulatedKinova::default() });
        let mut ticking = Ticking::open(&settings);
        ticking.enter_low_level();
        sleep(Duration::from_millis(400));
        assert!(ticking.until(100, |ticking| matches!(ticking.driver.health().standing, ConnectionState::Lost(_))));
        let lost = ConnectionState::Lost(Loss::Device { code: faults::COMMUNICATION_TICK_LOST });
        assert_eq!(ticking.driver.health().standing, lost);
        assert!(ticking.driver.faults().to_string().contains("joint 7: cyclic command missed (0x400000)"));
        assert_eq!(ticking.driver.aim(&HOME_RAD), Err(KinovaRefusal::Lost));
        drop(ticking);
        let clearing = FaultClearing::default();
        for _ in 0..2 {
            let trouble = open_clearing(&settings, &ArmModel::GEN3, &clearing).unwrap_err();
            assert!(
                matches!(&trouble, DeviceError::DeviceFault { words, .. } if words.contains("missed")),
                "{trouble}"
            );
        }
        clearing.command();
        let mut ticking = Ticking {
            driver: open_clearing(&settings, &ArmModel::GEN3, &clearing).unwrap(),
            now_s: 0.0,
            reading: None,
        };
        ticking.enter_low_level();
    });
}
