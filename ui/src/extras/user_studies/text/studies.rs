//! User studies: the list, the experimenter's page and trials.

use std::path::Path;

use nima_score::{CurveShape, LearningCurve, MIN_TRIALS};
use nima_user_study::{EndReason, Label, StudyStep, TrialId, TrialPhase};
use nima_words::language::{Text, text_format, word};

use super::questionnaires::questionnaire;

pub(in crate::extras::user_studies) const OPEN: Text = Text::of("User studies", "Nutzerstudien");
pub(in crate::extras::user_studies) const OPEN_HOVER: Text =
    Text::of("Create or continue a study. F8", "Studie anlegen oder fortsetzen. F8");
pub(in crate::extras::user_studies) const BACK: Text = Text::of("Back", "Zurück");
pub(in crate::extras::user_studies) const NEW: Text = Text::of("New study", "Neue Studie");
pub(in crate::extras::user_studies) const YOURS: Text = Text::of("Studies", "Studien");
pub(in crate::extras::user_studies) const YOURS_HOVER: Text = Text::of(
    "Studies in your data folder, and others that were opened here before",
    "Die im Datenordner und andere, die hier schon geöffnet waren",
);
pub(in crate::extras::user_studies) const NONE: Text = Text::of("No study yet: create one", "Noch keine: eine anlegen");
pub(in crate::extras::user_studies) const OPEN_THIS: Text = Text::of("Open", "Öffnen");
pub(in crate::extras::user_studies) const OTHER: Text = Text::of("Another study", "Andere Studie");
pub(in crate::extras::user_studies) const OTHER_FOLDER: Text = Text::of("Study folder", "Ordner der Studie");
pub(in crate::extras::user_studies) const OTHER_OPEN: Text = Text::of("Open this folder", "Diesen Ordner öffnen");
pub(in crate::extras::user_studies) const NO_FOLDER: Text =
    Text::of("No data folder was found: set NIMA_DATA_DIR", "Kein Datenordner gefunden: NIMA_DATA_DIR setzen");
pub(in crate::extras::user_studies) const NOT_OVER_A_LINE: Text = Text::of(
    "A study needs arm and handle on this machine, because it sets the delay itself",
    "Eine Studie braucht Arm und Handgerät an diesem Rechner, weil sie die Verzögerung selbst einstellt",
);

pub(in crate::extras::user_studies) const CLOSE: Text = Text::of("Close the study", "Studie schließen");
pub(in crate::extras::user_studies) const CLOSE_HOVER: Text = Text::of(
    "Nothing is lost: you can continue the study from here later",
    "Nichts geht verloren: die Studie lässt sich später hier fortsetzen",
);
pub(in crate::extras::user_studies) const WHO: Text = Text::of("Participants", "Versuchspersonen");
pub(in crate::extras::user_studies) const WHO_HOVER: Text =
    Text::of("Pseudonyms only: do not enter real names here", "Nur Pseudonyme: hier keine echten Namen eintragen");
pub(in crate::extras::user_studies) const NEXT_STEP: Text = Text::of("Next step", "Als Nächstes");
pub(in crate::extras::user_studies) const NEXT_STEP_HOVER: Text =
    Text::of("What this participant does next", "Was jetzt für diese Versuchsperson ansteht");
pub(in crate::extras::user_studies) const HAND: Text = Text::of("Moved by", "Bewegt durch");
pub(in crate::extras::user_studies) const BY_MOUSE: Text = Text::of("the mouse", "die Maus");
pub(in crate::extras::user_studies) const BY_SIMULATED: Text = Text::of("a simulated hand", "simulierte Hand");
pub(in crate::extras::user_studies) const BY_RIG: Text = Text::of("the handle of the rig", "das Handgerät des Aufbaus");
pub(in crate::extras::user_studies) const BY_SIMULATED_HOVER: Text = Text::of(
    "To try the study out: the trial is marked as simulated",
    "Zum Ausprobieren: der Versuch wird als simuliert \
     markiert",
);
pub(in crate::extras::user_studies) const STARTING: Text =
    Text::of("The rig of the study is starting", "Der Aufbau der Studie startet");
pub(in crate::extras::user_studies) const NOT_STARTED: Text =
    Text::of("The rig of the study did not start", "Der Aufbau der Studie ist nicht gestartet");
pub(in crate::extras::user_studies) const LEARNING: Text = Text::of("Learning", "Lernen");
pub(in crate::extras::user_studies) const LEARNING_HOVER: Text = Text::of(
    "Time of every completed trial, in order, for all conditions: rings are practice, discs are trials that count",
    "Zeit jedes abgeschlossenen Versuchs, der Reihe nach, unabhängig von der Bedingung: Ringe sind Übung, Scheiben \
     zählende Versuche",
);
pub(in crate::extras::user_studies) const NO_TIMES: Text =
    Text::of("No trial completed yet", "Noch kein Versuch abgeschlossen");
pub(in crate::extras::user_studies) const TRIAL_AXIS: Text = Text::of("trial", "Versuch");
pub(in crate::extras::user_studies) const TIME_AXIS: Text = Text::of("time (s)", "Zeit (s)");
pub(in crate::extras::user_studies) const NOTE: Text = Text::of("Note", "Notiz");
pub(in crate::extras::user_studies) const NOTE_HOVER: Text = Text::of(
    "Appears in the report; it must not identify the participant",
    "Erscheint im Bericht; darf die Versuchsperson nicht identifizieren",
);
pub(in crate::extras::user_studies) const NOTE_FIELD: Text = Text::of("What happened", "Was geschah");
pub(in crate::extras::user_studies) const NOTE_KEEP: Text = Text::of("Save note", "Notiz speichern");
pub(in crate::extras::user_studies) const NOTE_KEPT: Text = Text::of("Note saved", "Notiz gespeichert");
pub(in crate::extras::user_studies) const LEAVE_OUT: Text =
    Text::of("Exclude from the analysis", "Von der Auswertung ausschließen");
pub(in crate::extras::user_studies) const LEAVE_OUT_HOVER: Text = Text::of(
    "The data stay in the journal; the reason appears in the report",
    "Die Daten bleiben im Journal; der Grund erscheint im Bericht",
);
pub(in crate::extras::user_studies) const EVERYTHING: Text = Text::of("The participant", "Die Versuchsperson");
pub(in crate::extras::user_studies) const REASON: Text = Text::of("Reason", "Grund");
pub(in crate::extras::user_studies) const LEAVE_OUT_NOW: Text = Text::of("Exclude", "Ausschließen");
pub(in crate::extras::user_studies) const ABOUT: Text = Text::of("Study", "Studie");
pub(in crate::extras::user_studies) const ABOUT_HOVER: Text =
    Text::of("Public information about the study", "Was alle davon wissen dürfen");
pub(in crate::extras::user_studies) const COMMITMENT: Text = Text::of("Commitment", "Prüfsumme");
pub(in crate::extras::user_studies) const COMMITMENT_HOVER: Text = Text::of(
    "BLAKE2b-256 of the sealed assignment. Keep it outside the folder: it proves later that the assignment was \
     not changed.",
    "BLAKE2b-256 der versiegelten Zuteilung. Außerhalb des Ordners aufbewahren: sie beweist später, dass niemand die \
     Zuteilung geändert hat.",
);
pub(in crate::extras::user_studies) const COPY: Text = Text::of("Copy the commitment", "Prüfsumme kopieren");
pub(in crate::extras::user_studies) const REPORT: Text = Text::of("Report", "Bericht");
pub(in crate::extras::user_studies) const REPORT_HOVER: Text = Text::of(
    "The whole analysis on one page; a blind study stays blind",
    "Die ganze Auswertung als eine Seite; eine verblindete Studie bleibt verblindet",
);
pub(in crate::extras::user_studies) const REPORT_WRITE: Text = Text::of("Write the report", "Bericht schreiben");
pub(in crate::extras::user_studies) const REPORT_WRITING: Text =
    Text::of("Writing the report", "Bericht wird geschrieben");
pub(in crate::extras::user_studies) const REPORT_OPEN: Text = Text::of("Open the report", "Bericht öffnen");
pub(in crate::extras::user_studies) const REPORT_NOT_OPENED: Text = Text::of(
    "No program on this desktop can open the report: open the file report.html in the study folder yourself",
    "Kein Programm des Desktops öffnet ihn: die Datei report.html im Ordner der Studie selbst öffnen",
);
pub(in crate::extras::user_studies) const UNBLINDING: Text = Text::of("Unblinding", "Entblindung");
pub(in crate::extras::user_studies) const UNBLINDING_HOVER: Text = Text::of(
    "Shows the condition behind each label; name, reason and time are saved in the journal",
    "Zeigt, wofür jedes Label steht; Name, Grund und Zeit kommen ins Journal",
);
pub(in crate::extras::user_studies) const UNBLIND_NAME: Text = Text::of("Your name", "Ihr Name");
pub(in crate::extras::user_studies) const UNBLIND_WHY: Text =
    Text::of("Reason for unblinding", "Grund der Entblindung");
pub(in crate::extras::user_studies) const UNBLIND: Text = Text::of("Unblind the study", "Studie entblinden");
pub(in crate::extras::user_studies) const UNBLIND_EARLY: Text = Text::of(
    "Not all participants have finished: trials after unblinding are marked",
    "Noch nicht alle fertig: spätere Versuche werden markiert",
);
pub(in crate::extras::user_studies) const NOT_BLIND: Text =
    Text::of("The study is not blind", "Die Studie ist nicht verblindet");
pub(in crate::extras::user_studies) const SIMULATED: Text =
    Text::of("Contains simulated trials or answers", "Enthält simulierte Versuche oder Antworten");

pub(in crate::extras::user_studies) const GIVE_UP: Text = Text::of("Abort this trial", "Versuch abbrechen");
pub(in crate::extras::user_studies) const GIVE_UP_HOVER: Text = Text::of(
    "The rule of the study determines whether the trial is repeated",
    "Ob er wiederholt wird, sagt die Regel der Studie",
);
pub(in crate::extras::user_studies) const GIVE_UP_NOW: Text = Text::of("Abort now?", "Jetzt abbrechen?");
pub(in crate::extras::user_studies) const STATE_STARTING: Text = Text::of("Starting", "Startet");
pub(in crate::extras::user_studies) const STATE_IDLE: Text = Text::of("Press Engage to start", "Zum Beginnen koppeln");
pub(in crate::extras::user_studies) const STATE_HOLD: Text =
    Text::of("Hold the handle still until the arm has engaged", "Handgerät stillhalten, bis der Arm gekoppelt ist");
pub(in crate::extras::user_studies) const STATE_STOPPED: Text = Text::of(
    "This trial was stopped and is over. Press Release stop to go back.",
    "Dieser Versuch ist vorbei: er wurde angehalten. Halt lösen führt zurück.",
);
pub(in crate::extras::user_studies) const KEYS_SEARCH: Text =
    Text::of("X marks a place, D ends the trial", "X markiert eine Stelle, D beendet den Versuch");

pub(in crate::extras::user_studies) const BREAK: Text = Text::of("Break", "Pause");
pub(in crate::extras::user_studies) const BREAK_OVER: Text = Text::of("The break may end", "Die Pause darf enden");
pub(in crate::extras::user_studies) const BREAK_END: Text = Text::of("End the break", "Pause beenden");
pub(in crate::extras::user_studies) const BREAK_MAY_END: Text =
    Text::of("The break may last longer", "Sie darf länger dauern");
pub(in crate::extras::user_studies) const BREAK_BACK: Text = Text::of(
    "Back: does not count as a break; the break stays the next step",
    "Zurück: zählt nicht als Pause; die Pause bleibt der nächste Schritt",
);
pub(in crate::extras::user_studies) const BREAK_DONE: Text = Text::of("The break is over", "Die Pause ist vorbei");

pub(in crate::extras::user_studies) fn standing(
    finished: usize,
    participants: usize,
    results: usize,
    blindness: &str,
) -> String {
    text_format!(
        "{finished} of {participants} finished, {results} trials, {blindness}",
        "{finished} von {participants} fertig, {results} Versuche, {blindness}"
    )
}

pub(in crate::extras::user_studies) fn blindness(blind: bool, unblinded: bool) -> &'static str {
    match (blind, unblinded) {
        (false, _) => word("not blind", "nicht verblindet"),
        (true, false) => word("blind", "verblindet"),
        (true, true) => word("unblinded", "entblindet"),
    }
}

pub(in crate::extras::user_studies) fn open_named(name: &str) -> String {
    text_format!("Open {name}", "{name} öffnen")
}

fn attempt(attempt: u32) -> String {
    if attempt > 1 { text_format!(", attempt {attempt}", ", Anlauf {attempt}") } else { String::new() }
}

pub(in crate::extras::user_studies) fn next(step: &StudyStep, trials: u32) -> String {
    match step {
        StudyStep::Practice { number, attempt: nth } => {
            text_format!("Practice trial {number}{}", "Übungsversuch {number}{}", attempt(*nth))
        }
        StudyStep::Trial { number, attempt: nth, label } => {
            text_format!(
                "Trial {number} of {trials}, condition {label}{}",
                "Versuch {number} von {trials}, Bedingung {label}{}",
                attempt(*nth)
            )
        }
        StudyStep::Break { min_s } => text_format!("A break of at least {}", "Pause von mindestens {}", clock(*min_s)),
        StudyStep::Questionnaire { questionnaire: which, after: Some(label) } => {
            text_format!("{} about condition {label}", "{} über Bedingung {label}", questionnaire(*which))
        }
        StudyStep::Questionnaire { questionnaire: which, after: None } => {
            text_format!("{} at the end", "{} am Ende", questionnaire(*which))
        }
        StudyStep::Running { trial } => {
            text_format!("Waiting for the end of trial {}", "Warten auf das Ende von Versuch {}", trial.number)
        }
        StudyStep::Done { why: EndReason::Finished } => word("Finished", "Fertig").to_owned(),
        StudyStep::Done { why: EndReason::Excluded } => word("Excluded", "Ausgeschlossen").to_owned(),
    }
}

/// Returns the label of the button of the next step; `None` if the step has no button.
pub(in crate::extras::user_studies) fn begin(step: &StudyStep) -> Option<&'static str> {
    match step {
        StudyStep::Practice { .. } => Some(word("Start the practice trial", "Übungsversuch beginnen")),
        StudyStep::Trial { .. } => Some(word("Start the trial", "Versuch beginnen")),
        StudyStep::Break { .. } => Some(word("Start the break", "Pause beginnen")),
        StudyStep::Questionnaire { .. } => Some(word("Fill in the questionnaire", "Fragebogen ausfüllen")),
        StudyStep::Running { .. } | StudyStep::Done { .. } => None,
    }
}

pub(in crate::extras::user_studies) fn done(
    practice: usize,
    trials: usize,
    lost: usize,
    interruptions: u32,
    breaks: usize,
) -> String {
    let lost =
        if lost > 0 { text_format!(" ({lost} without a result)", " ({lost} ohne Ergebnis)") } else { String::new() };
    text_format!(
        "Done: {practice} practice trials, {trials} trials{lost}, {breaks} breaks, {interruptions} interruptions",
        "Erledigt: {practice} Übungsversuche, {trials} Versuche{lost}, {breaks} Pausen, {interruptions} Unterbrechungen"
    )
}

pub(in crate::extras::user_studies) fn order(labels: &[Label]) -> String {
    let labels: Vec<String> = labels.iter().map(ToString::to_string).collect();
    text_format!("Order {}", "Reihenfolge {}", labels.join(" "))
}

pub(in crate::extras::user_studies) fn trial(trial: TrialId, trials: u32, label: Option<Label>) -> String {
    let nth = attempt(trial.attempt);
    match (trial.phase, label) {
        (TrialPhase::Trial, Some(label)) => text_format!(
            "Trial {} of {trials}{nth}, condition {label}",
            "Versuch {} von {trials}{nth}, Bedingung {label}",
            trial.number
        ),
        (TrialPhase::Trial, None) => {
            text_format!("Trial {} of {trials}{nth}", "Versuch {} von {trials}{nth}", trial.number)
        }
        (TrialPhase::Practice, _) => text_format!("Practice trial {}{nth}", "Übungsversuch {}{nth}", trial.number),
    }
}

pub(in crate::extras::user_studies) fn clock(seconds: f64) -> String {
    let whole = if seconds.is_finite() { seconds.max(0.0) as u64 } else { 0 };
    format!("{}:{:02}", whole / 60, whole % 60)
}

pub(in crate::extras::user_studies) fn break_min(min_s: f64) -> String {
    text_format!(
        "Time until the break may end; the study requires at least {}",
        "Bis sie enden darf; die Studie verlangt mindestens {}",
        clock(min_s)
    )
}

pub(in crate::extras::user_studies) fn time_of(seconds: f64, limit_s: f64) -> String {
    text_format!("{} of {}", "{} von {}", clock(seconds), clock(limit_s))
}

pub(in crate::extras::user_studies) fn curve(participant: &str, practice: usize, trials: usize) -> String {
    text_format!(
        "Learning progress of {participant}: {practice} practice trials, {trials} trials completed",
        "Lernfortschritt von {participant}: {practice} Übungsversuche, {trials} Versuche abgeschlossen"
    )
}

pub(in crate::extras::user_studies) fn curve_marks(curve: Option<&LearningCurve>) -> String {
    let marks = word("Rings: practice. Discs: trials that count.", "Ringe: Übung. Scheiben: zählende Versuche.");
    match curve {
        Some(curve) if curve.shape == CurveShape::Flat => {
            text_format!("{marks} Line: {:.0} s, no learning", "{marks} Linie: {:.0} s, kein Lernen", curve.asymptote_s)
        }
        Some(curve) => {
            let seen = if curve.plateau_seen {
                word("reached", "erreicht")
            } else {
                word("not reached yet", "noch nicht erreicht")
            };
            text_format!(
                "{marks} Line: fitted curve, plateau {:.0} s ({seen})",
                "{marks} Linie: angepasste Kurve, Plateau {:.0} s ({seen})",
                curve.asymptote_s
            )
        }
        None => text_format!(
            "{marks} A curve needs {MIN_TRIALS} completed trials",
            "{marks} Eine Kurve braucht {MIN_TRIALS} abgeschlossene Versuche"
        ),
    }
}

pub(in crate::extras::user_studies) fn facts(
    rig: &str,
    finished: usize,
    participants: usize,
    results: usize,
    blind: &str,
) -> String {
    text_format!(
        "Rig: {rig}\nFinished: {finished} of {participants}\nTrials with a result: {results}\nThe study is {blind}",
        "Aufbau: {rig}\nFertig: {finished} von {participants}\nVersuche mit Ergebnis: {results}\nDie Studie ist {blind}"
    )
}

pub(in crate::extras::user_studies) fn left_out(participant: &str, trial: Option<u32>) -> String {
    trial.map_or_else(
        || text_format!("{participant}: excluded", "{participant}: ausgeschlossen"),
        |trial| {
            text_format!("{participant}, trial {trial}: excluded", "{participant}, Versuch {trial}: ausgeschlossen")
        },
    )
}

pub(in crate::extras::user_studies) fn unblinded(who: &str, at: &str, why: &str) -> String {
    text_format!("Unblinded by {who} at {at}: {why}", "Entblindet von {who}, {at}: {why}")
}

pub(in crate::extras::user_studies) fn stands_for(label: Label, name: &str) -> String {
    format!("{label}: {name}")
}

pub(in crate::extras::user_studies) fn report_written(page: &Path) -> String {
    text_format!("Written: {}", "Geschrieben: {}", page.display())
}

pub(in crate::extras::user_studies) fn report_failed(why: &str) -> String {
    text_format!("Not written: {why}", "Nicht geschrieben: „{why}“")
}

/// Returns the journal entry.
pub(in crate::extras::user_studies) fn note_lost(trial: TrialId, lost: u64) -> String {
    text_format!(
        "trial {}: {lost} ticks of the loop are missing from the score",
        "Versuch {}: {lost} Takte der Regelung fehlen in der Wertung",
        trial.number
    )
}

pub(in crate::extras::user_studies) fn record_failed(why: &str) -> String {
    text_format!(
        "The recording of the trial is incomplete: {why}",
        "Die Aufzeichnung des Versuchs ist unvollständig: {why}"
    )
}

pub(in crate::extras::user_studies) fn of_trial(number: u32) -> String {
    text_format!("Trial {number}", "Versuch {number}")
}
