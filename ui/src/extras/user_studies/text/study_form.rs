//! The form of a new study.

use std::path::Path;

use nima_user_study::{Excludes, MeasureComparison};
use nima_words::language::{Text, text_format, word};

pub(in crate::extras::user_studies) const READY: Text = Text::of("Start from a template", "Mit einer Vorlage beginnen");
pub(in crate::extras::user_studies) const READY_HOVER: Text = Text::of(
    "The template fills the whole form; you can change everything below",
    "Die Vorlage füllt das ganze Formular; alles darunter ist änderbar",
);
pub(in crate::extras::user_studies) const WHAT: Text = Text::of("Study", "Studie");
pub(in crate::extras::user_studies) const WHAT_HOVER: Text = Text::of(
    "Everyone reads the name, so it must not reveal what is compared",
    "Alle lesen den Namen; er darf nicht verraten, was verglichen wird",
);
pub(in crate::extras::user_studies) const NAME: Text = Text::of("Name", "Name");
pub(in crate::extras::user_studies) const PARTICIPANTS: Text = Text::of("Participants", "Versuchspersonen");
pub(in crate::extras::user_studies) const TRIALS: Text = Text::of("Trials per condition", "Versuche je Bedingung");
pub(in crate::extras::user_studies) const RIG: Text = Text::of("Rig", "Aufbau");
pub(in crate::extras::user_studies) const BLIND: Text = Text::of(
    "Blind: the conditions are hidden until unblinding",
    "Verblindet: die Bedingungen bleiben bis zur Entblindung verborgen",
);
pub(in crate::extras::user_studies) const RECORD: Text =
    Text::of("Record every trial (about 36 MB per minute)", "Jeden Versuch aufzeichnen (etwa 36 MB pro Minute)");
pub(in crate::extras::user_studies) const INTERRUPTED: Text =
    Text::of("An interrupted trial", "Ein unterbrochener Versuch");
pub(in crate::extras::user_studies) const REPEATED: Text = Text::of("is repeated", "wird wiederholt");
pub(in crate::extras::user_studies) const SKIPPED: Text = Text::of("has no result", "hat kein Ergebnis");
pub(in crate::extras::user_studies) const ATTEMPTS: Text = Text::of("Attempts per trial", "Anläufe je Versuch");
pub(in crate::extras::user_studies) const CONDITIONS: Text = Text::of("Conditions", "Bedingungen");
pub(in crate::extras::user_studies) const CONDITIONS_HOVER: Text = Text::of(
    "The conditions to compare. Later they are called A, B and so on, in random order.",
    "Die zu vergleichenden Bedingungen. Danach heißen sie A, B und so weiter, in zufälliger Reihenfolge.",
);
pub(in crate::extras::user_studies) const FEEDBACK: Text = Text::of("Force", "Kraft");
pub(in crate::extras::user_studies) const NO_FORCE: Text = Text::of("No force", "Keine Kraft");
pub(in crate::extras::user_studies) const GAIN: Text = Text::of("Gain", "Verstärkung");
pub(in crate::extras::user_studies) const NO_GAIN: Text = Text::of("none", "keine");
pub(in crate::extras::user_studies) const DELAY: Text = Text::of("Delay", "Verzögerung");
pub(in crate::extras::user_studies) const REMOVE: Text = Text::of("Remove", "Entfernen");
pub(in crate::extras::user_studies) const ADD: Text = Text::of("Add condition", "Weitere Bedingung");
pub(in crate::extras::user_studies) const NEW_CONDITION: Text = Text::of("New condition", "Neue Bedingung");
pub(in crate::extras::user_studies) const REFERENCE: Text = Text::of("Reference condition", "Vergleichsbedingung");
pub(in crate::extras::user_studies) const FIRST_LABEL: Text = Text::of("condition A", "Bedingung A");
pub(in crate::extras::user_studies) const TASK: Text = Text::of("Task", "Aufgabe");
pub(in crate::extras::user_studies) const TASK_HOVER: Text =
    Text::of("What the participant does in each trial", "Was die Versuchsperson in jedem Versuch tut");
pub(in crate::extras::user_studies) const SCENE: Text = Text::of("Scene", "Szene");
pub(in crate::extras::user_studies) const LIMIT: Text = Text::of("Time limit of a trial", "Zeitgrenze eines Versuchs");
pub(in crate::extras::user_studies) const FEW_RINGS: Text = Text::of("Only some of the rings", "Nur einige der Ringe");
pub(in crate::extras::user_studies) const RINGS: Text = Text::of("Rings", "Ringe");
pub(in crate::extras::user_studies) const MEASURES: Text = Text::of("Measures", "Zielgrößen");
pub(in crate::extras::user_studies) const MEASURES_HOVER: Text = Text::of(
    "The primary measure decides and is fixed before the first trial; the others are for the report",
    "Die primäre entscheidet und steht vor dem ersten Versuch fest; die anderen sind für den Bericht",
);
pub(in crate::extras::user_studies) const PRIMARY: Text = Text::of("Primary measure", "Primäre Zielgröße");
pub(in crate::extras::user_studies) const SECONDARY: Text = Text::of("Secondary measures", "Sekundäre Zielgrößen");
pub(in crate::extras::user_studies) const ADD_MEASURE: Text = Text::of("Add measure", "Weitere Zielgröße");
pub(in crate::extras::user_studies) const EXCLUSION: Text =
    Text::of("Excluded from the analysis", "Ausschluss aus der Auswertung");
pub(in crate::extras::user_studies) const EXCLUSION_HOVER: Text = Text::of(
    "Rules fixed before the first trial; every exclusion appears in the report with its rule",
    "Regeln, die vor dem ersten Versuch feststehen; was sie ausschließen, steht mit der Regel im Bericht",
);
pub(in crate::extras::user_studies) const NO_RULES: Text =
    Text::of("No rule: every trial with a result counts", "Keine Regel: jeder Versuch mit Ergebnis zählt");
pub(in crate::extras::user_studies) const ADD_RULE: Text = Text::of("Add rule", "Weitere Regel");
pub(in crate::extras::user_studies) const MEASURE: Text = Text::of("Measure", "Zielgröße");
pub(in crate::extras::user_studies) const IS: Text = Text::of("is", "ist");
pub(in crate::extras::user_studies) const LIMIT_OF: Text = Text::of("Limit", "Grenze");
pub(in crate::extras::user_studies) const LEFT_OUT: Text = Text::of("excludes", "schließt aus");
pub(in crate::extras::user_studies) const FROM: Text = Text::of("at least this many times", "ab so vielen Malen");
pub(in crate::extras::user_studies) const TIMES: Text = Text::of(" times", " Mal");
pub(in crate::extras::user_studies) const PRACTICE: Text = Text::of("Practice", "Übung");
pub(in crate::extras::user_studies) const PRACTICE_HOVER: Text = Text::of(
    "Trials before the first counted trial, until the criterion is met",
    "Versuche vor dem ersten zählenden, bis das Kriterium erfüllt ist",
);
pub(in crate::extras::user_studies) const PRACTISES: Text =
    Text::of("Practice before the first trial", "Übung vor dem ersten Versuch");
pub(in crate::extras::user_studies) const TIME: Text = Text::of("Done within", "Fertig binnen");
pub(in crate::extras::user_studies) const DROPS: Text =
    Text::of("Maximum drops out of view", "Max. außer Sicht gefallen");
pub(in crate::extras::user_studies) const IN_A_ROW: Text = Text::of("Such trials in a row", "Solche Versuche in Folge");
pub(in crate::extras::user_studies) const MORE: Text = Text::of("plus this many more", "plus so viele weitere");
pub(in crate::extras::user_studies) const MAX: Text = Text::of("Maximum practice trials", "Max. Übungsversuche");
pub(in crate::extras::user_studies) const UNDER: Text = Text::of("Under", "Unter");
pub(in crate::extras::user_studies) const IN_TURN: Text = Text::of("each condition in turn", "jeder Bedingung reihum");
pub(in crate::extras::user_studies) const NOT_REACHED: Text =
    Text::of("Participants who fail", "Wer das Kriterium verfehlt,");
pub(in crate::extras::user_studies) const GOES_ON: Text = Text::of("continue", "macht weiter");
pub(in crate::extras::user_studies) const EXCLUDED: Text = Text::of("are excluded", "wird ausgeschlossen");
pub(in crate::extras::user_studies) const BREAKS: Text = Text::of("Breaks", "Pausen");
pub(in crate::extras::user_studies) const BREAKS_HOVER: Text =
    Text::of("Practice trials count too", "Übungsversuche zählen mit");
pub(in crate::extras::user_studies) const RESTS: Text = Text::of("Breaks between trials", "Pausen zwischen Versuchen");
pub(in crate::extras::user_studies) const EVERY: Text = Text::of("After this many trials", "Nach so vielen Versuchen");
pub(in crate::extras::user_studies) const MIN: Text = Text::of("Minimum duration", "Mindestdauer");
pub(in crate::extras::user_studies) const QUESTIONNAIRES: Text = Text::of("Questionnaires", "Fragebögen");
pub(in crate::extras::user_studies) const QUESTIONNAIRES_HOVER: Text = Text::of(
    "Published questionnaires with their scores, and two additional ones",
    "Publizierte mit ihrer Auswertung und zwei zusätzliche",
);
pub(in crate::extras::user_studies) const AFTER_EACH: Text = Text::of("After each condition", "Nach jeder Bedingung");
pub(in crate::extras::user_studies) const AT_END: Text = Text::of("At the end", "Am Ende");
pub(in crate::extras::user_studies) const MAKE: Text = Text::of("Create study", "Studie anlegen");
pub(in crate::extras::user_studies) const MAKE_HOVER: Text = Text::of(
    "Draws orders and labels at random, and seals the assignment of labels to conditions",
    "Zieht Reihenfolgen und Labels zufällig und versiegelt die Zuordnung der Labels zu Bedingungen",
);

/// Returns the name and description of a template, by its name on the command line.
pub(in crate::extras::user_studies) fn ready(name: &str) -> [&'static str; 2] {
    match name {
        "paper" => [
            word("Comparison from the paper", "Vergleich des Artikels"),
            word(
                "Peg transfer, 18 people, three conditions, 12 trials each, with practice",
                "Peg-Transfer, 18 Personen, drei Bedingungen, je 12 Versuche und Übung",
            ),
        ],
        "short" => [
            word("Short, to try it out", "Kurz, zum Ausprobieren"),
            word(
                "Four people, two conditions, four trials of ten seconds",
                "Vier Personen, zwei Bedingungen, vier Versuche von zehn Sekunden",
            ),
        ],
        _ => [word("Study", "Studie"), ""],
    }
}

pub(in crate::extras::user_studies) fn measure(key: &str, words: &str) -> String {
    format!("{key}: {}", words.trim_end_matches('.'))
}

/// Returns the label of the button that removes a secondary measure.
pub(in crate::extras::user_studies) fn leave_off(key: &str) -> String {
    format!("{key} \u{00d7}")
}

pub(in crate::extras::user_studies) fn leave_off_hover(meaning: &str) -> String {
    text_format!("{meaning} Click to remove it.", "{meaning} Klick entfernt sie.")
}

/// Returns the accessible name of the control of a rule.
pub(in crate::extras::user_studies) fn of_rule(what: &str, number: usize) -> String {
    text_format!("Rule {number}: {what}", "Regel {number}: {what}")
}

pub(in crate::extras::user_studies) fn comparison(is: MeasureComparison) -> &'static str {
    match is {
        MeasureComparison::Above => word("above", "über"),
        MeasureComparison::Below => word("below", "unter"),
        MeasureComparison::Missing => word("missing", "fehlt"),
    }
}

pub(in crate::extras::user_studies) fn excludes(what: Excludes) -> &'static str {
    match what {
        Excludes::Trial => word("the trial", "den Versuch"),
        Excludes::Participant => word("the participant", "die Versuchsperson"),
    }
}

pub(in crate::extras::user_studies) fn balance(participants: usize, rows: usize) -> String {
    if rows > 0 && participants.is_multiple_of(rows) {
        text_format!(
            "Balanced: each order occurs {} times",
            "Balanciert: jede Reihenfolge kommt {} Mal vor",
            participants / rows
        )
    } else {
        text_format!(
            "Not balanced: use a multiple of {rows} participants",
            "Nicht balanciert: ein Vielfaches von {rows} Versuchspersonen nehmen"
        )
    }
}

pub(in crate::extras::user_studies) fn place(folder: &Path) -> String {
    text_format!("The study will be created in {}", "Die Studie wird angelegt in {}", folder.display())
}

pub(in crate::extras::user_studies) fn made(folder: &Path) -> String {
    text_format!(
        "Created: {}. Copy the commitment now and keep it elsewhere.",
        "Angelegt: {}. Jetzt die Prüfsumme kopieren und anderswo aufbewahren.",
        folder.display()
    )
}

/// Returns the accessible name of the control of a condition.
pub(in crate::extras::user_studies) fn of_condition(what: &str, number: usize) -> String {
    format!("{what} {number}")
}
