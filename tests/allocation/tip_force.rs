//! Test: neither the tip-force model, whatever its inputs, nor the loop that contains it allocates.

use std::sync::atomic::AtomicBool;

use nima_core::tip_force::{DEFAULT_INPUTS, Estimator, Fallback, FeatureSettings, LiveTipForce, TrainingSettings};
use nima_machine::{
    config::RigConfig,
    messages::{Command, ForceSource},
    rig::{Outputs, Side},
    teleop::{Calibrations, Pair, Timing},
};
use nima_recording::tip_force::{DataSet, Selection};
use nima_simulation::{World, scene::Scene};
use nima_study::validation::{
    experiment::SimulatedExperiment,
    isolation::{PriorCalibrations, record},
};
use nima_testing::real_time::alone;
use nima_training::train_model;

use crate::counting::calls;

#[test]
fn an_answer_on_the_default_inputs_with_the_default_network_allocates_nothing() {
    let _alone = alone();
    let mut generator = fastrand::Rng::with_seed(1);
    let mut text = DEFAULT_INPUTS.join(",") + ",tip_fx_n,tip_fy_n,tip_fz_n\n";
    for _ in 0..400 {
        let row: Vec<String> = (0..DEFAULT_INPUTS.len() + 3).map(|_| (generator.f32() - 0.5).to_string()).collect();
        text += &(row.join(",") + "\n");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("d.csv");
    std::fs::write(&path, text).unwrap();
    let data = DataSet::read(&[path], &Selection::default()).unwrap();
    let settings = TrainingSettings { epochs: Some(1), ..TrainingSettings::default() };
    let model = train_model(&data, &settings, [None, None], &AtomicBool::new(false), &|_| {}).unwrap();
    let mut estimator = Estimator::new(model);
    let before = calls();
    let mut doubted = 0_u32;
    for row in 0..data.rows() {
        doubted += u32::from(estimator.estimate(data.input(row)).in_doubt);
    }
    assert!(estimator.estimate(&[f32::NAN; DEFAULT_INPUTS.len()]).in_doubt && estimator.estimate(&[]).in_doubt);
    assert_eq!(calls() - before, 0);
    assert!(doubted < 400);
    drop(std::hint::black_box(vec![1_u8; 10]));
    assert_eq!(calls() - before, 2, "the counter counts");
}

#[test]
fn the_loop_with_a_network_in_it_allocates_nothing() {
    let _alone = alone();
    let known = PriorCalibrations::calibrate(2).unwrap();
    let session = SimulatedExperiment::scene("isolation", 2).unwrap();
    let data = record(&session, &known, FeatureSettings::default(), 4000, 7.0).unwrap().data(None).unwrap();
    let settings = TrainingSettings { epochs: Some(2), ..TrainingSettings::default() };
    let model = train_model(&data, &settings, [None, None], &AtomicBool::new(false), &|_| {}).unwrap();
    let tip_force = Some(LiveTipForce::new(model, Fallback::HoldAndFade).unwrap());
    let rig = RigConfig::load("simulated").unwrap();
    let calibrations = Calibrations { gravity: Some(known.gravity), tip_force, ..Calibrations::default() };
    let mut control = Pair::new(&rig, Side::Right, &calibrations).unwrap();
    let mut world = World::new(&Scene::load("palpation").unwrap(), rig.rate_hz);
    let mut outputs = Outputs::SAFE;
    let mut sure = 0;
    let mut doubtful = 0;
    let before = calls();
    for k in 0..10_000_u32 {
        let now_s = f64::from(k) * 1e-3;
        control.clear_events();
        if k == 100 {
            control.obey(Command::Engage, now_s).unwrap();
        }
        // Drop samples at intervals, which resets the features' state.
        let inputs = world.exchange(now_s, &outputs).filter(|_| k % 3000 > 15);
        let (next, tick) = control.step(false, inputs, &Timing { now_s, ..Timing::default() });
        outputs = next;
        sure += u32::from(tick.force.source == ForceSource::Network);
        doubtful += u32::from(tick.force.source.doubt().is_some());
    }
    assert_eq!(calls() - before, 0);
    assert!(sure > 1000 && doubtful > 100, "both ways were gone: {sure} sure, {doubtful} doubtful");
}
