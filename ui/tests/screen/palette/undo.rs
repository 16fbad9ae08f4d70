//! Changes that can be undone, and those that cannot.

use egui::accesskit::Role as Kind;
use egui_kittest::kittest::Queryable as _;
use nima_console::console::{ConsoleApp, commands::Action};
use nima_machine::messages::LoopState;
use nima_panels::tiles::PanelId;
use nima_screen::scene3d::extras::MenuSwitch;
use nima_tests::plan;

use super::{SIZE, begin, by_key, choose, rows};
use crate::{
    bench::{Console, press, until, wait},
    playback,
};

/// An action of a person.
type Does<'a> = &'a dyn Fn(&mut Console);

/// Commands for the machine are never undone.
#[test]
fn nothing_that_went_to_the_machine_is_undone() {
    let plan = plan("peg_transfer");
    let (handle, commands) = playback::watched(&plan);
    let mut console =
        egui_kittest::Harness::builder().with_size(SIZE).with_step_dt(1.0 / 30.0).build_eframe(move |cc| {
            let mut console = ConsoleApp::new(cc, handle, plan.rig, plan.scene).with_simulated_time(1.0);
            // The panel sends its own command, which makes the loop compute all modes.
            console.settings_mut().layout.toggle(PanelId::Degrees);
            console
        });
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    choose(&mut console, Action::Light(true));
    let slide = |console: &mut Console, label: &str, value: f64| {
        console.get_by_role_and_label(Kind::Slider, label).set_value_accesskit(value);
        console.run_steps(2);
    };
    let acts: [(&str, Does<'_>); 9] = [
        ("a mode", &|console| press(console, "Direct (DFR)")),
        ("a gain", &|console| slide(console, "Gain", 0.4)),
        ("a delay", &|console| slide(console, "Link delay", 200.0)),
        ("a dead band", &|console| slide(console, "Dead band", 5.0)),
        ("a force at standstill", &|console| {
            console.get_by_role_and_label(Kind::CheckBox, "Keep force at standstill").click();
        }),
        ("comparing", &|console| console.get_by_role_and_label(Kind::CheckBox, "Compare all modes").click()),
        ("a stop", &|console| press(console, "Stop")),
        ("its release", &|console| press(console, "Release stop")),
        ("engaging", &|console| press(console, "Engage")),
    ];
    for (name, act) in acts {
        act(&mut console);
        wait(&mut console, name, |_| !commands.lock().unwrap().is_empty());
        // Wait until it is active.
        std::thread::sleep(std::time::Duration::from_millis(200));
        console.run_steps(10);
        commands.lock().unwrap().clear();
        for action in [Action::Undo, Action::Undo, Action::Redo, Action::Redo, Action::Undo] {
            by_key(&mut console, action);
        }
        std::thread::sleep(std::time::Duration::from_millis(200));
        console.run_steps(10);
        assert_eq!(*commands.lock().unwrap(), [], "{name} was undone");
        by_key(&mut console, Action::Redo);
        assert!(console.state_mut().settings_mut().light, "what belongs to the screen is still undone and redone");
    }
}

#[test]
fn panels_and_plots_are_put_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    let state = |console: &mut Console| {
        let extras = console.state().extras();
        let traces = console.state().traces_s();
        let settings = console.state_mut().settings_mut();
        (settings.layout.closed.clone(), settings.light, settings.scale_percent, extras, traces)
    };
    let mut states = vec![state(&mut console)];
    let steps: [Does<'_>; 5] = [
        &|console| press(console, "Close Traces"),
        &|console| press(console, "Close Force space"),
        &|console| choose(console, Action::Light(true)),
        &|console| choose(console, Action::Draws(MenuSwitch::Ceiling)),
        &|console| choose(console, Action::Larger),
    ];
    for step in steps {
        step(&mut console);
        console.run_steps(3);
        states.push(state(&mut console));
    }
    for before in states.iter().rev().skip(1) {
        by_key(&mut console, Action::Undo);
        assert_eq!(state(&mut console), *before);
    }
    let nothing = rows(&mut console);
    assert!(nothing.contains(&("Undo".to_owned(), false)), "{nothing:?}");
    for after in &states[1..] {
        by_key(&mut console, Action::Redo);
        assert_eq!(state(&mut console), *after);
    }
    choose(&mut console, Action::Light(false));
    let none = rows(&mut console);
    assert!(none.contains(&("Redo".to_owned(), false)), "a new change ends what can be made again: {none:?}");
}
