//! A walk over every view at three sizes, light and dark: no text is cut or lies on another, nothing leaves the window, no two
//! controls overlap, every control has a name, and the stop is where a hand looks for it.

use std::{env, fmt::Write as _, fs, path::Path, time::Duration};

use eframe::App as _;
use egui::{Key, Pos2, Rect, Shape, accesskit};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::{
    console::{
        ConsoleApp, Options,
        desk::{Layout, Panel},
        roles::Role,
        settings::Kept,
        wizards::Which,
    },
    language::{Language, pseudo},
};
use nima_machine::messages::LoopState;

use crate::{
    bench::{self, console_of, toured, until},
    past, studies,
};

/// Points: the smallest window, the sizes of common screens, and with them those screens at a scale of 150 or 200 %.
const SIZES: [[f32; 2]; 4] = [[1100.0, 680.0], [1280.0, 720.0], [1920.0, 1080.0], [3840.0, 2160.0]];
/// A role, and the panels that are brought to the front: every panel is seen once.
pub(crate) const VIEWS: [(Role, &[Panel]); 7] = [
    (Role::Surgeon, &[]),
    (Role::Technician, &[]),
    (Role::Technician, &[Panel::Safety, Panel::Calibrations, Panel::Timing]),
    (Role::Technician, &[Panel::ForceSpace, Panel::Devices, Panel::Tradeoff]),
    (Role::Technician, &[Panel::Gates, Panel::Degrees]),
    (Role::Technician, &[Panel::Link]),
    (Role::Demo, &[]),
];
/// What rounding may cost, points.
const SLACK: f32 = 1.5;

/// A text on the screen: its words, its place, and where it is allowed to be seen.
pub(crate) struct Text {
    words: String,
    place: Rect,
    clip: Rect,
    cut: bool,
}

/// All texts in what was drawn last.
pub(crate) fn texts<A>(harness: &Harness<'_, A>) -> Vec<Text> {
    fn add(shape: &Shape, clip: Rect, texts: &mut Vec<Text>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(shape, clip, texts)),
            Shape::Text(text) if text.angle == 0.0 && !text.galley.text().trim().is_empty() => texts.push(Text {
                words: text.galley.text().to_owned(),
                place: text.galley.mesh_bounds.translate(text.pos.to_vec2()),
                clip,
                cut: text.galley.elided,
            }),
            _ => {}
        }
    }
    let mut texts = Vec::new();
    for clipped in &harness.output().shapes {
        add(&clipped.shape, clipped.clip_rect, &mut texts);
    }
    texts
}

/// What is wrong with the texts of this picture; `field` is the operating field, where labels ride on moving things.
pub(crate) fn faults_of_texts(
    texts: &[Text],
    window: Rect,
    field: Option<Rect>,
    scrolls: bool,
    overlaid: bool,
) -> Vec<String> {
    let mut faults = Vec::new();
    let seen = |text: &Text| text.place.intersect(text.clip).intersect(window).is_positive();
    let on_field = |text: &Text| {
        field.is_some_and(|field| {
            (text.clip.min - field.min).length() < SLACK && (text.clip.max - field.max).length() < SLACK
        })
    };
    let texts: Vec<&Text> = texts.iter().filter(|text| seen(text) && !on_field(text)).collect();
    for text in &texts {
        let room = text.clip.intersect(window).expand(SLACK);
        let sideways = text.place.left() < room.left() || text.place.right() > room.right();
        let up_or_down = text.place.top() < room.top() || text.place.bottom() > room.bottom();
        // A long column is scrolled; what is half seen at its end is seen whole a moment later.
        if text.cut || sideways || (up_or_down && !scrolls) {
            faults.push(format!("cut: \"{}\" at {:?}", text.words, text.place));
        }
    }
    for (i, one) in texts.iter().enumerate().filter(|_| !overlaid) {
        for other in &texts[i + 1..] {
            let shared = one.place.intersect(one.clip).intersect(other.place.intersect(other.clip)).shrink(SLACK);
            if shared.is_positive() {
                faults.push(format!("\"{}\" lies on \"{}\" at {:?}", one.words, other.words, shared.center()));
            }
        }
    }
    faults
}

/// Where a row of tabs that is longer than its group is scrolled sideways: what is cut there is a press away.
fn scrolled_tabs<A>(harness: &Harness<'_, A>) -> Vec<Rect> {
    let is_arrow = |name: Option<String>| name.is_some_and(|name| name.starts_with("Scroll tabs"));
    harness.query_all_by(move |node| is_arrow(node.label())).map(|node| node.rect()).collect()
}

/// Whether this is in one of these rows of tabs.
fn is_among(rows: &[Rect], place: Rect) -> bool {
    rows.iter().any(|row| row.y_range().contains(place.center().y))
}

/// Controls that overlap, or that leave the window sideways. A control that is scrolled away is known by its words.
pub(crate) fn faults_of_controls<A>(harness: &Harness<'_, A>, texts: &[Text], window: Rect) -> Vec<String> {
    let seen = |name: &str, place: Rect| {
        let words = texts.iter().find(|text| text.words.trim() == name && place.contains(text.place.center()));
        words.map_or(place, |words| place.intersect(words.clip))
    };
    let is_control = |role: accesskit::Role| {
        use accesskit::Role;
        matches!(role, Role::Button | Role::CheckBox | Role::SpinButton | Role::TextInput | Role::RadioButton)
    };
    let scrolled = scrolled_tabs(harness);
    let controls: Vec<(String, Rect)> = harness
        .query_all_by(move |node| is_control(node.role()))
        .map(|node| (node.accesskit_node().label().unwrap_or_default(), node.rect()))
        .map(|(name, place)| (name.clone(), seen(&name, place)))
        .filter(|(_, place)| place.is_positive() && !is_among(&scrolled, *place))
        .collect();
    let mut faults = Vec::new();
    for (i, (name, place)) in controls.iter().enumerate() {
        if place.left() < -SLACK || place.right() > window.right() + SLACK {
            faults.push(format!("\"{name}\" leaves the window: {place:?}"));
        }
        for (other, there) in &controls[i + 1..] {
            if place.intersect(*there).shrink(SLACK).is_positive() {
                faults.push(format!("\"{name}\" overlaps \"{other}\" at {place:?}"));
            }
        }
    }
    faults
}

/// Everything that is wrong on the screen now.
pub(crate) fn faults(harness: &mut Harness<'_, ConsoleApp>, size: [f32; 2], scrolls: bool) -> Vec<String> {
    let (texts, window, field) = seen(harness, size);
    let mut faults = faults_of_texts(&texts, window, field, scrolls, false);
    faults.extend(faults_of_controls(harness, &texts, window));
    faults
}

/// The same where something lies over the rest on purpose.
pub(crate) fn faults_overlaid(harness: &mut Harness<'_, ConsoleApp>, size: [f32; 2]) -> Vec<String> {
    let (texts, window, field) = seen(harness, size);
    faults_of_texts(&texts, window, field, true, true)
}

/// What is seen in a window of this size: its texts, the window, the operating field.
pub(crate) fn seen(harness: &mut Harness<'_, ConsoleApp>, size: [f32; 2]) -> (Vec<Text>, Rect, Option<Rect>) {
    harness.set_size(size.into());
    // Sizes settle within some frames.
    harness.run_steps(4);
    harness.check_accessibility();
    let window = Rect::from_min_size(Pos2::ZERO, size.into());
    let [stop, field] = match harness.state_mut().settings_mut().language {
        Language::English => ["Stop", "Operating field"].map(str::to_owned),
        Language::German => ["Halt", "OP-Feld"].map(str::to_owned),
        Language::Pseudo => ["Stop", "Operating field"].map(pseudo),
    };
    let stop = harness.get_by_role_and_label(accesskit::Role::Button, &stop).rect();
    assert!(stop.width() >= 48.0 && stop.height() >= 48.0 && window.contains_rect(stop), "{stop:?}");
    let field = harness.query_by_label(&field).map(|field| field.rect());
    let scrolled = scrolled_tabs(harness);
    let mut texts = texts(harness);
    texts.retain(|text| !is_among(&scrolled, text.place));
    (texts, window, field)
}

/// What is found in each view at each size, dark and light.
fn in_each_view(
    harness: &mut Harness<'_, ConsoleApp>,
    find: impl Fn(&mut Harness<'_, ConsoleApp>, Role, [f32; 2]) -> Vec<String>,
) -> Vec<String> {
    let mut all = Vec::new();
    for (role, front) in VIEWS {
        for size in SIZES {
            for light in [false, true] {
                let settings = harness.state_mut().settings_mut();
                (settings.role, settings.light) = (role, light);
                settings.layout = Layout { front: front.to_vec(), ..Layout::default() };
                let found = find(harness, role, size);
                all.extend(
                    found.into_iter().map(|fault| format!("{role:?} {front:?} {size:?} light {light}: {fault}")),
                );
            }
        }
    }
    all
}

fn walk(scene: &str) {
    let mut harness = console_of(scene, SIZES[0], |app| app);
    until(&mut harness, "a contact", |tick| tick.t_s > 1.5);
    let all = in_each_view(&mut harness, |harness, role, size| faults(harness, size, role == Role::Technician));
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n"));
}

#[test]
fn nothing_is_cut_or_overlaps_with_one_hand() {
    walk("peg_transfer");
}

#[test]
fn nothing_is_cut_or_overlaps_with_two_hands() {
    walk("bimanual");
}

#[test]
fn nothing_is_cut_or_overlaps_in_the_wizards() {
    let mut all = Vec::new();
    for which in Which::ALL {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_path_buf();
        let options = Options { wizard: Some(which), ..Options::default() };
        let mut harness = console_of(which.scene().unwrap_or("peg_transfer"), SIZES[0], move |app| {
            app.with_store(&path).with_options(options)
        });
        until(&mut harness, "any tick", |_| true);
        for size in SIZES {
            let faults = faults(&mut harness, size, true);
            all.extend(faults.into_iter().map(|fault| format!("{which:?} {size:?}: {fault}")));
        }
    }
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n"));
}

#[test]
fn nothing_is_cut_or_overlaps_on_the_start_page() {
    let mut harness = console_of("peg_transfer", SIZES[0], |app| app);
    until(&mut harness, "any tick", |_| true);
    bench::press(&mut harness, "Rig");
    let mut all = Vec::new();
    for size in SIZES {
        let faults = faults(&mut harness, size, true);
        all.extend(faults.into_iter().map(|fault| format!("{size:?}: {fault}")));
    }
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n"));
}

#[test]
fn nothing_is_cut_or_overlaps_on_the_pages_of_a_study_and_in_a_trial() {
    let folder = tempfile::tempdir().unwrap();
    let rest = "[questionnaires]\nafter_condition = ['nasa_tlx_weighted', 'sus']\nat_end = ['free_text']";
    studies::make(folder.path(), "trials = 1", 2.0, rest);
    let mut harness = studies::console(folder.path(), Options::default());
    until(&mut harness, "any tick", |_| true);
    let mut all = Vec::new();
    let look = |harness: &mut Harness<'_, ConsoleApp>, page: &str, all: &mut Vec<String>| {
        for size in SIZES {
            for light in [false, true] {
                harness.state_mut().settings_mut().light = light;
                // The form scrolls, and on a small screen a questionnaire does: what is scrolled away lies nowhere.
                let faults = if page == "form" || page == "questionnaire" && size[1] < 1000.0 {
                    let (texts, window, field) = seen(harness, size);
                    faults_of_texts(&texts, window, field, true, false)
                } else {
                    faults(harness, size, true)
                };
                all.extend(faults.into_iter().map(|fault| format!("{page} {size:?} light {light}: {fault}")));
            }
        }
    };
    harness.key_press(Key::F8);
    harness.run_steps(2);
    look(&mut harness, "list", &mut all);
    bench::pick(&mut harness, "New study");
    look(&mut harness, "form", &mut all);
    bench::pick(&mut harness, "Make the study");
    look(&mut harness, "new study", &mut all);
    bench::pick(&mut harness, "Close the study");
    bench::pick(&mut harness, "Open Touching");
    bench::pick(&mut harness, "a simulated hand");
    look(&mut harness, "study", &mut all);
    bench::pick(&mut harness, "Begin the trial");
    bench::wait(&mut harness, "a trial", |harness| harness.state().in_trial());
    until(&mut harness, "idle", |tick| tick.state == LoopState::Idle);
    look(&mut harness, "trial", &mut all);
    bench::press(&mut harness, "Engage");
    bench::wait(&mut harness, "its end", |harness| !harness.state().in_trial());
    look(&mut harness, "after a trial", &mut all);
    bench::pick(&mut harness, "Fill in the questionnaire");
    look(&mut harness, "questionnaire", &mut all);
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n"));
}

#[test]
fn nothing_is_cut_or_overlaps_in_the_past_and_in_the_list_of_sessions() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().to_path_buf();
    let sessions = data.join("sessions");
    fs::create_dir_all(&sessions).unwrap();
    let path = sessions.join("20261123T131415Z-Simulated-rig.mcap");
    past::record(&path, "bimanual", "3");
    let mut harness = console_of("peg_transfer", SIZES[0], move |app| app.with_settings(toured(&data)));
    until(&mut harness, "any tick", |_| true);
    let mut all = Vec::new();
    bench::press(&mut harness, "Sessions");
    past::until_listed(&mut harness, "20261123T131415Z-Simulated-rig.mcap");
    for size in SIZES {
        let faults = faults(&mut harness, size, true);
        all.extend(faults.into_iter().map(|fault| format!("list {size:?}: {fault}")));
    }
    bench::press(&mut harness, "Open 20261123T131415Z-Simulated-rig.mcap");
    past::until_whole(&mut harness);
    all.extend(in_each_view(&mut harness, |harness, role, size| {
        // On a small screen the technician's panels scroll more: what is scrolled away lies nowhere.
        if role == Role::Technician && size[1] < 1000.0 {
            let (texts, window, field) = seen(harness, size);
            faults_of_texts(&texts, window, field, true, false)
        } else {
            faults(harness, size, role == Role::Technician)
        }
    }));
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n"));
}

#[test]
fn the_alarm_and_the_stopped_state_fit_too() {
    let mut harness = console_of("bimanual", SIZES[0], |app| app);
    until(&mut harness, "any tick", |_| true);
    bench::press(&mut harness, "Stop");
    let mut all = Vec::new();
    for dead in [false, true] {
        if dead {
            harness.state_mut().on_exit(None);
            std::thread::sleep(Duration::from_millis(600));
            bench::press(&mut harness, "Stop");
            harness.run_steps(3);
        }
        for (role, front) in VIEWS {
            for size in &SIZES[..2] {
                let settings = harness.state_mut().settings_mut();
                settings.role = role;
                settings.layout = Layout { front: front.to_vec(), ..Layout::default() };
                let faults = faults(&mut harness, *size, role == Role::Technician);
                all.extend(faults.into_iter().map(|fault| format!("{role:?} {front:?} dead {dead}: {fault}")));
            }
        }
        for key in [Key::F4, Key::F5] {
            harness.key_press(key);
            let faults = faults_overlaid(&mut harness, SIZES[0]);
            all.extend(faults.into_iter().map(|fault| format!("{key:?} dead {dead}: {fault}")));
            harness.key_press(key);
            harness.run_steps(2);
        }
        bench::press(&mut harness, "View");
        let faults = faults_overlaid(&mut harness, SIZES[0]);
        all.extend(faults.into_iter().map(|fault| format!("menu dead {dead}: {fault}")));
        bench::press(&mut harness, "View");
    }
    assert!(harness.query_by_label_contains("has stopped sending data").is_some());
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n"));
}

#[test]
fn a_scale_is_used_as_far_as_the_window_has_room() {
    let mut harness = console_of("free_motion", SIZES[0], |app| app);
    until(&mut harness, "any tick", |_| true);
    for (size, factor) in [(SIZES[3], 2.0), (SIZES[1], 720.0 / 680.0)] {
        harness.state_mut().settings_mut().scale_percent = 200;
        for _ in 0..4 {
            // A window's points are its pixels over the factor.
            let points = egui::Vec2::from(size) / harness.ctx.zoom_factor();
            harness.set_size(points);
            harness.step();
        }
        let now = harness.ctx.zoom_factor();
        assert!((now - factor).abs() < 0.01, "{now} at {size:?}");
    }
}

#[test]
fn tour_and_glossary_fit_and_leave_the_stop_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    let begin = |path: std::path::PathBuf| {
        console_of("peg_transfer", SIZES[0], move |app| app.with_settings(Kept::open(&path)))
    };
    let mut harness = begin(path.clone());
    until(&mut harness, "any tick", |_| true);
    bench::press(&mut harness, "Go on with the simulated rig");
    for button in ["Next step", "Next step", "Step back", "Next step", "Next step"] {
        assert!(harness.query_by_role_and_label(accesskit::Role::Button, "Stop").is_some());
        bench::press(&mut harness, button);
    }
    bench::press(&mut harness, "Stop");
    until(&mut harness, "stopped during the tour", |tick| tick.state == LoopState::Stopped);
    bench::press(&mut harness, "Begin");
    assert!(harness.query_by_label("Begin").is_none());
    harness.key_press(egui::Key::F4);
    harness.run_steps(3);
    let entry = harness.get_by_label("Horizon").rect();
    let stop = harness.get_by_role_and_label(accesskit::Role::Button, "Stop").rect();
    assert!(entry.top() > stop.bottom());
    harness.key_press(egui::Key::F4);
    harness.run_steps(3);
    assert!(harness.query_by_label("Horizon").is_none());
    drop(harness);
    let mut again = begin(path);
    again.run_steps(3);
    assert!(again.query_by_label("Next step").is_none(), "the tour is for the first time");
}

/// Kind and name of everything that can be operated, in the order of the keyboard. Digits are left out, because numbers move.
fn controls(harness: &Harness<'_, ConsoleApp>) -> String {
    let operated = |kind: accesskit::Role| {
        matches!(
            kind,
            accesskit::Role::Button
                | accesskit::Role::CheckBox
                | accesskit::Role::RadioButton
                | accesskit::Role::Slider
        )
    };
    let mut text = String::new();
    for node in harness.get_all_by(move |node| operated(node.role())) {
        let node = node.accesskit_node();
        let name: String = node.label().unwrap_or_default().chars().filter(|letter| !letter.is_ascii_digit()).collect();
        // An alarm depends on the computer: one without the right to a real-time thread has one.
        if !(name.starts_with("All alarms") || name.starts_with("Acknowledge")) {
            writeln!(text, "{:?}: {}", node.role(), name.lines().next().unwrap_or_default()).unwrap();
        }
    }
    text
}

/// A control that is lost, renamed or new is seen in a review. `UPDATE_SNAPSHOTS=1` writes the files anew.
#[test]
fn every_view_offers_what_was_agreed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
    for (role, name) in [(Role::Surgeon, "surgeon"), (Role::Technician, "technician"), (Role::Demo, "demo")] {
        let mut harness = console_of("bimanual", [1600.0, 1000.0], move |app| {
            app.with_options(Options { role: Some(role), ..Options::default() })
        });
        until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
        harness.run_steps(5);
        let (now, path) = (controls(&harness), folder.join(format!("{name}.txt")));
        if env::var_os("UPDATE_SNAPSHOTS").is_some() {
            fs::create_dir_all(&folder).unwrap();
            fs::write(&path, &now).unwrap();
        }
        let agreed = fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(now, agreed, "{}: if this is meant, run with UPDATE_SNAPSHOTS=1", path.display());
    }
}
