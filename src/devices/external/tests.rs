//! The drivers with a device program that lives in the test.

use nalgebra::{Isometry3, Vector3};
use nima_core::kinematics::{ArmChain, ArmModel, ChainJoint};

use super::{
    ExternalArm, ExternalHandle, ExternalKind, ExternalSensor, ExternalSettings, READS_MAX,
    codec::{BYTES_MAX, Datagram, ExternalMessage, padded, status},
};
use crate::{
    ARM_JOINTS, ConnectionState, Device, DeviceError, Follower as _, Health, Leader as _, Lever, Loss,
    transport::{MemoryDatagrams, TransportDatagrams as _},
};

const TICK_S: f64 = 1e-3;

fn settings() -> ExternalSettings {
    ExternalSettings::at(([127, 0, 0, 1], 47_200).into())
}

/// A program of a device, and the loop's time.
struct Fixture {
    wire: MemoryDatagrams,
    next: Datagram,
    /// The newest command that the program has received.
    received: Option<Datagram>,
    now_s: f64,
}

impl Fixture {
    /// Creates the program, and the other end for the driver. Two datagrams are pending there; the second one shows
    /// that an answer was received.
    fn new(kind: ExternalKind) -> (Self, MemoryDatagrams) {
        Self::with(kind, ARM_JOINTS)
    }

    /// The same for an arm with this number of joints.
    fn with(kind: ExternalKind, joints: usize) -> (Self, MemoryDatagrams) {
        let [wire, other] = MemoryDatagrams::pair();
        let next = Datagram {
            session: 77,
            watchdog_us: 20_000,
            product: padded("test device"),
            serial: padded("T-1"),
            joints,
            ..Datagram::blank(ExternalMessage::Reading(kind))
        };
        let mut this = Self { wire, next, received: None, now_s: 5.0 };
        this.send();
        this.next.echo_us = 1;
        this.send();
        (this, other)
    }

    fn send_as(&mut self, datagram: &Datagram) {
        let mut wire = [0; BYTES_MAX];
        let length = datagram.encode(&mut wire);
        self.wire.send(&wire[..length]).unwrap();
    }

    fn send(&mut self) {
        self.next.sequence = self.next.sequence.wrapping_add(1);
        self.next.time_us += 1000;
        let next = self.next;
        self.send_as(&next);
    }

    fn receive(&mut self) {
        let mut buffer = [0; BYTES_MAX];
        while let Ok(Some(count)) = self.wire.receive(&mut buffer) {
            let command = Datagram::decode(&buffer[..count]).unwrap();
            self.next.echo_us = command.time_us;
            self.received = Some(command);
        }
    }

    /// Runs one tick, in which the program first receives and sends.
    fn tick<D: Device>(&mut self, device: &mut D) -> Option<D::Reading> {
        self.receive();
        self.send();
        self.poll(device)
    }

    fn poll<D: Device>(&mut self, device: &mut D) -> Option<D::Reading> {
        self.now_s += TICK_S;
        device.poll(self.now_s).map(|stamped| {
            assert!((stamped.arrival_s - self.now_s).abs() < 1e-12);
            stamped.value
        })
    }
}

fn handle() -> (Fixture, ExternalHandle) {
    let (mut bench, wire) = Fixture::new(ExternalKind::Handle);
    let mut handle = ExternalHandle::over(Box::new(wire), &settings()).unwrap();
    for _ in 0..30 {
        assert!(bench.tick(&mut handle).is_some());
    }
    (bench, handle)
}

fn lost(health: &Health) -> Option<Loss> {
    match health.standing {
        ConnectionState::Lost(loss) => Some(loss),
        _ => None,
    }
}

#[test]
fn a_handle_tells_where_it_is_and_is_given_a_force_within_its_limits() {
    let (mut bench, mut handle) = handle();
    assert_eq!((handle.identity().product.as_str(), handle.identity().serial.as_str()), ("test device", "T-1"));
    bench.next.numbers[..11].copy_from_slice(&[0.01, -0.02, 0.03, 0.0, 1.0, 0.0, 0.0, 0.1, 0.2, 0.3, 0.5]);
    bench.next.status = status::HAS_ORIENTATION | status::HAS_GRIPPER;
    bench.next.buttons = 2;
    let reading = bench.tick(&mut handle).unwrap();
    assert_eq!(reading.position_m, Vector3::new(0.01, -0.02, 0.03));
    assert!((reading.orientation.unwrap().angle() - std::f64::consts::PI).abs() < 1e-12);
    assert_eq!((reading.gripper_rad, reading.velocity_m_s, reading.buttons), (Some(0.5), None, 2));
    assert_eq!(handle.force_change(), Some(false));
    assert_eq!(handle.force_change(), None, "it has told nothing since");

    let report = |bench: &mut Fixture, handle: &mut ExternalHandle, force_n: Vector3<f64>| {
        handle.set_force(force_n, 1.0);
        bench.receive();
        let command = bench.received.unwrap();
        (command.has(status::ON), Vector3::from(command.three(0)), command.numbers[3])
    };
    assert_eq!(report(&mut bench, &mut handle, Vector3::x()), (false, Vector3::zeros(), 0.0), "it is not switched on");
    handle.switch_force(true);
    assert_eq!(report(&mut bench, &mut handle, Vector3::x()), (true, Vector3::x(), 0.0), "it has no gripper force");
    let (_, large_n, _) = report(&mut bench, &mut handle, Vector3::new(1e300, -1e300, 0.0));
    assert!((large_n.norm() - 4.0).abs() < 1e-9, "{large_n}");
    assert_eq!(report(&mut bench, &mut handle, Vector3::new(f64::NAN, 1.0, 0.0)), (true, Vector3::zeros(), 0.0));
    bench.next.status = status::ON;
    bench.tick(&mut handle);
    assert_eq!(handle.force_change(), Some(true));

    let lever = Lever::default();
    handle.attach(&lever);
    assert!(lever.pull());
    assert_eq!(report(&mut bench, &mut handle, Vector3::x()), (false, Vector3::zeros(), 0.0));
    handle.switch_force(true);
    drop(handle);
    bench.receive();
    assert!(!bench.received.unwrap().has(status::ON), "closing it switches it off");
}

#[test]
fn late_repeated_and_exchanged_readings_are_counted_and_never_handed_on() {
    let (mut bench, mut handle) = handle();
    let accepted = handle.health().readings;
    let echo_us = bench.next.echo_us;
    let old = bench.next;
    let bad: [fn(&mut Datagram); 4] = [
        |_| {},
        |next| next.sequence -= 3,
        |next| (next.sequence, next.time_us) = (next.sequence + 1, next.time_us - 1),
        |next| next.session += 1,
    ];
    for (count, change) in bad.into_iter().enumerate() {
        let mut datagram = old;
        change(&mut datagram);
        bench.send_as(&datagram);
        assert_eq!(bench.poll(&mut handle), None, "{count}");
        assert_eq!(handle.health().out_of_order, count as u64 + 1);
    }
    // Sent on time by its own clock, but by a program that has not received a command for longer than the limit.
    for _ in 0..6 {
        bench.receive();
        bench.next.echo_us = echo_us;
        bench.send();
        bench.poll(&mut handle);
    }
    let stale = handle.health().out_of_order;
    bench.next.echo_us = echo_us;
    bench.send();
    assert_eq!(bench.poll(&mut handle), None);
    assert_eq!(handle.health().out_of_order, stale + 1);
    assert!(handle.health().readings > accepted && lost(handle.health()).is_none());
    bench.next.sequence += 4;
    assert!(bench.tick(&mut handle).is_some(), "a program that receives again is accepted again");
    assert_eq!(handle.health().lost, 4);
}

#[test]
fn a_standstill_of_the_loop_itself_is_no_fault_of_the_device() {
    let (mut bench, mut handle) = handle();
    for _ in 0..30 {
        bench.receive();
        bench.send();
        bench.now_s += TICK_S;
    }
    assert!(bench.poll(&mut handle).is_some());
    assert!(bench.tick(&mut handle).is_some());
}

#[test]
fn a_silent_program_is_lost_in_time_and_a_closed_one_at_once() {
    let (mut bench, mut handle) = self::handle();
    let begin_s = bench.now_s;
    while lost(handle.health()).is_none() {
        bench.poll(&mut handle);
    }
    let after_s = bench.now_s - begin_s;
    assert_eq!(lost(handle.health()), Some(Loss::Silent));
    assert!((0.0099..0.0125).contains(&after_s), "{after_s} s");
    assert_eq!(bench.tick(&mut handle), None, "it stays lost until it is opened again");

    let (mut bench, mut handle) = self::handle();
    bench.wire.cut();
    bench.poll(&mut handle);
    assert_eq!(lost(handle.health()), Some(Loss::Disconnected));
}

#[test]
fn a_queue_that_grows_faster_than_it_is_read_delivers_nothing() {
    let (mut bench, mut handle) = handle();
    bench.receive();
    (0..2 * READS_MAX + 5).for_each(|_| bench.send());
    assert_eq!(bench.poll(&mut handle), None);
    assert_eq!(bench.poll(&mut handle), None);
    assert!(bench.poll(&mut handle).is_some(), "the end of the queue");
    assert_eq!(handle.health().out_of_order, 2);
}

#[test]
fn damaged_impossible_and_faulty_ones_are_told() {
    let run = |bench: &mut Fixture, handle: &mut ExternalHandle, send: fn(&mut Fixture)| {
        for _ in 0..10 {
            bench.receive();
            send(bench);
            assert_eq!(bench.poll(handle), None);
        }
        lost(handle.health())
    };
    let (mut bench, mut handle) = self::handle();
    assert_eq!(run(&mut bench, &mut handle, |bench| bench.wire.send(b"NIMX and more").unwrap()), Some(Loss::Corrupt));
    assert_eq!(handle.health().damaged, 10);
    let (mut bench, mut handle) = self::handle();
    bench.next.numbers[1] = f64::NAN;
    assert_eq!(run(&mut bench, &mut handle, Fixture::send), Some(Loss::Implausible));
    assert_eq!(handle.health().refused, 10);
    let (mut bench, mut handle) = self::handle();
    bench.next.watchdog_us = 0;
    assert_eq!(run(&mut bench, &mut handle, Fixture::send), Some(Loss::Implausible), "it would never be switched off");
    let (mut bench, mut handle) = self::handle();
    bench.next.status = status::FAULT;
    bench.next.fault = 0x1234;
    assert_eq!(run(&mut bench, &mut handle, Fixture::send), Some(Loss::Device { code: 0x1234 }));
    let (mut bench, mut handle) = self::handle();
    bench.next.status = status::HAS_ORIENTATION;
    bench.next.numbers[3..7].fill(1.0);
    assert_eq!(bench.tick(&mut handle), None, "no orientation has this length");
}

#[test]
fn a_sensor_tells_force_acceleration_and_why_it_must_not_be_used() {
    let (mut bench, wire) = Fixture::new(ExternalKind::Sensor);
    bench.next.watchdog_us = 0;
    let mut sensor = ExternalSensor::over(Box::new(wire), &settings()).unwrap();
    for place in 0..13 {
        bench.next.numbers[place] = place as f64;
    }
    bench.next.status = status::HAS_ACCELERATION;
    let reading = bench.tick(&mut sensor).unwrap();
    assert_eq!(reading.wrench.force_n, Vector3::new(0.0, 1.0, 2.0));
    assert_eq!(reading.wrench.torque_nm, Vector3::new(3.0, 4.0, 5.0));
    assert_eq!(reading.acceleration_m_s2, Some(Vector3::new(6.0, 7.0, 8.0)));
    assert_eq!((reading.angular_velocity_rad_s, reading.status.is_usable()), (None, true));
    for bad in [status::OVERRANGE, status::INVALID, status::RAW] {
        bench.next.status = bad;
        assert!(!bench.tick(&mut sensor).unwrap().status.is_usable());
    }
}

const START_RAD: [f64; ARM_JOINTS] = [2.38, -1.34, -1.37, 1.91, -1.28, 1.68, 0.92];

#[test]
fn an_arm_follows_only_while_it_tells_so_and_only_within_its_limits() {
    let (mut bench, wire) = Fixture::new(ExternalKind::Arm);
    let mut arm = ExternalArm::over(Box::new(wire), &settings(), &ArmModel::GEN3).unwrap();
    bench.next.numbers[..ARM_JOINTS].copy_from_slice(&START_RAD);
    let tick = |bench: &mut Fixture, arm: &mut ExternalArm| {
        bench.receive();
        let asked = bench.received.is_some_and(|command| command.has(status::ON));
        bench.next.status = if asked { status::ON } else { 0 };
        if let Some(command) = bench.received.filter(|_| asked) {
            bench.next.numbers[..ARM_JOINTS].copy_from_slice(&command.numbers[..ARM_JOINTS]);
        }
        bench.send();
        bench.poll(arm).unwrap()
    };
    assert!(!tick(&mut bench, &mut arm).servoing && !arm.aim(&START_RAD), "it rests");
    arm.enter_servoing();
    assert!(!arm.aim(&START_RAD), "it has not told that it follows");
    for _ in 0..3 {
        tick(&mut bench, &mut arm);
    }
    assert!(tick(&mut bench, &mut arm).servoing);
    for step in 1..=500_u32 {
        assert!(arm.aim(&START_RAD.map(|rad| rad + 1e-4 * f64::from(step))));
        tick(&mut bench, &mut arm);
    }
    let at_rad = tick(&mut bench, &mut arm).joint_rad[0];
    let asked_rad = START_RAD[0] + 0.05;
    assert!((at_rad - asked_rad).abs() < 3e-4, "{at_rad}, not {asked_rad}");
    assert!(!arm.aim(&START_RAD), "a step back by 0.05 rad");
    assert_eq!(arm.health().refused, 1);
    assert!(!tick(&mut bench, &mut arm).servoing, "and it brakes");
    for _ in 0..300 {
        tick(&mut bench, &mut arm);
    }
    assert!(!bench.received.unwrap().has(status::ON), "then it is switched off");

    // An arm that stops by itself does not resume.
    arm.enter_servoing();
    for _ in 0..4 {
        tick(&mut bench, &mut arm);
    }
    assert!(tick(&mut bench, &mut arm).servoing);
    bench.receive();
    bench.next.status = 0;
    bench.send();
    assert!(!bench.poll(&mut arm).unwrap().servoing);
    bench.receive();
    assert!(!bench.received.unwrap().has(status::ON));
}

/// Six joints: those of a Gen3 without its last one, which is enough for the driver.
fn six_joints() -> ArmModel {
    let joint = ChainJoint {
        from_previous: Isometry3::translation(0.0, 0.0, 0.1),
        axis: Vector3::z(),
        range_rad: [-1.0, 2.0],
        speed_rad_s: 1.0,
        acceleration_rad_s2: 2.0,
    };
    ArmModel::new(&ArmChain { joints: vec![joint; 6], last_from_flange: Isometry3::identity() }).unwrap()
}

#[test]
fn an_arm_of_six_joints_sends_and_gets_six_numbers_and_keeps_to_its_own_ranges() {
    let (mut bench, wire) = Fixture::with(ExternalKind::Arm, 6);
    let mut arm = ExternalArm::over(Box::new(wire), &settings(), &six_joints()).unwrap();
    let tick = |bench: &mut Fixture, arm: &mut ExternalArm| {
        bench.receive();
        let asked = bench.received.filter(|command| command.has(status::ON));
        bench.next.status = if asked.is_some() { status::ON } else { 0 };
        bench.next.numbers[..6]
            .copy_from_slice(&asked.map_or([-0.99; 6], |command| command.numbers[..6].try_into().unwrap()));
        bench.next.numbers[6..18].fill(0.25);
        bench.send();
        bench.poll(arm).unwrap()
    };
    arm.enter_servoing();
    for _ in 0..4 {
        let reading = tick(&mut bench, &mut arm);
        arm.enter_servoing();
        assert_eq!((reading.joint_rad_s[5], reading.joint_nm[5], reading.joint_rad_s[6]), (0.25, 0.25, 0.0));
    }
    assert!(tick(&mut bench, &mut arm).servoing);
    assert_eq!(bench.received.unwrap().joints, 6);
    let aim = |arm: &mut ExternalArm, rad: f64| {
        let mut target_rad = [rad; ARM_JOINTS];
        target_rad[6] = 0.0;
        arm.aim(&target_rad)
    };
    assert!(aim(&mut arm, -0.991));
    tick(&mut bench, &mut arm);
    assert!(!aim(&mut arm, -1.001), "below the lower limit");
}

#[test]
fn an_arm_with_another_number_of_joints_is_refused_with_both_numbers() {
    let (_bench, wire) = Fixture::with(ExternalKind::Arm, 6);
    let refused = ExternalArm::over(Box::new(wire), &settings(), &ArmModel::GEN3).err().unwrap().to_string();
    assert!(refused.contains("arm with 6 joints") && refused.contains("arm with 7 joints"), "{refused}");
}

#[test]
fn who_must_not_be_let_in_is_told_with_what_to_do() {
    let report = |kind: ExternalKind, change: fn(&mut Datagram), settings: &ExternalSettings| {
        let [mut wire, other] = MemoryDatagrams::pair();
        let mut datagram = Datagram {
            session: 1,
            sequence: 1,
            time_us: 1,
            echo_us: 1,
            watchdog_us: 20_000,
            serial: padded("T-1"),
            ..Datagram::blank(ExternalMessage::Reading(kind))
        };
        change(&mut datagram);
        let mut bytes = [0; BYTES_MAX];
        let length = datagram.encode(&mut bytes);
        wire.send(&bytes[..length]).unwrap();
        let trouble = ExternalHandle::over(Box::new(other), settings).err().unwrap();
        assert!(!trouble.cure().is_empty());
        trouble
    };
    let usual = settings();
    let arm = report(ExternalKind::Arm, |_| {}, &usual);
    assert_eq!(arm.to_string(), "UDP 127.0.0.1:47200 is a program for an arm, not a program for a handle (protocol 1)");
    let command = report(
        ExternalKind::Handle,
        |datagram| datagram.message = ExternalMessage::Command(ExternalKind::Handle),
        &usual,
    );
    assert!(matches!(command, DeviceError::WrongProduct { .. }), "{command}");
    let unwatched = report(ExternalKind::Handle, |datagram| datagram.watchdog_us = 500_000, &usual);
    assert!(unwatched.to_string().contains("its watchdog time is 500 ms"), "{unwatched}");
    let other = ExternalSettings { serial_number: Some("T-2".to_owned()), ..usual.clone() };
    assert!(matches!(report(ExternalKind::Handle, |_| {}, &other), DeviceError::OtherSerial { .. }));
    // It sends once and never receives.
    assert!(matches!(report(ExternalKind::Handle, |_| {}, &usual), DeviceError::Unheard { .. }));
    let [_silent, end] = MemoryDatagrams::pair();
    assert!(matches!(ExternalHandle::over(Box::new(end), &usual), Err(DeviceError::NobodySends { .. })));
}
