//! Searches for devices in the background: devices connected to this computer, and responses of a rig's devices.

use std::time::{Duration, Instant};

use egui::Context;
use nima_devices::discovery::{DiscoveryDiagnosis, PluggedDevices, TIMEOUT, diagnose};
use nima_machine::config::RigConfig;
use nima_screen::background::BackgroundQuery;

/// Interval of the search for connected devices.
const AGAIN: Duration = Duration::from_secs(2);

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

/// Opens every device of the rig briefly.
pub(super) fn check(answers: &mut DeviceAnswers, ctx: &Context, rig: &RigConfig) {
    let probes = rig.probes();
    answers.begin(ctx, move || diagnose(probes, TIMEOUT));
}
