//! `nima sessions`: the list, and that only sessions that are not being recorded are ever deleted.
use std::{path::Path, process::Command, process::Output};

use nima_recording::session::SessionWriter;
use nima_tests::studies::everything;
use serde_json::Value;

use crate::anonymous::all_bytes;

fn nima(data: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nima")).args(arguments).env("NIMA_DATA_DIR", data).output().unwrap()
}

fn refused(data: &Path, arguments: &[&str], words: &str) {
    let output = nima(data, arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && output.stdout.is_empty(), "{arguments:?} succeeded");
    assert!(text.lines().count() == 1 && text.contains(words), "\"{words}\" is not in: {text}");
}

fn done(data: &Path, arguments: &[&str]) -> String {
    let output = nima(data, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn sessions_are_listed_kept_and_deleted_and_nothing_else_is() {
    let data = tempfile::tempdir().unwrap();
    let data = data.path();
    assert!(done(data, &["sessions"]).starts_with("0 sessions in "));
    let folder = data.join("sessions");
    std::fs::create_dir(&folder).unwrap();
    let at = |name: &str| folder.join(name);
    for name in ["a.mcap", "b.mcap"] {
        let path = at(name).display().to_string();
        done(data, &["run", "--virtual", "--seconds", "2", "--scene", "peg_transfer", "--record", &path]);
    }
    let whole = at("b.mcap").display().to_string();
    let part = at("part.mcap").display().to_string();
    done(data, &["export", &whole, "--out", &part, "--from", "0.5", "--to", "1.5"]);
    std::fs::write(at("empty.mcap"), []).unwrap();
    // In the state in which a process killed while recording leaves it: not finished.
    let mut killed = SessionWriter::create(&at("killed.mcap"), "a program").unwrap();
    killed.flush().unwrap();
    let outside = data.join("mine.mcap");
    std::fs::copy(at("a.mcap"), &outside).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(&outside, at("link.mcap")).unwrap();

    let list: Value = serde_json::from_str(&done(data, &["sessions", "--json"])).unwrap();
    let one = |name: &str| list["sessions"].as_array().unwrap().iter().find(|one| one["name"] == name).cloned();
    let first = one("a.mcap").unwrap();
    assert_eq!((&first["state"], &first["kept"]), (&Value::from("closed"), &Value::from(false)), "{first}");
    assert!(first["seconds"].as_f64().unwrap() > 1.9 && first["started"].as_str().unwrap().ends_with('Z'), "{first}");
    assert_eq!((&first["rig"], &first["last_fault"]), (&Value::from("Simulated rig"), &Value::Null));
    assert_eq!(one("empty.mcap").unwrap()["state"], "damaged");
    let stretch = one("part.mcap").unwrap();
    let [from_s, seconds] = ["stretch_from_s", "seconds"].map(|key| stretch[key].as_f64().unwrap());
    let is_right = (0.5..0.51).contains(&from_s) && (0.98..1.0).contains(&seconds);
    assert!(stretch["state"] == "stretch" && is_right, "{stretch}");
    assert_eq!(one("link.mcap"), None);
    #[cfg(unix)]
    {
        assert_eq!(one("killed.mcap").unwrap()["state"], "recording", "its file is locked");
        refused(data, &["sessions", "--delete", "killed"], "is being recorded");
    }
    drop(killed);
    let text = done(data, &["sessions"]);
    assert!(text.contains("killed.mcap: not closed") && text.contains("a.mcap: closed"), "{text}");

    done(data, &["sessions", "--keep", "a.mcap"]);
    refused(data, &["sessions", "--delete", "a"], "is kept: use --unkeep first");
    assert!(done(data, &["sessions"]).contains("a.mcap: closed") && at("a.mcap.kept").exists());
    done(data, &["sessions", "--unkeep", "a"]);
    for name in ["../mine", "../mine.mcap", "mine", "link", "link.mcap", "/etc/passwd", "", ".", "a.mcap.kept", "A"] {
        refused(data, &["sessions", "--delete", name], "not found in");
        refused(data, &["sessions", "--keep", name], "not found in");
    }
    refused(data, &["sessions", "--delete", "a", "--keep", "b"], "cannot be used with");
    for name in ["a", "killed.mcap", "empty"] {
        assert!(done(data, &["sessions", "--delete", name]).contains("is deleted"));
    }
    assert!(!at("a.mcap").exists() && at("b.mcap").exists() && outside.exists());
}

#[test]
fn a_session_and_its_report_have_no_password_of_the_camera() {
    let data = tempfile::tempdir().unwrap();
    let data = data.path();
    let [rig, session, report] = ["rig.toml", "run.mcap", "report"].map(|name| data.join(name).display().to_string());
    let camera = "\n[endoscope]\nurl = \"http://eva:s3cret@127.0.0.1:1/video?pwd=s3cret&fps=30\"\n";
    std::fs::write(&rig, include_str!("../../../config/rigs/simulated.toml").to_owned() + camera).unwrap();
    let run = nima(data, &["run", "--seconds", "1", "--rig", &rig, "--record", &session, "--log", "debug"]);
    done(data, &["report", &session, "--out", &report]);
    let mut seen = all_bytes(session.as_ref());
    seen.extend([run.stdout, run.stderr].concat());
    seen.extend(everything(report.as_ref()).into_bytes());
    let contains = |words: &str| memchr::memmem::find(&seen, words.as_bytes()).is_some();
    assert!(contains("http://127.0.0.1:1/video?pwd=&fps=30"), "the session names the camera");
    assert!(!contains("s3cret"), "in {} bytes", seen.len());
}
