//! Velocities from the last positions read, computed like the SDK's, and the wrist's angles.

use std::{collections::VecDeque, time::Instant};

use crate::wire::DeviceReply;

/// The stored part of one reading.
#[derive(Clone, Copy)]
struct ReadingRecord {
    at: Instant,
    position_m: [f64; 3],
    gripper_rad: f64,
}

/// Recent readings.
pub(crate) struct ReadingHistory {
    past: VecDeque<ReadingRecord>,
    /// Window, s.
    pub(crate) window_s: f64,
}

impl Default for ReadingHistory {
    fn default() -> Self {
        Self { past: VecDeque::new(), window_s: 0.020 }
    }
}

/// Maximum number of stored readings; more than the fastest client makes in the longest window.
const KEPT: usize = 2048;

impl ReadingHistory {
    /// Stores a reading.
    pub(crate) fn note(&mut self, at: Instant, reply: &DeviceReply) {
        self.past.push_back(ReadingRecord { at, position_m: reply.position_m, gripper_rad: reply.gripper_rad });
        while self.past.len() > KEPT {
            self.past.pop_front();
        }
    }

    /// Returns velocity (m/s) and speed of the gripper (rad/s); `None` with fewer than two readings within the window
    /// before the newest.
    pub(crate) fn velocity(&mut self) -> Option<([f64; 3], f64)> {
        let newest = *self.past.back()?;
        while self.past.front().is_some_and(|past| (newest.at - past.at).as_secs_f64() > self.window_s) {
            self.past.pop_front();
        }
        let oldest = *self.past.front()?;
        let elapsed_s = (newest.at - oldest.at).as_secs_f64();
        let slope = |to: f64, from: f64| (to - from) / elapsed_s;
        let linear = std::array::from_fn(|axis| slope(newest.position_m[axis], oldest.position_m[axis]));
        (elapsed_s > 0.0).then(|| (linear, slope(newest.gripper_rad, oldest.gripper_rad)))
    }
}

/// Returns the angles of the emulated wrist, rad: its frame is a rotation about z, then y, then x of the device (`Rx(a)
/// Ry(b) Rz(g)`).
pub(crate) fn wrist_rad(frame: &[f64; 9]) -> [f64; 3] {
    [(-frame[5]).atan2(frame[8]), frame[2].clamp(-1.0, 1.0).asin(), (-frame[1]).atan2(frame[0])]
}
