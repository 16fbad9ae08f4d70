use super::*;
use crate::{
    bota::codec::{INERTIAL_BYTES, Inertial},
    transport::{ByteStream as _, MemoryBytes, MemoryDatagrams, TransportDatagrams as _},
};

const RATE_HZ: f64 = 1000.0;

fn over_memory(rate_hz: f64) -> (BotaDriver, MemoryBytes) {
    let [near, far] = MemoryBytes::pair();
    let link = BotaLink::new(Box::new(near), None);
    let opened = OpenSensor { link, identity: DeviceIdentity::default(), rate_hz, low_latency: false, stop: b"C\n" };
    (BotaDriver::of(opened), far)
}

fn frame(k: u32) -> BotaFrame {
    BotaFrame {
        force_n: [k as f32, 2.0, 3.0],
        timestamp_us: (u32::MAX - 5_500).wrapping_add(k * 1000),
        ..BotaFrame::default()
    }
}

fn bytes_of(frame: &BotaFrame) -> Vec<u8> {
    let mut buffer = [0; INERTIAL_BYTES];
    let length = frame.encode(&mut buffer);
    buffer[..length].to_vec()
}

/// Returns a driver after ten good readings, 1 ms apart.
fn running() -> (BotaDriver, MemoryBytes) {
    let (mut driver, mut far) = over_memory(RATE_HZ);
    assert_eq!(driver.poll(0.0), None);
    for k in 1..=10 {
        far.send(&bytes_of(&frame(k))).unwrap();
        let reading = driver.poll(f64::from(k) * 1e-3).unwrap();
        assert!((reading.value.wrench.force_n.x - f64::from(k)).abs() < 1e-12);
    }
    (driver, far)
}

/// Returns why the driver is lost, and how long after the last good reading, ms, if the line delivers `bytes` in each
/// tick.
fn lost_after(mut bytes: impl FnMut(u32) -> Vec<u8>) -> (Loss, u32, Health) {
    let (mut driver, mut far) = running();
    for k in 11..100 {
        far.send(&bytes(k)).unwrap();
        assert_eq!(driver.poll(f64::from(k) * 1e-3), None);
        if let ConnectionState::Lost(loss) = driver.health().standing {
            assert_eq!(driver.poll(f64::from(k) * 1e-3 + 1.0), None, "and stays so");
            return (loss, k - 10, *driver.health());
        }
    }
    panic!("never lost: {:?}", driver.health());
}

#[test]
fn time_goes_on_and_missing_late_and_repeated_readings_are_counted() {
    let (mut driver, mut far) = running();
    assert_eq!((driver.health().lost, driver.health().readings), (0, 10));
    // Reading 11 is late, 12 is missing, 13 is duplicated, 20 is throttled.
    for k in [13, 11, 13] {
        far.send(&bytes_of(&frame(k))).unwrap();
    }
    let reading = driver.poll(0.013).unwrap();
    let zero_s = f64::from(u32::MAX - 5_500) * 1e-6;
    assert!((reading.device_s.unwrap() - zero_s - 0.013).abs() < 1e-9, "the counter began again: {reading:?}");
    assert_eq!((driver.health().lost, driver.health().out_of_order), (1, 2));
    far.send(&bytes_of(&BotaFrame { status: 1, ..frame(14) })).unwrap();
    let status = driver.poll(0.014).unwrap().value.status;
    assert!(status.throttled && status.is_usable());
    assert_eq!(driver.health().standing, ConnectionState::Connected);
}

#[test]
fn every_loss_is_told_within_twenty_milliseconds_by_its_cause() {
    let spoilt = |k: u32, spoil: fn(&mut BotaFrame)| {
        let mut frame = frame(k);
        spoil(&mut frame);
        bytes_of(&frame)
    };
    let (loss, ms, _) = lost_after(|_| Vec::new());
    assert_eq!((loss, ms), (Loss::Silent, 18));
    let (loss, ms, health) = lost_after(|k| {
        let mut bytes = bytes_of(&frame(k));
        bytes[36] ^= 1;
        bytes
    });
    assert_eq!((loss, ms), (Loss::Corrupt, 18));
    assert!(health.damaged >= 17 && health.skipped_bytes >= 17 * 37, "{health:?}");
    let (loss, _, health) = lost_after(|k| vec![k as u8 & 0x7F; 40]);
    assert_eq!((loss, health.damaged), (Loss::Corrupt, 0), "no frame at all");
    for (bits, code) in [(2, 2), (4, 4), (8, 8), (0b1_0110, 0b0110)] {
        let (loss, ms, health) = lost_after(|k| bytes_of(&BotaFrame { status: bits, ..frame(k) }));
        assert_eq!((loss, ms, health.refused), (Loss::Device { code }, 18, 18));
    }
    let impossible: [fn(&mut BotaFrame); 4] = [
        |frame| frame.force_n[2] = f32::NAN,
        |frame| frame.torque_nm[0] = f32::INFINITY,
        |frame| frame.force_n[0] = -2e5,
        |frame| {
            let acceleration_m_s2 = [0.0, f32::NAN, 0.0];
            frame.inertial = Some(Inertial { acceleration_m_s2, ..Inertial::default() });
        },
    ];
    for spoil in impossible {
        let (loss, ms, health) = lost_after(|k| spoilt(k, spoil));
        assert_eq!((loss, ms, health.refused), (Loss::Implausible, 18, 18));
    }
    let (loss, ms, health) = lost_after(|_| bytes_of(&frame(10)));
    assert_eq!((loss, ms, health.out_of_order), (Loss::Implausible, 18, 18), "a clock that stands still");
}

#[test]
fn a_short_disturbance_is_counted_and_loses_nothing_else() {
    let (mut driver, mut far) = running();
    far.send(&bytes_of(&BotaFrame { status: 4, ..frame(11) })).unwrap();
    far.send(&bytes_of(&BotaFrame { force_n: [f32::NAN; 3], ..frame(12) })).unwrap();
    far.send(&[0xAA; 5]).unwrap();
    assert_eq!(driver.poll(0.012), None);
    assert_eq!(driver.status(), ForceStatus::default(), "of the newest frame");
    for k in 13..100 {
        far.send(&bytes_of(&frame(k))).unwrap();
        driver.poll(f64::from(k) * 1e-3);
    }
    let health = driver.health();
    assert_eq!(health.standing, ConnectionState::Connected);
    assert_eq!((health.refused, health.lost, health.damaged, health.skipped_bytes), (2, 0, 1, 5));
    assert_eq!(health.readings, 97);
}

#[test]
fn slow_sensors_get_the_time_of_five_readings_and_a_cut_line_none() {
    let (mut driver, _far) = over_memory(50.0);
    driver.poll(0.0);
    driver.poll(0.099);
    assert_eq!(driver.health().standing, ConnectionState::Opening);
    driver.poll(0.101);
    assert_eq!(driver.health().standing, ConnectionState::Lost(Loss::Silent));
    let (mut driver, far) = running();
    far.cut();
    driver.poll(0.011);
    assert_eq!(driver.health().standing, ConnectionState::Lost(Loss::Disconnected));
}

#[test]
fn what_came_before_the_first_poll_is_old_and_the_sensor_is_stopped_in_the_end() {
    let (mut driver, mut far) = over_memory(RATE_HZ);
    far.send(&bytes_of(&frame(1))).unwrap();
    far.send(&bytes_of(&frame(2))[..20]).unwrap();
    assert_eq!(driver.poll(0.0), None);
    far.send(&bytes_of(&frame(2))[20..]).unwrap();
    assert_eq!(driver.poll(0.002), None);
    far.send(&bytes_of(&frame(3))).unwrap();
    assert!(driver.poll(0.003).is_some());
    assert_eq!((driver.health().skipped_bytes, driver.health().damaged, driver.health().lost), (0, 0, 0));
    driver.close();
    let mut buffer = [0; 8];
    let count = far.receive(&mut buffer).unwrap();
    assert_eq!(&buffer[..count], b"C\n");
}

#[test]
fn datagrams_of_a_wrong_length_are_damaged_ones() {
    let [near, _far_control] = MemoryBytes::pair();
    let [stream, mut far] = MemoryDatagrams::pair();
    let link = BotaLink::new(Box::new(near), Some(Box::new(stream)));
    let mut driver = BotaDriver::of(OpenSensor {
        link,
        identity: DeviceIdentity::default(),
        rate_hz: RATE_HZ,
        low_latency: true,
        stop: b"x",
    });
    driver.poll(0.0);
    let good = bytes_of(&BotaFrame { inertial: Some(Inertial::default()), ..frame(1) });
    far.send(&good).unwrap();
    assert!(driver.poll(0.001).is_some());
    let longer = [good.as_slice(), &[0; 9]].concat();
    for bad in [&good[..60], &longer, &[], &[1, 2, 3]] {
        far.send(bad).unwrap();
    }
    assert_eq!(driver.poll(0.002), None);
    assert_eq!((driver.health().damaged, driver.health().readings), (4, 1));
}
