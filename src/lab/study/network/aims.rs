//! The targets, and the results.

use nima_core::impedance::Mode;
use nima_machine::runtime::ClockProfile;
use serde::Serialize;

use super::{
    NetworkRow,
    plan::{CLOCK_JITTER, judged_line},
};

/// Targets: additional error by loss and jitter (%), energy (mJ), force after the last data (ms), step on return (mm),
/// error of the clock (ms), time until a clock step is reported (ms).
const COST_PERCENT: f64 = 10.0;
const INJECTED_MJ: f64 = 1.0;
const FORCE_AFTER_MS: f64 = 20.0;
const RETURN_MM: f64 = 0.2;
const CLOCK_MS: f64 = 0.2;
const NAMED_MS: f64 = 1000.0;

/// One target and its result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudyAim {
    /// Clock of both loops.
    pub clock: ClockProfile,
    /// Measured quantity, with its unit.
    pub what: String,
    /// Maximum.
    pub limit: f64,
    /// Maximum over all cells to which it applies.
    pub worst: f64,
    /// The cell with that maximum.
    pub place: String,
    /// Number of cells to which it applies, and number of those that missed it.
    pub cells: usize,
    /// Number of cells that missed it.
    pub missed: usize,
}

impl StudyAim {
    /// Returns the target over the cells for which `of` returns a number; `None` if there is none.
    fn over<'a>(
        what: &str,
        limit: f64,
        rows: impl Iterator<Item = &'a &'a NetworkRow>,
        of: impl Fn(&NetworkRow) -> Option<f64>,
    ) -> Option<Self> {
        let measured: Vec<_> = rows.filter_map(|row| Some((of(row)?, row))).collect();
        let (worst, row) = measured.iter().max_by(|(one, _), (other, _)| one.total_cmp(other))?;
        Some(Self {
            clock: row.clock,
            what: what.to_owned(),
            limit,
            worst: *worst,
            place: row.place(),
            cells: measured.len(),
            // NaN counts as a miss.
            missed: measured.iter().filter(|(value, _)| value.is_nan() || *value > limit).count(),
        })
    }
}

/// Returns all targets on one clock. Limits of the gates and the behaviour after a stop apply to every mode, the
/// quality of the force only to the evaluated one.
pub(super) fn aims(rows: &[&NetworkRow], judged: Mode) -> Vec<StudyAim> {
    let all = || rows.iter();
    let ours = || rows.iter().filter(move |row| row.mode == judged);
    let cost = |row: &NetworkRow| {
        let is_it = row.condition == judged_line(row.condition.delay_ms);
        row.over_clean.filter(|_| is_it).map(|ratio| 100.0 * (ratio - 1.0))
    };
    let cost_of_loss = |row: &NetworkRow| row.over_same_playout.map(|ratio| 100.0 * (ratio - 1.0));
    let injected = |row: &NetworkRow| (row.stops == 0).then_some((row.injected_mj - row.tissue_injected_mj).max(0.0));
    let clock = |row: &NetworkRow| {
        let is_it = row.condition.jitter == CLOCK_JITTER && !row.condition.happening.sets_clock();
        is_it.then_some(row.clock_error_ms)
    };
    let named = |row: &NetworkRow| {
        row.condition.happening.sets_clock().then_some(row.clock_step_named_ms.unwrap_or(f64::INFINITY))
    };
    [
        StudyAim::over("forces above the ceiling", 0.0, all(), |row| Some(row.ceiling_breaches as f64)),
        StudyAim::over("changes above the slew limit", 0.0, all(), |row| Some(row.slew_breaches as f64)),
        StudyAim::over("more error by 30 % loss and 20 ms jitter, %", COST_PERCENT, ours(), cost),
        StudyAim::over("the same, over a perfect line as long as the play-out, %", COST_PERCENT, ours(), cost_of_loss),
        StudyAim::over("energy beyond the tissue's own without a latched stop, mJ", INJECTED_MJ, ours(), injected),
        StudyAim::over("force after the last data, ms", FORCE_AFTER_MS, all(), |row| Some(row.force_after_data_ms)),
        StudyAim::over("step of the tip on return, mm", RETURN_MM, all(), |row| row.return_step_mm),
        StudyAim::over("machines that resumed without a command", 0.0, all(), |row| Some(f64::from(row.resumed))),
        StudyAim::over("error of the clock with 1 ms jitter, ms", CLOCK_MS, all(), clock),
        StudyAim::over("until a clock step of 50 ms is reported, ms", NAMED_MS, all(), named),
    ]
    .into_iter()
    .flatten()
    .collect()
}
