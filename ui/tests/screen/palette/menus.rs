//! Commands of the View menu and the top bar.

use egui::{Key, accesskit::Role as Kind};
use egui_kittest::kittest::Queryable as _;
use nima_console::console::commands::{Action, SIZES_PERCENT};
use nima_panels::{
    roles::Role,
    settings::{ConsoleSettings, ImageSettings},
    tiles::{Arrangement, PanelId, PanelLayout},
};
use nima_screen::scene3d::extras::{Extras, MenuSwitch, SHOW};
use nima_words::language::Language;

use super::{alike, begin, by_key, choose, entry, expect, rows};
use crate::bench::{Console, pick, press, shows};

/// Returns the initial settings with this change.
fn set(change: impl Fn(&mut ConsoleSettings)) -> impl Fn(&mut Console) {
    move |console| {
        let settings = console.state_mut().settings_mut();
        *settings = ConsoleSettings { toured: true, recent: settings.recent.clone(), ..ConsoleSettings::default() };
        change(settings);
    }
}

fn settings(console: &mut Console) -> String {
    format!("{:?}", console.state_mut().settings_mut())
}

/// Returns a button or switch of the View menu.
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
    // Switching back is tested elsewhere, with German labels.
    done.push(Action::Language(Language::English));
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
    for panel in PanelId::ALL {
        let reset = set(|settings| settings.layout.toggle(panel));
        let other = of_menu(Kind::Button, panel.title());
        let seen = |console: &mut Console| format!("{:?}", console.state_mut().settings_mut().layout.closed);
        done.push(alike(&mut console, Action::Panel(panel), reset, other, seen));
    }
    for panel in PanelId::ALL {
        let other = of_menu(Kind::Button, &entry(Action::Window(panel)).title);
        let seen = |console: &mut Console| format!("{:?}", console.state_mut().settings_mut().layout.windows);
        done.push(alike(&mut console, Action::Window(panel), set(|_| {}), other, seen));
    }
    for arrangement in Arrangement::ALL {
        let before = if arrangement == Arrangement::Simple { Arrangement::Research } else { Arrangement::Simple };
        let reset = set(|settings| settings.layout = PanelLayout::built_in(before));
        let other = of_menu(Kind::Button, &entry(Action::Arrange(arrangement)).title);
        done.push(alike(&mut console, Action::Arrange(arrangement), reset, other, settings));
    }
    let reset = set(|settings| settings.layout = PanelLayout { closed: vec![PanelId::Link], ..PanelLayout::default() });
    done.push(alike(&mut console, Action::ResetLayout, reset, of_menu(Kind::Button, "Reset layout"), settings));
    for action in [Action::ColourBlind, Action::Touch, Action::Sound, Action::ForcesOfNow, Action::RecordsPicture] {
        done.push(alike(&mut console, action, set(|_| {}), of_menu(Kind::CheckBox, &entry(action).title), settings));
    }
    let reset = set(|settings| {
        settings.image = ImageSettings { brightness_percent: 20, forces_of_now: true, ..ImageSettings::default() };
    });
    let plain = &entry(Action::PlainPicture).title;
    done.push(alike(&mut console, Action::PlainPicture, reset, of_menu(Kind::Button, plain), settings));
    set(|_| {})(&mut console);
    console.run_steps(3);
    for switch in MenuSwitch::ALL {
        let other = |console: &mut Console| {
            press(console, SHOW.get());
            console.get_by_role_and_label(Kind::CheckBox, switch.name()).click_accesskit();
            console.run_steps(2);
            press(console, SHOW.get());
        };
        // Switched twice to restore the initial state.
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
    expect(&done, "the View menu");
}

/// Returns the open page, identified by something unique to it.
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
            pick(console, "Skip tour");
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
    expect(&done, "the top bar");
}
