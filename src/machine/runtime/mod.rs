//! Time and threads: runs the loop in its own thread, on the real clock or at the pace of it, or on the virtual clock as fast as it goes.
//!
//! Takes an [`Assembly`]; gives a [`Handle`] (commands in; ticks and events out, over bounded queues) or a [`Summary`].
//! The real-time thread owns the rig and the loop. It never waits for a receiver: what does not fit is dropped and counted.

mod os;
mod summary;
mod supervisor;
mod thread;
mod virtual_clock;
mod wrists;

pub use summary::{ArmEnd, CauseAndCure, CpuShare, DeviceFigures, Histograms, ModeError, Summary};
pub use supervisor::STALL_MAX_S;
pub use thread::{Ender, Handle, StartError, TICKS_WAITING_MAX, start};
pub use virtual_clock::run_virtual;
pub use wrists::WristChange;

use crate::{
    config::SchedulingClass,
    rig::{Rig, Roster},
    teleop::Loop,
};

/// What the loop takes as its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clock {
    /// The monotonic clock: every period has a deadline, what is late is counted, and a stall switches the drives off.
    Real,
    /// Simulated time, at most so many times as fast as real time. A loop that was held up goes on where it was, and nothing is late: for
    /// simulated rigs, where nobody is at the other end.
    Simulated {
        /// Simulated seconds in a real one.
        speed: f64,
    },
}

/// A loop and the rig that it runs on, ready to start.
pub struct Assembly {
    /// The loop.
    pub control: Loop,
    /// The rig.
    pub rig: Box<dyn Rig>,
    /// The devices in it.
    pub roster: Roster,
    /// Ticks per second.
    pub rate_hz: f64,
    /// The loop's time, where it runs in a thread of its own.
    pub clock: Clock,
    /// What to ask of the operating system.
    pub scheduling: SchedulingClass,
    /// Engage as soon as everything is there.
    pub engage: bool,
}
