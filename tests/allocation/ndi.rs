//! Polling the tracker allocates nothing: binary over TCP, text over TCP, binary over a serial line.
#![cfg(unix)]
use std::time::{Duration, Instant};

use nima_devices::{
    Device as _,
    ndi::{NdiDefinition, NdiDriver, NdiSettings},
};
use nima_emulation::emulators::ndi::{NdiProfile, wandering};
use nima_testing::real_time::{alone, judged};

use crate::counting::calls;

/// Polls until there are 20 readings; returns the allocations of this thread.
#[expect(clippy::unwrap_used, reason = "a test fails by panicking")]
fn allocations(settings: &NdiSettings) -> u64 {
    let mut driver = NdiDriver::open(settings).unwrap();
    let begin = Instant::now();
    let before = calls();
    let mut readings = 0;
    while readings < 20 && begin.elapsed() < Duration::from_mins(1) {
        readings += u32::from(driver.poll(begin.elapsed().as_secs_f64()).is_some());
        if readings == 10 {
            driver.beep(1);
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let after = calls();
    assert_eq!(readings, 20, "{:?}", driver.health());
    after - before
}

#[test]
fn polling_allocates_nothing() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let tool = folder.path().join("tool.rom");
        std::fs::write(&tool, NdiDefinition::emulated("tool").bytes()).unwrap();
        let settings = NdiSettings { tools: vec![tool], ..NdiSettings::default() };
        for firmware in ["Polaris Vega 014", "Polaris Vega 008"] {
            let profile = NdiProfile { firmware: firmware.to_owned(), ..NdiProfile::default() };
            let served = profile.on_network(0, wandering).serve().unwrap();
            let settings = NdiSettings { address: Some(served.endpoint.clone()), ..settings.clone() };
            assert_eq!(allocations(&settings), 0, "{firmware}");
        }
        let served = NdiProfile::default().on_line(None, wandering).serve().unwrap();
        assert_eq!(allocations(&NdiSettings { port: Some(served.endpoint.clone()), ..settings }), 0, "line");
    });
}
