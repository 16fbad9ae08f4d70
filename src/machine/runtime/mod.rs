//! Runs the loop in its own thread on the real clock or in paced simulated time, or in the caller's thread on the
//! virtual clock.
//!
//! Takes an [`Assembly`]; returns a [`LoopHandle`] (commands in; ticks and events out, over bounded queues) or a
//! [`RuntimeSummary`].
//! The real-time thread owns the rig and the loop. It never waits for a receiver: if a queue is full, the item is
//! dropped and counted.

mod clock_profile;
mod handle;
mod jitter;
mod loop_tap;
mod os;
mod phase;
mod summary;
mod supervisor;
mod thread;
mod virtual_clock;
mod wrists;

pub use clock_profile::{ClockProfile, ParseClockProfileError, TickTime, TickTimes, VirtualClock};
pub use handle::{Ender, LoopHandle};
pub use loop_tap::{Operation, TICKS_TAPPED_MAX, Tap, TapEnd, TapEntry, TapItem, TapPayload, TickRecord, tap};
pub use summary::{ArmEnd, CauseAndCure, CpuFraction, DeviceFigures, Histograms, ModeError, RuntimeSummary};
pub use supervisor::STALL_MAX_S;
pub use thread::{LoopStartError, TICKS_WAITING_MAX, start};
pub use virtual_clock::{VirtualSupervisor, run_virtual, run_virtual_on, tick};
pub use wrists::WristChange;

use crate::{
    config::SchedulingClass,
    rig::{Rig, Roster},
    teleop::Loop,
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RuntimeClock {
    /// The monotonic clock: every period has a deadline, late wake-ups are counted, and a stall switches the drives
    /// off.
    Real,
    /// Simulated time that advances at most `speed` times as fast as real time. After a delay the loop continues where
    /// it stopped, and nothing counts as late. For simulated rigs only, which have no hardware to keep in step.
    Simulated {
        /// Simulated seconds per real second.
        speed: f64,
    },
}

pub struct Assembly {
    pub control: Loop,
    pub rig: Box<dyn Rig>,
    pub roster: Roster,
    pub rate_hz: f64,
    /// Source of time, if the loop runs in its own thread.
    pub clock: RuntimeClock,
    pub scheduling: SchedulingClass,
    /// Whether to engage as soon as every device delivers data.
    pub engage: bool,
    /// Records the loop's input and output.
    pub tap: Option<Tap>,
}
