//! Tests of the markers of a loop, without the library; `tests/peers/peer_lsl.py` tests them with it.

use nalgebra::Vector3;
use nima_core::safety::InterlockState;
use nima_machine::{
    config::RigConfig,
    messages::{Fault, Tick},
    rig::{Inputs, SIDES, SensedForce},
    teleop::{Calibrations, Loop, Timing},
};

use super::{
    marks::{MarkFollower, happening},
    *,
};

const WORDS: fn(Fault) -> &'static str = |_| "something is wrong";

/// Returns ticks of one arm that is engaged from 0.005 s, touches from 0.5 to 1 s, and is stopped from 1.5 to 1.6 s.
fn ticks() -> Vec<[Option<Tick>; SIDES]> {
    let rig = RigConfig::load("simulated").unwrap();
    let mut control = Loop::new(&rig, &[Some(Calibrations::default()), None]).unwrap();
    let inputs = Inputs { sensed: SensedForce::AtTip(Vector3::zeros()), powered: true, ..Inputs::NOTHING };
    let (_, [tick, _]) = control.step([Some(inputs), None], &Timing::default());
    let tick = tick.unwrap();
    (0..1800).map(|number| [Some(at(number, &tick)), None]).collect()
}

/// Returns a copy of this tick with another number.
fn at(number: u32, like: &Tick) -> Tick {
    let mut tick = *like;
    tick.index = u64::from(number);
    tick.t_s = f64::from(number) * 1e-3;
    tick.state = match number {
        5..1500 => InterlockState::Engaged,
        1500..1600 => InterlockState::Stopped,
        _ => InterlockState::Idle,
    };
    // The force trembles around the threshold: a marker at every crossing would be too many.
    let tremble_n = if number.is_multiple_of(2) { 0.03 } else { -0.03 };
    let touches = (0.5..1.0).contains(&tick.t_s);
    let force_n = if touches { 0.2 + tremble_n + (tick.t_s - 0.5).min(1.0 - tick.t_s) } else { 0.0 };
    tick.measured_n = Vector3::new(0.0, 0.0, force_n);
    tick
}

#[test]
fn a_session_gives_each_mark_once_at_its_tick() {
    let mut follower = MarkFollower::new(CONTACT_N, Some(WORDS));
    let mut marks = Vec::new();
    for (tick, shown) in ticks().iter().enumerate() {
        follower.tick(shown, |what| marks.push((tick, what)));
    }
    let words: Vec<&str> = marks.iter().map(|(_, what)| what.as_str()).collect();
    assert_eq!(words, ["engage right", "contact on right", "contact off right", "disengage right", "stop right"]);
    let near = |place: usize, tick: usize| marks[place].0.abs_diff(tick) <= 60;
    assert!(near(0, 5) && near(1, 500) && near(2, 1000) && near(3, 1500) && marks[3].0 == marks[4].0, "{marks:?}");
}

#[test]
fn marks_tell_no_condition() {
    // The same session with every number of the rendering changed gives the same markers.
    let report = |change: &dyn Fn(&mut Tick)| {
        let mut follower = MarkFollower::new(CONTACT_N, Some(WORDS));
        let mut marks = Vec::new();
        for (tick, shown) in ticks().iter_mut().enumerate() {
            shown.iter_mut().flatten().for_each(change);
            follower.tick(shown, |what| marks.push((tick, what)));
        }
        marks
    };
    let plain = report(&|_| {});
    let other = report(&|tick| {
        tick.mode = nima_core::impedance::Mode::Literal;
        tick.delay_s = 0.3;
        tick.rendering.rendered_n = Vector3::repeat(9.0);
        tick.rendering.asked_n = [Vector3::repeat(7.0); nima_core::impedance::SLOTS];
        tick.gates.settings.gain = 0.0;
    });
    assert_eq!(plain, other);
    assert!(plain.iter().all(|(_, what)| !what.contains(|c: char| c.is_ascii_digit())), "{plain:?}");
}

#[test]
fn a_force_that_is_not_known_is_no_contact() {
    let mut follower = MarkFollower::new(CONTACT_N, Some(WORDS));
    let mut shown = ticks().swap_remove(1300);
    shown[0].as_mut().unwrap().measured_n = Vector3::repeat(f64::NAN);
    let mut marks = Vec::new();
    follower.tick(&shown, |what| marks.push(what));
    assert_eq!(marks, ["engage right"]);
    let mut tick = shown[0].unwrap();
    tick.state = InterlockState::Faulted(Fault::LinkSilent);
    follower.tick(&[Some(tick), None], |what| marks.push(what));
    assert_eq!(marks[1..], ["disengage right", "fault right: something is wrong"]);
}

#[test]
fn a_fault_in_a_blind_trial_is_marked_without_its_cause() {
    let mut tick = ticks().swap_remove(1300)[0].unwrap();
    for fault in [Fault::LinkSilent, Fault::SamplesLost, Fault::ClockJumped, Fault::DrivesOff] {
        let mut follower = MarkFollower::new(CONTACT_N, None);
        tick.state = InterlockState::Faulted(fault);
        let mut marks = Vec::new();
        follower.tick(&[Some(tick), None], |what| marks.push(what));
        assert_eq!(marks, ["fault right"], "{fault:?}");
    }
}

#[test]
fn happenings_are_told_with_their_fields_and_what_is_none_is_not() {
    let dropped = br#"{"t_s": 12.25, "event": "ring_dropped", "ring": 2, "side": "left", "in_view": false}"#;
    assert_eq!(happening(dropped).unwrap(), "task ring_dropped in_view=false ring=2 side=left");
    let knocked = br#"{"t_s": 1.0, "event": "ring_knocked_off", "ring": 0, "side": null}"#;
    assert_eq!(happening(knocked).unwrap(), "task ring_knocked_off ring=0");
    for none in [&b""[..], b"[]", b"{}", br#"{"event": 3}"#] {
        assert_eq!(happening(none), None);
    }
}

#[test]
fn a_library_that_is_missing_or_none_is_told_with_its_cure_in_one_line() {
    let folder = std::env::temp_dir().join(format!("nima-lsl-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let text = folder.join("liblsl.so");
    std::fs::write(&text, "no library").unwrap();
    for (path, words) in [(folder.join("absent.so"), "not found"), (text, "cannot be used")] {
        let error = MarkStream::start(Some(&path), "test", "here").unwrap_err().to_string();
        assert!(error.contains(words) && error.contains("--lsl FILE") && error.contains(".so"), "{error}");
        assert_eq!(error.lines().count(), 1);
    }
    std::fs::remove_dir_all(folder).unwrap();
}
