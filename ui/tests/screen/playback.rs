//! Recorded sessions on the screen: the list, playback in every view, and that no control reaches the machine.

use std::{
    path::{Path, PathBuf},
    process::Command as Program,
    sync::{Arc, Mutex},
    thread,
    time::{Duration, Instant},
};

use egui::{Key, accesskit::Role as Kind};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::ConsoleApp;
use nima_core::task::TaskEvent;
use nima_machine::{
    config::SchedulingClass,
    messages::{Command, LoopState},
    rig::Side,
    runtime::{self, Assembly, Operation, RuntimeClock, TapEnd, TapItem, TapPayload, tap},
};
use nima_panels::roles::Role;
use nima_recording::{
    csv::{ColumnMapping, read_signals},
    session::SessionReader,
};
use nima_session::objects;
use nima_simulation::SimulationPlan;
use nima_tests::plan;

use crate::bench::{TIMEOUT, can_press, console_of, press, read, shows, toured, until, wait, write_into, write_over};

const SIZE: [f32; 2] = [1600.0, 1000.0];

pub(crate) fn record(path: &Path, scene: &str, seconds: &str) {
    let arguments = ["run", "--virtual", "--scene", scene, "--seconds", seconds, "--record"];
    let recorded = Program::new(env!("CARGO_BIN_EXE_nima")).args(arguments).arg(path).output().unwrap();
    assert!(recorded.status.success(), "{}", String::from_utf8_lossy(&recorded.stderr));
}

/// Steps the window until playback is fully replayed.
pub(crate) fn until_whole(harness: &mut Harness<'_, ConsoleApp>) {
    wait(harness, "the session is replayed", |harness| harness.state().past_ticks().is_some());
    harness.run_steps(3);
}

/// Returns the commands that reach a loop, from its tap.
pub(crate) fn watched(plan: &SimulationPlan) -> (runtime::LoopHandle, Arc<Mutex<Vec<Command>>>) {
    let (tap, end) = tap();
    let commands = Arc::<Mutex<Vec<Command>>>::default();
    let seen = Arc::clone(&commands);
    thread::spawn(move || watch(&end, &seen));
    let clock = RuntimeClock::Simulated { speed: 1.0 };
    let scheduling = SchedulingClass::Ordinary;
    let assembly = Assembly { clock, scheduling, tap: Some(tap), ..plan.simulated().unwrap() };
    (runtime::start(assembly).unwrap(), commands)
}

fn watch(end: &TapEnd, seen: &Mutex<Vec<Command>>) {
    loop {
        match end.next(Duration::from_millis(100)) {
            TapItem::Nothing => {}
            TapItem::End => return,
            TapItem::Entry(entry) => match entry.passed {
                TapPayload::Stepped(stepped) => end.give_back(stepped),
                TapPayload::Operation(Operation::Command { command, .. }) => seen.lock().unwrap().push(command),
                TapPayload::Operation(_) | TapPayload::Event(_) => {}
            },
        }
    }
}

/// Presses every enabled control, and drags the field and the traces; the keys of the views too.
fn do_everything(harness: &mut Harness<'_, ConsoleApp>) -> usize {
    let is_control = |kind: Kind| {
        matches!(
            kind,
            Kind::Button | Kind::CheckBox | Kind::RadioButton | Kind::Slider | Kind::SpinButton | Kind::Canvas
        )
    };
    let mut places: Vec<_> = harness
        .get_all_by(move |node| is_control(node.role()))
        .filter(|node| {
            let name = node.accesskit_node().label().unwrap_or_default();
            // Other tests press the controls that leave playback, stop, or open a window over the rest.
            !["Stop", "Return to live (L)", "Close", "View", "Report", "Save excerpt"].contains(&name.as_str())
        })
        .map(|node| node.rect().center())
        .collect();
    places.dedup();
    for place in &places {
        harness.drag_at(*place);
        harness.step();
        harness.drop_at(*place);
        harness.step();
    }
    for key in
        [Key::M, Key::PageUp, Key::ArrowLeft, Key::E, Key::A, Key::P, Key::P, Key::F6, Key::F7, Key::Enter, Key::Tab]
    {
        harness.key_press(key);
        harness.step();
    }
    places.len()
}

#[test]
fn nothing_in_the_past_reaches_the_machine_but_a_stop() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "bimanual", "6");
    let plan = plan("peg_transfer");
    let (handle, commands) = watched(&plan);
    let mut harness = Harness::builder().with_size(SIZE).with_step_dt(1.0 / 30.0).build_eframe(move |cc| {
        ConsoleApp::new(cc, handle, plan.rig, plan.scene).with_simulated_time(1.0).with_session(&path)
    });
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    until_whole(&mut harness);
    commands.lock().unwrap().clear();
    let mut pressed = 0;
    for role in Role::ALL {
        harness.state_mut().settings_mut().role = role;
        harness.run_steps(3);
        pressed += do_everything(&mut harness);
        assert!(harness.state().past().is_some(), "{role:?}");
    }
    assert!(pressed > 60, "{pressed} controls");
    harness.run_steps(10);
    assert_eq!(*commands.lock().unwrap(), []);
    until(&mut harness, "still engaged", |tick| tick.state == LoopState::Engaged);
    harness.key_press(Key::Space);
    harness.step();
    until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped);
    assert_eq!(*commands.lock().unwrap(), [Command::Stop]);
    harness.run_steps(30);
    let release = harness.get_by_role_and_label(Kind::Button, "Release stop");
    assert!(release.accesskit_node().is_disabled(), "not during playback");
    harness.key_press(Key::L);
    harness.step();
    assert!(harness.state().past().is_none());
    press(&mut harness, "Release stop");
    until(&mut harness, "idle", |tick| tick.state == LoopState::Idle);
}

#[test]
fn the_past_looks_like_the_past_and_one_key_leaves_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "peg_transfer", "5");
    let mut harness = console_of("peg_transfer", SIZE, move |app| app.with_session(&path));
    until_whole(&mut harness);
    for role in Role::ALL {
        harness.state_mut().settings_mut().role = role;
        harness.run_steps(3);
        assert!(
            harness.query_by_label("PLAYBACK").is_some() && harness.query_by_label("Time of the session").is_some()
        );
    }
    harness.state_mut().settings_mut().role = Role::Technician;
    harness.run_steps(3);
    assert!(shows(&harness, "Not during playback"), "the Feedback panel says why it is off");
    harness.state_mut().show_past(2.5);
    harness.step();
    until_whole(&mut harness);
    let (_, shown_s) = harness.state().past().unwrap();
    assert!((shown_s - 2.5).abs() < 1e-9, "{shown_s}");
    // A click in the middle of the time line shows the middle of the session.
    let line = harness.get_by_label("Time of the session").rect();
    harness.drag_at(line.center());
    harness.step();
    harness.drop_at(line.center());
    harness.step();
    until_whole(&mut harness);
    let (_, shown_s) = harness.state().past().unwrap();
    assert!((shown_s - 2.5).abs() < 0.01, "{shown_s}");
    harness.key_press(Key::L);
    harness.step();
    harness.run_steps(2);
    assert!(harness.query_by_label("PLAYBACK").is_none() && harness.state().past().is_none());
}

/// Returns the hover text of the time line at the place where it contains this text.
fn found_along_the_line(harness: &mut Harness<'_, ConsoleApp>, at: f64, words: &str) -> bool {
    let line = harness.get_by_label("Time of the session").rect();
    [0.0, -6.0, 6.0].into_iter().any(|aside| {
        harness.hover_at(line.left_center() + egui::vec2(line.width() * at as f32 + aside, 0.0));
        // A hover text appears when the pointer has been still for half a second.
        harness.run_steps(20);
        shows(harness, words)
    })
}

#[test]
fn rings_jaws_and_what_happened_to_them_are_on_the_screen_of_the_past() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let run = ["run", "--virtual", "--scene", "rings", "--mode", "matched", "--seconds", "9", "--record"];
    let recorded = Program::new(env!("CARGO_BIN_EXE_nima")).args(run).arg(&path).output().unwrap();
    assert!(recorded.status.success(), "{}", String::from_utf8_lossy(&recorded.stderr));
    let reader = SessionReader::open(&path).unwrap();
    let happened = objects::happenings(&reader, 0..u64::MAX).unwrap();
    let lifted_s = happened.iter().find(|one| matches!(one.event, TaskEvent::RingLifted { .. })).unwrap().t_s;
    let mut harness = console_of("free_motion", SIZE, move |app| app.with_session(&path));
    until_whole(&mut harness);
    let ring_m = |harness: &mut Harness<'_, ConsoleApp>, t_s: f64| {
        harness.state_mut().show_past(t_s);
        harness.step();
        until_whole(harness);
        let shown = harness.state().past_objects().unwrap();
        assert_eq!(shown.rings.iter().flatten().count(), 6, "at {t_s} s");
        let opening_rad = Side::ALL.map(|side| shown.jaws[side.index()].unwrap().opening_rad);
        (shown.rings[0].unwrap().translation.z, opening_rad[Side::Left.index()])
    };
    let (on_the_board_m, closed_rad) = ring_m(&mut harness, 0.1);
    let (lifted_m, holds_rad) = ring_m(&mut harness, lifted_s + 0.5);
    assert!(on_the_board_m < 0.005 && lifted_m > 0.02, "{on_the_board_m} m, {lifted_m} m");
    assert!(closed_rad < 0.05 && holds_rad > 0.05, "{closed_rad} rad, {holds_rad} rad");
    wait(&mut harness, "the session is read", |harness| !shows(harness, "% read"));
    assert!(found_along_the_line(&mut harness, lifted_s / 9.0, "ring 1 lifted off its peg by the left instrument"));
}

/// Steps the window until this session is in the list and its row no longer moves.
pub(crate) fn until_listed(harness: &mut Harness<'_, ConsoleApp>, name: &str) {
    let open = format!("Open {name}");
    wait(harness, &open, |harness| harness.query_by_role_and_label(Kind::Button, &open).is_some());
    harness.run_steps(4);
}

fn listed(folder: &Path) -> Harness<'static, ConsoleApp> {
    let folder = folder.to_path_buf();
    let mut harness = console_of("free_motion", SIZE, move |app| app.with_settings(toured(&folder)));
    until(&mut harness, "any tick", |_| true);
    harness.key_press(Key::F7);
    harness.step();
    harness
}

#[test]
fn sessions_are_listed_kept_deleted_and_opened() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = folder.path().join("sessions");
    std::fs::create_dir_all(&sessions).unwrap();
    let [one, other, bad]: [PathBuf; 3] = ["1.mcap", "2.mcap", "3.mcap"].map(|name| sessions.join(name));
    record(&one, "peg_transfer", "3");
    record(&other, "peg_transfer", "2");
    std::fs::write(&bad, "no session").unwrap();
    let mut harness = listed(folder.path());
    until_listed(&mut harness, "1.mcap");
    assert!(shows(&harness, "Six points on soft tissue") && shows(&harness, "Best of both"), "scene and mode");
    write_into(&mut harness, "Note of 1.mcap", "third try");
    harness.key_press(Key::Enter);
    harness.run_steps(2);
    assert_eq!(std::fs::read_to_string(sessions.join("1.mcap.note")).unwrap(), "third try");
    // The longest is first, and what cannot be read is last.
    press(&mut harness, "Sort by Length");
    let tops = ["1.mcap", "2.mcap", "3.mcap"]
        .map(|name| harness.get_by_role_and_label(Kind::Button, &format!("Open {name}")).rect().top());
    assert!(tops[0] < tops[1] && tops[1] < tops[2], "{tops:?}");
    write_into(&mut harness, "Search sessions", "THIRD six");
    assert!(harness.query_by_role_and_label(Kind::Button, "Open 2.mcap").is_none());
    write_over(&mut harness, "Search sessions", "nowhere");
    read(&mut harness, "No session matches the search");
    write_over(&mut harness, "Search sessions", " ");
    press(&mut harness, "Keep 1.mcap");
    press(&mut harness, "Kept 1.mcap");
    press(&mut harness, "Keep 1.mcap");
    press(&mut harness, "Delete 2.mcap");
    assert!(other.exists(), "one confirmation is requested");
    press(&mut harness, "Delete it? 2.mcap");
    // The rows below have moved up.
    wait(&mut harness, "it is not listed any more", |harness| {
        harness.query_by_role_and_label(Kind::Button, "Open 2.mcap").is_none()
    });
    harness.run_steps(4);
    press(&mut harness, "Report 1.mcap");
    let page = sessions.join("reports/1/report.html");
    wait(&mut harness, "a report", |_| page.exists());
    assert!(sessions.join("1.mcap.kept").exists() && !other.exists() && bad.exists());
    harness.run_steps(5);
    let delete = harness.get_by_role_and_label(Kind::Button, "Delete 1.mcap");
    assert!(delete.accesskit_node().is_disabled(), "a kept one is never deleted");
    let open = harness.get_by_role_and_label(Kind::Button, "Open 3.mcap");
    assert!(open.accesskit_node().is_disabled(), "what cannot be read is not opened");
    press(&mut harness, "Open 1.mcap");
    until_whole(&mut harness);
    assert_eq!(harness.state().past().unwrap().0, one);
}

#[test]
fn two_sessions_stand_side_by_side_on_one_clock() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = folder.path().join("sessions");
    std::fs::create_dir_all(&sessions).unwrap();
    let [one, other] = ["1.mcap", "2.mcap"].map(|name| sessions.join(name));
    record(&one, "bimanual", "5");
    record(&other, "peg_transfer", "3");
    let mut harness = listed(folder.path());
    until_listed(&mut harness, "1.mcap");
    press(&mut harness, "Open 1.mcap");
    until_whole(&mut harness);
    press(&mut harness, "Compare");
    until_listed(&mut harness, "2.mcap");
    press(&mut harness, "Open 2.mcap");
    let shown = |harness: &mut Harness<'_, ConsoleApp>, t_s: f64, expected_s: [f64; 2]| {
        harness.state_mut().show_past(t_s);
        let began = Instant::now();
        loop {
            harness.step();
            let both = [harness.state().past(), harness.state().past_beside()].map(|one| one.map_or(-1.0, |one| one.1));
            if both.iter().zip(expected_s).all(|(now_s, expected_s)| (now_s - expected_s).abs() < 1.5e-3) {
                return;
            }
            assert!(began.elapsed() < TIMEOUT, "{both:?} at {t_s} s");
            thread::sleep(Duration::from_millis(5));
        }
    };
    shown(&mut harness, 2.0, [2.0, 2.0]);
    // The shorter one stays at its last tick.
    shown(&mut harness, 4.0, [4.0, 2.999]);
    assert_eq!(harness.state().past_beside().unwrap().0, other);
    for size in [[1100.0, 680.0], SIZE] {
        harness.set_size(size.into());
        harness.run_steps(4);
        assert_eq!(harness.query_all_by_label("Operating field").count(), 2);
    }
    press(&mut harness, "Compare");
    assert!(harness.state().past_beside().is_none() && harness.state().past().is_some());
}

#[test]
fn another_programs_recording_shows_what_it_has_and_offers_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("forces.csv");
    let rows = (0..500).map(|number| format!("{},0.5,-1.25\n", f64::from(number) * 0.01));
    std::fs::write(&path, std::iter::once("t_s,fx_n,fz_n\n".to_owned()).chain(rows).collect::<String>()).unwrap();
    let signals = Arc::new(read_signals(&path, &ColumnMapping::default()).unwrap());
    let mut harness = console_of("peg_transfer", [1280.0, 720.0], move |app| app.with_signals(&path, &signals));
    read(&mut harness, "Force: x, z. Position: unknown. Everything else is unknown.");
    read(&mut harness, "x 0.50 N   y \u{2013}   z -1.25 N");
    assert!(shows(&harness, "x \u{2013}   y \u{2013}   z \u{2013}"), "no position is shown as zero");
    assert!(!can_press(&harness, "Report") && !can_press(&harness, "From"));
    assert_eq!(harness.query_all_by_label("Operating field").count(), 0, "its scene is not known");
    press(&mut harness, "Signals");
    assert!(shows(&harness, "Force along x") && !shows(&harness, "Force along y") && !shows(&harness, "Gates: gain"));
}
