//! Commands for the machine: stop, release, engage, alarms, mouse control.

use eframe::App as _;
use egui::{Key, accesskit::Role as Kind};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::{ConsoleApp, commands::Action};
use nima_core::impedance::Mode;
use nima_machine::{config::RigConfig, messages::LoopState, rig::Side};
use nima_simulation::{SimulationPlan, start_watched};
use nima_tests::plan;

use super::{FIELD, SIZE, alike, begin, by_key, choose, close, entry, expect, is_open, open, rows};
use crate::bench::{Console, console_of, press, read, shown, shows, until, wait, write_into};

#[test]
fn stop_release_engage_and_the_traces() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    let mut done = Vec::new();
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    done.push(alike(
        &mut console,
        Action::Pause,
        |console| {
            if shows(console, "Resume") {
                press(console, "Resume");
            }
        },
        |console| press(console, "Pause"),
        |console| format!("{}", shows(console, "Resume")),
    ));
    let traces = |console: &mut Console| format!("{:?}", console.state().traces_s());
    let zoom = |console: &mut Console| console.state_mut().show_traces(30.0);
    done.push(alike(&mut console, Action::LastTenSeconds, zoom, |console| press(console, "Last 10 s"), traces));

    choose(&mut console, Action::Stop);
    until(&mut console, "stopped", |tick| tick.state == LoopState::Stopped);
    let greyed = rows(&mut console);
    assert!(greyed.contains(&("Engage".to_owned(), false)), "not before the stop is released: {greyed:?}");
    for (action, state) in [(Action::Release, LoopState::Idle), (Action::Engage, LoopState::Engaged)] {
        // Button and command become available a moment after every change of state.
        console.run_steps(30);
        open(&mut console);
        write_into(&mut console, FIELD, &entry(action).title);
        console.key_press(Key::Enter);
        console.run_steps(30);
        assert!(is_open(&console) && shows(&console, "Press Enter or click again"), "{action:?}");
        assert_ne!(console.state().tick().unwrap().state, state, "one Enter does nothing");
        close(&mut console);
        choose(&mut console, action);
        until(&mut console, "the next step", |tick| tick.state == state);
        done.push(action);
    }
    done.push(Action::Stop);
    expect(&done, "stop and traces");
}

#[test]
fn an_alarm_is_acknowledged() {
    let mut console = console_of("free_motion", SIZE, |app| app);
    until(&mut console, "any tick", |_| true);
    console.state_mut().on_exit(None);
    read(&mut console, "The control loop has stopped sending data");
    choose(&mut console, Action::Acknowledge);
    let button = console.get_by_role_and_label(Kind::Button, "Acknowledge (A)");
    assert!(button.accesskit_node().is_disabled());
    let rows = rows(&mut console);
    assert!(rows.contains(&(entry(Action::Acknowledge).title.clone(), false)), "{rows:?}");
}

#[test]
fn the_instrument_is_driven_from_the_palette_too() {
    let mut plan = plan("rings");
    plan.rig.mode = Mode::Matched;
    let mut console = shown(&SimulationPlan { engage: true, ..plan }, SIZE, |app| app);
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    let led = |tick: &nima_machine::messages::Tick| tick.guidance.guide_m.is_some();
    let greyed = rows(&mut console);
    assert!(greyed.contains(&(entry(Action::Jaws).title.clone(), false)), "not before it is driven: {greyed:?}");
    choose(&mut console, Action::Drive);
    until(&mut console, "led", led);
    by_key(&mut console, Action::Drive);
    until(&mut console, "let go", |tick| !led(tick));
    by_key(&mut console, Action::Drive);
    until(&mut console, "led by key", led);
    read(&mut console, "Right instrument");
    choose(&mut console, Action::OtherHand);
    read(&mut console, "Left instrument");
    by_key(&mut console, Action::OtherHand);
    read(&mut console, "Right instrument");
    let is_open = |console: &Harness<'_, ConsoleApp>| {
        let jaws = console.state().objects().and_then(|objects| objects.jaws[Side::Right.index()]);
        jaws.is_some_and(|jaws| jaws.opening_rad > 0.4)
    };
    for by_palette in [true, false] {
        let before = is_open(&console);
        if by_palette {
            choose(&mut console, Action::Jaws);
        } else {
            by_key(&mut console, Action::Jaws);
        }
        wait(&mut console, "the jaws", |console| is_open(console) != before);
    }
}

/// The loop is simulated, so that no emulator is needed: only the console's rig has devices.
#[test]
fn a_hand_that_the_mouse_cannot_move_is_not_offered() {
    let plan = plan("peg_transfer");
    let (handle, _) = start_watched(&plan, 1.0).unwrap();
    let rig = RigConfig { endoscope: None, ..RigConfig::load("emulated").unwrap() };
    let scene = plan.scene;
    let mut console = Harness::builder()
        .with_size(SIZE)
        .with_step_dt(1.0 / 30.0)
        .build_eframe(move |cc| ConsoleApp::new(cc, handle, rig, scene).with_simulated_time(1.0));
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    assert!(!shows(&console, "Drive by mouse"));
    let greyed = rows(&mut console);
    assert!(greyed.contains(&(entry(Action::Drive).title.clone(), false)), "{greyed:?}");
    by_key(&mut console, Action::Drive);
    assert!(console.state().tick().unwrap().guidance.guide_m.is_none());
}

#[test]
fn a_palpation_is_done_from_the_palette_too() {
    let mut console = console_of("find_lumps", SIZE, |app| app);
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    choose(&mut console, Action::Drive);
    read(&mut console, "Places marked: 0 (X marks");
    choose(&mut console, Action::MarkPlace);
    read(&mut console, "Places marked: 1");
    by_key(&mut console, Action::MarkPlace);
    read(&mut console, "Places marked: 2");
    choose(&mut console, Action::BeginTrial);
    read(&mut console, "Places marked: 0");
    choose(&mut console, Action::MarkPlace);
    read(&mut console, "Places marked: 1");
    choose(&mut console, Action::EndTrial);
    read(&mut console, "of 5, false marks: ");
}
