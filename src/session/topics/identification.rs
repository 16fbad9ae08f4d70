//! Status of the identification and the network, ten times a second.

use nima_core::{
    impedance::{Mode, SLOTS},
    tip_force::TipForceReport,
};
use nima_machine::{messages::Tick, rig::Side};
use nima_recording::session::WriteError;

use super::plot::Plot;
use crate::sinks::SessionSinks;

/// Interval, s: an error is a mean over half a second.
const EVERY_S: f64 = 0.1;
/// Follow one column for each mode, in the order of [`Mode::index`]. A value that is not computed is NaN; so is an
/// error while the force is unknown.
const NAMES: [&str; 9] = [
    "baseline.error_n",
    "anchored.degree",
    "matched.degree",
    "nima.degree",
    "paper.degree",
    "resting",
    "network.share",
    "network.outside_share",
    "network.doubt_max",
];

pub(super) fn names() -> Vec<String> {
    let errors = Mode::ALL.map(|mode| format!("{}.error_n", mode.name()));
    errors.into_iter().chain(NAMES.map(str::to_owned)).collect()
}

#[derive(Debug)]
pub(super) struct IdentificationChannel {
    plot: Plot,
    due_s: f64,
    network: NetworkChannel,
}

/// Statistics of the network since the last message.
#[derive(Debug, Default)]
struct NetworkChannel {
    ticks: u32,
    fraction: f64,
    outside: u32,
    doubt_max: f32,
}

impl IdentificationChannel {
    pub(super) fn new(out: &mut SessionSinks, side: Side) -> Result<Self, WriteError> {
        let names = names();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let plot = Plot::of_side(out, side, "identification", &names)?;
        Ok(Self { plot, due_s: f64::NEG_INFINITY, network: NetworkChannel::default() })
    }

    /// Adds a tick, and writes a message if one is due.
    pub(super) fn tick(&mut self, out: &mut SessionSinks, time_ns: u64, tick: &Tick) -> Result<(), WriteError> {
        if let Some(report) = &tick.force.tip_force {
            self.network.add(report);
        }
        // If the clock was set back, start again.
        if tick.t_s < self.due_s && tick.t_s > self.due_s - 2.0 * EVERY_S {
            return Ok(());
        }
        self.due_s = tick.t_s + EVERY_S;
        let report = &tick.identification;
        let mut errors_n = [f64::NAN; SLOTS];
        for mode in Mode::ALL.into_iter().chain(report.modes.baseline().map(Mode::Baseline)) {
            if report.modes.contains(mode) && tick.force.source.is_known() {
                errors_n[mode.index()] = report.horizon_error_n[mode.index()];
            }
        }
        let compares = report.modes.contains(Mode::Literal);
        let degree = |is_made: bool, degree: u8| if is_made { f64::from(degree) } else { f64::NAN };
        self.plot.values.extend(errors_n);
        self.plot.values.extend([
            degree(report.modes.contains(Mode::Anchored), report.degrees.anchored),
            degree(report.modes.contains(Mode::Matched), report.degrees.matched),
            degree(report.modes.contains(Mode::Nima), report.degrees.nima),
            degree(compares, report.degrees.paper),
            f64::from(u8::from(report.resting)),
        ]);
        self.plot.values.extend(std::mem::take(&mut self.network).values());
        self.plot.write(out, time_ns, false)
    }
}

impl NetworkChannel {
    fn add(&mut self, report: &TipForceReport) {
        self.ticks += 1;
        self.fraction += report.network_fraction;
        self.outside += u32::from(report.extrapolates);
        self.doubt_max = self.doubt_max.max(report.doubt);
    }

    /// Returns the mean weight in the force, the fraction of ticks outside the training data, and the maximum
    /// uncertainty; NaN without a network.
    fn values(&self) -> [f64; 3] {
        if self.ticks == 0 {
            return [f64::NAN; 3];
        }
        let ticks = f64::from(self.ticks);
        [self.fraction / ticks, f64::from(self.outside) / ticks, f64::from(self.doubt_max)]
    }
}
