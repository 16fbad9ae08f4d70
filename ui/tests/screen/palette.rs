//! The palette: every command of the table is reached by its name and does what its key, its menu or its button does; who sits before the
//! screen finds what can be reached from there, and nothing leads to force by one Enter.

use std::path::Path;

use eframe::App as _;
use egui::{Key, Modifiers, accesskit::Role as Kind};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nima_console::{
    console::{
        ConsoleApp, Options,
        commands::{Action, Entry, SIZES_PERCENT, table},
        desk::{Layout, Panel},
        roles::Role,
        scene3d::extras::{Extras, SHOW, Switch},
        settings::{Kept, PictureSettings, Settings},
        wizards::Which,
    },
    language::Language,
};
use nima_core::impedance::Mode;
use nima_machine::{
    config::{Endoscope, StereoView},
    messages::LoopState,
    rig::Side,
};
use nima_testing::real_time::{alone, judged};
use nima_tests::plan;
use nima_world::Plan;

use crate::{
    bench::{Console, TIMEOUT, comes, console_of, pick, press, read, shown, shows, texts, until, wait, write_into},
    eyes, past, studies,
};

const SIZE: [f32; 2] = [1600.0, 1000.0];
const FIELD: &str = "Find a command";

fn entry(action: Action) -> &'static Entry {
    table().iter().find(|entry| entry.action == action).unwrap()
}

fn is_open(console: &Console) -> bool {
    console.query_by_role_and_label(Kind::TextInput, FIELD).is_some()
}

fn open(console: &mut Console) {
    console.key_press_modifiers(Modifiers::COMMAND, Key::P);
    console.run_steps(3);
    assert!(is_open(console), "there is: {:?}", texts(console));
}

fn close(console: &mut Console) {
    console.key_press_modifiers(Modifiers::COMMAND, Key::P);
    console.run_steps(2);
    assert!(!is_open(console));
}

/// Names of the rows, and whether each can be chosen.
fn rows(console: &mut Console) -> Vec<(String, bool)> {
    open(console);
    let rows = console.query_all_by_role(Kind::MenuItem).map(|row| row.accesskit_node());
    let rows = rows.map(|row| (row.label().unwrap_or_default(), !row.is_disabled())).collect();
    close(console);
    rows
}

/// Types the name of the command and Enter, twice where it is asked once more.
fn choose(console: &mut Console, action: Action) {
    open(console);
    let title = &entry(action).title;
    write_into(console, FIELD, title);
    let row = console.get_by_role_and_label(Kind::MenuItem, title);
    assert!(!row.accesskit_node().is_disabled(), "{title} is greyed");
    console.key_press(Key::Enter);
    console.run_steps(2);
    if action.leads_to_force() {
        assert!(is_open(console), "{title} is asked once more");
        console.key_press(Key::Enter);
        console.run_steps(2);
    }
    console.run_steps(2);
    assert!(!is_open(console), "{title}");
}

/// Presses its first key.
fn by_key(console: &mut Console, action: Action) {
    let stroke = entry(action).keys[0];
    console.key_press_modifiers(stroke.with.modifiers(), stroke.key);
    console.run_steps(4);
}

/// From the same state, the palette leads where the key or the button leads.
fn alike(
    console: &mut Console,
    action: Action,
    reset: impl Fn(&mut Console),
    other: impl Fn(&mut Console),
    seen: impl Fn(&mut Console) -> String,
) -> Action {
    let again = |console: &mut Console| {
        reset(console);
        console.run_steps(3);
        seen(console)
    };
    let before = again(console);
    other(console);
    let by_other = seen(console);
    assert_ne!(before, by_other, "{action:?} changes nothing");
    assert_eq!(before, again(console), "{action:?}");
    choose(console, action);
    assert_eq!(by_other, seen(console), "{action:?}");
    again(console);
    action
}

fn begin(folder: &Path, scene: &str) -> Console {
    let folder = folder.to_path_buf();
    let mut console = console_of(scene, SIZE, move |app| {
        let mut kept = Kept::open(&folder);
        kept.now.toured = true;
        app.with_settings(kept).with_store(&folder.join("calibrations"))
    });
    until(&mut console, "any tick", |_| true);
    console.run_steps(3);
    console
}

/// The settings at the beginning, with this changed.
fn set(change: impl Fn(&mut Settings)) -> impl Fn(&mut Console) {
    move |console| {
        let settings = console.state_mut().settings_mut();
        *settings = Settings { toured: true, recent: settings.recent.clone(), ..Settings::default() };
        change(settings);
    }
}

fn settings(console: &mut Console) -> String {
    format!("{:?}", console.state_mut().settings_mut())
}

/// A button or switch of the View menu.
fn of_menu(kind: Kind, label: &str) -> impl Fn(&mut Console) {
    move |console| {
        press(console, "View");
        console.get_by_role_and_label(kind, label).click_accesskit();
        console.run_steps(3);
        for (words, menu) in [("Text and control size", "View"), ("Gr\u{f6}\u{df}e von Text und", "Ansicht")] {
            if shows(console, words) {
                press(console, menu);
                console.run_steps(2);
            }
        }
    }
}

#[test]
fn what_the_view_menu_and_the_keys_of_the_screen_do() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    let mut done = Vec::new();
    for action in Role::ALL.map(Action::View) {
        let from = if action == Action::View(Role::Demo) { Role::Surgeon } else { Role::Demo };
        let from = if action == Action::View(Role::Surgeon) { Role::Technician } else { from };
        done.push(alike(&mut console, action, set(|settings| settings.role = from), |c| by_key(c, action), settings));
    }
    for light in [false, true] {
        let name = if light { "Light" } else { "Dark" };
        let reset = set(|settings| settings.light = !light);
        done.push(alike(&mut console, Action::Light(light), reset, of_menu(Kind::Button, name), settings));
    }
    // The way back is tried where German labels are known.
    let german = Action::Language(Language::German);
    let reset = set(|settings| settings.language = Language::English);
    done.push(alike(&mut console, german, reset, of_menu(Kind::Button, Language::German.name()), settings));
    for action in [Action::Larger, Action::Smaller] {
        let reset = set(|settings| settings.scale_percent = 150);
        done.push(alike(&mut console, action, reset, |c| by_key(c, action), settings));
    }
    for percent in SIZES_PERCENT {
        let reset = set(|settings| settings.scale_percent = if percent == 100 { 125 } else { 100 });
        let name = format!("{percent} %");
        let other = of_menu(Kind::Button, &name);
        done.push(alike(&mut console, Action::Size(percent), reset, other, settings));
    }
    for panel in Panel::ALL {
        let reset = set(|settings| settings.layout.toggle(panel));
        let other = of_menu(Kind::Button, panel.title());
        let seen = |console: &mut Console| format!("{:?}", console.state_mut().settings_mut().layout.closed);
        done.push(alike(&mut console, Action::Panel(panel), reset, other, seen));
    }
    let reset = set(|settings| settings.layout = Layout { closed: vec![Panel::Link], ..Layout::default() });
    done.push(alike(&mut console, Action::ResetLayout, reset, of_menu(Kind::Button, "Reset the layout"), settings));
    for action in [Action::Sound, Action::ForcesOfNow, Action::RecordsPicture] {
        done.push(alike(&mut console, action, set(|_| {}), of_menu(Kind::CheckBox, &entry(action).title), settings));
    }
    let reset = set(|settings| {
        settings.picture =
            PictureSettings { brightness_percent: 20, forces_of_now: true, ..PictureSettings::default() };
    });
    let plain = &entry(Action::PlainPicture).title;
    done.push(alike(&mut console, Action::PlainPicture, reset, of_menu(Kind::Button, plain), settings));
    set(|_| {})(&mut console);
    console.run_steps(3);
    for switch in Switch::ALL {
        let other = |console: &mut Console| {
            press(console, SHOW.get());
            console.get_by_role_and_label(Kind::CheckBox, switch.name()).click_accesskit();
            console.run_steps(2);
            press(console, SHOW.get());
        };
        // It is switched twice to be as before.
        let extras = |console: &mut Console| format!("{:?}", console.state().extras());
        let before = console.state().extras();
        let reset = move |console: &mut Console| {
            if console.state().extras() != before {
                other(console);
            }
        };
        done.push(alike(&mut console, Action::Draws(switch), reset, other, extras));
    }
    assert_eq!(console.state().extras(), Extras::default());
    expect(&done, |action| {
        matches!(
            action,
            Action::View(_)
                | Action::Light(_)
                | Action::Language(Language::German)
                | Action::Larger
                | Action::Smaller
                | Action::Size(_)
                | Action::Panel(_)
                | Action::ResetLayout
                | Action::Sound
                | Action::ForcesOfNow
                | Action::RecordsPicture
                | Action::PlainPicture
                | Action::Draws(_)
        )
    });
}

/// What is on the screen, by something that stands only there.
fn pages(console: &mut Console) -> String {
    let marks = ["1. Choose a rig", "Back to the view", "New study", "The last 50 alarms", "Terms"];
    let marks = marks.iter().chain(&["Three views of one loop"]);
    marks.filter(|mark| shows(console, mark)).copied().collect::<Vec<_>>().join(", ")
}

#[test]
fn what_the_top_bar_opens_and_what_is_undone() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    let mut done = Vec::new();
    let close_all = |console: &mut Console| {
        for (mark, key) in [("The last 50 alarms", Key::F5), ("Terms", Key::F4)] {
            if shows(console, mark) {
                console.key_press(key);
                console.run_steps(2);
            }
        }
        if shows(console, "Three views of one loop") {
            pick(console, "Skip the tour");
        }
        // The key of a view closes the pages.
        console.key_press(Key::F2);
        console.run_steps(2);
    };
    for action in [Action::Glossary, Action::Alarms, Action::Rig, Action::Sessions, Action::Studies] {
        done.push(alike(&mut console, action, close_all, |console| by_key(console, action), pages));
    }
    done.push(alike(&mut console, Action::Rig, close_all, |console| press(console, "Rig"), pages));
    done.push(alike(&mut console, Action::Sessions, close_all, |console| press(console, "Sessions"), pages));
    done.push(alike(&mut console, Action::Tour, close_all, of_menu(Kind::Button, "Tour"), pages));

    let light = |console: &mut Console| console.state_mut().settings_mut().light;
    for others in [false, true] {
        choose(&mut console, Action::Light(true));
        for (action, is_light) in [(Action::Undo, false), (Action::Redo, true), (Action::Undo, false)] {
            if others {
                by_key(&mut console, action);
            } else {
                choose(&mut console, action);
            }
            assert_eq!(light(&mut console), is_light, "{action:?}");
        }
    }
    done.extend([Action::Undo, Action::Redo]);

    for others in [false, true] {
        let marks = console.state().marks_s().count();
        if others {
            by_key(&mut console, Action::Mark);
        } else {
            choose(&mut console, Action::Mark);
        }
        assert_eq!(console.state().marks_s().count(), marks + 1);
    }
    done.push(Action::Mark);
    let rows = rows(&mut console);
    assert!(rows.contains(&(entry(Action::Keep).title.clone(), false)), "nothing is recorded here: {rows:?}");
    expect(&done, |action| {
        use Action::{Alarms, Glossary, Mark, Redo, Rig, Sessions, Studies, Tour, Undo};
        [Glossary, Alarms, Rig, Sessions, Studies, Tour, Undo, Redo, Mark].contains(&action)
    });
}

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
            if shows(console, "Go on") {
                press(console, "Go on");
            }
        },
        |console| press(console, "Pause"),
        |console| format!("{}", shows(console, "Go on")),
    ));
    let traces = |console: &mut Console| format!("{:?}", console.state().traces_s());
    let zoom = |console: &mut Console| console.state_mut().show_traces(30.0);
    done.push(alike(&mut console, Action::LastTenSeconds, zoom, |console| press(console, "Last 10 s"), traces));

    choose(&mut console, Action::Stop);
    until(&mut console, "stopped", |tick| tick.state == LoopState::Stopped);
    let greyed = rows(&mut console);
    assert!(greyed.contains(&("Engage".to_owned(), false)), "not before the stop is released: {greyed:?}");
    for (action, state) in [(Action::Release, LoopState::Idle), (Action::Engage, LoopState::Engaged)] {
        // The button waits a moment after every change of state, and so does the command.
        console.run_steps(30);
        open(&mut console);
        write_into(&mut console, FIELD, &entry(action).title);
        console.key_press(Key::Enter);
        console.run_steps(30);
        assert!(is_open(&console) && shows(&console, "Press Enter once more"), "{action:?}");
        assert_ne!(console.state().tick().unwrap().state, state, "one Enter does nothing");
        close(&mut console);
        choose(&mut console, action);
        until(&mut console, "the next step", |tick| tick.state == state);
        done.push(action);
    }
    done.push(Action::Stop);
    expect(&done, |action| {
        use Action::{Engage, LastTenSeconds, Pause, Release, Stop};
        [Stop, Release, Engage, Pause, LastTenSeconds].contains(&action)
    });
}

#[test]
fn escape_stops_while_the_palette_is_open_and_closes_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    open(&mut console);
    console.key_press(Key::Escape);
    console.run_steps(2);
    until(&mut console, "stopped", |tick| tick.state == LoopState::Stopped);
    assert!(!is_open(&console));
    open(&mut console);
    press(&mut console, "Rig");
    assert!(!is_open(&console), "a click elsewhere closes it and does what it does");
    assert!(shows(&console, "1. Choose a rig"));
}

#[test]
fn arrows_choose_among_what_can_be_done_and_a_press_takes_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    open(&mut console);
    write_into(&mut console, FIELD, "view");
    console.key_press(Key::ArrowDown);
    console.run_steps(2);
    console.key_press(Key::ArrowDown);
    console.key_press(Key::Enter);
    console.run_steps(3);
    assert_eq!(console.state().role(), Role::Demo, "surgeon, technician, demo");
    open(&mut console);
    console.get_by_role_and_label(Kind::MenuItem, "View: Surgeon").click();
    console.run_steps(3);
    assert_eq!((console.state().role(), is_open(&console)), (Role::Surgeon, false));
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

/// Which wizards cannot be opened, because one is open.
fn open_pages(console: &mut Console) -> String {
    let all = console.query_all_by_role(Kind::Button).map(|button| button.accesskit_node());
    let ours = all.filter(|button| button.is_disabled() && button.label().unwrap_or_default().ends_with('…'));
    ours.filter_map(|button| button.label()).collect::<Vec<_>>().join(", ")
}

fn back(console: &mut Console) {
    if shows(console, "Back to the monitor") {
        pick(console, "Back to the monitor");
        console.run_steps(3);
    }
}

#[test]
fn every_wizard_is_opened_and_left() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    let mut done = Vec::new();
    let simulated = Which::ALL.into_iter().filter(|which| which.scene().is_some()).map(Action::Calibrate);
    for action in [Action::Calibrations, Action::Check].into_iter().chain(simulated) {
        let title = &entry(action).title;
        done.push(alike(&mut console, action, back, |console| pick(console, title), open_pages));
    }
    pick(&mut console, "Ready check…");
    choose(&mut console, Action::CloseWizard);
    assert!(!shows(&console, "Back to the monitor"));
    done.push(Action::CloseWizard);
    let offered = rows(&mut console);
    assert!(offered.iter().all(|(title, _)| *title != entry(Action::Calibrate(Which::Camera)).title), "no endoscope");
    expect(&done, |action| match action {
        Action::Calibrate(which) => which.scene().is_some(),
        action => matches!(action, Action::Check | Action::Calibrations | Action::CloseWizard),
    });
}

#[cfg(target_os = "linux")]
#[test]
fn every_wizard_of_a_rig_with_arms_is_opened() {
    // Its devices are emulated in real time: beside other work one of them may be lost, and no wizard is open to a fault.
    judged(|| {
        let _alone = alone();
        let folder = tempfile::tempdir().unwrap();
        let (mut console, _emulators, _) = crate::wizard_frames::console(folder.path());
        let idle = |console: &mut Console| {
            back(console);
            until(console, "idle", |tick| tick.state == LoopState::Idle);
        };
        idle(&mut console);
        for which in Which::ALL.into_iter().filter(|which| matches!(which, Which::Frame(_))) {
            let action = Action::Calibrate(which);
            let title = &entry(action).title;
            alike(&mut console, action, idle, |console| pick(console, title), open_pages);
        }
    });
}

#[test]
fn the_endoscope_has_its_commands_where_its_picture_is() {
    let (_serving, endoscope) = eyes::lenses(Some(0.004));
    let endoscope = Endoscope { view: Some(StereoView::Left), baseline_m: Some(0.004), ..endoscope };
    let mut console = eyes::surgeon(endoscope, [1280.0, 720.0]);
    eyes::told(&mut console, "Endoscope's picture: live");
    let is = |console: &mut Console, words: &str| {
        assert!(comes(console, TIMEOUT, |console| eyes::is_painted(console, words)), "never painted: {words}");
    };
    is(&mut console, "Left half");
    choose(&mut console, Action::Lens);
    is(&mut console, "Right half");
    by_key(&mut console, Action::Lens);
    is(&mut console, "Both halves");
    is(&mut console, "O hides them");
    choose(&mut console, Action::HideForces);
    is(&mut console, "O draws the forces at the tips");
    by_key(&mut console, Action::HideForces);
    is(&mut console, "O hides them");
    console.key_press(Key::F2);
    console.run_steps(3);
    let camera = Action::Calibrate(Which::Camera);
    let title = &entry(camera).title;
    let opened = |console: &mut Console| {
        pick(console, "Calibration");
        pick(console, title);
    };
    alike(&mut console, camera, back, opened, open_pages);
    let rows = rows(&mut console);
    assert!(rows.iter().all(|(title, _)| *title != entry(Action::Lens).title), "the technician has no picture");
}

#[test]
fn the_instrument_is_driven_from_the_palette_too() {
    let mut plan = plan("rings");
    plan.rig.mode = Mode::Matched;
    let mut console = shown(&Plan { engage: true, ..plan }, SIZE, |app| app);
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    let led = |tick: &nima_machine::messages::Tick| tick.guide_m.is_some();
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
    let is_open = |console: &egui_kittest::Harness<'_, ConsoleApp>| {
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

#[test]
fn the_past_is_played_and_left() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    past::record(&path, "peg_transfer", "6");
    let mut console = console_of("peg_transfer", SIZE, move |app| app.with_session(&path));
    past::until_whole(&mut console);
    let shown_ms = |console: &mut Console| console.state().past().map(|(_, t_s)| (t_s * 1e3).round() as i64);
    let at_three = |console: &mut Console| {
        console.state_mut().show_past(3.0);
        console.step();
        past::until_whole(console);
    };
    for ms in [-1000, 1000, -10, 10] {
        for by_palette in [true, false] {
            at_three(&mut console);
            let action = Action::Step(ms);
            if by_palette {
                choose(&mut console, action);
            } else {
                by_key(&mut console, action);
            }
            past::until_whole(&mut console);
            assert_eq!(shown_ms(&mut console), Some(3000 + i64::from(ms)), "{action:?} {by_palette}");
        }
    }
    at_three(&mut console);
    choose(&mut console, Action::Play);
    wait(&mut console, "it plays", |console| shows(console, "Pause") && console.state().past().unwrap().1 > 3.05);
    by_key(&mut console, Action::Play);
    let greyed = rows(&mut console);
    for blocked in [Action::Mark, Action::Rig, Action::Sessions, Action::Check] {
        assert!(greyed.contains(&(entry(blocked).title.clone(), false)), "{blocked:?}: {greyed:?}");
    }
    choose(&mut console, Action::LeavePast);
    assert!(console.state().past().is_none());
}

/// The commands of this test are all of their kind in the table.
fn expect(done: &[Action], kind: impl Fn(Action) -> bool) {
    let missing: Vec<&str> = table()
        .iter()
        .filter(|entry| kind(entry.action) && !done.contains(&entry.action))
        .map(|entry| entry.title.as_str())
        .collect();
    assert!(missing.is_empty(), "not tried: {missing:?}");
}

/// A command that is added to the table is added to one of the tests above, or this does not compile.
#[test]
fn every_command_of_the_table_is_tried() {
    let tried_in = |action: Action| match action {
        Action::View(_)
        | Action::Light(_)
        | Action::Language(_)
        | Action::Larger
        | Action::Smaller
        | Action::Size(_)
        | Action::Panel(_)
        | Action::ResetLayout
        | Action::Sound
        | Action::ForcesOfNow
        | Action::RecordsPicture
        | Action::PlainPicture
        | Action::Draws(_) => "the View menu",
        Action::Glossary
        | Action::Alarms
        | Action::Rig
        | Action::Sessions
        | Action::Studies
        | Action::Tour
        | Action::Undo
        | Action::Redo
        | Action::Mark => "the top bar",
        Action::Stop | Action::Release | Action::Engage | Action::Pause | Action::LastTenSeconds => "stop and traces",
        Action::Acknowledge => "an alarm",
        Action::Check | Action::Calibrations | Action::Calibrate(_) | Action::CloseWizard => "the wizards",
        Action::HideForces | Action::Lens => "the endoscope",
        Action::Drive | Action::OtherHand | Action::Jaws => "driving",
        Action::MarkPlace | Action::EndTrial | Action::BeginTrial => "palpation",
        Action::LeavePast | Action::Play | Action::Step(_) => "the past",
        // It opens the palette, in every test.
        Action::Palette => "all",
        // Needs a session that is being recorded: beside the code that keeps one.
        Action::Keep => "the console itself",
    };
    assert!(table().len() > 60 && table().iter().all(|entry| !tried_in(entry.action).is_empty()));
}

fn titles(console: &mut Console) -> Vec<String> {
    rows(console).into_iter().map(|(title, _)| title).collect()
}

#[test]
fn every_role_finds_what_it_can_reach_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    let of_role = |console: &mut Console, role: Role| {
        console.state_mut().settings_mut().role = role;
        console.run_steps(3);
        titles(console)
    };
    let of_technician = |entry: &Entry| {
        matches!(entry.action, Action::Panel(_) | Action::ResetLayout | Action::Check | Action::Calibrations)
            || matches!(entry.action, Action::Calibrate(which) if which.scene().is_some())
    };
    let with_traces = |entry: &Entry| {
        matches!(entry.action, Action::Pause | Action::LastTenSeconds | Action::Draws(_) | Action::Drive)
    };
    // In this scene, with one hand, without an endoscope, live.
    let nowhere = |entry: &Entry| {
        use Action::{
            BeginTrial, CloseWizard, EndTrial, HideForces, Jaws, LeavePast, Lens, MarkPlace, OtherHand, Palette, Play,
        };
        match entry.action {
            Action::Calibrate(which) => which.scene().is_none(),
            Action::Step(_)
            | LeavePast
            | Play
            | Palette
            | CloseWizard
            | OtherHand
            | Jaws
            | MarkPlace
            | EndTrial
            | BeginTrial
            | HideForces
            | Lens => true,
            _ => false,
        }
    };
    for role in Role::ALL {
        let wanted: Vec<&str> = table()
            .iter()
            .filter(|entry| !nowhere(entry))
            .filter(|entry| !of_technician(entry) || role == Role::Technician)
            .filter(|entry| !with_traces(entry) || role != Role::Surgeon)
            .map(|entry| entry.title.as_str())
            .collect();
        assert_eq!(of_role(&mut console, role), wanted, "{role:?}");
    }
}

#[test]
fn a_participant_finds_only_what_a_trial_has() {
    let folder = tempfile::tempdir().unwrap();
    studies::make(folder.path(), "trials = 1", 6.0, "");
    let mut console = studies::console(folder.path(), Options::default());
    studies::open(&mut console);
    let greyed = rows(&mut console);
    for blocked in [Action::View(Role::Surgeon), Action::Rig, Action::Sessions, Action::Studies] {
        assert!(greyed.contains(&(entry(blocked).title.clone(), false)), "{blocked:?}: {greyed:?}");
    }
    pick(&mut console, "a simulated hand");
    pick(&mut console, "Begin the trial");
    wait(&mut console, "a trial", |console| console.state().in_trial());
    until(&mut console, "idle", |tick| tick.state == LoopState::Idle);
    let wanted =
        ["Alarms", "Larger", "Smaller", "Mark this moment", "Acknowledge the alarms", "Stop", "Release stop", "Engage"];
    assert_eq!(titles(&mut console), wanted);
    console.run_steps(30);
    choose(&mut console, Action::Engage);
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    choose(&mut console, Action::Stop);
    wait(&mut console, "the end of the trial, or its stop", |console| {
        !console.state().in_trial() || console.state().tick().is_some_and(|tick| tick.state == LoopState::Stopped)
    });
}

/// What a person does.
type Does<'a> = &'a dyn Fn(&mut Console);

/// Commands that go to the machine, or are about it, are not taken back, however often.
#[test]
fn nothing_that_went_to_the_machine_is_undone() {
    let plan = plan("peg_transfer");
    let (handle, commands) = past::watched(&plan);
    let mut console = egui_kittest::Harness::builder()
        .with_size(SIZE)
        .with_step_dt(1.0 / 30.0)
        .build_eframe(move |cc| ConsoleApp::new(cc, handle, plan.rig, plan.scene).with_simulated_time(1.0));
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
        // Until it is in force.
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
        let (extras, traces) = (console.state().extras(), console.state().traces_s());
        let settings = console.state_mut().settings_mut();
        (settings.layout.closed.clone(), settings.light, settings.scale_percent, extras, traces)
    };
    let mut states = vec![state(&mut console)];
    let steps: [Does<'_>; 5] = [
        &|console| press(console, "Close Traces"),
        &|console| press(console, "Close Safety"),
        &|console| choose(console, Action::Light(true)),
        &|console| choose(console, Action::Draws(Switch::Ceiling)),
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
