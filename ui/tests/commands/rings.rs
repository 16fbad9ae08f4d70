//! Training tasks, recorded: the counts of the run are computed again from its session.

use std::path::Path;

use nima_recording::session::SessionReader;
use nima_session::{
    file::{LineKind, RecordedFile},
    objects,
};
use serde_json::Value;

use crate::{
    every_command::{json, nima},
    export::done,
};

/// Returns the scene with one ring, which two simulated hands carry over and back in about twenty seconds.
fn scene(folder: &Path) -> String {
    let text = include_str!("../../../config/scenes/rings.toml");
    let one = text.replace("[objects]", "[objects]\nrings = [{ peg = 1 }]");
    assert!(one != text, "the scene has the section of objects");
    let path = folder.join("one_ring.toml");
    std::fs::write(&path, one).unwrap();
    path.display().to_string()
}

fn record(scene: &str, seconds: &str, path: &str) -> Value {
    let run = ["run", "--virtual", "--scene", scene, "--mode", "matched", "--seconds", seconds, "--record", path];
    json(&[&run[..], &["--json"]].concat())["score"].take()
}

/// Checks that every measure of the run equals the score of its session, bit by bit.
fn same(run: &Value, session: &Value) {
    let run = run.as_object().unwrap();
    assert!(run.len() > 50, "{run:?}");
    for (key, value) in run {
        assert_eq!(Some(value), session.get(key), "{key}");
    }
}

#[test]
fn the_score_of_a_session_is_that_of_its_run() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let scene = scene(folder.path());
    let [whole, part, shared, early] = ["whole.mcap", "part.mcap", "shared.mcap", "early.mcap"].map(at);
    let run = record(&scene, "26", &whole);
    for (key, expected) in [("transfers", 2.0), ("lifts", 2.0), ("rings_placed", 2.0), ("drops", 0.0)] {
        assert_eq!(run[key].as_f64(), Some(expected), "{key}: {run}");
    }
    let value = |key: &str| run[key].as_f64().unwrap_or_else(|| panic!("{key}: {run}"));
    let points = 300.0 - value("completion_time_s");
    assert!(value("completion_time_s") < 25.0 && (value("fls_like_score") - points).abs() < 1e-9, "{run}");
    assert!(value("jaw_openings_left") >= 1.0 && value("jaw_openings_right") >= 1.0, "{run}");
    assert!((0.5..10.0).contains(&value("time_to_first_grasp_s")), "{run}");
    let scored = json(&["score", &whole, "--json"]);
    assert_eq!(scored["task"], "Rings on pegs");
    same(&run, &scored);
    // Rings are not an input of the loop.
    assert_eq!(json(&["replay", &whole, "--json"])["differs"], Value::Null);
    done(&["export", &whole, "--out", &shared, "--anonymous"]);
    same(&run, &json(&["score", &shared, "--json"]));
    let lines = RecordedFile::open(Path::new(&shared)).unwrap().log(0..u64::MAX).unwrap();
    let report: Vec<_> = lines.iter().filter(|line| line.kind == LineKind::Happening).collect();
    assert!(report.len() == 9 && report.iter().all(|line| line.words != "(withheld)"), "{report:?}");
    done(&["export", &whole, "--out", &part, "--from", "4", "--to", "12"]);
    let [of_part, of_whole] =
        [json(&["score", &part, "--json"]), json(&["score", &whole, "--from", "4", "--to", "12", "--json"])];
    assert_eq!((&of_part["transfers"], &of_part["completion_time_s"]), (&Value::from(1.0), &Value::Null), "{of_part}");
    same(&of_whole.as_object().map(without_names).unwrap(), &of_part);

    // A trial that was not finished.
    same(&record("rings", "8", &early), &json(&["score", &early, "--json"]));
    let report = String::from_utf8(nima(&["score", &early]).stdout).unwrap();
    assert!(report.contains("task: Rings on pegs") && report.contains("lifts"), "{report}");

    let figures = json(&["report", &whole, "--out", &at("pages"), "--json"]);
    assert_eq!(figures["sessions"][0]["happenings"]["ring_transferred"], 2, "{figures}");
    let page = std::fs::read_to_string(folder.path().join("pages/report.html")).unwrap();
    for words in ["Events of the objects", "ring transferred", "ring 1 passed to the right instrument"] {
        assert!(page.contains(words), "{words}");
    }
    let reader = SessionReader::open(Path::new(&whole)).unwrap();
    assert!(objects::are_shown(&reader) && reader.notes().is_empty());
}

#[test]
fn the_scores_of_lumps_and_of_the_wire_are_those_of_their_runs() {
    let folder = tempfile::tempdir().unwrap();
    let lumps = include_str!("../../../config/scenes/find_lumps.toml")
        .replace("size_m = [0.12, 0.09]", "size_m = [0.06, 0.05]")
        .replace("count = 5", "count = 1");
    let wire = include_str!("../../../config/scenes/wire.toml").to_owned();
    // A hand that palpates faster than this mistakes a first touch for a lump.
    let tasks = [("lumps", lumps, "1.5", "40", "lumps_found"), ("wire", wire, "3.0", "14", "wire_touches")];
    for (name, scene, pace, seconds, key) in tasks {
        let at = |end: &str| folder.path().join(format!("{name}{end}")).display().to_string();
        let [file, whole, shared] = [".toml", ".mcap", "_shared.mcap"].map(at);
        std::fs::write(&file, scene.replace("[hand]", &format!("[hand]\npace = {pace}"))).unwrap();
        let run = record(&file, seconds, &whole);
        assert!(run[key].as_f64().is_some_and(|count| count >= 1.0) && run["completion_time_s"].is_f64(), "{run}");
        same(&run, &json(&["score", &whole, "--json"]));
        assert_eq!(json(&["replay", &whole, "--json"])["differs"], Value::Null);
        done(&["export", &whole, "--out", &shared, "--anonymous"]);
        same(&run, &json(&["score", &shared, "--json"]));
        let [of_whole, of_shared] = [&whole, &shared].map(|path| {
            let reader = SessionReader::open(Path::new(path)).unwrap();
            let (begin_ns, end_ns) = reader.statistics().times_ns;
            objects::at(&reader, begin_ns, end_ns).unwrap().unwrap().task.unwrap()
        });
        assert_eq!(of_whole, of_shared);
        assert!(of_whole.ended, "{of_whole:?}");
        match name {
            "lumps" => assert_eq!((of_whole.found, of_whole.marks.len() as u32), (1, of_whole.marked)),
            _ => assert_eq!(Some(f64::from(of_whole.touches)), run[key].as_f64()),
        }
    }
}

fn without_names(score: &serde_json::Map<String, Value>) -> Value {
    let names = ["session", "condition", "task"];
    score
        .iter()
        .filter(|(key, _)| !names.contains(&key.as_str()))
        .map(|(key, value)| (key.clone(), value.clone()))
        .collect()
}
