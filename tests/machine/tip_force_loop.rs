//! The network in the loop removes the trocar's friction, and the change to the fallback causes no force step.
use std::sync::{OnceLock, atomic::AtomicBool};

use nalgebra::Vector3;
use nima_core::tip_force::{Fallback, FeatureSettings, ForceModel, LiveTipForce, TrainingSettings, Unsure};
use nima_machine::{
    messages::{ForceReport, ForceSource},
    rig::{Outputs, Prompt, Side},
    teleop::{Calibrations, ForcePath},
};
use nima_simulation::{World, scene::Scene};
use nima_study::validation::{
    experiment::SimulatedExperiment,
    isolation::{PriorCalibrations, record},
};
use nima_training::train_model;

/// Calibrated and trained once for all tests in this file.
fn trained() -> &'static (PriorCalibrations, ForceModel) {
    static TRAINED: OnceLock<(PriorCalibrations, ForceModel)> = OnceLock::new();
    TRAINED.get_or_init(|| {
        let known = PriorCalibrations::calibrate(3).unwrap();
        let scene = SimulatedExperiment::scene("isolation", 3).unwrap();
        let data = record(&scene, &known, FeatureSettings::default(), 12_000, 7.0).unwrap().data(None).unwrap();
        let settings = TrainingSettings { members: 2, epochs: Some(20), ..TrainingSettings::default() };
        let model = train_model(&data, &settings, [None, None], &AtomicBool::new(false), &|_| {}).unwrap();
        (known, model)
    })
}

fn path(fallback: Option<Fallback>) -> ForcePath {
    let (known, model) = trained();
    let tip_force = fallback.map(|fallback| LiveTipForce::new(model.clone(), fallback).unwrap());
    ForcePath::new(&Calibrations { gravity: Some(known.gravity), tip_force, ..Calibrations::default() }, 1e-3)
}

/// Returns the result of a path for each sample, and the true force, N (`world`), during work on the tissue.
fn work(mut path: ForcePath, scene: &Scene, seconds: f64) -> Vec<(ForceReport, Vector3<f64>)> {
    let mut world = World::new(scene, 1000.0);
    let outputs = Outputs { prompt: Prompt::Work, ..Outputs::SAFE };
    (1..=(seconds * 1e3) as u32)
        .map(|tick| {
            let t_s = f64::from(tick) * 1e-3;
            let sensed = world.exchange(t_s, &outputs).unwrap().sensed;
            (path.step(t_s, &sensed), world.true_tip_n())
        })
        .collect()
}

fn scene(seed: u64) -> Scene {
    SimulatedExperiment::scene("isolation", seed).unwrap()
}

/// Returns a scene with another tool, for which the network was not trained.
fn heavier(seed: u64) -> Scene {
    heavier_by(0.5, seed)
}

fn heavier_by(mass_kg: f64, seed: u64) -> Scene {
    let mut scene = scene(seed);
    scene.wrist.as_mut().unwrap().tool_mass_kg += mass_kg;
    scene
}

fn mean_error_n(all: &[(ForceReport, Vector3<f64>)]) -> f64 {
    all.iter().map(|(report, true_n)| (report.tip_n - true_n).norm()).sum::<f64>() / all.len() as f64
}

#[test]
fn the_network_takes_the_friction_out_of_the_wrist_force() {
    let all = work(path(Some(Fallback::WristForce)), &scene(11), 20.0);
    let sure = all.iter().filter(|(report, _)| report.source == ForceSource::Network).count();
    assert!(sure as f64 > 0.85 * all.len() as f64, "{sure} of {}", all.len());
    let [with, without] = [mean_error_n(&all), mean_error_n(&work(path(None), &scene(11), 20.0))];
    assert!(with < 0.2 * without, "{with:.3} N against {without:.3} N");
}

#[test]
fn friction_of_unknown_direction_is_not_taken_for_tissue_until_the_instrument_has_moved() {
    let all = work(path(Some(Fallback::WristForce)), &scene(11), 3.0);
    let not_moved = ForceSource::InDoubt { unsure: Unsure::NotMoved, fallback: Fallback::HoldAndFade };
    assert_eq!(all[0].0.source, not_moved);
    for (report, _) in all.iter().filter(|(report, _)| report.source == not_moved) {
        assert_eq!(report.tip_n, Vector3::zeros());
        assert!(report.measured_n().iter().all(|x| x.is_nan()), "it was not measured");
    }
    assert!(all.iter().any(|(report, _)| report.source == ForceSource::Network));
}

#[test]
fn a_little_outside_its_training_the_network_is_better_than_the_wrist_force() {
    // Both contain 1.2 N of weight that no calibration accounts for.
    let scene = heavier_by(0.12, 11);
    let all = work(path(Some(Fallback::WristForce)), &scene, 20.0);
    let fraction = |source| all.iter().filter(|(report, _)| report.source == source).count() as f64 / all.len() as f64;
    assert!(fraction(ForceSource::Extrapolated) > 0.3, "{}", fraction(ForceSource::Extrapolated));
    let outside: Vec<_> = all
        .iter()
        .zip(work(path(None), &scene, 20.0))
        .filter(|((report, _), _)| report.source == ForceSource::Extrapolated)
        .collect();
    let (with, without): (Vec<_>, Vec<_>) = outside.into_iter().map(|(with, without)| (*with, without)).unzip();
    let [with, without] = [mean_error_n(&with), mean_error_n(&without)];
    assert!(with < 0.7 * without, "{with:.3} N against {without:.3} N");
}

#[test]
fn another_tool_is_flagged_and_the_chosen_fallback_is_used() {
    let doubtful = |fallback| {
        let all = work(path(Some(fallback)), &heavier(11), 10.0);
        let doubt = ForceSource::InDoubt { unsure: Unsure::OutsideTraining, fallback };
        let late = all[3000..].to_vec();
        let fraction = late.iter().filter(|(report, _)| report.source == doubt).count() as f64 / late.len() as f64;
        assert!(fraction > 0.95, "{fraction}");
        late
    };
    let wrist = doubtful(Fallback::WristForce);
    let without = work(path(None), &heavier(11), 10.0);
    let same = wrist.iter().zip(&without[3000..]).filter(|(a, b)| (a.0.tip_n - b.0.tip_n).norm() < 1e-9).count();
    assert!(same as f64 > 0.9 * wrist.len() as f64, "the uncorrected wrist force: {same} of {}", wrist.len());
    let faded = doubtful(Fallback::HoldAndFade);
    let silent = faded.iter().filter(|(report, _)| report.tip_n.norm() < 1e-9).count();
    assert!(silent as f64 > 0.9 * faded.len() as f64, "nothing is felt: {silent} of {}", faded.len());
}

#[test]
fn a_handover_causes_no_force_step() {
    for fallback in [Fallback::WristForce, Fallback::HoldAndFade] {
        let mut path = path(Some(fallback));
        let mut good = World::new(&scene(11), 1000.0);
        let mut foreign = World::new(&heavier_by(0.3, 11), 1000.0);
        let outputs = Outputs { prompt: Prompt::WorkFree, ..Outputs::SAFE };
        let mut last_n = None::<ForceReport>;
        let mut largest_n = 0.0_f64;
        let mut handovers = 0;
        for tick in 1..=20_000_u32 {
            let t_s = f64::from(tick) * 1e-3;
            let [mine, other] = [&mut good, &mut foreign].map(|world| world.exchange(t_s, &outputs).unwrap().sensed);
            // Every two seconds the tool changes to one that is 3 N heavier, and back.
            let report = path.step(t_s, if tick / 2000 % 2 == 0 { &mine } else { &other });
            // At the moment of the change even the wrist force is discontinuous.
            if let Some(last) = last_n.filter(|_| tick % 2000 > 1) {
                handovers += u32::from(last.source.doubt().is_some() != report.source.doubt().is_some());
                if last.source.doubt().is_none() || report.source.doubt().is_none() {
                    largest_n = largest_n.max((report.tip_n - last.tip_n).norm());
                }
            }
            last_n = Some(report);
        }
        assert!(handovers >= 8, "{handovers}");
        assert!(largest_n < 0.5, "{fallback:?}: a step of {largest_n:.2} N in a millisecond");
    }
}

/// This side of the scene `bimanual`, with the wrist, trocar and technician of the paper's rig.
fn at_the_task(side: Side) -> Scene {
    let paper = Scene::load("isolation").unwrap();
    let scene = Scene::load("bimanual").unwrap().of_side(side).unwrap();
    let Scene { wrist, trocar, tissue_sensor, person, .. } = paper;
    Scene { wrist, trocar, tissue_sensor, person, ..scene }
}

/// Returns the standard deviation per axis of the reported force without contact while the hand performs its task, N
/// (`world`).
fn free_sd_n(mut path: ForcePath, scene: &Scene, seconds: f64) -> Vector3<f64> {
    let mut world = World::new(&Scene { person: None, ..scene.clone() }, 1000.0);
    let mut outputs = Outputs::SAFE;
    let mut count = 0.0;
    let mut sum = Vector3::zeros();
    let mut squares = Vector3::zeros();
    for tick in 1..=(seconds * 1e3) as u32 {
        let inputs = world.advance_to(f64::from(tick) * 1e-3, &outputs);
        outputs.tip_command_m = Some(inputs.hand.position_m);
        let tip_n = path.step(f64::from(tick) * 1e-3, &inputs.sensed).tip_n;
        if world.true_tip_n().norm() < f64::EPSILON {
            count += 1.0;
            sum += tip_n;
            squares += tip_n.component_mul(&tip_n);
        }
    }
    let mean = sum / count;
    (squares / count - mean.component_mul(&mean)).map(f64::sqrt)
}

/// The hand's strokes reach 0.11 m/s, and the friction along the shaft grows with the speed.
#[test]
fn a_technician_s_recording_covers_the_speeds_of_the_task() {
    let (known, _) = trained();
    for side in Side::ALL {
        let scene = at_the_task(side);
        let data = record(&scene, known, FeatureSettings::default(), 12_000, 7.0).unwrap().data(None).unwrap();
        let none = AtomicBool::new(false);
        let model = train_model(&data, &TrainingSettings::default(), [None, None], &none, &|_| {}).unwrap();
        let tip_force = Some(LiveTipForce::new(model, Fallback::WristForce).unwrap());
        let calibrations = Calibrations { gravity: Some(known.gravity), tip_force, ..Calibrations::default() };
        let sd_n = free_sd_n(ForcePath::new(&calibrations, 1e-3), &scene, 20.0);
        println!("{side:?}: standard deviation without contact {sd_n:.3?} N");
        assert!(sd_n.max() < 0.035, "{side:?}: {sd_n} N");
    }
}
