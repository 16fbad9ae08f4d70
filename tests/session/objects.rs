//! Tests of a scene's objects in a session, from any source: recorded, read, trimmed and made anonymous.

use std::{collections::VecDeque, path::Path, sync::atomic::AtomicBool};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use nima_core::task::{TaskEvent, TimedTaskEvent};
use nima_machine::{
    rig::Side,
    runtime::{self, Assembly, tap},
};
use nima_recording::session::SessionReader;
use nima_session::{
    anonymous,
    file::{LineKind, RecordedFile},
    objects::{JawState, ObjectSource, ObjectStates, are_reported, are_shown, at, happenings, openings},
    plot_channels::beginning_ns,
    recorder::SessionRecorder,
    report::SessionFigures,
    sinks::Destination,
    trim,
};
use nima_tests::plan;

use crate::file::{about, recorded, replayed};

/// Reports two rings, one of which is lost after two seconds, and the right jaws, a hundred times per second.
#[derive(Debug)]
struct RingPublisher {
    moments: VecDeque<ObjectStates>,
    happenings: VecDeque<TimedTaskEvent>,
}

impl ObjectSource for RingPublisher {
    fn moment(&mut self) -> Option<ObjectStates> {
        self.moments.pop_front()
    }

    fn happening(&mut self) -> Option<TimedTaskEvent> {
        self.happenings.pop_front()
    }
}

fn moment(number: u32) -> ObjectStates {
    let t_s = f64::from(number) * 0.01;
    let turn = UnitQuaternion::from_euler_angles(0.1, t_s, -0.3);
    let ring = |x_m: f64| Isometry3::from_parts(Translation3::new(x_m, t_s, 0.1 * t_s), turn);
    // One ring is out of view; it is listed before the visible one.
    let rings = vec![(number < 200).then(|| ring(-0.02)), Some(ring(0.01))];
    let jaws = JawState {
        opening_rad: 0.2 * t_s,
        opens_n: -t_s,
        force_n: Vector3::new(t_s, 1.0, 2.0),
        torque_nm: Vector3::new(0.01, t_s, 0.03),
        touched: [true, false, number > 100, false],
    };
    let mut objects = ObjectStates { t_s, rings, ..ObjectStates::default() };
    objects.jaws[Side::Right.index()] = Some(jaws);
    objects
}

/// Returns the events of every possible scene.
fn events() -> Vec<TimedTaskEvent> {
    let side = Side::Left;
    let events = [
        (0.5, TaskEvent::RingGrasped { ring: 1, side }),
        (1.0, TaskEvent::RingDropped { ring: 1, side, in_view: false }),
        (1.001, TaskEvent::RingDropped { ring: 0, side, in_view: true }),
        (1.5, TaskEvent::LumpMarked { side, lump: Some(2) }),
        (1.75, TaskEvent::WireTouched { side }),
        (2.5, TaskEvent::Ended),
    ];
    events.map(|(t_s, event)| TimedTaskEvent { t_s, event }).to_vec()
}

/// Records three seconds of a loop, with the objects.
fn record(path: &Path) {
    let plan = plan("peg_transfer");
    let (tap, end) = tap();
    let recorder = SessionRecorder::start(Destination::file(path), about(), plan.origin(), end).unwrap();
    // Longer than the session: states at times that the loop never reached are not recorded.
    recorder.watch(Box::new(RingPublisher { moments: (0..400).map(moment).collect(), happenings: events().into() }));
    runtime::run_virtual(Assembly { tap: Some(tap), ..plan.simulated().unwrap() }, 3.0, |_| None);
    recorder.finish().unwrap();
}

fn all(reader: &SessionReader) -> Vec<TimedTaskEvent> {
    happenings(reader, 0..u64::MAX).unwrap()
}

fn shown(reader: &SessionReader, t_s: f64) -> Option<ObjectStates> {
    let begin_ns = beginning_ns(reader).unwrap();
    at(reader, begin_ns, begin_ns + (t_s * 1e9).round() as u64).unwrap()
}

#[test]
fn what_is_told_of_objects_is_in_the_session_and_the_replay_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path);
    let outcome = replayed(&path).unwrap();
    assert_eq!((outcome.ticks, outcome.differs, outcome.hole, outcome.closed), (3000, None, None, true));
    let reader = SessionReader::open(&path).unwrap();
    assert!(reader.notes().is_empty() && are_reported(&reader) && are_shown(&reader));
    assert_eq!(all(&reader), events());
    for (t_s, number) in [(0.0, 0), (1.237, 123), (2.5, 250)] {
        assert_eq!(shown(&reader, t_s), Some(moment(number)), "at {t_s} s");
    }
    assert_eq!(shown(&reader, 3.5), None, "there is nothing new there");
    let opened = openings(&reader, Side::Right, 0..u64::MAX).unwrap();
    assert_eq!((opened.len(), opened[150]), (300, (1.5, 0.2 * 1.5)));
    assert_eq!(openings(&reader, Side::Left, 0..u64::MAX).unwrap(), []);
    let log = RecordedFile::open(&path).unwrap().log(0..u64::MAX).unwrap();
    let report: Vec<_> = log.iter().filter(|line| line.kind == LineKind::Happening).collect();
    assert!(report.len() == 6 && report[1].words.contains("RingDropped"), "{report:?}");
    let counted = SessionFigures::read(&path).unwrap().happenings.unwrap();
    let counted: Vec<(&str, u64)> = counted.iter().map(|(kind, count)| (kind.as_str(), *count)).collect();
    let expected = ["ended", "lump_marked", "ring_dropped", "ring_dropped_out_of_view", "ring_grasped", "wire_touched"];
    assert_eq!(counted, expected.map(|kind| (kind, 1)));
}

#[test]
fn a_stretch_and_an_anonymous_session_keep_the_objects() {
    let folder = tempfile::tempdir().unwrap();
    let [path, part, shared] = ["session", "part", "shared"].map(|name| folder.path().join(name));
    record(&path);
    let reader = SessionReader::open(&path).unwrap();
    let begin_ns = beginning_ns(&reader).unwrap();
    let times_ns = begin_ns + 1_000_000_000..begin_ns + 2_000_000_000;
    let asked = AtomicBool::new(false);
    trim::write(&reader, "session", &times_ns, &part, &asked).unwrap();
    let known = anonymous::SessionFacts { program: "test", files: &[], words: about().words, devices: &[] };
    anonymous::write(&reader, &known, &(0..u64::MAX), &shared, &asked).unwrap();
    let shared_path = shared.clone();
    let [part, shared] = [part, shared].map(|path| SessionReader::open(&path).unwrap());
    assert_eq!(all(&part), events()[1..5]);
    assert_eq!(shown(&part, 1.237), Some(moment(123)));
    assert_eq!(all(&shared), events());
    let log = RecordedFile::open(&shared_path).unwrap().log(0..u64::MAX).unwrap();
    let report: Vec<_> = log.iter().filter(|line| line.kind == LineKind::Happening).collect();
    assert!(report.len() == 6 && report[1].words.contains("RingDropped"), "{report:?}");
    for number in [0, 123, 250] {
        assert_eq!(shown(&shared, f64::from(number) * 0.01), Some(moment(number)), "moment {number}");
    }
}

#[test]
fn a_session_in_which_nobody_told_of_objects_has_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    recorded(&path, &plan("peg_transfer"), 1.0, |_| None);
    let reader = SessionReader::open(&path).unwrap();
    assert!(!are_reported(&reader) && !are_shown(&reader));
    assert_eq!((all(&reader), shown(&reader, 0.5)), (vec![], None));
    assert_eq!(SessionFigures::read(&path).unwrap().happenings, None);
}
