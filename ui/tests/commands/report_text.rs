//! The console's texts are in `ui/words/src/text/`, and those of an extra in its folder, so that a translation has few
//! places to work in. This test reads the sources and counts the literals with text everywhere else.

use std::path::{Path, PathBuf};

use crate::languages::pairs;

/// Literals with text that are not part of the screen, by file: errors on the terminal (`app/pace.rs`, `screenshot.rs`), a
/// driver's name (`renderer.rs`), a type's (`link.rs`) and shader source (`scene3d/gl.rs`). Any other file has none.
const LEFT: [(&str, usize); 5] = [
    ("src/console/app/frame_rate.rs", 1),
    ("screen/src/renderer.rs", 1),
    ("screen/src/link.rs", 1),
    ("screen/src/scene3d/gl.rs", 2),
    ("screen/src/screenshot.rs", 1),
];

/// Returns the file or folder of this name in each extra.
pub(crate) fn of_extras(name: &str) -> Vec<PathBuf> {
    let extras = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/extras");
    let folders = std::fs::read_dir(extras).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir());
    let paths = folders.flat_map(|folder| [folder.join(name), folder.join(format!("{name}.rs"))]);
    paths.filter(|path| path.exists()).collect()
}

/// The sources in this folder, or this source.
pub(crate) fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    if folder.is_file() {
        return files.push(folder.to_owned());
    }
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            if !["text", "tests"].contains(&path.file_name().unwrap().to_str().unwrap()) {
                sources(&path, files);
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") && path.file_name().unwrap() != "tests.rs"
        {
            files.push(path);
        }
    }
}

/// Returns the string literals of a source, without its comments, its attributes and its tests.
pub(crate) fn literals(source: &str) -> Vec<String> {
    let source = source.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let mut literals = Vec::new();
    for line in joined(source) {
        let mut parts = line.split('"');
        // Code and literals alternate.
        while let (Some(code), Some(literal)) = (parts.next(), parts.next()) {
            if code.contains("//") {
                break;
            }
            literals.push(literal.to_owned());
        }
    }
    literals
}

/// Returns the lines with continued literals joined, without attributes, comment lines, escaped quotes and quote
/// characters.
fn joined(source: &str) -> Vec<String> {
    let plain = source.replace("'\"'", "").replace("\\\"", "");
    let mut lines: Vec<String> = Vec::new();
    let mut open = false;
    for line in plain.lines().map(str::trim_start) {
        if !open && (line.starts_with("//") || line.starts_with("#[") || line.starts_with("#![")) {
            continue;
        }
        match lines.last_mut() {
            Some(last) if open => last.push_str(line),
            _ => lines.push(line.to_owned()),
        }
        open = lines.last().is_some_and(|line| line.matches('"').count() % 2 == 1);
    }
    lines
}

/// Returns whether it has two words, or one that starts a sentence; the content of braces does not count.
pub(crate) fn has_text(literal: &str) -> bool {
    let mut depth = 0_i32;
    let plain: String = literal
        .chars()
        .map(|letter| {
            depth += i32::from(letter == '{') - i32::from(letter == '}');
            if depth > 0 || letter == '}' { ' ' } else { letter }
        })
        .collect();
    let words: Vec<&str> = plain
        .split(|letter: char| letter.is_whitespace())
        .filter(|word| word.chars().filter(char::is_ascii_alphabetic).count() >= 3)
        .collect();
    let begins = words.iter().any(|word| {
        let mut letters = word.chars();
        letters.next().is_some_and(char::is_uppercase) && letters.take(2).all(char::is_lowercase)
    });
    words.len() >= 2 || begins
}

#[test]
fn every_sentence_is_in_the_text_modules() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["src/console", "screen/src", "wizards/src", "panels/src", "playback/src"] {
        sources(&root.join(folder), &mut files);
    }
    let shown = of_extras("screen");
    assert!(shown.len() >= 4, "{shown:?}");
    for path in &shown {
        sources(path, &mut files);
    }
    files.sort();
    let mut wrong = Vec::new();
    for path in &files {
        let name = path.strip_prefix(root).unwrap_or(path).to_str().unwrap().replace('\\', "/");
        let found: Vec<String> =
            literals(&std::fs::read_to_string(path).unwrap()).into_iter().filter(|literal| has_text(literal)).collect();
        let allowed = LEFT.iter().find(|(file, _)| *file == name).map_or(0, |(_, left)| *left);
        if found.len() != allowed {
            wrong.push(format!("(\"{name}\", {}), // {allowed} allowed: {found:?}", found.len()));
        }
    }
    assert!(
        wrong.is_empty(),
        "put new words into ui/words/src/text or the text of the extra, and lower the number where some have moved:\n{}",
        wrong.join("\n")
    );
}

/// Returns the name and texts, English and German, of every constant in `text/`.
fn constants() -> Vec<(String, [String; 2])> {
    let mut files = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("words/src/text"), &mut files);
    for path in of_extras("text") {
        sources(&path, &mut files);
    }
    let mut constants = Vec::new();
    for path in files {
        let source = std::fs::read_to_string(path).unwrap();
        for part in source.split("const ").skip(1) {
            let Some((name, rest)) = part.split_once(": Text =") else { continue };
            constants.push((name.to_owned(), pairs(rest).remove(0)));
        }
    }
    assert!(constants.len() > 400, "{} found", constants.len());
    constants
}

/// `ALARM_STALE_CAUSE`, not `THE_DATA_ARE`: a name must survive a new wording.
#[test]
fn a_constant_is_named_by_its_role() {
    let first_text = |name: &str, words: &str| {
        let words = words.to_uppercase();
        let words: Vec<&str> =
            words.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
        let parts: Vec<&str> = name.split('_').collect();
        parts.len() >= 3 && words.len() > parts.len() && words.starts_with(&parts)
    };
    let wrong: Vec<_> = constants().into_iter().filter(|(name, [words, _])| first_text(name, words)).collect();
    assert!(wrong.is_empty(), "{} named by their first words: {wrong:#?}", wrong.len());
}

#[test]
fn one_sentence_has_no_full_stop_and_more_is_an_ellipsis() {
    let several = |words: &str| [". ", "! ", "? ", ".) "].iter().any(|end| words.contains(end));
    let wrong: Vec<_> = constants()
        .into_iter()
        .flat_map(|(name, both)| both.map(|words| (name.clone(), words)))
        .filter(|(_, words)| words.contains("...") || (words.ends_with('.') && !several(words)))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn words_are_distinguished_from_formats() {
    for words in ["Stop", "press any key", "{} ticks of {total} late", "Acted on {acted}"] {
        assert!(has_text(words), "{words}");
    }
    for format in ["{:.1} N", "{}: {}", "top_bar", "us", "{force_n:.1} N, {a} x", "alarms"] {
        assert!(!has_text(format), "{format}");
    }
    let source =
        "// \"No words\"\n#[doc = \"No words\"]\nlet a = (\"Some words\", \"more \\\n  of them\"); // \"none here\"\n";
    assert_eq!(literals(source), ["Some words", "more \\of them"]);
}
