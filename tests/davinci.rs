//! The tip-force machinery on real recordings: jaw torque of a da Vinci Maryland instrument from its spindle's side.
//!
//! The recordings lie in `../shared/data/mrd_davinci` (file XY: drive frequency X, load Y); without them nothing is tested.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

use nima::tip_force::{DataSet, Estimator, Model, Selection, Settings, evaluate};

const FILES: [&str; 6] = ["00", "11", "12", "21", "22", "33"];

fn path(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../shared/data/mrd_davinci/maryland_r5_{file}.csv"))
}

fn split(held: [&str; 2], settings: &Settings, inputs: &str) {
    let list = |names: &str| Some(names.split(',').map(str::to_owned).collect());
    let selection = Selection { inputs: list(inputs), outputs: list("jaw_torque_nm") };
    let rest: Vec<PathBuf> = FILES.into_iter().filter(|file| !held.contains(file)).map(path).collect();
    let start = std::time::Instant::now();
    let data = DataSet::read(&rest, &selection).unwrap();
    let model = Model::train(&data, settings, [None, None], &AtomicBool::new(false), &|_| {}).unwrap();
    let figs: Vec<_> =
        model.origin.figures.iter().map(|f| (f.epoch, (f.validation_loss * 1000.0).round() / 1000.0)).collect();
    let mut estimator = Estimator::new(model);
    let data = DataSet::read(&held.map(path), &estimator.selection()).unwrap();
    let evaluation = evaluate(&mut estimator, &data).unwrap();
    let m: Vec<[f64; 3]> = evaluation
        .files
        .iter()
        .map(|f| {
            [
                f.methods[0].outputs[0].unwrap().mae * 1e3,
                f.methods[2].outputs[0].unwrap().mae * 1e3,
                f.doubt_share * 100.0,
            ]
        })
        .collect();
    println!(
        "{held:?} {:.2} {:.2} {} linear {:.2} {:.2} doubt {:.1} {:.1}  {:.1} s p99 {:.1} {figs:?}",
        m[0][0],
        m[1][0],
        if m[0][0] < 2.5 && m[1][0] < 2.5 { "pass" } else { "FAIL" },
        m[0][1],
        m[1][1],
        m[0][2],
        m[1][2],
        start.elapsed().as_secs_f64(),
        evaluation.inference_us.p99
    );
}

#[test]
fn explore() {
    let get = |name: &str, default: &str| std::env::var(name).unwrap_or_else(|_| default.to_owned());
    let d = Settings::default();
    let settings = Settings {
        epochs: get("EPOCHS", "").parse().ok(),
        members: get("MEMBERS", "4").parse().unwrap(),
        hidden: get("HIDDEN", "32,32").split(',').map(|x| x.parse().unwrap()).collect(),
        weight_decay: get("DECAY", &d.weight_decay.to_string()).parse().unwrap(),
        ..d
    };
    let inputs = get(
        "INPUTS",
        "spindle_angle_rad,spindle_torque_nm,presliding:spindle_angle_rad:0.03,presliding:spindle_angle_rad:0.1,midline:spindle_torque_nm:spindle_angle_rad:0.1",
    );
    for i in 0..6 {
        for j in i + 1..6 {
            split([FILES[i], FILES[j]], &settings, &inputs);
        }
    }
}
