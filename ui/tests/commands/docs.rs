//! Checks the pages for users and contributors against the program: links lead somewhere, commands and flags exist, named
//! files exist, and the glossary has every gate, mode and state.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    process::Command,
};

use nima_core::{
    impedance::Mode,
    limits::{GAIN, GAIN_ABOVE_ONE, SLIDER_DELAY_S, USUAL_CEILING_N},
    safety::{ChainSettings, Gate, PLAUSIBLE_N},
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

/// Returns the path and text of every page.
fn pages() -> Vec<(PathBuf, String)> {
    let mut paths: Vec<PathBuf> = ["README.md", "CONTRIBUTING.md"].map(|name| root().join(name)).to_vec();
    for folder in ["docs", "docs/reference"] {
        let files = std::fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
        paths.extend(files.filter(|path| path.extension().is_some_and(|extension| extension == "md")));
    }
    // The site's list of pages names generated pages; another test checks it.
    paths.retain(|path| !path.ends_with("SUMMARY.md"));
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())).collect()
}

/// Returns the path and text of the pages that are linked, but are not in the site or become pages under another name.
fn pages_outside_the_site() -> Vec<(PathBuf, String)> {
    let mut paths: Vec<PathBuf> =
        ["ARCHITECTURE.md", "CHANGELOG.md", "python/README.md"].map(|name| root().join(name)).to_vec();
    for folder in ["docs/results", "docs/decisions"] {
        paths.extend(std::fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path()));
    }
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    paths.into_iter().map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())).collect()
}

/// Returns the anchor of a heading.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

/// Returns the parts between `open` and `close` on one line.
fn between<'a>(text: &'a str, open: &str, close: char) -> Vec<&'a str> {
    text.split(open).skip(1).filter_map(|rest| rest.split_once(close)).map(|(inside, _)| inside).collect()
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut wrong = Vec::new();
    for (page, text) in pages().into_iter().chain(pages_outside_the_site()) {
        for link in between(&text, "](", ')').into_iter().filter(|link| !link.contains("://")) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(file) };
            let found = target.exists()
                && (heading.is_empty()
                    || std::fs::read_to_string(&target)
                        .unwrap()
                        .lines()
                        .any(|line| line.starts_with('#') && anchor(line) == heading));
            if !found {
                wrong.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "links to nowhere:\n{}", wrong.join("\n"));
}

/// Every page of the folder is in the site, once.
#[test]
fn the_site_has_every_page() {
    let summary = std::fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    let listed = between(&summary, "](", ')');
    let outside = ["first-minute.md", "architecture.md", "contributing.md", "changelog.md"];
    let mut found: Vec<&str> = listed.iter().copied().filter(|page| !outside.contains(page)).collect();
    assert_eq!(listed.len() - found.len(), outside.len());
    let all = pages();
    let docs = root().join("docs");
    let mut pages: Vec<&str> = all.iter().filter_map(|(path, _)| path.strip_prefix(&docs).ok()?.to_str()).collect();
    found.sort_unstable();
    pages.sort_unstable();
    assert_eq!(found, pages);
}

/// Returns the commands in the pages: lines of code blocks and pieces of code in a sentence that begin with `nima`.
fn commands(text: &str) -> Vec<String> {
    let plain = text.replace("\\\n", " ");
    let lines = plain.lines().map(|line| line.split(" #").next().unwrap_or_default().trim());
    let blocks = lines.filter(|line| line.starts_with("nima ")).map(str::to_owned);
    let inline = plain.split('`').skip(1).step_by(2).filter(|code| code.starts_with("nima ")).map(str::to_owned);
    blocks.chain(inline).collect()
}

#[test]
fn every_command_and_flag_in_the_pages_exists() {
    let mut helps: HashMap<Vec<String>, Option<String>> = HashMap::new();
    let mut help = |words: &[String]| {
        let run = || {
            let output = Command::new(env!("CARGO_BIN_EXE_nima")).args(words).arg("--help").output().unwrap();
            output.status.success().then(|| String::from_utf8(output.stdout).unwrap())
        };
        helps.entry(words.to_vec()).or_insert_with(run).clone()
    };
    let mut wrong = Vec::new();
    let mut seen = 0;
    for (page, text) in pages() {
        for command in commands(&text) {
            let words: Vec<String> = command.split_whitespace().skip(1).map(str::to_owned).collect();
            // Another program has this command; its tests read the page.
            if words[0] == "department" {
                continue;
            }
            // These commands have a second word, such as `nima study faults`.
            let depth =
                if ["study", "train", "evaluate", "calibrate", "check", "user-study"].contains(&words[0].as_str()) {
                    2
                } else {
                    1
                };
            let named: Vec<String> =
                words.iter().take(depth).take_while(|word| !word.starts_with('-')).cloned().collect();
            if named.iter().any(|word| word.chars().any(char::is_uppercase)) {
                continue;
            }
            seen += 1;
            let Some(known) = help(&named) else {
                wrong.push(format!("{}: no command `{command}`", page.display()));
                continue;
            };
            for word in words {
                let flag: String =
                    word.trim_start_matches('[').chars().take_while(|c| c.is_alphanumeric() || *c == '-').collect();
                if flag.starts_with("--")
                    && flag != "--help"
                    && !known.contains(&format!("{flag} "))
                    && !known.contains(&format!("{flag}\n"))
                {
                    wrong.push(format!("{}: `{command}` has no {flag}", page.display()));
                }
            }
        }
    }
    assert!(seen > 40, "only {seen} commands were found in the pages");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_file_that_the_pages_name_is_there() {
    let mut wrong = Vec::new();
    for (page, text) in pages() {
        let pieces: Vec<&str> = text.split('`').collect();
        for (before, code) in pieces.iter().zip(&pieces[1..]).step_by(2) {
            let ours = ["src/", "ui/", "tests/", "benches/", "config/", "assets/", "docs/"]
                .iter()
                .any(|top| code.starts_with(top));
            // A recipe names files that it writes, and placeholders are in capitals or contain a star.
            let example = ["Write ", "folder ", "add ", "Add "].iter().any(|verb| before.ends_with(verb))
                || code.contains(['*', '<', ' '])
                || code.contains("NAME");
            if ours && !example && !root().join(code).exists() {
                wrong.push(format!("{}: {code}", page.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "named and not there:\n{}", wrong.join("\n"));
}

#[test]
fn the_glossary_has_every_gate_mode_and_state() {
    let glossary = std::fs::read_to_string(root().join("docs/glossary.md")).unwrap();
    let gates = Gate::ALL.into_iter().map(|gate| format!("| `{}` |", gate.name()));
    let modes = Mode::ALL.into_iter().chain(Mode::BASELINES).map(|mode| format!("| `{}` |", mode.name()));
    let states = nima_session::STATES.into_iter().map(|state| format!("| {} |", state.word()));
    let missing: Vec<String> =
        gates.chain(modes).chain(states).filter(|row| !glossary.contains(row.as_str())).collect();
    assert!(missing.is_empty(), "not in docs/glossary.md: {missing:?}");
}

#[test]
fn the_pages_have_the_limits_of_the_gates() {
    let page = |name: &str| std::fs::read_to_string(root().join(name)).unwrap();
    let ChainSettings { fade_after_s, zero_after_s, dead_band_m_s, slew_n_per_s, ceiling_n, .. } =
        ChainSettings::default();
    let glossary = page("docs/glossary.md");
    for (gate, figure) in [
        (Gate::Validity, format!("more than {PLAUSIBLE_N} N")),
        (Gate::Age, format!("from {} ms beyond", fade_after_s * 1e3)),
        (Gate::Age, format!("zero from {} ms on", zero_after_s * 1e3)),
        (Gate::DeadBand, format!("slower than {} mm/s", dead_band_m_s * 1e3)),
        (Gate::Gain, format!("{GAIN}, up to {} with a second action", GAIN_ABOVE_ONE.max)),
        (Gate::Slew, format!("to {slew_n_per_s} N/s")),
        (Gate::Ceiling, format!("to {ceiling_n} N, and")),
    ] {
        let row = glossary.lines().find(|line| line.starts_with(&format!("| `{}` |", gate.name()))).unwrap();
        assert!(row.contains(&figure), "{figure} is not in: {row}");
    }
    assert!(page("docs/panels.md").contains(&format!("one-way delay of {}", SLIDER_DELAY_S.per(1e-3, "ms"))));
    assert!(page("docs/faults.md").contains(&format!("the ceiling ({USUAL_CEILING_N} N by default)")));
}
