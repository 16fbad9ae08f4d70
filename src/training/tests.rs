//! From data to predictions, on simulated data: force through a trocar with Coulomb friction that grows with the load.

use std::{path::PathBuf, sync::atomic::AtomicBool};

use nima_core::tip_force::{Estimator, ForceModel, ModelOrigin, TrainingSettings};
use nima_recording::tip_force::{DataSet, Trajectory, load_model, save_model};

use super::*;

/// Trajectories of an instrument that moves in and out under a lateral load, 200 rows each.
fn world(trajectories: usize, seed: u64) -> DataSet {
    let mut generator = fastrand::Rng::with_seed(seed);
    let names = |list: &[&str]| list.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let mut data = DataSet {
        inputs: names(&["fx_n", "fz_n", "insertion_speed_m_s"]),
        outputs: names(&["tip_fz_n"]),
        x: Vec::new(),
        y: Vec::new(),
        contact: None,
        files: vec![PathBuf::from("made")],
        trajectories: Vec::new(),
        hashes: vec!["made".into()],
    };
    for k in 0..trajectories {
        let [a, b, c] = [generator.f32(), generator.f32(), generator.f32()];
        for i in 0..200_u16 {
            let t = f32::from(i) * 0.01;
            let speed = 0.03 * ((5.0 + 3.0 * a) * t + 6.0 * b).sin();
            let side = 2.0 * ((3.0 + 2.0 * b) * t + 6.0 * c).sin();
            let tip = 2.0 * ((4.0 + 3.0 * c) * t + 6.0 * a).sin();
            let friction = (0.3 + 0.3 * side.abs()) * speed / speed.hypot(0.003);
            data.x.extend([side, tip + friction, speed]);
            data.y.push(tip);
        }
        data.trajectories.push(Trajectory { file: 0, rows: k * 200..(k + 1) * 200 });
    }
    data
}

fn quick() -> TrainingSettings {
    TrainingSettings { hidden: vec![16], members: 2, epochs: Some(12), ..TrainingSettings::default() }
}

fn trained(data: &DataSet) -> ForceModel {
    train_model(data, &quick(), [None, None], &AtomicBool::new(false), &|_| {}).unwrap()
}

#[test]
fn friction_is_taken_out_of_unseen_trajectories_and_doubt_knows_its_limits() {
    let mut estimator = Estimator::new(trained(&world(30, 1)));
    let unseen = world(10, 2);
    let figures = evaluate(&mut estimator, &unseen).unwrap().overall;
    let mae = |k: usize| figures.methods[k].outputs[0].unwrap().mae;
    assert!(mae(0) < 0.5 * mae(1) && mae(0) < 0.8 * mae(2), "network {}, none {}, linear {}", mae(0), mae(1), mae(2));
    assert!(figures.doubt_fraction <= 0.05, "{}", figures.doubt_fraction);
    let flagged = |edit: &dyn Fn(&mut [f32])| {
        let doubted = (0..unseen.rows()).filter(|row| {
            let mut inputs = unseen.input(*row).to_vec();
            edit(&mut inputs);
            estimator.clone().estimate(&inputs).in_doubt
        });
        doubted.count() as f64 / unseen.rows() as f64
    };
    assert!(flagged(&|x| x[1] = 3.5_f32.copysign(x[1])) >= 0.95);
    assert!(flagged(&|x| x[0] = 2.6_f32.copysign(x[0])) >= 0.95);
    assert!(flagged(&|x| x[2] = 0.05) >= 0.95);
    for bad in [f32::NAN, f32::INFINITY, f32::MAX] {
        let estimate = estimator.estimate(&[bad, 0.0, 0.0]);
        assert!(estimate.in_doubt && estimate.output.iter().all(|y| y.is_finite()), "{bad}: {estimate:?}");
    }
    assert!(estimator.estimate(&[0.0]).in_doubt);
}

#[test]
fn a_model_comes_back_from_its_file_bit_by_bit_and_a_seed_repeats_it() {
    let data = world(12, 3);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.safetensors");
    let model = trained(&data);
    save_model(&model, &path).unwrap();
    let mut estimators = [model, trained(&data), load_model(&path).unwrap()].map(Estimator::new);
    let [before, after] = [0, 2].map(|k| estimators[k].model().origin.clone());
    for (a, b) in before.figures.iter().zip(&after.figures) {
        // JSON may change the last bit of an f64, so allow a tolerance.
        assert!((a.validation_loss - b.validation_loss).abs() < 1e-12 && a.epoch == b.epoch);
    }
    assert_eq!(before, ModelOrigin { figures: before.figures.clone(), ..after });
    for row in 0..200 {
        let [ours, again, loaded] = [0, 1, 2].map(|k| estimators[k].estimate(data.input(row)));
        assert_eq!(ours, again);
        assert_eq!(ours, loaded);
    }
}

#[test]
fn a_wrong_file_is_refused_in_one_line_and_never_read_as_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.safetensors");
    save_model(&trained(&world(8, 4)), &path).unwrap();
    let good = std::fs::read(&path).unwrap();
    let refused = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        let message = load_model(&path).unwrap_err().to_string();
        assert!(message.contains("m.safetensors") && message.lines().count() == 1, "{message}");
        message
    };
    refused(b"");
    refused(&good[..good.len() / 2]);
    let swapped = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let at = good.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        let mut bytes = good.clone();
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        bytes
    };
    assert!(refused(&swapped("nima tip force 3", "nima tip force 9")).contains("this version reads"));
    assert!(refused(&swapped("doubt.centres", "doubt.central")).contains("doubt.centres is missing"));
    assert!(refused(&swapped("\"nima\"", "\"nina\"")).contains("metadata"));
    // A misspelled optional key must not be ignored.
    assert!(refused(&swapped("epochs", "epocks")).contains("unknown field `epocks`"));
    let mut poisoned = good.clone();
    let end = poisoned.len();
    poisoned[end - 4..].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(refused(&poisoned).contains("non-finite"));
    // A file in which a single bit was flipped is never read as another model.
    let mut generator = fastrand::Rng::with_seed(9);
    for _ in 0..300 {
        let mut flipped = good.clone();
        flipped[generator.usize(..good.len())] ^= 1 << generator.u8(..8);
        refused(&flipped);
    }
}

#[test]
fn training_refuses_what_cannot_be_learned_and_stops_when_asked() {
    let attempt = |data: &DataSet, settings: &TrainingSettings, cancel: bool| {
        train(data, settings, &AtomicBool::new(cancel), &|_| {}).map(|_| ()).unwrap_err().to_string()
    };
    let data = world(5, 5);
    assert!(attempt(&data, &quick(), true).contains("cancelled"));
    assert!(attempt(&data, &TrainingSettings { members: 0, ..quick() }, false).contains("members"));
    assert!(attempt(&data, &TrainingSettings { hidden: vec![], ..quick() }, false).contains("hidden"));
    let mut still = data.clone();
    still.y.fill(1.0);
    assert!(attempt(&still, &quick(), false).contains("\"tip_fz_n\" is constant"));
    let mut short = world(1, 5);
    short.x.truncate(30);
    short.y.truncate(10);
    assert!(attempt(&short, &quick(), false).contains("too few rows: 10"));
}

#[test]
fn both_signs_of_a_quaternion_give_the_same_bits_and_a_constant_column_that_moves_is_in_doubt() {
    let mut data = world(8, 6);
    data.inputs = ["fx_n", "fz_n", "qw", "qx", "qy", "qz", "fixed"].map(str::to_owned).to_vec();
    data.x = (0..data.rows())
        .flat_map(|row| {
            let [side, wrist] = [data.x[3 * row], data.x[3 * row + 1]];
            [side, wrist, 0.9, 0.1 * side, -0.2 * (wrist + side).sin(), 0.3, 5.0]
        })
        .collect();
    let mut estimator = Estimator::new(trained(&data));
    assert_eq!(estimator.model().origin.constant, ["fixed"]);
    for row in (0..data.rows()).step_by(7) {
        let mut inputs = data.input(row).to_vec();
        let plus = estimator.estimate(&inputs);
        inputs[2..6].iter_mut().for_each(|q| *q = -*q);
        let minus = estimator.estimate(&inputs);
        assert_eq!(plus.output.map(f32::to_bits), minus.output.map(f32::to_bits));
        assert_eq!(plus.doubt.to_bits(), minus.doubt.to_bits());
        inputs[6] = 5.5;
        assert!(estimator.estimate(&inputs).in_doubt);
    }
}

#[test]
fn inputs_that_never_change_are_refused() {
    let refusal = |edit: &dyn Fn(&mut [f32])| {
        let mut data = world(12, 5);
        data.x.chunks_mut(3).for_each(edit);
        train_model(&data, &quick(), [None, None], &AtomicBool::new(false), &|_| {})
            .err()
            .map(|error| error.to_string())
    };
    let words = "no force at the wrist changes over the whole data set";
    assert!(refusal(&|x| x.fill(0.0)).is_some_and(|report| report.contains(words)));
    assert!(refusal(&|x| (x[0], x[1]) = (1.3, -2.1)).is_some_and(|report| report.contains(words)), "both forces hang");
    assert_eq!(refusal(&|x| x[0] = 0.0), None, "one axis may be unused");
    // Columns with other names are not assumed to be forces, but something in the data must change.
    let mut data = world(12, 5);
    data.inputs = ["a", "b", "c"].map(str::to_owned).to_vec();
    data.x.fill(1.0);
    let report = train_model(&data, &quick(), [None, None], &AtomicBool::new(false), &|_| {}).unwrap_err().to_string();
    assert!(report.contains("no input changes over the whole data set"), "{report}");
}
