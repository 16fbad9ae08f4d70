//! The score of a recorded session: motion and force of the hands while they were engaged.

use std::{collections::BTreeMap, ops::Range, path::Path};

use nima_machine::{messages::LoopState, rig::Side};
use nima_recording::session::Reader;
use nima_score::{Event, HandSample, Happening, Sample, Score, Scorer, TaskFile};

use crate::plotted::{self, PlottedError, PlottedTick};

/// Both arms are read in stretches of this length, ns.
const STRETCH_NS: u64 = 2_000_000_000;

/// Scores a stretch of a session (ns since 1970). The trial goes from the first tick in which an arm is engaged to the last one; `None` if none
/// was.
///
/// # Errors
/// [`PlottedError`] for a file that cannot be read, or that another program wrote.
pub fn score(
    reader: &Reader,
    path: &Path,
    times_ns: &Range<u64>,
    task: &TaskFile,
) -> Result<Option<Score>, PlottedError> {
    let arms = plotted::arms(reader);
    if arms.is_empty() {
        return Err(PlottedError::NoArms { path: path.to_owned() });
    }
    let Some([first_ns, last_ns]) = engaged(reader, path, times_ns, &arms)? else { return Ok(None) };
    let mut scorer = Scorer::new(task);
    let mut ended_s = None;
    let mut from_ns = first_ns;
    while from_ns <= last_ns {
        let to_ns = from_ns.saturating_add(STRETCH_NS).min(last_ns + 1);
        for sample in samples(reader, path, from_ns..to_ns, &arms)? {
            if ended_s.is_none() {
                scorer.happening(&Happening { t_s: sample.t_s, event: Event::Begun });
            }
            ended_s = Some(sample.t_s);
            scorer.sample(&sample);
        }
        from_ns = to_ns;
    }
    if let Some(t_s) = ended_s {
        scorer.happening(&Happening { t_s, event: Event::Ended });
    }
    Ok(Some(scorer.finish()))
}

/// When an arm is first engaged, and last.
fn engaged(
    reader: &Reader,
    path: &Path,
    times_ns: &Range<u64>,
    arms: &[Side],
) -> Result<Option<[u64; 2]>, PlottedError> {
    let mut extent: Option<[u64; 2]> = None;
    for arm in arms {
        plotted::each_tick(reader, path, *arm, times_ns.clone(), |PlottedTick { time_ns, state, .. }| {
            if state == LoopState::Engaged.word() {
                let [first, last] = extent.unwrap_or([time_ns; 2]);
                extent = Some([first.min(time_ns), last.max(time_ns)]);
            }
            Ok::<_, PlottedError>(())
        })?;
    }
    Ok(extent)
}

/// A side as the score has it.
pub const fn side_of(arm: Side) -> nima_score::Side {
    match arm {
        Side::Left => nima_score::Side::Left,
        Side::Right => nima_score::Side::Right,
    }
}

/// Both hands, tick by tick.
fn samples(reader: &Reader, path: &Path, times_ns: Range<u64>, arms: &[Side]) -> Result<Vec<Sample>, PlottedError> {
    let mut samples: BTreeMap<u64, Sample> = BTreeMap::new();
    for arm in arms {
        let place = side_of(*arm);
        plotted::each_tick(reader, path, *arm, times_ns.clone(), |tick| {
            let PlottedTick { time_ns, t_s, tip_m, measured_n, rendered_n, state, .. } = tick;
            let engaged = state == LoopState::Engaged.word();
            // No endoscope and no jaw is in a session yet.
            let hand = HandSample { tip_m, jaw_rad: None, force_n: measured_n, rendered_n, engaged, in_view: true };
            let none = || Sample { t_s, ..Sample::default() };
            samples.entry(time_ns).or_insert_with(none).hands[place.index()] = Some(hand);
            Ok::<_, PlottedError>(())
        })?;
    }
    Ok(samples.into_values().collect())
}
