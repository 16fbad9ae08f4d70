//! Recordings of other programs: missing signals are unknown on the screen.

use std::sync::Arc;

use nima_recording::csv::{ColumnMapping, Signals, read_signals};

use super::*;

/// Opens a table and waits until its last moment is shown.
fn look(folder: &Path, text: &str) -> Playback {
    let path = folder.join("table.csv");
    std::fs::write(&path, text).unwrap();
    let signals = read_signals(&path, &ColumnMapping::default()).unwrap();
    let mut past = Playback::open_signals(&path, &Arc::new(signals), &Context::default());
    until(&mut past, "shown", |past| past.live.as_ref().is_some_and(|live| live.ticks[0].is_some()));
    until(&mut past, "at its end", |past| (past.shown_s() - past.wanted_s).abs() < 1e-9);
    past
}

fn known(values: &[f64]) -> Vec<Option<f64>> {
    values.iter().map(|value| value.is_finite().then_some(*value)).collect()
}

#[test]
fn a_table_of_forces_only_is_shown_and_the_rest_is_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let row = |number: u32| {
        let t_s = 100.0 + f64::from(number) * 0.01;
        // The force along z is missing for a while.
        let z = if (200..300).contains(&number) { String::new() } else { "-2".to_owned() };
        format!("{t_s},1.5,{z}\n")
    };
    let text: String = std::iter::once("t_s,fx_n,fz_n\n".to_owned()).chain((0..600).map(row)).collect();
    let mut past = look(folder.path(), &text);
    assert!((past.shown_s() - 5.99).abs() < 1e-9, "it opens at the end: {} s", past.shown_s());
    let live = past.live.as_ref().unwrap();
    let tick = live.ticks[0].unwrap();
    assert_eq!(known(tick.measured_n.as_slice()), [Some(1.5), None, Some(-2.0)]);
    assert_eq!(known(tick.positions.tip_m.as_slice()), [None; 3]);
    assert_eq!(known(tick.positions.leader_m.as_slice()), [None; 3]);
    assert_eq!(known(tick.rendering.rendered_n.as_slice()), [None; 3]);
    let history = &live.history[0];
    let around = |channel, t_s: f64| history.extent(&[channel], (t_s - 0.1, t_s + 0.1));
    let expected = [Some((1.5, 1.5)), None, Some((-2.0, -2.0))];
    assert_eq!([around(0, 2.5), around(2, 2.5), around(2, 1.0)], expected, "a gap, not zero");
    for unknown in [1, 3, 6, 7, 9, 12] {
        assert_eq!(history.extent(&[unknown], (0.0, 6.0)), None, "channel {unknown}");
    }
    // The bars of the time line are computed from the known axes.
    let bars: Vec<_> = past.overview.buckets.iter().map(|bucket| (bucket.measured_n, bucket.rendered_n)).collect();
    assert_eq!((bars.len(), bars[0], bars[5]), (12, (Some(2.5), None), (Some(1.5), None)));
    past.show(2.5);
    until(&mut past, "moved", |past| (past.shown_s() - 2.5).abs() < 0.02);
    assert_eq!(known(past.live.as_ref().unwrap().ticks[0].unwrap().measured_n.as_slice()), [Some(1.5), None, None]);
    let before_s = past.shown_s();
    past.toggle();
    past.step(0.5, false);
    until(&mut past, "plays", |past| past.shown_s() > before_s + 0.4);
}

#[test]
fn the_faults_of_another_programs_file_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    std::fs::write(&path, "t_s,fx_n\n0,1\n0.5,2\n1,3\n").unwrap();
    let signals = read_signals(&path, &ColumnMapping::default()).unwrap();
    let signals = Signals { notes: vec!["it is truncated".to_owned()], ..signals };
    let mut past = Playback::open_signals(&path, &Arc::new(signals), &Context::default());
    until(&mut past, "what is missing", |past| !past.report.lacks.is_empty());
    assert!(past.report.trouble().unwrap().contains("it is truncated"));
}

#[test]
fn a_slow_recording_is_one_line_and_its_pause_a_gap() {
    let folder = tempfile::tempdir().unwrap();
    let row = |number: u32| format!("{},{}\n", f64::from(number) * 0.1 + if number < 50 { 0.0 } else { 3.0 }, number);
    let text: String = std::iter::once("t_s,z_m\n".to_owned()).chain((0..100).map(row)).collect();
    let past = look(folder.path(), &text);
    let mut line = nima_screen::history::PlotTrace::default();
    past.live.as_ref().unwrap().history[0].trace(11, (0.0, 13.0), 0.0, 10_000, &mut line);
    assert_eq!(line.runs().count(), 2);
}

#[test]
fn a_recording_that_is_opened_in_the_window_is_recognized_by_its_contents() {
    let folder = tempfile::tempdir().unwrap();
    let [table, other] = ["table.csv", "other.csv"].map(|name| folder.path().join(name));
    std::fs::write(&table, "t_s,fx_n\n0,1\n0.5,2\n1,3\n").unwrap();
    let mut past = open(&table);
    until(&mut past, "at its end", |past| past.live.is_some() && (past.shown_s() - 1.0).abs() < 1e-9);
    assert!(past.is_foreign() && past.refused().is_none());
    assert_eq!(known(past.live.as_ref().unwrap().ticks[0].unwrap().measured_n.as_slice()), [Some(3.0), None, None]);

    let mut beside = open(&table);
    beside.show(0.5);
    until(&mut beside, "at the time of a comparison", |past| past.live.is_some() && past.is_foreign());
    until(&mut beside, "still there", |past| (past.shown_s() - 0.5).abs() < 1e-9);

    std::fs::write(&other, "t_s,load\n0,1\n0.5,2\n1,3\n").unwrap();
    let mut past = open(&other);
    until(&mut past, "refused", |past| past.refused().is_some());
    let why = past.refused().unwrap();
    assert!(why.contains("load") && why.contains("nima view FILE --map"), "{why}");
}
