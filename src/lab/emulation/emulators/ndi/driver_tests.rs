//! Tests of the driver with the emulator over TCP and a pseudo-terminal: readings, baud rates, every fault that can be
//! provoked here.

use std::{
    io::{Read as _, Write as _},
    net::TcpListener,
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicU32, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use nalgebra::{UnitQuaternion, Vector3};
use nima_devices::{
    ConnectionState, Device, DeviceError, Health, Loss, TRACKED_TOOLS, TimedReading, TrackedTool, TrackerReading,
    ndi::*,
};
use nima_testing::real_time::judged;

use crate::emulators::{
    EmulatorThread,
    ndi::{FRAME_HZ, NdiBody, NdiProfile, wandering},
};

pub(super) fn definitions(count: usize) -> (tempfile::TempDir, Vec<PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let paths = (0..count).map(|k| {
        let path = folder.path().join(format!("tool{k}.rom"));
        std::fs::write(&path, NdiDefinition::emulated(&format!("TOOL_{k}")).bytes()).unwrap();
        path
    });
    let paths = paths.collect();
    (folder, paths)
}

pub(super) fn profile(firmware: &str) -> NdiProfile {
    NdiProfile { firmware: firmware.to_owned(), ..NdiProfile::default() }
}

pub(super) const TEXT_FIRMWARE: &str = "Polaris Vega 008";
pub(super) const BLOCK_FIRMWARE: &str = "Polaris Vega 014";

/// Polls at about 1 kHz until `good`, for at most `seconds`.
pub(super) fn until(
    begin: Instant,
    seconds: f64,
    mut poll: impl FnMut(f64) -> Option<TimedReading<TrackerReading>>,
    mut good: impl FnMut(Option<TimedReading<TrackerReading>>) -> bool,
) -> bool {
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    while Instant::now() < end {
        let reading = poll(begin.elapsed().as_secs_f64());
        if good(reading) {
            return true;
        }
        std::thread::sleep(Duration::from_micros(700));
    }
    false
}

pub(super) fn network(served: &EmulatorThread, tools: Vec<PathBuf>) -> NdiSettings {
    NdiSettings { address: Some(served.endpoint.clone()), tools, ..NdiSettings::default() }
}

pub(super) fn line(served: &EmulatorThread, tools: Vec<PathBuf>) -> NdiSettings {
    NdiSettings { port: Some(served.endpoint.clone()), tools, ..NdiSettings::default() }
}

/// Returns a driver's readings in its first second.
fn attempt(settings: &NdiSettings, form: ReplyForm) -> (Health, Vec<TimedReading<TrackerReading>>) {
    let mut driver = NdiDriver::open(settings).unwrap();
    assert_eq!(driver.form(), form);
    assert_eq!(driver.identity().product, "Polaris Vega");
    let begin = Instant::now();
    let mut readings = Vec::new();
    until(
        begin,
        1.3,
        |now_s| driver.poll(now_s),
        |reading| {
            readings.extend(reading);
            false
        },
    );
    println!("{:?}", driver.health());
    (*driver.health(), readings)
}

/// Checks that the readings of the first second agree with the body, frame by frame. The number of lost frames depends
/// on the machine's load: none on an idle one; at most a tenth is accepted here.
fn follows(settings: &NdiSettings, form: ReplyForm, within_m: f64) {
    // A tenth of a second's stall of the machine makes a tracker look silent, so allow a second and a third attempt.
    let attempts = (0..3).map(|_| attempt(settings, form));
    let complete = |(health, _): &(Health, Vec<_>)| health.standing == ConnectionState::Connected && health.lost <= 8;
    let (health, readings) = attempts.into_iter().find(complete).expect("complete in one of three attempts");
    assert!(health.damaged == 0 && health.out_of_order == 0, "{health:?}");
    assert!(readings.len() as u64 + health.lost >= 70, "{} readings", readings.len());
    println!("{form:?}: {} readings, {:.1} Hz, {} lost", readings.len(), health.rate_hz, health.lost);
    for TimedReading { device_s, value, .. } in &readings {
        let at_s = f64::from(value.frame) / FRAME_HZ;
        assert!((device_s.unwrap() - at_s).abs() < 1e-9);
        for number in 0..settings.tools.len() {
            let (
                TrackedTool::Seen { c_from_tool, position_in_c_m, error_m, .. },
                TrackedTool::Seen { c_from_tool: turned, position_in_c_m: place, error_m: error, .. },
            ) = (value.tools[number], wandering(at_s, number))
            else {
                panic!("tool {number} is not seen")
            };
            assert!((position_in_c_m - place).norm() < within_m);
            assert!(c_from_tool.angle_to(&turned) < 3e-4);
            assert!((error_m - error).abs() < 1e-7);
        }
        assert_eq!(value.tools[settings.tools.len()..].iter().filter(|one| **one != TrackedTool::Absent).count(), 0);
    }
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn over_a_network_every_frame_arrives_in_both_forms() {
    judged(|| {
        let (_folder, tools) = definitions(2);
        for (firmware, form, within_m) in
            [(BLOCK_FIRMWARE, ReplyForm::Binary, 1e-6), (TEXT_FIRMWARE, ReplyForm::Text, 1e-5)]
        {
            let served = profile(firmware).on_network(0, wandering).serve().unwrap();
            follows(&network(&served, tools.clone()), form, within_m);
        }
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn over_a_line_every_frame_arrives_in_binary() {
    judged(|| {
        let (_folder, tools) = definitions(2);
        let served = profile(BLOCK_FIRMWARE).on_line(None, wandering).serve().unwrap();
        follows(&line(&served, tools), ReplyForm::Binary, 1e-6);
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn over_a_line_text_arrives_as_often_as_the_line_carries_it() {
    judged(|| {
        let (_folder, tools) = definitions(1);
        let served = profile(TEXT_FIRMWARE).on_line(None, wandering).serve().unwrap();
        let settings = NdiSettings { baud: 230_400, ..line(&served, tools) };
        follows(&settings, ReplyForm::Text, 1e-5);
    });
}

/// Sends one command at `baud` and waits for its reply, like another program.
fn say(endpoint: &str, baud: u32, command: &NdiCommand<'_>) -> String {
    let mut port = serialport::new(endpoint, baud).timeout(Duration::from_secs(1)).open_native().unwrap();
    port.write_all(command.encode().as_bytes()).unwrap();
    let mut reply = Vec::new();
    while !reply.ends_with(b"\r") {
        let mut byte = [0];
        port.read_exact(&mut byte).unwrap();
        reply.push(byte[0]);
    }
    // The unit changes its baud rate after the reply.
    std::thread::sleep(Duration::from_millis(20));
    String::from_utf8(reply).unwrap()
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn a_line_left_at_another_speed_is_found_or_reset() {
    judged(|| {
        let (_folder, tools) = definitions(1);
        let served = profile(BLOCK_FIRMWARE).on_line(None, wandering).serve().unwrap();
        let settings = line(&served, tools);
        for left_at in [115_200, 38_400] {
            assert_eq!(say(&served.endpoint, 9600, &NdiCommand::Comm { baud: left_at }), "OKAYA896\r");
            assert_eq!(say(&served.endpoint, left_at, &NdiCommand::Init), "OKAYA896\r");
            let mut driver = NdiDriver::open(&settings).unwrap();
            assert!(until(Instant::now(), 1.0, |now_s| driver.poll(now_s), |reading| reading.is_some()));
            assert!(matches!(NdiDriver::open(&settings), Err(DeviceError::Busy { .. })), "one driver for one line");
        }
        assert_eq!(say(&served.endpoint, 9600, &NdiCommand::Init), "OKAYA896\r", "left at its first speed");
    });
}

/// A world that a test changes while the unit tracks.
#[derive(Clone, Default)]
struct World {
    mode: Arc<AtomicU32>,
    system: Arc<AtomicU32>,
    beeps: Arc<AtomicUsize>,
}

impl NdiBody for World {
    fn tool(&mut self, unit_s: f64, number: usize) -> TrackedTool {
        match (self.mode.load(Ordering::Relaxed), number) {
            (1, 0) => TrackedTool::Missing { out_of_volume: false },
            (2, 0) => TrackedTool::Missing { out_of_volume: true },
            (3, 0) => TrackedTool::Disabled,
            (4, 0) => TrackedTool::Absent,
            (5, 0) => TrackedTool::Seen {
                c_from_tool: UnitQuaternion::identity(),
                position_in_c_m: Vector3::new(0.0, 0.0, -1.0),
                error_m: 1e-4,
                at_the_edge: true,
            },
            (6, 0) => TrackedTool::Seen {
                c_from_tool: UnitQuaternion::identity(),
                position_in_c_m: Vector3::new(0.0, 0.0, -50.0),
                error_m: 1e-4,
                at_the_edge: false,
            },
            _ => wandering(unit_s, number),
        }
    }

    fn system(&mut self) -> SystemStatus {
        SystemStatus(self.system.load(Ordering::Relaxed) as u16)
    }

    fn beep(&mut self, times: u8) {
        self.beeps.fetch_add(usize::from(times), Ordering::Relaxed);
    }
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn what_happens_to_a_tool_is_told() {
    judged(|| {
        let (_folder, tools) = definitions(2);
        for firmware in [BLOCK_FIRMWARE, TEXT_FIRMWARE] {
            let world = World::default();
            let served = profile(firmware).on_network(0, world.clone()).serve().unwrap();
            let mut driver = NdiDriver::open(&network(&served, tools.clone())).unwrap();
            let begin = Instant::now();
            for mode in 0..6 {
                world.mode.store(mode, Ordering::Relaxed);
                let right = |tool: &TrackedTool| match mode {
                    0 => matches!(tool, TrackedTool::Seen { at_the_edge: false, .. }),
                    1 => *tool == TrackedTool::Missing { out_of_volume: false },
                    2 => *tool == TrackedTool::Missing { out_of_volume: true },
                    5 => matches!(tool, TrackedTool::Seen { at_the_edge: true, .. }),
                    _ => *tool == TrackedTool::Disabled,
                };
                let seen = until(
                    begin,
                    1.0,
                    |now_s| driver.poll(now_s),
                    |reading| {
                        reading.is_some_and(|reading| {
                            assert!(
                                matches!(reading.value.tools[1], TrackedTool::Seen { .. }),
                                "the other is not touched"
                            );
                            right(&reading.value.tools[0])
                        })
                    },
                );
                assert!(seen, "mode {mode}, {firmware}: {:?}", driver.health());
            }
            assert!(driver.port_status()[0].has(PortStatus::PARTLY_OUT));
            driver.beep(3);
            let beeped = |_| world.beeps.load(Ordering::Relaxed) == 3;
            assert!(until(begin, 1.0, |now_s| driver.poll(now_s), beeped));
            assert!(until(begin, 1.0, |now_s| driver.poll(now_s), |reading| reading.is_some()), "and tracks on");
            world.mode.store(6, Ordering::Relaxed);
            let mut last = ConnectionState::Connected;
            until(
                begin,
                1.0,
                |now_s| {
                    driver.poll(now_s);
                    last = driver.health().standing;
                    None
                },
                |_| false,
            );
            assert_eq!(last, ConnectionState::Lost(Loss::Implausible), "50 m away is nowhere");
            assert_eq!(driver.health().refused, 1);
        }
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn dropping_it_stops_tracking() {
    judged(|| {
        let (_folder, tools) = definitions(1);
        let served = NdiProfile::default().on_network(0, wandering).serve().unwrap();
        let mut driver = NdiDriver::open(&network(&served, tools)).unwrap();
        let begin = Instant::now();
        assert!(until(begin, 1.0, |now_s| driver.poll(now_s), |reading| reading.is_some()));
        drop(driver);
        // The next client gets the answers of a unit that is not tracking.
        let mut stream = std::net::TcpStream::connect(&served.endpoint).unwrap();
        stream.write_all(b"TX 0801\r").unwrap();
        let mut reply = [0; 12];
        stream.read_exact(&mut reply).unwrap();
        assert_eq!(&reply, b"ERROR0C4E42\r");
    });
}

/// Starts a TCP server that sends `reply` to every request; returns its address.
fn stranger(reply: &'static [u8]) -> (String, std::thread::JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let thread = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut buffer = [0; 256];
        while let Ok(1..) = stream.read(&mut buffer) {
            if stream.write_all(reply).is_err() || reply.is_empty() {
                return;
            }
        }
    });
    (address, thread)
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn who_is_not_a_tracker_is_told() {
    judged(|| {
        let (_folder, tools) = definitions(1);
        let open = |address: String| {
            NdiDriver::open(&NdiSettings { address: Some(address), tools: tools.clone(), ..NdiSettings::default() })
        };
        let (address, thread) = stranger(b"HTTP/1.1 400 Bad Request\r\n\r\n");
        assert!(matches!(open(address), Err(DeviceError::WrongProduct { .. })));
        thread.join().unwrap();
        let (address, thread) = stranger(b"ERROR1538C2\r");
        let refused = open(address);
        assert!(matches!(&refused, Err(DeviceError::Refused { command, .. }) if command == "INIT"), "{refused:?}");
        thread.join().unwrap();
        let (address, thread) = stranger(b"");
        assert!(matches!(open(address.clone()), Err(DeviceError::Other { .. })), "closed");
        thread.join().unwrap();
        assert!(matches!(open(address), Err(DeviceError::NobodyListens { .. })));
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn a_unit_with_a_fault_is_told_while_opening() {
    judged(|| {
        let (_folder, tools) = definitions(1);
        let world = World::default();
        world.system.store(1 << 9, Ordering::Relaxed);
        let served = NdiProfile::default().on_network(0, world).serve().unwrap();
        let trouble = NdiDriver::open(&network(&served, tools)).unwrap_err();
        assert!(
            matches!(&trouble, DeviceError::DeviceFault { words, .. } if words.contains("temperature")),
            "{trouble}"
        );
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn impossible_settings_are_told() {
    let (folder, tools) = definitions(5);
    let key_of = |settings: &NdiSettings| match NdiDriver::open(settings) {
        Err(DeviceError::Setting { key, .. } | DeviceError::File { key, .. }) => key,
        other => panic!("{other:?}"),
    };
    let good =
        NdiSettings { address: Some("127.0.0.1:1".to_owned()), tools: tools[..1].to_vec(), ..NdiSettings::default() };
    assert_eq!(key_of(&NdiSettings { port: Some("/dev/x".to_owned()), ..good.clone() }), "address");
    assert_eq!(key_of(&NdiSettings { address: None, ..good.clone() }), "address");
    assert_eq!(key_of(&NdiSettings { baud: 9600, ..good.clone() }), "baud");
    assert_eq!(key_of(&NdiSettings { tools: tools.clone(), ..good.clone() }), "tools");
    assert_eq!(key_of(&NdiSettings { tools: vec![], ..good.clone() }), "tools");
    assert_eq!(key_of(&NdiSettings { frame_hz: f64::NAN, ..good.clone() }), "frame_hz");
    let absent = folder.path().join("absent.rom");
    assert_eq!(key_of(&NdiSettings { tools: vec![tools[0].clone(), absent], ..good.clone() }), "tools[1]");
    let strange = folder.path().join("strange.rom");
    std::fs::write(&strange, "a text").unwrap();
    assert_eq!(key_of(&NdiSettings { tools: vec![strange], ..good.clone() }), "tools[0]");
    let copy = folder.path().join("copy.rom");
    std::fs::copy(&tools[0], &copy).unwrap();
    assert_eq!(
        key_of(&NdiSettings { tools: vec![tools[0].clone(), tools[1].clone(), copy], ..good.clone() }),
        "tools[2]"
    );
    assert_eq!(key_of(&NdiSettings { tools: vec![tools[0].clone(), tools[0].clone()], ..good.clone() }), "tools[1]");
    let line = NdiSettings { address: None, port: Some("/dev/not-there".to_owned()), ..good };
    assert!(matches!(NdiDriver::open(&line), Err(DeviceError::Absent { .. })));
    assert_eq!(TRACKED_TOOLS, 4);
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn settings_are_read_as_documented() {
    let text = "address = \"10.0.0.5\"\ntools = [\"a.rom\"]\nreplies = \"text\"\n";
    let settings: NdiSettings = toml::from_str(text).unwrap();
    assert_eq!((settings.place().as_str(), settings.replies, settings.baud), ("10.0.0.5:8765", Replies::Text, 115_200));
    assert!(toml::from_str::<NdiSettings>("adress = \"x\"").is_err());
}
