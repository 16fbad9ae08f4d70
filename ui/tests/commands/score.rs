//! Tests: from recorded sessions to a table of trials, and from such a table to the answer.
use std::{
    collections::BTreeMap,
    fmt::Write as _,
    path::Path,
    process::{Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use nima_recording::session::{ChannelId, SessionReader, SessionWriter};
use serde_json::Value;

use crate::{
    every_command::{json, nima},
    export::record,
};

fn refused(arguments: &[&str]) -> String {
    let output = nima(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{arguments:?} succeeded");
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}

#[test]
fn sessions_are_scored_and_become_a_table_of_trials() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let sessions = [at("a.mcap"), at("b.mcap")];
    for (session, mode) in sessions.iter().zip(["best", "dfr"]) {
        let run = ["run", "--virtual", "--seconds", "10", "--scene", "bimanual", "--mode", mode, "--record", session];
        assert!(nima(&run).status.success());
    }
    let score = json(&["score", &sessions[0], "--json"]);
    let value = |key: &str| score[key].as_f64().unwrap_or_else(|| panic!("{key}: {score}"));
    assert!((9.0..10.0).contains(&value("completion_time_s")), "{score}");
    for side in ["left", "right"] {
        assert!((0.05..2.0).contains(&value(&format!("path_length_m_{side}"))), "{score}");
        assert!((0.5..4.5).contains(&value(&format!("peak_force_n_{side}"))), "{score}");
    }
    assert_eq!(score["drops_out_of_view"], Value::Null, "there was nothing to drop: {score}");
    let part = json(&["score", &sessions[0], "--from", "2", "--to", "5", "--json"]);
    assert!((part["completion_time_s"].as_f64().unwrap() - 3.0).abs() < 0.01, "{part}");

    let out = at("trials.csv");
    let report = nima(&["score", &sessions[0], &sessions[1], "--participant", "p1", "--out", &out]);
    assert!(report.status.success(), "{}", String::from_utf8_lossy(&report.stderr));
    let table = std::fs::read_to_string(&out).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[0].starts_with("participant,condition,trial,session,complete,") && lines.len() == 3, "{table}");
    assert!(lines[1].starts_with("p1,best 50 ms,1,") && lines[2].starts_with("p1,dfr 50 ms,2,"), "{table}");
    assert!(nima(&["study", "trials", &out]).status.success(), "the table is one of trials");

    assert!(refused(&["score", &at("absent.mcap")]).contains("absent.mcap"));
    assert!(refused(&["score", &sessions[0], &sessions[1], "--from", "1"]).contains("a single session"));
    std::fs::write(at("task.toml"), "name = 'x'\nkind = 'palpation'\ntime_limit_s = -1.0").unwrap();
    assert!(refused(&["score", &sessions[0], "--task", &at("task.toml")]).contains("time_limit_s"));
    let idle = at("idle.mcap");
    let run = ["run", "--virtual", "--seconds", "1", "--scene", "gravity", "--record", &idle];
    nima(&run);
    if Path::new(&idle).exists() {
        assert!(refused(&["score", &idle]).contains("no trial"));
    }
}

#[test]
fn a_table_of_trials_gives_the_answer_with_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let mut table = "participant,condition,trial,time_s\n".to_owned();
    for participant in 0..8 {
        for (condition, time_s) in [("dfr", 60.0), ("matched", 51.0)] {
            let skill_s = f64::from(participant * participant % 7);
            writeln!(table, "p{participant},{condition},1,{}", time_s + skill_s + f64::from(participant) * 0.1)
                .unwrap();
        }
    }
    std::fs::write(at("trials.csv"), table).unwrap();
    let report = json(&["study", "trials", &at("trials.csv"), "--reference", "dfr", "--json", "--out", &at("out")]);
    let pair = &report["measures"][0]["pairs"][0];
    assert_eq!((&pair["first"], &pair["second"]), (&Value::from("matched"), &Value::from("dfr")));
    assert!((pair["difference"]["estimate"].as_f64().unwrap() + 9.0).abs() < 1e-6, "{pair}");
    // All eight differ in the same direction, as in 2 of the 256 combinations.
    assert!((pair["p"].as_f64().unwrap() - 2.0 / 256.0).abs() < 1e-9, "{pair}");
    for name in ["analysis.json", "analysis.md", "analysis.csv", "analysis.R"] {
        assert!(folder.path().join("out").join(name).exists(), "{name}");
    }
    assert!(refused(&["study", "trials", &at("trials.csv"), "--reference", "none"]).contains("dfr, matched"));
    assert!(refused(&["study", "trials", &at("trials.csv"), "--measure", "force_n"]).contains("force_n"));
    assert!(refused(&["study", "trials", &at("absent.csv")]).contains("absent.csv"));
}

#[test]
fn a_run_of_a_training_scene_is_scored_and_its_seed_can_be_given() {
    let run = |scene: &str, seconds: &str, more: &[&str]| {
        let run = ["run", "--virtual", "--scene", scene, "--seconds", seconds, "--json"];
        json(&[&run[..], more].concat())
    };
    let number = |report: &Value, key: &str| report["score"][key].as_f64().unwrap_or_else(|| panic!("{key}: {report}"));
    let lumps = run("find_lumps", "115", &["--seed", "5"]);
    let [found, missed] = ["lumps_found", "lumps_missed"].map(|key| number(&lumps, key));
    assert!(found >= 4.0 && (found + missed - 5.0).abs() < 1e-9 && number(&lumps, "lumps_false") <= 1.0, "{lumps}");
    assert!((1.0..6.0).contains(&number(&lumps, "lump_peak_force_n_right")), "{lumps}");
    assert_eq!(lumps["score"]["jaw_openings_right"], Value::Null, "there are no jaws");
    let wire = run("wire", "40", &[]);
    assert!(number(&wire, "completion_time_s") > 5.0 && number(&wire, "path_length_m_right") > 0.1, "{wire}");
    assert!(number(&wire, "wire_touches") >= 1.0 && number(&wire, "wire_touch_time_s") > 0.0, "{wire}");
    let other = run("wire", "2", &["--seed", "32"]);
    assert_ne!(other["score"]["path_length_m_right"], run("wire", "2", &[])["score"]["path_length_m_right"]);
    let output = nima(&["run", "--virtual", "--scene", "wire", "--seed", "many"]);
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains("--seed"));
}

/// Copies the messages of a session; returns the new one, and the last message of the right arm's forces.
fn copied(from: &str, to: &str) -> (SessionWriter, (ChannelId, u64, Vec<u8>)) {
    let reader = SessionReader::open(Path::new(from)).unwrap();
    let mut writer = SessionWriter::create(Path::new(to), reader.library()).unwrap();
    let mut channels = BTreeMap::new();
    let mut last = None;
    for message in reader.messages(&[], 0..u64::MAX) {
        let message = message.unwrap();
        let of = reader.channels().iter().find(|channel| channel.id == message.channel()).unwrap();
        let channel = *channels
            .entry(of.topic.clone())
            .or_insert_with(|| writer.channel(&of.topic, of.encoding.clone()).unwrap());
        writer.message(channel, message.log_time_ns(), message.data()).unwrap();
        if of.topic == "right/forces" {
            last = Some((channel, message.log_time_ns(), message.data().to_vec()));
        }
    }
    (writer, last.unwrap())
}

/// Copies a session with a further message, dated 30 years after its end.
fn with_a_late_message(from: &str, to: &str) {
    let (mut writer, (channel, time_ns, data)) = copied(from, to);
    writer.message(channel, time_ns + 1_000_000_000_000_000_000, &data).unwrap();
    writer.flush().unwrap();
}

/// Returns what `nima score` reports; panics if it takes more than a minute.
fn scored(session: &str, out: &str) -> (String, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_nima"))
        .args(["score", session, "--out", out])
        .env("NIMA_DATA_DIR", "/dev/null/no/such/folder")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let began = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if began.elapsed() > Duration::from_mins(1) {
            child.kill().unwrap();
            panic!("{session} takes too long");
        }
        sleep(Duration::from_millis(20));
    }
    let output = child.wait_with_output().unwrap();
    let report = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{report}");
    (report, std::fs::read_to_string(out).unwrap().lines().nth(1).unwrap().to_owned())
}

#[test]
fn a_session_that_is_not_whole_is_reported_and_marked_in_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    record(&at("whole.mcap"), "bimanual", "4");
    let (report, row) = scored(&at("whole.mcap"), &at("whole.csv"));
    assert!(report.is_empty() && row.contains(".mcap,yes,"), "{report}{row}");

    let whole = std::fs::read(at("whole.mcap")).unwrap();
    std::fs::write(at("cut.mcap"), &whole[..whole.len() * 6 / 10]).unwrap();
    let mut damaged = whole.clone();
    damaged[whole.len() / 2] ^= 0xff;
    std::fs::write(at("damaged.mcap"), damaged).unwrap();
    with_a_late_message(&at("whole.mcap"), &at("late.mcap"));
    for (name, words) in
        [("cut", "the recording was not closed"), ("late", "it has no ticks from 3.999 s to 1000000003.")]
    {
        let (report, row) = scored(&at(&format!("{name}.mcap")), &at(&format!("{name}.csv")));
        assert!(report.contains(words) && row.contains(".mcap,no,"), "{name}: {report}{row}");
        for command in [&["export", "--out", "x.csv", "--arm", "right"][..], &["replay"], &["report", "--json"]] {
            let rest = command[1..]
                .iter()
                .map(|word| if *word == "x.csv" { at(&format!("{name}-x.csv")) } else { (*word).to_owned() });
            let all: Vec<String> =
                [command[0].to_owned(), at(&format!("{name}.mcap"))].into_iter().chain(rest).collect();
            let output = nima(&all.iter().map(String::as_str).collect::<Vec<_>>());
            let told = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(told.contains(words), "{all:?}: {told}");
        }
    }
    // An excerpt of a damaged session is closed, but lacks the same data.
    let exported = nima(&["export", &at("cut.mcap"), "--out", &at("excerpt.mcap")]);
    assert!(exported.status.success(), "{exported:?}");
    let (report, row) = scored(&at("excerpt.mcap"), &at("excerpt.csv"));
    assert!(report.contains("the recording was not closed") && row.contains(".mcap,no,"), "{report}{row}");
    let report = nima(&["score", &at("damaged.mcap")]);
    let told = String::from_utf8_lossy(&report.stderr).into_owned();
    assert!(told.contains("damaged.mcap: ") && told.contains("chunk"), "{told}");
}

#[test]
fn metadata_of_another_program_never_reach_the_terminal_as_control_characters() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    record(&at("whole.mcap"), "bimanual", "4");
    let [foreign, table] = ["foreign.mcap", "foreign.csv"].map(at);
    let (mut writer, _) = copied(&at("whole.mcap"), &foreign);
    let entries = [("mode", "\u{1b}[31mred\r\n\u{202e}\u{7}"), ("delay_s", "\u{1b}]0;title\u{7}")];
    let entries = entries.map(|(key, value)| (key.to_owned(), value.to_owned()));
    writer.metadata("session", &BTreeMap::from(entries)).unwrap();
    writer.finish().unwrap();
    let more: [&[&str]; 2] = [&["--out", &table], &["--json"]];
    for more in more {
        let output = nima(&[&["score", foreign.as_str()][..], more].concat());
        let text = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
        assert!(output.status.success() && text.contains("u{1b}[31mred"), "{text:?}");
        assert!(!text.contains(|c: char| (c.is_control() && c != '\n') || c == '\u{202e}'), "{text:?}");
    }
    let table = std::fs::read_to_string(&table).unwrap();
    assert!(table.lines().count() == 2 && !table.contains(|c: char| c.is_control() && c != '\n'), "{table:?}");
}
