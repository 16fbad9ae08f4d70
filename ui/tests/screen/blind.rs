//! Blindness of user studies on the screen: no text, hover text, title or file reveals a condition before unblinding.

use std::{
    collections::BTreeSet,
    fs,
    time::{Duration, Instant},
};

use egui::{Key, Shape, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nima_console::console::ConsoleOptions;
use nima_machine::messages::LoopState;
use nima_tests::studies::{everything, found_in};

use crate::{
    bench::{Console, TIMEOUT, can_press, shows, texts, until, write_into},
    studies::{console, make},
};

/// Words and numbers that occur nowhere else, in all spellings that a screen could show.
const SECRET: [&str; 10] =
    ["zebra", "wildebeest", "anchored", "no_force", "137.5", "0.1375", "138 ms", "0.8125", "0.81", "rendered_n"];

/// A window that records all readable texts in it.
struct Reader {
    window: Console,
    seen: BTreeSet<String>,
}

impl Reader {
    fn step(&mut self) {
        self.window.step();
        for node in self.window.query_all_by(|_| true) {
            let node = node.accesskit_node();
            self.seen.extend([node.label(), node.value(), node.description()].into_iter().flatten());
        }
        let output = self.window.output();
        for clipped in &output.shapes {
            painted(&clipped.shape, &mut self.seen);
        }
        for viewport in output.viewport_output.values() {
            self.seen.extend(viewport.builder.title.clone());
            self.seen.extend(viewport.commands.iter().map(|command| format!("{command:?}")));
        }
    }

    fn until(&mut self, what: &str, wanted: impl Fn(&Console) -> bool) {
        let began = Instant::now();
        while !wanted(&self.window) {
            assert!(began.elapsed() < TIMEOUT, "never: {what}; there is: {:?}", texts(&self.window));
            std::thread::sleep(Duration::from_millis(10));
            self.step();
        }
    }

    fn pick(&mut self, label: &str) {
        self.until(label, |window| can_press(window, label));
        self.window.get_by_role_and_label(Role::Button, label).click_accesskit();
        self.step();
        self.step();
    }

    fn read(&mut self, words: &str) {
        self.until(words, |window| shows(window, words));
    }

    fn write_into(&mut self, label: &str, text: &str) {
        write_into(&mut self.window, label, text);
        self.step();
    }

    /// A trial that visits every control that keys and pointer reach.
    fn trial(&mut self, button: &str) {
        self.pick(button);
        self.until("a trial", |window| window.state().in_trial());
        self.until("idle", |window| window.state().tick().is_some_and(|tick| tick.state == LoopState::Idle));
        self.look_around();
        self.until("Engage", |window| can_press(window, "Engage"));
        self.window.get_by_role_and_label(Role::Button, "Engage").click_accesskit();
        self.until("engaged", |window| window.state().tick().is_some_and(|tick| tick.state == LoopState::Engaged));
        self.look_around();
        self.until("the end", |window| !window.state().in_trial());
        self.step();
    }

    fn look_around(&mut self) {
        use Key::{A, E, F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, F11, F12, G, K, L, M, N, P, Tab};
        for key in [F1, F2, F3, F4, F5, F5, F6, F7, F8, F9, F10, F11, F12, A, E, G, K, L, M, N, P, Tab] {
            self.window.key_press(key);
            self.step();
            self.step();
        }
        // Run everything that the palette offers, and close it again.
        for _ in 0..2 {
            self.window.key_press_modifiers(egui::Modifiers::COMMAND, P);
            self.step();
            self.step();
        }
        self.point_around();
    }

    /// Moves the pointer over everything that can be pressed or read.
    fn point_around(&mut self) {
        let of = |role: Role| self.window.query_all_by_role(role).map(|node| node.rect().center());
        let places: Vec<egui::Pos2> = [Role::Button, Role::Label].into_iter().flat_map(of).collect();
        for place in places {
            self.window.event(egui::Event::PointerMoved(place));
            for _ in 0..24 {
                self.step();
            }
        }
        self.window.event(egui::Event::PointerGone);
        self.step();
    }
}

fn painted(shape: &Shape, seen: &mut BTreeSet<String>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| painted(shape, seen)),
        Shape::Text(text) => drop(seen.insert(text.galley.text().to_owned())),
        _ => {}
    }
}

fn secrets_in(text: &str) -> Vec<&'static str> {
    found_in(text, &SECRET)
}

/// Sealed sessions are random bytes: in 20 MB of them, any given four bytes in a row occur in one of two hundred runs.
fn secrets_in_files(files: &str) -> Vec<&'static str> {
    secrets_in(files).into_iter().filter(|secret| secret.len() > 4).collect()
}

#[test]
fn a_blind_study_tells_its_conditions_on_no_page_and_in_no_file_until_it_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let rest = "[questionnaires]\nafter_condition = ['realism']\nat_end = ['free_text']\n[breaks]\nafter_trials = 2\nleast_s = 0.5\n\
                [practice]\n[practice.criterion]\ntime_s = 100.0\nconsecutive = 1\nadditional = 0\nmax_trials = 1";
    let place = make(folder.path(), "trials = 1\nrecord = true\nreference = 'Wildebeest'", 6.0, rest);
    let mut window = console(folder.path(), ConsoleOptions::default());
    until(&mut window, "any tick", |_| true);
    // The screen shows the mode and gain of the previous loop.
    window.key_press(Key::F8);
    window.run_steps(3);
    let mut reader = Reader { window, seen: BTreeSet::new() };
    reader.pick("Open Touching");
    reader.pick("a simulated hand");
    reader.trial("Start the practice trial");
    reader.pick("the mouse");
    reader.trial("Start the trial");
    reader.pick("Fill in the questionnaire");
    reader.pick("1: 5");
    reader.pick("Submit");
    reader.pick("Start the break");
    reader.pick("End the break");
    reader.trial("Start the trial");
    reader.pick("Fill in the questionnaire");
    reader.pick("1: 4");
    reader.pick("Submit");
    reader.pick("Submit");
    reader.read("Finished");
    reader.pick("P02");
    reader.write_into("What happened", "the light flickered");
    reader.pick("Save note");
    reader.write_into("Reason", "never came");
    reader.pick("Exclude");
    reader.pick("Write the report");
    reader.read("Written: ");
    reader.point_around();
    let seen: Vec<String> = reader.seen.iter().cloned().collect();
    let files = everything(folder.path());
    for report in ["Trial 1 of 2, condition ", "Practice trial 1", "Touch", "Loop state: Engaged", "Abort this trial"] {
        assert!(seen.iter().any(|words| words.contains(report)), "{report} was not even seen: {seen:?}");
    }
    let found: Vec<&String> = seen.iter().filter(|words| !secrets_in(words).is_empty()).collect();
    assert!(found.is_empty(), "on the screen, of {} texts: {found:#?}", seen.len());
    assert_eq!(secrets_in_files(&files), [""; 0], "in {} bytes of files", files.len());
    let names: Vec<String> = fs::read_dir(place.join("sessions"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert!(names.len() == 3 && names.iter().all(|name| name.ends_with(".mcap.sealed")), "{names:?}");
    assert!(!folder.path().join("sessions").exists(), "the console itself recorded nothing");

    reader.write_into("Your name", "A. Person");
    reader.write_into("Reason for unblinding", "end");
    reader.pick("Unblind the study");
    reader.read("Unblinded by");
    let seen = reader.seen.iter().cloned().collect::<String>();
    assert_eq!(secrets_in(&seen), ["zebra", "wildebeest"], "the control: now they are present");
    assert!(secrets_in_files(&everything(&place)).len() > 5, "and in the files");
}
