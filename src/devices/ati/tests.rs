use super::{
    codec::{RECORD_BYTES, RdtCommand, RdtRecord},
    *,
};
use crate::{ConnectionState, Device as _, DeviceError, Loss, transport::MemoryDatagrams};

fn page(changes: &[(&str, &str)]) -> String {
    let mut page = "HTTP/1.0 200 OK\r\n\r\n<?xml version=\"1.0\"?><netft><prodname>Net F/T</prodname><setserial>FT12345</setserial>\
        <cfgcpf>1000000</cfgcpf><cfgcpt>2000000</cfgcpt><scfgfu>N</scfgfu><scfgtu>N-m</scfgtu>\
        <comrdte>Enabled</comrdte><comrdtrate>1000</comrdtrate></netft>"
        .to_owned();
    for (from, to) in changes {
        assert!(page.contains(from));
        page = page.replace(from, to);
    }
    page
}

fn driver() -> (AtiDriver, MemoryDatagrams) {
    let [ours, theirs] = MemoryDatagrams::pair();
    let settings = AtiSettings::at("127.0.0.1").unwrap();
    let configuration = AtiConfiguration::of_page("here", &page(&[])).unwrap();
    (AtiDriver::over(Box::new(ours), &settings, configuration), theirs)
}

fn send(to: &mut MemoryDatagrams, number: u32, status: u32) {
    use crate::transport::TransportDatagrams as _;
    let record =
        RdtRecord { number, measurement: 7 * number, status, counts: [1_000_000, 0, -2_500_000, 0, 400_000, 0] };
    to.send(&record.encode()).unwrap();
}

#[test]
fn requests_and_records_have_the_bytes_of_the_manual() {
    assert_eq!(RdtCommand::StartRealTime.encode(), [0x12, 0x34, 0, 2, 0, 0, 0, 0]);
    assert_eq!(RdtCommand::Stop.encode(), [0x12, 0x34, 0, 0, 0, 0, 0, 0]);
    for command in [RdtCommand::Stop, RdtCommand::StartRealTime] {
        assert_eq!(RdtCommand::decode(&command.encode()), Some(command));
    }
    let record = RdtRecord { number: 1, measurement: 2, status: 0x8000_0000, counts: [-1, 2, -3, 4, -5, i32::MIN] };
    let bytes = record.encode();
    assert_eq!((&bytes[..4], &bytes[8..16]), (&[0, 0, 0, 1][..], &[0x80, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF][..]));
    assert_eq!(RdtRecord::decode(&bytes), Some(record));
    let mut random = fastrand::Rng::with_seed(5);
    for length in 0..80 {
        let bytes: Vec<u8> = (0..length).map(|_| random.u8(..)).collect();
        assert_eq!(RdtRecord::decode(&bytes).is_some(), length == RECORD_BYTES);
        RdtCommand::decode(&bytes);
    }
}

#[test]
fn counts_and_units_come_from_the_page() {
    let read = |changes: &[(&str, &str)]| AtiConfiguration::of_page("10.0.0.1:80", &page(changes));
    let usual = read(&[]).unwrap();
    assert_eq!((usual.counts, usual.rate_hz), ([1e6, 2e6], Some(1000.0)));
    assert_eq!(usual.identity.serial, "FT12345");
    let other = read(&[(">N<", ">lbf<"), (">N-m<", ">lbf-in<")]).unwrap();
    assert!((other.counts[0] * 4.448_221_6 - 1e6).abs() < 1.0 && (other.counts[1] * 0.112_984_83 - 2e6).abs() < 1.0);
    let unit = read(&[(">N<", ">stone<")]).unwrap_err();
    assert!(unit.to_string().contains("stone") && unit.cure().contains("N and N-m"), "{unit}");
    let disabled = read(&[("Enabled", "Disabled")]).unwrap_err();
    assert!(matches!(disabled, DeviceError::NotReady { .. }), "{disabled}");
    for broken in ["cfgcpf>1000000", "cfgcpt>2000000"] {
        assert!(matches!(read(&[(broken, "x>0")]).unwrap_err(), DeviceError::WrongProduct { .. }));
    }
}

#[test]
fn readings_are_in_newtons_and_gaps_faults_and_silence_are_reported() {
    let (mut driver, mut sensor) = driver();
    send(&mut sensor, 10, 0);
    let reading = driver.poll(0.0).unwrap();
    let wrench = reading.value.wrench;
    assert_eq!((wrench.force_n.as_slice(), wrench.torque_nm.y), (&[1.0, 0.0, -2.5][..], 0.2));
    assert!(reading.value.acceleration_m_s2.is_none() && reading.value.temperature_c.is_nan());
    send(&mut sensor, 13, 0);
    assert_eq!(driver.poll(0.003).unwrap().device_s, Some(0.003));
    assert_eq!(driver.health().lost, 2);
    send(&mut sensor, 12, 0);
    assert!(driver.poll(0.004).is_none() && driver.health().out_of_order == 1);
    send(&mut sensor, 14, 0x8000_0000);
    assert!(driver.poll(0.005).is_none() && driver.health().refused == 1);
    assert!(driver.poll(0.030).is_none());
    assert_eq!(driver.health().standing, ConnectionState::Lost(Loss::Device { code: 0x8000_0000 }));
    let (mut driver, _sensor) = self::driver();
    assert!(driver.poll(0.0).is_none() && driver.poll(0.1).is_none());
    assert_eq!(driver.health().standing, ConnectionState::Lost(Loss::Silent));
}

#[test]
fn settings_are_checked_and_read_from_an_endpoint() {
    let good = AtiSettings::at("127.0.0.1 rdt=1 http=2").unwrap();
    assert_eq!((good.rdt_port, good.http_port, good.check()), (1, 2, Ok(())));
    assert!(AtiSettings::at("127.0.0.1 udp=1").is_none() && AtiSettings::at("").is_none());
    let key = |settings: AtiSettings| match settings.check() {
        Err(DeviceError::Setting { key, .. }) => key,
        other => panic!("{other:?}"),
    };
    assert_eq!(key(AtiSettings { host: " ".to_owned(), ..good.clone() }), "host");
    assert_eq!(key(AtiSettings { rate_hz: f64::NAN, ..good.clone() }), "rate_hz");
    assert_eq!(key(AtiSettings { counts_per_n: Some(1e6), ..good.clone() }), "counts_per_nm");
    assert_eq!(key(AtiSettings { counts_per_n: Some(0.0), counts_per_nm: Some(1e6), ..good }), "counts_per_n");
}
