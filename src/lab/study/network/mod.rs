//! Two machines over an impaired line: the force in the hand, in every mode, over delay, jitter, loss, outages and
//! clock faults.
//!
//! Takes [`NetworkOptions`]; returns a [`NetworkReport`]: one [`NetworkRow`] per cell, and the [`StudyAim`]s with their results. A cell is a run
//! of two whole loops on the virtual clock, the console's with the hand and the follower's with arm and tissue: those
//! of `nima console --follower` and `nima follower`, connected by the stream of `nima-network` through its impaired
//! line, each with its own late ticks. Deterministic.

mod aims;
mod bench;
mod cell;
mod condition;
mod end;
mod operator;
mod plan;
mod present;
mod trace;

use std::{
    collections::{BTreeMap, HashMap},
    num::NonZero,
    panic,
    thread::{available_parallelism, scope},
};

use nima_core::impedance::{Mode, OwnMotion, SettingsError};
use nima_machine::{config::ConfigError, runtime::ClockProfile};
use nima_network::keys::KeyError;
use serde::Serialize;

pub use self::{
    aims::StudyAim,
    condition::{BURSTS_MS, ConditionJitter, DELAYS_MS, JITTERS, LOSSES_PERCENT, LinkEvent, NetworkCondition},
    plan::{BASE_MS, NetworkOptions, PlanExtent},
};
use self::{
    cell::{Runs, measured},
    plan::{Cell, judged_line, plan, runs},
};

/// Why the study could not run.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// No keys could be generated.
    #[error(transparent)]
    Keys(#[from] KeyError),
}

/// One cell. Pairs are: to the follower, to the console.
#[derive(Clone, Debug, Serialize)]
pub struct NetworkRow {
    /// Clock of both loops.
    pub clock: ClockProfile,
    /// The line and the clocks.
    #[serde(flatten)]
    pub condition: NetworkCondition,
    /// Rendering mode.
    pub mode: Mode,
    /// Mean error of the force in the hand, compared with the true force of the tissue at the time when the follower
    /// has the current command, N, while engaged.
    pub error_n: f64,
    /// The same error for the force requested by the mode, before the gates.
    pub asked_error_n: f64,
    /// Mean force of the tissue, N.
    pub tissue_n: f64,
    /// `error_n` as a ratio to the same delay without other impairments.
    pub over_clean: Option<f64>,
    /// Ratio of `error_n` to the error on a link without jitter and loss whose delay equals this link's playout delay;
    /// for the evaluated link only.
    pub over_same_playout: Option<f64>,
    /// `error_n` as a ratio to delayed reflection over the same line.
    pub over_reflection: Option<f64>,
    /// Maximum net energy given to the hand since an engagement, mJ.
    pub injected_mj: f64,
    /// Energy that the true force would have given on the same path, mJ.
    pub tissue_injected_mj: f64,
    /// RMS of the force in the hand between 2 and 50 Hz, N.
    pub oscillation_n: f64,
    /// The same for the true force.
    pub tissue_oscillation_n: f64,
    /// Number of forces above the force limit.
    pub ceiling_breaches: u64,
    /// Number of changes above the slew limit.
    pub slew_breaches: u64,
    /// Longest time in contact (above 0.5 N) without force, ms, including stops.
    pub without_force_ms: f64,
    /// Longest time with force after the last payload, ms.
    pub force_after_data_ms: f64,
    /// Fraction of the evaluated time in which the console was engaged.
    pub engaged: f64,
    /// Number of stops of the console by a fault.
    pub stops: u32,
    /// Number of times that a machine resumed without a command.
    pub resumed: u32,
    /// Faults of the console, and their numbers.
    pub console_faults: BTreeMap<String, u32>,
    pub follower_faults: BTreeMap<String, u32>,
    /// Maximum step of the tip in a tick between a stop and the resumed following, mm; `None` without a stop.
    pub return_step_mm: Option<f64>,
    /// Mean time from sending to delivery, ms: the playout delay, and additional delay.
    pub under_way_ms: [f64; 2],
    /// Time from a command to its answer, measured by the console's loop at the end, ms.
    pub round_trip_ms: f64,
    /// Payloads that arrived late, %.
    pub late_percent: [f64; 2],
    /// Payloads that never arrived, %.
    pub lost_percent: [f64; 2],
    /// Payloads recovered from a later datagram, %.
    pub recovered_percent: [f64; 2],
    /// Redundant copies requested and fitting at the end, for the console's and for the follower's data.
    pub copies: [[usize; 2]; 2],
    /// Maximum error of the console's estimate of the other clock, ms; 0 where that clock is set.
    pub clock_error_ms: f64,
    /// Bound of the clock estimate, ms.
    pub clock_bound_ms: f64,
    /// Time until both machines had reported a clock step, ms.
    pub clock_step_named_ms: Option<f64>,
}

#[derive(Clone, Debug, Serialize)]
pub struct NetworkReport {
    /// Extent of the run.
    pub extent: PlanExtent,
    /// Evaluated mode.
    pub judged: Mode,
    /// Motion from which the console computes the force.
    pub own_motion: OwnMotion,
    /// Time for which a link has been open before the run, s: with jitter, and without.
    pub known_s: [f64; 2],
    /// Duration of a run, and of its evaluated part, s.
    pub run_s: f64,
    pub judged_s: f64,
    /// Targets.
    pub aims: Vec<StudyAim>,
    /// Every cell.
    pub rows: Vec<NetworkRow>,
}

/// Runs the study; before each part `progress` is called with the number of cells done, their total, and the name of the next.
///
/// # Errors
/// [`NetworkError`] if rig or scene cannot be used.
pub fn study(
    options: &NetworkOptions,
    mut progress: impl FnMut(usize, usize, &str),
) -> Result<NetworkReport, NetworkError> {
    let plan = plan(options);
    let runs = runs(options);
    let mut rows = Vec::with_capacity(plan.len());
    for cells in plan.chunks(available_parallelism().map_or(1, NonZero::get)) {
        progress(rows.len(), plan.len(), cells[0].mode.name());
        rows.extend(side_by_side(cells, runs)?);
    }
    compare(&mut rows);
    let judged = options.judged();
    for (row, cell) in rows.iter_mut().zip(&plan) {
        if row.mode != judged || row.condition != judged_line(row.condition.delay_ms) {
            continue;
        }
        let playout_ms = row.under_way_ms.iter().sum::<f64>() / 2.0;
        // The playout delay adds a margin and the rest of a tick.
        let as_long = measured(cell.clock, NetworkCondition::clean(playout_ms.round() - 1.0), judged, runs)?;
        row.over_same_playout = Some(row.error_n / as_long.error_n);
    }
    let aims = options.clocks.iter().flat_map(|clock| {
        let rows: Vec<_> = rows.iter().filter(|row| row.clock == clock.profile).collect();
        aims::aims(&rows, judged)
    });
    progress(plan.len(), plan.len(), "done");
    Ok(NetworkReport {
        extent: options.extent,
        judged,
        own_motion: options.own_motion,
        known_s: runs.known_s,
        run_s: runs.settle_s + runs.learn_s + runs.task_s,
        judged_s: runs.task_s,
        aims: aims.collect(),
        rows,
    })
}

/// Runs these cells in parallel.
fn side_by_side(cells: &[Cell], runs: Runs) -> Result<Vec<NetworkRow>, NetworkError> {
    scope(|scope| {
        let running: Vec<_> = cells
            .iter()
            .map(|&Cell { clock, condition, mode }| scope.spawn(move || measured(clock, condition, mode, runs)))
            .collect();
        running.into_iter().map(|run| run.join().unwrap_or_else(|panic| panic::resume_unwind(panic))).collect()
    })
}

/// Computes the ratios between cells.
fn compare(rows: &mut [NetworkRow]) {
    let key = |clock: ClockProfile, condition: &NetworkCondition, mode: Mode| format!("{clock} {condition:?} {mode}");
    let errors: HashMap<String, f64> =
        rows.iter().map(|row| (key(row.clock, &row.condition, row.mode), row.error_n)).collect();
    for row in rows {
        let over = |condition: &NetworkCondition, mode| {
            let error_n = errors.get(&key(row.clock, condition, mode))?;
            Some(row.error_n / error_n).filter(|ratio| ratio.is_finite())
        };
        let ratios =
            (over(&NetworkCondition::clean(row.condition.delay_ms), row.mode), over(&row.condition, Mode::Dfr));
        (row.over_clean, row.over_reflection) = ratios;
    }
}

#[cfg(test)]
mod tests;
