//! Injects faults of every kind in every state and measures the machine's reports, their delay, the time until the
//! force is removed, and the maximum error until then.
//!
//! Each case compares a machine whose rig, clock, link or screen fails with a fault-free twin in the same world. Takes
//! [`FaultOptions`]; returns a [`FaultReport`] (ms, N). A case is *detected* (the machine reports a fault, a change of state, a
//! refusal, a closed gate or an unusable force), *harmless* (there is no force and no motion; or the force in the hand
//! differs from the twin's within 5 ms by at most [`HARMLESS_N`], or is at most as far from the force at the tip as the
//! twin's), *bounded* (it cannot be detected in principle; its maximum error is given), or *silent*. Faults of threads
//! and disks run on the real clock; faults of files need no clock.

mod at_rest;
mod bench;
mod calm;
mod case;
mod catalogue;
mod impaired_link;
mod inject;
mod live;
mod present;
mod sensor_at;
mod subject;

use nima_core::impedance::{Mode, SettingsError};
use nima_machine::{config::ConfigError, messages::LoopState};
use nima_recording::tip_force::TipForceError;
use serde::Serialize;

pub use calm::FaultFreeRuns;
pub use catalogue::{FaultKind, FaultPart};
pub use live::{LiveFaultError, Special};
pub use sensor_at::SensorAt;

use self::bench::FaultBench;
use crate::validation::ValidationError;

/// A force in the hand that differs from the twin's by no more than this is harmless, N: the standard deviation of the
/// tip force in the paper.
pub const HARMLESS_N: f64 = 0.2;
/// Tested modes: the default mode, which stores most data, and the mode that stores none.
const MODES: [Mode; 2] = [Mode::Best, Mode::Dfr];

/// Why the study could not run.
#[derive(Debug, thiserror::Error)]
pub enum FaultsError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Settings(#[from] SettingsError),
    #[error(transparent)]
    Calibration(#[from] ValidationError),
    #[error(transparent)]
    Network(#[from] TipForceError),
    /// The fault-free machine did not reach the situation for a fault.
    #[error(
        "the fault-free machine is {state} but should be {place}: a false alarm, or this study's scenes have changed"
    )]
    NotReached { place: &'static str, state: String },
    /// A fault on the real clock could not be tested.
    #[error(transparent)]
    Live(#[from] LiveFaultError),
}

/// State of the machine when the fault begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultPlace {
    Disconnected,
    /// All devices deliver data, drives off.
    Idle,
    /// Engaging: the drives come on 200 ms later, while the fault is still present.
    Ready,
    /// Engaged and moving, 8 mm above the tissue.
    Free,
    /// Engaged, 5 mm in the tissue.
    Contact,
    /// Clutch pressed while in contact, and released 200 ms later.
    Clutched,
    /// Stopped by the operator, latched.
    Stopped,
    /// In a latched fault.
    Faulted,
}

impl FaultPlace {
    pub const ALL: [Self; 8] = [
        Self::Disconnected,
        Self::Idle,
        Self::Ready,
        Self::Free,
        Self::Contact,
        Self::Clutched,
        Self::Stopped,
        Self::Faulted,
    ];

    /// Returns one word for tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Disconnected => "no device",
            Self::Idle => "idle",
            Self::Ready => "ready",
            Self::Free => "engaged, free",
            Self::Contact => "engaged, contact",
            Self::Clutched => "clutched",
            Self::Stopped => "stopped",
            Self::Faulted => "fault",
        }
    }

    /// Returns whether force and motion are on when the fault begins.
    pub const fn is_engaged(self) -> bool {
        matches!(self, Self::Free | Self::Contact)
    }

    const fn is(self, state: LoopState) -> bool {
        match self {
            Self::Disconnected => matches!(state, LoopState::Disconnected),
            Self::Idle => matches!(state, LoopState::Idle),
            Self::Ready => matches!(state, LoopState::Ready),
            Self::Free | Self::Contact => matches!(state, LoopState::Engaged),
            Self::Clutched => matches!(state, LoopState::Clutched),
            Self::Stopped => matches!(state, LoopState::Stopped),
            Self::Faulted => matches!(state, LoopState::Faulted(_)),
        }
    }

    /// Returns the number of ticks for which the fault is observed.
    const fn ticks(self) -> u32 {
        match self {
            Self::Ready | Self::Free | Self::Contact => 2500,
            Self::Clutched => 1500,
            _ => 300,
        }
    }
}

/// Outcome of a case, better first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultVerdict {
    /// Neither force nor motion at any time.
    NoForce,
    /// The force differs from the twin's within 5 ms by at most [`HARMLESS_N`], or is not further from the force at the
    /// tip than the twin's: its largest error by at most [`HARMLESS_N`], its mean error by at most 0.02 N.
    Harmless,
    /// The machine reported the fault.
    Detected,
    /// Cannot be detected in principle; the largest error is given.
    Bounded,
    /// None of the above: neither detected nor harmless.
    Silent,
}

/// Result of one case.
#[derive(Clone, Debug, Serialize)]
pub struct CaseOutcome {
    pub kind: FaultKind,
    pub part: FaultPart,
    /// Location of the force sensor.
    pub sensor: SensorAt,
    pub mode: Mode,
    pub place: FaultPlace,
    /// Number of the moment within that state.
    pub moment: u32,
    pub verdict: FaultVerdict,
    /// The first report, if any.
    #[serde(rename = "told")]
    pub report: Option<String>,
    /// Time to that report since the loop's inputs first differed from the true values (or since the fault began, if it
    /// was reported before that), ms.
    pub detection_ms: Option<f64>,
    /// Time until the force was removed, from the same instant, ms; `None` if there was no force.
    pub zero_ms: Option<f64>,
    /// Largest difference between the force in the hand and the twin's until the force was removed, N.
    pub peak_error_n: f64,
    /// The same against the closest of the twin's forces within 5 ms before and after, N, because the age gate accepts
    /// data that are 5 ms late.
    pub error_n: f64,
    /// Maximum commanded force, N.
    #[serde(rename = "most_n")]
    pub max_n: f64,
    /// Largest change of that force in one tick, except a change to zero, N.
    pub step_n: f64,
}

/// Extent of the study.
#[derive(Clone, Copy, Debug)]
pub struct FaultOptions {
    /// Number of moments tested in each state with force; one in the other states.
    pub moments: u32,
    /// Whether faults of threads, disks and files are tested too (some seconds on the real clock).
    pub live: bool,
    /// Duration of each fault-free run, which must be free of reports, s.
    pub calm_s: f64,
}

/// Result of this study.
#[derive(Clone, Debug, Serialize)]
pub struct FaultReport {
    /// Every case on the virtual clock.
    pub outcomes: Vec<CaseOutcome>,
    /// Faults on the real clock, and of files.
    pub specials: Vec<Special>,
    pub calm: FaultFreeRuns,
    /// Number of cases with each outcome.
    pub sums: FaultSums,
}

/// Counts and percentiles of a report.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct FaultSums {
    pub kinds: usize,
    /// Cases on the virtual clock.
    pub cases: usize,
    /// Number of these cases without force and motion.
    pub no_force: usize,
    pub harmless: usize,
    pub detected: usize,
    pub bounded: usize,
    pub silent: usize,
    /// Detected cases on the force path while engaged.
    pub on_force_path: usize,
    /// Median time to detection of the cases in `on_force_path`, ms.
    pub detection_p50_ms: f64,
    /// 99th percentile of that time, ms.
    pub detection_p99_ms: f64,
    /// Maximum of that time, ms.
    pub detection_max_ms: f64,
    /// Maximum error of a bounded case, N.
    pub bounded_error_n: f64,
    /// Maximum force commanded in any case, N.
    #[serde(rename = "most_n")]
    pub max_n: f64,
    /// Maximum change of the commanded force in one tick, N.
    pub step_n: f64,
}

impl FaultSums {
    fn of(outcomes: &[CaseOutcome], specials: &[Special]) -> Self {
        let count = |verdict| outcomes.iter().filter(|outcome| outcome.verdict == verdict).count();
        let max = |of: fn(&CaseOutcome) -> f64| outcomes.iter().map(of).fold(0.0, f64::max);
        let on_path = |outcome: &&CaseOutcome| outcome.part.is_on_force_path() && outcome.place.is_engaged();
        let report = outcomes.iter().filter(on_path).filter(|outcome| outcome.verdict == FaultVerdict::Detected);
        let mut times_ms: Vec<f64> = report.filter_map(|outcome| outcome.detection_ms).collect();
        times_ms.sort_by(f64::total_cmp);
        let at = |fraction: f64| {
            let place = (fraction * times_ms.len() as f64).ceil() as usize;
            times_ms.get(place.saturating_sub(1)).copied().unwrap_or_default()
        };
        let mut kinds: Vec<FaultKind> = Vec::new();
        for outcome in outcomes {
            if !kinds.contains(&outcome.kind) {
                kinds.push(outcome.kind);
            }
        }
        let bounded = outcomes.iter().filter(|outcome| outcome.verdict == FaultVerdict::Bounded);
        Self {
            kinds: kinds.len() + specials.len(),
            cases: outcomes.len(),
            no_force: count(FaultVerdict::NoForce),
            harmless: count(FaultVerdict::Harmless),
            detected: count(FaultVerdict::Detected),
            bounded: count(FaultVerdict::Bounded),
            silent: count(FaultVerdict::Silent)
                + specials.iter().filter(|special| special.verdict == FaultVerdict::Silent).count(),
            on_force_path: times_ms.len(),
            detection_p50_ms: at(0.5),
            detection_p99_ms: at(0.99),
            detection_max_ms: at(1.0),
            bounded_error_n: bounded.map(|outcome| outcome.peak_error_n).fold(0.0, f64::max),
            max_n: max(|outcome| outcome.max_n),
            step_n: max(|outcome| outcome.step_n),
        }
    }
}

/// Runs the study; `progress` is called from time to time with the number of parts done and their total.
///
/// # Errors
/// [`FaultsError`] if a scene or rig is invalid or a situation cannot be reached.
pub fn study(options: &FaultOptions, mut progress: impl FnMut(usize, usize, &str)) -> Result<FaultReport, FaultsError> {
    let mut outcomes = Vec::new();
    let all = SensorAt::ALL.map(|sensor| sensor.places().len()).iter().sum::<usize>() * MODES.len() + 1;
    let mut done = 0;
    for sensor in SensorAt::ALL {
        for mode in MODES {
            let idle = FaultBench::new(sensor, mode, 0)?;
            for &place in sensor.places() {
                progress(done, all, place.word());
                done += 1;
                outcomes.extend(at(&idle, sensor, mode, place, options.moments)?);
            }
        }
    }
    progress(all - 1, all, "threads, disks and files");
    let mut specials = Vec::new();
    if options.live {
        specials.extend(at_rest::all()?);
        specials.extend(live::all()?);
    }
    progress(all - 1, all, "fault-free runs");
    let calm = calm::runs(options.calm_s)?;
    progress(all, all, "done");
    let sums = FaultSums::of(&outcomes, &specials);
    Ok(FaultReport { outcomes, specials, calm, sums })
}

/// Tests every kind of fault in one state.
fn at(
    idle: &FaultBench,
    sensor: SensorAt,
    mode: Mode,
    place: FaultPlace,
    moments: u32,
) -> Result<Vec<CaseOutcome>, FaultsError> {
    let mut outcomes = Vec::new();
    for moment in 0..if place.is_engaged() { moments } else { 1 } {
        let mut ready = idle.clone();
        ready.prepare(place, moment)?;
        for kind in FaultKind::ALL {
            if sensor.has(kind) {
                outcomes.push(case::tried(ready.clone(), kind, sensor, mode, place, moment));
            }
        }
    }
    Ok(outcomes)
}

#[cfg(test)]
mod tests;
