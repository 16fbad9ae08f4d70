//! `nima study` as a user would type it.
use std::process::{Command, Output};

use serde_json::Value;

fn nima(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nima")).args(arguments).output().unwrap()
}

fn refused(arguments: &[&str], word: &str) {
    let output = nima(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && output.stdout.is_empty(), "{arguments:?}");
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.contains(word) && !text.contains("panicked"), "\"{word}\" is not in: {text}");
}

#[test]
fn stability_prints_a_table_and_writes_three_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("made/if/absent");
    let output = nima(&["study", "stability", "--quick", "--ticks", "10000", "--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    for word in ["standstill", "NaN", "literal-f32", "sliding", "targets reached"] {
        assert!(text.contains(word), "\"{word}\" is not in: {text}");
    }
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let report: Value = serde_json::from_str(&read("stability.json")).unwrap();
    assert_eq!(report["verdict"]["reached"], true, "{}", report["verdict"]);
    assert_eq!(report["verdict"]["ours_finite_share"], 1.0);
    assert!(report["verdict"]["ours_worst_error"].as_f64().unwrap() <= 1e-9);
    assert!(report["drift"]["ticks"].as_u64().unwrap() <= 10_000);
    let extremes = report["extremes"].as_array().unwrap();
    for extreme in extremes {
        assert_eq!(extreme["entries"].as_array().unwrap().len(), 25, "{}", extreme["name"]);
    }
    assert_eq!(read("stability.csv").lines().count(), 1 + 25 * extremes.len());
    let columns = read("stability.csv").lines().map(|line| line.split(',').count()).collect::<Vec<_>>();
    assert!(columns.iter().all(|count| *count == columns[0]));
    assert!(read("stability.svg").starts_with("<svg"));
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 3);
}

#[test]
fn the_papers_figures_are_told_under_a_name_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("judged-too.mcap").display().to_string();
    crate::export::record(&session, "peg_transfer", "3");
    let out = folder.path().to_str().unwrap();
    let arguments =
        ["study", "validation", "--paper", "--seconds", "5", "--recording", &session, "--json", "--out", out];
    let output = nima(&arguments);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let entries = report["entries"].as_array().unwrap();
    assert!(entries.iter().any(|entry| entry["name"].as_str().unwrap().contains("judged-too")), "{report:.2000}");
    for entry in entries {
        let fraction = |key: &str| entry["in_window"][key].as_f64().unwrap();
        assert!(fraction("window_share") > fraction("next_share"), "{entry}");
        assert_eq!(entry["at_horizon"].as_array().unwrap().len(), 20, "{}", entry["name"]);
    }
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&read("validation-paper.json")).unwrap(), report);
    let text = read("validation-paper.md");
    assert!(entries.iter().all(|entry| text.contains(entry["name"].as_str().unwrap())), "{text}");
    // A table has as many cells in each row as in its head.
    let columns = |line: &str| line.matches('|').count();
    for table in text.split("\n\n").filter(|table| table.starts_with('|')) {
        assert!(table.lines().all(|line| columns(line) == columns(table.lines().next().unwrap())), "{table}");
    }
}

#[test]
fn bad_input_is_one_line() {
    refused(&["study"], "study");
    refused(&["study", "nonsense"], "nonsense");
    refused(&["study", "stability", "--ticks", "9"], "10000");
    refused(&["study", "stability", "--ticks", "many"], "many");
    refused(&["study", "validation", "--paper", "--rows", "2000"], "--rows");
    refused(&["study", "validation", "--paper", "--seconds", "1"], "from 5 to 3600 s");
    refused(&["study", "validation", "--recording", "a.csv"], "--paper");
    refused(&["study", "validation", "--paper", "--recording", "/nowhere/a.csv"], "/nowhere/a.csv");
    let file = tempfile::NamedTempFile::new().unwrap();
    refused(&["study", "stability", "--out", file.path().to_str().unwrap()], "folder");
}

#[test]
fn the_gates_hold_against_a_short_attack_and_a_wrong_number_is_refused() {
    let output = nima(&["study", "gates", "--requests", "2e4", "--json"]);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["requests"], 20_000);
    assert!(report["breaches"].as_object().unwrap().values().all(|count| *count == 0), "{}", report["breaches"]);
    assert_eq!(report["acted"].as_array().unwrap().len(), 9);
    for wrong in ["0", "1.5", "-3", "many", "1e13", "nan"] {
        refused(&["study", "gates", &format!("--requests={wrong}")], "whole number");
    }
}

#[test]
fn the_methods_of_others_are_compared_on_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("press.csv");
    let row = |k: u32| {
        let t = 1e-3 * f64::from(k);
        let x = 0.01 * (9.0 * t).sin();
        format!("{t},{x},{}\n", if x > 0.0 { -300.0 * x.powf(1.3) } else { 0.0 })
    };
    std::fs::write(&path, format!("t_s,x_m,fx_n\n{}", (0..3000).map(row).collect::<String>())).unwrap();
    let path = path.to_str().unwrap();
    let out = folder.path().join("out");
    let arguments = ["study", "baselines", "--recording", path, "--delay-ms", "50", "--delay-ms", "300", "--json"];
    let output = nima(&[&arguments[..], &["--out", out.to_str().unwrap()]].concat());
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let means = report["means"].as_array().unwrap();
    assert_eq!(means.len(), 2 * 11);
    for mean in means {
        assert_eq!((mean["split"].as_str(), mean["sources"].as_u64()), (Some("held_out"), Some(1)), "{mean}");
        assert!(mean["mean"].as_f64().unwrap() > 0.0 && mean["low"].is_null(), "one recording has no interval: {mean}");
    }
    let model = means.iter().find(|mean| mean["mode"] == "model_mediated" && mean["delay_ms"] == 300.0).unwrap();
    assert!(model["mean"].as_f64().unwrap() < 0.3, "{model}");
    let table = std::fs::read_to_string(out.join("baselines.md")).unwrap();
    assert!(table.contains("Held-out split") && table.contains("| kalman |"), "{table}");
    assert_eq!(std::fs::read_to_string(out.join("baselines.csv")).unwrap().lines().count(), 1 + 22);

    refused(&["study", "baselines", "--recording", "nowhere.csv"], "nowhere.csv");
    refused(&["study", "baselines", "--map", "x=a"], "--recording");
    refused(&["study", "baselines", "--recording", path, "--delay-ms", "2000"], "1000 ms");
    refused(&["study", "baselines", "--recording", path, "--delay-ms", "0"], "--delay-ms");
}

#[test]
fn two_machines_over_a_bad_line_are_compared_with_a_perfect_one() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let clock = ["--clock", "late-1"];
    let output =
        nima(&[&["study", "network", "--quick", "--mode", "best", "--json", "--out", out], &clock[..]].concat());
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = report["rows"].as_array().unwrap();
    assert_eq!((rows.len(), report["extent"].as_str()), (6, Some("quick")));
    for row in rows {
        assert_eq!(row["clock"], "late-1");
        assert!(row["ceiling_breaches"] == 0 && row["slew_breaches"] == 0 && row["resumed"] == 0, "{row}");
        assert!(row["error_n"].as_f64().unwrap() > 0.0 && row["over_clean"].as_f64().unwrap() > 0.0, "{row}");
        assert_eq!(row["stops"].as_u64() > Some(0), row["happening"] == "outages", "{row}");
    }
    let missed: u64 = report["aims"].as_array().unwrap().iter().map(|aim| aim["missed"].as_u64().unwrap()).sum();
    assert_eq!(output.status.success(), missed == 0, "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&read("network.json")).unwrap(), report);
    assert!(read("network.md").contains("Every factor alone") && read("network.svg").starts_with("<svg"));
    assert_eq!(read("network.csv").lines().count(), 1 + rows.len());

    refused(&["study", "network", "--quick", "--full"], "--full");
    refused(&["study", "network", "--mode", "sideways"], "sideways");
    for study in ["release", "hands", "passivity", "network", "validation", "tradeoff"] {
        refused(&["study", study, "--clock", "late-90"], "unknown clock profile \"late-90\"");
    }
    refused(&["study", "validation", "--paper", "--clock", "busy"], "--clock");
}
