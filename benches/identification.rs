//! Identification of all five degrees on three axes: our routine compared with the routines that it replaces, in one
//! run.
//!
//! Prints a table with p50 and p99 per tick and the ratios; with `--ratios` it prints only the ratios that `./dev bench`
//! compares.

#![expect(clippy::expect_used, reason = "a benchmark may stop at a setting out of range")]

mod ratio;

use std::{hint::black_box, time::Instant};

use nalgebra::{DMatrix, DVector, Vector3};
use nima_core::{
    impedance::{
        Baseline, Identifier, ImpedanceFactor, ImpedanceSettings, ImpedanceSolution, Mode, ModeSet, Sample,
        SlidingWindow,
    },
    signal::Lanes,
};

const RATE_HZ: f64 = 1000.0;
const COLUMNS: usize = 16;
const ROW: usize = COLUMNS + 1;
/// The modes without matched rendering.
const BEFORE: ModeSet = ModeSet::only(Mode::Anchored).with(Mode::Literal).with(Mode::Linear);

fn sample(k: usize) -> Sample {
    let t = k as f64 / RATE_HZ;
    let wave =
        |phase: f64| 0.02 * (5.0 * t + phase).sin() + 0.003 * (31.0 * t).sin() + 1e-4 * (157.0 * t + phase).cos();
    let x = Vector3::new(wave(0.0), wave(1.0), wave(2.0));
    Sample { t_s: t, position_m: x, force_n: x.map(|x| 80.0 * x + 2000.0 * x * x + 0.1 * (400.0 * x).sin()) }
}

/// Returns rows of scaled features as the identifier computes them (here from analytic derivatives), with the
/// right-hand side last.
fn rows(count: usize) -> Vec<[Lanes; ROW]> {
    (0..count)
        .map(|k| {
            let mut row = [Lanes::ZERO; ROW];
            for lane in 0..3 {
                let [before, now, after] = [k, k + 1, k + 2].map(|k| sample(k).position_m[lane]);
                let base = [now / 0.1, (after - before) * 500.0 / 0.2, (after - 2.0 * now + before) * 1e6 / 4.0];
                row[0][lane] = 1.0;
                for j in 0..15 {
                    row[j + 1][lane] = (0..=j / 3).map(|_| base[j % 3]).product();
                }
                row[COLUMNS][lane] = sample(k + 1).force_n[lane];
            }
            row
        })
        .collect()
}

/// Returns the sorted times of `work` per call, us.
fn times_us(calls: usize, mut work: impl FnMut(usize)) -> Vec<f64> {
    let mut times: Vec<f64> = (0..calls)
        .map(|k| {
            let start = Instant::now();
            work(k);
            start.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times
}

fn percentile(times: &[f64], fraction: f64) -> f64 {
    times[((times.len() - 1) as f64 * fraction).round() as usize]
}

fn sliding(block: usize) -> (SlidingWindow<ImpedanceFactor>, ImpedanceSolution) {
    let ridge = ImpedanceFactor::with_ridge(COLUMNS, 2e-6 * block as f64);
    (SlidingWindow::new(block, ImpedanceFactor::new(COLUMNS), ridge), ImpedanceSolution::new(COLUMNS))
}

fn identifier(window: usize, modes: ModeSet) -> Identifier {
    let settings = ImpedanceSettings { window_s: window as f64 / RATE_HZ, modes, ..ImpedanceSettings::default() };
    Identifier::new(&settings).expect("settings are in range")
}

fn window_matrix(rows: &[[Lanes; ROW]], lane: usize, columns: std::ops::Range<usize>) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), columns.len(), |i, j| rows[i][columns.start + j][lane])
}

fn force(rows: &[[Lanes; ROW]], lane: usize) -> DVector<f64> {
    DVector::from_fn(rows.len(), |i, _| rows[i][COLUMNS][lane])
}

/// Five pseudo-inverses per axis by singular values, the textbook method.
fn svd(rows: &[[Lanes; ROW]]) -> f64 {
    let mut sum = 0.0;
    for lane in 0..3 {
        let f = force(rows, lane);
        for degree in 1..=5 {
            let x = window_matrix(rows, lane, 1..1 + 3 * degree);
            sum += x.pseudo_inverse(1e-12).map_or(0.0, |inverse| (inverse * &f)[0]);
        }
    }
    sum
}

/// `M = F X^T (X X^T)^-1` for five degrees per axis, computed from scratch.
fn normal_equations(rows: &[[Lanes; ROW]]) -> f64 {
    let mut sum = 0.0;
    for lane in 0..3 {
        let f = force(rows, lane);
        for degree in 1..=5 {
            let x = window_matrix(rows, lane, 1..1 + 3 * degree);
            let gram = x.tr_mul(&x);
            sum += gram.try_inverse().map_or(0.0, |inverse| (inverse * x.tr_mul(&f))[0]);
        }
    }
    sum
}

/// Computes one QR factorisation per axis and tick from scratch; all five degrees follow from it.
fn fresh_qr(rows: &[[Lanes; ROW]]) -> f64 {
    (0..3).map(|lane| window_matrix(rows, lane, 0..ROW).qr().unpack_r()[(0, 0)]).sum()
}

/// Prints p50, p99 and the maximum of sorted times; returns p50.
fn print(window: usize, name: &str, times: &[f64]) -> f64 {
    let [p50, p99, max] = [0.5, 0.99, 1.0].map(|fraction| percentile(times, fraction));
    println!("{window:>6}  {name:<44} {p50:>10.2} {p99:>10.2} {max:>10.2}");
    p50
}

/// Work of the slowest tick relative to the median. Every tick of three blocks is repeated and the minimum time of each
/// is used, so that interruptions do not count.
fn worst_to_median(window: usize, rows: &[[Lanes; ROW]]) -> f64 {
    let ticks = 3 * window / 2;
    let mut min = vec![f64::INFINITY; ticks];
    for _ in 0..15 {
        let (mut slide, mut solution) = sliding(window / 2);
        rows[..2 * window].iter().for_each(|row| slide.push(row));
        for (min, row) in min.iter_mut().zip(&rows[2 * window..]) {
            let start = Instant::now();
            slide.push(row);
            solution.solve(slide.current());
            *min = min.min(start.elapsed().as_secs_f64());
        }
    }
    min.sort_by(f64::total_cmp);
    percentile(&min, 1.0) / percentile(&min, 0.5)
}

/// Prints all results for one window length; returns p50 of our routine, us.
fn table(window: usize) -> f64 {
    let rows = rows(4 * window + 20_000);
    let calls = 20_000;
    let warm = 3 * window;
    let (mut slide, mut solution) = sliding(window / 2);
    rows[..warm].iter().for_each(|row| slide.push(row));
    let times = times_us(calls, |k| {
        slide.push(&rows[warm + k]);
        solution.solve(slide.current());
        black_box(&solution);
    });
    let ours = print(window, "ours: all degrees, constant, ridge, 3 axes", &times);
    for (name, modes) in [
        ("identifier step, anchored", ModeSet::only(Mode::Anchored)),
        ("identifier step, literal and linear", ModeSet::only(Mode::Literal).with(Mode::Linear)),
        ("identifier step, matched", ModeSet::only(Mode::Matched)),
        ("identifier step, best (what runs by default)", ModeSet::only(Mode::Best)),
        ("identifier step, the paper's columns repaired", ModeSet::only(Mode::Nima)),
        ("identifier step, anchored, literal and linear", BEFORE),
        ("identifier step, all modes", ModeSet::ALL),
        ("identifier step, model_mediated", ModeSet::only(Mode::Baseline(Baseline::ModelMediated))),
        ("identifier step, waves", ModeSet::only(Mode::Baseline(Baseline::Waves))),
        ("identifier step, passivity", ModeSet::only(Mode::Baseline(Baseline::Passivity))),
        ("identifier step, kalman", ModeSet::only(Mode::Baseline(Baseline::Kalman))),
        ("identifier step, autoregressive", ModeSet::only(Mode::Baseline(Baseline::Autoregressive))),
        ("identifier step, increments", ModeSet::only(Mode::Baseline(Baseline::Increments))),
    ] {
        let samples: Vec<_> = (0..warm + calls).map(sample).collect();
        let mut identifier = identifier(window, modes);
        samples[..warm].iter().for_each(|sample| identifier.step(sample));
        let times = times_us(calls, |k| identifier.step(&samples[warm + k]));
        print(window, name, &times);
    }
    let at = |k: usize| &rows[warm + k - window..warm + k];
    let few = if window > 1000 { 11 } else { 101 };
    let time = |work: fn(&[[Lanes; ROW]]) -> f64| {
        times_us(few, |k| {
            black_box(work(at(k)));
        })
    };
    let qr = print(window, "fresh QR", &time(fresh_qr)) / ours;
    let normal = print(window, "normal equations x 5, fresh", &time(normal_equations)) / ours;
    let svd = print(window, "SVD pseudo-inverse x 5, fresh", &time(svd)) / ours;
    println!("{window:>6}  ratio to ours: SVD {svd:.0}, normal equations {normal:.0}, fresh QR {qr:.1}");
    println!("{window:>6}  slowest tick / median tick: {:.2}", worst_to_median(window, &rows));
    ours
}

/// Prints the costs of the alternatives as multiples of ours.
fn ratios(window: usize) {
    let rows = rows(3 * window);
    let (mut slide, mut solution) = sliding(window / 2);
    for row in &rows {
        slide.push(row);
    }
    let mut next = rows.iter().cycle();
    let mut ours = || {
        next.next().into_iter().for_each(|row| slide.push(row));
        solution.solve(slide.current());
        black_box(&solution);
    };
    let mut report = |name: &str, theirs: fn(&[[Lanes; ROW]]) -> f64| {
        ratio::report(&format!("identification_{window}_{name}"), &mut ours, || {
            black_box(theirs(&rows[..window]));
        });
    };
    report("svd", svd);
    report("normal_equations", normal_equations);
    report("fresh_qr", fresh_qr);
}

fn main() {
    nima_baselines::provide();
    if ratio::alone() {
        [300, 3000].into_iter().for_each(ratios);
        return;
    }
    println!("{:>6}  {:<44} {:>10} {:>10} {:>10}", "rows", "per tick, 3 axes, N = 1..5", "p50 us", "p99 us", "max us");
    let short = table(300);
    let long = table(3000);
    println!("3000 rows cost {:.2} times 300 rows", long / short);
}
