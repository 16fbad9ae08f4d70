//! Faults of every kind in every state: what the machine tells, how soon, how soon the force is gone, and how wrong it was until then.
//!
//! Each case is a machine whose rig, clock, link or screen fails at a moment, and its twin in the same world that is given the truth.
//! Takes nothing but [`Options`]; gives a [`Report`] (ms, N). A case is *detected* (a fault, a change of state, a refusal, a closed
//! gate or an unusable force is told), *harmless* (there is no force and no motion, or the force in the hand differs from the
//! twin's of the same 5 ms by at most [`HARMLESS_N`], or is no farther from the force at the tip than the twin's own), *bounded* (it cannot be told in principle; its largest error is given), or *silent*.
//! Faults of threads and disks run on the real clock, those of files on files.

mod at_rest;
mod bench;
mod calm;
mod case;
mod catalogue;
mod impaired_link;
mod inject;
mod live;
mod present;

use nima_core::impedance::{Mode, SettingsError};
use nima_machine::{config::ConfigError, messages::LoopState};
use nima_recording::tip_force::TipForceError;
use serde::Serialize;

pub use calm::Calm;
pub use catalogue::{Kind, Part};
pub use inject::Faulty;
pub use live::{LiveError, Special};

use self::bench::Bench;
use crate::validation::ValidationError;

/// A force in the hand that differs from the twin's by no more than this is harmless, N: the deviation of the paper's own tip force.
pub const HARMLESS_N: f64 = 0.2;

/// Why the study cannot be made.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum FaultsError {
    /// A scene or rig is wrong.
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Settings(#[from] SettingsError),
    #[error(transparent)]
    Calibration(#[from] ValidationError),
    #[error(transparent)]
    Network(#[from] TipForceError),
    /// The healthy machine did not come to where a fault was to be tried.
    #[error(
        "the healthy machine is {state} where it should be {place}: a false alarm, or this study's scenes have changed"
    )]
    NotReached { place: &'static str, state: String },
    /// Faults on the real clock.
    #[error(transparent)]
    Live(#[from] LiveError),
}

/// Where the force is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorAt {
    /// At the tip, scene `peg_transfer`.
    Tip,
    /// At the wrist, scene `palpation`, gravity calibrated.
    Wrist,
}

impl SensorAt {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Tip, Self::Wrist];

    const fn scene(self) -> &'static str {
        match self {
            Self::Tip => "peg_transfer",
            Self::Wrist => "palpation",
        }
    }

    const fn word(self) -> &'static str {
        match self {
            Self::Tip => "tip",
            Self::Wrist => "wrist",
        }
    }
}

/// Where the machine is when the fault begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// No device.
    Disconnected,
    /// Everything delivers, drives off.
    Idle,
    /// Drives on their way; 200 ms later they obey, and the fault still stands.
    Ready,
    /// Engaged, 8 mm above the tissue, on the way.
    Free,
    /// Engaged, 5 mm in the tissue.
    Contact,
    /// Clutched out of a contact; 200 ms later the clutch is let go.
    Clutched,
    /// Stopped by the operator.
    Stopped,
    /// Stopped by a fault.
    Faulted,
}

impl Place {
    /// All of them.
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

    /// In a word.
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

    /// Force and motion are on when the fault begins.
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

    /// Ticks that the fault is watched.
    const fn ticks(self) -> u32 {
        match self {
            Self::Ready | Self::Free | Self::Contact => 2500,
            Self::Clutched => 1500,
            _ => 300,
        }
    }
}

/// What became of a case, better first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Neither force nor motion all the time.
    NoForce,
    /// The force differs from the nearest of the twin's within 5 ms by at most [`HARMLESS_N`], or is no farther from the force at the tip
    /// than the twin's own: its largest error by at most [`HARMLESS_N`], its mean error by at most 0.02 N.
    Harmless,
    /// Something was told.
    Detected,
    /// Cannot be told in principle; the error is given.
    Bounded,
    /// None of these.
    Silent,
}

/// One case.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Outcome {
    pub kind: Kind,
    /// Where it sits.
    pub part: Part,
    /// Where the force is measured.
    pub sensor: SensorAt,
    pub mode: Mode,
    /// Where the machine was.
    pub place: Place,
    /// Which moment there.
    pub moment: u32,
    pub verdict: Verdict,
    /// What was told first, if anything.
    pub told: Option<String>,
    /// When it was told since what is given first differed from the truth (or since the fault began, where it was told before), ms.
    pub detection_ms: Option<f64>,
    /// When the force was gone since then, ms, where there was one.
    pub zero_ms: Option<f64>,
    /// Largest difference of the force in the hand from the twin's until the force was gone, N.
    pub peak_error_n: f64,
    /// The same against the nearest of the twin's forces of 5 ms before and after, N: what is late by less is fresh to the age gate.
    pub error_n: f64,
    /// Largest force that the machine commanded, N.
    pub most_n: f64,
    /// Largest change of it in a tick other than to nothing, N.
    pub step_n: f64,
}

/// How much to try.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Moments at each place with force; one elsewhere.
    pub moments: u32,
    /// The faults of threads, disks and files too (some seconds on the real clock).
    pub live: bool,
    /// Time of each healthy run in which nothing may be told, s.
    pub calm_s: f64,
}

/// The study's result.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Every case on the virtual clock.
    pub outcomes: Vec<Outcome>,
    /// Faults on the real clock and of files.
    pub specials: Vec<Special>,
    /// Healthy runs.
    pub calm: Calm,
    /// How many runs ended in each way.
    pub sums: Sums,
}

/// Counts and percentiles over a report.
#[derive(Clone, Copy, Debug, Default, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Sums {
    /// Kinds of fault.
    pub kinds: usize,
    /// Cases on the virtual clock.
    pub cases: usize,
    /// Of these without force and motion.
    pub no_force: usize,
    pub harmless: usize,
    pub detected: usize,
    pub bounded: usize,
    pub silent: usize,
    /// Detected cases on the force path while engaged.
    pub on_force_path: usize,
    /// Time to their detection, median, ms.
    pub detection_p50_ms: f64,
    /// 99th percentile, ms.
    pub detection_p99_ms: f64,
    /// Largest, ms.
    pub detection_max_ms: f64,
    /// Largest error of a bounded case, N.
    pub bounded_error_n: f64,
    /// Largest force commanded in any case, N.
    pub most_n: f64,
    /// Largest change of it in a tick, N.
    pub step_n: f64,
}

impl Sums {
    fn of(outcomes: &[Outcome], specials: &[Special]) -> Self {
        let count = |verdict| outcomes.iter().filter(|outcome| outcome.verdict == verdict).count();
        let most = |of: fn(&Outcome) -> f64| outcomes.iter().map(of).fold(0.0, f64::max);
        let on_path = |outcome: &&Outcome| outcome.part.is_on_force_path() && outcome.place.is_engaged();
        let told = outcomes.iter().filter(on_path).filter(|outcome| outcome.verdict == Verdict::Detected);
        let mut times_ms: Vec<f64> = told.filter_map(|outcome| outcome.detection_ms).collect();
        times_ms.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = (share * times_ms.len() as f64).ceil() as usize;
            times_ms.get(place.saturating_sub(1)).copied().unwrap_or_default()
        };
        let mut kinds: Vec<Kind> = Vec::new();
        for outcome in outcomes {
            if !kinds.contains(&outcome.kind) {
                kinds.push(outcome.kind);
            }
        }
        let bounded = outcomes.iter().filter(|outcome| outcome.verdict == Verdict::Bounded);
        Self {
            kinds: kinds.len() + specials.len(),
            cases: outcomes.len(),
            no_force: count(Verdict::NoForce),
            harmless: count(Verdict::Harmless),
            detected: count(Verdict::Detected),
            bounded: count(Verdict::Bounded),
            silent: count(Verdict::Silent)
                + specials.iter().filter(|special| special.verdict == Verdict::Silent).count(),
            on_force_path: times_ms.len(),
            detection_p50_ms: at(0.5),
            detection_p99_ms: at(0.99),
            detection_max_ms: at(1.0),
            bounded_error_n: bounded.map(|outcome| outcome.peak_error_n).fold(0.0, f64::max),
            most_n: most(|outcome| outcome.most_n),
            step_n: most(|outcome| outcome.step_n),
        }
    }
}

/// Makes the study; `progress` is told now and then how many of how many parts are done.
pub fn study(options: &Options, mut progress: impl FnMut(usize, usize, &str)) -> Result<Report, FaultsError> {
    let mut outcomes = Vec::new();
    let all = SensorAt::ALL.len() * 2 * Place::ALL.len() + 1;
    let mut done = 0;
    for sensor in SensorAt::ALL {
        for mode in [Mode::Anchored, Mode::Dfr] {
            let idle = Bench::new(sensor, mode, 0)?;
            for place in Place::ALL {
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
    progress(all - 1, all, "healthy runs");
    let calm = calm::runs(options.calm_s)?;
    progress(all, all, "done");
    let sums = Sums::of(&outcomes, &specials);
    Ok(Report { outcomes, specials, calm, sums })
}

/// Every kind of fault at one place.
fn at(idle: &Bench, sensor: SensorAt, mode: Mode, place: Place, moments: u32) -> Result<Vec<Outcome>, FaultsError> {
    let mut outcomes = Vec::new();
    for moment in 0..if place.is_engaged() { moments } else { 1 } {
        let mut ready = idle.clone();
        ready.prepare(place, moment)?;
        for kind in Kind::ALL {
            if sensor == SensorAt::Wrist || !kind.needs_wrist() {
                outcomes.push(case::tried(ready.clone(), kind, sensor, mode, place, moment));
            }
        }
    }
    Ok(outcomes)
}

#[cfg(test)]
mod tests;
