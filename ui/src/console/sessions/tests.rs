//! Tests of the recordings of the console.

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
