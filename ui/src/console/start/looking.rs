//! Searches for devices in the background: devices connected to this computer, and responses of a rig's devices.

use std::{
    sync::mpsc::{Receiver, TryRecvError, channel},
    thread,
    time::{Duration, Instant},
};

use crate::language;
use egui::Context;
use nima_devices::discovery::{DiscoveryDiagnosis, PluggedDevices, TIMEOUT, diagnose};
use nima_machine::config::RigConfig;

/// Interval of the search for connected devices.
const AGAIN: Duration = Duration::from_secs(2);

/// Work on a separate thread, and its last result.
#[derive(Debug)]
pub(crate) struct BackgroundQuery<T> {
    running: Option<Receiver<T>>,
    found: Option<T>,
}

impl<T> Default for BackgroundQuery<T> {
    fn default() -> Self {
        Self { running: None, found: None }
    }
}

impl<T: Send + 'static> BackgroundQuery<T> {
    /// Starts the work; the window is woken when there is a result. Does nothing while work is in progress.
    pub(crate) fn begin(&mut self, ctx: &Context, work: impl FnOnce() -> T + Send + 'static) {
        if self.running.is_some() {
            return;
        }
        let (give, take) = channel();
        let ctx = ctx.clone();
        let looks = move || {
            give.send(work()).ok();
            ctx.request_repaint();
        };
        self.running =
            thread::Builder::new().name("devices".to_owned()).spawn(language::carried(looks)).ok().map(|_| take);
    }

    pub(crate) fn found(&mut self) -> Option<&T> {
        match self.running.as_ref().map(Receiver::try_recv) {
            Some(Ok(found)) => (self.running, self.found) = (None, Some(found)),
            Some(Err(TryRecvError::Disconnected)) => self.running = None,
            Some(Err(TryRecvError::Empty)) | None => {}
        }
        self.found.as_ref()
    }

    pub(crate) const fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Discards the result, and a result of work in progress.
    pub(crate) fn forget(&mut self) {
        *self = Self::default();
    }
}

/// Devices connected to this computer.
#[derive(Debug, Default)]
pub(super) struct PluggedIn {
    looked: BackgroundQuery<PluggedDevices>,
    at: Option<Instant>,
}

impl PluggedIn {
    /// At most some seconds old; `None` before the first result.
    pub(super) fn now(&mut self, ctx: &Context) -> Option<&PluggedDevices> {
        if self.at.is_none_or(|at| at.elapsed() > AGAIN) {
            self.at = Some(Instant::now());
            self.looked.begin(ctx, PluggedDevices::list);
        }
        ctx.request_repaint_after(AGAIN);
        self.looked.found()
    }
}

/// Responses of a rig's devices.
pub(super) type DeviceAnswers = BackgroundQuery<Vec<DiscoveryDiagnosis>>;

impl DeviceAnswers {
    /// Opens every device of the rig briefly.
    pub(super) fn check(&mut self, ctx: &Context, rig: &RigConfig) {
        let probes = rig.probes();
        self.begin(ctx, move || diagnose(probes, TIMEOUT));
    }
}
