//! The ticks of a session from a start time: replayed, or from the recorded plots in its file.

use std::{collections::BTreeMap, mem::discriminant, ops::Range};

use nima_machine::{
    messages::{Event, Tick, TickPositions, UNKNOWN_N},
    rig::{SIDES, Side},
};
use nima_recording::csv::Signals;
use nima_session::{
    objects::ObjectStates,
    plot_channels::{self, PlottedError, PlottedTick},
    replay::{CursorEvent, Differs, Keyframe, ReplayCursor, ReplayError, StepsMessages},
};
use nima_words::{report_text::chain, text};

use super::playback_file::{PlaybackContents, PlaybackFile};

/// Recorded plots are read in segments of this length, s: about a chunk of the file.
const STRETCH_S: f64 = 0.4;

/// One tick of a session.
#[derive(Clone, Debug)]
pub(super) struct TickFrame {
    pub(super) t_s: f64,
    /// Newly activated calibrations: the side, and their number.
    pub(super) active: Vec<(Side, u64)>,
    pub(super) events: Vec<Event>,
    pub(super) ticks: [Option<Tick>; SIDES],
    /// The objects of the scene at that time, only in the last requested frame.
    pub(super) objects: Option<ObjectStates>,
}

impl TickFrame {
    /// Creates the frame of recorded plots, without ticks.
    const fn plotted(t_s: f64) -> Self {
        Self { t_s, active: Vec::new(), events: Vec::new(), ticks: [None; SIDES], objects: None }
    }
}

/// Source of ticks.
#[expect(clippy::large_enum_variant, reason = "two at most")]
pub(super) enum TickFeed {
    /// A replay of the recorded loop.
    Replay(ReplayCursor<StepsMessages>),
    /// The recorded plots of the file, from this time on, s.
    Plots(f64),
}

/// Progress of a feed.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum FeedPosition {
    /// The limit, exceeded by less than a tick.
    Limit,
    /// More ticks follow before the limit.
    More,
    /// The end, with the reason if it is not the end of the session.
    End(Option<String>),
}

impl TickFeed {
    /// Advances by a block, or to the first tick at or after `limit_s`. `like`: ticks that supply values missing in the
    /// recorded plots.
    pub(super) fn slice(
        &mut self,
        file: &PlaybackFile,
        like: &[Option<Tick>; SIDES],
        limit_s: f64,
        mut each: impl FnMut(TickFrame),
    ) -> FeedPosition {
        match self {
            Self::Replay(cursor) => {
                replay(cursor, limit_s, &mut each).unwrap_or_else(|error| FeedPosition::End(Some(chain(&error))))
            }
            Self::Plots(at_s) => {
                let to_s = *at_s + STRETCH_S;
                let frames = match plots(file, like, *at_s, to_s) {
                    Ok(frames) => frames,
                    Err(error) => return FeedPosition::End(Some(chain(&error))),
                };
                for frame in frames {
                    *at_s = frame.t_s + 1e-6;
                    let reached = frame.t_s >= limit_s;
                    each(frame);
                    if reached {
                        return FeedPosition::Limit;
                    }
                }
                *at_s = at_s.max(to_s);
                if *at_s > file.end_s { FeedPosition::End(None) } else { FeedPosition::More }
            }
        }
    }

    /// Returns the current loop, if it is replayed and a block of the journal has just ended.
    pub(super) fn keyframe(&self) -> Option<Keyframe> {
        match self {
            Self::Replay(cursor) => cursor.keyframe(),
            Self::Plots(_) => None,
        }
    }
}

fn replay(
    cursor: &mut ReplayCursor<StepsMessages>,
    limit_s: f64,
    each: &mut impl FnMut(TickFrame),
) -> Result<FeedPosition, ReplayError> {
    loop {
        match cursor.step()? {
            None | Some(CursorEvent::Closed) => return Ok(FeedPosition::End(None)),
            Some(CursorEvent::Hole(hole)) => return Ok(FeedPosition::End(Some(text::playback::hole(hole.lost)))),
            Some(CursorEvent::Tick(moment)) => {
                if let Some(Differs { t_s, .. }) = moment.differs() {
                    return Ok(FeedPosition::End(Some(text::playback::differs(t_s))));
                }
                let t_s = moment.row.timing.now_s;
                let active = moment.active.to_vec();
                let events = moment.events.to_vec();
                each(TickFrame { t_s, active, events, ticks: *moment.ticks, objects: None });
                if t_s >= limit_s {
                    return Ok(FeedPosition::Limit);
                }
                if cursor.is_between_blocks() {
                    return Ok(FeedPosition::More);
                }
            }
        }
    }
}

/// Returns the recorded plots from `from_s` up to `to_s`, as ticks.
pub(super) fn plots(
    file: &PlaybackFile,
    like: &[Option<Tick>; SIDES],
    from_s: f64,
    to_s: f64,
) -> Result<Vec<TickFrame>, PlottedError> {
    let recorded = match &file.contents {
        PlaybackContents::Session(recorded) => recorded,
        PlaybackContents::Signals(signals) => return Ok(rows(signals, like, &(from_s..to_s))),
    };
    let mut frames: BTreeMap<u64, TickFrame> = BTreeMap::new();
    let times_ns = file.time_ns(from_s)..file.time_ns(to_s);
    for arm in &file.arms {
        let Some(like) = &like[arm.index()] else { continue };
        plot_channels::each_tick(recorded.reader(), &file.path, *arm, times_ns.clone(), |plotted| {
            let none = || TickFrame::plotted(plotted.t_s);
            frames.entry(plotted.time_ns).or_insert_with(none).ticks[arm.index()] = Some(tick(like, *arm, &plotted));
            Ok::<_, PlottedError>(())
        })?;
    }
    Ok(frames.into_values().collect())
}

/// Returns the rows of another program's recording between these times, s, as ticks in which all other forces and positions
/// are unknown.
fn rows(signals: &Signals, like: &[Option<Tick>; SIDES], times_s: &Range<f64>) -> Vec<TickFrame> {
    let Some(like) = &like[Side::Right.index()] else { return Vec::new() };
    let from = signals.rows.partition_point(|row| row.t_s < times_s.start);
    let between = signals.rows[from..].iter().take_while(|row| row.t_s < times_s.end);
    let frames = between.map(|row| {
        let plotted = PlottedTick {
            time_ns: 0,
            t_s: row.t_s,
            tip_m: row.position_m,
            leader_m: UNKNOWN_N,
            measured_n: row.force_n,
            delayed_n: UNKNOWN_N,
            asked_n: UNKNOWN_N,
            rendered_n: UNKNOWN_N,
            state: like.state,
        };
        let mut frame = TickFrame::plotted(row.t_s);
        frame.ticks[Side::Right.index()] = Some(tick(like, Side::Right, &plotted));
        frame
    });
    frames.collect()
}

/// Returns a tick like this one, with all recorded plot values.
fn tick(like: &Tick, side: Side, plotted: &PlottedTick) -> Tick {
    let PlottedTick { time_ns: _, t_s, tip_m, leader_m, measured_n, delayed_n, asked_n, rendered_n, state } = plotted;
    // The recorded plots do not contain the kind of fault, so use that of the previous tick.
    let state = if discriminant(state) == discriminant(&like.state) { like.state } else { *state };
    let mut tick = Tick {
        side,
        state,
        t_s: *t_s,
        positions: TickPositions { tip_m: *tip_m, leader_m: *leader_m },
        measured_n: *measured_n,
        ..*like
    };
    tick.rendering.delayed_n = *delayed_n;
    tick.rendering.rendered_n = *rendered_n;
    tick.rendering.asked_n[tick.mode.index()] = *asked_n;
    tick
}
