//! Replays a recording through the identification, causally and sample by sample, and computes the figures of `nima
//! identify`.
//!
//! For every sample at time t the force is rendered from data up to t - D and the motion at t, exactly as a leader
//! behind a link of delay D would do, and compared with the force measured at t and with the delayed force f(t - D)
//! (delayed DFR). Units are those of the recording (N and m, or Nm and rad).

use std::time::Instant;

use nalgebra::Vector3;
use nima_core::{
    impedance::{Identifier, MAX_DEGREE, Mode, ModeSet, Recipe, Report, Settings, SettingsError},
    safety::{Chain, ChainSettings, Request},
    statistics::Percentiles,
};
use nima_recording::csv::Recording;
use serde::Serialize;

/// Why a recording could not be replayed.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum ReplayError {
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Shorter than one window and one delay.
    #[error(
        "recording {path} has {found} samples; a window of {window_ms} ms and a delay of {delay_ms} ms at {rate_hz} Hz need {needed}; record longer or shorten the window"
    )]
    TooShort {
        path: String,
        found: usize,
        needed: usize,
        window_ms: f64,
        delay_ms: f64,
        /// Rate of the recording, Hz.
        rate_hz: f64,
    },
    /// A delay that would be rounded to none.
    #[error(
        "the delay of {delay_ms} ms is less than half a sample of recording {path} ({rate_hz} Hz); give 0 or at least {least_ms:.3} ms"
    )]
    ShortDelay {
        path: String,
        delay_ms: f64,
        /// Rate of the recording, Hz.
        rate_hz: f64,
        least_ms: f64,
    },
}

/// A time step longer than this (s) and this many periods is a hole: nothing is learnt or rendered across it.
const HOLE_S: f64 = 0.05;
const HOLE_PERIODS: f64 = 10.0;

/// Mean, standard deviation, percentile and maximum of an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorFigures {
    /// Mean norm of the error.
    pub mae: f64,
    /// Standard deviation of the error about its mean (all axes together).
    pub sd: f64,
    /// 95th percentile of the norm.
    pub p95: f64,
    /// Largest norm.
    pub max: f64,
}

/// In-window reconstruction error of one degree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Reconstruction {
    /// Mean norm.
    pub mae: f64,
    /// Standard deviation about the mean.
    pub sd: f64,
}

/// In-window errors of the paper's method: the parameters fitted to a window, tested on the newest sample of that same
/// window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Reconstructions {
    /// N = 1.
    pub degree_1: Reconstruction,
    /// N = 2.
    pub degree_2: Reconstruction,
    /// N = 3.
    pub degree_3: Reconstruction,
    /// N = 4.
    pub degree_4: Reconstruction,
    /// N = 5.
    pub degree_5: Reconstruction,
    /// The degree chosen in each window.
    pub selected: Reconstruction,
}

/// Median, 95th percentile and maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Spread {
    pub p50: f64,
    pub p95: f64,
    pub max: f64,
}

/// Time of one tick of identification, us.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct TickTime {
    pub p50: f64,
    pub p99: f64,
    pub max: f64,
}

/// All results of a replay; the JSON of `nima identify`.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Figures {
    /// Samples in the recording.
    pub samples: usize,
    pub rate_hz: f64,
    /// Axes, by name.
    pub axes: Vec<&'static str>,
    pub mode: Mode,
    /// Window used, ms.
    pub window_ms: f64,
    /// Delay used, ms: the requested one rounded to whole samples.
    pub delay_ms: f64,
    /// Number of samples compared: all from the first one with a delayed force.
    pub compared: usize,
    /// Rendered force against measured force.
    pub error: ErrorFigures,
    /// Delayed force against measured force: delayed DFR.
    pub hold: ErrorFigures,
    /// In-window errors of the paper's method.
    pub reconstruction: Reconstructions,
    /// Share of compared samples with degree 1 to 5; the remaining ones were rendered without a correction.
    pub degree_share: [f64; MAX_DEGREE],
    /// Share of compared samples with a degree above 1.
    pub nonlinear_share: f64,
    /// Condition number of the scaled regression; 0 while there is no regression.
    pub condition: Spread,
    /// Compared samples for which the mode had no valid force and rendered zero.
    pub rejected: u64,
    /// Holes in the recording; after each, window and delay begin anew.
    pub holes: u64,
    /// The longest of them, s.
    pub longest_hole_s: f64,
    /// Computing time of one tick of identification.
    pub tick_us: TickTime,
}

/// One row of the trace.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Row {
    pub t_s: f64,
    pub measured: Vector3<f64>,
    /// Rendered force, before the gates.
    /// `None` before the first parcel, and where the mode has no valid force.
    pub rendered: Option<Vector3<f64>>,
    /// `None` before the first parcel.
    pub held: Option<Vector3<f64>>,
    /// Degree used, 0 for none.
    pub degree: usize,
    /// Condition of the scaled regression.
    pub condition: f64,
    /// The first gate that would change this force.
    pub gate: &'static str,
}

/// How to replay.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Options {
    pub mode: Mode,
    pub window_s: f64,
    pub delay_s: f64,
    pub max_degree: usize,
    /// Learn the full matrix `M`, with cross-talk.
    pub cross_talk: bool,
    /// How literal and linear read the paper.
    pub literal: Recipe,
}

/// Replays `recording`; `each` is called with every row in order.
///
/// # Errors
/// [`ReplayError`] if a setting is out of range or the recording is shorter than window and delay together.
///
/// ```
/// use nima_core::impedance::{Mode, Recipe};
/// use nima_recording::csv::{Mapping, Recording};
/// use nima_study::replay::{Options, replay};
///
/// // Two seconds of a spring of 200 N/m, read from a file.
/// let row = |k: u32| {
///     let t = 1e-3 * f64::from(k);
///     let x = 0.02 * (9.0 * t).sin();
///     format!("{t},{x},{}\n", -200.0 * x)
/// };
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("spring.csv");
/// std::fs::write(&path, format!("t_s,x_m,fx_n\n{}", (0..2000).map(row).collect::<String>()))?;
///
/// let recording = Recording::read(&path, &Mapping::default())?;
/// let literal = Recipe::default();
/// let options = Options { mode: Mode::Anchored, window_s: 0.3, delay_s: 0.05, max_degree: 2, cross_talk: false, literal };
/// let figures = replay(&recording, &options, |_| {})?;
/// assert!(figures.error.mae < 0.5 * figures.hold.mae, "better than the delayed force");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn replay(recording: &Recording, options: &Options, mut each: impl FnMut(&Row)) -> Result<Figures, ReplayError> {
    let rate_hz = recording.rate_hz;
    let mut settings = Settings {
        rate_hz,
        window_s: options.window_s,
        delay_s: options.delay_s,
        max_degree: options.max_degree,
        cross_talk: options.cross_talk,
        literal: options.literal,
        axes: recording.axes.len(),
        modes: ModeSet::default().with(options.mode),
        ..Settings::default()
    };
    settings.validate()?;
    let delay = (options.delay_s * rate_hz).round() as usize;
    settings.delay_s = delay as f64 / rate_hz;
    if delay == 0 && options.delay_s > 0.0 {
        return Err(ReplayError::ShortDelay {
            path: recording.path.display().to_string(),
            delay_ms: options.delay_s * 1e3,
            rate_hz,
            least_ms: 0.5e3 / rate_hz,
        });
    }
    let mut identifier = Identifier::new(&settings)?;
    let window = (options.window_s * rate_hz).round() as usize;
    let needed = window + delay + 1;
    if recording.samples.len() < needed {
        return Err(ReplayError::TooShort {
            path: recording.path.display().to_string(),
            found: recording.samples.len(),
            needed,
            window_ms: options.window_s * 1e3,
            delay_ms: settings.delay_s * 1e3,
            rate_hz,
        });
    }
    let mut tally = Tally::default();
    let mut gates = Chain::new(ChainSettings::default(), 1.0 / rate_hz);
    let hole_s = HOLE_S.max(HOLE_PERIODS / rate_hz);
    let mut begin = 0;
    for (i, sample) in recording.samples.iter().enumerate() {
        let step_s = sample.t_s - recording.samples[i.saturating_sub(1)].t_s;
        if step_s > hole_s {
            begin = i;
            tally.hole(step_s);
            identifier.reset();
            gates.reset();
        }
        let start = Instant::now();
        identifier.step(sample);
        tally.tick.record(start.elapsed().as_secs_f64());
        let report = identifier.report();
        let rendered = report.prediction(options.mode);
        let held = i.checked_sub(delay).filter(|then| *then >= begin).map(|then| recording.samples[then].force_n);
        let last_m = recording.samples[i.saturating_sub(1).max(begin)].position_m;
        let speed_m_s = (sample.position_m - last_m).norm() * rate_hz;
        let (_, gate) =
            gates.step(&Request { force_n: rendered, age_s: 0.0, speed_m_s, hand_m: None, permitted: true });
        let row = Row {
            t_s: sample.t_s,
            measured: sample.force_n,
            rendered: rendered.filter(|_| held.is_some()),
            held,
            degree: usize::from(report.degree_of(options.mode)),
            condition: report.condition,
            gate: gate.first_closed(),
        };
        tally.add(&row, report);
        each(&row);
    }
    Ok(tally.figures(recording, options.mode, &settings))
}

/// Sums over the replay.
#[derive(Default)]
struct Tally {
    error: Errors,
    hold: Errors,
    reconstruction: [Errors; MAX_DEGREE],
    selected: Errors,
    degrees: [u64; MAX_DEGREE + 1],
    conditions: Vec<f64>,
    rejected: u64,
    holes: u64,
    longest_hole_s: f64,
    tick: Percentiles,
}

impl Tally {
    fn hole(&mut self, seconds: f64) {
        self.holes += 1;
        self.longest_hole_s = self.longest_hole_s.max(seconds);
    }

    fn add(&mut self, row: &Row, report: &Report) {
        if let Some(chosen) = usize::from(report.paper_degree).checked_sub(1) {
            for (errors, residual) in self.reconstruction.iter_mut().zip(&report.reconstruction_n) {
                errors.add(residual);
            }
            self.selected.add(&report.reconstruction_n[chosen]);
        }
        if report.condition > 0.0 {
            self.conditions.push(report.condition);
        }
        let Some(held) = row.held else { return };
        // A mode without a valid force renders none: its error is the whole force.
        self.error.add(&(row.rendered.unwrap_or_else(Vector3::zeros) - row.measured));
        self.hold.add(&(held - row.measured));
        self.degrees[row.degree.min(MAX_DEGREE)] += 1;
        self.rejected += u64::from(row.rendered.is_none());
    }

    fn figures(mut self, recording: &Recording, mode: Mode, settings: &Settings) -> Figures {
        let compared = self.error.norms.len();
        let share = |count: u64| count as f64 / compared.max(1) as f64;
        let [degree_1, degree_2, degree_3, degree_4, degree_5] =
            self.reconstruction.map(|errors| errors.reconstruction());
        let tick = self.tick.quantiles();
        self.conditions.sort_unstable_by(f64::total_cmp);
        Figures {
            samples: recording.samples.len(),
            rate_hz: recording.rate_hz,
            axes: recording.axes.iter().map(|&axis| nima_recording::csv::AXIS_NAMES[axis]).collect(),
            mode,
            window_ms: tidy_ms(settings.window_s),
            delay_ms: tidy_ms(settings.delay_s),
            compared,
            error: self.error.figures(),
            hold: self.hold.figures(),
            reconstruction: Reconstructions {
                degree_1,
                degree_2,
                degree_3,
                degree_4,
                degree_5,
                selected: self.selected.reconstruction(),
            },
            degree_share: std::array::from_fn(|i| share(self.degrees[i + 1])),
            nonlinear_share: share(self.degrees[2..].iter().sum()),
            condition: Spread {
                p50: quantile(&self.conditions, 0.5),
                p95: quantile(&self.conditions, 0.95),
                max: quantile(&self.conditions, 1.0),
            },
            rejected: self.rejected,
            holes: self.holes,
            longest_hole_s: tidy_ms(self.longest_hole_s) * 1e-3,
            tick_us: TickTime { p50: tick.p50, p99: tick.p99, max: tick.max },
        }
    }
}

/// Seconds to milliseconds, rounded to remove the error of the division.
fn tidy_ms(seconds: f64) -> f64 {
    (seconds * 1e9).round() * 1e-6
}

/// Errors stored to compute percentiles.
#[derive(Default)]
struct Errors {
    norms: Vec<f64>,
    sum: Vector3<f64>,
    squares: f64,
}

impl Errors {
    fn add(&mut self, error: &Vector3<f64>) {
        self.norms.push(error.norm());
        self.sum += error;
        self.squares += error.norm_squared();
    }

    fn reconstruction(&self) -> Reconstruction {
        let count = self.norms.len().max(1) as f64;
        let mae = self.norms.iter().sum::<f64>() / count;
        let variance = self.squares / count - (self.sum / count).norm_squared();
        Reconstruction { mae, sd: variance.max(0.0).sqrt() }
    }

    fn figures(&mut self) -> ErrorFigures {
        let Reconstruction { mae, sd } = self.reconstruction();
        self.norms.sort_unstable_by(f64::total_cmp);
        ErrorFigures { mae, sd, p95: quantile(&self.norms, 0.95), max: quantile(&self.norms, 1.0) }
    }
}

/// Quantile of sorted values (nearest rank); 0 if there are none.
fn quantile(sorted: &[f64], q: f64) -> f64 {
    let rank = (q * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.clamp(1, sorted.len().max(1)) - 1).copied().unwrap_or(0.0)
}
