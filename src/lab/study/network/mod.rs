//! Two machines over a bad line: what the hand feels, in every mode, over delay, jitter, loss, outages and faults of a clock.
//!
//! Takes [`Options`]; returns a [`Report`]: one [`Row`] per cell, and the [`Aim`]s with what was reached. A cell is a run of two whole
//! loops on the virtual clock, the console's with the hand and the follower's with arm and tissue: those of `nima console --follower` and
//! `nima follower`, joined by the stream of `nima-network` through its impaired line, each with late ticks of its own. Deterministic.

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
    aims::Aim,
    condition::{BURSTS_MS, Condition, DELAYS_MS, Happening, JITTERS, Jitter, LOSSES_PERCENT},
    plan::{BASE_MS, Extent, Options},
};
use self::{
    cell::{Runs, measured},
    plan::{Cell, judged_line, plan, runs},
};

/// Why the study could not be made.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    /// Rig or scene cannot be had.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Settings out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// No keys could be made.
    #[error(transparent)]
    Keys(#[from] KeyError),
}

/// One cell. Pairs are: to the follower, to the console.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// When the ticks of both loops wake.
    pub clock: ClockProfile,
    /// The line and the clocks.
    #[serde(flatten)]
    pub condition: Condition,
    /// Mode that rendered.
    pub mode: Mode,
    /// Mean error of the force in the hand against the true force of the tissue at the moment when the follower has the present command,
    /// N, while engaged.
    pub error_n: f64,
    /// The same of what the mode asked for, before the gates.
    pub asked_error_n: f64,
    /// Mean force of the tissue, N.
    pub tissue_n: f64,
    /// `error_n` over that with the same delay and nothing else.
    pub over_clean: Option<f64>,
    /// `error_n` over that of a line without jitter and loss that takes as long as this one's play-out; for the judged line only.
    pub over_same_playout: Option<f64>,
    /// `error_n` over that of delayed reflection over the same line.
    pub over_reflection: Option<f64>,
    /// Most net energy that the hand was given since an engagement, mJ.
    pub injected_mj: f64,
    /// What the true force would have given on the same way.
    pub tissue_injected_mj: f64,
    /// Effective value of the force in the hand between 2 and 50 Hz, N.
    pub oscillation_n: f64,
    /// The same of the true force.
    pub tissue_oscillation_n: f64,
    /// Forces above the ceiling.
    pub ceiling_breaches: u64,
    /// Changes of the force above the slew limit.
    pub slew_breaches: u64,
    /// Longest time in contact (above 0.5 N) without force, ms, stops included.
    pub without_force_ms: f64,
    /// Longest time for which there was force after the last payload, ms.
    pub force_after_data_ms: f64,
    /// Share of the judged time in which the console was engaged.
    pub engaged: f64,
    /// How often the console was stopped by a fault.
    pub stops: u32,
    /// How often a machine drove again unasked.
    pub resumed: u32,
    /// Faults of the console, and how often.
    pub console_faults: BTreeMap<String, u32>,
    /// Faults of the follower.
    pub follower_faults: BTreeMap<String, u32>,
    /// Largest step of the tip in a tick from a stop until it follows again, mm; `None` if there was no stop.
    pub return_step_mm: Option<f64>,
    /// Mean time from sending to handing over, ms: the play-out delay, and what is late.
    pub under_way_ms: [f64; 2],
    /// From a command to the answer to it at the end, as the console's loop has it, ms.
    pub round_trip_ms: f64,
    /// Payloads that came after their time, %.
    pub late_percent: [f64; 2],
    /// Payloads that never came, %.
    pub lost_percent: [f64; 2],
    /// Payloads that came with a later datagram, %.
    pub recovered_percent: [f64; 2],
    /// Copies that were wanted and that fitted, at the end, of what the console and what the follower sends.
    pub copies: [[usize; 2]; 2],
    /// Largest error of the other clock as the console knows it, ms; 0 where that clock is set.
    pub clock_error_ms: f64,
    /// Its bound.
    pub clock_bound_ms: f64,
    /// Time until both had named a step of the clock, ms.
    pub clock_step_named_ms: Option<f64>,
}

/// Result of this study.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// What was run.
    pub extent: Extent,
    /// Mode that is judged.
    pub judged: Mode,
    /// Motion from which the console makes the force.
    pub own_motion: OwnMotion,
    /// For how long a line has been open before the run, s: one with jitter, and one without.
    pub known_s: [f64; 2],
    /// Length of a run, and of its judged part, s.
    pub run_s: f64,
    /// See above.
    pub judged_s: f64,
    /// What must be reached.
    pub aims: Vec<Aim>,
    /// Every cell.
    pub rows: Vec<Row>,
}

/// Runs the study; before each part `progress` is called with the number of cells done, their total, and the name of the next.
///
/// # Errors
/// [`NetworkError`] if rig or scene cannot be used.
pub fn study(options: &Options, mut progress: impl FnMut(usize, usize, &str)) -> Result<Report, NetworkError> {
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
        // Play-out adds a margin and what is left of a tick.
        let as_long = measured(cell.clock, Condition::clean(playout_ms.round() - 1.0), judged, runs)?;
        row.over_same_playout = Some(row.error_n / as_long.error_n);
    }
    let aims = options.clocks.iter().flat_map(|clock| {
        let rows: Vec<_> = rows.iter().filter(|row| row.clock == clock.profile).collect();
        aims::aims(&rows, judged)
    });
    progress(plan.len(), plan.len(), "done");
    Ok(Report {
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

/// Runs these cells at the same time.
fn side_by_side(cells: &[Cell], runs: Runs) -> Result<Vec<Row>, NetworkError> {
    scope(|scope| {
        let running: Vec<_> = cells
            .iter()
            .map(|&Cell { clock, condition, mode }| scope.spawn(move || measured(clock, condition, mode, runs)))
            .collect();
        running.into_iter().map(|run| run.join().unwrap_or_else(|panic| panic::resume_unwind(panic))).collect()
    })
}

/// Fills in what compares a cell with others.
fn compare(rows: &mut [Row]) {
    let key = |clock: ClockProfile, condition: &Condition, mode: Mode| format!("{clock} {condition:?} {mode}");
    let errors: HashMap<String, f64> =
        rows.iter().map(|row| (key(row.clock, &row.condition, row.mode), row.error_n)).collect();
    for row in rows {
        let over = |condition: &Condition, mode| {
            let error_n = errors.get(&key(row.clock, condition, mode))?;
            Some(row.error_n / error_n).filter(|ratio| ratio.is_finite())
        };
        let ratios = (over(&Condition::clean(row.condition.delay_ms), row.mode), over(&row.condition, Mode::Dfr));
        (row.over_clean, row.over_reflection) = ratios;
    }
}

#[cfg(test)]
mod tests;
