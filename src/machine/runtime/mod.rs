//! Time and threads: runs the loop on the real clock in its own thread, or on the virtual clock as fast as it goes.
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
    /// What to ask of the operating system.
    pub scheduling: SchedulingClass,
    /// Engage as soon as everything is there.
    pub engage: bool,
}
