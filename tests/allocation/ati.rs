//! Reading a force sensor over the network allocates nothing.

use std::time::{Duration, Instant};

use nima_devices::{
    Device as _,
    ati::{AtiDriver, AtiSettings},
};
use nima_emulation::emulators::{EmulatedFault, ati::EmulatedAti, bota::slow_motion};
use nima_testing::real_time::{alone, judged};

use crate::counting::calls;

#[test]
fn polling_allocates_nothing_also_with_damaged_records() {
    let _alone = alone();
    judged(|| {
        let serving = EmulatedAti::default().with(slow_motion()).serve().unwrap();
        let mut driver = AtiDriver::open(&AtiSettings::at(&serving.endpoint).unwrap()).unwrap();
        let begin = Instant::now();
        for fault in [EmulatedFault::None, EmulatedFault::Loss, EmulatedFault::BadChecksum] {
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
    });
}
