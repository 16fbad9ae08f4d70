//! Questionnaires of a study.

use nima_user_study::{Label, Questionnaire};
use nima_words::language::{Text, text_format, word};

pub(in crate::extras::user_studies) const SUBMIT: Text = Text::of("Submit", "Absenden");
pub(in crate::extras::user_studies) const SUBMITTED: Text = Text::of("Answers saved", "Antworten gespeichert");
pub(in crate::extras::user_studies) const RATE: Text =
    Text::of("Click or drag on each line to rate it", "Zum Bewerten auf jede Linie klicken oder ziehen");
pub(in crate::extras::user_studies) const PAIRS: Text = Text::of(
    "In each pair, choose the item that contributed more to the workload",
    "Aus jedem Paar wählen, was mehr zur Beanspruchung beitrug",
);
pub(in crate::extras::user_studies) const AGREE: [Text; 2] =
    [Text::of("Strongly disagree", "Stimme gar nicht zu"), Text::of("Strongly agree", "Stimme voll zu")];
pub(in crate::extras::user_studies) const FREE_TEXT: Text =
    Text::of("What would you like to tell us?", "Was möchten Sie uns sagen?");
pub(in crate::extras::user_studies) const FREE_TEXT_HINT: Text = Text::of("May be left empty", "Darf leer bleiben");
pub(in crate::extras::user_studies) const NOT_ANSWERED: Text = Text::of("not yet", "noch nicht");

pub(in crate::extras::user_studies) fn questionnaire(which: Questionnaire) -> &'static str {
    match which {
        Questionnaire::NasaTlx => word("NASA-TLX", "NASA-TLX"),
        Questionnaire::NasaTlxWeighted => word("NASA-TLX, weighted", "NASA-TLX, gewichtet"),
        Questionnaire::Sus => word("System usability scale", "System Usability Scale"),
        Questionnaire::Realism => word("Realism", "Realismus"),
        Questionnaire::FreeText => word("Remarks", "Anmerkungen"),
    }
}

pub(in crate::extras::user_studies) fn asked(which: Questionnaire, participant: &str, after: Option<Label>) -> String {
    let about = after.map_or_else(
        || word("the whole session", "die ganze Sitzung").to_owned(),
        |label| text_format!("condition {label}", "Bedingung {label}"),
    );
    text_format!("{}, {participant}, about {about}", "{}, {participant}, über {about}", questionnaire(which))
}

pub(in crate::extras::user_studies) fn missing(what: &[String]) -> String {
    text_format!("Missing: {}", "Es fehlt: {}", what.join(", "))
}

pub(in crate::extras::user_studies) fn missing_pairs(count: usize) -> String {
    if count == 1 { word("1 pair", "1 Paar").to_owned() } else { text_format!("{count} pairs", "{count} Paare") }
}

pub(in crate::extras::user_studies) fn statement(number: usize) -> String {
    text_format!("statement {number}", "Aussage {number}")
}
