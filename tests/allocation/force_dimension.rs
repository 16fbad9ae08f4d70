//! Polling a haptic handle and setting forces allocates nothing on the loop's thread.

use std::time::{Duration, Instant};

use nalgebra::Vector3;
use nima_devices::{
    Device as _,
    force_dimension::{ForceDimensionSettings, open},
};
use nima_emulation::emulators::force_dimension::{EmulatedForceDimension, EmulatedHand, stand_in};
use nima_testing::real_time::{alone, judged};

use crate::counting::calls;

#[test]
fn a_tick_with_the_handle_allocates_nothing() {
    let _alone = alone();
    judged(|| {
        let serving = EmulatedForceDimension::default().with(EmulatedHand::default().body()).serve().unwrap();
        let emulator = Some(serving.endpoint.parse().unwrap());
        let library = stand_in();
        assert!(library.is_some(), "cargo builds the stand-in library before the tests");
        let mut driver =
            open(&ForceDimensionSettings { library, emulator, ..ForceDimensionSettings::default() }).unwrap();
        driver.enable_force();
        let begin = Instant::now();
        let mut readings = 0;
        let mut events = 0;
        let before = calls();
        while readings < 300 && begin.elapsed() < Duration::from_mins(1) {
            readings += u32::from(driver.poll(begin.elapsed().as_secs_f64()).is_some());
            driver.set_force(Vector3::new(0.5, f64::from(readings) * 1e-3, 0.0), 0.1);
            events += u32::from(driver.take_event().is_some());
            std::thread::sleep(Duration::from_micros(500));
        }
        assert_eq!(calls() - before, 0);
        assert!(readings >= 300 && events == 1, "{readings} readings, {events} events, {:?}", driver.health());
    });
}
