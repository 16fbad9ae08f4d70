//! A user study by commands: from the file to the report, blind until unblinding, with kills and stops in between.
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use nima_tests::studies::{BLIND, everything, found_in, study_file};
use serde_json::Value;

use crate::every_command::{json, nima};

/// Words and numbers that occur nowhere else, in all spellings that a program could write.
const SECRET: [&str; 9] =
    ["zebra", "wildebeest", "anchored", "no_force", "no force", "137.5", "0.1375", "0.8125", "rendered_n"];

/// Returns a study of short trials in which the right hand touches tissue.
fn file(folder: &Path, head: &str, seconds: f64, conditions: &str) -> String {
    let path = folder.join("file.toml");
    fs::write(&path, study_file(head, seconds, conditions)).unwrap();
    path.display().to_string()
}

/// Runs a command that must succeed; returns its output.
fn report(arguments: &[&str]) -> String {
    let output = nima(arguments);
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
    assert!(output.status.success(), "{arguments:?}: {text}");
    text
}

fn refused(arguments: &[&str]) -> String {
    let output = nima(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && output.stdout.is_empty(), "{arguments:?} succeeded");
    assert!(text.lines().count() == 1 && !text.contains("panicked"), "{text}");
    text
}

fn secrets_in(text: &str) -> Vec<&'static str> {
    found_in(text, &SECRET)
}

#[test]
fn a_blind_study_tells_its_conditions_nowhere_until_it_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let head = "participants = 2\ntrials = 1\nrecord = true\nreference = 'Wildebeest'";
    let rest = "[questionnaires]\nafter_condition = ['nasa_tlx', 'realism']\n[breaks]\nafter_trials = 1\nleast_s = 5.0";
    let file = file(folder.path(), head, 3.0, &format!("{BLIND}{rest}"));
    let place = folder.path().join("study");
    let study = place.to_str().unwrap();
    let csv = folder.path().join("trials.csv").display().to_string();
    let mut all = report(&["user-study", "new", &file, "--out", study]);
    let next = ["user-study", "next", study, "--participant", "P01"];
    let run = |more: &[&str]| report(&[&next[..], more].concat());
    all += &run(&["--virtual"]);
    all += &refused(&[&next[..], &["--virtual", "--answers", "realism = 8"]].concat());
    let tlx = "nasa_tlx = { mental = 50, physical = 5, temporal = 90, performance = 0, effort = 50, frustration = 45 }";
    all += &run(&["--answers", tlx]);
    all += &run(&["--answers", "realism = 6", "--json"]);
    all += &run(&["--virtual"]);
    all += &run(&["--virtual", "--json"]);
    all += &report(&["user-study", "note", study, "--text", "the light flickered", "--participant", "P01"]);
    all += &report(&["user-study", "status", study]);
    all += &report(&["user-study", "status", study, "--json"]);
    all += &report(&["user-study", "table", study, "--out", &csv]);
    all += &report(&["user-study", "table", study, "--out", &csv, "--questionnaires"]);
    all += &report(&["study-report", study, "--all"]);
    all += &everything(&place);
    all += &fs::read_to_string(&csv).unwrap();
    assert_eq!(secrets_in(&all), [""; 0], "of {} bytes", all.len());
    let page = fs::read_to_string(place.join("report/report.html")).unwrap();
    assert!(page.contains("Blind: the conditions are shown by their labels"), "{page}");
    assert!(page.contains("the light flickered") && page.contains("A (n = 1)"), "{page}");
    let sessions = |end: &str| {
        let names =
            fs::read_dir(place.join("sessions")).unwrap().map(|entry| entry.unwrap().path().display().to_string());
        names.filter(|name| name.ends_with(end)).count()
    };
    assert_eq!((sessions(".mcap"), sessions(".mcap.sealed")), (0, 2));

    let opened = report(&["user-study", "unblind", study, "--name", "A. Person", "--reason", "end"]);
    assert_eq!(secrets_in(&opened), ["zebra", "wildebeest"]);
    assert!(opened.contains("not all participants have finished"), "{opened}");
    report(&["study-report", study]);
    assert_eq!(secrets_in(&everything(&place)), SECRET, "the control: now they are present");
    assert_eq!((sessions(".mcap"), sessions(".mcap.sealed")), (2, 0));
    report(&["user-study", "table", study, "--out", &csv]);
    let table = fs::read_to_string(&csv).unwrap();
    assert!(table.contains("P01,Zebra,") && table.contains("P01,Wildebeest,"), "{table}");
    let session = place.join("sessions/P01-trial-01-1.mcap").display().to_string();
    assert!(
        json(&["score", &session, "--json"])["condition"].as_str().unwrap().contains("ms"),
        "it is a whole session"
    );
    let commitment = json(&["user-study", "status", study, "--json"])["commitment"].as_str().unwrap().to_owned();
    if let Ok(output) = Command::new("b2sum").args(["-l", "256"]).arg(place.join("conditions.json")).output() {
        assert!(String::from_utf8_lossy(&output.stdout).starts_with(&commitment), "a program of others says the same");
    }
    assert!(refused(&["user-study", "unblind", study, "--name", "B", "--reason", "x"]).contains("A. Person"));
}

/// Starts the next trial of P01 and ends it by a signal after its start; `false` if it was over before.
fn ended_by(signal: i32, study: &Path) -> bool {
    let journal = study.join("journal.jsonl");
    // An unfinished line does not count.
    let began = |journal: &PathBuf| {
        let text = fs::read_to_string(journal).unwrap();
        text.rsplit_once('\n').map_or(0, |(lines, _)| lines.matches("trial_began").count())
    };
    let before = began(&journal);
    let mut child = Command::new(env!("CARGO_BIN_EXE_nima"))
        .args(["user-study", "next", study.to_str().unwrap(), "--participant", "P01", "--virtual"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while began(&journal) == before && child.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(1));
    }
    // The program handles signals before it starts the trial. SAFETY: the child is ours and has not yet been waited
    // for, so its id cannot belong to another process.
    #[expect(unsafe_code, reason = "a signal to a child")]
    unsafe {
        libc::kill(libc::pid_t::try_from(child.id()).unwrap(), signal);
    }
    child.wait().unwrap();
    let last = fs::read_to_string(&journal).unwrap().lines().last().unwrap().to_owned();
    !last.contains("trial_ended")
}

#[test]
fn twelve_trials_with_a_killed_program_and_a_stop_lose_nothing_but_these_attempts() {
    let folder = tempfile::tempdir().unwrap();
    let file = file(folder.path(), "participants = 2\ntrials = 6\nsecondary = ['path_length_m_right']", 15.0, BLIND);
    let place = folder.path().join("study");
    let study = place.to_str().unwrap();
    report(&["user-study", "new", &file, "--out", study]);
    let status = || json(&["user-study", "status", study, "--json"])["participants"][0].clone();
    let mut killed = 0;
    let mut stopped = 0;
    loop {
        let before = status();
        let trials = before["trials"].as_u64().unwrap();
        if before["next"]["step"] == "done" {
            break;
        }
        if (3..8).contains(&trials) && killed == 0 && ended_by(libc::SIGKILL, &place) {
            killed += 1;
            let after = status();
            assert_eq!((after["trials"].as_u64(), after["next"]["step"].as_str()), (Some(trials), Some("running")));
        } else if (8..12).contains(&trials) && stopped == 0 && ended_by(libc::SIGINT, &place) {
            stopped += 1;
            let after = status();
            assert_eq!(
                (after["next"]["number"].as_u64(), after["next"]["attempt"].as_u64()),
                (Some(trials + 1), Some(2))
            );
        } else {
            nima(&["user-study", "next", study, "--participant", "P01", "--virtual"]);
        }
    }
    assert_eq!((killed, stopped), (1, 1));
    let end = status();
    assert_eq!(
        (end["trials"].as_u64(), end["without_result"].as_u64(), end["interruptions"].as_u64()),
        (Some(12), Some(0), Some(2))
    );
    let csv = folder.path().join("trials.csv").display().to_string();
    assert!(report(&["user-study", "table", study, "--out", &csv]).starts_with("12 rows"));
    let numbers: Vec<String> = fs::read_to_string(&csv)
        .unwrap()
        .lines()
        .skip(1)
        .map(|row| row.split(',').nth(2).unwrap().to_owned())
        .collect();
    assert_eq!(numbers, (1..=12).map(|number| number.to_string()).collect::<Vec<_>>());
    assert!(
        refused(&["user-study", "next", study, "--participant", "P01", "--virtual"]).contains("all steps are done")
    );
}

/// Returns a whole study with simulated people; returns p after Holm of the primary measure, and the page.
fn simulated(conditions: &str) -> (f64, String) {
    let folder = tempfile::tempdir().unwrap();
    let rest = "[questionnaires]\nafter_condition = ['nasa_tlx_weighted']\nat_end = ['sus', 'free_text']";
    let head = "participants = 10\ntrials = 2\nseed = 1";
    let file = file(folder.path(), head, 4.0, &format!("{conditions}{rest}"));
    let place = folder.path().join("study");
    let study = place.to_str().unwrap();
    report(&["user-study", "new", &file, "--out", study]);
    report(&["user-study", "simulate", study, "--seed", "2", "--steps", "5"]);
    let text = report(&["user-study", "simulate", study, "--seed", "2"]);
    assert_eq!(text.matches("all steps are done").count(), 10, "{text}");
    report(&["user-study", "unblind", study, "--name", "A", "--reason", "end"]);
    report(&["study-report", study]);
    let read = |name: &str| fs::read_to_string(place.join("report").join(name)).unwrap();
    let analysis: Value = serde_json::from_str(&read("trials-analysis.json")).unwrap();
    let measure = &analysis["measures"][0];
    assert_eq!((measure["measure"].as_str(), measure["complete"].as_u64()), (Some("mean_force_n_right"), Some(10)));
    assert!(
        read("trials-analysis.R").contains("wilcox.test")
            && read("questionnaires-analysis.csv").contains("nasa_tlx_raw")
    );
    assert_eq!(read("trials.csv").lines().count(), 1 + 40);
    (measure["pairs"][0]["p_holm"].as_f64().unwrap(), read("report.html"))
}

#[test]
fn a_simulated_study_finds_a_difference_that_is_there_and_none_that_is_not() {
    let with = "[[conditions]]\nname = 'With'\nmode = 'matched'\ndelay_ms = 20.0\n";
    let without = "[[conditions]]\nname = 'Without'\nno_force = true\n";
    let (p, page) = simulated(&format!("{with}{without}"));
    assert!(p < 0.01, "{p}");
    assert!(page.contains("Simulated:") && page.contains("<svg") && page.contains("With (n = 10)"), "{page}");
    assert!(page.contains("Unblinded by A") && page.contains("matched, gain 1") && page.contains("20 ms"), "{page}");
    assert!(!page.contains("<script") && !page.contains("src="), "nothing is loaded from elsewhere");
    // The delays differ by less than a tick, so the hand feels no difference.
    let same = "[[conditions]]\nname = 'Same'\nmode = 'matched'\ndelay_ms = 20.1\n";
    let (p, _) = simulated(&format!("{with}{same}"));
    assert!(p > 0.05, "{p}");
}

#[test]
fn the_result_of_a_trial_is_told_as_the_study_has_it() {
    let report_under = |feedback: &str| {
        let folder = tempfile::tempdir().unwrap();
        let head = format!("participants = 2\ntrials = 1\nfeedback = '{feedback}'");
        let file = file(folder.path(), &head, 3.0, BLIND);
        let place = folder.path().join("study");
        let study = place.to_str().unwrap();
        report(&["user-study", "new", &file, "--out", study]);
        report(&["user-study", "next", study, "--participant", "P01", "--virtual"])
    };
    // A trial that ends by its time limit meets no criterion, so nothing fades.
    for shows in ["always", "fades"] {
        assert!(report_under(shows).contains("the time limit is reached"), "{shows}");
    }
    let without = report_under("never");
    assert!(without.contains("result hidden") && !without.contains("time limit is reached"), "{without}");
}

#[test]
fn a_recording_that_cannot_be_sealed_is_reported_and_the_study_opens() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("study");
    let study = place.to_str().unwrap();
    report(&["user-study", "new", &file(folder.path(), "participants = 2\ntrials = 1", 3.0, BLIND), "--out", study]);
    fs::create_dir_all(place.join("sessions/P01-trial-01-1.mcap.sealed")).unwrap();
    fs::write(place.join("sessions/P01-trial-01-1.mcap"), "left by a power cut").unwrap();
    let text = report(&["user-study", "note", study, "--text", "the light flickered"]);
    assert!(text.contains("warning: cannot encrypt a recording") && text.lines().count() == 1, "{text}");
    fs::remove_dir(place.join("sessions/P01-trial-01-1.mcap.sealed")).unwrap();
    assert_eq!(report(&["user-study", "note", study, "--text", "it is over"]), "");
    assert!(!place.join("sessions/P01-trial-01-1.mcap").exists());
}

#[test]
fn bad_studies_and_steps_are_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("study");
    let study = place.to_str().unwrap();
    let new = |file: &str| refused(&["user-study", "new", file, "--out", study]);
    let with = |head: &str, conditions: &str| file(folder.path(), head, 3.0, conditions);
    assert!(new("nowhere.toml").contains("paper, short"));
    assert!(new(&with("participants = 0\ntrials = 1", BLIND)).contains("participants = 0"));
    assert!(new(&with("participants = 0\ntrials = 0", BLIND)).contains("2 errors"));
    assert!(new(&with("participants = 2\ntrials = 1\nrings = 2", BLIND)).contains("has none"));
    assert!(new(&with("participants = 2\ntrials = 1\nrig = 'desktop'", BLIND)).contains("desktop"));
    assert!(!place.exists(), "a file with mistakes creates nothing");
    report(&["user-study", "new", &with("participants = 2\ntrials = 1", BLIND), "--out", study]);
    assert!(new("short").contains("already exists"));
    let next = |more: &[&str]| refused(&[&["user-study", "next", study, "--participant"], more].concat());
    assert!(next(&["P07", "--virtual"]).contains("P01, P02") || next(&["P07", "--virtual"]).contains("P01 to P02"));
    assert!(next(&["P01"]).contains("--virtual"));
    assert!(next(&["P01", "--answers", "realism = 3"]).contains("takes no answers"));
    assert!(refused(&["user-study", "status", folder.path().to_str().unwrap()]).contains("study.toml"));
    assert!(refused(&["user-study", "unblind", study, "--name", " ", "--reason", "x"]).contains("requires a name"));
    let empty = report(&["study-report", study]);
    assert!(
        fs::read_to_string(place.join("report/report.html")).unwrap().contains("Nothing to compare yet"),
        "{empty}"
    );
}
