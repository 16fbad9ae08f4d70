//! The session that is being recorded: begun with every loop that the console runs, without being asked.
//!
//! A key or a button keeps it; what nobody keeps makes room for later sessions. A recording that ends by itself (a full disk, a folder
//! that is gone) is told, and the loop runs on.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use nima_machine::runtime::Tap;
use nima_recording::store::utc_now;
use nima_session::{
    recorder::Recorder,
    shelf::{MOST_BYTES, Shelf, free_bytes, keep},
};
use nima_world::Plan;

use super::{chain, text};
use crate::recording;

/// A loop that ran for fewer ticks than this was no session: a window that could not be opened, a rig that was changed at once.
const LEAST_TICKS: u64 = 1000;
/// How often room is made while a session grows.
const ROOM_EVERY: Duration = Duration::from_secs(30);
/// A disk on which there is room for less than a working day is told.
const WARN_BEFORE: Duration = Duration::from_hours(8);
/// A session must have run for this long before its growth says anything of a day.
const GROWN: Duration = Duration::from_mins(1);

/// The sessions of this console.
#[derive(Debug, Default)]
pub(crate) struct Sessions {
    /// `None`: nothing is recorded.
    shelf: Option<Shelf>,
    now: Option<Now>,
    /// Why the last recording could not begin, or ended by itself.
    trouble: Option<String>,
    looked: Option<Instant>,
    /// The disk is full in this time, at the present rate.
    full_in: Option<Duration>,
}

/// The session that is being recorded.
#[derive(Debug)]
struct Now {
    recorder: Recorder,
    path: PathBuf,
    began: Instant,
    kept: bool,
}

/// What the screen shows of a recording.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shown {
    /// How long it has run.
    pub(crate) seconds: u64,
    pub(crate) kept: bool,
    pub(crate) path: PathBuf,
    pub(crate) bytes: u64,
    /// Entries that were lost, because the disk was slower than the loop.
    pub(crate) lost: u64,
}

impl Sessions {
    /// Records into the folder `sessions` of the user's data folder.
    pub(crate) fn of_user(data_folder: Option<&Path>) -> Self {
        let shelf = data_folder.map(|folder| Shelf::new(folder.join("sessions"), MOST_BYTES));
        Self { shelf, now: None, trouble: None, looked: None, full_in: None }
    }

    /// Begins to record a loop of this plan; the tap is for it. `None` if nothing is recorded.
    pub(crate) fn begin(&mut self, plan: &Plan) -> Option<Tap> {
        self.end();
        let shelf = self.shelf.as_ref()?;
        self.trouble = None;
        let place =
            shelf.place(&utc_now(), &plan.rig.name).map_err(|error| text::sessions::no_folder(shelf.folder(), &error));
        let begun = place.and_then(|path| {
            let (tap, recorder) = recording::begin(&path, plan, "real").map_err(|error| chain(&error))?;
            Ok((tap, Now { recorder, path, began: Instant::now(), kept: false }))
        });
        match begun {
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

    /// Ends the recording; the loop must have ended.
    pub(crate) fn end(&mut self) {
        let Some(Now { recorder, path, kept, .. }) = self.now.take() else { return };
        match recorder.finish() {
            // Whether it can be deleted matters to nobody.
            Ok(progress) if progress.ticks < LEAST_TICKS && !kept => drop(std::fs::remove_file(path)),
            Ok(_) => {}
            Err(error) => self.trouble = Some(chain(&error)),
        }
    }

    /// Keeps the session that is being recorded, or leaves it to be deleted.
    pub(crate) fn toggle_kept(&mut self) {
        let Some(now) = &mut self.now else { return };
        match keep(&now.path, !now.kept) {
            Ok(()) => now.kept = !now.kept,
            Err(error) => self.trouble = Some(text::sessions::not_kept(&now.path, &error)),
        }
    }

    /// Why nothing is recorded although it should be, or what will be in the way within a working day.
    pub(crate) fn trouble(&self) -> Option<String> {
        let ended = self.now.as_ref().and_then(|now| now.recorder.trouble()).map(|error| chain(error));
        let full = || self.full_in.filter(|time| *time < WARN_BEFORE).map(text::sessions::full_in);
        ended.or_else(|| self.trouble.clone()).or_else(full)
    }

    /// The session that is being recorded; `None` if none is.
    pub(crate) fn shown(&self) -> Option<Shown> {
        let now = self.now.as_ref().filter(|now| now.recorder.trouble().is_none())?;
        let progress = now.recorder.progress();
        Some(Shown {
            seconds: now.began.elapsed().as_secs(),
            kept: now.kept,
            path: now.path.clone(),
            bytes: progress.bytes,
            lost: progress.lost,
        })
    }

    /// Makes room while a session grows; to be called now and then.
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
        let grown = now.began.elapsed();
        let per_s = now.recorder.progress().bytes as f64 / grown.as_secs_f64().max(1.0);
        let free = free_bytes(shelf.folder()).filter(|_| grown >= GROWN);
        self.full_in = free.map(|free| Duration::from_secs_f64((free + others) as f64 / per_s.max(1.0)));
    }
}

impl Drop for Sessions {
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
    use nima_session::{file::Recorded, replay::replay};
    use nima_world::scene::Scene;

    use super::*;

    fn plan() -> Plan {
        let (rig, scene) = (RigConfig::load("simulated").unwrap(), Scene::load("peg_transfer").unwrap());
        Plan { rig, scene, calibrations: Default::default(), engage: true }
    }

    #[test]
    fn every_loop_is_recorded_and_its_session_replays() {
        let folder = tempfile::tempdir().unwrap();
        let mut sessions = Sessions::of_user(Some(folder.path()));
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
            let file = Recorded::open(path).unwrap();
            let outcome = replay(file.journal().unwrap(), |_| ()).unwrap();
            assert!(outcome.differs.is_none() && outcome.closed && outcome.ticks > 0, "{outcome:?}");
        }
    }

    #[test]
    fn a_loop_that_ends_at_once_leaves_no_session() {
        let folder = tempfile::tempdir().unwrap();
        let mut sessions = Sessions::of_user(Some(folder.path()));
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
        let mut sessions = Sessions::of_user(Some(folder.path()));
        assert!(sessions.begin(&plan()).is_none());
        let trouble = sessions.trouble().unwrap();
        assert!(trouble.contains("sessions"), "{trouble}");
        assert_eq!(sessions.shown(), None);
    }
}
