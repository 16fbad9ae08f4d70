//! The window in German and in the lengthened pseudo-language: on every view and page, at four sizes, no text is cut,
//! overlaps another one or leaves its button. The test presses controls by their English names, and switches the language
//! only for the checks.

use std::{fs, path::Path};

use egui::{Key, Modifiers, Rect, vec2};
use egui_kittest::Harness;
use nima_console::console::ConsoleOptions;
use nima_machine::messages::LoopState;
use nima_panels::{roles::Role, settings::SettingsStore, tiles::PanelLayout};
use nima_screen::theme;
use nima_wizards::WizardKind;
use nima_words::language::{self, Language, pseudo};

use crate::{
    bench::{self, Console, console_of, pick, press, read, shows, toured, until},
    faults::{Page, faults, faults_of_controls, faults_of_texts, none, texts, too_wide},
    playback, studies,
    walk::VIEWS,
};

/// The smallest window, the sizes of common screens, and the initial size of the console; points.
const SIZES: [[f32; 2]; 4] = [[1100.0, 680.0], [1280.0, 720.0], [1600.0, 1000.0], [1920.0, 1080.0]];
const LANGUAGES: [Language; 2] = [Language::German, Language::Pseudo];

/// Returns the faults of this page in every language at every size.
fn look_at(console: &mut Console, page: &str, kind: Page) -> Vec<String> {
    let before = console.ctx.content_rect().size();
    let mut all = Vec::new();
    for language in LANGUAGES {
        console.state_mut().settings_mut().language = language;
        for size in SIZES {
            let mut found = faults(console, size, kind);
            if kind != Page::Over {
                found.extend(too_wide(console));
            }
            all.extend(found.into_iter().map(|fault| format!("{page} {language:?} {size:?}: {fault}")));
        }
    }
    console.state_mut().settings_mut().language = Language::English;
    console.set_size(before);
    console.run_steps(3);
    all
}

/// Checks a page of a wizard, for the tests that go through the wizards.
pub(crate) fn fits(console: &mut Console, page: &str) {
    none(&look_at(console, page, Page::Scrolls));
}

/// Like [`fits`], for a window with only a wizard, as wide as its place in the smallest window of the console.
pub(crate) fn fits_alone<A>(window: &mut Harness<'_, A>, page: &str) {
    let mut all = Vec::new();
    for language in LANGUAGES {
        language::set(language);
        window.run_steps(3);
        let mut found = faults_of_texts(&texts(window), window.ctx.content_rect(), None, true, false);
        found.extend(too_wide(window));
        all.extend(found.into_iter().map(|fault| format!("{page} {language:?}: {fault}")));
    }
    language::set(Language::English);
    window.run_steps(2);
    none(&all);
}

fn begin(scene: &str, folder: &Path) -> Console {
    let folder = folder.to_path_buf();
    let mut console = console_of(scene, SIZES[2], move |app| app.with_settings(toured(&folder)));
    until(&mut console, "any tick", |_| true);
    console
}

/// Returns the faults in each view.
fn views(console: &mut Console, what: &str) -> Vec<String> {
    let mut all = Vec::new();
    for (role, front) in VIEWS {
        let settings = console.state_mut().settings_mut();
        settings.role = role;
        settings.layout = PanelLayout { front: front.to_vec(), ..PanelLayout::default() };
        let kind = match role {
            Role::Technician if what == "past" => Page::Form,
            role => Page::of_view(role),
        };
        all.extend(look_at(console, &format!("{what} {role:?} {front:?}"), kind));
    }
    all
}

#[test]
fn every_view_fits() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin("bimanual", folder.path());
    until(&mut console, "a contact", |tick| tick.t_s > 1.5);
    none(&views(&mut console, "live"));
}

#[test]
fn the_alarm_and_the_stopped_state_fit() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin("peg_transfer", folder.path());
    press(&mut console, "Stop");
    until(&mut console, "stopped", |tick| tick.state == LoopState::Stopped);
    let mut all = views(&mut console, "stopped");
    eframe::App::on_exit(console.state_mut(), None);
    std::thread::sleep(std::time::Duration::from_millis(600));
    press(&mut console, "Stop");
    read(&mut console, "has stopped sending data");
    all.extend(look_at(&mut console, "alarm", Page::Scrolls));
    drop(console);
    all.extend(refused(folder.path()));
    none(&all);
}

/// Returns the faults while a refused command is shown, which is for some seconds only.
fn refused(folder: &Path) -> Vec<String> {
    // The wrist sensor of this scene is not calibrated.
    let mut console = begin("palpation", folder);
    until(&mut console, "idle", |tick| tick.state == LoopState::Idle);
    console.state_mut().settings_mut().role = Role::Surgeon;
    let mut all = Vec::new();
    for language in LANGUAGES {
        for size in SIZES {
            console.set_size(size.into());
            console.run_steps(30);
            press(&mut console, "Engage");
            read(&mut console, "Not engaged: the force at the tip is unknown");
            console.state_mut().settings_mut().language = language;
            let found = faults(&mut console, size, Page::of_view(Role::Surgeon));
            all.extend(found.into_iter().map(|fault| format!("refused {language:?} {size:?}: {fault}")));
            console.state_mut().settings_mut().language = Language::English;
        }
    }
    all
}

#[test]
fn every_page_list_and_menu_fits() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin("peg_transfer", folder.path());
    let mut all = Vec::new();
    for (key, name) in [(Key::F4, "glossary"), (Key::F5, "alarms")] {
        console.key_press(key);
        console.run_steps(2);
        all.extend(look_at(&mut console, name, Page::Over));
        console.key_press(key);
        console.run_steps(2);
    }
    console.key_press_modifiers(Modifiers::COMMAND, Key::P);
    console.run_steps(2);
    all.extend(look_at(&mut console, "palette", Page::Over));
    console.key_press_modifiers(Modifiers::COMMAND, Key::P);
    console.run_steps(2);
    for role in [Role::Technician, Role::Surgeon] {
        console.state_mut().settings_mut().role = role;
        press(&mut console, "View");
        all.extend(look_at(&mut console, "menu", Page::Over));
        press(&mut console, "View");
    }
    console.state_mut().settings_mut().role = Role::Technician;
    console.run_steps(2);
    for page in ["Ready check\u{2026}", "Set-up\u{2026}"] {
        pick(&mut console, page);
        all.extend(look_at(&mut console, page, Page::Scrolls));
        pick(&mut console, "Back to the monitor");
    }
    press(&mut console, "Rig");
    all.extend(look_at(&mut console, "start", Page::Scrolls));
    none(&all);
}

#[test]
fn welcome_and_tour_fit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    let mut console = console_of("peg_transfer", SIZES[0], move |app| app.with_settings(SettingsStore::open(&path)));
    until(&mut console, "any tick", |_| true);
    let mut all = look_at(&mut console, "welcome", Page::Over);
    press(&mut console, "Continue with the simulated rig");
    for step in 1..=4 {
        all.extend(look_at(&mut console, &format!("step {step} of the tour"), Page::Over));
        press(&mut console, if step < 4 { "Next step" } else { "Start" });
    }
    none(&all);
}

#[test]
fn the_first_page_of_every_wizard_fits() {
    let mut all = Vec::new();
    for which in WizardKind::ALL {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_path_buf();
        let options = ConsoleOptions { wizard: Some(which), ..ConsoleOptions::default() };
        let mut console = console_of(which.scene().unwrap_or("peg_transfer"), SIZES[0], move |app| {
            app.with_store(&path).with_options(options)
        });
        until(&mut console, "any tick", |_| true);
        all.extend(look_at(&mut console, &format!("{which:?}"), Page::Scrolls));
    }
    none(&all);
}

#[test]
fn the_pages_of_a_study_and_a_trial_fit() {
    let folder = tempfile::tempdir().unwrap();
    let rest = "[questionnaires]\nafter_condition = ['nasa_tlx_weighted', 'sus']\nat_end = ['free_text']";
    studies::make(folder.path(), "trials = 1", 2.0, rest);
    let mut console = studies::console(folder.path(), ConsoleOptions::default());
    until(&mut console, "any tick", |_| true);
    console.key_press(Key::F8);
    console.run_steps(2);
    let mut all = look_at(&mut console, "list of studies", Page::Scrolls);
    pick(&mut console, "New study");
    all.extend(look_at(&mut console, "form of a study", Page::Form));
    pick(&mut console, "Create study");
    all.extend(look_at(&mut console, "new study", Page::Form));
    pick(&mut console, "Close the study");
    pick(&mut console, "Open Touching");
    pick(&mut console, "a simulated hand");
    all.extend(look_at(&mut console, "study", Page::Form));
    pick(&mut console, "Start the trial");
    bench::wait(&mut console, "a trial", |console| console.state().in_trial());
    until(&mut console, "idle", |tick| tick.state == LoopState::Idle);
    all.extend(look_at(&mut console, "trial", Page::Whole));
    press(&mut console, "Engage");
    bench::wait(&mut console, "its end", |console| !console.state().in_trial());
    pick(&mut console, "Fill in the questionnaire");
    all.extend(look_at(&mut console, "questionnaire", Page::Form));
    none(&all);
}

#[test]
fn the_past_and_the_list_of_sessions_fit() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = folder.path().join("sessions");
    fs::create_dir_all(&sessions).unwrap();
    playback::record(&sessions.join("20261123T131415Z-Simulated-rig.mcap"), "bimanual", "3");
    let mut console = begin("peg_transfer", folder.path());
    press(&mut console, "Sessions");
    playback::until_listed(&mut console, "20261123T131415Z-Simulated-rig.mcap");
    let mut all = look_at(&mut console, "list of sessions", Page::Scrolls);
    press(&mut console, "Open 20261123T131415Z-Simulated-rig.mcap");
    playback::until_whole(&mut console);
    all.extend(views(&mut console, "past"));
    none(&all);
}

/// Returns the number of faults found in a window with one planted fault.
fn planted(draw: impl FnMut(&mut egui::Ui) + 'static) -> usize {
    let size = [400.0, 300.0];
    let mut harness = Harness::builder().with_size(size).with_context_setup(theme::apply).build_ui(draw);
    harness.run_steps(2);
    let window = Rect::from_min_size(egui::Pos2::ZERO, size.into());
    let texts = texts(&harness);
    let found = faults_of_texts(&texts, window, None, false, false);
    found.len() + faults_of_controls(&harness, &texts, window).len() + too_wide(&harness).len()
}

#[test]
fn a_planted_cut_text_is_found() {
    let words = "Kraft an der Spitze, in der Hand dargestellt";
    assert_eq!(planted(move |ui| drop(ui.label(words))), 0, "one that fits");
    let narrow = |ui: &mut egui::Ui| {
        ui.set_max_width(90.0);
    };
    let shortened = move |ui: &mut egui::Ui| {
        narrow(ui);
        ui.add(egui::Label::new(words).truncate());
    };
    assert_eq!(planted(shortened), 1, "with an ellipsis");
    let clipped = move |ui: &mut egui::Ui| {
        let place = Rect::from_min_size(ui.min_rect().min, vec2(90.0, 20.0));
        ui.set_clip_rect(place);
        ui.add(egui::Label::new(words).extend());
    };
    assert_eq!(planted(clipped), 1, "cut off at an edge");
    let beyond = move |ui: &mut egui::Ui| {
        ui.add_space(10.0);
        ui.horizontal(|ui| {
            ui.add_space(250.0);
            ui.add(egui::Label::new(words).extend());
        });
    };
    assert_eq!(planted(beyond), 1, "out of the window");
    let on_another = move |ui: &mut egui::Ui| {
        let place = Rect::from_min_size(ui.min_rect().min, vec2(200.0, 20.0));
        for text in ["one", "the other"] {
            ui.place(place, egui::Label::new(text).halign(egui::Align::Min));
        }
    };
    assert_eq!(planted(on_another), 1, "two at one place");
    let wide = move |ui: &mut egui::Ui| {
        ui.add_space(10.0);
        ui.horizontal(|ui| {
            ui.add_space(30.0);
            let (place, response) = ui.allocate_exact_size(vec2(60.0, 24.0), egui::Sense::click());
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Kraft an der"));
            let font = egui::FontId::proportional(13.0);
            ui.painter().text(place.center(), egui::Align2::CENTER_CENTER, "Kraft an der", font, egui::Color32::WHITE);
        });
    };
    assert_eq!(planted(wide), 1, "wider than its button");
}

fn language_of(console: &mut Console) -> Language {
    console.state_mut().settings_mut().language
}

#[test]
fn the_language_is_chosen_in_the_menu_at_once_taken_back_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin("peg_transfer", folder.path());
    console.run_steps(3);
    press(&mut console, "View");
    press(&mut console, "Deutsch");
    console.run_steps(3);
    assert!(shows(&console, "Verst\u{e4}rkung") && !shows(&console, "Gain"), "{:?}", bench::texts(&console));
    assert!(bench::can_press(&console, "Halt") && !bench::can_press(&console, "Stop"));
    console.key_press(Key::Escape);
    console.run_steps(3);
    console.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    console.run_steps(3);
    assert_eq!(language_of(&mut console), Language::English);
    assert!(bench::can_press(&console, "Stop"));
    console.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    console.run_steps(3);
    assert_eq!(language_of(&mut console), Language::German);
    drop(console);
    let mut again = begin("peg_transfer", folder.path());
    again.run_steps(3);
    assert!(bench::can_press(&again, "Halt"));
    // The palette finds a command by its German name, and a language by its own name.
    again.key_press_modifiers(Modifiers::COMMAND, Key::P);
    again.run_steps(3);
    again.event(egui::Event::Text("english".to_owned()));
    again.run_steps(2);
    again.key_press(Key::Enter);
    again.run_steps(3);
    assert_eq!(language_of(&mut again), Language::English);
}

#[test]
fn the_option_chooses_the_language_and_english_is_the_first() {
    let options = ConsoleOptions { language: Some(Language::Pseudo), ..ConsoleOptions::default() };
    let mut console = console_of("peg_transfer", SIZES[0], move |app| app.with_options(options));
    console.run_steps(3);
    assert!(bench::can_press(&console, &pseudo("Stop")), "{:?}", bench::texts(&console));
    let mut console = console_of("peg_transfer", SIZES[0], |app| app);
    console.run_steps(3);
    assert!(bench::can_press(&console, "Stop"), "a window that is opened afterwards has its own language");
}
