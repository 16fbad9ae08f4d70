//! Damaged, cut and foreign files.

use nima_session::completeness;

use super::*;

#[test]
fn damage_costs_what_is_damaged_and_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "peg_transfer", 10.0, |_| None);
    let ticks = replayed(&path);
    let mut bytes = std::fs::read(&path).unwrap();
    let middle = bytes.len() * 6 / 10;
    bytes[middle..middle + 64].fill(0xa5);
    std::fs::write(&path, bytes).unwrap();
    let mut past = open(&path);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    assert!(past.report.limited.is_some() && past.refused().is_none(), "{:?}", past.report);
    settled(&mut past, 2.0);
    assert!(same(&past.live.as_ref().unwrap().ticks, &ticks[2000]));
    past.show(9.0);
    past.live = None;
    until(&mut past, "shown behind the damage", |past| past.live.is_some());
    let shown = past.live.as_ref().unwrap().ticks[0].unwrap();
    assert_eq!((shown.t_s, shown.measured_n), (9.0, ticks[9000][0].unwrap().measured_n));
}

#[test]
fn what_a_session_lacks_is_shown_as_the_commands_report_it() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, cut] = ["whole.mcap", "cut.mcap"].map(|name| folder.path().join(name));
    record(&whole, "peg_transfer", 4.0, |_| None);
    let bytes = std::fs::read(&whole).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let missing = |path: &Path| completeness::missing(&SessionReader::open(path).unwrap());
    assert_eq!(missing(&whole), [""; 0]);
    let lines = missing(&cut);
    assert!(lines.iter().any(|line| line.contains("was not closed")), "{lines:?}");
    let mut past = open(&cut);
    until(&mut past, "what is missing", |past| !past.report.lacks.is_empty());
    let shown = past.report.trouble().unwrap();
    assert!(lines.iter().all(|line| shown.contains(line)), "{shown}");
}

#[test]
fn what_is_no_session_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    for content in ["", "not a session at all"] {
        std::fs::write(&path, content).unwrap();
        let mut past = open(&path);
        until(&mut past, "refused", |past| past.refused().is_some());
        assert!(!past.refused().unwrap().contains('\n') && past.live.is_none());
    }
}
