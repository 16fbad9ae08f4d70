//! The page of recorded sessions, compared with their tables.

use serde_json::Value;

use crate::every_command::{json, nima};

fn done(arguments: &[&str]) {
    let output = nima(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Returns the maximum and mean magnitude of a vector in an exported table.
fn peak_and_mean(table: &str, columns: [&str; 3]) -> [f64; 2] {
    let text = std::fs::read_to_string(table).unwrap();
    let mut lines = text.lines();
    let header: Vec<_> = lines.next().unwrap().split(',').collect();
    let places = columns.map(|name| header.iter().position(|column| *column == name).unwrap());
    let length = |line: &str| {
        let cells: Vec<_> = line.split(',').collect();
        places.iter().map(|place| cells[*place].parse::<f64>().unwrap().powi(2)).sum::<f64>().sqrt()
    };
    let lengths: Vec<_> = lines.map(length).collect();
    [lengths.iter().copied().fold(0.0, f64::max), lengths.iter().sum::<f64>() / lengths.len() as f64]
}

fn close(report: &Value, expected: f64) {
    let report = report.as_f64().unwrap();
    assert!((report - expected).abs() < 1e-9 * expected.max(1.0), "{report}, the table has {expected}");
}

#[test]
fn the_figures_are_those_of_the_tables_and_the_page_compares_both_sessions() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let (first, second, table, out) = (at("first.mcap"), at("second.mcap"), at("first.csv"), at("out"));
    done(&["run", "--virtual", "--seconds", "3", "--record", &first]);
    done(&["run", "--virtual", "--seconds", "2", "--mode", "dfr", "--record", &second]);
    done(&["export", &first, "--out", &table]);
    let report = json(&["report", &first, &second, "--out", &out, "--json"]);
    let arm = &report["sessions"][0]["arms"][0];
    for (number, columns) in [(0, ["fx", "fy", "fz"]), (2, ["rendered_x", "rendered_y", "rendered_z"])] {
        let columns = columns.map(|column| format!("{column}_n"));
        let [peak_n, mean_n] = peak_and_mean(&table, columns.each_ref().map(String::as_str));
        assert!(peak_n > 0.5, "the task presses");
        close(&arm["forces"][number]["peak_n"], peak_n);
        close(&arm["forces"][number]["mean_n"], mean_n);
    }
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    for expected in ["first.mcap", "second.mcap", "Comparison", "<h2>Events</h2>", "closed properly", "<svg"] {
        assert!(page.contains(expected), "{expected} is not on the page");
    }
    assert!(!page.contains("NaN") && !page.contains("<script"));
}

#[test]
fn what_is_no_session_is_told_in_one_line_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let foreign = folder.path().join("foreign.mcap");
    let out = folder.path().join("out");
    std::fs::write(&foreign, "no session").unwrap();
    for session in [foreign.to_str().unwrap(), "/no/such/session.mcap"] {
        let output = nima(&["report", session, "--out", out.to_str().unwrap()]);
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && output.stdout.is_empty(), "{session} succeeded");
        assert!(text.lines().count() == 1 && text.contains(session), "{text}");
        assert!(!out.exists());
    }
}
