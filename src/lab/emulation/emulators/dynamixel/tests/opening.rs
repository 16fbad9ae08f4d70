//! Opening: the settings written to the servos, and every cause of failure.

use nima_devices::{
    ConnectionState, Device as _, DeviceError, Loss,
    dynamixel::{
        DynamixelSettings, HardwareError, OperatingMode, WaitClock as _,
        codec::{BROADCAST, IncomingPackets, OutgoingPackets},
        message::Instruction,
        open_over,
    },
    transport::{ByteStream, MemoryBytes},
};

use super::{
    super::{Bus, EmulatedDynamixel},
    world::{Fixture, emulated, settings, with_unsupported},
};
use crate::emulators::EmulatedFault;

/// Reads registers of a servo, bypassing the driver.
fn peek(bench: &Fixture, id: u8, address: u16, count: u16) -> Vec<u8> {
    let mut out = OutgoingPackets::new(64);
    Instruction::Read { address, count }.encode(id, &mut out);
    let mut world = bench.world.borrow_mut();
    let mut incoming = IncomingPackets::new(512);
    let mut body = Vec::new();
    let now_s = world.now_s;
    world.emulator.receive(now_s, out.bytes());
    world.emulator.send(now_s + 1.0, EmulatedFault::None, &mut |bytes| {
        incoming.feed(bytes);
        body = incoming.next().unwrap().body[1..].to_vec();
    });
    body
}

fn number(bytes: &[u8]) -> i32 {
    let sign = if bytes.last().is_some_and(|byte| byte & 0x80 != 0) { 0xFF } else { 0 };
    let mut all = [sign; 4];
    all[..bytes.len()].copy_from_slice(bytes);
    i32::from_le_bytes(all)
}

#[test]
fn the_servos_become_what_the_settings_say() {
    let mut wanted = settings();
    let servo = &mut wanted.servos[2];
    servo.reverse = true;
    servo.homing_offset_rad = 0.5;
    servo.operating_mode = OperatingMode::CurrentBasedPosition;
    servo.goal_current_a = Some(0.269);
    servo.gains.position_d = 77;
    servo.profile_acceleration_rad_s2 = 0.01;
    let mut bench = Fixture::new(Bus::new(&emulated(), None).unwrap(), wanted);
    let driver = bench.open().unwrap();
    assert_eq!(driver.identity().product, "XM430-W350 XM430-W350 XM430-W350 XM430-W350");
    assert_eq!(
        (driver.identity().serial.as_str(), driver.health().standing),
        ("ids 1 2 3 4", ConnectionState::Opening)
    );
    assert!(driver.uses_fast_sync_read());
    for (id, address, count, value) in [
        (1, 9, 1, 0),
        (1, 10, 1, 0),
        (1, 11, 1, 3),
        // 1.5 rad are 977.8 ticks.
        (1, 48, 4, 2048 + 977),
        (1, 52, 4, 2048 - 977),
        (1, 38, 2, 743),
        (1, 84, 2, 800),
        (1, 112, 4, 167),
        (3, 10, 1, 1),
        (3, 11, 1, 5),
        (3, 20, 4, 326),
        (3, 80, 2, 77),
        (3, 102, 2, 100),
        // A limit of less than one step is still a limit.
        (3, 108, 4, 1),
        (3, 64, 1, 0),
    ] {
        assert_eq!(number(&peek(&bench, id, address, count)), value, "servo {id}, register {address}");
    }
}

#[test]
fn an_old_firmware_is_asked_one_by_one() {
    let settings_of = EmulatedDynamixel { fast: false, ..emulated() };
    let mut bench = Fixture::new(Bus::new(&settings_of, None).unwrap(), settings());
    let mut driver = bench.open().unwrap();
    assert!(!driver.uses_fast_sync_read());
    assert!(bench.run(&mut driver, 1.0).is_some());
    assert_eq!((driver.health().lost, driver.health().out_of_order), (0, 0));
    assert!(driver.health().readings > 450, "{:?}", driver.health());
}

#[test]
fn servos_that_answer_to_reads_alone_are_told_to_answer() {
    let mut bench = Fixture::usual();
    drop(bench.open().unwrap());
    let mut out = OutgoingPackets::new(64);
    Instruction::Write { address: 68, data: &[1] }.encode(2, &mut out);
    let now_s = bench.now_s();
    bench.world.borrow_mut().emulator.receive(now_s, out.bytes());
    assert!(bench.open().is_ok());
}

#[test]
fn what_is_missing_or_another_is_named() {
    let opened = |emulator: EmulatedDynamixel, settings: DynamixelSettings| {
        Fixture::new(Bus::new(&emulator, None).unwrap(), settings).open().err()
    };
    let missing = opened(EmulatedDynamixel { ids: vec![1, 2, 4], ..emulated() }, settings());
    assert_eq!(missing, Some(DeviceError::Absent { place: "servo 3 on test".to_owned() }));
    let nobody = opened(EmulatedDynamixel { ids: vec![], ..emulated() }, settings());
    assert_eq!(nobody, Some(DeviceError::Silent { place: "test".to_owned() }));
    let mut wanted = settings();
    wanted.servos[1].model = Some("XM540-W270".to_owned());
    let other = opened(emulated(), wanted);
    let found = ("servo 2 on test".to_owned(), "XM540-W270".to_owned(), "XM430-W350".to_owned());
    assert_eq!(other, Some(DeviceError::WrongProduct { place: found.0, expected: found.1, found: found.2 }));
    let mut weak = settings();
    weak.servos.iter_mut().for_each(|servo| servo.current_limit_a = 1.8);
    let small = opened(EmulatedDynamixel { model: 1200, ..emulated() }, weak);
    assert!(matches!(&small, Some(DeviceError::Setting { key, .. }) if key == "current_limit_a"), "{small:?}");
}

#[test]
fn a_servo_of_an_unsupported_model_is_refused_with_its_number_and_the_supported_ones() {
    let report = Fixture::new(with_unsupported(&emulated()), settings()).open().unwrap_err();
    assert!(matches!(report, DeviceError::Unsupported { .. }), "{report:?}");
    let words = format!("{report}: {}", report.cure());
    for expected in ["servo 3 on test", "model number 350", "not supported", "XM430-W350", "XC430-W240"] {
        assert!(words.contains(expected), "{expected} is not in: {words}");
    }
}

#[test]
fn impossible_settings_are_refused_by_key() {
    type Change = fn(&mut DynamixelSettings);
    let changes: [(&str, Change); 10] = [
        ("baud", |s| s.baud = 123),
        ("bus_watchdog_s", |s| s.bus_watchdog_s = 3.0),
        ("silence_s", |s| s.silence_s = f64::NAN),
        ("servos[1].id", |s| s.servos[1].id = 1),
        ("servos[0].id", |s| s.servos[0].id = 253),
        ("servos[3].model", |s| s.servos[3].model = Some("AX-12".to_owned())),
        ("servos[2].homing_offset_rad", |s| s.servos[2].homing_offset_rad = 2.0),
        ("servos[0].position_min_rad", |s| s.servos[0].position_min_rad = 2.0),
        ("servos[0].goal_current_a", |s| s.servos[0].goal_current_a = Some(2.1)),
        ("servos[0].gains", |s| s.servos[0].gains.position_p = 20_000),
    ];
    assert_eq!(settings().check(), Ok(()));
    for (key, change) in changes {
        let mut changed = settings();
        change(&mut changed);
        assert!(matches!(changed.check(), Err(DeviceError::Setting { key: report, .. }) if report == key), "{key}");
    }
    let text = "port = \"x\"\nbaud = 57600\nspeed = 1\nservos = []";
    assert!(toml::from_str::<DynamixelSettings>(text).is_err(), "unknown keys are refused");
    let written = toml::to_string(&settings()).unwrap();
    assert_eq!(toml::from_str::<DynamixelSettings>(&written).unwrap(), settings());
}

#[test]
fn a_servo_that_shut_down_opens_after_a_restart_by_command_only() {
    let mut bench = Fixture::usual();
    bench.world.borrow_mut().emulator.fail(1, HardwareError(0x24));
    let report = bench.open().err();
    let words = "servo 2: overheated, overload".to_owned();
    assert!(matches!(&report, Some(DeviceError::DeviceFault { words: report, .. }) if *report == words), "{report:?}");
    assert!(report.unwrap().cure().contains("servo 2"));
    bench.reboots.ask(1);
    let mut driver = bench.open().unwrap();
    assert!(bench.run(&mut driver, 0.1).is_some() && !bench.reboots.is_any());
}

/// A connection on which another program keeps switching on the torque of servo 1.
struct TorqueMeddlingLine(MemoryBytes);

impl ByteStream for TorqueMeddlingLine {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss> {
        self.0.receive(buffer)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        let mut out = OutgoingPackets::new(64);
        Instruction::SyncWrite { address: 64, count: 1, items: &[1, 1] }.encode(BROADCAST, &mut out);
        self.0.send(out.bytes())?;
        self.0.send(bytes)
    }
}

#[test]
fn a_servo_that_does_not_keep_what_is_written_is_told() {
    let mut bench = Fixture::usual();
    let [ours, theirs] = MemoryBytes::pair();
    bench.world.borrow_mut().end = theirs;
    let wanted = bench.settings.clone();
    let reboots = bench.reboots.clone();
    let report = open_over(TorqueMeddlingLine(ours), &mut bench, &wanted, &reboots).err();
    let Some(DeviceError::Refused { place, command, answer }) = report else { panic!("{report:?}") };
    assert_eq!((place.as_str(), command.as_str()), ("servo 1 on test", "0 in register 64"));
    assert_eq!(answer, "it remains 1");
}

#[test]
fn servos_without_current_hold_the_jaws_and_report_no_current() {
    let bus = || Bus::new(&EmulatedDynamixel { model: 1060, ..emulated() }, None).unwrap();
    let mut wanted = settings();
    let refused = Fixture::new(bus(), wanted.clone()).open().unwrap_err().to_string();
    assert!(refused.contains("current_limit_a") && refused.contains("XL430-W250 does not measure"), "{refused}");
    wanted.servos.iter_mut().for_each(|servo| servo.current_limit_a = 0.0);
    let mut bench = Fixture::new(bus(), wanted.clone());
    let mut driver = bench.open().unwrap();
    assert!(driver.identity().product.starts_with("XL430-W250"));
    let reading = (0..200).find_map(|_| {
        bench.world.borrow_mut().pass(1e-3);
        let now_s = bench.world.borrow().now_s;
        driver.poll(now_s)
    });
    let reading = reading.expect("a reading").value;
    assert!(reading.current_a.iter().all(|current_a| current_a.is_nan()), "{reading:?}");
    assert!(reading.position_rad.iter().all(|angle| angle.abs() < 1.0), "{reading:?}");
    let unlimited = Fixture::new(Bus::new(&emulated(), None).unwrap(), wanted).open().unwrap_err().to_string();
    assert!(unlimited.contains("measures its current and needs a limit"), "{unlimited}");
}
