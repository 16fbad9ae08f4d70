//! The requested motion of one side happens on the other: it is reported by name, and nothing is reported if each
//! device is on its own side.

use nalgebra::{Isometry3, Vector3};

use super::bench::{Fixture, Flaws, SIDE, subject};
use crate::{
    config::RigConfig,
    messages::Tick,
    ready::{
        CheckSubject, ReadyArm, ReadyCause,
        handle::ReadyHandle,
        item::{Item, PointProgress},
        push::ReadyPush,
        side_check::Own,
    },
    rig::{Side, SideSwap},
};

fn both() -> CheckSubject {
    let one = subject();
    let arm = one.arms[0].clone();
    CheckSubject { rig: RigConfig::load("emulated").unwrap(), arms: [arm.clone(), arm], ..one }
}

/// Measurements of both sides: displacement of arm, marker and handle, m, and the push on the instrument, N.
#[derive(Clone, Copy, Debug, Default)]
struct SideMotion {
    arm_m: f64,
    marker_m: f64,
    handle_m: f64,
    push_n: f64,
}

/// One second of rest, then these measurements for a second.
fn ends(item: &mut impl Item, [right, left]: [SideMotion; 2]) -> PointProgress {
    let template = Fixture::new(subject(), Flaws::default()).some_tick();
    let mut end = item.look(0.0);
    for ms in 0..2000_u32 {
        for (side, shows) in Side::ALL.into_iter().zip([right, left]) {
            let shows = if ms < 1000 { SideMotion::default() } else { shows };
            item.tick(&tick(&template, side, f64::from(ms) * 1e-3, &shows));
        }
        end = item.look(f64::from(ms) * 1e-3);
        if !matches!(end, PointProgress::Asking(_)) {
            break;
        }
    }
    end
}

fn tick(template: &Tick, side: Side, t_s: f64, shows: &SideMotion) -> Tick {
    let at = |x_m: f64| Some(Isometry3::translation(x_m, 0.0, 0.0));
    let mut tick = Tick { side, t_s, ..*template };
    tick.calibration.frames.base_from_flange = at(shows.arm_m);
    tick.calibration.frames.c_from_m = at(shows.marker_m);
    tick.calibration.frames.leader_from_handle = at(shows.handle_m);
    let push_n = Vector3::new(-shows.push_n, 0.0, 0.0);
    tick.force.gravity_free =
        tick.force.gravity_free.map(|wrench| nima_core::frames::Wrench { force_n: push_n, ..wrench });
    assert!(tick.force.gravity_free.is_some(), "the push is felt by a calibrated sensor");
    tick.calibration.wrist.as_mut().unwrap().raw.force_n = Vector3::new(0.0, 0.0, -4.0) + push_n;
    tick
}

const REST: SideMotion = SideMotion { arm_m: 0.0, marker_m: 0.0, handle_m: 0.0, push_n: 0.0 };

fn exchanged(end: PointProgress) -> Option<SideSwap> {
    match end {
        PointProgress::Failed(ReadyCause::Exchanged(exchange)) => Some(exchange),
        _ => None,
    }
}

#[test]
fn an_arm_or_a_marker_that_moves_in_place_of_its_own_is_named() {
    let own = |shows| ends(&mut Own::of(SIDE, &both()), shows);
    let moved = SideMotion { arm_m: 0.1, marker_m: 0.09, ..REST };
    assert!(matches!(own([moved, REST]), PointProgress::Passed(_)));
    assert_eq!(exchanged(own([REST, moved])), Some(SideSwap::Arms));
    let arm = SideMotion { marker_m: 0.0, ..moved };
    let marker = SideMotion { arm_m: 0.0, ..moved };
    assert_eq!(exchanged(own([arm, marker])), Some(SideSwap::Markers));
    for undecided in [[moved, moved], [arm, REST], [moved, marker], [REST, REST]] {
        assert!(matches!(own(undecided), PointProgress::Asking(_)), "{undecided:?}");
    }
    let mut without_tracker = both();
    without_tracker.rig.devices.as_mut().unwrap().tracker = None;
    assert!(matches!(ends(&mut Own::of(SIDE, &without_tracker), [arm, REST]), PointProgress::Passed(_)));
}

#[test]
fn a_handle_that_moves_in_place_of_the_one_asked_for_is_named() {
    let handle = |shows| ends(&mut ReadyHandle::of(SIDE, &both()), shows);
    let moved = SideMotion { handle_m: 0.02, ..REST };
    assert_eq!(exchanged(handle([REST, moved])), Some(SideSwap::Handles));
    assert_eq!(exchanged(handle([moved, REST])), None);
    assert!(matches!(handle([REST, REST]), PointProgress::Asking(_)));
}

#[test]
fn a_push_that_the_other_sensor_feels_is_named() {
    let arm = ReadyArm { at_wrist: true, ..both().arms[0].clone().unwrap() };
    let push = |shows| ends(&mut ReadyPush::of(SIDE, &arm), shows);
    let pushed = SideMotion { push_n: 2.0, ..REST };
    assert!(matches!(push([pushed, REST]), PointProgress::Passed(_)));
    assert_eq!(exchanged(push([REST, pushed])), Some(SideSwap::Sensors));
    assert!(matches!(push([REST, REST]), PointProgress::Asking(_)));
    assert_eq!(exchanged(push([pushed, pushed])), None, "its own one felt it too");
}
