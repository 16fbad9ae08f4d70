//! An unknown force is NaN in a session, and not a sample of a recording.

use std::path::Path;

use nima_machine::rig::Side;
use nima_recording::{csv::RecordingError, session::SessionReader};
use nima_session::plot_channels::{PlottedError, PlottedTick, each_tick, recording};
use nima_simulation::SimulationPlan;
use nima_tests::plan;

use crate::file::{recorded, replayed};

fn ticks(path: &Path) -> Vec<PlottedTick> {
    let mut ticks = Vec::new();
    let reader = SessionReader::open(path).unwrap();
    each_tick(&reader, path, Side::Right, 0..u64::MAX, |tick| {
        ticks.push(tick);
        Ok::<_, PlottedError>(())
    })
    .unwrap();
    ticks
}

#[test]
fn an_uncalibrated_arm_has_no_force_in_its_session() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    recorded(&path, &SimulationPlan { engage: false, ..plan("palpation") }, 1.0, |_| None);
    assert_eq!(replayed(&path).unwrap().differs, None, "a number that is none is replayed too");
    let ticks = ticks(&path);
    assert_eq!(ticks.len(), 1000);
    for tick in ticks {
        assert!(tick.measured_n.iter().chain(&tick.delayed_n).all(|x| x.is_nan()), "{tick:?}");
        assert!(tick.rendered_n.norm() < 1e-12 && tick.tip_m.iter().all(|x| x.is_finite()), "{tick:?}");
    }
    let refused = recording(&path, None).unwrap_err();
    assert!(matches!(refused, PlottedError::Recording(RecordingError::TooShort { found: 0, .. })), "{refused}");
}

#[test]
fn a_known_force_is_plotted_from_its_first_tick_and_the_delayed_one_a_delay_later() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let plan = plan("peg_transfer");
    recorded(&path, &plan, 5.0, |_| None);
    let ticks = ticks(&path);
    assert!(ticks.iter().all(|tick| tick.measured_n.iter().all(|x| x.is_finite())));
    let unknown = ticks.iter().take_while(|tick| tick.delayed_n.x.is_nan()).count();
    assert_eq!(unknown, (plan.rig.delay_s * 1e3).round() as usize);
    assert!(ticks[unknown..].iter().all(|tick| tick.delayed_n.iter().all(|x| x.is_finite())));
    assert_eq!(recording(&path, None).unwrap().samples.len(), 5000);
}
