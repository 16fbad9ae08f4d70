//! Inputs that failed for people who do this work, in `../shared/cases`.

use std::path::PathBuf;

use nima_testing::unjudged;

use crate::every_command::nima;

/// Returns the output on stderr of a command with a file, and whether it succeeded.
fn tried(arguments: &[&str]) -> (bool, String) {
    let output = nima(arguments);
    (output.status.success(), String::from_utf8(output.stderr).unwrap())
}

fn case(file: &str) -> Option<String> {
    let path: PathBuf = unjudged::shared(&format!("cases/{file}"))?;
    Some(path.to_str().unwrap().to_owned())
}

#[test]
fn two_arms_at_one_address_are_refused_by_name() {
    let Some(rig) = case("two_arms_one_address.toml") else { return };
    let (succeeded, words) = tried(&["run", "--rig", &rig, "--seconds", "1"]);
    assert!(
        !succeeded && words.contains("devices.left.arm.host") && words.contains("devices.right.arm.host"),
        "{words}"
    );
}

/// The tables are too short for an identification, which names how many rows it has read.
#[test]
fn tables_in_other_dialects_are_read_or_refused_with_what_is_wrong() {
    for (file, right) in [
        ("semicolon_small.csv", "has 2 samples"),
        ("savetxt_header.csv", "has 10 samples"),
        ("clock_step_back.csv", "line 202: the time steps back by 0.999 s"),
        ("dup_small.csv", "two columns have the name \"x_m\" (columns 2 and 3)"),
    ] {
        let Some(table) = case(file) else { continue };
        let (succeeded, words) = tried(&["identify", &table]);
        assert!(!succeeded && words.contains(right) && !words.contains("sort"), "{file}: {words}");
    }
}
