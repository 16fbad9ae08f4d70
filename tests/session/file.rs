//! Sessions in files: recorded by the recorder's thread, read back, damaged, and recorded to locations that disappear.

use std::{
    collections::BTreeMap,
    ops::Range,
    path::Path,
    time::{Duration, Instant},
};

use nima_core::impedance::Mode;
use nima_machine::{
    messages::{Command, Tick},
    runtime::{self, Assembly, RuntimeClock, tap},
};
use nima_recording::session::{ReadError, SessionReader, SessionWriter, WriteError};
use nima_session::{
    SentenceChannel,
    file::RecordedFile,
    recorder::{AttachedFile, JOURNAL_TOPIC, RecordError, RecordingInfo, RecordingProgress, SessionRecorder},
    replay::{ReplayError, ReplayOutcome, WhatIfChange, compare, replay, verify},
    sinks::Destination,
};
use nima_simulation::SimulationPlan;
use nima_tests::plan;

pub(crate) fn about() -> RecordingInfo {
    let seed = BTreeMap::from([("seed".to_owned(), "1".to_owned())]);
    RecordingInfo {
        program: "test".to_owned(),
        started_ns: 1_700_000_000_000_000_000,
        metadata: BTreeMap::from([("session".to_owned(), seed)]),
        files: vec![AttachedFile {
            name: "scene.toml".into(),
            media_type: "application/toml".into(),
            data: b"name = \"x\"".into(),
        }],
        words: SentenceChannel {
            event: |event, _| format!("{event:?}"),
            operation: |operation, _| format!("{operation:?}"),
            happening: |event| format!("{event:?}"),
        },
    }
}

pub(crate) fn recorded(
    path: &Path,
    plan: &SimulationPlan,
    seconds: f64,
    each: impl FnMut(&Tick) -> Option<Command>,
) -> RecordingProgress {
    let (tap, end) = tap();
    let recorder = SessionRecorder::start(Destination::file(path), about(), plan.origin(), end).unwrap();
    runtime::run_virtual(Assembly { tap: Some(tap), ..plan.simulated().unwrap() }, seconds, each);
    recorder.finish().unwrap()
}

pub(crate) fn replayed(path: &Path) -> Result<ReplayOutcome, ReplayError> {
    let file = RecordedFile::open(path)?;
    replay(file.journal()?, |_| {})
}

const WHOLE: Range<f64> = 0.0..f64::INFINITY;

#[test]
fn a_session_file_replays_and_can_be_plotted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let report =
        recorded(&path, &plan("bimanual"), 6.0, |tick| (tick.index == 2000).then_some(Command::SetMode(Mode::Dfr)));
    assert_eq!((report.ticks, report.lost), (6000, 0));
    let outcome = replayed(&path).unwrap();
    assert_eq!((outcome.ticks, outcome.differs, outcome.hole, outcome.closed), (6000, None, None, true));
    let reader = SessionReader::open(&path).unwrap();
    assert!(reader.notes().is_empty(), "{:?}", reader.notes());
    for topic in ["right/forces", "left/forces", "right/poses", "left/gates"] {
        let messages: Vec<_> = reader.messages(&[topic], 0..u64::MAX).collect::<Result<_, _>>().unwrap();
        assert_eq!(messages.len(), 6000, "{topic}");
        assert_eq!(messages[1500].log_time_ns(), about().started_ns + 1_500_000_000, "the time of the sample");
    }
    let log = reader.messages(&["log"], 0..u64::MAX).map(|message| {
        let message = message.unwrap();
        String::from_utf8_lossy(message.data()).into_owned()
    });
    let log = log.collect::<Vec<_>>().join("\n");
    assert!(log.contains("SetMode") && log.contains("StateChanged"), "{log}");
    let bytes = reader.messages(&[JOURNAL_TOPIC], 0..u64::MAX).map(|message| message.unwrap().data().len());
    println!("{} bytes of journal, {} in the file", bytes.sum::<usize>(), std::fs::metadata(&path).unwrap().len());
}

#[test]
fn a_change_differs_where_it_was_made_and_nothing_changed_differs_nowhere() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    recorded(&path, &plan("peg_transfer"), 10.0, |tick| (tick.index == 4000).then_some(Command::SetGain(0.8)));
    let file = RecordedFile::open(&path).unwrap();
    let with = |change: WhatIfChange| compare(&mut file.journal().unwrap(), &change, &WHOLE, |_, _| {}).unwrap();
    let ([right, left], ticks, hole) = with(WhatIfChange::default());
    let same = right.unwrap();
    assert!(left.is_none() && ticks == 10_000 && hole.is_none());
    assert!(same.rendered.max_n < f64::EPSILON && same.engaged > 8000 && same.apart == 0, "{same:?}");
    let none = with(WhatIfChange { gain: Some(0.0), ..WhatIfChange::default() }).0[0].unwrap();
    assert!((none.rendered.mean_n - mean_rendered_n(&file)).abs() < 1e-9, "{none:?}");
    let late = with(WhatIfChange { delay_s: Some(0.3), ..WhatIfChange::default() }).0[0].unwrap();
    assert!(late.changed_error.mean_n > 1.5 * late.recorded_error.mean_n, "{late:?}");
    let reflected = with(WhatIfChange { mode: Some(Mode::Dfr), ..WhatIfChange::default() }).0[0].unwrap();
    assert!(reflected.rendered.mean_n > 0.01, "{reflected:?}");
}

#[test]
fn a_stretch_is_compared_alone_after_all_before_it_was_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    recorded(&path, &plan("bimanual"), 5.0, |tick| (tick.index == 2100).then_some(Command::SetGain(0.8)));
    let file = RecordedFile::open(&path).unwrap();
    let stretch = |stretch_s: Range<f64>| {
        let ReplayOutcome { before, ticks, differs, closed, .. } =
            verify(file.journal().unwrap(), &stretch_s, |_| ()).unwrap();
        assert_eq!(differs, None);
        (before, ticks, closed)
    };
    assert_eq!(stretch(WHOLE), (0, 5000, true));
    assert_eq!(stretch(2.05..3.217), (2050, 1167, false));
    assert_eq!(stretch(3.217..f64::INFINITY), (3217, 1783, true));
    assert_eq!(stretch(0.0..0.05), (0, 50, false));
    // A part of the session gives the same forces, tick by tick, as the whole session.
    let change = WhatIfChange { mode: Some(Mode::Dfr), ..WhatIfChange::default() };
    let forces_n = |stretch_s: &Range<f64>| {
        let mut forces_n = Vec::new();
        let report = compare(&mut file.journal().unwrap(), &change, stretch_s, |was, would| {
            forces_n.push((was.rendering.rendered_n, would.rendering.rendered_n));
        });
        (report.unwrap().1, forces_n)
    };
    let (_, whole) = forces_n(&WHOLE);
    let (ticks, part) = forces_n(&(2.05..3.217));
    assert_eq!(ticks, 1167);
    assert_eq!(part, whole[2 * 2050..2 * 3217]);
}

/// Returns the mean of the rendered force while engaged, N.
fn mean_rendered_n(file: &RecordedFile) -> f64 {
    let mut sum_n = 0.0;
    let mut count = 0;
    replay(file.journal().unwrap(), |replayed| {
        let tick = replayed.ticks[0].as_ref().unwrap();
        if tick.state == nima_machine::messages::LoopState::Engaged {
            sum_n += tick.rendering.rendered_n.norm();
            count += 1;
        }
    })
    .unwrap();
    sum_n / f64::from(count)
}

#[test]
fn a_flipped_bit_is_named_or_has_changed_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    recorded(&path, &plan("peg_transfer"), 2.0, |_| None);
    let whole = std::fs::read(&path).unwrap();
    let bad = folder.path().join("bad.mcap");
    let mut named = 0;
    let mut random = fastrand::Rng::with_seed(7);
    for _ in 0..60 {
        let mut bytes = whole.clone();
        bytes[random.usize(..whole.len())] ^= 1 << random.u8(..8);
        std::fs::write(&bad, &bytes).unwrap();
        match replayed(&bad) {
            Err(error) => {
                let words = error.to_string();
                assert!(!words.contains('\n') && words.len() > 20, "{words}");
                named += 1;
            }
            Ok(outcome) => assert_eq!((outcome.ticks, outcome.differs, outcome.closed), (2000, None, true)),
        }
    }
    assert!(named > 40, "{named} of 60: nearly all of the file is chunks");
}

#[test]
fn files_that_cannot_be_replayed_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("empty"), []).unwrap();
    assert!(matches!(replayed(&at("empty")), Err(ReplayError::File(ReadError::Empty { .. }))));
    std::fs::write(at("foreign"), "t_s,x_m\n0,1\n").unwrap();
    assert!(matches!(replayed(&at("foreign")), Err(ReplayError::File(ReadError::Foreign { .. }))));
    SessionWriter::create(&at("other.mcap"), "another program").unwrap().finish().unwrap();
    assert!(matches!(replayed(&at("other.mcap")), Err(ReplayError::NoJournal)));
    recorded(&at("whole"), &plan("peg_transfer"), 4.0, |_| None);
    let whole = std::fs::read(at("whole")).unwrap();
    std::fs::write(at("cut"), &whole[..whole.len() / 2]).unwrap();
    // Either the remaining part is replayed and the missing end is reported, or the cut itself is reported.
    match replayed(&at("cut")) {
        Ok(outcome) => {
            assert!(outcome.ticks > 500 && outcome.ticks < 4000 && !outcome.closed, "{outcome:?}");
            assert_eq!(outcome.differs, None);
        }
        Err(error) => assert!(error.to_string().contains("cut"), "{error}"),
    }
    assert!(
        matches!(
            SessionRecorder::start(Destination::file(&at("whole")), about(), plan("peg_transfer").origin(), tap().1),
            Err(RecordError::Write(WriteError::Create { .. }))
        ),
        "a session is never overwritten"
    );
}

#[test]
fn a_folder_that_is_gone_is_told_at_once_and_the_loop_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let plan = plan("peg_transfer");
    let (tap, end) = tap();
    let recorder = SessionRecorder::start(Destination::file(&path), about(), plan.origin(), end).unwrap();
    let assembly =
        Assembly { tap: Some(tap), clock: RuntimeClock::Simulated { speed: 4.0 }, ..plan.simulated().unwrap() };
    let handle = runtime::start(assembly).unwrap();
    let begin = Instant::now();
    let wait_for = |what: &dyn Fn() -> bool| {
        while !what() {
            assert!(begin.elapsed() < Duration::from_mins(2));
            std::thread::sleep(Duration::from_millis(10));
        }
    };
    wait_for(&|| recorder.progress().ticks > 500);
    drop(folder);
    wait_for(&|| recorder.trouble().is_some());
    let words = recorder.trouble().unwrap().to_string();
    assert!(words.contains("deleted") && words.contains("session.mcap"), "{words}");
    // The tap is still emptied, and the loop keeps running.
    let before = Instant::now();
    let mut newest = 0;
    while before.elapsed() < Duration::from_millis(500) {
        handle.drain_ticks(|tick| newest = tick.index);
        std::thread::sleep(Duration::from_millis(10));
    }
    let summary = handle.stop_and_join().unwrap();
    assert!(summary.ticks > newest && newest > 500, "{} ticks, {newest}", summary.ticks);
    assert!(matches!(recorder.finish(), Err(RecordError::Write(WriteError::Deleted { .. }))));
}
