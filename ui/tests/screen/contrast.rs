//! Contrast as painted: every text of every view, page and list, in both palettes, against the colour directly below it.

use egui::{Color32, Key, Modifiers, Pos2, Rect, Shape, accesskit::Role as Kind};
use egui_kittest::kittest::Queryable as _;
use nima_console::console::ConsoleOptions;
use nima_panels::tiles::PanelLayout;
use nima_screen::theme;
use nima_testing::contrast::MIN;
use nima_wizards::WizardKind;

use crate::{
    bench::{self, Console, console_of, toured, until},
    playback,
    walk::VIEWS,
};

const SIZE: [f32; 2] = [1600.0, 1000.0];

fn contrast(a: Color32, b: Color32) -> f64 {
    let [a, b] = [a, b].map(|colour| [colour.r(), colour.g(), colour.b()]);
    nima_testing::contrast::contrast(a, b)
}

/// A text as painted: its characters, its middle, and its colours over the ground.
struct Painted {
    words: String,
    at: Pos2,
    inks: Vec<Color32>,
    ground: Color32,
}

/// Returns all texts of the frame, over the filled rectangles painted before.
fn painted(console: &Console) -> Vec<Painted> {
    fn add(shape: &Shape, clip: Rect, grounds: &mut Vec<(Rect, Color32)>, texts: &mut Vec<Painted>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(shape, clip, grounds, texts)),
            Shape::Rect(rect) if rect.fill.a() > 0 => grounds.push((rect.rect.intersect(clip), rect.fill)),
            Shape::Text(text) if !text.galley.text().trim().is_empty() => {
                let place = text.galley.mesh_bounds.translate(text.pos.to_vec2());
                let at = place.center();
                if !clip.contains(at) {
                    return;
                }
                let below = grounds.iter().filter(|(rect, _)| rect.contains(at)).map(|(_, fill)| *fill);
                let ground = below.fold(theme::now().background, Color32::blend);
                let ink = |section: &egui::text::LayoutSection| {
                    let colour = text.override_text_color.unwrap_or(section.format.color);
                    if colour == Color32::PLACEHOLDER { text.fallback_color } else { colour }
                };
                let inks = text.galley.job.sections.iter().map(ink);
                let inks = inks.map(|ink| ground.blend(ink.gamma_multiply(text.opacity_factor))).collect();
                texts.push(Painted { words: text.galley.text().to_owned(), at, inks, ground });
            }
            _ => {}
        }
    }
    let mut grounds = Vec::new();
    let mut texts = Vec::new();
    for clipped in &console.output().shapes {
        add(&clipped.shape, clipped.clip_rect, &mut grounds, &mut texts);
    }
    texts
}

/// Unreadable texts. Disabled controls are greyed on purpose, and text on the field or on an image has its own ground, which
/// is tested with the colours.
fn faults(console: &mut Console) -> Vec<String> {
    console.run_steps(4);
    let greyed: Vec<Rect> = console
        .query_all_by(|node| node.is_disabled() && node.role() != Kind::Window)
        .map(|node| node.rect())
        .chain(["Operating field"].iter().flat_map(|name| console.query_all_by_label(name)).map(|node| node.rect()))
        .collect();
    let texts = painted(console);
    assert!(texts.len() > 8, "only {} texts", texts.len());
    let mut wrong = Vec::new();
    for Painted { words, at, inks, ground } in texts {
        if greyed.iter().any(|rect| rect.contains(at)) {
            continue;
        }
        let min = inks.iter().map(|ink| contrast(*ink, ground)).fold(f64::INFINITY, f64::min);
        if min < MIN {
            wrong.push(format!("{min:.2}: \"{words}\" {inks:?} on {ground:?} at {at:?}"));
        }
    }
    wrong
}

fn both_palettes(console: &mut Console, what: &str, all: &mut Vec<String>) {
    for light in [false, true] {
        console.state_mut().settings_mut().light = light;
        let found = faults(console);
        all.extend(found.into_iter().map(|fault| format!("{what}, light {light}: {fault}")));
    }
    console.state_mut().settings_mut().light = false;
}

fn report(all: &[String]) {
    assert!(all.is_empty(), "{} cannot be read:\n{}", all.len(), all.join("\n"));
}

#[test]
fn every_text_of_the_views_is_read() {
    let mut all = Vec::new();
    let mut console = console_of("bimanual", SIZE, |app| app);
    until(&mut console, "a contact", |tick| tick.t_s > 1.5);
    for (role, front) in VIEWS {
        let settings = console.state_mut().settings_mut();
        settings.role = role;
        settings.layout = PanelLayout { front: front.to_vec(), ..PanelLayout::default() };
        both_palettes(&mut console, &format!("{role:?} {front:?}"), &mut all);
    }
    report(&all);
}

#[test]
fn every_text_of_lists_menus_and_alarms_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    let mut console = console_of("peg_transfer", SIZE, move |app| app.with_settings(toured(&path)));
    until(&mut console, "any tick", |_| true);
    let mut all = Vec::new();
    for key in [Key::F4, Key::F5, Key::F6, Key::F7, Key::F8] {
        console.key_press(key);
        both_palettes(&mut console, &format!("{key:?}"), &mut all);
        console.key_press(key);
        console.run_steps(2);
    }
    bench::press(&mut console, "View");
    both_palettes(&mut console, "menu", &mut all);
    bench::press(&mut console, "View");
    console.key_press_modifiers(Modifiers::COMMAND, Key::P);
    both_palettes(&mut console, "palette", &mut all);
    console.key_press_modifiers(Modifiers::COMMAND, Key::P);
    console.run_steps(2);
    bench::press(&mut console, "Stop");
    eframe::App::on_exit(console.state_mut(), None);
    bench::read(&mut console, "has stopped sending data");
    both_palettes(&mut console, "an alarm", &mut all);
    report(&all);
}

#[test]
fn every_text_of_the_wizards_is_read() {
    let mut all = Vec::new();
    for which in WizardKind::ALL {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_path_buf();
        let options = ConsoleOptions { wizard: Some(which), ..ConsoleOptions::default() };
        let mut console = console_of(which.scene().unwrap_or("peg_transfer"), SIZE, move |app| {
            app.with_store(&path).with_options(options)
        });
        until(&mut console, "any tick", |_| true);
        both_palettes(&mut console, &format!("{which:?}"), &mut all);
    }
    report(&all);
}

#[test]
fn every_text_of_the_past_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    playback::record(&path, "bimanual", "4");
    let mut console = console_of("peg_transfer", SIZE, move |app| app.with_session(&path));
    playback::until_whole(&mut console);
    let mut all = Vec::new();
    for (role, front) in VIEWS {
        let settings = console.state_mut().settings_mut();
        settings.role = role;
        settings.layout = PanelLayout { front: front.to_vec(), ..PanelLayout::default() };
        both_palettes(&mut console, &format!("past {role:?} {front:?}"), &mut all);
    }
    report(&all);
}
