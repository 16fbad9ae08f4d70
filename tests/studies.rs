//! A study of short trials, and the search for text that a blind study must not reveal.

use std::{fs, path::Path};

/// Two conditions whose names and numbers occur nowhere else.
pub const BLIND: &str = "
[[conditions]]
name = 'Zebra'
mode = 'anchored'
gain = 0.8125
delay_ms = 137.5
[[conditions]]
name = 'Wildebeest'
no_force = true
";

/// Returns a study file in which the right hand touches tissue for this many seconds per trial.
pub fn study_file(head: &str, seconds: f64, conditions: &str) -> String {
    format!(
        "name = 'Touching'\nscene = 'peg_transfer'\nprimary = 'mean_force_n_right'\n{head}\n\
         [task]\nname = 'Touch'\nkind = 'free'\ntime_limit_s = {seconds:?}\n{conditions}"
    )
}

/// Returns the names and bytes of all files under a folder.
///
/// # Panics
/// If a file cannot be read.
pub fn everything(folder: &Path) -> String {
    let mut all = String::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        all += &path.file_name().unwrap().to_string_lossy();
        all += &if path.is_dir() {
            everything(&path)
        } else {
            String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned()
        };
    }
    all
}

/// Returns all words in a text, in lower case.
pub fn found_in<'a>(text: &str, words: &[&'a str]) -> Vec<&'a str> {
    let text = text.to_lowercase();
    words.iter().copied().filter(|word| text.contains(word)).collect()
}
