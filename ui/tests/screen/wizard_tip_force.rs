//! The tip-force wizard driven by accessible names, with data from a simulated rig on the virtual clock: minutes of work take
//! seconds.

use std::{
    path::{Path, PathBuf},
    time::{Instant, SystemTime},
};

use egui::{ScrollArea, accesskit::Role};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::ConsoleApp;
use nima_core::calibration::Verdict;
use nima_machine::{
    config::RigConfig,
    messages::{Command, ForceSource},
    rig::{Prompt, Side},
    teleop::Calibrations,
};
use nima_recording::{
    store::{Store, utc_now},
    tip_force::{DataSet, Selection, kept_model},
};
use nima_screen::theme;
use nima_simulation::{
    SimulationPlan, run_virtual,
    scene::{Flaw, Scene},
};
use nima_wizards::{
    Binding, SaveRequest, WizardKind, WizardPageRequest, Wizards, active_calibrations::ActiveCalibrations,
};

use crate::{
    bench::{TIMEOUT, can_press, pick, read, shown, shows, texts, wait, write_into},
    image, language,
    virtual_rig::{VirtualRig, records},
};

/// Ticks of the virtual clock between two frames of the window.
const TICKS: usize = 250;

/// A window with only the wizard.
struct Fixture {
    wizards: Wizards,
    binding: Binding,
    saving: Option<SaveRequest>,
}

impl eframe::App for Fixture {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        ScrollArea::vertical().show(ui, |ui| {
            ui.set_max_width(760.0);
            if let Some(WizardPageRequest::Save(saving)) = self.wizards.ui(WizardKind::TipForce, ui, &self.binding) {
                self.saving.get_or_insert(saving);
            }
        });
    }
}

struct Console {
    rig: VirtualRig,
    window: Harness<'static, Fixture>,
}

impl Console {
    fn new(flaw: Option<Flaw>, folder: &Path) -> Self {
        let (gravity, correspondence) = records();
        let mut scene = Scene::load("isolation").unwrap();
        scene.person.as_mut().unwrap().flaw = flaw;
        let calibrations = Calibrations { gravity: Some(gravity.model), ..Calibrations::default() };
        let bench = Fixture {
            wizards: Wizards::default(),
            binding: Binding {
                sensor: gravity.head.sensor.clone(),
                tool: gravity.head.tool.clone(),
                date: utc_now(),
                correspondence: Some(correspondence.correspondence()),
                store: Some(Store::open(folder)),
                ..Binding::default()
            },
            saving: None,
        };
        let window = Harness::builder().with_size([800.0, 1500.0]).with_step_dt(1.0 / 30.0).build_eframe(|cc| {
            theme::apply(&cc.egui_ctx);
            bench
        });
        Self { rig: VirtualRig::start(scene, calibrations), window }
    }

    /// Advances the rig for a moment, then draws the window.
    fn step(&mut self) {
        let wizards = &mut self.window.state_mut().wizards;
        let ticks = self.rig.go_on(TICKS, wizards.prompt(WizardKind::TipForce));
        for tick in &ticks {
            wizards.tick(WizardKind::TipForce, tick, 1000.0);
        }
        self.window.step();
    }

    /// Two seconds pass with the wizard closed.
    fn look_away(&mut self) {
        self.rig.go_on(2000, Prompt::Rest);
        self.rig.go_on(1, Prompt::Rest);
        self.step();
        self.step();
    }

    fn shows(&self, words: &str) -> bool {
        shows(&self.window, words)
    }

    fn read(&mut self, words: &str) {
        let began = Instant::now();
        while !self.shows(words) {
            assert!(began.elapsed() < TIMEOUT, "never came: {words}; there is: {:?}", texts(&self.window));
            self.step();
        }
    }

    fn is_ready(&self, label: &str) -> bool {
        can_press(&self.window, label)
    }

    fn press(&mut self, label: &str) {
        let began = Instant::now();
        while !self.is_ready(label) {
            assert!(began.elapsed() < TIMEOUT, "cannot press: {label}; there is: {:?}", texts(&self.window));
            self.step();
        }
        self.window.get_by_role_and_label(Role::Button, label).click_accesskit();
        self.step();
        self.step();
    }

    /// Returns the number in the label of the bar.
    fn rows(&self) -> usize {
        let label = self.window.get_by_label_contains(" s (paper: ").accesskit_node().label().unwrap();
        label.trim_start_matches("Rows: ").split(',').next().unwrap().parse().unwrap()
    }

    fn record(&mut self, rows: usize) {
        let began = Instant::now();
        while self.rows() < rows {
            assert!(began.elapsed() < TIMEOUT, "no rows; there is: {:?}", texts(&self.window));
            self.step();
        }
    }

    fn train(&mut self, size: &str) {
        self.press(size);
        self.press("Start training");
        self.read("networks on");
    }
}

fn rows_of(folder: &Path, kind: &str) -> Option<usize> {
    let path = Store::open(folder).path_of(kind, &records().0.head.sensor, "csv").unwrap();
    path.exists().then(|| DataSet::read(&[path], &Selection::default()).unwrap().rows())
}

fn model_path(folder: &Path) -> PathBuf {
    Store::open(folder).path_of("tip-force", &records().0.head.sensor, "safetensors").unwrap()
}

/// Returns the real console on a running loop; with wizards, that of the tip force is open with their data.
fn real_console(wizards: Option<Wizards>, folder: &Path) -> Harness<'static, ConsoleApp> {
    let rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load("isolation").unwrap();
    let calibrations = ActiveCalibrations::load(Some(folder), &rig, &scene).calibrations(&rig);
    let plan = SimulationPlan { rig, scene, calibrations, engage: false };
    let folder = folder.to_owned();
    shown(&plan, [1600.0, 1500.0], move |app| {
        let app = app.with_store(&folder);
        match wizards {
            Some(wizards) => app.with_wizards(WizardKind::TipForce, wizards),
            None => app,
        }
    })
}

#[test]
fn from_an_empty_recording_to_a_network_that_answers_in_the_loop() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    store.save(&records().0).unwrap();
    store.save(&records().1).unwrap();
    let mut console = Console::new(None, folder.path());
    console.press("Next");
    console.press("Start recording");
    console.record(12_000);
    console.read("All goals are met");
    language::fits_alone(&mut console.window, "record");
    image::same(&mut console.window, "wizard-tipforce-record");
    console.press("Next");
    console.press("Small (16)");
    console.press("Start training");
    // Showing another page does not end it.
    console.press("Back");
    assert!(console.shows("All goals are met"));
    console.press("Next");
    console.read("networks on");
    assert!(rows_of(folder.path(), "tip-force-data").unwrap() >= 6000, "the data set is on disk for the command line");
    language::fits_alone(&mut console.window, "train");
    image::same(&mut console.window, "wizard-tipforce-train");
    console.press("Next");
    console.press("Start the check");
    console.read("without touching the tissue");
    console.read("Verdict: ");
    console.read("Accepted");
    assert!(console.shows("Regression plot") && console.shows("Histogram of the predicted force without contact"));
    console.window.check_accessibility();
    language::fits_alone(&mut console.window, "check");
    console.press("Next");
    language::fits_alone(&mut console.window, "save");
    image::same(&mut console.window, "wizard-tipforce-save");
    assert!(!model_path(folder.path()).exists(), "nothing is kept without being asked");
    let wizards = std::mem::take(&mut console.window.state_mut().wizards);
    let mut real = real_console(Some(wizards), folder.path());
    pick(&mut real, "Save and use");
    read(&mut real, "Saved and in use");
    let lines = real.state().active().lines();
    assert!(
        lines.iter().any(|line| line.starts_with("Tip force: 2") && line.contains("error on new data")),
        "{lines:?}"
    );
    wait(&mut real, "the network at work", |window| {
        window.state().tick().is_some_and(|tick| tick.force.tip_force.is_some())
    });
    drop(real);
    answers_in_the_loop(folder.path());
}

/// On the virtual clock the accepted network is used, with a smaller error than the wrist force.
fn answers_in_the_loop(folder: &Path) {
    let rig = RigConfig::load("simulated").unwrap();
    let mut scene = Scene::load("isolation").unwrap();
    scene.seed += 1;
    let calibrations = ActiveCalibrations::load(Some(folder), &rig, &scene).calibrations(&rig);
    let plan = SimulationPlan { rig, scene, calibrations, engage: false };
    let [mut by_network, mut by_wrist, mut answered] = [0.0; 3];
    let correspondence = records().1.correspondence();
    run_virtual(&plan, 15.0, |tick| {
        if tick.force.source == ForceSource::Network {
            let sample = tick.calibration.wrist.unwrap();
            let true_n = correspondence.tip_force_s1(&sample, &sample.tissue_n.unwrap()).unwrap();
            by_network += (tick.force.tip_force.unwrap().force_s1_n - true_n).norm();
            by_wrist += (tick.force.gravity_free.unwrap().force_n - true_n).norm();
            answered += 1.0;
        }
        (tick.index == 10).then_some(Command::Prompt(Side::Right, Prompt::Work))
    })
    .unwrap();
    assert!(answered > 10_000.0, "{answered} of 15000 ticks");
    assert!(by_network < 0.5 * by_wrist, "{} against {} N", by_network / answered, by_wrist / answered);
}

#[test]
fn a_sensor_that_is_lost_for_a_moment_costs_no_recording_and_another_one_does() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = Console::new(None, folder.path());
    console.press("Next");
    console.press("Start recording");
    console.record(300);
    let known = std::mem::take(&mut console.window.state_mut().binding);
    console.window.step();
    console.window.state_mut().binding = known;
    console.record(600);
    assert!(!console.shows("was discarded"));
    console.window.state_mut().binding.sensor = "another one".to_owned();
    console.read("was discarded");
}

#[test]
fn without_a_correspondence_nothing_can_be_recorded() {
    let folder = tempfile::tempdir().unwrap();
    Store::open(folder.path()).save(&records().0).unwrap();
    let mut real = real_console(None, folder.path());
    pick(&mut real, "Calibrate tip force…");
    wait(&mut real, "the reason", |window| {
        window.query_by_label_contains("The correspondence is unknown: calibrate it first").is_some()
            && window.query_by_label_contains("Correspondence: unknown; press").is_some()
            && window.query_by_label_contains("Gravity: passed").is_some()
    });
    for _ in 0..20 {
        real.step();
        assert!(!can_press(&real, "Next"));
    }
}

#[test]
fn work_in_one_place_never_meets_the_goals_and_its_network_needs_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = Console::new(Some(Flaw::WorksInOnePlace), folder.path());
    console.press("Next");
    console.press("Start recording");
    console.read("To do: reach left, right, near and far (tilt of the shaft)");
    console.record(6500);
    assert!(console.shows("To do: reach left") && !console.is_ready("Next"), "all rows, and not enough of the space");
    console.press("Train anyway");
    console.train("Small (16)");
    assert!(console.shows("The recording is incomplete (tilt of the shaft)"));
    console.press("Next");
    console.press("Start the check");
    console.read("Verdict: ");
    assert!(!console.shows("Accepted"));
    console.press("Next");
    assert!(!console.is_ready("Save despite the verdict") && !console.shows("Save and use"));
}

#[test]
fn sensors_that_do_not_agree_are_refused_and_an_override_is_written_into_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = Console::new(Some(Flaw::LeansOnTheStand), folder.path());
    console.press("Next");
    console.press("Start recording");
    console.read("All goals are met");
    console.press("Next");
    console.train("Small (16)");
    console.press("Next");
    console.press("Start the check");
    console.read("Verdict: ");
    assert!(console.shows("Poor data"), "{:?}", texts(&console.window));
    console.press("Next");
    assert!(!console.is_ready("Save despite the verdict"), "a name and a reason come first");
    for (label, text) in [("Your name", "A. Technician"), ("Reason", "practice")] {
        write_into(&mut console.window, label, text);
    }
    console.press("Save despite the verdict");
    let saving = console.window.state_mut().saving.take().unwrap();
    let rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load("isolation").unwrap();
    let mut active = ActiveCalibrations::load(Some(folder.path()), &rig, &scene);
    active.save(saving).unwrap();
    let lines = active.lines();
    assert!(lines.iter().any(|line| line.contains("NOT PROVEN, accepted by A. Technician")), "{lines:?}");
    let wrist = rig.simulated_wrist(Side::Right).unwrap();
    let store = Store::open(folder.path());
    let kept = kept_model(&store, &wrist.serial_number, &wrist.tool, SystemTime::now()).unwrap().unwrap();
    let check = kept.record.origin.check.unwrap();
    assert_eq!(
        (check.judgement.verdict, check.judgement.override_by.as_deref()),
        (Verdict::PoorData, Some("A. Technician"))
    );
    assert_eq!(check.judgement.override_reason.as_deref(), Some("practice"));
}

#[test]
fn a_cancelled_training_and_steps_back_keep_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = Console::new(None, folder.path());
    console.press("Next");
    console.press("Start recording");
    console.record(1000);
    console.press("Pause");
    let rows = console.rows();
    console.press("Back");
    console.press("Next");
    assert_eq!(console.rows(), rows, "a step back costs no row, and nothing is taken meanwhile");
    console.press("Train anyway");
    console.press("Start training");
    console.press("Cancel training");
    console.read("Cancelled. The recording is kept.");
    assert!(console.is_ready("Start training") && !console.is_ready("Next"), "nothing was trained");
    console.press("Back");
    assert_eq!(console.rows(), rows);
    assert_eq!(rows_of(folder.path(), "tip-force-data"), Some(rows), "it is on disk too");
    console.press("Resume recording");
    console.record(rows + 300);
    let rows = console.rows();
    console.look_away();
    assert_eq!(console.rows(), rows, "the page was hidden, and nothing is lost");
    assert!(console.shows("Paused: press"), "the time in between is unknown: it continues on request");
    console.press("Resume recording");
    console.read("setting the sensor under the tissue to zero");
    console.record(rows + 300);
    console.press("Start over");
    assert!(console.shows("Put the tissue on its sensor"));
    console.press("Next");
    assert_eq!(console.rows(), 0, "started over");
}
