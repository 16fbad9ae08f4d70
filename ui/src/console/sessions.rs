//! The session that is being recorded. Recording starts automatically with every loop of the console.
//!
//! A key or a button keeps the session; sessions that are not kept are deleted to make room. If a recording ends on its own
//! (full disk, missing folder), the operator is informed, and the loop continues.

use std::{
    collections::VecDeque,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use nima_endoscope::FrameQueue;
use nima_machine::runtime::Tap;
use nima_recording::store::utc_now;
use nima_screen::{
    alarms::{Alarm, AlarmKind, AlarmPriority, log::AlarmLog},
    image_recorder, recording,
};
use nima_session::{
    disk_forecast::{DiskForecast, WARN_BEFORE},
    objects::ObjectSource,
    recorder::{LogNote, NoteKind, SessionRecorder},
    session_store::{MAX_BYTES, SessionStore, free_bytes, keep},
    sinks::{Audience, Destination},
};
use nima_simulation::SimulationPlan;
use nima_words::text::current_session::DisplayState;
use nima_words::{
    language::{self, Language},
    report_text::{self, chain},
    text,
};

use crate::watching::Servers;

/// A loop with fewer ticks than this is not a session, for example if no window could be opened or the rig was changed at
/// once.
const MIN_TICKS: u64 = 1000;
/// Interval at which space is freed while a session grows.
const ROOM_EVERY: Duration = Duration::from_secs(30);
/// A disk that does not respond for this long is reported: after 2 s entries are lost.
const SLOW: Duration = Duration::from_secs(1);

#[derive(Debug, Default)]
pub(crate) struct ConsoleSessions {
    /// `None`: nothing is recorded.
    shelf: Option<SessionStore>,
    /// Servers for live viewers.
    servers: Servers,
    now: Option<CurrentRecording>,
    /// Reason why the last recording could not start, or ended on its own.
    trouble: Option<String>,
    looked: Option<Instant>,
    /// Time until the disk is full at the current rate.
    full_in: Option<Duration>,
    /// Free bytes on the disk.
    free_bytes: Option<u64>,
    /// Loops that start now are not recorded.
    rests: bool,
    /// Source of the endoscope images.
    reel: FrameQueue,
}

#[derive(Debug)]
struct CurrentRecording {
    recorder: SessionRecorder,
    path: PathBuf,
    began: Instant,
    outlook: DiskForecast,
    kept: bool,
    report: LoggedState,
}

/// Screen events that are already in the session.
#[derive(Debug, Default)]
struct LoggedState {
    /// Number of marks, and the time of the last one, s on the loop's clock.
    marks: usize,
    last_mark_s: Option<f64>,
    /// Alarms whose causes are present.
    alarms: Vec<Alarm>,
}

impl ConsoleSessions {
    /// Records into the folder `sessions` of the user's data folder, with these servers for live viewers.
    pub(crate) fn of_user(data_folder: Option<&Path>, servers: Servers) -> Self {
        let shelf = data_folder.map(|folder| SessionStore::new(folder.join("sessions"), MAX_BYTES));
        let now = None;
        let trouble = None;
        let looked = None;
        let full_in = None;
        let free_bytes = None;
        let reel = FrameQueue::default();
        Self { shelf, servers, now, trouble, looked, full_in, free_bytes, rests: false, reel }
    }

    /// Starts to record a loop of this plan; the tap is for the loop. `None` if nothing is recorded.
    pub(crate) fn begin(&mut self, plan: &SimulationPlan) -> Option<Tap> {
        self.end();
        let shelf = self.shelf.as_ref().filter(|_| !self.rests)?;
        self.trouble = None;
        let started = utc_now();
        let place = shelf.place(&started, &plan.rig.name);
        let begin = |path: PathBuf| {
            let audiences = self.servers.audiences(plan, &self.reel);
            let to = Destination { file: Some(&path), audiences };
            let (tap, recorder) = recording::begin(to, plan, None).map_err(|error| chain(&error))?;
            image_recorder::film(&recorder, &plan.rig, &self.reel);
            let began = Instant::now();
            let outlook = DiskForecast::new(&path, recorder.progress().bytes, began);
            Ok((tap, CurrentRecording { recorder, path, began, outlook, kept: false, report: LoggedState::default() }))
        };
        let place = place.map_err(|error| text::sessions::no_folder(shelf.folder(), &error));
        match place.and_then(begin) {
            Ok((tap, now)) => {
                self.now = Some(now);
                Some(tap)
            }
            Err(trouble) => {
                self.trouble = Some(trouble);
                None
            }
        }
    }

    /// Returns the audiences that may see a trial of a blind study with this name.
    pub(crate) fn blind_audiences(&self, plan: &SimulationPlan, trial: &str) -> Vec<Box<dyn Audience>> {
        self.servers.blind_audiences(plan, trial)
    }

    /// Returns the target of the endoscope images for the recording.
    pub(crate) const fn reel(&self) -> &FrameQueue {
        &self.reel
    }

    /// Sets whether loops that start from now on are not recorded.
    pub(crate) fn rest(&mut self, rests: bool) {
        self.rests = rests;
    }

    /// Also records the objects of the scene that this source reports. Call it before the loop starts.
    pub(crate) fn watch(&self, source: Box<dyn ObjectSource>) {
        if let Some(CurrentRecording { recorder, .. }) = &self.now {
            recorder.watch(source);
        }
    }

    /// Ends the recording; the loop must have ended.
    pub(crate) fn end(&mut self) {
        let Some(CurrentRecording { recorder, path, kept, .. }) = self.now.take() else { return };
        match recorder.finish() {
            // It does not matter if the deletion fails.
            Ok(progress) if progress.ticks < MIN_TICKS && !kept => drop(std::fs::remove_file(path)),
            Ok(_) => {}
            Err(error) => self.trouble = Some(report_text::quoted(&chain(&error))),
        }
    }

    pub(crate) fn toggle_kept(&mut self) {
        let Some(now) = &mut self.now else { return };
        match keep(&now.path, !now.kept) {
            Ok(()) => now.kept = !now.kept,
            Err(error) => self.trouble = Some(text::sessions::not_kept(&now.path, &error)),
        }
    }

    /// Adds new marks (s on the loop's clock) and alarms of the screen to the session: each alarm when its cause appears, and
    /// when it ends. `written` are those alarms in English, for the file. `now_s` is the time of the last tick; faults are in
    /// the session anyway.
    pub(crate) fn notify(&mut self, marks_s: &VecDeque<f64>, alarms: &AlarmLog, written: &[Alarm], now_s: Option<f64>) {
        let (Some(CurrentRecording { recorder, report, .. }), Some(now_s)) = (&mut self.now, now_s) else { return };
        let before_s = report.last_mark_s;
        for &t_s in marks_s.iter().filter(|t_s| before_s.is_none_or(|last_s| **t_s > last_s)) {
            report.marks += 1;
            report.last_mark_s = Some(t_s);
            let words = language::with(Language::English, || text::sessions::mark(report.marks));
            recorder.note(t_s, LogNote { kind: NoteKind::Mark, warns: false, words, names: false });
        }
        let live: Vec<&Alarm> = alarms.live().into_iter().map(|entry| &entry.alarm).collect();
        let alarm = |kind: AlarmKind, warns, words| {
            recorder.note(now_s, LogNote { kind: NoteKind::Alarm, warns, words, names: kind.has_names() });
        };
        report.alarms.retain(|before| {
            let stays = live.iter().any(|alarm| alarm.kind == before.kind);
            if !stays {
                alarm(
                    before.kind,
                    false,
                    language::with(Language::English, || text::sessions::alarm_over(&before.cause)),
                );
            }
            stays
        });
        for new in live {
            let known = report.alarms.iter().any(|alarm| alarm.kind == new.kind);
            if !known && !matches!(new.kind, AlarmKind::Fault(_)) {
                let new = written.iter().find(|alarm| alarm.kind == new.kind).unwrap_or(new);
                let words = language::with(Language::English, || text::sessions::alarm(&new.cause));
                alarm(new.kind, new.priority < AlarmPriority::Low, words);
                report.alarms.push(new.clone());
            }
        }
    }

    /// Returns the reason why nothing is recorded although it should be, or a problem expected within a day.
    pub(crate) fn trouble(&self) -> Option<String> {
        let recorder = self.now.as_ref().map(|now| &now.recorder);
        let ended = recorder.and_then(SessionRecorder::trouble).map(|error| chain(error));
        let progress = recorder.map(SessionRecorder::progress).unwrap_or_default();
        let slow = || (progress.waits > SLOW).then(|| text::sessions::slow(progress.waits));
        let lost = || (progress.lost > 0).then(|| text::sessions::lost(progress.lost));
        let images = || (progress.images_dropped > 0).then(|| text::sessions::images_lost(progress.images_dropped));
        let full = || self.full_in.filter(|time| *time < WARN_BEFORE).map(report_text::disk_full_in);
        ended.or_else(slow).or_else(lost).or_else(images).or_else(|| self.trouble.clone()).or_else(full)
    }

    /// Returns the current recording; `None` if there is none.
    pub(crate) fn shown(&self) -> Option<DisplayState> {
        let now = self.now.as_ref().filter(|now| now.recorder.trouble().is_none())?;
        let progress = now.recorder.progress();
        Some(DisplayState {
            seconds: now.began.elapsed().as_secs(),
            kept: now.kept,
            path: now.path.clone(),
            bytes: progress.bytes,
            free_bytes: self.free_bytes,
            lost: progress.lost,
            images: progress.images,
            marks: now.report.marks,
            watched: self.servers.shown(),
        })
    }

    /// Makes room while a session grows. Call it regularly.
    pub(crate) fn look_after(&mut self) {
        let (Some(shelf), Some(now)) = (&self.shelf, &self.now) else { return };
        if self.looked.is_some_and(|at| at.elapsed() < ROOM_EVERY) {
            return;
        }
        self.looked = Some(Instant::now());
        let others = match shelf.make_room(Some(&now.path)) {
            Ok(others) => others,
            Err(error) => {
                self.trouble = Some(text::sessions::no_folder(shelf.folder(), &error));
                0
            }
        };
        self.free_bytes = free_bytes(shelf.folder());
        self.full_in = now.outlook.full_in(now.recorder.progress().bytes, others, Instant::now());
    }
}

impl Drop for ConsoleSessions {
    fn drop(&mut self) {
        self.end();
    }
}

#[cfg(test)]
mod tests;
