//! `nima export`, and the commands that read a session themselves, as a user would type them.
use std::{collections::BTreeMap, path::Path};

use nima_recording::{
    messages::JointStateDecoder,
    session::{Encoding, SessionReader, SessionWriter},
};
use serde_json::Value;

use crate::every_command::{json, nima};

/// The one line of a command that must fail and leave no file.
pub(crate) fn refused(arguments: &[&str], words: &str) {
    let output = nima(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && output.stdout.is_empty(), "{arguments:?} succeeded");
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.contains(words), "\"{words}\" is not in: {text}");
}

pub(crate) fn done(arguments: &[&str]) -> String {
    let output = nima(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

pub(crate) fn record(path: &str, scene: &str, seconds: &str) {
    json(&["run", "--virtual", "--seconds", seconds, "--scene", scene, "--delay-ms", "40", "--record", path, "--json"]);
}

/// Returns the content of an arm's topic at each time: values by their names.
pub(crate) fn values(reader: &SessionReader, topic: &str) -> BTreeMap<u64, BTreeMap<String, f64>> {
    let message = |message: nima_recording::session::SessionMessage| {
        let mut read = JointStateDecoder::default();
        assert!(read.decode(message.data()), "{topic}");
        (message.log_time_ns(), read.names().iter().cloned().zip(read.values().iter().copied()).collect())
    };
    reader.messages(&[topic], 0..u64::MAX).map(|read| message(read.unwrap())).collect()
}

/// Checks that every row of a table matches the messages of its time bit by bit.
fn agrees(session: &str, table: &str, arm: &str) -> usize {
    let reader = SessionReader::open(Path::new(session)).unwrap();
    let topics = ["forces", "poses"].map(|what| values(&reader, &format!("{arm}/{what}")));
    let text = std::fs::read_to_string(table).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let parts =
        [("", "tip", "_m"), ("f", "measured", "_n"), ("leader_", "leader", "_m"), ("delayed_", "delayed", "_n")];
    let parts = parts.into_iter().chain([("asked_", "asked", "_n"), ("rendered_", "rendered", "_n")]);
    let columns: Vec<(usize, String)> = parts
        .flat_map(|(prefix, name, unit)| {
            ["x", "y", "z"].map(|axis| (format!("{prefix}{axis}{unit}"), format!("{arm}.{name}.{axis}{unit}")))
        })
        .map(|(column, signal)| (header.iter().position(|one| *one == column).unwrap(), signal))
        .collect();
    assert_eq!((columns.len(), header.len()), (18, 21));
    let mut rows = 0;
    for row in lines {
        let time_ns: u64 = row[1].parse().unwrap();
        for (column, signal) in &columns {
            let said = topics.iter().find_map(|topic| topic[&time_ns].get(signal)).unwrap();
            // An unknown value is an empty field.
            let field = if row[*column].is_empty() { f64::NAN } else { row[*column].parse().unwrap() };
            assert_eq!(field.to_bits(), said.to_bits(), "{signal} at {time_ns}");
        }
        rows += 1;
    }
    rows
}

/// Returns the results without the times of this computer.
fn figures(arguments: &[&str]) -> Value {
    let mut figures = json(arguments);
    figures.as_object_mut().unwrap().remove("tick_us").unwrap();
    figures
}

#[test]
fn a_table_has_the_values_of_the_messages_and_identify_makes_the_same_of_both() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let session = at("s.mcap");
    let right = at("right.csv");
    let left = at("left.csv");
    let part = at("part.csv");
    record(&session, "bimanual", "4");
    let report = done(&["export", &session, "--out", &right, "--arm", "right"]);
    assert!(report.contains("4000 ticks of the right arm"), "{report}");
    done(&["export", &session, "--out", &left, "--arm", "left"]);
    assert_eq!((agrees(&session, &right, "right"), agrees(&session, &left, "left")), (4000, 4000));
    done(&["export", &session, "--out", &part, "--arm", "left", "--from", "1", "--to", "2.5"]);
    assert_eq!(agrees(&session, &part, "left"), 1500);
    let text = std::fs::read_to_string(&part).unwrap();
    assert!(text.lines().nth(1).unwrap().starts_with("1,") && text.contains(",Engaged\n"), "{text:.200}");
    for (arm, table) in [("right", &right), ("left", &left)] {
        let ours = figures(&["identify", &session, "--arm", arm, "--delay-ms", "40", "--json"]);
        assert_eq!(ours, figures(&["identify", table, "--delay-ms", "40", "--json"]), "{arm}");
        assert_eq!(ours["samples"], 4000);
    }
    let a = at("a.csv");
    let b = at("b.csv");
    done(&["identify", &session, "--arm", "left", "--out", &a]);
    done(&["identify", &left, "--out", &b]);
    assert!(std::fs::read(a).unwrap() == std::fs::read(b).unwrap(), "the traces differ");

    refused(&["export", &session, "--out", &at("new.csv")], "choose one with --arm");
    refused(&["identify", &session], "choose one with --arm");
    refused(&["export", &session, "--out", &left, "--arm", "left"], "it already exists");
    refused(&["export", &session, "--out", &at("new.txt")], "end in .csv, .mcap, .json or .xml");
    refused(&["export", &session, "--out", &at("new.mcap"), "--arm", "left"], "keeps both arms");
    refused(&["export", &session, "--out", &at("new.csv"), "--arm", "middle"], "right or left");
    refused(&["export", &session, "--out", &at("new.csv"), "--from", "4.5"], "after the end");
    refused(&["export", &session, "--out", &at("new.csv"), "--from", "3", "--to", "2"], "is not before --to 2");
    refused(&["export", &session, "--out", &at("no/such/new.mcap")], "cannot write");
    refused(&["identify", &left, "--arm", "left"], "is a table");
    refused(&["identify", &session, "--map", "x=a"], "is a session");
    assert!(!Path::new(&at("new.csv")).exists() && !Path::new(&at("new.mcap")).exists());
}

#[test]
fn a_layout_for_viewers_comes_out_of_a_session_and_stays_in_an_anonymous_one() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let session = at("s.mcap");
    let shared = at("shared.mcap");
    record(&session, "peg_transfer", "1");
    done(&["export", &session, "--out", &shared, "--anonymous"]);
    for (name, begin) in [("layout.json", "{"), ("layout.xml", "<?xml")] {
        let of_session = at(name);
        let of_shared = at(&format!("shared-{name}"));
        done(&["export", &session, "--out", &of_session]);
        done(&["export", &shared, "--out", &of_shared]);
        let text = std::fs::read_to_string(of_session).unwrap();
        assert!(text.starts_with(begin) && text.contains("right") && !text.contains("left"), "{text:.300}");
        assert!(text == std::fs::read_to_string(of_shared).unwrap(), "{name} differs in the anonymous session");
    }
    refused(&["export", &session, "--out", &at("layout.json")], "it already exists");
    refused(&["export", &session, "--out", &at("other.json"), "--from", "1"], "omit --arm");
}

#[test]
fn studies_make_the_same_of_a_session_and_of_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let session = at("one.mcap");
    let table = at("one.csv");
    record(&session, "peg_transfer", "5");
    done(&["export", &session, "--out", &table]);
    let study = |file: &str| json(&["study", "baselines", "--recording", file, "--delay-ms", "50", "--json"]);
    assert_eq!(study(&session), study(&table));
    // Computing times differ between runs; results do not.
    let errors = |file: &str| {
        let study = json(&["study", "tradeoff", "--quick", "--recording", file, "--json"]);
        let text = study.to_string();
        let error = |part: &str| part.split([',', '}']).next().unwrap().to_owned();
        text.split("\"error\":").skip(1).map(error).collect::<Vec<_>>()
    };
    let ours = errors(&session);
    assert!(!ours.is_empty());
    assert_eq!(ours, errors(&table));
}

#[test]
fn a_stretch_is_a_session_with_all_that_was_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let session = at("s.mcap");
    let begin = at("begin.mcap");
    let middle = at("middle.mcap");
    let inner = at("inner.mcap");
    record(&session, "peg_transfer", "4");
    let report = done(&["export", &session, "--out", &begin, "--to", "2"]);
    assert!(report.contains("with the journal up to the end of the excerpt"), "{report}");
    let replayed = json(&["replay", &begin, "--json"]);
    assert_eq!((&replayed["identical"], &replayed["ticks"]), (&Value::from(true), &Value::from(2000)), "{replayed}");
    let report = done(&["export", &session, "--out", &middle, "--from", "1", "--to", "3"]);
    assert!(report.contains("without the journal"), "{report}");
    refused(&["replay", &middle], "no journal");
    done(&["export", &middle, "--out", &inner, "--from", "1.5", "--to", "2"]);

    let open = |path: &str| SessionReader::open(Path::new(path)).unwrap();
    let all = |path: &str| {
        let reader = open(path);
        let topic = |id| reader.channels().iter().find(|channel| channel.id == id).unwrap().topic.clone();
        let one = |message: nima_recording::session::SessionMessage| {
            (message.log_time_ns(), topic(message.channel()), message.data().to_vec())
        };
        reader.messages(&[], 0..u64::MAX).map(|read| one(read.unwrap())).collect::<Vec<_>>()
    };
    let whole = all(&session);
    let begin_ns = whole[0].0;
    for (path, from_s, to_s, journal) in
        [(&begin, 0.0, 2.0, true), (&middle, 1.0, 3.0, false), (&inner, 1.5, 2.0, false)]
    {
        let inside = |(time_ns, topic, _): &&(u64, String, Vec<u8>)| {
            let t_s = (time_ns - begin_ns) as f64 / 1e9;
            (from_s..to_s).contains(&t_s) && (journal || topic != "nima/journal")
        };
        let expected: Vec<_> = whole.iter().filter(inside).cloned().collect();
        let found = all(path);
        assert_eq!(found.len(), expected.len(), "{path}");
        let differs = found.iter().zip(&expected).position(|(found, expected)| found != expected);
        let about = |(time_ns, topic, _): &(u64, String, Vec<u8>)| (time_ns - begin_ns, topic.clone());
        assert!(differs.is_none(), "{path}: {:?}", differs.map(|at| (at, about(&found[at]), about(&expected[at]))));
        assert!(expected.len() > 1000);
        let cut = open(path);
        let from = open(&session);
        assert!(cut.notes().is_empty());
        let files = |reader: &SessionReader| {
            let file = |one| (reader.attachment(one).unwrap(), one.name.clone(), one.media_type.clone());
            reader.attachments().iter().map(file).collect::<Vec<_>>()
        };
        assert!(files(&cut) == files(&from) && files(&cut).len() >= 2);
        let mut tables = cut.metadata().unwrap();
        let (name, report) = tables.pop().unwrap();
        assert_eq!(tables, from.metadata().unwrap());
        let report = |key: &str| report[key].as_str();
        assert_eq!(
            (name.as_str(), report("from_s"), report("to_s")),
            ("cut", &*from_s.to_string(), &*to_s.to_string())
        );
        assert_eq!(report("journal").starts_with("kept"), journal);
        assert_eq!(report("session_begins_ns"), begin_ns.to_string());
        assert_eq!(report("session"), "s.mcap");
    }
    // Times in an excerpt are the times of the session.
    let a = at("a.csv");
    let b = at("b.csv");
    done(&["export", &inner, "--out", &a]);
    done(&["export", &session, "--out", &b, "--from", "1.5", "--to", "2"]);
    assert!(std::fs::read(a).unwrap() == std::fs::read(b).unwrap());
}

#[test]
fn what_is_no_session_is_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(at("empty.mcap"), []).unwrap();
    std::fs::write(at("foreign.mcap"), "t_s,x_m,fx_n\n0,1,2\n").unwrap();
    std::fs::write(at("cut.mcap"), b"\x89MCAP0").unwrap();
    std::fs::write(at("newer.mcap"), b"\x89MCAP1\r\n and more").unwrap();
    let mut other = SessionWriter::create(Path::new(&at("other.mcap")), "another program").unwrap();
    let channel = other.channel("words", Encoding { message_encoding: "text".into(), ..Encoding::default() }).unwrap();
    other.message(channel, 1, b"one").unwrap();
    other.finish().unwrap();
    let bad = [
        ("empty.mcap", "is empty"),
        ("foreign.mcap", "is not a session"),
        ("cut.mcap", "within its first bytes"),
        ("newer.mcap", "version 1"),
        ("other.mcap", "no forces of an arm"),
        ("absent.mcap", "cannot read"),
    ];
    for (name, words) in bad {
        refused(&["export", &at(name), "--out", &at("new.csv")], words);
        refused(&["identify", &at(name)], words);
        refused(&["study", "baselines", "--recording", &at(name)], words);
    }
    for (name, words) in &bad[..4] {
        refused(&["export", &at(name), "--out", &at("new.mcap")], words);
    }
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 5, "{left:?}");
}
