//! Statistics of a constructed session against values computed by hand.

use std::{collections::BTreeMap, f64::consts::TAU, path::Path};

use nima_core::safety::Gate;
use nima_recording::{
    messages::{JointStateEncoder, foxglove},
    session::SessionWriter,
};

use super::*;
use crate::topics::plots;

const START_NS: u64 = 1_700_000_000_000_000_000;

/// Ten seconds of one arm: idle for 2 s, engaged for 6 s with a force of `2 |sin(2 pi t)|` N along x, half of it
/// rendered while the force limit acts for 1.5 s; faulted for 2 s.
fn made(path: &Path) {
    let mut writer = SessionWriter::create(path, "test").unwrap();
    let table = BTreeMap::from([("rig".to_owned(), "<script>".to_owned()), ("rate_hz".to_owned(), "1000".to_owned())]);
    writer.metadata("session", &table).unwrap();
    let forces = writer.channel("right/forces", JointStateEncoder::encoding()).unwrap();
    let gates = writer.channel("right/gates", JointStateEncoder::encoding()).unwrap();
    let log = writer.channel("log", foxglove::encoding::<Log>()).unwrap();
    let encoder = |topic: &str| {
        let (_, names, _) = plots().into_iter().find(|(name, ..)| name == topic).unwrap();
        JointStateEncoder::new("world", &names.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let mut force = encoder("right/forces");
    let mut gate = encoder("right/gates");
    for i in 0..10_000_u32 {
        let t_s = f64::from(i) * 1e-3;
        let time_ns = START_NS + u64::from(i) * 1_000_000;
        let mut values = [0.0; 12];
        values[0] = 2.0 * (TAU * t_s).sin();
        values[9] = 0.5 * values[0];
        writer.message(forces, time_ns, force.encode(time_ns, &[], &[], &values).unwrap()).unwrap();
        let state = match i {
            0..2000 => 1.0,
            2000..8000 => 3.0,
            _ => 6.0,
        };
        let mut values = [0.0; 14];
        values[Gate::Permission.index()] = f64::from(u8::from(!(2000..8000).contains(&i)));
        values[Gate::Ceiling.index()] = f64::from(u8::from((3000..4500).contains(&i)));
        // Columns: stored energy, withheld force, state.
        values[10] = 0.1 - 1e-5 * f64::from(i);
        values[11] = 0.25;
        values[13] = state;
        writer.message(gates, time_ns, gate.encode(time_ns, &values, &[], &[]).unwrap()).unwrap();
        if i == 8000 {
            let report =
                Log { level: Level::Error as i32, message: "right arm: fault: a <b>".to_owned(), ..Log::default() };
            writer.message(log, time_ns, &report.encode_to_vec()).unwrap();
        }
    }
    writer.finish().unwrap();
}

fn near(value: f64, expected: f64, within: f64) {
    assert!((value - expected).abs() <= within, "{value} instead of {expected}");
}

#[test]
fn the_figures_of_a_made_session_are_those_of_the_books() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.mcap");
    made(&path);
    let figures = SessionFigures::read(&path).unwrap();
    near(figures.length_s, 9.999, 1e-9);
    assert_eq!((figures.closed, figures.arms.len(), figures.about["rig"].as_str()), (None, 1, "<script>"));
    let arm = &figures.arms[0];
    for (state, seconds) in [(1, 2.0), (3, 6.0), (6, 2.0), (5, 0.0)] {
        near(arm.seconds[state], seconds, 1e-6);
    }
    assert_eq!(arm.states.iter().map(|span| span.state).collect::<Vec<_>>(), [1, 3, 6]);
    near(arm.states[1].from_s, 2.0, 1e-6);
    near(arm.states[1].to_s, 8.0, 1e-6);
    // Six whole periods: the mean of |sin| is 2 / pi, and its standard deviation about zero is the amplitude over the
    // square root of two.
    let [measured, delayed, rendered] = arm.forces.map(Option::unwrap);
    near(measured.peak_n, 2.0, 1e-4);
    near(measured.mean_n, 4.0 / std::f64::consts::PI, 1e-4);
    near(measured.integral_n_s, 6.0 * 4.0 / std::f64::consts::PI, 1e-3);
    near(measured.principal_sd_n[0], 2.0_f64.sqrt(), 1e-4);
    near(measured.rate_peak_n_s, 2.0 * TAU, 1e-3);
    near(measured.rate_rms_n_s, 2.0_f64.sqrt() * TAU, 2e-3);
    assert!(measured.volume_n3 < 1e-9 && measured.samples == 6000, "a line has no volume: {measured:?}");
    near(rendered.mean_n, 2.0 / std::f64::consts::PI, 1e-4);
    near(delayed.peak_n, 0.0, 0.0);
    let fraction = |gate: Gate| arm.gates[gate.index()].fraction;
    near(fraction(Gate::Ceiling), 0.25, 1e-9);
    near(fraction(Gate::Permission), 0.4, 1e-9);
    near(arm.stored_min_j, 0.1 - 1e-5 * 7999.0, 1e-9);
    near(arm.withheld_mean_n, 0.25, 1e-9);
    let mark = &figures.marks[0];
    assert_eq!((mark.level, mark.words.as_str()), (MarkLevel::Error, "right arm: fault: a <b>"));
    near(mark.t_s, 8.0, 1e-6);
    assert!(figures.notes.iter().any(|note| note.contains("older version")), "{:?}", figures.notes);
}

#[test]
fn files_without_anything_of_ours_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.mcap");
    SessionWriter::create(&path, "another program").unwrap().finish().unwrap();
    let error = SessionFigures::read(&path).unwrap_err().to_string();
    assert!(error.contains("other.mcap") && error.contains("neither") && !error.contains('\n'), "{error}");
}
