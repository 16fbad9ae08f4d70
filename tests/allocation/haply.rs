//! Test: a force and its answer on a Haply handle's line allocate nothing.

use std::{
    collections::VecDeque,
    sync::{
        Arc, Mutex,
        atomic::{AtomicU8, Ordering::Relaxed},
    },
};

use nalgebra::Vector3;
use nima_devices::{
    ConnectionState, Device as _, Leader as _, Loss,
    haply::{
        CENTRE_M, HaplyDriver, HaplySettings,
        codec::{DeviceInfo, HaplyState, WAKE_UP},
    },
    transport::ByteStream,
};
use nima_testing::real_time::alone;

use crate::counting::calls;

/// Modes of the handle.
const ANSWERS: u8 = 0;
const ANSWERS_NONSENSE: u8 = 1;
const IS_SILENT: u8 = 2;

struct Line {
    does: Arc<AtomicU8>,
    waiting: Mutex<VecDeque<u8>>,
}

impl ByteStream for Line {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss> {
        let mut waiting = self.waiting.lock().unwrap();
        let count = waiting.len().min(buffer.len());
        buffer.iter_mut().zip(waiting.drain(..count)).for_each(|(to, byte)| *to = byte);
        Ok(count)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        let mut waiting = self.waiting.lock().unwrap();
        let mut state = HaplyState { position_m: CENTRE_M.map(|axis| axis as f32), velocity_m_s: [0.0; 3] };
        match self.does.load(Relaxed) {
            ANSWERS if bytes == [WAKE_UP] => waiting.extend(DeviceInfo::default().encode()),
            ANSWERS => waiting.extend(state.encode()),
            ANSWERS_NONSENSE => {
                state.position_m[0] = f32::NAN;
                waiting.extend([7; 9]);
                waiting.extend(state.encode());
            }
            _ => {}
        }
        Ok(())
    }
}

#[test]
fn polling_and_pushing_allocate_nothing_also_when_the_handle_talks_nonsense_or_is_silent() {
    let _alone = alone();
    for wrong in [ANSWERS_NONSENSE, IS_SILENT] {
        let does = Arc::new(AtomicU8::new(ANSWERS));
        let line = Line { does: Arc::clone(&does), waiting: Mutex::new(VecDeque::with_capacity(4096)) };
        let mut driver = HaplyDriver::over(Box::new(line), &HaplySettings::at("/dev/ttyACM0")).unwrap();
        driver.switch_force(true);
        let mut now_s = 0.0;
        for what in [ANSWERS, wrong] {
            does.store(what, Relaxed);
            let before = calls();
            for _ in 0..100 {
                now_s += 1e-3;
                driver.poll(now_s);
                driver.set_force(Vector3::new(1.0, 2.0, 3.0), 0.0);
            }
            assert_eq!(calls() - before, 0, "{what}");
        }
        let health = driver.health();
        assert!(health.readings > 90 && matches!(health.standing, ConnectionState::Lost(_)), "{health:?}");
    }
}
