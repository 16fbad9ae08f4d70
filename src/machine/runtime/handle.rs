//! The end of other threads: commands to a running loop, and what it reports.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::JoinHandle,
};

use nima_devices::DeviceIdentity;

use super::{
    RuntimeSummary,
    supervisor::Supervisor,
    thread::{EVENTS_WAITING_MAX, GAUGES_WAITING_MAX, TICKS_WAITING_MAX},
    wrists::{WristChange, WristConnection},
};
use crate::{
    hand_over::{FromLoop, ToLoop},
    messages::{Command, Event, Tick},
    rig::{Gauges, Healths, Roster, Side},
    teleop::Calibrations,
};

/// A running loop. Dropping it ends the loop.
#[derive(Debug)]
pub struct LoopHandle {
    pub(super) commands: ToLoop<Command>,
    pub(super) ends: Arc<AtomicBool>,
    pub(super) ticks: FromLoop<Tick>,
    pub(super) events: FromLoop<Event>,
    pub(super) healths: FromLoop<Healths>,
    pub(super) gauges: FromLoop<Gauges>,
    pub(super) roster: Roster,
    pub(super) wrists: WristConnection,
    pub(super) thread: Option<JoinHandle<RuntimeSummary>>,
    /// Declared after the thread: fields are dropped after [`Drop`] has joined the loop's thread, so the supervisor
    /// outlives the loop.
    pub(super) _supervisor: Supervisor,
}

impl LoopHandle {
    /// Sends a command; returns false if the queue is full or the loop has ended.
    pub fn send(&self, command: Command) -> bool {
        !self.ends.load(Ordering::Acquire) && !self.commands.is_abandoned() && self.commands.try_send(command).is_ok()
    }

    /// Calls `each` for every pending tick, oldest first, without blocking.
    pub fn drain_ticks(&self, mut each: impl FnMut(&Tick)) {
        // Limited, so that a loop that produces ticks faster than the screen reads them cannot keep the screen in this
        // function.
        self.ticks.try_iter().take(TICKS_WAITING_MAX).for_each(|tick| each(&tick));
    }

    /// Calls `each` for every pending event, oldest first, without blocking.
    pub fn drain_events(&self, mut each: impl FnMut(&Event)) {
        self.events.try_iter().take(EVENTS_WAITING_MAX).for_each(|event| each(&event));
    }

    /// Returns the devices of the rig; empty if everything is simulated.
    pub fn roster(&self) -> &Roster {
        &self.roster
    }

    /// Returns the last connection or disconnection of this side's force sensor. Read it before
    /// [`LoopHandle::force_sensor`]: [`LoopHandle::activate`] then refuses calibrations if the sensor has been swapped in
    /// between.
    pub fn wrist_change(&self, side: Side) -> WristChange {
        self.wrists.change(side)
    }

    /// Returns the identity that the force sensor of this side reported; `None` until it has been opened.
    pub fn force_sensor(&self, side: Side) -> Option<DeviceIdentity> {
        self.roster.iter().find(|entry| entry.force_sensor_of() == Some(side))?.view.report().identity
    }

    /// Activates the calibrations of a force sensor, unless the sensor has connected or disconnected since `change`.
    /// Returns false if the loop cannot accept them now.
    pub fn activate(&self, change: WristChange, calibrations: &Calibrations) -> bool {
        self.wrists.activate(change, calibrations)
    }

    /// Returns the health of the devices; `None` if it has not changed since the last call.
    pub fn healths(&self) -> Option<Healths> {
        self.healths.try_recv()
    }

    /// Returns the deliveries of the devices, in blocks of time, oldest first. Blocks that are not read in time are
    /// dropped.
    pub fn gauges(&self) -> impl Iterator<Item = Gauges> {
        self.gauges.try_iter().take(GAUGES_WAITING_MAX)
    }

    /// Returns an object that can end this loop from any thread.
    pub fn ender(&self) -> Ender {
        Ender(Arc::clone(&self.ends))
    }

    pub fn is_running(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// Ends the loop and returns its results; `None` if its thread has panicked.
    pub fn stop_and_join(mut self) -> Option<RuntimeSummary> {
        self.end()
    }

    fn end(&mut self) -> Option<RuntimeSummary> {
        let thread = self.thread.take()?;
        self.ender().end();
        let mut summary = thread.join().ok()?;
        summary.report_devices(&self.roster);
        Some(summary)
    }
}

/// Ends a loop from any thread: zero force, drives off, arm at rest. The results of the run stay available in the
/// [`LoopHandle`].
#[derive(Clone, Debug)]
pub struct Ender(Arc<AtomicBool>);

impl Ender {
    pub fn end(&self) {
        // Not a command, because a full queue must not keep the loop alive.
        self.0.store(true, Ordering::Release);
    }
}

impl Drop for LoopHandle {
    fn drop(&mut self) {
        self.end();
    }
}
