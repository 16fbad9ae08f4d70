//! Reader of a recorded session during playback: it reads the session once from start to end, and again around any moment.
//!
//! The first reading stores loops to continue from (keyframes), samples, the extremes of the traces, and events. A moment is
//! shown at once from these and from the recorded plots in the file; then the loop is replayed to that moment from some
//! seconds before, so that every panel shows its original content. Parts that cannot be replayed are shown from the recorded
//! plots.

use nima_machine::{
    messages::{Event, Tick},
    rig::{SIDES, Side},
};
use nima_screen::{
    history::CHANNELS,
    live::LiveState,
    recording::WORDS,
    signals::{TipThen, signals_of},
};
use nima_session::{
    file::{LineKind, LogLine},
    replay::Keyframe,
};
use nima_words::report_text::{chain, quoted};

use super::{
    feed::{FeedPosition, TickFeed, TickFrame, plots},
    overview::EventNote,
    playback_file::PlaybackFile,
    shown_s,
};

/// Length of the replay before a moment, s, so that traces and values have their history.
const LEAD_S: f64 = 10.0;
/// Traces reach back to this time before it, s.
pub(super) const TRACES_S: f64 = 120.0;
/// Minimum time between keyframes, s; doubled whenever there are too many.
const KEYFRAME_S: f64 = 1.5;
/// Maximum number of stored keyframes: each is a whole loop, 17 MB with one arm and 27 MB with two.
const KEYFRAMES: usize = 40;
/// Time between samples, s.
const SAMPLE_S: f64 = 0.1;
/// Length of a column of the traces, s.
const COLUMN_S: f64 = 0.016;
/// The log is read in segments of this length, s, because each read searches all chunks of its time range.
const LOG_S: f64 = 4.0;
/// A moment without a tick uses the next tick within this time, s.
const NEXT_S: f64 = 0.05;

/// Extremes of the signals in a short time.
#[derive(Clone, Copy, Debug)]
struct ForceColumn {
    number: u64,
    low: [f32; CHANNELS],
    high: [f32; CHANNELS],
}

/// Results of the first reading so far.
pub(super) struct SessionIndex<'a> {
    pub(super) file: &'a PlaybackFile,
    blank: [Option<Tick>; SIDES],
    reading: Option<TickFeed>,
    keyframes: Vec<Keyframe>,
    keyframe_s: f64,
    samples: [Vec<Tick>; SIDES],
    columns: [Vec<ForceColumn>; SIDES],
    /// Tip at the last tick of each arm.
    tips: [Option<TipThen>; SIDES],
    events: Vec<(f64, Event)>,
    /// Operator marks, s.
    marks_s: Vec<f64>,
    /// The log was read up to this time, s.
    log_s: f64,
    /// Everything before this time was read, s.
    read_s: f64,
    /// The replay matches the recording up to this time, s.
    exact_s: f64,
    /// Reason why the rest is available only from the recorded plots.
    pub(super) why: Option<String>,
}

/// A replay towards a moment.
pub(super) struct Chase {
    feed: TickFeed,
    live: LiveState,
    like: [Option<Tick>; SIDES],
    from_s: f64,
    to_s: f64,
}

impl<'a> SessionIndex<'a> {
    pub(super) fn new(file: &'a PlaybackFile) -> Result<Self, String> {
        let mut film = Self {
            file,
            blank: file.blank()?,
            reading: Some(TickFeed::Plots(0.0)),
            keyframes: Vec::new(),
            keyframe_s: KEYFRAME_S,
            samples: Default::default(),
            columns: Default::default(),
            tips: Default::default(),
            events: Vec::new(),
            marks_s: Vec::new(),
            log_s: 0.0,
            read_s: 0.0,
            exact_s: 0.0,
            why: None,
        };
        let start = file.start.as_ref().map_err(Clone::clone);
        match start.and_then(|start| Keyframe::first(start).map_err(|error| quoted(&chain(&error)))) {
            Ok(first) => {
                film.reading = file.feed(&first);
                film.keyframes.push(first);
            }
            Err(why) => film.why = Some(why),
        }
        Ok(film)
    }

    /// Returns the time up to which the session was read, s.
    pub(super) const fn read_s(&self) -> f64 {
        self.read_s
    }

    /// Returns whether the loop can be replayed up to this time, s.
    pub(super) fn is_exact(&self, t_s: f64) -> bool {
        t_s <= self.exact_s
    }

    /// Reads for a short time; returns false at the end. `each` receives all data read.
    pub(super) fn read(&mut self, mut each: impl FnMut(&TickFrame)) -> bool {
        let Some(mut reading) = self.reading.take() else { return false };
        let mut frames = Vec::new();
        let like = self.like(self.read_s);
        let reached = reading.slice(self.file, &like, f64::INFINITY, |frame| frames.push(frame));
        let is_replay = matches!(reading, TickFeed::Replay(_));
        for frame in frames {
            self.keep(&frame, is_replay);
            each(&frame);
        }
        match (reached, is_replay) {
            (FeedPosition::End(why), true) => {
                // A truncated recording has more plots than journal.
                self.why = self.why.take().or(why);
                let has_more = self.read_s + NEXT_S < self.file.end_s;
                self.reading = has_more.then_some(TickFeed::Plots(self.read_s + 1e-6));
            }
            (FeedPosition::End(why), false) => {
                self.why = self.why.take().or(why);
                self.read_s = self.file.end_s;
            }
            (FeedPosition::More | FeedPosition::Limit, _) => self.reading = Some(reading),
        }
        if let Some(reading) = &self.reading {
            self.keep_loop(reading.keyframe());
        }
        self.reading.is_some()
    }

    /// Returns the log entries of the segments read so far, once there are enough of them.
    pub(super) fn notes(&mut self) -> Vec<EventNote> {
        if self.reading.is_some() && self.read_s < self.log_s + LOG_S {
            return Vec::new();
        }
        let to_ns = if self.reading.is_some() { self.file.time_ns(self.read_s) } else { u64::MAX };
        let times_ns = self.file.time_ns(self.log_s)..to_ns;
        self.log_s = self.read_s;
        // An unreadable log yields no entries; the replay or the plots report the damage.
        let lines = self.file.log(times_ns);
        let devices = self.file.rig.device_names();
        let note = |LogLine { time_ns, kind, words, value }| {
            let words = value.and_then(|value| WORDS.of(&value, &devices)).unwrap_or(words);
            EventNote { t_s: self.file.t_s(time_ns), kind, words }
        };
        let notes: Vec<EventNote> = lines.into_iter().map(note).collect();
        self.marks_s.extend(notes.iter().filter(|note| note.kind == LineKind::Mark).map(|note| note.t_s));
        notes
    }

    fn keep(&mut self, frame: &TickFrame, is_replay: bool) {
        let TickFrame { t_s, events, ticks, .. } = frame;
        self.read_s = *t_s;
        if is_replay {
            self.exact_s = *t_s;
        }
        self.events.extend(events.iter().map(|event| (*t_s, *event)));
        for tick in ticks.iter().flatten() {
            let side = tick.side.index();
            if self.samples[side].last().is_none_or(|last| *t_s >= last.t_s + SAMPLE_S) {
                self.samples[side].push(*tick);
            }
            let before = self.tips[side].replace((tick.t_s, tick.positions.tip_m));
            add(&mut self.columns[side], *t_s, &signals_of(tick, before));
        }
    }

    fn keep_loop(&mut self, keyframe: Option<Keyframe>) {
        let due_s = self.keyframes.last().map_or(0.0, |last| last.t_s() + self.keyframe_s);
        let Some(keyframe) = keyframe.filter(|keyframe| keyframe.t_s() >= due_s) else { return };
        self.keyframes.push(keyframe);
        if self.keyframes.len() > KEYFRAMES {
            let mut number = 0;
            self.keyframes.retain(|_| {
                number += 1;
                number % 2 == 1
            });
            self.keyframe_s *= 2.0;
        }
    }

    /// Returns the last samples before this time, s, for values missing in the recorded plots.
    fn like(&self, t_s: f64) -> [Option<Tick>; SIDES] {
        Side::ALL.map(|side| {
            let samples = &self.samples[side.index()];
            let before = samples.partition_point(|tick| tick.t_s <= t_s);
            before.checked_sub(1).map(|last| samples[last]).or(self.blank[side.index()])
        })
    }

    /// Returns the state of the window before this time, s: traces and events.
    fn live(&self, t_s: f64) -> LiveState {
        let mut live = LiveState::of_past(self.file.rig.clone(), self.file.scene.clone());
        if let Some(signals) = self.file.signals() {
            live.history.iter_mut().for_each(|history| history.bridge(signals.gap_s()));
        }
        live.replay(self.events.iter().take_while(|(at_s, _)| *at_s < t_s).map(|(_, event)| event), &[None; SIDES]);
        // Later marks are to the right of the traces.
        live.marks_s.extend(&self.marks_s);
        for (columns, history) in self.columns.iter().zip(&mut live.history) {
            let from = columns.partition_point(|column| begin_s(column) < t_s - TRACES_S);
            for column in columns[from..].iter().take_while(|column| begin_s(column) + COLUMN_S <= t_s) {
                history.push(begin_s(column), &column.low);
                history.push(begin_s(column), &column.high);
            }
        }
        live
    }

    /// Returns the moment at this time, s, at once: recorded plot values, the rest from the last sample.
    pub(super) fn at_once(&self, t_s: f64) -> LiveState {
        let like = self.like(t_s);
        // Ignore damage here: it is reported when the first reading reaches it.
        let frames = plots(self.file, &like, t_s, t_s + NEXT_S).unwrap_or_default();
        let frame = frames.into_iter().next();
        let mut live = self.live(t_s);
        live.show_objects(self.file.objects(frame.as_ref().map_or(t_s, |frame| frame.t_s)));
        live.replay(std::iter::empty(), &frame.map_or(like, |frame| frame.ticks));
        live.settle(0.0);
        live
    }

    /// Starts a replay to the first tick at or after this time, s.
    pub(super) fn chase(&self, to_s: f64) -> Chase {
        let from_s = (to_s - LEAD_S).max(0.0);
        let keyframe = self.keyframes.iter().rfind(|keyframe| keyframe.t_s() <= from_s);
        let replay = keyframe.filter(|_| self.is_exact(to_s)).and_then(|keyframe| self.file.feed(keyframe));
        let feed = replay.unwrap_or(TickFeed::Plots(from_s));
        Chase { feed, live: self.live(from_s), like: self.like(from_s), from_s, to_s }
    }
}

impl Chase {
    /// Continues for a short time; true when the moment is reached.
    pub(super) fn go_on(&mut self, file: &PlaybackFile) -> bool {
        let Self { feed, live, like, from_s, to_s } = self;
        let reached = feed.slice(file, like, *to_s, |frame| {
            if frame.t_s >= *from_s {
                live.replay(frame.events.iter(), &frame.ticks);
            }
        });
        reached != FeedPosition::More
    }

    /// Returns the state to show, and the view to continue from.
    pub(super) fn end(mut self, file: &PlaybackFile) -> (LiveState, PlaybackPosition) {
        if self.live.ticks.iter().all(Option::is_none) {
            // No tick could be read here.
            self.live.replay(std::iter::empty(), &self.like);
        }
        self.live.settle(self.to_s - self.from_s);
        let objects = file.objects(shown_s(&self.live));
        self.live.show_objects(objects);
        let like = std::array::from_fn(|side| self.live.ticks[side].or(self.like[side]));
        (self.live, PlaybackPosition { feed: self.feed, like })
    }
}

/// The displayed moment, and the feed that continues from it.
pub(super) struct PlaybackPosition {
    feed: TickFeed,
    like: [Option<Tick>; SIDES],
}

impl PlaybackPosition {
    /// Returns whether every value is replayed, not only those in the recorded plots.
    pub(super) const fn is_exact(&self) -> bool {
        matches!(self.feed, TickFeed::Replay(_))
    }

    /// Returns the ticks up to this time, s; `None` at the end.
    pub(super) fn go_on(&mut self, file: &PlaybackFile, to_s: f64) -> Option<Vec<TickFrame>> {
        let mut frames = Vec::new();
        let reached = loop {
            match self.feed.slice(file, &self.like, to_s, |frame| frames.push(frame)) {
                FeedPosition::More => {}
                reached => break reached,
            }
        };
        if let Some(last) = frames.last_mut() {
            last.objects = file.objects(last.t_s);
        }
        (reached == FeedPosition::Limit || !frames.is_empty()).then_some(frames)
    }
}

fn begin_s(column: &ForceColumn) -> f64 {
    column.number as f64 * COLUMN_S
}

fn add(columns: &mut Vec<ForceColumn>, t_s: f64, values: &[f32; CHANNELS]) {
    let number = (t_s / COLUMN_S) as u64;
    if columns.last().is_none_or(|last| last.number != number) {
        columns.push(ForceColumn { number, low: *values, high: *values });
    }
    let Some(column) = columns.last_mut() else { return };
    for ((low, high), value) in column.low.iter_mut().zip(&mut column.high).zip(values) {
        *low = low.min(*value);
        *high = high.max(*value);
    }
}
