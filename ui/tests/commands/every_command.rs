//! Every command with good and with bad input, as a user would type it.
use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
};

use nima_core::impedance::Mode;
use nima_testing::unjudged;
use serde_json::Value;

/// Runs the program without a display.
pub(crate) fn nima(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nima"))
        .args(arguments)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        // Keep out the calibrations of the user who runs the tests.
        .env("NIMA_DATA_DIR", "/dev/null/no/such/folder")
        .output()
        .unwrap()
}

/// Returns the output of a command that must succeed.
pub(crate) fn json(arguments: &[&str]) -> Value {
    let output = nima(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Runs a command that must fail with one line that contains all of `words`; returns the line.
fn refused(arguments: &[&str], words: &[&str]) -> String {
    let output = nima(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{arguments:?} succeeded");
    assert!(output.stdout.is_empty(), "{arguments:?} printed on stdout");
    assert_eq!(text.lines().count(), 1, "{text}");
    for word in words {
        assert!(text.contains(word), "\"{word}\" is not in: {text}");
    }
    assert!(!text.contains("panicked"), "{text}");
    text
}

/// Returns a recording of a hand that presses a soft spring twice per second, at 1 kHz.
fn recording(folder: &Path, name: &str, rows: usize, edit: impl Fn(usize, &mut String)) -> PathBuf {
    let mut text = String::from("t_s,x_m,fx_n\n");
    for i in 0..rows {
        let t = i as f64 * 1e-3;
        let x = 0.01 * (std::f64::consts::TAU * 2.0 * t).sin();
        let f = if x > 0.0 { 300.0 * x.powf(1.3) } else { 0.0 };
        let mut row = format!("{t},{x},{f}");
        edit(i, &mut row);
        text.push_str(&row);
        text.push('\n');
    }
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn identify_prints_every_field_of_its_json() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), "r.csv", 2000, |_, _| {});
    let figures = json(&["identify", path.to_str().unwrap(), "--delay-ms", "50", "--json"]);
    for field in ["samples", "rate_hz", "axes", "mode", "window_ms", "delay_ms", "nonlinear_share", "rejected"] {
        assert!(!figures[field].is_null(), "{field}");
    }
    for group in ["error", "hold"] {
        for field in ["mae", "sd", "p95", "max"] {
            assert!(figures[group][field].is_f64(), "{group}.{field}");
        }
    }
    for degree in ["degree_1", "degree_2", "degree_3", "degree_4", "degree_5", "selected"] {
        assert!(
            figures["reconstruction"][degree]["mae"].is_f64() && figures["reconstruction"][degree]["sd"].is_f64(),
            "{degree}"
        );
    }
    assert_eq!(figures["degree_share"].as_array().unwrap().len(), 5);
    assert!(figures["condition"]["p95"].is_f64() && figures["tick_us"]["p99"].is_f64());
    assert_eq!((figures["samples"].as_u64(), figures["delay_ms"].as_f64()), (Some(2000), Some(50.0)));
    assert!(
        figures["error"]["mae"].as_f64() < figures["hold"]["mae"].as_f64(),
        "anchored is better than holding: {figures}"
    );
}

#[test]
fn a_hole_in_a_recording_is_told_and_nothing_is_made_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let later = |seconds: f64| {
        move |i: usize, row: &mut String| {
            if i >= 1000 {
                let (_, rest) = row.split_once(',').unwrap();
                *row = format!("{},{rest}", i as f64 * 1e-3 + seconds);
            }
        }
    };
    let whole = recording(folder.path(), "whole.csv", 2000, |_, _| {});
    let hole = recording(folder.path(), "hole.csv", 2000, later(2.0));
    let figures = |path: &Path| json(&["identify", path.to_str().unwrap(), "--delay-ms", "50", "--json"]);
    assert_eq!((figures(&whole)["holes"].as_u64(), figures(&whole)["compared"].as_u64()), (Some(0), Some(1950)));
    let figures = figures(&hole);
    assert_eq!((figures["holes"].as_u64(), figures["longest_hole_s"].as_f64()), (Some(1), Some(2.001)));
    assert_eq!(figures["compared"].as_u64(), Some(1900), "the delay fills again after the hole");
    let output = nima(&["identify", hole.to_str().unwrap()]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("GAPS                   1, the longest 2.001 s") && !text.contains("NaN"), "{text}");
}

#[test]
fn a_real_recording_is_identified_better_than_held_and_literal_is_shown_as_it_is() {
    let Some(foam) = unjudged::recording("tue_1dof/m1_question1a_foam.csv") else { return };
    let foam = foam.display().to_string();
    let with = |mode| {
        json(&[
            "identify",
            &foam,
            "--map",
            "x=pos_follower_rad",
            "--map",
            "fx=Fe_Nm",
            "--mode",
            mode,
            "--delay-ms",
            "50",
            "--json",
        ])
    };
    let anchored = with("anchored");
    let literal = with("literal");
    let dfr = with("dfr");
    let mae = |figures: &Value, what: &str| figures[what]["mae"].as_f64().unwrap();
    assert!(mae(&anchored, "error") < mae(&anchored, "hold"));
    assert!((mae(&dfr, "error") - mae(&dfr, "hold")).abs() < 1e-12);
    assert!(literal["reconstruction"]["selected"]["mae"].as_f64().unwrap() < 0.01, "in-window: millinewton-metres");
    assert!(mae(&literal, "error") > 3.0 * mae(&literal, "hold"), "at the horizon: far worse");
}

#[test]
fn every_way_to_read_the_paper_changes_the_literal_mode_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), "rec.csv", 2000, |_, _| {});
    let error = |mode: &str, keys: &[&str]| {
        let given = ["identify", path.to_str().unwrap(), "--mode", mode, "--delay-ms", "50", "--json"];
        json(&given.iter().chain(keys).copied().collect::<Vec<_>>())["error"]["mae"].as_f64().unwrap()
    };
    let keys: [&[&str]; 4] =
        [&["--reading", "displacement"], &["--choice", "next"], &["--constant"], &["--ridge", "0.003"]];
    for key in keys {
        assert!((error("literal", key) - error("literal", &[])).abs() > 1e-9, "{key:?}");
        assert!((error("matched", key) - error("matched", &[])).abs() <= 0.0, "{key:?}");
    }
    refused(&["identify", path.to_str().unwrap(), "--choice", "best"], &["`window` or `next`"]);
    refused(&["identify", path.to_str().unwrap(), "--reading", "sideways"], &["`displacement`"]);
    refused(&["identify", path.to_str().unwrap(), "--ridge", "-1"], &["the ridge parameter -1 is out of range"]);
}

#[test]
fn cutting_the_tail_never_changes_earlier_rows() {
    let folder = tempfile::tempdir().unwrap();
    let whole = recording(folder.path(), "whole.csv", 2000, |_, _| {});
    let cut = recording(folder.path(), "cut.csv", 1300, |_, _| {});
    let modes = ["literal", "linear", "dfr", "anchored"].map(|mode| (mode, "window"));
    for (mode, choice) in modes.into_iter().chain([("literal", "next")]) {
        let trace = |path: &Path, out: &str| {
            let out = folder.path().join(out);
            json(&[
                "identify",
                path.to_str().unwrap(),
                "--mode",
                mode,
                "--choice",
                choice,
                "--delay-ms",
                "50",
                "--json",
                "--out",
                out.to_str().unwrap(),
            ]);
            std::fs::read_to_string(out).unwrap()
        };
        let whole = trace(&whole, "a.csv");
        let cut = trace(&cut, "b.csv");
        assert_eq!(cut.lines().count(), 1301);
        assert!(
            whole.starts_with(&cut),
            "{mode}: the trace of the cut recording is not the beginning of the whole one"
        );
        assert!(whole.starts_with("t_s,fx_n,rx_n,hx_n,degree,condition,gate\n"));
    }
}

#[test]
fn identify_refuses_bad_recordings_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("trace.csv");
    let good = recording(folder.path(), "good.csv", 2000, |_, _| {});
    let nan = recording(folder.path(), "nan.csv", 2000, |i, row| {
        if i == 700 {
            *row = "0.7,NaN,0".to_owned();
        }
    });
    let back = recording(folder.path(), "back.csv", 2000, |i, row| {
        if i == 800 {
            *row = "0.1,0,0".to_owned();
        }
    });
    let short = recording(folder.path(), "short.csv", 200, |_, _| {});
    let refuse = |path: &Path, more: &[&str], words: &[&str]| {
        let mut arguments = vec!["identify", path.to_str().unwrap(), "--json", "--out", out.to_str().unwrap()];
        arguments.extend(more);
        refused(&arguments, words);
        assert!(!out.exists(), "something was written");
    };
    refuse(&folder.path().join("none.csv"), &[], &["none.csv", "No such file"]);
    refuse(&good, &["--map", "x=px"], &["px", "t_s, x_m, fx_n"]);
    refuse(&good, &["--map", "w=px"], &["w=px"]);
    refuse(&nan, &[], &["line 702", "NaN"]);
    refuse(&back, &[], &["line 802", "the time steps back by 0.699 s", "split the file"]);
    refuse(&short, &[], &["200 samples", "300 ms"]);
    refuse(&good, &["--window-ms", "2", "--mode", "nima"], &["window"]);
    refuse(&good, &["--delay-ms", "5000"], &["delay"]);
    refuse(&good, &["--delay-ms", "-1"], &["delay"]);
    refuse(&good, &["--delay-ms", "0.4"], &["0.4 ms", "half a sample", "0 or at least 0.500 ms"]);
    refuse(&good, &["--delay-ms", "NaN"], &["delay"]);
    refuse(&good, &["--max-degree", "9"], &["degree"]);
    let own = good.to_str().unwrap();
    refused(&["identify", own, "--out", own], &["is the input", "itself"]);
    assert_eq!(std::fs::read_to_string(&good).unwrap().lines().count(), 2001, "the recording is untouched");
    refused(
        &["identify", own, "--out", folder.path().join("no/such/folder/t.csv").to_str().unwrap()],
        &["cannot write"],
    );
}

#[test]
fn run_on_the_virtual_clock_reports_everything() {
    let summary = json(&["run", "--virtual", "--seconds", "5", "--json"]);
    assert_eq!((summary["ticks"].as_u64(), summary["missed"].as_u64()), (Some(5000), Some(0)));
    assert_eq!(summary["clock"], "virtual");
    for quantile in ["p50", "p99", "p999", "max"] {
        assert!(summary["wake_us"][quantile].is_f64() && summary["work_us"][quantile].is_f64());
    }
    let modes = |summary: &Value| -> Vec<String> {
        summary["error"].as_array().unwrap().iter().map(|e| e["mode"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(modes(&summary), ["dfr", "anchored", "matched", "best"], "only what is needed is computed");
    let compared = json(&["run", "--virtual", "--seconds", "5", "--compare", "--json"]);
    assert_eq!(modes(&compared), Mode::ALL.map(Mode::name));
}

#[test]
fn a_run_on_a_late_clock_repeats_for_its_seed_and_its_session_names_both() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("late.mcap");
    let late = |seed: &str, more: &[&str]| {
        json(
            &[&["run", "--virtual", "--seconds", "5", "--json", "--clock", "late-1", "--clock-seed", seed], more]
                .concat(),
        )
    };
    let [one, same, other] = [late("7", &["--record", session.to_str().unwrap()]), late("7", &[]), late("8", &[])];
    assert_eq!(one["lateness"], serde_json::json!({ "profile": "late-1", "seed": 7 }));
    let missed = one["missed"].as_u64().unwrap();
    assert!(missed > 20 && (4990..=5000).contains(&(missed + one["ticks"].as_u64().unwrap())), "{one}");
    assert!(one["wake_us"]["max"].as_f64().unwrap() > 1000.0, "{one}");
    assert_eq!((&one["missed"], &one["error"]), (&same["missed"], &same["error"]));
    assert_ne!(one["error"], other["error"]);
    let replayed = nima(&["replay", session.to_str().unwrap()]);
    assert!(replayed.status.success(), "{}", String::from_utf8_lossy(&replayed.stderr));
    let page = folder.path().join("page");
    assert!(nima(&["report", session.to_str().unwrap(), "--out", page.to_str().unwrap()]).status.success());
    let page = std::fs::read_to_string(page.join("report.html")).unwrap();
    assert!(page.contains("late-1") && !page.contains("nothing is late"), "the session names its clock");
    refused(&["run", "--virtual", "--clock", "early"], &["unknown clock profile \"early\"", "stall-MS"]);
    refused(&["run", "--clock", "busy"], &["--virtual"]);
}

#[test]
fn every_baseline_runs_in_the_loop_and_over_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), "r.csv", 2000, |_, _| {});
    for mode in Mode::BASELINES.map(Mode::name) {
        let summary = json(&["run", "--virtual", "--seconds", "2", "--mode", mode, "--json"]);
        let errors = summary["error"].as_array().unwrap();
        let own = errors.iter().find(|error| error["mode"] == mode).unwrap();
        assert!(own["mae_n"].as_f64().unwrap() > 0.0 && own["invalid"].as_u64().unwrap() < 100, "{own}");
        assert_eq!(errors.len(), 2, "it and delayed reflection, one baseline at a time");
        let figures = json(&["identify", path.to_str().unwrap(), "--delay-ms", "50", "--mode", mode, "--json"]);
        assert_eq!((figures["mode"].as_str(), figures["rejected"].as_u64()), (Some(mode), Some(0)));
    }
    refused(&["run", "--virtual", "--mode", "smith"], &["smith", "kalman"]);
}

#[test]
fn run_on_the_real_clock_counts_every_period() {
    // On a busy machine a delayed loop ends in a fault, but still counts its periods.
    let output = nima(&["run", "--seconds", "2", "--json"]);
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let ticks = summary["ticks"].as_u64().unwrap();
    let missed = summary["missed"].as_u64().unwrap();
    let periods = summary["seconds"].as_f64().unwrap() * 1000.0;
    assert!((periods - (ticks + missed) as f64).abs() < 1.5, "{summary}");
    assert!(ticks > 100);
}

#[test]
fn run_refuses_what_it_cannot_run() {
    refused(&["run", "--scene", "no_such_scene"], &["no_such_scene", "peg_transfer"]);
    refused(&["run", "--rig", "no_such_rig.toml"], &["no_such_rig.toml", "simulated"]);
    refused(&["run", "--virtual", "--delay-ms", "-3"], &["delay_s"]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.toml");
    std::fs::write(&path, "name = \"x\"\nseed = maybe\n").unwrap();
    refused(&["run", "--scene", path.to_str().unwrap()], &["broken.toml", "line 2"]);
    let line = refused(&["run", "--scene", folder.path().to_str().unwrap()], &["cannot read scene file"]);
    assert_eq!(line.matches("it is a folder").count(), 1, "said twice: {line}");
}

#[test]
fn unusable_arguments_exit_non_zero() {
    for arguments in [&["fly"][..], &["run", "--seconds", "-1"], &["run", "--mode", "magic"], &["identify"]] {
        refused(arguments, &["--help"]);
    }
    for (seconds, words) in [("1e9", "at most 10000000 seconds"), ("-1", "seconds above 0"), ("nan", "seconds above 0")]
    {
        refused(&["run", "--seconds", seconds], &["--seconds", words]);
    }
    refused(&["emulate", "rig", "--set", "kinova.joints=6"], &["--set applies only to single devices"]);
    assert!(nima(&["identify", "--help"]).status.success());
}

#[test]
fn without_a_display_the_console_says_so_with_its_own_exit_code() {
    if !cfg!(target_os = "linux") {
        return;
    }
    let output = nima(&["console"]);
    assert_eq!(output.status.code(), Some(69), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stderr).contains("nima run"), "it says what to do instead");
}

#[test]
fn run_refuses_a_wrist_that_is_not_calibrated() {
    refused(&["run", "--virtual", "--scene", "palpation"], &["Palpation through a trocar", "--calibrate gravity"]);
    refused(&["run", "--virtual", "--scene", "gravity"], &["Gravity calibration", "cannot be engaged"]);
}

#[test]
fn a_program_without_the_department_names_the_build_that_has_it() {
    for arguments in [
        &["run", "--share", "--seconds", "1"][..],
        &["department", "rigs"],
        &["department", "create", "lab"],
        &["department", "monitor", "--at", "127.0.0.1"],
    ] {
        let output = nima(arguments);
        let report = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && report.contains("src/extras/department/Cargo.toml"), "{report}");
        assert_eq!(report.lines().count(), 1, "{report}");
    }
}
