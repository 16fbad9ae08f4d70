//! The driver of the arm allocates nothing in a tick: reading, servoing, moving with a twist, and receiving damaged
//! data.

use std::{thread::sleep, time::Duration};

use nalgebra::Vector3;
use nima_devices::{
    Device as _,
    kinova::{KinovaDriver, KinovaSettings, ToolTwist, open},
};
use nima_emulation::emulators::{
    EmulatedFault,
    kinova::{EmulatedKinova, StandIn},
};
use nima_testing::real_time::{alone, judged};

use crate::counting::calls;

/// Polls once per millisecond; returns the number of allocations.
fn allocations(
    driver: &mut KinovaDriver,
    now_s: &mut f64,
    ticks: u32,
    mut command: impl FnMut(&mut KinovaDriver),
) -> u64 {
    let mut count = 0;
    for _ in 0..ticks {
        sleep(Duration::from_millis(1));
        *now_s += 1e-3;
        let before = calls();
        driver.poll(*now_s);
        command(driver);
        count += calls() - before;
    }
    count
}

#[test]
fn a_tick_of_the_arm_allocates_nothing() {
    let _alone = alone();
    judged(|| {
        let arm = EmulatedKinova { watchdog_ms: 5_000.0, ..EmulatedKinova::default() };
        let serving = arm.with(StandIn::swaying()).serve().unwrap();
        let mut driver = open(&KinovaSettings::at(&serving.endpoint).unwrap()).unwrap();
        let mut now_s = 0.0;
        // Long enough for several keep-alive messages on both connections.
        assert_eq!(allocations(&mut driver, &mut now_s, 400, |_| {}), 0, "reading");
        let twist = ToolTwist { linear_m_s: Vector3::new(0.0, 0.02, 0.0), ..ToolTwist::default() };
        let moving = |driver: &mut KinovaDriver| driver.twist(&twist).unwrap();
        assert_eq!(allocations(&mut driver, &mut now_s, 100, moving), 0, "twist");
        driver.stop();
        let before = calls();
        driver.enter_low_level().unwrap();
        assert_eq!(calls() - before, 0);
        let mut served = 0;
        let servoing = |driver: &mut KinovaDriver| {
            let angles = *driver.command_rad();
            served += u32::from(driver.aim(&angles).is_ok());
        };
        assert_eq!(allocations(&mut driver, &mut now_s, 400, servoing), 0, "servoing");
        assert!(served > 200, "{served}");
        let before = *driver.health();
        for fault in [EmulatedFault::Loss, EmulatedFault::Reorder, EmulatedFault::Garbage, EmulatedFault::BadChecksum] {
            serving.faults.set(fault);
            assert_eq!(allocations(&mut driver, &mut now_s, 100, |_| {}), 0, "{fault:?}");
        }
        assert!(driver.health().damaged > before.damaged && driver.health().readings > 500, "{:?}", driver.health());
    });
}
