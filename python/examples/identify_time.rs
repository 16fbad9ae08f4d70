//! Time of an identification in Rust, which `tests/speed.py` compares with that from Python: the same motion and
//! options.
//!
//! `cargo run --release --example identify_time -- SAMPLES RUNS` prints the seconds of each run.

use std::{env, error::Error, path::Path, time::Instant};

use nalgebra::Vector3;
use nima_core::impedance::{Mode, Recipe, Sample};
use nima_recording::csv::CsvRecording;
use nima_study::replay::{ReplayOptions, replay};

/// Returns the motion of `tests/speed.py`.
fn sample(i: usize) -> Sample {
    let t_s = i as f64 * 1e-3;
    let position_m = Vector3::new(0.02 * (7.0 * t_s).sin(), 0.015 * (4.4 * t_s).cos(), 0.008 * (12.0 * t_s).sin());
    Sample { t_s, position_m, force_n: position_m.map(|x| 350.0 * x.max(0.0)) }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut numbers = env::args().skip(1).map(|text| text.parse::<usize>());
    let mut number = |name| numbers.next().ok_or_else(|| format!("give {name}"));
    let samples = number("SAMPLES")??;
    let runs = number("RUNS")??;
    let recording = CsvRecording::of_samples(Path::new("speed"), vec![0, 1, 2], (0..samples).map(sample).collect())?;
    let literal = Recipe::default();
    let options =
        ReplayOptions { mode: Mode::Best, window_s: 0.3, delay_s: 0.05, max_degree: 5, cross_talk: false, literal };
    for _ in 0..runs {
        let begin = Instant::now();
        let mut sum = 0.0;
        let figures = replay(&recording, &options, |row| sum += row.rendered.map_or(0.0, |force_n| force_n.x))?;
        println!("{} {:e} {sum:e}", begin.elapsed().as_secs_f64(), figures.error.mae);
    }
    Ok(())
}
