//! User studies: the list, the form of a new one, the experimenter's page, trials and questionnaires.

use std::path::Path;

use nima_score::{LEAST_TRIALS, LearningCurve, Shape};
use nima_user_study::{Comparison, Done, Excludes, Label, Phase, Questionnaire, Step, TrialId};

use crate::language::{Text, told, word};

pub(in crate::console) const OPEN: Text = Text::of("User studies", "User studies");
pub(in crate::console) const OPEN_HOVER: Text =
    Text::of("Make a study, or go on with one. F8", "Make a study, or go on with one. F8");
pub(in crate::console) const BACK: Text = Text::of("Back", "Back");
pub(in crate::console) const NEW: Text = Text::of("New study", "New study");
pub(in crate::console) const YOURS: Text = Text::of("Studies", "Studies");
pub(in crate::console) const YOURS_HOVER: Text = Text::of(
    "Those in your data folder, and others that were opened here before",
    "Those in your data folder, and others that were opened here before",
);
pub(in crate::console) const NONE: Text = Text::of("There is none yet: make one", "There is none yet: make one");
pub(in crate::console) const OPEN_THIS: Text = Text::of("Open", "Open");
pub(in crate::console) const OTHER: Text = Text::of("Another study", "Another study");
pub(in crate::console) const OTHER_FOLDER: Text = Text::of("Its folder", "Its folder");
pub(in crate::console) const OTHER_OPEN: Text = Text::of("Open this folder", "Open this folder");
pub(in crate::console) const NO_FOLDER: Text = Text::of(
    "There is no folder for your files: set NIMA_DATA_DIR",
    "There is no folder for your files: set NIMA_DATA_DIR",
);
pub(in crate::console) const NOT_OVER_A_LINE: Text = Text::of(
    "A study needs arm and handle at this machine, because it sets the delay itself",
    "A study needs arm and handle at this machine, because it sets the delay itself",
);

pub(in crate::console) const READY: Text = Text::of("Begin with a ready study", "Begin with a ready study");
pub(in crate::console) const READY_HOVER: Text = Text::of(
    "Everything comes from it, and all that is below can be changed",
    "Everything comes from it, and all that is below can be changed",
);
pub(in crate::console) const WHAT: Text = Text::of("Study", "Study");
pub(in crate::console) const WHAT_HOVER: Text = Text::of(
    "Everybody reads the name, so it must not tell what is compared",
    "Everybody reads the name, so it must not tell what is compared",
);
pub(in crate::console) const NAME: Text = Text::of("Name", "Name");
pub(in crate::console) const PARTICIPANTS: Text = Text::of("Participants", "Participants");
pub(in crate::console) const TRIALS: Text = Text::of("Trials of each condition", "Trials of each condition");
pub(in crate::console) const RIG: Text = Text::of("Rig", "Rig");
pub(in crate::console) const BLIND: Text = Text::of(
    "Blind: nobody sees the conditions before the unblinding",
    "Blind: nobody sees the conditions before the unblinding",
);
pub(in crate::console) const RECORD: Text =
    Text::of("Record every trial (about 36 MB a minute)", "Record every trial (about 36 MB a minute)");
pub(in crate::console) const INTERRUPTED: Text = Text::of("An interrupted trial", "An interrupted trial");
pub(in crate::console) const REPEATED: Text = Text::of("is done again", "is done again");
pub(in crate::console) const SKIPPED: Text = Text::of("has no result", "has no result");
pub(in crate::console) const ATTEMPTS: Text = Text::of("Attempts at a trial", "Attempts at a trial");
pub(in crate::console) const CONDITIONS: Text = Text::of("Conditions", "Conditions");
pub(in crate::console) const CONDITIONS_HOVER: Text = Text::of(
    "What is compared. Afterwards they are called A, B and so on, in an order that nobody chooses.",
    "What is compared. Afterwards they are called A, B and so on, in an order that nobody chooses.",
);
pub(in crate::console) const FEEDBACK: Text = Text::of("Force", "Force");
pub(in crate::console) const NO_FORCE: Text = Text::of("No force", "No force");
pub(in crate::console) const GAIN: Text = Text::of("Gain", "Gain");
pub(in crate::console) const NO_GAIN: Text = Text::of("none", "none");
pub(in crate::console) const DELAY: Text = Text::of("Delay", "Delay");
pub(in crate::console) const REMOVE: Text = Text::of("Remove", "Remove");
pub(in crate::console) const ADD: Text = Text::of("Add a condition", "Add a condition");
pub(in crate::console) const NEW_CONDITION: Text = Text::of("New condition", "New condition");
pub(in crate::console) const REFERENCE: Text = Text::of("The others are compared with", "The others are compared with");
pub(in crate::console) const FIRST_LABEL: Text = Text::of("condition A", "condition A");
pub(in crate::console) const TASK: Text = Text::of("Task", "Task");
pub(in crate::console) const TASK_HOVER: Text =
    Text::of("What the participant does in each trial", "What the participant does in each trial");
pub(in crate::console) const SCENE: Text = Text::of("Scene", "Scene");
pub(in crate::console) const LIMIT: Text = Text::of("A trial is over after", "A trial is over after");
pub(in crate::console) const FEW_RINGS: Text = Text::of("Only some of its rings", "Only some of its rings");
pub(in crate::console) const RINGS: Text = Text::of("Rings", "Rings");
pub(in crate::console) const MEASURES: Text = Text::of("Measures", "Measures");
pub(in crate::console) const MEASURES_HOVER: Text = Text::of(
    "The primary one decides, and is chosen before the first trial; the others are for the report",
    "The primary one decides, and is chosen before the first trial; the others are for the report",
);
pub(in crate::console) const PRIMARY: Text = Text::of("Primary measure", "Primary measure");
pub(in crate::console) const SECONDARY: Text = Text::of("Secondary measures", "Secondary measures");
pub(in crate::console) const ADD_MEASURE: Text = Text::of("Add a measure", "Add a measure");
pub(in crate::console) const EXCLUSION: Text = Text::of("Left out of the analysis", "Left out of the analysis");
pub(in crate::console) const EXCLUSION_HOVER: Text = Text::of(
    "Rules that are fixed before the first trial; what they leave out stands in the report with its rule",
    "Rules that are fixed before the first trial; what they leave out stands in the report with its rule",
);
pub(in crate::console) const NO_RULES: Text =
    Text::of("No rule: every trial with a result counts", "No rule: every trial with a result counts");
pub(in crate::console) const ADD_RULE: Text = Text::of("Add a rule", "Add a rule");
pub(in crate::console) const MEASURE: Text = Text::of("Measure", "Measure");
pub(in crate::console) const IS: Text = Text::of("is", "is");
pub(in crate::console) const LIMIT_OF: Text = Text::of("Limit", "Limit");
pub(in crate::console) const LEFT_OUT: Text = Text::of("leaves out", "leaves out");
pub(in crate::console) const FROM: Text = Text::of("from so many times on", "from so many times on");
pub(in crate::console) const TIMES: Text = Text::of(" times", " times");
pub(in crate::console) const PRACTICE: Text = Text::of("Practice", "Practice");
pub(in crate::console) const PRACTICE_HOVER: Text = Text::of(
    "Trials before the first one that counts, until the criterion is met",
    "Trials before the first one that counts, until the criterion is met",
);
pub(in crate::console) const PRACTISES: Text =
    Text::of("Practice before the first trial", "Practice before the first trial");
pub(in crate::console) const TIME: Text = Text::of("Done within", "Done within");
pub(in crate::console) const DROPS: Text = Text::of("Most drops out of view", "Most drops out of view");
pub(in crate::console) const IN_A_ROW: Text = Text::of("Such trials in a row", "Such trials in a row");
pub(in crate::console) const MORE: Text = Text::of("and so many more", "and so many more");
pub(in crate::console) const MOST: Text = Text::of("Most trials of practice", "Most trials of practice");
pub(in crate::console) const UNDER: Text = Text::of("Under", "Under");
pub(in crate::console) const IN_TURN: Text = Text::of("each condition in turn", "each condition in turn");
pub(in crate::console) const NOT_REACHED: Text = Text::of("Who does not get there", "Who does not get there");
pub(in crate::console) const GOES_ON: Text = Text::of("goes on", "goes on");
pub(in crate::console) const EXCLUDED: Text = Text::of("is excluded", "is excluded");
pub(in crate::console) const BREAKS: Text = Text::of("Breaks", "Breaks");
pub(in crate::console) const BREAKS_HOVER: Text =
    Text::of("Trials of practice count too", "Trials of practice count too");
pub(in crate::console) const RESTS: Text = Text::of("Breaks between trials", "Breaks between trials");
pub(in crate::console) const EVERY: Text = Text::of("After so many trials", "After so many trials");
pub(in crate::console) const LEAST: Text = Text::of("For at least", "For at least");
pub(in crate::console) const QUESTIONNAIRES: Text = Text::of("Questionnaires", "Questionnaires");
pub(in crate::console) const QUESTIONNAIRES_HOVER: Text = Text::of(
    "Published ones with their scores, and two of our own",
    "Published ones with their scores, and two of our own",
);
pub(in crate::console) const AFTER_EACH: Text = Text::of("After each condition", "After each condition");
pub(in crate::console) const AT_END: Text = Text::of("At the end", "At the end");
pub(in crate::console) const MAKE: Text = Text::of("Make the study", "Make the study");
pub(in crate::console) const MAKE_HOVER: Text = Text::of(
    "Draws orders and labels, and seals what each label stands for",
    "Draws orders and labels, and seals what each label stands for",
);

pub(in crate::console) const CLOSE: Text = Text::of("Close the study", "Close the study");
pub(in crate::console) const CLOSE_HOVER: Text = Text::of(
    "Nothing is lost: it goes on from here another time",
    "Nothing is lost: it goes on from here another time",
);
pub(in crate::console) const WHO: Text = Text::of("Participants", "Participants");
pub(in crate::console) const WHO_HOVER: Text =
    Text::of("Pseudonyms; who is who must not stand here", "Pseudonyms; who is who must not stand here");
pub(in crate::console) const NEXT_STEP: Text = Text::of("Next step", "Next step");
pub(in crate::console) const NEXT_STEP_HOVER: Text =
    Text::of("What the study asks of this participant now", "What the study asks of this participant now");
pub(in crate::console) const HAND: Text = Text::of("Moved by", "Moved by");
pub(in crate::console) const BY_MOUSE: Text = Text::of("the mouse", "the mouse");
pub(in crate::console) const BY_SIMULATED: Text = Text::of("a simulated hand", "a simulated hand");
pub(in crate::console) const BY_RIG: Text = Text::of("the handle of the rig", "the handle of the rig");
pub(in crate::console) const BY_SIMULATED_HOVER: Text =
    Text::of("For trying out: the trial is marked as simulated", "For trying out: the trial is marked as simulated");
pub(in crate::console) const STARTING: Text =
    Text::of("The rig of the study is starting", "The rig of the study is starting");
pub(in crate::console) const NOT_STARTED: Text =
    Text::of("The rig of the study did not start", "The rig of the study did not start");
pub(in crate::console) const LEARNING: Text = Text::of("Learning", "Learning");
pub(in crate::console) const LEARNING_HOVER: Text = Text::of(
    "Time of every completed trial, in order, whatever its condition: rings are practice, discs are trials that count",
    "Time of every completed trial, in order, whatever its condition: rings are practice, discs are trials that count",
);
pub(in crate::console) const NO_TIMES: Text = Text::of("No trial was completed yet", "No trial was completed yet");
pub(in crate::console) const TRIAL_AXIS: Text = Text::of("trial", "trial");
pub(in crate::console) const TIME_AXIS: Text = Text::of("time (s)", "time (s)");
pub(in crate::console) const NOTE: Text = Text::of("Note", "Note");
pub(in crate::console) const NOTE_HOVER: Text = Text::of(
    "Stands in the report; it must not tell who the participant is",
    "Stands in the report; it must not tell who the participant is",
);
pub(in crate::console) const NOTE_FIELD: Text = Text::of("What happened", "What happened");
pub(in crate::console) const NOTE_KEEP: Text = Text::of("Keep the note", "Keep the note");
pub(in crate::console) const NOTE_KEPT: Text = Text::of("The note is kept", "The note is kept");
pub(in crate::console) const LEAVE_OUT: Text = Text::of("Leave out of the analysis", "Leave out of the analysis");
pub(in crate::console) const LEAVE_OUT_HOVER: Text = Text::of(
    "What was done stays in the journal; the reason stands in the report",
    "What was done stays in the journal; the reason stands in the report",
);
pub(in crate::console) const EVERYTHING: Text = Text::of("The participant", "The participant");
pub(in crate::console) const REASON: Text = Text::of("Reason", "Reason");
pub(in crate::console) const LEAVE_OUT_NOW: Text = Text::of("Leave it out", "Leave it out");
pub(in crate::console) const ABOUT: Text = Text::of("Study", "Study");
pub(in crate::console) const ABOUT_HOVER: Text =
    Text::of("What everybody may know of it", "What everybody may know of it");
pub(in crate::console) const COMMITMENT: Text = Text::of("Commitment", "Commitment");
pub(in crate::console) const COMMITMENT_HOVER: Text = Text::of(
    "BLAKE2b-256 of the sealed assignment. Keep it outside of the folder: it proves later that nobody changed the \
     assignment.",
    "BLAKE2b-256 of the sealed assignment. Keep it outside of the folder: it proves later that nobody changed the \
     assignment.",
);
pub(in crate::console) const COPY: Text = Text::of("Copy the commitment", "Copy the commitment");
pub(in crate::console) const REPORT: Text = Text::of("Report", "Report");
pub(in crate::console) const REPORT_HOVER: Text = Text::of(
    "The whole analysis as one page; a study that is blind stays blind",
    "The whole analysis as one page; a study that is blind stays blind",
);
pub(in crate::console) const REPORT_WRITE: Text = Text::of("Write the report", "Write the report");
pub(in crate::console) const REPORT_WRITING: Text = Text::of("Writing the report", "Writing the report");
pub(in crate::console) const REPORT_OPEN: Text = Text::of("Open the report", "Open the report");
pub(in crate::console) const REPORT_NOT_OPENED: Text = Text::of(
    "No program of this desktop opens it: open the file report.html in the study's folder yourself",
    "No program of this desktop opens it: open the file report.html in the study's folder yourself",
);
pub(in crate::console) const UNBLINDING: Text = Text::of("Unblinding", "Unblinding");
pub(in crate::console) const UNBLINDING_HOVER: Text = Text::of(
    "Shows what each label stands for; name, reason and time are kept in the journal",
    "Shows what each label stands for; name, reason and time are kept in the journal",
);
pub(in crate::console) const UNBLIND_NAME: Text = Text::of("Your name", "Your name");
pub(in crate::console) const UNBLIND_WHY: Text = Text::of("Reason of the unblinding", "Reason of the unblinding");
pub(in crate::console) const UNBLIND: Text = Text::of("Unblind the study", "Unblind the study");
pub(in crate::console) const UNBLIND_EARLY: Text = Text::of(
    "Not everybody has finished: trials after it are marked",
    "Not everybody has finished: trials after it are marked",
);
pub(in crate::console) const NOT_BLIND: Text = Text::of("The study is not blind", "The study is not blind");
pub(in crate::console) const SIMULATED: Text =
    Text::of("Simulated trials or answers are in it", "Simulated trials or answers are in it");

pub(in crate::console) const GIVE_UP: Text = Text::of("Give up this trial", "Give up this trial");
pub(in crate::console) const GIVE_UP_HOVER: Text =
    Text::of("The study's rule says whether it is done again", "The study's rule says whether it is done again");
pub(in crate::console) const GIVE_UP_NOW: Text = Text::of("Give up now?", "Give up now?");
pub(in crate::console) const STATE_STARTING: Text = Text::of("Starting", "Starting");
pub(in crate::console) const STATE_IDLE: Text = Text::of("Press Engage to begin", "Press Engage to begin");
pub(in crate::console) const STATE_HOLD: Text =
    Text::of("Hold the handle still until it has engaged", "Hold the handle still until it has engaged");
pub(in crate::console) const STATE_STOPPED: Text = Text::of(
    "This trial is over: it was stopped. Press Release stop to go back.",
    "This trial is over: it was stopped. Press Release stop to go back.",
);
pub(in crate::console) const KEYS_SEARCH: Text =
    Text::of("X marks a place, D ends the trial", "X marks a place, D ends the trial");

pub(in crate::console) const BREAK: Text = Text::of("Break", "Break");
pub(in crate::console) const BREAK_OVER: Text = Text::of("The break may end", "The break may end");
pub(in crate::console) const BREAK_END: Text = Text::of("End the break", "End the break");
pub(in crate::console) const BREAK_MAY_END: Text = Text::of("It may last longer", "It may last longer");
pub(in crate::console) const BREAK_BACK: Text = Text::of(
    "Back: the break did not happen, and stays the next step",
    "Back: the break did not happen, and stays the next step",
);
pub(in crate::console) const BREAK_DONE: Text = Text::of("The break is over", "The break is over");
pub(in crate::console) const SUBMIT: Text = Text::of("Submit", "Submit");
pub(in crate::console) const SUBMITTED: Text = Text::of("The answers are kept", "The answers are kept");
pub(in crate::console) const RATE: Text =
    Text::of("Click or drag on each line to rate it", "Click or drag on each line to rate it");
pub(in crate::console) const PAIRS: Text = Text::of(
    "Of each pair, choose what contributed more to the workload",
    "Of each pair, choose what contributed more to the workload",
);
pub(in crate::console) const AGREE: [Text; 2] =
    [Text::of("Strongly disagree", "Strongly disagree"), Text::of("Strongly agree", "Strongly agree")];
pub(in crate::console) const FREE_TEXT: Text = Text::of("What do you want to tell us?", "What do you want to tell us?");
pub(in crate::console) const FREE_TEXT_HINT: Text = Text::of("It may stay empty", "It may stay empty");
pub(in crate::console) const NOT_ANSWERED: Text = Text::of("not yet", "not yet");

/// A ready study, by its name in commands.
pub(in crate::console) fn ready(name: &str) -> [&'static str; 2] {
    match name {
        "paper" => [
            word("Comparison of the paper", "Comparison of the paper"),
            word(
                "Peg transfer, 18 people, three conditions, 12 trials each and practice",
                "Peg transfer, 18 people, three conditions, 12 trials each and practice",
            ),
        ],
        "short" => [
            word("Short, for trying out", "Short, for trying out"),
            word(
                "Four people, two conditions, four trials of ten seconds",
                "Four people, two conditions, four trials of ten seconds",
            ),
        ],
        _ => [word("Study", "Study"), ""],
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
    told!("{meaning} A click leaves it off.", "{meaning} A click leaves it off.")
}

/// Name of the control of a rule, for those who do not see the table.
pub(in crate::console) fn of_rule(what: &str, number: usize) -> String {
    told!("Rule {number}: {what}", "Rule {number}: {what}")
}

/// How a rule compares.
pub(in crate::console) fn comparison(is: Comparison) -> &'static str {
    match is {
        Comparison::Above => word("above", "above"),
        Comparison::Below => word("below", "below"),
        Comparison::Missing => word("missing", "missing"),
    }
}

/// What a rule leaves out.
pub(in crate::console) fn excludes(what: Excludes) -> &'static str {
    match what {
        Excludes::Trial => word("the trial", "the trial"),
        Excludes::Participant => word("the participant", "the participant"),
    }
}

/// Whether the orders are balanced.
pub(in crate::console) fn balance(participants: usize, rows: usize) -> String {
    if rows > 0 && participants.is_multiple_of(rows) {
        told!("Balanced: each order is there {} times", "Balanced: each order is there {} times", participants / rows)
    } else {
        told!(
            "Not balanced: take a multiple of {rows} participants",
            "Not balanced: take a multiple of {rows} participants"
        )
    }
}

/// Where the new study will be.
pub(in crate::console) fn place(folder: &Path) -> String {
    told!("It will be in {}", "It will be in {}", folder.display())
}

/// A study that was made.
pub(in crate::console) fn made(folder: &Path) -> String {
    told!(
        "Made: {}. Copy the commitment now and keep it elsewhere.",
        "Made: {}. Copy the commitment now and keep it elsewhere.",
        folder.display()
    )
}

/// Name of the control of a condition, for those who do not see the table.
pub(in crate::console) fn of_condition(what: &str, number: usize) -> String {
    format!("{what} {number}")
}

/// A study in the list.
pub(in crate::console) fn standing(finished: usize, participants: usize, results: usize, blindness: &str) -> String {
    told!(
        "{finished} of {participants} finished, {results} trials, {blindness}",
        "{finished} of {participants} finished, {results} trials, {blindness}"
    )
}

/// Whether it is blind, in a word.
pub(in crate::console) fn blindness(blind: bool, unblinded: bool) -> &'static str {
    match (blind, unblinded) {
        (false, _) => word("not blind", "not blind"),
        (true, false) => word("blind", "blind"),
        (true, true) => word("unblinded", "unblinded"),
    }
}

/// Name of a button in the list.
pub(in crate::console) fn open_named(name: &str) -> String {
    told!("Open {name}", "Open {name}")
}

/// A questionnaire.
pub(in crate::console) fn questionnaire(which: Questionnaire) -> &'static str {
    match which {
        Questionnaire::NasaTlx => word("NASA-TLX", "NASA-TLX"),
        Questionnaire::NasaTlxWeighted => word("NASA-TLX, weighted", "NASA-TLX, weighted"),
        Questionnaire::Sus => word("System usability scale", "System usability scale"),
        Questionnaire::Realism => word("Realism", "Realism"),
        Questionnaire::FreeText => word("Remarks", "Remarks"),
    }
}

/// Of whom a questionnaire is about, and about what.
pub(in crate::console) fn asked(which: Questionnaire, participant: &str, after: Option<Label>) -> String {
    let about = after.map_or_else(
        || word("the whole session", "the whole session").to_owned(),
        |label| told!("condition {label}", "condition {label}"),
    );
    told!("{}, {participant}, about {about}", "{}, {participant}, about {about}", questionnaire(which))
}

fn attempt(attempt: u32) -> String {
    if attempt > 1 { told!(", attempt {attempt}", ", attempt {attempt}") } else { String::new() }
}

/// What a participant does next; `trials` in all.
pub(in crate::console) fn next(step: &Step, trials: u32) -> String {
    match step {
        Step::Practice { number, attempt: nth } => {
            told!("Practice trial {number}{}", "Practice trial {number}{}", attempt(*nth))
        }
        Step::Trial { number, attempt: nth, label } => {
            told!(
                "Trial {number} of {trials}, condition {label}{}",
                "Trial {number} of {trials}, condition {label}{}",
                attempt(*nth)
            )
        }
        Step::Break { least_s } => told!("A break of at least {}", "A break of at least {}", clock(*least_s)),
        Step::Questionnaire { questionnaire: which, after: Some(label) } => {
            told!("{} about condition {label}", "{} about condition {label}", questionnaire(*which))
        }
        Step::Questionnaire { questionnaire: which, after: None } => {
            told!("{} at the end", "{} at the end", questionnaire(*which))
        }
        Step::Running { trial } => told!("The end of trial {}", "The end of trial {}", trial.number),
        Step::Done { why: Done::Finished } => word("Finished", "Finished").to_owned(),
        Step::Done { why: Done::Excluded } => word("Excluded", "Excluded").to_owned(),
    }
}

/// On the button of the next step; `None` if there is none.
pub(in crate::console) fn begin(step: &Step) -> Option<&'static str> {
    match step {
        Step::Practice { .. } => Some(word("Begin the practice trial", "Begin the practice trial")),
        Step::Trial { .. } => Some(word("Begin the trial", "Begin the trial")),
        Step::Break { .. } => Some(word("Begin the break", "Begin the break")),
        Step::Questionnaire { .. } => Some(word("Fill in the questionnaire", "Fill in the questionnaire")),
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
    let lost = if lost > 0 { told!(" ({lost} without a result)", " ({lost} without a result)") } else { String::new() };
    told!(
        "Done: {practice} of practice, {trials} trials{lost}, {breaks} breaks, {interruptions} interruptions",
        "Done: {practice} of practice, {trials} trials{lost}, {breaks} breaks, {interruptions} interruptions"
    )
}

/// The order of a participant's labels.
pub(in crate::console) fn order(labels: &[Label]) -> String {
    let labels: Vec<String> = labels.iter().map(ToString::to_string).collect();
    told!("Order {}", "Order {}", labels.join(" "))
}

/// The trial on the screen.
pub(in crate::console) fn trial(trial: TrialId, trials: u32, label: Option<Label>) -> String {
    let nth = attempt(trial.attempt);
    match (trial.phase, label) {
        (Phase::Trial, Some(label)) => told!(
            "Trial {} of {trials}{nth}, condition {label}",
            "Trial {} of {trials}{nth}, condition {label}",
            trial.number
        ),
        (Phase::Trial, None) => told!("Trial {} of {trials}{nth}", "Trial {} of {trials}{nth}", trial.number),
        (Phase::Practice, _) => told!("Practice trial {}{nth}", "Practice trial {}{nth}", trial.number),
    }
}

/// Time on the screen, minutes and seconds.
pub(in crate::console) fn clock(seconds: f64) -> String {
    let whole = if seconds.is_finite() { seconds.max(0.0) as u64 } else { 0 };
    format!("{}:{:02}", whole / 60, whole % 60)
}

/// How long a break lasts.
pub(in crate::console) fn break_least(least_s: f64) -> String {
    told!(
        "Until it may end; the study asks for {} at least",
        "Until it may end; the study asks for {} at least",
        clock(least_s)
    )
}

/// Time of a trial, of its limit.
pub(in crate::console) fn time_of(seconds: f64, limit_s: f64) -> String {
    told!("{} of {}", "{} of {}", clock(seconds), clock(limit_s))
}

/// What is missing in a questionnaire.
pub(in crate::console) fn missing(what: &[String]) -> String {
    told!("Missing: {}", "Missing: {}", what.join(", "))
}

/// So many pairs were not compared.
pub(in crate::console) fn missing_pairs(count: usize) -> String {
    if count == 1 { word("1 pair", "1 pair").to_owned() } else { told!("{count} pairs", "{count} pairs") }
}

/// A statement by its number.
pub(in crate::console) fn statement(number: usize) -> String {
    told!("statement {number}", "statement {number}")
}

/// Trials of a learning curve.
pub(in crate::console) fn curve(participant: &str, practice: usize, trials: usize) -> String {
    told!(
        "Learning of {participant}: {practice} trials of practice, {trials} trials completed",
        "Learning of {participant}: {practice} trials of practice, {trials} trials completed"
    )
}

/// What is drawn of them.
pub(in crate::console) fn curve_marks(curve: Option<&LearningCurve>) -> String {
    let marks = word("Rings: practice. Discs: trials that count.", "Rings: practice. Discs: trials that count.");
    match curve {
        Some(curve) if curve.shape == Shape::Flat => {
            told!("{marks} Line: {:.0} s, no learning", "{marks} Line: {:.0} s, no learning", curve.asymptote_s)
        }
        Some(curve) => {
            let seen = if curve.plateau_seen {
                word("reached", "reached")
            } else {
                word("not reached yet", "not reached yet")
            };
            told!(
                "{marks} Line: fitted curve, plateau {:.0} s ({seen})",
                "{marks} Line: fitted curve, plateau {:.0} s ({seen})",
                curve.asymptote_s
            )
        }
        None => told!(
            "{marks} A curve needs {LEAST_TRIALS} completed trials",
            "{marks} A curve needs {LEAST_TRIALS} completed trials"
        ),
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
    told!(
        "Rig: {rig}\nFinished: {finished} of {participants}\nTrials with a result: {results}\nThe study is {blind}",
        "Rig: {rig}\nFinished: {finished} of {participants}\nTrials with a result: {results}\nThe study is {blind}"
    )
}

/// What was left out.
pub(in crate::console) fn left_out(participant: &str, trial: Option<u32>) -> String {
    trial.map_or_else(
        || told!("{participant} is left out", "{participant} is left out"),
        |trial| told!("{participant}, trial {trial}: left out", "{participant}, trial {trial}: left out"),
    )
}

/// Who opened it, when and why.
pub(in crate::console) fn unblinded(who: &str, at: &str, why: &str) -> String {
    told!("Unblinded by {who} at {at}: {why}", "Unblinded by {who} at {at}: {why}")
}

/// A label and its condition.
pub(in crate::console) fn stands_for(label: Label, name: &str) -> String {
    format!("{label}: {name}")
}

/// Where the report is.
pub(in crate::console) fn report_written(page: &Path) -> String {
    told!("Written: {}", "Written: {}", page.display())
}

/// It was not written.
pub(in crate::console) fn report_failed(why: &str) -> String {
    told!("Not written: {why}", "Not written: {why}")
}

/// Ticks that did not reach the score, for the journal.
pub(in crate::console) fn note_lost(trial: TrialId, lost: u64) -> String {
    told!(
        "trial {}: {lost} ticks of the loop did not reach the score",
        "trial {}: {lost} ticks of the loop did not reach the score",
        trial.number
    )
}

/// The recording of a trial has a hole or an early end.
pub(in crate::console) fn record_failed(why: &str) -> String {
    told!("The recording of the trial is not whole: {why}", "The recording of the trial is not whole: {why}")
}

/// A trial by its number.
pub(in crate::console) fn of_trial(number: u32) -> String {
    told!("Trial {number}", "Trial {number}")
}
