//! Every text of the window is in the sources in English and German. The compiler requires both; this test checks that the
//! German is German.

use std::path::{Path, PathBuf};

use crate::report_text::{has_text, literals, of_extras, sources};

/// Texts that are the same in both languages: names, abbreviations, terms that German engineers use unchanged.
const SAME: [&str; 30] = [
    "Alarm",
    "Ctrl ",
    "Ctrl Shift ",
    "Ctrl Tab",
    "Demo",
    "Ensemble",
    "Enter",
    "Gamma",
    "IMA, NIMA",
    "Jitter",
    "Kalman",
    "Layout",
    "Layout: {name}",
    "Linear",
    "Name",
    "Offset",
    "Panel: {name}",
    "Panels",
    "Pause",
    "Pose",
    "Rate",
    "Rec",
    "Sensor",
    "Sensor {sensor}, {tool}",
    "Servos",
    "Shift ",
    "Tab, Shift Tab",
    "Timing",
    "Training",
    "{panel} \\u{2013} NIMA Console",
];

/// Start of a pair of literals.
const BEGINNINGS: [&str; 3] = ["Text::of(", "word(", "text_format!("];

/// Returns the pairs in a source, with continued literals joined.
pub(crate) fn pairs(source: &str) -> Vec<[String; 2]> {
    let mut pairs = Vec::new();
    for beginning in BEGINNINGS {
        for (at, _) in source.match_indices(beginning) {
            let is_within_a_name = source[..at].ends_with(|letter: char| letter.is_alphanumeric() || letter == '_');
            let rest = &source[at + beginning.len()..];
            if let (false, Some((english, rest))) = (is_within_a_name, literal(rest)) {
                let rest = rest.trim_start().strip_prefix(',').unwrap_or_default();
                let (german, _) = literal(rest).unwrap_or_else(|| panic!("no German for \"{english}\""));
                pairs.push([english, german]);
            }
        }
    }
    pairs
}

/// Returns the string literal at the start of `source`, and the text after it.
fn literal(source: &str) -> Option<(String, &str)> {
    let rest = source.trim_start().strip_prefix('"')?;
    let mut escaped = false;
    let end = rest.find(|letter: char| {
        let ends = letter == '"' && !escaped;
        escaped = letter == '\\' && !escaped;
        ends
    })?;
    let lines: Vec<&str> = rest[..end].split("\\\n").collect();
    let joined = lines.iter().enumerate().map(|(i, line)| if i == 0 { line } else { line.trim_start() });
    Some((joined.collect(), &rest[end + 1..]))
}

/// Returns the modules of texts, without their tests.
fn modules() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("words/src");
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in ["text", "report_text"] {
        sources(&root.join(folder), &mut files);
    }
    for path in ["text", "report_text", "bridge_text", "link_text"].into_iter().flat_map(of_extras) {
        sources(&path, &mut files);
    }
    files.sort();
    let read = |path: PathBuf| {
        let source = std::fs::read_to_string(&path).unwrap();
        let source = source.split("#[cfg(test)]\nmod tests").next().unwrap_or_default().to_owned();
        (path, source)
    };
    files.into_iter().map(read).collect()
}

fn all_pairs() -> Vec<[String; 2]> {
    let all: Vec<_> = modules().iter().flat_map(|(_, source)| pairs(source)).collect();
    assert!(all.len() > 2000, "{} found", all.len());
    all
}

/// Returns the content of braces, sorted; a side after its noun is `after` in German, in lower case.
fn values(text: &str) -> Vec<String> {
    let plain = text.replace("{{", "").replace("}}", "");
    let plain = plain.replace("{side}", "{after}").replace("{arm}", "{after}");
    let mut values: Vec<String> =
        plain.split('{').skip(1).map(|part| part.split('}').next().unwrap_or_default().to_owned()).collect();
    values.sort();
    values
}

#[test]
fn no_text_is_left_in_english() {
    let wrong: Vec<_> = all_pairs()
        .into_iter()
        .filter(|[english, german]| english == german && has_text(english) && !SAME.contains(&english.as_str()))
        .collect();
    assert!(wrong.is_empty(), "translate these, or list them if they are the same on purpose: {wrong:#?}");
}

#[test]
fn what_is_listed_as_the_same_is_the_same_and_there() {
    let all = all_pairs();
    let stale: Vec<_> =
        SAME.iter().filter(|same| !all.iter().any(|[english, german]| english == *same && german == *same)).collect();
    assert!(stale.is_empty(), "{stale:?}");
}

#[test]
fn both_languages_tell_the_same_values() {
    let wrong: Vec<_> = all_pairs().into_iter().filter(|[english, german]| values(english) != values(german)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A text in only one language would compile if it were not in a pair.
#[test]
fn every_text_with_words_is_a_pair() {
    let mut wrong = Vec::new();
    for (path, source) in modules() {
        let plain = |text: &str| text.replace("\\\"", "").replace('\\', "");
        let known: Vec<String> = pairs(&source).concat().iter().map(|text| plain(text)).collect();
        for text in literals(&source) {
            let text = plain(&text);
            let is_known = known.iter().any(|known| known.contains(text.trim()));
            if has_text(&text) && !is_known {
                wrong.push((path.display().to_string(), text));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_pair_is_read_with_its_continued_lines() {
    let source = "let a = Text::of(\n    \"one \\\n     line\",\n    \"eine \\\"Zeile\\\"\",\n); fn text_format!(x: u8) {} sword(\"no\");";
    assert_eq!(pairs(source), [["one line".to_owned(), "eine \\\"Zeile\\\"".to_owned()]]);
    assert_eq!(values("{a:.1} of {} {{x}}"), ["", "a:.1"]);
}
