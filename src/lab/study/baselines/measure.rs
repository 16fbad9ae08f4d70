//! One source at one delay: the errors of every mode.

use nalgebra::Vector3;
use nima_core::impedance::{Identifier, ImpedanceSettings, Mode, ModeSet};

use super::{BaselineRow, BaselinesError, OWN, Split, modes};
use crate::tradeoff::TradeoffSource;

/// Measures every mode on this source at this delay.
pub(super) fn measure(
    source: &TradeoffSource,
    split: Split,
    delay_s: f64,
    cross_talk: bool,
) -> Result<Vec<BaselineRow>, BaselinesError> {
    let rate_hz = source.recording.rate_hz;
    let samples = &source.recording.samples;
    let delay = (delay_s * rate_hz).round() as usize;
    let delay_ms = delay as f64 / rate_hz * 1e3;
    nima_baselines::provide();
    let name = || source.name.clone();
    let needed = delay + 1;
    if samples.len() <= needed {
        return Err(BaselinesError::TooShort { name: name(), samples: samples.len(), needed, delay_ms, rate_hz });
    }
    let held = samples.iter().zip(&samples[delay..]).map(|(then, now)| (then.force_n - now.force_n).norm());
    let held_error = held.sum::<f64>() / (samples.len() - delay) as f64;
    if held_error <= 0.0 {
        return Err(BaselinesError::NothingToCompare { name: name(), delay_ms: delay_s * 1e3 });
    }
    // The program's own modes run in one pass; each baseline runs in its own pass, because only one is computed at a
    // time.
    let own = OWN.into_iter().fold(ModeSet::only(Mode::Dfr), ModeSet::with);
    let sets = [own].into_iter().chain(Mode::BASELINES.map(ModeSet::only));
    let mut errors: Vec<(Mode, f64)> = Vec::new();
    for set in sets {
        let wanted: Vec<Mode> =
            set.modes().filter(|mode| errors.iter().all(|(measured, _)| measured != mode)).collect();
        let settings = ImpedanceSettings {
            rate_hz,
            delay_s: delay as f64 / rate_hz,
            // At least ten samples, for slow recordings.
            window_s: ImpedanceSettings::default().window_s.max(10.0 / rate_hz),
            axes: source.recording.axes.len(),
            cross_talk,
            modes: set,
            ..ImpedanceSettings::default()
        };
        let mut identifier =
            Identifier::new(&settings).map_err(|error| BaselinesError::Settings { name: name(), source: error })?;
        let mut sums = vec![0.0; wanted.len()];
        for (k, sample) in samples.iter().enumerate() {
            identifier.step(sample);
            for (sum, &mode) in sums.iter_mut().zip(&wanted).filter(|_| k >= delay) {
                let rendered = identifier.report().prediction(mode).unwrap_or_else(Vector3::zeros);
                *sum += (rendered - sample.force_n).norm();
            }
        }
        let count = (samples.len() - delay) as f64;
        errors.extend(wanted.into_iter().zip(sums.into_iter().map(|sum| sum / count)));
    }
    let row = |mode: Mode| {
        let error = errors.iter().find(|(measured, _)| *measured == mode).map_or(f64::NAN, |(_, error)| *error);
        BaselineRow {
            source: name(),
            split,
            delay_ms: tidy(delay_s * 1e3),
            used_delay_ms: tidy(delay_ms),
            mode,
            error,
            held_error,
            ratio: error / held_error,
        }
    };
    Ok(modes().map(row).collect())
}

/// Rounded to remove the error of the division.
fn tidy(delay_ms: f64) -> f64 {
    (delay_ms * 1e6).round() * 1e-6
}
