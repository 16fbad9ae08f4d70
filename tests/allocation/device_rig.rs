//! Reading all devices of a rig, and summarising their data, allocates nothing.
#![cfg(target_os = "linux")]

use std::time::{Duration, Instant};

use nima_devices::ConnectionState;
use nima_machine::rig::{DeviceRig, Outputs, Rig as _, SIDES};
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{elsewhere, started};

use crate::counting::calls;

#[test]
fn reading_the_devices_and_handing_over_what_they_delivered_allocates_nothing() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let devices = elsewhere(folder.path());
        let _emulated = started(&devices);
        let (mut rig, roster) = DeviceRig::start(&devices, 1e-3, [true; SIDES]).unwrap();
        let begin = Instant::now();
        let now_s = || begin.elapsed().as_secs_f64();
        let all_there = |rig: &DeviceRig| {
            rig.health().devices[..roster.len()].iter().all(|health| health.standing == ConnectionState::Connected)
        };
        while !all_there(&rig) {
            assert!(begin.elapsed() <= Duration::from_mins(2), "never: all devices; {:?}", rig.health().devices);
            rig.read(now_s());
            std::thread::sleep(Duration::from_millis(1));
        }
        rig.gauges(now_s());
        let before = calls();
        let mut readings = 0;
        for tick in 1..=500 {
            rig.read(now_s());
            rig.write(now_s(), &[Outputs::SAFE; SIDES]);
            while rig.event().is_some() {}
            if tick % 100 == 0 {
                let gauges = rig.gauges(now_s()).unwrap();
                readings += gauges.devices[..roster.len()].iter().map(|gauge| gauge.channels[0].count).sum::<u32>();
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(calls() - before, 0);
        assert!(readings > 1000, "{readings} readings were summed up");
    });
}
