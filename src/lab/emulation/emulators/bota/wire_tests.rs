use std::{
    net::{Ipv4Addr, SocketAddrV4, UdpSocket},
    time::{Duration, Instant},
};

use nima_devices::{
    ConnectionState, Device as _, DeviceError, DeviceSlot, Health, Loss,
    bota::{BotaDriver, BotaSettings, BotaTimeouts, Transport},
};
use nima_testing::real_time::judged;

use crate::emulators::{
    EmulatedFault, EmulatorThread,
    bota::{EmulatedBota, slow_motion},
};

/// Short timeouts, to keep tests short; the emulated sensors start within them.
const TIMEOUT: BotaTimeouts = BotaTimeouts {
    boot: Duration::from_millis(300),
    answer: Duration::from_millis(100),
    tries: 2,
    init: Duration::from_millis(10),
    stream: Duration::from_millis(200),
};
fn free_udp_port() -> u16 {
    UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

/// Returns a sensor that starts quickly, on a clock that is about to wrap around.
fn emulated() -> EmulatedBota {
    EmulatedBota {
        boot_s: 0.02,
        first_timestamp_us: u32::MAX - 200_000,
        tcp_port: 0,
        destination: SocketAddrV4::new(Ipv4Addr::LOCALHOST, free_udp_port()),
        ..EmulatedBota::default()
    }
}

fn serve(transport: Transport, emulated: EmulatedBota) -> (EmulatorThread, BotaSettings) {
    let serving = EmulatedBota { transport, ..emulated }.with(slow_motion()).serve().unwrap();
    let settings = BotaSettings::new(transport, serving.endpoint.clone());
    (serving, settings)
}

const TRANSPORTS: [Transport; 3] = [Transport::Gen0, Transport::GenA, Transport::Socket];

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn sensors_on_real_wires_are_read_whole_and_without_loss() {
    judged(|| {
        for (transport, product_hz) in TRANSPORTS.into_iter().zip([800.0, 500.0, 500.0]) {
            let (_serving, mut settings) = serve(transport, emulated());
            settings.serial_number = Some("SN000853".to_owned());
            let mut driver = BotaDriver::open_within(&settings, TIMEOUT).unwrap();
            assert_eq!(driver.identity().product, "BFT-SENS-SER-M8");
            assert_eq!(driver.identity().firmware, "1.0.9");
            assert!((driver.rate_hz() - product_hz).abs() < 1e-9);
            let begin = Instant::now();
            let mut times_s: Vec<f64> = Vec::new();
            while begin.elapsed() < Duration::from_millis(500) {
                if let Some(reading) = driver.poll(begin.elapsed().as_secs_f64()) {
                    times_s.push(reading.device_s.unwrap());
                    assert_eq!(reading.value.acceleration_m_s2.is_some(), transport != Transport::Gen0);
                    let weight_n = reading.value.wrench.force_n.z;
                    assert!((-4.0..-2.5).contains(&weight_n), "{transport:?}: {reading:?}");
                }
                std::thread::sleep(Duration::from_micros(500));
            }
            let health = *driver.health();
            assert_eq!(
                (health.lost, health.damaged, health.skipped_bytes, health.out_of_order),
                (0, 0, 0, 0),
                "{health:?}"
            );
            assert!(times_s.windows(2).all(|pair| pair[1] > pair[0]), "{transport:?}");
            let span_s = times_s[times_s.len() - 1] - times_s[0];
            println!("{transport:?}: {} readings in {span_s:.3} s of the sensor", health.readings);
            // More frames may have arrived together with the first one, which cannot be seen here.
            let expected = span_s * product_hz + 1.0;
            assert!(
                (0.0..=20.0).contains(&(health.readings as f64 - expected).round()),
                "{transport:?}: {expected} {health:?}"
            );
        }
    });
}

/// Polls until `done`; returns the time it took, or `None` after 4 s.
fn until(
    slot: &mut DeviceSlot<BotaDriver>,
    zero: Instant,
    mut done: impl FnMut(&Health, bool) -> bool,
) -> Option<Duration> {
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(4) {
        let is_reading = slot.poll(zero.elapsed().as_secs_f64()).is_some();
        if done(slot.health(), is_reading) {
            return Some(begin.elapsed());
        }
        std::thread::sleep(Duration::from_micros(500));
    }
    None
}

/// For every fault, checks that the sensor is lost with `loss` or that `counter` increases, and that readings return
/// after the fault is removed.
fn faults(transport: Transport, faults: &[(EmulatedFault, Expected)]) {
    let (serving, settings) = serve(transport, emulated());
    let mut slot = DeviceSlot::start("bota", move || BotaDriver::open_within(&settings, TIMEOUT)).unwrap();
    let zero = Instant::now();
    for (fault, expected) in faults {
        assert!(until(&mut slot, zero, |_, reading| reading).is_some(), "{transport:?} before {fault:?}");
        let before = *slot.health();
        serving.faults.set(*fault);
        let seen = until(&mut slot, zero, |health, _| match expected {
            Expected::Loss(loss) => health.standing == ConnectionState::Lost(*loss),
            Expected::Counter(counter) => counter(health) > counter(&before),
        });
        let took = seen.unwrap_or_else(|| panic!("{transport:?} {fault:?}: {:?}", slot.health()));
        println!("{transport:?} {fault:?}: seen after {:.1} ms", took.as_secs_f64() * 1e3);
        serving.faults.set(EmulatedFault::None);
    }
    assert!(until(&mut slot, zero, |_, reading| reading).is_some(), "{transport:?} in the end");
}

enum Expected {
    Loss(Loss),
    Counter(fn(&Health) -> u64),
}

use Expected::{Counter, Loss as Loses};

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn faults_of_the_first_generation_that_lose_it() {
    judged(|| {
        faults(
            Transport::Gen0,
            &[
                (EmulatedFault::Silence, Loses(Loss::Silent)),
                (EmulatedFault::Disconnect, Loses(Loss::Disconnected)),
                (EmulatedFault::DeviceFault, Loses(Loss::Device { code: 4 })),
            ],
        );
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn faults_of_the_second_generation_that_lose_it() {
    judged(|| {
        faults(
            Transport::GenA,
            &[
                (EmulatedFault::BadChecksum, Loses(Loss::Corrupt)),
                (EmulatedFault::WrongFrame, Loses(Loss::Corrupt)),
                (EmulatedFault::NotANumber, Loses(Loss::Implausible)),
                (EmulatedFault::Delay, Loses(Loss::Silent)),
            ],
        );
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn faults_in_the_network_that_lose_it() {
    judged(|| {
        faults(
            Transport::Socket,
            &[
                (EmulatedFault::Freeze, Loses(Loss::Implausible)),
                (EmulatedFault::Disconnect, Loses(Loss::Disconnected)),
                (EmulatedFault::WrongFrame, Loses(Loss::Corrupt)),
                (EmulatedFault::Silence, Loses(Loss::Silent)),
            ],
        );
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn faults_that_are_only_counted() {
    judged(|| {
        for transport in TRANSPORTS {
            faults(
                transport,
                &[
                    (EmulatedFault::Loss, Counter(|health| health.lost)),
                    (EmulatedFault::Garbage, Counter(|health| health.skipped_bytes + health.damaged)),
                    (EmulatedFault::Reorder, Counter(|health| health.out_of_order)),
                ],
            );
        }
    });
}

fn trouble(settings: &BotaSettings) -> DeviceError {
    BotaDriver::open_within(settings, TIMEOUT).unwrap_err()
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn troubles_of_the_line_are_told_apart() {
    judged(|| {
        let nowhere = BotaSettings::new(Transport::Gen0, "/dev/nima-no-such-port");
        assert!(matches!(trouble(&nowhere), DeviceError::Absent { .. }));
        let (_serving, settings) = serve(Transport::Gen0, EmulatedBota { baud: Some(115_200), ..emulated() });
        assert!(matches!(trouble(&settings), DeviceError::WrongBaud { baud: 460_800, .. }));
        let (serving, settings) = serve(Transport::Gen0, emulated());
        serving.faults.set(EmulatedFault::Silence);
        assert!(matches!(trouble(&settings), DeviceError::Silent { .. }));
        serving.faults.set(EmulatedFault::None);
        let held = BotaDriver::open_within(&settings, TIMEOUT).unwrap();
        assert!(matches!(trouble(&settings), DeviceError::Busy { .. }));
        drop(held);
        let other = BotaSettings { serial_number: Some("854".to_owned()), ..settings };
        match trouble(&other) {
            DeviceError::OtherSerial { found, .. } => assert!(found.ends_with("853"), "{found}"),
            other => panic!("{other:?}"),
        }
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn the_wrong_generation_is_told_by_its_name() {
    judged(|| {
        for (real, taken_for, name) in
            [(Transport::Gen0, Transport::GenA, "first"), (Transport::GenA, Transport::Gen0, "second")]
        {
            let (_serving, settings) = serve(real, emulated());
            match trouble(&BotaSettings { transport: taken_for, ..settings }) {
                DeviceError::WrongProduct { found, .. } => assert!(found.starts_with(name), "{found}"),
                other => panic!("{other:?}"),
            }
        }
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn a_sensor_without_its_calibration_is_restarted_and_one_that_stays_so_is_refused() {
    judged(|| {
        let (_serving, settings) = serve(Transport::Gen0, EmulatedBota { raw_starts: 2, ..emulated() });
        let driver = BotaDriver::open_within(&settings, TIMEOUT).unwrap();
        assert!(!driver.status().raw);
        for (transport, status, word) in
            [(Transport::Gen0, 8, "raw"), (Transport::GenA, 2, "overrange"), (Transport::Socket, 4, "invalid")]
        {
            let (_serving, settings) = serve(transport, EmulatedBota { status, ..emulated() });
            match trouble(&settings) {
                DeviceError::DeviceFault { words, .. } => assert!(words.contains(word), "{words}"),
                other => panic!("{other:?}"),
            }
        }
    });
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn troubles_of_the_network_are_told_apart() {
    judged(|| {
        let closed = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let nobody = BotaSettings::new(Transport::Socket, closed.to_string());
        assert!(matches!(trouble(&nobody), DeviceError::NobodyListens { .. }));
        let elsewhere = SocketAddrV4::new(Ipv4Addr::new(192, 0, 2, 1), free_udp_port());
        let (_serving, settings) = serve(Transport::Socket, EmulatedBota { destination: elsewhere, ..emulated() });
        match trouble(&settings) {
            DeviceError::SendsElsewhere { to, here, .. } => {
                assert_eq!((to, here.as_str()), (elsewhere.to_string(), "127.0.0.1"));
            }

            other => panic!("{other:?}"),
        }
        let taken = UdpSocket::bind("0.0.0.0:0").unwrap();
        let destination = SocketAddrV4::new(Ipv4Addr::LOCALHOST, taken.local_addr().unwrap().port());
        let (_serving, settings) = serve(Transport::Socket, EmulatedBota { destination, ..emulated() });
        assert!(matches!(trouble(&settings), DeviceError::Busy { .. }));
    });
}

#[test]
fn readings_are_taken_at_one_address_and_from_the_sensor_alone() {
    let destination = SocketAddrV4::new(Ipv4Addr::LOCALHOST, free_udp_port());
    let (_serving, settings) = serve(Transport::Socket, EmulatedBota { destination, ..emulated() });
    // One of several attempts succeeds, even on a busy computer.
    let long = BotaTimeouts { answer: Duration::from_secs(5), stream: Duration::from_secs(5), ..TIMEOUT };
    let mut driver = (0..5).find_map(|_| BotaDriver::open_within(&settings, long).ok()).expect("opened");
    #[cfg(target_os = "linux")]
    UdpSocket::bind(("127.0.0.2", destination.port())).expect("the port is free at this computer's other addresses");
    let stranger = UdpSocket::bind("127.0.0.1:0").unwrap();
    for _ in 0..100 {
        stranger.send_to(b"no frame", destination).ok();
    }
    let begin = Instant::now();
    while driver.health().readings < 50 && begin.elapsed() < Duration::from_mins(1) {
        driver.poll(begin.elapsed().as_secs_f64());
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(driver.health().damaged, 0, "a stranger was heard");
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn a_command_that_the_sensor_refuses_is_told_with_its_words() {
    judged(|| {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let settings = BotaSettings::new(Transport::Socket, listener.local_addr().unwrap().to_string());
        let sensor = std::thread::spawn(move || {
            use std::io::{Read as _, Write as _};
            let (mut stream, _) = listener.accept().unwrap();
            let mut buffer = [0; 64];
            let count = stream.read(&mut buffer).unwrap();
            assert_eq!(&buffer[..count], b"wh,1,2,1\n");
            stream.write_all(b"wh,17,0\n").unwrap();
        });
        match trouble(&settings) {
            DeviceError::Refused { answer, .. } => assert_eq!(answer, "the action failed"),
            other => panic!("{other:?}"),
        }
        sensor.join().unwrap();
    });
}
