//! User studies: the list, the form of a new one, the experimenter's page, trials and questionnaires.

use std::path::Path;

use nima_score::{LEAST_TRIALS, LearningCurve, Shape};
use nima_user_study::{Comparison, Done, Excludes, Label, Phase, Questionnaire, Step, TrialId};

pub(in crate::console) const OPEN: &str = "User studies";
pub(in crate::console) const OPEN_HOVER: &str = "Make a study, or go on with one. F8";
pub(in crate::console) const BACK: &str = "Back";
pub(in crate::console) const NEW: &str = "New study";
pub(in crate::console) const YOURS: &str = "Studies";
pub(in crate::console) const YOURS_HOVER: &str = "Those in your data folder, and others that were opened here before";
pub(in crate::console) const NONE: &str = "There is none yet: make one";
pub(in crate::console) const OPEN_THIS: &str = "Open";
pub(in crate::console) const OTHER: &str = "Another study";
pub(in crate::console) const OTHER_FOLDER: &str = "Its folder";
pub(in crate::console) const OTHER_OPEN: &str = "Open this folder";
pub(in crate::console) const NO_FOLDER: &str = "There is no folder for your files: set NIMA_DATA_DIR";
pub(in crate::console) const NOT_OVER_A_LINE: &str =
    "A study needs arm and handle at this machine, because it sets the delay itself";

pub(in crate::console) const READY: &str = "Begin with a ready study";
pub(in crate::console) const READY_HOVER: &str = "Everything comes from it, and all that is below can be changed";
pub(in crate::console) const WHAT: &str = "Study";
pub(in crate::console) const WHAT_HOVER: &str = "Everybody reads the name, so it must not tell what is compared";
pub(in crate::console) const NAME: &str = "Name";
pub(in crate::console) const PARTICIPANTS: &str = "Participants";
pub(in crate::console) const TRIALS: &str = "Trials of each condition";
pub(in crate::console) const RIG: &str = "Rig";
pub(in crate::console) const BLIND: &str = "Blind: nobody sees the conditions before the unblinding";
pub(in crate::console) const RECORD: &str = "Record every trial (about 36 MB a minute)";
pub(in crate::console) const INTERRUPTED: &str = "An interrupted trial";
pub(in crate::console) const REPEATED: &str = "is done again";
pub(in crate::console) const SKIPPED: &str = "has no result";
pub(in crate::console) const ATTEMPTS: &str = "Attempts at a trial";
pub(in crate::console) const CONDITIONS: &str = "Conditions";
pub(in crate::console) const CONDITIONS_HOVER: &str =
    "What is compared. Afterwards they are called A, B and so on, in an order that nobody chooses.";
pub(in crate::console) const FEEDBACK: &str = "Force";
pub(in crate::console) const NO_FORCE: &str = "No force";
pub(in crate::console) const GAIN: &str = "Gain";
pub(in crate::console) const NO_GAIN: &str = "none";
pub(in crate::console) const DELAY: &str = "Delay";
pub(in crate::console) const REMOVE: &str = "Remove";
pub(in crate::console) const ADD: &str = "Add a condition";
pub(in crate::console) const NEW_CONDITION: &str = "New condition";
pub(in crate::console) const REFERENCE: &str = "The others are compared with";
pub(in crate::console) const FIRST_LABEL: &str = "condition A";
pub(in crate::console) const TASK: &str = "Task";
pub(in crate::console) const TASK_HOVER: &str = "What the participant does in each trial";
pub(in crate::console) const SCENE: &str = "Scene";
pub(in crate::console) const LIMIT: &str = "A trial is over after";
pub(in crate::console) const FEW_RINGS: &str = "Only some of its rings";
pub(in crate::console) const RINGS: &str = "Rings";
pub(in crate::console) const MEASURES: &str = "Measures";
pub(in crate::console) const MEASURES_HOVER: &str =
    "The primary one decides, and is chosen before the first trial; the others are for the report";
pub(in crate::console) const PRIMARY: &str = "Primary measure";
pub(in crate::console) const SECONDARY: &str = "Secondary measures";
pub(in crate::console) const ADD_MEASURE: &str = "Add a measure";
pub(in crate::console) const EXCLUSION: &str = "Left out of the analysis";
pub(in crate::console) const EXCLUSION_HOVER: &str =
    "Rules that are fixed before the first trial; what they leave out stands in the report with its rule";
pub(in crate::console) const NO_RULES: &str = "No rule: every trial with a result counts";
pub(in crate::console) const ADD_RULE: &str = "Add a rule";
pub(in crate::console) const MEASURE: &str = "Measure";
pub(in crate::console) const IS: &str = "is";
pub(in crate::console) const LIMIT_OF: &str = "Limit";
pub(in crate::console) const LEFT_OUT: &str = "leaves out";
pub(in crate::console) const FROM: &str = "from so many times on";
pub(in crate::console) const TIMES: &str = " times";
pub(in crate::console) const PRACTICE: &str = "Practice";
pub(in crate::console) const PRACTICE_HOVER: &str =
    "Trials before the first one that counts, until the criterion is met";
pub(in crate::console) const PRACTISES: &str = "Practice before the first trial";
pub(in crate::console) const TIME: &str = "Done within";
pub(in crate::console) const DROPS: &str = "Most drops out of view";
pub(in crate::console) const IN_A_ROW: &str = "Such trials in a row";
pub(in crate::console) const MORE: &str = "and so many more";
pub(in crate::console) const MOST: &str = "Most trials of practice";
pub(in crate::console) const UNDER: &str = "Under";
pub(in crate::console) const IN_TURN: &str = "each condition in turn";
pub(in crate::console) const NOT_REACHED: &str = "Who does not get there";
pub(in crate::console) const GOES_ON: &str = "goes on";
pub(in crate::console) const EXCLUDED: &str = "is excluded";
pub(in crate::console) const BREAKS: &str = "Breaks";
pub(in crate::console) const BREAKS_HOVER: &str = "Trials of practice count too";
pub(in crate::console) const RESTS: &str = "Breaks between trials";
pub(in crate::console) const EVERY: &str = "After so many trials";
pub(in crate::console) const LEAST: &str = "For at least";
pub(in crate::console) const QUESTIONNAIRES: &str = "Questionnaires";
pub(in crate::console) const QUESTIONNAIRES_HOVER: &str = "Published ones with their scores, and two of our own";
pub(in crate::console) const AFTER_EACH: &str = "After each condition";
pub(in crate::console) const AT_END: &str = "At the end";
pub(in crate::console) const MAKE: &str = "Make the study";
pub(in crate::console) const MAKE_HOVER: &str = "Draws orders and labels, and seals what each label stands for";

pub(in crate::console) const CLOSE: &str = "Close the study";
pub(in crate::console) const CLOSE_HOVER: &str = "Nothing is lost: it goes on from here another time";
pub(in crate::console) const WHO: &str = "Participants";
pub(in crate::console) const WHO_HOVER: &str = "Pseudonyms; who is who must not stand here";
pub(in crate::console) const NEXT_STEP: &str = "Next step";
pub(in crate::console) const NEXT_STEP_HOVER: &str = "What the study asks of this participant now";
pub(in crate::console) const HAND: &str = "Moved by";
pub(in crate::console) const BY_MOUSE: &str = "the mouse";
pub(in crate::console) const BY_SIMULATED: &str = "a simulated hand";
pub(in crate::console) const BY_RIG: &str = "the handle of the rig";
pub(in crate::console) const BY_SIMULATED_HOVER: &str = "For trying out: the trial is marked as simulated";
pub(in crate::console) const STARTING: &str = "The rig of the study is starting";
pub(in crate::console) const NOT_STARTED: &str = "The rig of the study did not start";
pub(in crate::console) const LEARNING: &str = "Learning";
pub(in crate::console) const LEARNING_HOVER: &str =
    "Time of every completed trial, in order, whatever its condition: rings are practice, discs are trials that count";
pub(in crate::console) const NO_TIMES: &str = "No trial was completed yet";
pub(in crate::console) const TRIAL_AXIS: &str = "trial";
pub(in crate::console) const TIME_AXIS: &str = "time (s)";
pub(in crate::console) const NOTE: &str = "Note";
pub(in crate::console) const NOTE_HOVER: &str = "Stands in the report; it must not tell who the participant is";
pub(in crate::console) const NOTE_FIELD: &str = "What happened";
pub(in crate::console) const NOTE_KEEP: &str = "Keep the note";
pub(in crate::console) const NOTE_KEPT: &str = "The note is kept";
pub(in crate::console) const LEAVE_OUT: &str = "Leave out of the analysis";
pub(in crate::console) const LEAVE_OUT_HOVER: &str =
    "What was done stays in the journal; the reason stands in the report";
pub(in crate::console) const EVERYTHING: &str = "The participant";
pub(in crate::console) const REASON: &str = "Reason";
pub(in crate::console) const LEAVE_OUT_NOW: &str = "Leave it out";
pub(in crate::console) const ABOUT: &str = "Study";
pub(in crate::console) const ABOUT_HOVER: &str = "What everybody may know of it";
pub(in crate::console) const COMMITMENT: &str = "Commitment";
pub(in crate::console) const COMMITMENT_HOVER: &str = "BLAKE2b-256 of the sealed assignment. Keep it outside of the folder: it proves later that nobody changed the assignment.";
pub(in crate::console) const COPY: &str = "Copy the commitment";
pub(in crate::console) const REPORT: &str = "Report";
pub(in crate::console) const REPORT_HOVER: &str = "The whole analysis as one page; a study that is blind stays blind";
pub(in crate::console) const REPORT_WRITE: &str = "Write the report";
pub(in crate::console) const REPORT_WRITING: &str = "Writing the report";
pub(in crate::console) const REPORT_OPEN: &str = "Open the report";
pub(in crate::console) const REPORT_NOT_OPENED: &str =
    "No program of this desktop opens it: open the file report.html in the study's folder yourself";
pub(in crate::console) const UNBLINDING: &str = "Unblinding";
pub(in crate::console) const UNBLINDING_HOVER: &str =
    "Shows what each label stands for; name, reason and time are kept in the journal";
pub(in crate::console) const UNBLIND_NAME: &str = "Your name";
pub(in crate::console) const UNBLIND_WHY: &str = "Reason of the unblinding";
pub(in crate::console) const UNBLIND: &str = "Unblind the study";
pub(in crate::console) const UNBLIND_EARLY: &str = "Not everybody has finished: trials after it are marked";
pub(in crate::console) const NOT_BLIND: &str = "The study is not blind";
pub(in crate::console) const SIMULATED: &str = "Simulated trials or answers are in it";

pub(in crate::console) const GIVE_UP: &str = "Give up this trial";
pub(in crate::console) const GIVE_UP_HOVER: &str = "The study's rule says whether it is done again";
pub(in crate::console) const GIVE_UP_NOW: &str = "Give up now?";
pub(in crate::console) const STATE_STARTING: &str = "Starting";
pub(in crate::console) const STATE_IDLE: &str = "Press Engage to begin";
pub(in crate::console) const STATE_HOLD: &str = "Hold the handle still until it has engaged";
pub(in crate::console) const STATE_STOPPED: &str = "This trial is over: it was stopped. Press Release stop to go back.";
pub(in crate::console) const KEYS_SEARCH: &str = "X marks a place, D ends the trial";

pub(in crate::console) const BREAK: &str = "Break";
pub(in crate::console) const BREAK_OVER: &str = "The break may end";
pub(in crate::console) const BREAK_END: &str = "End the break";
pub(in crate::console) const BREAK_MAY_END: &str = "It may last longer";
pub(in crate::console) const BREAK_BACK: &str = "Back: the break did not happen, and stays the next step";
pub(in crate::console) const BREAK_DONE: &str = "The break is over";
pub(in crate::console) const SUBMIT: &str = "Submit";
pub(in crate::console) const SUBMITTED: &str = "The answers are kept";
pub(in crate::console) const RATE: &str = "Click or drag on each line to rate it";
pub(in crate::console) const PAIRS: &str = "Of each pair, choose what contributed more to the workload";
pub(in crate::console) const AGREE: [&str; 2] = ["Strongly disagree", "Strongly agree"];
pub(in crate::console) const FREE_TEXT: &str = "What do you want to tell us?";
pub(in crate::console) const FREE_TEXT_HINT: &str = "It may stay empty";
pub(in crate::console) const NOT_ANSWERED: &str = "not yet";

/// A ready study, by its name in commands.
pub(in crate::console) fn ready(name: &str) -> [&'static str; 2] {
    match name {
        "paper" => {
            ["Comparison of the paper", "Peg transfer, 18 people, three conditions, 12 trials each and practice"]
        }
        "short" => ["Short, for trying out", "Four people, two conditions, four trials of ten seconds"],
        _ => ["Study", ""],
    }
}

/// A measure in a list.
pub(in crate::console) fn measure(key: &str, words: &str) -> String {
    format!("{key}: {}", words.trim_end_matches('.'))
}

/// A secondary measure, on the button that leaves it off.
pub(in crate::console) fn leave_off(key: &str) -> String {
    format!("{key} \u{00d7}")
}

/// What it is, and what the button does.
pub(in crate::console) fn leave_off_hover(meaning: &str) -> String {
    format!("{meaning} A click leaves it off.")
}

/// Name of the control of a rule, for those who do not see the table.
pub(in crate::console) fn of_rule(what: &str, number: usize) -> String {
    format!("Rule {number}: {what}")
}

/// How a rule compares.
pub(in crate::console) const fn comparison(is: Comparison) -> &'static str {
    match is {
        Comparison::Above => "above",
        Comparison::Below => "below",
        Comparison::Missing => "missing",
    }
}

/// What a rule leaves out.
pub(in crate::console) const fn excludes(what: Excludes) -> &'static str {
    match what {
        Excludes::Trial => "the trial",
        Excludes::Participant => "the participant",
    }
}

/// Whether the orders are balanced.
pub(in crate::console) fn balance(participants: usize, rows: usize) -> String {
    if rows > 0 && participants.is_multiple_of(rows) {
        format!("Balanced: each order is there {} times", participants / rows)
    } else {
        format!("Not balanced: take a multiple of {rows} participants")
    }
}

/// Where the new study will be.
pub(in crate::console) fn place(folder: &Path) -> String {
    format!("It will be in {}", folder.display())
}

/// A study that was made.
pub(in crate::console) fn made(folder: &Path) -> String {
    format!("Made: {}. Copy the commitment now and keep it elsewhere.", folder.display())
}

/// Name of the control of a condition, for those who do not see the table.
pub(in crate::console) fn of_condition(what: &str, number: usize) -> String {
    format!("{what} {number}")
}

/// A study in the list.
pub(in crate::console) fn standing(finished: usize, participants: usize, results: usize, blindness: &str) -> String {
    format!("{finished} of {participants} finished, {results} trials, {blindness}")
}

/// Whether it is blind, in a word.
pub(in crate::console) const fn blindness(blind: bool, unblinded: bool) -> &'static str {
    match (blind, unblinded) {
        (false, _) => "not blind",
        (true, false) => "blind",
        (true, true) => "unblinded",
    }
}

/// Name of a button in the list.
pub(in crate::console) fn open_named(name: &str) -> String {
    format!("Open {name}")
}

/// A questionnaire.
pub(in crate::console) const fn questionnaire(which: Questionnaire) -> &'static str {
    match which {
        Questionnaire::NasaTlx => "NASA-TLX",
        Questionnaire::NasaTlxWeighted => "NASA-TLX, weighted",
        Questionnaire::Sus => "System usability scale",
        Questionnaire::Realism => "Realism",
        Questionnaire::FreeText => "Remarks",
    }
}

/// Of whom a questionnaire is about, and about what.
pub(in crate::console) fn asked(which: Questionnaire, participant: &str, after: Option<Label>) -> String {
    let about = after.map_or_else(|| "the whole session".to_owned(), |label| format!("condition {label}"));
    format!("{}, {participant}, about {about}", questionnaire(which))
}

fn attempt(attempt: u32) -> String {
    if attempt > 1 { format!(", attempt {attempt}") } else { String::new() }
}

/// What a participant does next; `trials` in all.
pub(in crate::console) fn next(step: &Step, trials: u32) -> String {
    match step {
        Step::Practice { number, attempt: nth } => format!("Practice trial {number}{}", attempt(*nth)),
        Step::Trial { number, attempt: nth, label } => {
            format!("Trial {number} of {trials}, condition {label}{}", attempt(*nth))
        }
        Step::Break { least_s } => format!("A break of at least {}", clock(*least_s)),
        Step::Questionnaire { questionnaire: which, after: Some(label) } => {
            format!("{} about condition {label}", questionnaire(*which))
        }
        Step::Questionnaire { questionnaire: which, after: None } => format!("{} at the end", questionnaire(*which)),
        Step::Running { trial } => format!("The end of trial {}", trial.number),
        Step::Done { why: Done::Finished } => "Finished".to_owned(),
        Step::Done { why: Done::Excluded } => "Excluded".to_owned(),
    }
}

/// On the button of the next step; `None` if there is none.
pub(in crate::console) const fn begin(step: &Step) -> Option<&'static str> {
    match step {
        Step::Practice { .. } => Some("Begin the practice trial"),
        Step::Trial { .. } => Some("Begin the trial"),
        Step::Break { .. } => Some("Begin the break"),
        Step::Questionnaire { .. } => Some("Fill in the questionnaire"),
        Step::Running { .. } | Step::Done { .. } => None,
    }
}

/// What a participant has done.
pub(in crate::console) fn done(
    practice: usize,
    trials: usize,
    lost: usize,
    interruptions: u32,
    breaks: usize,
) -> String {
    let lost = if lost > 0 { format!(" ({lost} without a result)") } else { String::new() };
    format!("Done: {practice} of practice, {trials} trials{lost}, {breaks} breaks, {interruptions} interruptions")
}

/// The order of a participant's labels.
pub(in crate::console) fn order(labels: &[Label]) -> String {
    let labels: Vec<String> = labels.iter().map(ToString::to_string).collect();
    format!("Order {}", labels.join(" "))
}

/// The trial on the screen.
pub(in crate::console) fn trial(trial: TrialId, trials: u32, label: Option<Label>) -> String {
    let nth = attempt(trial.attempt);
    match (trial.phase, label) {
        (Phase::Trial, Some(label)) => format!("Trial {} of {trials}{nth}, condition {label}", trial.number),
        (Phase::Trial, None) => format!("Trial {} of {trials}{nth}", trial.number),
        (Phase::Practice, _) => format!("Practice trial {}{nth}", trial.number),
    }
}

/// Time on the screen, minutes and seconds.
pub(in crate::console) fn clock(seconds: f64) -> String {
    let whole = if seconds.is_finite() { seconds.max(0.0) as u64 } else { 0 };
    format!("{}:{:02}", whole / 60, whole % 60)
}

/// How long a break lasts.
pub(in crate::console) fn break_least(least_s: f64) -> String {
    format!("Until it may end; the study asks for {} at least", clock(least_s))
}

/// Time of a trial, of its limit.
pub(in crate::console) fn time_of(seconds: f64, limit_s: f64) -> String {
    format!("{} of {}", clock(seconds), clock(limit_s))
}

/// What is missing in a questionnaire.
pub(in crate::console) fn missing(what: &[String]) -> String {
    format!("Missing: {}", what.join(", "))
}

/// So many pairs were not compared.
pub(in crate::console) fn missing_pairs(count: usize) -> String {
    if count == 1 { "1 pair".to_owned() } else { format!("{count} pairs") }
}

/// A statement by its number.
pub(in crate::console) fn statement(number: usize) -> String {
    format!("statement {number}")
}

/// Trials of a learning curve.
pub(in crate::console) fn curve(participant: &str, practice: usize, trials: usize) -> String {
    format!("Learning of {participant}: {practice} trials of practice, {trials} trials completed")
}

/// What is drawn of them.
pub(in crate::console) fn curve_marks(curve: Option<&LearningCurve>) -> String {
    let marks = "Rings: practice. Discs: trials that count.";
    match curve {
        Some(curve) if curve.shape == Shape::Flat => format!("{marks} Line: {:.0} s, no learning", curve.asymptote_s),
        Some(curve) => {
            let seen = if curve.plateau_seen { "reached" } else { "not reached yet" };
            format!("{marks} Line: fitted curve, plateau {:.0} s ({seen})", curve.asymptote_s)
        }
        None => format!("{marks} A curve needs {LEAST_TRIALS} completed trials"),
    }
}

/// Facts of a study: its rig, who has finished, whether it is blind.
pub(in crate::console) fn facts(
    rig: &str,
    finished: usize,
    participants: usize,
    results: usize,
    blind: &str,
) -> String {
    format!("Rig: {rig}\nFinished: {finished} of {participants}\nTrials with a result: {results}\nThe study is {blind}")
}

/// What was left out.
pub(in crate::console) fn left_out(participant: &str, trial: Option<u32>) -> String {
    trial
        .map_or_else(|| format!("{participant} is left out"), |trial| format!("{participant}, trial {trial}: left out"))
}

/// Who opened it, when and why.
pub(in crate::console) fn unblinded(who: &str, at: &str, why: &str) -> String {
    format!("Unblinded by {who} at {at}: {why}")
}

/// A label and its condition.
pub(in crate::console) fn stands_for(label: Label, name: &str) -> String {
    format!("{label}: {name}")
}

/// Where the report is.
pub(in crate::console) fn report_written(page: &Path) -> String {
    format!("Written: {}", page.display())
}

/// It was not written.
pub(in crate::console) fn report_failed(why: &str) -> String {
    format!("Not written: {why}")
}

/// Ticks that did not reach the score, for the journal.
pub(in crate::console) fn note_lost(trial: TrialId, lost: u64) -> String {
    format!("trial {}: {lost} ticks of the loop did not reach the score", trial.number)
}

/// The recording of a trial has a hole or an early end.
pub(in crate::console) fn record_failed(why: &str) -> String {
    format!("The recording of the trial is not whole: {why}")
}

/// A trial by its number.
pub(in crate::console) fn of_trial(number: u32) -> String {
    format!("Trial {number}")
}
