use std::{
    ops::Range,
    path::Path,
    sync::atomic::AtomicBool,
    thread,
    time::{Duration, Instant},
};

use egui::Context;
use nima_machine::{
    config::RigConfig,
    messages::{Command, Tick},
    runtime::{self, Assembly, VirtualClock},
};
use nima_recording::session::SessionReader;
use nima_screen::{recording, scene3d::SceneView};
use nima_session::{
    file::{LineKind, RecordedFile},
    plot_channels,
    replay::replay,
    sinks::Destination,
    trim,
};
use nima_simulation::{SimulationPlan, scene::Scene};

mod damage;
mod images;
mod signals;
mod training;

use super::Playback;

const TIMEOUT: Duration = Duration::from_mins(3);

/// Returns a session of this scene, with a command after this many ticks of the right arm.
fn record(path: &Path, scene: &str, seconds: f64, command: impl Fn(u64) -> Option<Command>) {
    let rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load(scene).unwrap();
    let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: true };
    let (tap, recorder) = recording::begin(Destination::file(path), &plan, Some(VirtualClock::PERFECT)).unwrap();
    runtime::run_virtual(Assembly { tap: Some(tap), ..plan.simulated().unwrap() }, seconds, |tick| {
        (tick.side.index() == 0).then(|| command(tick.index)).flatten()
    });
    recorder.finish().unwrap();
}

/// Returns all ticks of the right arm, and of the left.
fn replayed(path: &Path) -> Vec<[Option<Tick>; 2]> {
    let mut all = Vec::new();
    let outcome =
        replay(RecordedFile::open(path).unwrap().journal().unwrap(), |moment| all.push(*moment.ticks)).unwrap();
    assert!(outcome.closed && outcome.differs.is_none());
    all
}

fn open(path: &Path) -> Playback {
    Playback::open(path, &Context::default(), SceneView::default())
}

fn until(past: &mut Playback, what: &str, good: impl Fn(&Playback) -> bool) {
    let began = Instant::now();
    while !good(past) {
        assert!(began.elapsed() < TIMEOUT, "never: {what}, {:?}", past.report);
        thread::sleep(Duration::from_millis(2));
        past.step(0.0, false);
    }
}

/// Shows a moment until every value is replayed.
fn settled(past: &mut Playback, t_s: f64) {
    past.show(t_s);
    past.extent = super::WorkerExtent::Plotted;
    until(past, "replayed", |past| past.is_whole() && (past.shown_s() - past.wanted_s).abs() < 0.01);
}

fn same(shown: &[Option<Tick>; 2], replayed: &[Option<Tick>; 2]) -> bool {
    // NaN must match too.
    format!("{shown:?}") == format!("{replayed:?}")
}

#[test]
fn a_moment_on_the_screen_is_the_tick_of_the_replay() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "bimanual", 14.0, |tick| (tick == 6000).then_some(Command::SetGain(0.5)));
    let ticks = replayed(&path);
    let mut past = open(&path);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    for number in [0, 1, 13_999].into_iter().chain((1..12).map(|turn| turn * 5471 % ticks.len())) {
        settled(&mut past, number as f64 * 1e-3);
        let live = past.live.as_ref().unwrap();
        assert!(same(&live.ticks, &ticks[number]), "tick {number}");
        let latest_s = live.history[0].latest_s();
        assert!((latest_s - number as f64 * 1e-3).abs() < 1e-9, "the traces end at {latest_s} s");
    }
    assert!(past.report.limited.is_none(), "{:?}", past.report);
}

#[test]
fn what_is_shown_at_once_has_the_forces_and_places_of_that_tick() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "peg_transfer", 8.0, |_| None);
    let ticks = replayed(&path);
    let mut past = open(&path);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    for number in [3210, 7777, 42] {
        past.show(number as f64 * 1e-3);
        past.live = None;
        until(&mut past, "shown", |past| past.live.is_some());
        let shown = past.live.as_ref().unwrap().ticks[0].unwrap();
        let was = ticks[number][0].unwrap();
        assert_eq!(
            (shown.measured_n, shown.rendering.rendered_n, shown.positions.tip_m),
            (was.measured_n, was.rendering.rendered_n, was.positions.tip_m)
        );
        assert_eq!((shown.positions.leader_m, shown.state), (was.positions.leader_m, was.state));
        // Compared bit by bit: the link is still filling at the start, and NaN does not equal itself.
        assert_eq!(shown.rendering.delayed_n.map(f64::to_bits), was.rendering.delayed_n.map(f64::to_bits));
    }
}

#[test]
fn a_session_is_played_tick_by_tick() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "peg_transfer", 6.0, |_| None);
    let ticks = replayed(&path);
    let mut past = open(&path);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    settled(&mut past, 1.0);
    past.toggle();
    for frame in 0..40 {
        let before = past.shown_s();
        past.step(0.02, false);
        until(&mut past, "went on", |past| past.shown_s() > before);
        let live = past.live.as_ref().unwrap();
        let number = (live.ticks[0].unwrap().t_s * 1e3).round() as usize;
        assert!(same(&live.ticks, &ticks[number]), "tick {number} in frame {frame}");
    }
    assert!((past.shown_s() - 1.8).abs() < 0.05, "{} s", past.shown_s());
    past.toggle();
    past.step(1.0, true);
    assert!(!past.moves());
    settled(&mut past, 5.9);
    past.toggle();
    for _ in 0..200 {
        past.step(0.01, false);
        thread::sleep(Duration::from_millis(2));
    }
    assert!(!past.moves(), "it ends with the session");
}

#[test]
fn a_window_that_draws_rarely_plays_as_fast_as_another() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "peg_transfer", 10.0, |_| None);
    let mut past = open(&path);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    for (speed, frame_s) in [(1.0, 0.05), (1.0, 0.5), (4.0, 0.1), (4.0, 0.5)] {
        settled(&mut past, 1.0);
        past.play.speed = speed;
        past.toggle();
        for _ in 0..(2.0 / (speed * frame_s)).round() as usize {
            let before_s = past.shown_s();
            past.step(frame_s, false);
            until(&mut past, "went on", |past| past.shown_s() >= before_s + speed * frame_s - 2e-3);
        }
        past.toggle();
        assert!((past.shown_s() - 3.0).abs() < 0.05, "{} s at {speed}, {frame_s} s a frame", past.shown_s());
    }
    settled(&mut past, 1.0);
    past.play.speed = 1.0;
    past.toggle();
    past.step(60.0, false);
    assert!((past.wanted_s - 2.0).abs() < 0.01, "{} s: data that were not shown are not skipped", past.wanted_s);
}

#[test]
fn what_happened_is_marked_along_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "peg_transfer", 5.0, |tick| match tick {
        2000 => Some(Command::Stop),
        3000 => Some(Command::SetGain(9.0)),
        _ => None,
    });
    let mut past = open(&path);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    let at = |kind: LineKind, t_s: f64| {
        past.overview.notes.iter().any(|note| note.kind == kind && (note.t_s - t_s).abs() < 0.01)
    };
    assert!(at(LineKind::Told, 2.0) && at(LineKind::Warning, 3.0), "{:?}", past.overview.notes);
    assert_eq!(past.overview.buckets.len(), 10);
    let max_n = replayed(&path).iter().map(|ticks| ticks[0].unwrap().measured_n.norm()).fold(0.0, f64::max);
    let shown_n =
        past.overview.buckets.iter().filter_map(|bucket| bucket.measured_n.map(f64::from)).fold(0.0, f64::max);
    assert!((max_n - shown_n).abs() < 1e-4, "{shown_n} N of {max_n} N");
}

fn stretch(from: &Path, to: &Path, seconds: Range<f64>) {
    let reader = SessionReader::open(from).unwrap();
    let begin_ns = plot_channels::beginning_ns(&reader).unwrap();
    let at = |seconds: f64| begin_ns + (seconds * 1e9) as u64;
    trim::write(&reader, "session", &(at(seconds.start)..at(seconds.end)), to, &AtomicBool::new(false)).unwrap();
}

#[test]
fn a_stretch_without_a_journal_is_shown_as_far_as_it_is_plotted() {
    let folder = tempfile::tempdir().unwrap();
    let [path, part] = ["session.mcap", "part.mcap"].map(|name| folder.path().join(name));
    record(&path, "bimanual", 5.0, |_| None);
    stretch(&path, &part, 2.0..4.0);
    let ticks = replayed(&path);
    let mut past = open(&part);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    assert!(past.report.limited.as_ref().is_some_and(|why| why.contains("journal")), "{:?}", past.report);
    past.show(3.5);
    past.live = None;
    until(&mut past, "shown", |past| past.live.as_ref().is_some_and(|live| live.ticks[1].is_some()));
    let shown = past.live.as_ref().unwrap().ticks[1].unwrap();
    assert_eq!((shown.t_s, shown.rendering.rendered_n), (3.5, ticks[3500][1].unwrap().rendering.rendered_n));
    assert!(!past.is_whole());
}

#[test]
fn a_stretch_is_saved_beside_its_session_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "peg_transfer", 4.0, |_| None);
    let mut past = open(&path);
    until(&mut past, "shown", |past| past.live.is_some());
    past.stretch_s = [Some(0.0), Some(2.5)];
    for expected in ["Saved", "already"] {
        past.save(&Context::default());
        until(&mut past, "saved", |past| past.job.is_none());
        assert!(past.report.job.as_ref().is_some_and(|words| words.contains(expected)), "{:?}", past.report);
    }
    let saved = folder.path().join("session-0.0-2.5.mcap");
    assert!(folder.path().join("session-0.0-2.5.mcap.kept").exists());
    let outcome = replay(RecordedFile::open(&saved).unwrap().journal().unwrap(), |_| ()).unwrap();
    assert!(outcome.ticks >= 2200 && outcome.differs.is_none(), "{outcome:?}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "no half a file is left");
}

#[test]
fn a_window_that_is_closed_while_a_stretch_is_saved_leaves_no_half_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "bimanual", 20.0, |_| None);
    let mut past = open(&path);
    until(&mut past, "open", |past| past.about.is_some());
    past.stretch_s = [Some(0.0), Some(19.5)];
    past.save(&Context::default());
    let named = |ending: &str| {
        let names = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
        names.filter(|name| name.to_string_lossy().ends_with(ending)).count()
    };
    let began = Instant::now();
    while named(".part") == 0 && named(".mcap") == 1 && began.elapsed() < TIMEOUT {
        thread::yield_now();
    }
    drop(past);
    assert_eq!(named(".part"), 0, "{} sessions", named(".mcap"));
}

/// Prints the time until a random moment is on the screen, and until every value is replayed.
#[test]
#[ignore = "needs a long session: NIMA_SESSION=FILE"]
fn figures_of_scrubbing() {
    let path = std::env::var_os("NIMA_SESSION").unwrap();
    let mut past = open(Path::new(&path));
    let began = Instant::now();
    until(&mut past, "read", |past| past.read_share() > 0.999);
    let end_s = past.about.unwrap().end_s;
    eprintln!("{end_s:.0} s read in {:.1} s", began.elapsed().as_secs_f64());
    let [mut shown, mut whole] = [Vec::new(), Vec::new()];
    for turn in 0..200 {
        let began = Instant::now();
        past.show((f64::from(turn) * 0.618_034).fract() * end_s);
        past.live = None;
        past.extent = super::WorkerExtent::Plotted;
        until(&mut past, "shown", |past| past.live.is_some());
        shown.push(began.elapsed().as_secs_f64() * 1e3);
        if turn % 4 == 0 {
            until(&mut past, "replayed", Playback::is_whole);
            whole.push(began.elapsed().as_secs_f64() * 1e3);
        }
    }
    for (what, all) in [("shown", &mut shown), ("whole", &mut whole)] {
        all.sort_by(f64::total_cmp);
        let [median, late, worst] = [0.5, 0.95, 1.0].map(|fraction| all[((all.len() - 1) as f64 * fraction) as usize]);
        eprintln!("{what}: median {median:.1} ms, 95 % {late:.1} ms, worst {worst:.1} ms of {}", all.len());
    }
}
