//! Test: the driver of the servos allocates nothing while it runs on a real terminal.
#![cfg(unix)]

use std::time::Instant;

use nima_devices::{
    Device as _,
    dynamixel::{DynamixelSettings, GoalResult, open},
};
use nima_emulation::emulators::dynamixel::EmulatedDynamixel;
use nima_testing::real_time::{alone, judged};

use crate::counting::calls;

const SERVO: &str = "position_min_rad = -1.0\nposition_max_rad = 1.0\ncurrent_limit_a = 1.0\n";

#[test]
fn running_servos_allocates_nothing() {
    let _alone = alone();
    judged(|| {
        let emulated = EmulatedDynamixel { baud: 4_000_000, ..EmulatedDynamixel::default() };
        let serving = emulated.with(None).unwrap().serve().unwrap();
        let servos = [1, 2, 3, 4].map(|id| format!("[[servos]]\nid = {id}\n{SERVO}")).concat();
        let text = format!("port = \"{}\"\nbaud = 4000000\nsilence_s = 0.5\n{servos}", serving.endpoint);
        let settings: DynamixelSettings = toml::from_str(&text).unwrap();
        let mut driver = open(&settings).unwrap();
        let begin = Instant::now();
        let before = calls();
        let mut readings = 0;
        while begin.elapsed().as_secs_f64() < 0.8 {
            readings += u32::from(driver.poll(begin.elapsed().as_secs_f64()).is_some());
            if readings == 20 {
                driver.set_torque(true);
            }
            if driver.is_torque_on() {
                assert_ne!(driver.set_goals(&[0.1; 4]), GoalResult::Refused);
            }
            std::thread::yield_now();
        }
        assert_eq!(calls() - before, 0);
        assert!(readings > 20 && driver.is_torque_on(), "{:?}", driver.health());
    });
}
