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

    /// Audiences that may see a trial of a blind study with this name.
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
mod tests {
    use nima_machine::{
        config::RigConfig,
        runtime::{Assembly, start},
    };
    use nima_session::{
        file::RecordedFile,
        replay::replay,
        report::{MarkLevel, SessionFigures},
    };
    use nima_simulation::scene::Scene;

    use nima_screen::alarms::{Signs, judge, log::AlarmMoment};

    use super::*;

    fn plan() -> SimulationPlan {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load("peg_transfer").unwrap();
        SimulationPlan { rig, scene, calibrations: Default::default(), engage: true }
    }

    #[test]
    fn every_loop_is_recorded_and_its_session_replays() {
        let folder = tempfile::tempdir().unwrap();
        let mut sessions = ConsoleSessions::of_user(Some(folder.path()), Servers::default());
        let mut paths = Vec::new();
        for kept in [true, false] {
            let plan = plan();
            let tap = sessions.begin(&plan);
            assert!(tap.is_some(), "{:?}", sessions.trouble());
            let handle = start(Assembly { tap, ..plan.assembly().unwrap() }).unwrap();
            let began = Instant::now();
            while sessions.shown().unwrap().seconds < 2 && began.elapsed() < Duration::from_secs(20) {
                std::thread::sleep(Duration::from_millis(20));
            }
            if kept {
                sessions.toggle_kept();
            }
            assert_eq!(sessions.shown().unwrap().kept, kept);
            paths.push(sessions.shown().unwrap().path);
            handle.stop_and_join().unwrap();
            sessions.end();
            assert_eq!((sessions.shown(), sessions.trouble()), (None, None));
        }
        for path in &paths {
            let file = RecordedFile::open(path).unwrap();
            let outcome = replay(file.journal().unwrap(), |_| ()).unwrap();
            assert!(outcome.differs.is_none() && outcome.closed && outcome.ticks > 0, "{outcome:?}");
        }
    }

    #[test]
    fn while_it_rests_nothing_is_recorded() {
        let folder = tempfile::tempdir().unwrap();
        let mut sessions = ConsoleSessions::of_user(Some(folder.path()), Servers::default());
        sessions.rest(true);
        assert!(sessions.begin(&plan()).is_none());
        assert_eq!((sessions.shown(), sessions.trouble()), (None, None));
        assert!(!folder.path().join("sessions").exists());
        sessions.rest(false);
        assert!(sessions.begin(&plan()).is_some());
    }

    #[test]
    fn marks_and_alarms_of_the_screen_are_in_the_session_at_their_moments_and_it_replays() {
        let folder = tempfile::tempdir().unwrap();
        let mut sessions = ConsoleSessions::of_user(Some(folder.path()), Servers::default());
        let plan = plan();
        let tap = sessions.begin(&plan);
        let handle = start(Assembly { tap, ..plan.assembly().unwrap() }).unwrap();
        // Even a short session is not deleted if it is kept.
        sessions.toggle_kept();
        let mut marks_s = VecDeque::new();
        let mut log = AlarmLog::default();
        let began = Instant::now();
        let newest_s = || {
            let mut newest_s = None;
            handle.drain_ticks(|tick| newest_s = Some(tick.t_s));
            newest_s
        };
        while marks_s.len() < 3 && began.elapsed() < Duration::from_secs(20) {
            std::thread::sleep(Duration::from_millis(300));
            let Some(now_s) = newest_s() else { continue };
            marks_s.push_back(now_s);
            let present = if marks_s.len() == 2 { Some(0.41) } else { None };
            let signs = Signs { running: true, bias_moved_n: present, ..Signs::default() };
            log.update(&judge(&signs), &AlarmMoment::now(Some(now_s), now_s));
            // Reported once, however often the window is drawn.
            for _ in 0..2 {
                sessions.notify(&marks_s, &log, &judge(&signs), Some(now_s));
            }
        }
        let path = sessions.shown().unwrap().path;
        handle.stop_and_join().unwrap();
        sessions.end();
        let figures = SessionFigures::read(&path).unwrap();
        let of = |start: &str| {
            let those = figures.marks.iter().filter(|mark| mark.words.starts_with(start));
            those.map(|mark| (mark.t_s, mark.level, mark.words.clone())).collect::<Vec<_>>()
        };
        let report = of("mark ");
        assert_eq!(report.len(), 3, "{report:?}");
        for (number, ((t_s, level, words), expected_s)) in report.iter().zip(&marks_s).enumerate() {
            assert!((t_s - expected_s).abs() < 1e-6, "{t_s} s, it was {expected_s} s");
            assert_eq!((*level, words.as_str()), (MarkLevel::Mark, &*format!("mark {}", number + 1)));
        }
        let [(raised_s, level, words)] = &of("alarm: ")[..] else { panic!("{:?}", figures.marks) };
        assert!(
            (raised_s - marks_s[1]).abs() < 1e-6 && *level == MarkLevel::Warning && words.contains("0.41 N"),
            "{words}"
        );
        let [(over_s, ..)] = &of("alarm ended: ")[..] else { panic!("{:?}", figures.marks) };
        assert!((over_s - marks_s[2]).abs() < 1e-6);
        let file = RecordedFile::open(&path).unwrap();
        assert!(file.is_closed().unwrap());
        let outcome = replay(file.journal().unwrap(), |_| ()).unwrap();
        assert!(outcome.differs.is_none() && outcome.closed && outcome.ticks > 0, "{outcome:?}");
    }

    #[test]
    fn a_loop_that_ends_at_once_leaves_no_session() {
        let folder = tempfile::tempdir().unwrap();
        let mut sessions = ConsoleSessions::of_user(Some(folder.path()), Servers::default());
        let plan = plan();
        let tap = sessions.begin(&plan);
        drop(start(Assembly { tap, ..plan.assembly().unwrap() }).unwrap());
        let path = sessions.shown().unwrap().path;
        drop(sessions);
        assert!(!path.exists());
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_told_and_the_loop_runs_without_a_recording() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("sessions"), "a file").unwrap();
        let mut sessions = ConsoleSessions::of_user(Some(folder.path()), Servers::default());
        assert!(sessions.begin(&plan()).is_none());
        let trouble = sessions.trouble().unwrap();
        assert!(trouble.contains("sessions"), "{trouble}");
        assert_eq!(sessions.shown(), None);
    }
}
