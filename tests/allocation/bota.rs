//! Reading a force-torque sensor from a real serial line allocates nothing.
#![cfg(unix)]

use std::time::{Duration, Instant};

use nima_devices::{
    ConnectionState, Device as _,
    bota::{BotaDriver, BotaSettings, Transport},
};
use nima_emulation::emulators::{
    EmulatedFault,
    bota::{EmulatedBota, slow_motion},
};
use nima_testing::real_time::{alone, judged};

use crate::counting::calls;

#[test]
fn polling_allocates_nothing_also_in_a_damaged_stream_and_when_the_sensor_is_lost() {
    let _alone = alone();
    judged(|| {
        let serving = EmulatedBota::default().with(slow_motion()).serve().unwrap();
        let mut driver = BotaDriver::open(&BotaSettings::new(Transport::GenA, serving.endpoint.clone())).unwrap();
        let begin = Instant::now();
        for fault in [EmulatedFault::None, EmulatedFault::Garbage, EmulatedFault::Reorder, EmulatedFault::BadChecksum] {
            serving.faults.set(fault);
            let before = calls();
            for _ in 0..200 {
                driver.poll(begin.elapsed().as_secs_f64());
                std::thread::sleep(Duration::from_millis(1));
            }
            assert_eq!(calls() - before, 0, "{fault:?}");
        }
        let health = driver.health();
        assert!(health.readings > 50 && health.damaged > 0, "{health:?}");
        assert!(matches!(health.standing, ConnectionState::Lost(_)));
    });
}
