//! Size of the tip-force network against accuracy and time, on sessions that it was not trained on, and compared with a
//! general matrix library.
//!
//! `./dev bench` prints one row per size: errors against the simulated trocar's true force, predictions without
//! contact, time of one prediction, time of training on 30000 rows. Below it the same network as products of dynamic
//! matrices. With `--ratios` it prints only the ratio of the two, which `./dev bench` compares.
#![expect(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

mod ratio;

use std::{hint::black_box, time::Instant};

use nalgebra::DMatrix;
use nima_core::tip_force::{FeatureSettings, TrainingSettings};
use nima_study::validation::isolation::{IsolationSessions, NetworkErrors, ROWS};

const SIZES: [&[usize]; 7] = [&[8], &[16], &[32], &[16, 16], &[32, 32], &[64, 64], &[128, 128]];

/// The same arithmetic with a matrix library as a multiple of ours, although ours also computes the uncertainty.
fn ratios() {
    let sessions = IsolationSessions::record(1, ROWS, FeatureSettings::default()).unwrap();
    let settings = TrainingSettings { epochs: Some(1), ..TrainingSettings::default() };
    let (mut estimator, _) = sessions.train(None, &settings).unwrap();
    let input = vec![0.1; estimator.model().inputs.len()];
    let ours = || {
        black_box(estimator.estimate(black_box(&input)));
    };
    ratio::report("tip_force_matrices", ours, matrices());
}

fn main() {
    if ratio::alone() {
        return ratios();
    }
    let sessions = IsolationSessions::record(1, ROWS, FeatureSettings::default()).unwrap();
    println!(
        "{:>10} {:>24} {:>8} {:>18} {:>10}",
        "hidden", "MAE x y z (N)", "free sd", "answer p50/p99 us", "training s"
    );
    for hidden in SIZES {
        let settings = TrainingSettings { hidden: hidden.to_vec(), ..TrainingSettings::default() };
        let (_, NetworkErrors { truth, no_contact, inference_us, training_s, .. }) =
            sessions.train(None, &settings).unwrap();
        let mae: Vec<String> =
            truth.methods[0].outputs.iter().flatten().map(|stats| format!("{:.3}", stats.mae)).collect();
        let free = no_contact.iter().map(|free| free.sd).fold(0.0, f64::max);
        let times = format!("{:.1} / {:.1}", inference_us.p50, inference_us.p99);
        println!("{:>10} {:>24} {free:>8.3} {times:>18} {training_s:>10.1}", format!("{hidden:?}"), mae.join(" "));
    }
    println!("\nsmoothing of the wrench and the depth (ms), usual size:");
    for smoothing_s in [0.001, 0.002, 0.005, 0.010, 0.020] {
        let features = FeatureSettings { smoothing_s, ..FeatureSettings::default() };
        let sessions = IsolationSessions::record(1, ROWS, features).unwrap();
        let (_, NetworkErrors { truth, no_contact, .. }) = sessions.train(None, &TrainingSettings::default()).unwrap();
        let mae = truth.methods[0].outputs.iter().flatten().map(|stats| stats.mae).fold(0.0, f64::max);
        let free = no_contact.iter().map(|free| free.sd).fold(0.0, f64::max);
        println!("{:>6.0} worst MAE {mae:.3} N, free sd {free:.3} N", 1e3 * smoothing_s);
    }
    println!("\nfour networks of 36-32-32-3 for one row as products of matrices: {:.1} us median", matrices_us());
}

/// Returns the same arithmetic as products of dynamic matrices.
fn matrices() -> impl FnMut() {
    let mut generator = fastrand::Rng::with_seed(1);
    let mut random = |rows: usize, columns: usize| DMatrix::from_fn(rows, columns, |_, _| 2.0 * generator.f32() - 1.0);
    let layers: Vec<[DMatrix<f32>; 3]> = (0..4).map(|_| [random(32, 36), random(32, 32), random(3, 32)]).collect();
    let input = random(36, 1);
    let bent = |z: f32| z / (1.0 + z * z).sqrt();
    move || {
        for [first, second, last] in &layers {
            let hidden = (second * (first * &input).map(bent)).map(bent);
            black_box(last * hidden);
        }
    }
}

/// Returns their median time, microseconds.
fn matrices_us() -> f64 {
    let mut work = matrices();
    let mut times: Vec<f64> = (0..2000)
        .map(|_| {
            let start = Instant::now();
            work();
            1e6 * start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
