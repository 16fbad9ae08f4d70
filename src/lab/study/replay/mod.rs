//! Replays a recording through the identification, causally and sample by sample, and computes the results of `nima
//! identify`.
//!
//! For every sample at time t the force is rendered from data up to t - D and the motion at t, exactly like a leader
//! behind a link of delay D, and compared with the force measured at t and with the delayed force f(t - D) (delayed
//! DFR). Units as in the recording (N and m, or Nm and rad).
//!
//! If the leader's motion was recorded too, the force is computed from it, as the loop does with the handle's motion.

mod figures;
mod leader;
mod renewal;
mod summary;
mod tally;
mod unit;

use std::time::Instant;

use nalgebra::Vector3;
use nima_core::{
    impedance::{Identifier, ImpedanceSettings, LinkPacket, Mode, ModeSet, OwnMotion, Recipe, Sample, SettingsError},
    limits::WINDOW_SAMPLES,
    safety::{ChainSettings, ForceRequest, SafetyChain},
    signal::DelayLine,
};
use nima_recording::csv::CsvRecording;

pub use figures::{ErrorFigures, FigureSpread, IdentificationTime, Reconstruction, Reconstructions, ReplayFigures};
pub use summary::{RatioFigures, ReplaySummary};

use self::{leader::ReplayLeader, tally::ReplayTally, unit::PositionUnit};

/// Why a recording could not be replayed.
#[derive(Debug, thiserror::Error)]
pub enum RecordingReplayError {
    #[error(transparent)]
    Settings(#[from] SettingsError),
    #[error(
        "recording {path} has {found} samples; a window of {window_ms} ms and a delay of {delay_ms} ms at {rate_hz} Hz need {needed}; record longer or shorten the window"
    )]
    TooShort { path: String, found: usize, needed: usize, window_ms: f64, delay_ms: f64, rate_hz: f64 },
    /// A delay that would be rounded to zero.
    #[error(
        "the delay of {delay_ms} ms is less than half a sample of recording {path} ({rate_hz} Hz); use 0 or at least {min_ms:.3} ms"
    )]
    ShortDelay { path: String, delay_ms: f64, rate_hz: f64, min_ms: f64 },
}

/// A time step longer than this (s) and this many periods is a gap.
const HOLE_S: f64 = 0.05;
const HOLE_PERIODS: f64 = 10.0;
/// A gap up to this long (s) is bridged like lost samples; after a longer one, window and delay start again.
const BRIDGED_S: f64 = 10.0;

/// A sample that was not recorded.
const UNKNOWN: Vector3<f64> = Vector3::new(f64::NAN, f64::NAN, f64::NAN);

/// One row of the trace.
#[derive(Clone, Copy, Debug)]
pub struct ReplayRow {
    pub t_s: f64,
    pub measured: Vector3<f64>,
    /// Rendered force, before the gates. `None` before the first packet, and while the mode has no valid force.
    pub rendered: Option<Vector3<f64>>,
    /// `None` before the first packet, and one delay after a gap.
    pub held: Option<Vector3<f64>>,
    /// Degree used, 0 for none.
    pub degree: usize,
    /// Condition number of the scaled regression.
    pub condition: f64,
    /// The first gate that would change this force.
    pub gate: &'static str,
}

/// Options of a replay.
#[derive(Clone, Copy, Debug)]
pub struct ReplayOptions {
    pub mode: Mode,
    pub window_s: f64,
    pub delay_s: f64,
    pub max_degree: usize,
    /// Whether to learn the full matrix `M`, with cross-talk.
    pub cross_talk: bool,
    /// Interpretation of the paper for the modes literal and linear.
    pub literal: Recipe,
}

/// Motion and force over time, from any storage.
#[derive(Clone)]
pub struct ReplayMotion<'a> {
    /// Name in messages: `recording NAME has ...`.
    pub name: String,
    /// The axes; lane `i` of a sample is axis `axes[i]`.
    pub axes: &'a [usize],
    pub rate_hz: f64,
    pub samples: usize,
    /// Returns the sample with this index; times rise, and numbers are finite.
    pub sample: &'a dyn Fn(usize) -> Sample,
    /// Returns the leader's motion in the same tick, mapped to the tip, m.
    pub leader_m: Option<&'a dyn Fn(usize) -> Vector3<f64>>,
}

/// Replays `recording`; `each` is called with every row in order.
///
/// # Errors
/// [`RecordingReplayError`] if a setting is out of range or the recording is shorter than window and delay together.
///
/// ```
/// use nima_core::impedance::{Mode, Recipe};
/// use nima_recording::csv::{ColumnMapping, CsvRecording};
/// use nima_study::replay::{ReplayOptions, replay};
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
/// let recording = CsvRecording::read(&path, &ColumnMapping::default())?;
/// let literal = Recipe::default();
/// let options = ReplayOptions { mode: Mode::Anchored, window_s: 0.3, delay_s: 0.05, max_degree: 2, cross_talk: false, literal };
/// let figures = replay(&recording, &options, |_| {})?;
/// assert!(figures.error.mae < 0.5 * figures.hold.mae, "better than the delayed force");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn replay(
    recording: &CsvRecording,
    options: &ReplayOptions,
    mut each: impl FnMut(&ReplayRow),
) -> Result<ReplayFigures, RecordingReplayError> {
    let sample = |i: usize| recording.samples[i];
    let leader = recording.leader_m.as_ref().map(|leader_m| move |i: usize| leader_m[i]);
    let motion = ReplayMotion {
        name: recording.path.display().to_string(),
        axes: &recording.axes,
        rate_hz: recording.rate_hz,
        samples: recording.samples.len(),
        sample: &sample,
        leader_m: leader.as_ref().map(|leader| leader as &dyn Fn(usize) -> Vector3<f64>),
    };
    replay_motion(&motion, options, |row, _| each(row))
}

/// Like [`replay`], for motion in any storage; `each` also gets the data sent by the follower in that tick.
///
/// # Errors
/// As [`replay`].
pub fn replay_motion(
    motion: &ReplayMotion<'_>,
    options: &ReplayOptions,
    mut each: impl FnMut(&ReplayRow, &LinkPacket),
) -> Result<ReplayFigures, RecordingReplayError> {
    let ReplayMotion { rate_hz, samples, sample, .. } = *motion;
    let (settings, delay) = settings(motion, options)?;
    nima_baselines::provide();
    let mut identifier = Identifier::new(&settings)?;
    let leader = |position_m| Ok::<_, SettingsError>((ReplayLeader::new(&settings, delay)?, position_m));
    let mut leader = motion.leader_m.map(leader).transpose()?;
    let mut tally = ReplayTally::default();
    let mut gates = SafetyChain::new(ChainSettings::default(), 1.0 / rate_hz);
    let hole_s = HOLE_S.max(HOLE_PERIODS / rate_hz);
    let unit = PositionUnit::of(motion);
    let mut held = DelayLine::new(delay, None);
    let mut last: Option<Sample> = None;
    for i in 0..samples {
        let read = sample(i);
        let now = Sample { position_m: unit.metres(&read.position_m), ..read };
        let step_s = last.map_or(0.0, |last| now.t_s - last.t_s);
        if step_s > hole_s {
            tally.hole(step_s);
            gates.reset();
            let mut follower = ReplayFollower { identifier: &mut identifier, held: &mut held };
            let renderer = leader.as_mut().map(|(leader, _)| leader);
            match last {
                Some(last) if step_s <= BRIDGED_S => follower.bridge(&last, step_s, rate_hz, renderer),
                _ => follower.restart(renderer),
            }
            last = None;
        }
        let start = Instant::now();
        identifier.step(&now);
        tally.tick.record(start.elapsed().as_secs_f64());
        held.push(Some(now.force_n));
        let report = identifier.report();
        let rendered = match &mut leader {
            Some((leader, position_m)) => {
                leader.step(&unit.metres(&position_m(i)), identifier.parcel()).force(options.mode)
            }
            None => report.prediction(options.mode),
        };
        let held = held.get(delay).copied().flatten();
        let speed_m_s = (now.position_m - last.unwrap_or(now).position_m).norm() * rate_hz;
        let (_, gate) = gates.step(&ForceRequest {
            t_s: now.t_s,
            force_n: rendered,
            age_s: 0.0,
            speed_m_s,
            permitted: true,
            ..ForceRequest::default()
        });
        let row = ReplayRow {
            t_s: now.t_s,
            measured: now.force_n,
            rendered: rendered.filter(|_| held.is_some()),
            held,
            degree: usize::from(report.degree_of(options.mode)),
            condition: report.condition,
            gate: gate.first_closed(),
        };
        tally.add(&row, report);
        each(&row, identifier.parcel());
        last = Some(now);
    }
    Ok(tally.figures(motion, options.mode, &settings, &unit))
}

/// The follower's end of a replay at a gap.
struct ReplayFollower<'a> {
    identifier: &'a mut Identifier,
    held: &'a mut DelayLine<Option<Vector3<f64>>>,
}

impl ReplayFollower<'_> {
    /// Runs the ticks of a gap after the sample `last`, as if every sample had been lost.
    fn bridge(&mut self, last: &Sample, step_s: f64, rate_hz: f64, mut leader: Option<&mut ReplayLeader>) {
        let missing = ((step_s * rate_hz).round() as usize).saturating_sub(1);
        for k in 1..=missing {
            let t_s = last.t_s + k as f64 / rate_hz;
            self.identifier.step(&Sample { t_s, position_m: UNKNOWN, force_n: UNKNOWN });
            // One delay after the gap, there is again a measured force to compare with.
            self.held.push(None);
            if let Some(leader) = &mut leader {
                leader.step(&UNKNOWN, self.identifier.parcel());
            }
        }
    }

    fn restart(&mut self, leader: Option<&mut ReplayLeader>) {
        self.identifier.reset();
        self.held.clear();
        if let Some(leader) = leader {
            leader.reset();
        }
    }
}

/// Returns the settings of the identification, and the delay in samples.
fn settings(
    motion: &ReplayMotion<'_>,
    options: &ReplayOptions,
) -> Result<(ImpedanceSettings, usize), RecordingReplayError> {
    let rate_hz = motion.rate_hz;
    let mut settings = ImpedanceSettings {
        rate_hz,
        window_s: options.window_s,
        delay_s: options.delay_s,
        max_degree: options.max_degree,
        cross_talk: options.cross_talk,
        literal: options.literal,
        axes: motion.axes.len(),
        own_motion: if motion.leader_m.is_some() { OwnMotion::Handle } else { OwnMotion::Follower },
        modes: ModeSet::default().with(options.mode),
        ..ImpedanceSettings::default()
    };
    if options.window_s * rate_hz < WINDOW_SAMPLES.min && !options.mode.has_window() {
        // At a low rate, the paper's windows are left out, and a mode without a window works all the same.
        settings.modes = ModeSet::only(options.mode);
    }
    settings.validate()?;
    let delay = (options.delay_s * rate_hz).round() as usize;
    settings.delay_s = delay as f64 / rate_hz;
    if delay == 0 && options.delay_s > 0.0 {
        return Err(RecordingReplayError::ShortDelay {
            path: motion.name.clone(),
            delay_ms: options.delay_s * 1e3,
            rate_hz,
            min_ms: 0.5e3 / rate_hz,
        });
    }
    let window = if settings.modes.contains(Mode::Literal) { (options.window_s * rate_hz).round() as usize } else { 0 };
    let needed = window + delay + 1;
    if motion.samples < needed {
        return Err(RecordingReplayError::TooShort {
            path: motion.name.clone(),
            found: motion.samples,
            needed,
            window_ms: options.window_s * 1e3,
            delay_ms: settings.delay_s * 1e3,
            rate_hz,
        });
    }
    Ok((settings, delay))
}

#[cfg(test)]
mod tests;
