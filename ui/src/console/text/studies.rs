//! User studies: the list, the form of a new one, the experimenter's page, trials and questionnaires.

use std::path::Path;

use nima_score::{LEAST_TRIALS, LearningCurve, Shape};
use nima_user_study::{Comparison, Done, Excludes, Label, Phase, Questionnaire, Step, TrialId};

use crate::language::{Text, told, word};

pub(in crate::console) const OPEN: Text = Text::of("User studies", "Nutzerstudien");
pub(in crate::console) const OPEN_HOVER: Text =
    Text::of("Make a study, or go on with one. F8", "Studie anlegen oder fortsetzen. F8");
pub(in crate::console) const BACK: Text = Text::of("Back", "Zurück");
pub(in crate::console) const NEW: Text = Text::of("New study", "Neue Studie");
pub(in crate::console) const YOURS: Text = Text::of("Studies", "Studien");
pub(in crate::console) const YOURS_HOVER: Text = Text::of(
    "Those in your data folder, and others that were opened here before",
    "Die im Datenordner und andere, die hier schon geöffnet waren",
);
pub(in crate::console) const NONE: Text = Text::of("There is none yet: make one", "Noch keine: eine anlegen");
pub(in crate::console) const OPEN_THIS: Text = Text::of("Open", "Öffnen");
pub(in crate::console) const OTHER: Text = Text::of("Another study", "Andere Studie");
pub(in crate::console) const OTHER_FOLDER: Text = Text::of("Its folder", "Ihr Ordner");
pub(in crate::console) const OTHER_OPEN: Text = Text::of("Open this folder", "Diesen Ordner öffnen");
pub(in crate::console) const NO_FOLDER: Text = Text::of(
    "There is no folder for your files: set NIMA_DATA_DIR",
    "Kein Ordner für Ihre Dateien: NIMA_DATA_DIR setzen",
);
pub(in crate::console) const NOT_OVER_A_LINE: Text = Text::of(
    "A study needs arm and handle at this machine, because it sets the delay itself",
    "Eine Studie braucht Arm und Handgerät an diesem Rechner, weil sie die Verzögerung selbst einstellt",
);

pub(in crate::console) const READY: Text = Text::of("Begin with a ready study", "Mit fertiger Studie beginnen");
pub(in crate::console) const READY_HOVER: Text = Text::of(
    "Everything comes from it, and all that is below can be changed",
    "Alles kommt aus ihr und ist unten änderbar",
);
pub(in crate::console) const WHAT: Text = Text::of("Study", "Studie");
pub(in crate::console) const WHAT_HOVER: Text = Text::of(
    "Everybody reads the name, so it must not tell what is compared",
    "Alle lesen den Namen; er darf nicht verraten, was verglichen wird",
);
pub(in crate::console) const NAME: Text = Text::of("Name", "Name");
pub(in crate::console) const PARTICIPANTS: Text = Text::of("Participants", "Versuchspersonen");
pub(in crate::console) const TRIALS: Text = Text::of("Trials of each condition", "Versuche je Bedingung");
pub(in crate::console) const RIG: Text = Text::of("Rig", "Aufbau");
pub(in crate::console) const BLIND: Text = Text::of(
    "Blind: nobody sees the conditions before the unblinding",
    "Verblindet: vor der Entblindung sieht niemand die Bedingungen",
);
pub(in crate::console) const RECORD: Text =
    Text::of("Record every trial (about 36 MB a minute)", "Jeden Versuch aufzeichnen (etwa 36 MB pro Minute)");
pub(in crate::console) const INTERRUPTED: Text = Text::of("An interrupted trial", "Ein unterbrochener Versuch");
pub(in crate::console) const REPEATED: Text = Text::of("is done again", "wird wiederholt");
pub(in crate::console) const SKIPPED: Text = Text::of("has no result", "hat kein Ergebnis");
pub(in crate::console) const ATTEMPTS: Text = Text::of("Attempts at a trial", "Anläufe je Versuch");
pub(in crate::console) const CONDITIONS: Text = Text::of("Conditions", "Bedingungen");
pub(in crate::console) const CONDITIONS_HOVER: Text = Text::of(
    "What is compared. Afterwards they are called A, B and so on, in an order that nobody chooses.",
    "Was verglichen wird. Danach heißen sie A, B und so weiter, in einer Reihenfolge, die niemand wählt.",
);
pub(in crate::console) const FEEDBACK: Text = Text::of("Force", "Kraft");
pub(in crate::console) const NO_FORCE: Text = Text::of("No force", "Keine Kraft");
pub(in crate::console) const GAIN: Text = Text::of("Gain", "Verstärkung");
pub(in crate::console) const NO_GAIN: Text = Text::of("none", "keine");
pub(in crate::console) const DELAY: Text = Text::of("Delay", "Verzögerung");
pub(in crate::console) const REMOVE: Text = Text::of("Remove", "Entfernen");
pub(in crate::console) const ADD: Text = Text::of("Add a condition", "Weitere Bedingung");
pub(in crate::console) const NEW_CONDITION: Text = Text::of("New condition", "Neue Bedingung");
pub(in crate::console) const REFERENCE: Text = Text::of("The others are compared with", "Die anderen im Vergleich mit");
pub(in crate::console) const FIRST_LABEL: Text = Text::of("condition A", "Bedingung A");
pub(in crate::console) const TASK: Text = Text::of("Task", "Aufgabe");
pub(in crate::console) const TASK_HOVER: Text =
    Text::of("What the participant does in each trial", "Was die Versuchsperson in jedem Versuch tut");
pub(in crate::console) const SCENE: Text = Text::of("Scene", "Szene");
pub(in crate::console) const LIMIT: Text = Text::of("A trial is over after", "Ein Versuch endet nach");
pub(in crate::console) const FEW_RINGS: Text = Text::of("Only some of its rings", "Nur einige der Ringe");
pub(in crate::console) const RINGS: Text = Text::of("Rings", "Ringe");
pub(in crate::console) const MEASURES: Text = Text::of("Measures", "Zielgrößen");
pub(in crate::console) const MEASURES_HOVER: Text = Text::of(
    "The primary one decides, and is chosen before the first trial; the others are for the report",
    "Die primäre entscheidet und steht vor dem ersten Versuch fest; die anderen sind für den Bericht",
);
pub(in crate::console) const PRIMARY: Text = Text::of("Primary measure", "Primäre Zielgröße");
pub(in crate::console) const SECONDARY: Text = Text::of("Secondary measures", "Sekundäre Zielgrößen");
pub(in crate::console) const ADD_MEASURE: Text = Text::of("Add a measure", "Weitere Zielgröße");
pub(in crate::console) const EXCLUSION: Text = Text::of("Left out of the analysis", "Ausschluss aus der Auswertung");
pub(in crate::console) const EXCLUSION_HOVER: Text = Text::of(
    "Rules that are fixed before the first trial; what they leave out stands in the report with its rule",
    "Regeln, die vor dem ersten Versuch feststehen; was sie ausschließen, steht mit der Regel im Bericht",
);
pub(in crate::console) const NO_RULES: Text =
    Text::of("No rule: every trial with a result counts", "Keine Regel: jeder Versuch mit Ergebnis zählt");
pub(in crate::console) const ADD_RULE: Text = Text::of("Add a rule", "Weitere Regel");
pub(in crate::console) const MEASURE: Text = Text::of("Measure", "Zielgröße");
pub(in crate::console) const IS: Text = Text::of("is", "ist");
pub(in crate::console) const LIMIT_OF: Text = Text::of("Limit", "Grenze");
pub(in crate::console) const LEFT_OUT: Text = Text::of("leaves out", "schließt aus");
pub(in crate::console) const FROM: Text = Text::of("from so many times on", "ab so vielen Malen");
pub(in crate::console) const TIMES: Text = Text::of(" times", " Mal");
pub(in crate::console) const PRACTICE: Text = Text::of("Practice", "Übung");
pub(in crate::console) const PRACTICE_HOVER: Text = Text::of(
    "Trials before the first one that counts, until the criterion is met",
    "Versuche vor dem ersten zählenden, bis das Kriterium erfüllt ist",
);
pub(in crate::console) const PRACTISES: Text =
    Text::of("Practice before the first trial", "Übung vor dem ersten Versuch");
pub(in crate::console) const TIME: Text = Text::of("Done within", "Fertig binnen");
pub(in crate::console) const DROPS: Text = Text::of("Most drops out of view", "Max. außer Sicht gefallen");
pub(in crate::console) const IN_A_ROW: Text = Text::of("Such trials in a row", "Solche Versuche in Folge");
pub(in crate::console) const MORE: Text = Text::of("and so many more", "und so viele weitere");
pub(in crate::console) const MOST: Text = Text::of("Most trials of practice", "Max. Übungsversuche");
pub(in crate::console) const UNDER: Text = Text::of("Under", "Unter");
pub(in crate::console) const IN_TURN: Text = Text::of("each condition in turn", "jeder Bedingung reihum");
pub(in crate::console) const NOT_REACHED: Text = Text::of("Who does not get there", "Wer es nicht schafft,");
pub(in crate::console) const GOES_ON: Text = Text::of("goes on", "macht weiter");
pub(in crate::console) const EXCLUDED: Text = Text::of("is excluded", "wird ausgeschlossen");
pub(in crate::console) const BREAKS: Text = Text::of("Breaks", "Pausen");
pub(in crate::console) const BREAKS_HOVER: Text = Text::of("Trials of practice count too", "Übungsversuche zählen mit");
pub(in crate::console) const RESTS: Text = Text::of("Breaks between trials", "Pausen zwischen Versuchen");
pub(in crate::console) const EVERY: Text = Text::of("After so many trials", "Nach so vielen Versuchen");
pub(in crate::console) const LEAST: Text = Text::of("For at least", "Mindestdauer");
pub(in crate::console) const QUESTIONNAIRES: Text = Text::of("Questionnaires", "Fragebögen");
pub(in crate::console) const QUESTIONNAIRES_HOVER: Text = Text::of(
    "Published ones with their scores, and two of our own",
    "Publizierte mit ihrer Auswertung und zwei eigene",
);
pub(in crate::console) const AFTER_EACH: Text = Text::of("After each condition", "Nach jeder Bedingung");
pub(in crate::console) const AT_END: Text = Text::of("At the end", "Am Ende");
pub(in crate::console) const MAKE: Text = Text::of("Make the study", "Studie anlegen");
pub(in crate::console) const MAKE_HOVER: Text = Text::of(
    "Draws orders and labels, and seals what each label stands for",
    "Zieht Reihenfolgen und Labels zufällig und versiegelt, wofür jedes Label steht",
);

pub(in crate::console) const CLOSE: Text = Text::of("Close the study", "Studie schließen");
pub(in crate::console) const CLOSE_HOVER: Text =
    Text::of("Nothing is lost: it goes on from here another time", "Nichts geht verloren: sie geht später hier weiter");
pub(in crate::console) const WHO: Text = Text::of("Participants", "Versuchspersonen");
pub(in crate::console) const WHO_HOVER: Text =
    Text::of("Pseudonyms; who is who must not stand here", "Pseudonyme; wer wer ist, darf hier nicht stehen");
pub(in crate::console) const NEXT_STEP: Text = Text::of("Next step", "Als Nächstes");
pub(in crate::console) const NEXT_STEP_HOVER: Text =
    Text::of("What the study asks of this participant now", "Was jetzt für diese Versuchsperson ansteht");
pub(in crate::console) const HAND: Text = Text::of("Moved by", "Bewegt durch");
pub(in crate::console) const BY_MOUSE: Text = Text::of("the mouse", "die Maus");
pub(in crate::console) const BY_SIMULATED: Text = Text::of("a simulated hand", "simulierte Hand");
pub(in crate::console) const BY_RIG: Text = Text::of("the handle of the rig", "das Handgerät des Aufbaus");
pub(in crate::console) const BY_SIMULATED_HOVER: Text = Text::of(
    "For trying out: the trial is marked as simulated",
    "Zum Ausprobieren: der Versuch wird als simuliert \
     markiert",
);
pub(in crate::console) const STARTING: Text =
    Text::of("The rig of the study is starting", "Der Aufbau der Studie startet");
pub(in crate::console) const NOT_STARTED: Text =
    Text::of("The rig of the study did not start", "Der Aufbau der Studie ist nicht gestartet");
pub(in crate::console) const LEARNING: Text = Text::of("Learning", "Lernen");
pub(in crate::console) const LEARNING_HOVER: Text = Text::of(
    "Time of every completed trial, in order, whatever its condition: rings are practice, discs are trials that count",
    "Zeit jedes abgeschlossenen Versuchs, der Reihe nach, unabhängig von der Bedingung: Ringe sind Übung, Scheiben \
     zählende Versuche",
);
pub(in crate::console) const NO_TIMES: Text = Text::of("No trial was completed yet", "Noch kein Versuch abgeschlossen");
pub(in crate::console) const TRIAL_AXIS: Text = Text::of("trial", "Versuch");
pub(in crate::console) const TIME_AXIS: Text = Text::of("time (s)", "Zeit (s)");
pub(in crate::console) const NOTE: Text = Text::of("Note", "Notiz");
pub(in crate::console) const NOTE_HOVER: Text = Text::of(
    "Stands in the report; it must not tell who the participant is",
    "Steht im Bericht; darf nicht verraten, wer die Versuchsperson ist",
);
pub(in crate::console) const NOTE_FIELD: Text = Text::of("What happened", "Was geschah");
pub(in crate::console) const NOTE_KEEP: Text = Text::of("Keep the note", "Notiz speichern");
pub(in crate::console) const NOTE_KEPT: Text = Text::of("The note is kept", "Notiz gespeichert");
pub(in crate::console) const LEAVE_OUT: Text = Text::of("Leave out of the analysis", "Von der Auswertung ausschließen");
pub(in crate::console) const LEAVE_OUT_HOVER: Text = Text::of(
    "What was done stays in the journal; the reason stands in the report",
    "Was getan wurde, bleibt im Journal; der Grund steht im Bericht",
);
pub(in crate::console) const EVERYTHING: Text = Text::of("The participant", "Die Versuchsperson");
pub(in crate::console) const REASON: Text = Text::of("Reason", "Grund");
pub(in crate::console) const LEAVE_OUT_NOW: Text = Text::of("Leave it out", "Ausschließen");
pub(in crate::console) const ABOUT: Text = Text::of("Study", "Studie");
pub(in crate::console) const ABOUT_HOVER: Text =
    Text::of("What everybody may know of it", "Was alle davon wissen dürfen");
pub(in crate::console) const COMMITMENT: Text = Text::of("Commitment", "Prüfsumme");
pub(in crate::console) const COMMITMENT_HOVER: Text = Text::of(
    "BLAKE2b-256 of the sealed assignment. Keep it outside of the folder: it proves later that nobody changed the \
     assignment.",
    "BLAKE2b-256 der versiegelten Zuteilung. Außerhalb des Ordners aufbewahren: sie beweist später, dass niemand die \
     Zuteilung geändert hat.",
);
pub(in crate::console) const COPY: Text = Text::of("Copy the commitment", "Prüfsumme kopieren");
pub(in crate::console) const REPORT: Text = Text::of("Report", "Bericht");
pub(in crate::console) const REPORT_HOVER: Text = Text::of(
    "The whole analysis as one page; a study that is blind stays blind",
    "Die ganze Auswertung als eine Seite; eine verblindete Studie bleibt verblindet",
);
pub(in crate::console) const REPORT_WRITE: Text = Text::of("Write the report", "Bericht schreiben");
pub(in crate::console) const REPORT_WRITING: Text = Text::of("Writing the report", "Bericht wird geschrieben");
pub(in crate::console) const REPORT_OPEN: Text = Text::of("Open the report", "Bericht öffnen");
pub(in crate::console) const REPORT_NOT_OPENED: Text = Text::of(
    "No program of this desktop opens it: open the file report.html in the study's folder yourself",
    "Kein Programm des Desktops öffnet ihn: die Datei report.html im Ordner der Studie selbst öffnen",
);
pub(in crate::console) const UNBLINDING: Text = Text::of("Unblinding", "Entblindung");
pub(in crate::console) const UNBLINDING_HOVER: Text = Text::of(
    "Shows what each label stands for; name, reason and time are kept in the journal",
    "Zeigt, wofür jedes Label steht; Name, Grund und Zeit kommen ins Journal",
);
pub(in crate::console) const UNBLIND_NAME: Text = Text::of("Your name", "Ihr Name");
pub(in crate::console) const UNBLIND_WHY: Text = Text::of("Reason of the unblinding", "Grund der Entblindung");
pub(in crate::console) const UNBLIND: Text = Text::of("Unblind the study", "Studie entblinden");
pub(in crate::console) const UNBLIND_EARLY: Text = Text::of(
    "Not everybody has finished: trials after it are marked",
    "Noch nicht alle fertig: spätere Versuche werden markiert",
);
pub(in crate::console) const NOT_BLIND: Text = Text::of("The study is not blind", "Die Studie ist nicht verblindet");
pub(in crate::console) const SIMULATED: Text =
    Text::of("Simulated trials or answers are in it", "Enthält simulierte Versuche oder Antworten");

pub(in crate::console) const GIVE_UP: Text = Text::of("Give up this trial", "Versuch abbrechen");
pub(in crate::console) const GIVE_UP_HOVER: Text =
    Text::of("The study's rule says whether it is done again", "Ob er wiederholt wird, sagt die Regel der Studie");
pub(in crate::console) const GIVE_UP_NOW: Text = Text::of("Give up now?", "Jetzt abbrechen?");
pub(in crate::console) const STATE_STARTING: Text = Text::of("Starting", "Startet");
pub(in crate::console) const STATE_IDLE: Text = Text::of("Press Engage to begin", "Zum Beginnen koppeln");
pub(in crate::console) const STATE_HOLD: Text =
    Text::of("Hold the handle still until it has engaged", "Handgerät stillhalten, bis es gekoppelt ist");
pub(in crate::console) const STATE_STOPPED: Text = Text::of(
    "This trial is over: it was stopped. Press Release stop to go back.",
    "Dieser Versuch ist vorbei: er wurde angehalten. Halt lösen führt zurück.",
);
pub(in crate::console) const KEYS_SEARCH: Text =
    Text::of("X marks a place, D ends the trial", "X markiert eine Stelle, D beendet den Versuch");

pub(in crate::console) const BREAK: Text = Text::of("Break", "Pause");
pub(in crate::console) const BREAK_OVER: Text = Text::of("The break may end", "Die Pause darf enden");
pub(in crate::console) const BREAK_END: Text = Text::of("End the break", "Pause beenden");
pub(in crate::console) const BREAK_MAY_END: Text = Text::of("It may last longer", "Sie darf länger dauern");
pub(in crate::console) const BREAK_BACK: Text = Text::of(
    "Back: the break did not happen, and stays the next step",
    "Zurück: ohne Pause; sie bleibt der nächste Schritt",
);
pub(in crate::console) const BREAK_DONE: Text = Text::of("The break is over", "Die Pause ist vorbei");
pub(in crate::console) const SUBMIT: Text = Text::of("Submit", "Absenden");
pub(in crate::console) const SUBMITTED: Text = Text::of("The answers are kept", "Antworten gespeichert");
pub(in crate::console) const RATE: Text =
    Text::of("Click or drag on each line to rate it", "Zum Bewerten auf jede Linie klicken oder ziehen");
pub(in crate::console) const PAIRS: Text = Text::of(
    "Of each pair, choose what contributed more to the workload",
    "Aus jedem Paar wählen, was mehr zur Beanspruchung beitrug",
);
pub(in crate::console) const AGREE: [Text; 2] =
    [Text::of("Strongly disagree", "Stimme gar nicht zu"), Text::of("Strongly agree", "Stimme voll zu")];
pub(in crate::console) const FREE_TEXT: Text = Text::of("What do you want to tell us?", "Was möchten Sie uns sagen?");
pub(in crate::console) const FREE_TEXT_HINT: Text = Text::of("It may stay empty", "Darf leer bleiben");
pub(in crate::console) const NOT_ANSWERED: Text = Text::of("not yet", "noch nicht");

/// A ready study, by its name in commands.
pub(in crate::console) fn ready(name: &str) -> [&'static str; 2] {
    match name {
        "paper" => [
            word("Comparison of the paper", "Vergleich des Artikels"),
            word(
                "Peg transfer, 18 people, three conditions, 12 trials each and practice",
                "Peg-Transfer, 18 Personen, drei Bedingungen, je 12 Versuche und Übung",
            ),
        ],
        "short" => [
            word("Short, for trying out", "Kurz, zum Ausprobieren"),
            word(
                "Four people, two conditions, four trials of ten seconds",
                "Vier Personen, zwei Bedingungen, vier Versuche von zehn Sekunden",
            ),
        ],
        _ => [word("Study", "Studie"), ""],
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
    told!("{meaning} A click leaves it off.", "{meaning} Ein Klick nimmt sie weg.")
}

/// Name of the control of a rule, for those who do not see the table.
pub(in crate::console) fn of_rule(what: &str, number: usize) -> String {
    told!("Rule {number}: {what}", "Regel {number}: {what}")
}

/// How a rule compares.
pub(in crate::console) fn comparison(is: Comparison) -> &'static str {
    match is {
        Comparison::Above => word("above", "über"),
        Comparison::Below => word("below", "unter"),
        Comparison::Missing => word("missing", "fehlt"),
    }
}

/// What a rule leaves out.
pub(in crate::console) fn excludes(what: Excludes) -> &'static str {
    match what {
        Excludes::Trial => word("the trial", "den Versuch"),
        Excludes::Participant => word("the participant", "die Versuchsperson"),
    }
}

/// Whether the orders are balanced.
pub(in crate::console) fn balance(participants: usize, rows: usize) -> String {
    if rows > 0 && participants.is_multiple_of(rows) {
        told!(
            "Balanced: each order is there {} times",
            "Balanciert: jede Reihenfolge kommt {} Mal vor",
            participants / rows
        )
    } else {
        told!(
            "Not balanced: take a multiple of {rows} participants",
            "Nicht balanciert: ein Vielfaches von {rows} Versuchspersonen nehmen"
        )
    }
}

/// Where the new study will be.
pub(in crate::console) fn place(folder: &Path) -> String {
    told!("It will be in {}", "Sie liegt dann in {}", folder.display())
}

/// A study that was made.
pub(in crate::console) fn made(folder: &Path) -> String {
    told!(
        "Made: {}. Copy the commitment now and keep it elsewhere.",
        "Angelegt: {}. Jetzt die Prüfsumme kopieren und anderswo aufbewahren.",
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
        "{finished} von {participants} fertig, {results} Versuche, {blindness}"
    )
}

/// Whether it is blind, in a word.
pub(in crate::console) fn blindness(blind: bool, unblinded: bool) -> &'static str {
    match (blind, unblinded) {
        (false, _) => word("not blind", "nicht verblindet"),
        (true, false) => word("blind", "verblindet"),
        (true, true) => word("unblinded", "entblindet"),
    }
}

/// Name of a button in the list.
pub(in crate::console) fn open_named(name: &str) -> String {
    told!("Open {name}", "{name} öffnen")
}

/// A questionnaire.
pub(in crate::console) fn questionnaire(which: Questionnaire) -> &'static str {
    match which {
        Questionnaire::NasaTlx => word("NASA-TLX", "NASA-TLX"),
        Questionnaire::NasaTlxWeighted => word("NASA-TLX, weighted", "NASA-TLX, gewichtet"),
        Questionnaire::Sus => word("System usability scale", "System Usability Scale"),
        Questionnaire::Realism => word("Realism", "Realismus"),
        Questionnaire::FreeText => word("Remarks", "Anmerkungen"),
    }
}

/// Of whom a questionnaire is about, and about what.
pub(in crate::console) fn asked(which: Questionnaire, participant: &str, after: Option<Label>) -> String {
    let about = after.map_or_else(
        || word("the whole session", "die ganze Sitzung").to_owned(),
        |label| told!("condition {label}", "Bedingung {label}"),
    );
    told!("{}, {participant}, about {about}", "{}, {participant}, über {about}", questionnaire(which))
}

fn attempt(attempt: u32) -> String {
    if attempt > 1 { told!(", attempt {attempt}", ", Anlauf {attempt}") } else { String::new() }
}

/// What a participant does next; `trials` in all.
pub(in crate::console) fn next(step: &Step, trials: u32) -> String {
    match step {
        Step::Practice { number, attempt: nth } => {
            told!("Practice trial {number}{}", "Übungsversuch {number}{}", attempt(*nth))
        }
        Step::Trial { number, attempt: nth, label } => {
            told!(
                "Trial {number} of {trials}, condition {label}{}",
                "Versuch {number} von {trials}, Bedingung {label}{}",
                attempt(*nth)
            )
        }
        Step::Break { least_s } => told!("A break of at least {}", "Pause von mindestens {}", clock(*least_s)),
        Step::Questionnaire { questionnaire: which, after: Some(label) } => {
            told!("{} about condition {label}", "{} über Bedingung {label}", questionnaire(*which))
        }
        Step::Questionnaire { questionnaire: which, after: None } => {
            told!("{} at the end", "{} am Ende", questionnaire(*which))
        }
        Step::Running { trial } => told!("The end of trial {}", "Das Ende von Versuch {}", trial.number),
        Step::Done { why: Done::Finished } => word("Finished", "Fertig").to_owned(),
        Step::Done { why: Done::Excluded } => word("Excluded", "Ausgeschlossen").to_owned(),
    }
}

/// On the button of the next step; `None` if there is none.
pub(in crate::console) fn begin(step: &Step) -> Option<&'static str> {
    match step {
        Step::Practice { .. } => Some(word("Begin the practice trial", "Übungsversuch beginnen")),
        Step::Trial { .. } => Some(word("Begin the trial", "Versuch beginnen")),
        Step::Break { .. } => Some(word("Begin the break", "Pause beginnen")),
        Step::Questionnaire { .. } => Some(word("Fill in the questionnaire", "Fragebogen ausfüllen")),
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
    let lost = if lost > 0 { told!(" ({lost} without a result)", " ({lost} ohne Ergebnis)") } else { String::new() };
    told!(
        "Done: {practice} of practice, {trials} trials{lost}, {breaks} breaks, {interruptions} interruptions",
        "Erledigt: {practice} Übungsversuche, {trials} Versuche{lost}, {breaks} Pausen, {interruptions} Unterbrechungen"
    )
}

/// The order of a participant's labels.
pub(in crate::console) fn order(labels: &[Label]) -> String {
    let labels: Vec<String> = labels.iter().map(ToString::to_string).collect();
    told!("Order {}", "Reihenfolge {}", labels.join(" "))
}

/// The trial on the screen.
pub(in crate::console) fn trial(trial: TrialId, trials: u32, label: Option<Label>) -> String {
    let nth = attempt(trial.attempt);
    match (trial.phase, label) {
        (Phase::Trial, Some(label)) => told!(
            "Trial {} of {trials}{nth}, condition {label}",
            "Versuch {} von {trials}{nth}, Bedingung {label}",
            trial.number
        ),
        (Phase::Trial, None) => told!("Trial {} of {trials}{nth}", "Versuch {} von {trials}{nth}", trial.number),
        (Phase::Practice, _) => told!("Practice trial {}{nth}", "Übungsversuch {}{nth}", trial.number),
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
        "Bis sie enden darf; die Studie verlangt mindestens {}",
        clock(least_s)
    )
}

/// Time of a trial, of its limit.
pub(in crate::console) fn time_of(seconds: f64, limit_s: f64) -> String {
    told!("{} of {}", "{} von {}", clock(seconds), clock(limit_s))
}

/// What is missing in a questionnaire.
pub(in crate::console) fn missing(what: &[String]) -> String {
    told!("Missing: {}", "Es fehlt: {}", what.join(", "))
}

/// So many pairs were not compared.
pub(in crate::console) fn missing_pairs(count: usize) -> String {
    if count == 1 { word("1 pair", "1 Paar").to_owned() } else { told!("{count} pairs", "{count} Paare") }
}

/// A statement by its number.
pub(in crate::console) fn statement(number: usize) -> String {
    told!("statement {number}", "Aussage {number}")
}

/// Trials of a learning curve.
pub(in crate::console) fn curve(participant: &str, practice: usize, trials: usize) -> String {
    told!(
        "Learning of {participant}: {practice} trials of practice, {trials} trials completed",
        "Lernen von {participant}: {practice} Übungsversuche, {trials} Versuche abgeschlossen"
    )
}

/// What is drawn of them.
pub(in crate::console) fn curve_marks(curve: Option<&LearningCurve>) -> String {
    let marks = word("Rings: practice. Discs: trials that count.", "Ringe: Übung. Scheiben: zählende Versuche.");
    match curve {
        Some(curve) if curve.shape == Shape::Flat => {
            told!("{marks} Line: {:.0} s, no learning", "{marks} Linie: {:.0} s, kein Lernen", curve.asymptote_s)
        }
        Some(curve) => {
            let seen = if curve.plateau_seen {
                word("reached", "erreicht")
            } else {
                word("not reached yet", "noch nicht erreicht")
            };
            told!(
                "{marks} Line: fitted curve, plateau {:.0} s ({seen})",
                "{marks} Linie: angepasste Kurve, Plateau {:.0} s ({seen})",
                curve.asymptote_s
            )
        }
        None => told!(
            "{marks} A curve needs {LEAST_TRIALS} completed trials",
            "{marks} Eine Kurve braucht {LEAST_TRIALS} abgeschlossene Versuche"
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
        "Aufbau: {rig}\nFertig: {finished} von {participants}\nVersuche mit Ergebnis: {results}\nDie Studie ist {blind}"
    )
}

/// What was left out.
pub(in crate::console) fn left_out(participant: &str, trial: Option<u32>) -> String {
    trial.map_or_else(
        || told!("{participant} is left out", "{participant} ist ausgeschlossen"),
        |trial| told!("{participant}, trial {trial}: left out", "{participant}, Versuch {trial}: ausgeschlossen"),
    )
}

/// Who opened it, when and why.
pub(in crate::console) fn unblinded(who: &str, at: &str, why: &str) -> String {
    told!("Unblinded by {who} at {at}: {why}", "Entblindet von {who}, {at}: {why}")
}

/// A label and its condition.
pub(in crate::console) fn stands_for(label: Label, name: &str) -> String {
    format!("{label}: {name}")
}

/// Where the report is.
pub(in crate::console) fn report_written(page: &Path) -> String {
    told!("Written: {}", "Geschrieben: {}", page.display())
}

/// It was not written.
pub(in crate::console) fn report_failed(why: &str) -> String {
    told!("Not written: {why}", "Nicht geschrieben: {why}")
}

/// Ticks that did not reach the score, for the journal.
pub(in crate::console) fn note_lost(trial: TrialId, lost: u64) -> String {
    told!(
        "trial {}: {lost} ticks of the loop did not reach the score",
        "Versuch {}: {lost} Takte der Regelung fehlen in der Wertung",
        trial.number
    )
}

/// The recording of a trial has a hole or an early end.
pub(in crate::console) fn record_failed(why: &str) -> String {
    told!("The recording of the trial is not whole: {why}", "Die Aufzeichnung des Versuchs ist unvollständig: {why}")
}

/// A trial by its number.
pub(in crate::console) fn of_trial(number: u32) -> String {
    told!("Trial {number}", "Versuch {number}")
}
