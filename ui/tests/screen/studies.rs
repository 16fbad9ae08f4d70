//! User studies in the window: from a template to a report by clicks, and blind until unblinding.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use eframe::App as _;
use egui::{Key, Pos2, Shape, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use nima_console::console::ConsoleOptions;
use nima_core::{
    Side,
    task::{TaskEvent, TimedTaskEvent},
};
use nima_machine::messages::LoopState;
use nima_score::{HandSample, ScoreSample, Scorer, TaskFile};
use nima_simulation::scene::Scene;
use nima_tests::{
    plan,
    studies::{BLIND, study_file},
};
use nima_user_study::{Excludes, MeasureComparison, StudyFile, TrialEnding, UserStudy};

use crate::bench::{
    Console, can_press, pick, press, read, shown_at, shows, texts, toured, until, wait, write_into, write_over,
};

pub(crate) const SIZE: [f32; 2] = [1600.0, 1000.0];
/// Speed of a trial, as a multiple of real time.
const SPEED: f64 = 6.0;
const AT: &str = "2026-01-01T09:00:00Z";
/// Creates a study among the user's data in which the right hand touches tissue for this duration.
pub(crate) fn make(data: &Path, head: &str, seconds: f64, rest: &str) -> PathBuf {
    let text = study_file(&format!("participants = 2\n{head}"), seconds, &format!("{BLIND}{rest}"));
    let file = StudyFile::from_toml(&text).unwrap();
    let scene =
        Scene { task: file.task.as_ref().map(|task| task.to_scene().unwrap()), ..Scene::load("peg_transfer").unwrap() };
    let place = data.join("studies/touching");
    UserStudy::create(&place, &file, &toml::to_string(&scene).unwrap(), AT).unwrap();
    place
}

/// Returns the console with this folder of the user's data.
pub(crate) fn console(data: &Path, options: ConsoleOptions) -> Console {
    let data = data.to_path_buf();
    shown_at(SPEED, &plan("peg_transfer"), SIZE, move |app| app.with_settings(toured(&data)).with_options(options))
}

/// Opens the study created by [`make`].
pub(crate) fn open(window: &mut Console) {
    until(window, "any tick", |_| true);
    window.key_press(Key::F8);
    window.run_steps(2);
    pick(window, "Open Touching");
    read(window, "Next step");
}

/// Starts the next trial and engages.
pub(crate) fn begin(window: &mut Console, button: &str) {
    pick(window, button);
    wait(window, "a trial", |window| window.state().in_trial());
    until(window, "idle", |tick| tick.state == LoopState::Idle);
    press(window, "Engage");
    until(window, "engaged", |tick| tick.state == LoopState::Engaged);
}

/// Completes the next trial.
fn trial(window: &mut Console, button: &str) {
    begin(window, button);
    wait(window, "the end of the trial", |window| !window.state().in_trial());
    window.run_steps(2);
}

fn journal(place: &Path) -> String {
    fs::read_to_string(place.join("journal.jsonl")).unwrap()
}

fn rate(window: &mut Console, name: &str, value: f64) {
    window.get_by_role_and_label(Role::Slider, name).set_value_accesskit(value);
    window.run_steps(2);
}

fn set(window: &mut Console, name: &str, value: f64) {
    window.get_by_role_and_label(Role::SpinButton, name).set_value_accesskit(value);
    window.run_steps(2);
}

#[test]
fn from_a_ready_study_to_the_end_of_its_first_trial_by_clicks() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = console(folder.path(), ConsoleOptions::default());
    until(&mut window, "any tick", |_| true);
    press(&mut window, "Rig");
    pick(&mut window, "User studies");
    pick(&mut window, "New study");
    pick(&mut window, "Short, to try it out");
    set(&mut window, "Participants", 0.0);
    set(&mut window, "Trials per condition", 0.0);
    pick(&mut window, "Create study");
    for mistake in ["participants = 0", "trials = 0"] {
        assert!(shows(&window, mistake), "all are reported at once: {:?}", texts(&window));
    }
    assert!(!folder.path().join("studies").exists(), "a study with mistakes creates nothing");
    set(&mut window, "Participants", 4.0);
    set(&mut window, "Trials per condition", 2.0);
    pick(&mut window, "Create study");
    let place = folder.path().join("studies/short-trial-of-a-study");
    let commitment = UserStudy::read(&place).unwrap().plan().commitment.clone();
    read(&mut window, &commitment);

    begin(&mut window, "Start the trial");
    assert!(shows(&window, "Trial 1 of 4, condition "), "{:?}", texts(&window));
    until(&mut window, "the participant's hand holds the instrument", |tick| tick.guidance.guide_m.is_some());
    let before_m = window.state().tick().unwrap().guidance.guide_m.unwrap();
    for _ in 0..10 {
        window.key_press(Key::ArrowRight);
        window.step();
    }
    until(&mut window, "led", |tick| {
        tick.guidance.guide_m.is_some_and(|position_m| (position_m - before_m).norm() > 0.005)
    });
    window.key_press(Key::M);
    window.run_steps(5);
    assert!(window.state().tick().unwrap().guidance.guide_m.is_some(), "it cannot be let go");
    wait(&mut window, "the end", |window| !window.state().in_trial());
    // A task without an end has no completion time.
    read(&mut window, "Trial 1: the time limit is reached");
    let study = UserStudy::read(&place).unwrap();
    let made = &study.state().progress("P01").unwrap().trials;
    assert!(made.len() == 1 && !made[0].simulated, "{made:?}");
    assert!(made[0].measures.as_ref().unwrap()["path_length_m_right"] > 0.004, "{made:?}");
    assert!(shows(&window, "No trial completed yet"), "{:?}", texts(&window));
    pick(&mut window, "Close the study");
    wait(&mut window, "what ran before", |window| window.state().running().scene == "peg_transfer");
}

/// Opens a list and chooses in it.
fn choose(window: &mut Console, list: &str, what: &str) {
    let click = |window: &mut Console| {
        window.get_by_role_and_label(Role::ComboBox, list).click_accesskit();
        window.run_steps(2);
    };
    click(window);
    pick(window, what);
    // Without a pointer, nothing closes the menu.
    if can_press(window, what) {
        click(window);
    }
}

fn tick(window: &mut Console, name: &str) {
    window.get_by_role_and_label(Role::CheckBox, name).click_accesskit();
    window.run_steps(2);
}

/// Centres of the circles around tips.
fn circles(window: &Console) -> Vec<Pos2> {
    fn add(shape: &Shape, found: &mut Vec<Pos2>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(shape, found)),
            Shape::Circle(circle) if (circle.radius - 11.0).abs() < 0.1 => found.push(circle.center),
            _ => {}
        }
    }
    let mut found = Vec::new();
    window.output().shapes.iter().for_each(|clipped| add(&clipped.shape, &mut found));
    found
}

/// Returns whether a circle is in the undimmed part of the round image.
fn is_in_image(window: &Console, at: Pos2) -> bool {
    let rect = window.get_by_role_and_label(Role::Canvas, "Operating field").rect();
    let clear = 0.57 * rect.height().min(rect.width());
    rect.shrink(11.0).contains(at) && (at - rect.center()).length() + 11.0 < clear
}

#[test]
fn scene_task_measures_and_rules_are_made_in_the_form_and_both_tips_are_seen_from_the_first_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = console(folder.path(), ConsoleOptions::default());
    until(&mut window, "any tick", |_| true);
    window.key_press(Key::F8);
    window.run_steps(2);
    pick(&mut window, "New study");
    write_over(&mut window, "Name", "Two rings");
    choose(&mut window, "Scene", "Loop along a wire");
    assert!(!shows(&window, "drops \u{d7}"), "no trial there has drops");
    choose(&mut window, "Scene", "Rings on pegs");
    tick(&mut window, "Only some of the rings");
    set(&mut window, "Rings", 2.0);
    set(&mut window, "Time limit of a trial", 0.0);
    for name in
        ["Practice before the first trial", "Breaks between trials", "Record every trial (about 36 MB per minute)"]
    {
        tick(&mut window, name);
    }
    set(&mut window, "Participants", 6.0);
    set(&mut window, "Trials per condition", 1.0);
    choose(&mut window, "Primary measure", "idle_time_s: How long both hands rested");
    choose(&mut window, "Add measure", "drops: How often a ring was dropped");
    choose(&mut window, "Add measure", "drops: How often a ring was dropped");
    let rules = window.query_all_by_label_contains(": excludes").count();
    for number in (1..=rules).rev() {
        pick(&mut window, &format!("Rule {number}: Remove"));
    }
    read(&mut window, "No rule");
    pick(&mut window, "Add rule");
    choose(&mut window, "Rule 1: Measure", "trial_time_s: How long the trial lasted");
    choose(&mut window, "Rule 1: is", "below");
    choose(&mut window, "Rule 1: excludes", "the participant");
    set(&mut window, "Rule 1: at least this many times", 2.0);
    pick(&mut window, "Create study");
    for mistake in ["time_limit_s = 0", "drops occurs twice", "exclusion 1: limit is missing"] {
        assert!(shows(&window, mistake), "{mistake}: {:?}", texts(&window));
    }
    set(&mut window, "Time limit of a trial", 30.0);
    set(&mut window, "Rule 1: Limit", 5.0);
    window.query_all_by_label_contains("drops \u{d7}").last().unwrap().click_accesskit();
    window.run_steps(2);
    pick(&mut window, "Create study");

    let place = folder.path().join("studies/two-rings");
    let study = UserStudy::read(&place).unwrap();
    let plan = study.plan();
    assert_eq!(plan.primary, "idle_time_s");
    assert_eq!(plan.secondary.iter().filter(|key| *key == "drops").count(), 1, "{:?}", plan.secondary);
    assert!(plan.practice.is_none() && !plan.record, "{plan:?}");
    let [rule] = plan.exclusion.as_slice() else { panic!("{:?}", plan.exclusion) };
    assert_eq!((rule.measure.as_str(), rule.limit, rule.times), ("trial_time_s", Some(5.0), 2));
    assert_eq!((rule.is, rule.exclude), (MeasureComparison::Below, Excludes::Participant));
    let scene = Scene::parse(&place, study.scene()).unwrap();
    assert_eq!(scene.objects.unwrap().rings.len(), 2);
    assert!((TaskFile::of(&scene.task.unwrap()).unwrap().time_limit_s - 30.0).abs() < 1e-9);

    pick(&mut window, "Start the trial");
    wait(&mut window, "a trial", |window| window.state().in_trial());
    for _ in 0..3 {
        let found = circles(&window);
        assert_eq!(found.len(), 2, "one around each tip, in the first frame and in the following ones");
        assert!(found.iter().all(|at| is_in_image(&window, *at)), "{found:?}");
        until(&mut window, "idle", |tick| tick.state == LoopState::Idle);
    }
    press(&mut window, "Engage");
    until(&mut window, "engaged", |tick| tick.state == LoopState::Engaged);
    assert!(shows(&window, "Trial 1 of 3, condition "), "{:?}", texts(&window));
    assert!(circles(&window).iter().all(|at| is_in_image(&window, *at)));
}

#[test]
fn twelve_trials_with_one_given_up_one_stopped_and_a_power_cut_lose_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let place = make(folder.path(), "trials = 6", 2.0, "");
    let mut window = console(folder.path(), ConsoleOptions::default());
    open(&mut window);
    pick(&mut window, "a simulated hand");
    for number in 1..=12 {
        read(&mut window, &format!("Trial {number} of 12, condition "));
        match number {
            3 => {
                begin(&mut window, "Start the trial");
                press(&mut window, "Abort this trial");
                press(&mut window, "Abort now?");
                read(&mut window, "Trial 3: aborted (given up by the operator)");
            }
            6 => {
                begin(&mut window, "Start the trial");
                press(&mut window, "Stop");
                until(&mut window, "stopped", |tick| tick.state == LoopState::Stopped);
                assert!(
                    shows(&window, "This trial was stopped") && window.state().in_trial(),
                    "the stop stays on the screen"
                );
                press(&mut window, "Release stop");
                read(&mut window, "Trial 6: aborted (stopped by the operator)");
            }
            9 => {
                begin(&mut window, "Start the trial");
                drop(window);
                assert!(journal(&place).lines().last().unwrap().contains("trial_began"));
                window = console(folder.path(), ConsoleOptions::default());
                open(&mut window);
                pick(&mut window, "a simulated hand");
            }
            _ => {}
        }
        if [3, 6, 9].contains(&number) {
            read(&mut window, ", attempt 2");
        }
        trial(&mut window, "Start the trial");
    }
    read(&mut window, "Finished");
    let study = UserStudy::read(&place).unwrap();
    let progress = study.state().progress("P01").unwrap();
    let attempts: Vec<u32> = progress.trials.iter().map(|made| made.attempt).collect();
    assert_eq!(attempts, [1, 1, 2, 1, 1, 2, 1, 1, 2, 1, 1, 1]);
    assert!(progress.trials.iter().all(|made| made.measures.is_some() && made.simulated));
    assert_eq!(progress.interruptions, 3);
    assert_eq!(study.trials().rows, 12);
}

#[test]
fn questionnaires_break_notes_exclusion_unblinding_and_report_are_done_on_the_screen() {
    let folder = tempfile::tempdir().unwrap();
    let rest = "[questionnaires]\nafter_condition = ['nasa_tlx_weighted', 'realism']\nat_end = ['sus', 'free_text']\n\
                [breaks]\nafter_trials = 1\nleast_s = 1.0";
    let place = make(folder.path(), "trials = 1", 2.0, rest);
    let mut window = console(folder.path(), ConsoleOptions::default());
    open(&mut window);
    pick(&mut window, "a simulated hand");
    for number in 1..=2 {
        trial(&mut window, "Start the trial");
        pick(&mut window, "Fill in the questionnaire");
        for (name, value) in
            ["Mental", "Physical", "Temporal", "Performance", "Effort"].into_iter().zip([60.0, 30.0, 45.0, 30.0, 15.0])
        {
            rate(&mut window, name, value);
        }
        assert!(shows(&window, "Missing: frustration, 15 pairs") && !can_press(&window, "Submit"));
        // A tap whose press and release arrive in one frame, on the middle of the line.
        window.get_by_role_and_label(Role::Slider, "Frustration").click();
        window.run_steps(2);
        assert!(shows(&window, "Missing: 15 pairs"), "{:?}", texts(&window));
        assert!(texts(&window).iter().any(|words| words == "50"), "{:?}", texts(&window));
        rate(&mut window, "Frustration", 100.0);
        let names = ["Mental", "Physical", "Temporal", "Performance", "Effort", "Frustration"];
        let firsts = (0..6).flat_map(|one| std::iter::repeat_n(names[one], 5 - one));
        for (pair, first) in (1..).zip(firsts) {
            assert!(!can_press(&window, "Submit"), "before pair {pair}");
            pick(&mut window, &format!("{pair}: {first}"));
        }
        pick(&mut window, "Submit");
        read(&mut window, "How real did touching");
        assert!(!can_press(&window, "Submit"));
        pick(&mut window, "1: 6");
        pick(&mut window, "Submit");
        if number == 1 {
            pick(&mut window, "Start the break");
            assert!(!can_press(&window, "End the break"));
            let began = Instant::now();
            pick(&mut window, "End the break");
            assert!(began.elapsed() > Duration::from_millis(900));
        }
    }
    for (number, answer) in (1..).zip([5, 4, 2, 1, 2, 3, 2, 4, 5, 2]) {
        assert!(shows(&window, "Missing: statement"), "{number}");
        pick(&mut window, &format!("{number}: {answer}"));
    }
    pick(&mut window, "Submit");
    write_into(&mut window, "What would you like to tell us?", "it was easy");
    pick(&mut window, "Submit");
    read(&mut window, "Finished");

    write_into(&mut window, "What happened", "the light flickered");
    pick(&mut window, "Save note");
    pick(&mut window, "Trial 2");
    write_into(&mut window, "Reason", "a telephone rang");
    pick(&mut window, "Exclude");
    read(&mut window, "P01, trial 2: excluded");
    pick(&mut window, "Write the report");
    read(&mut window, "Written: ");
    assert!(!can_press(&window, "Unblind the study"), "neither name nor reason");
    write_into(&mut window, "Your name", "A. Person");
    write_into(&mut window, "Reason for unblinding", "end");
    pick(&mut window, "Unblind the study");
    read(&mut window, "Unblinded by A. Person at ");
    assert!(shows(&window, ": Zebra") && shows(&window, ": Wildebeest"));

    let study = UserStudy::read(&place).unwrap();
    let scores: Vec<(&str, f64)> =
        study.state().progress("P01").unwrap().answers.iter().flat_map(|(_, answers, _)| answers.scores()).collect();
    for wanted in [("nasa_tlx_weighted", 42.0), ("realism", 6.0), ("sus", 55.0)] {
        assert!(scores.contains(&wanted), "{wanted:?} in {scores:?}");
    }
    assert_eq!(study.exclusions().len(), 1);
    let report = fs::read_to_string(place.join("report/report.html")).unwrap();
    assert!(report.contains("the light flickered") && report.contains("a telephone rang"), "{report}");
    let journal = journal(&place);
    assert!(journal.contains("\"unblinded\"") && journal.contains("it was easy"), "{journal}");
}

#[test]
fn a_closed_window_ends_its_trial_and_writes_no_figures_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let place = make(folder.path(), "trials = 1", 20.0, "");
    let summary = folder.path().join("summary.json");
    let mut window =
        console(folder.path(), ConsoleOptions { summary: Some(summary.clone()), ..ConsoleOptions::default() });
    open(&mut window);
    begin(&mut window, "Start the trial");
    window.state_mut().on_exit(None);
    assert!(journal(&place).lines().last().unwrap().contains("the console was closed"));
    assert!(!summary.exists(), "it has the errors of the modes");
}

/// Completes the next trial of this participant in this time.
fn complete(study: &mut UserStudy, participant: &str, seconds: u32) {
    let mut scorer = Scorer::new(&TaskFile::from_toml("name = 'x'\nkind = 'peg_transfer'").unwrap());
    scorer.happening(&TimedTaskEvent { t_s: 0.0, event: TaskEvent::Begun });
    for tick in 0..=seconds * 10 {
        let right = HandSample { engaged: true, ..HandSample::default() };
        scorer.sample(&ScoreSample { t_s: f64::from(tick) * 0.1, hands: Side::Right.alone(right) });
    }
    scorer.happening(&TimedTaskEvent { t_s: f64::from(seconds), event: TaskEvent::Ended });
    let running = study.begin_trial(participant, false, AT).unwrap();
    study.end_trial(running, TrialEnding::Completed, &scorer.finish(), AT).unwrap();
}

#[test]
fn the_learning_of_the_chosen_participant_is_drawn_by_practice_and_trials() {
    let folder = tempfile::tempdir().unwrap();
    let practice = "[practice.criterion]\ntime_s = 100.0\nconsecutive = 2\nadditional = 0\nmax_trials = 4";
    let place = make(folder.path(), "trials = 3", 2.0, practice);
    let mut study = UserStudy::open(&place, AT).unwrap();
    for seconds in [60, 50, 45, 40, 38] {
        complete(&mut study, "P01", seconds);
    }
    drop(study);
    let mut window = console(folder.path(), ConsoleOptions::default());
    open(&mut window);
    read(&mut window, "Learning progress of P01: 2 practice trials, 3 trials completed");
    pick(&mut window, "P02");
    read(&mut window, "No trial completed yet");
}
