use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::Vector3;
use nima_core::{
    impedance::{ImpedanceSettings, Mode, Recipe, Sample},
    signal::DifferentiatorKind,
};
use nima_recording::csv::{ColumnMapping, CsvRecording};
use nima_simulation::scene::Scene;
use nima_testing::unjudged;

use super::{sweep::mark_front, *};
use crate::{
    replay::{ReplayOptions, replay},
    solvers::LeastSquaresSolver,
};

/// Returns a hand that presses a soft spring twice per second.
fn source(seconds: f64, rate_hz: f64) -> TradeoffSource {
    let samples = (0..(seconds * rate_hz) as usize)
        .map(|k| {
            let t_s = k as f64 / rate_hz;
            let x = 0.01 * (std::f64::consts::TAU * 2.0 * t_s).sin() + 0.002 * (41.0 * t_s).sin();
            let f = if x > 0.0 { 300.0 * x.powf(1.3) } else { 0.0 };
            Sample { t_s, position_m: Vector3::new(x, 0.0, 0.0), force_n: Vector3::new(f, 0.0, 0.0) }
        })
        .collect();
    TradeoffSource::from_recording(
        CsvRecording { path: "press.csv".into(), axes: vec![0], rate_hz, samples, leader_m: None },
        "N",
    )
}

fn tiny() -> TradeoffPlan {
    let base = ImpedanceSettings { delay_s: 0.05, window_s: 0.2, max_degree: 2, ..ImpedanceSettings::default() };
    TradeoffPlan {
        degrees: vec![1, 2],
        windows_s: vec![0.1, 0.2],
        rates_hz: vec![500.0],
        delays_s: vec![0.05],
        differentiators: vec![DifferentiatorKind::SavitzkyGolay, DifferentiatorKind::Kalman],
        instants: 20,
        passes: 1,
        ..TradeoffPlan::full(base)
    }
}

fn swept(source: &TradeoffSource, plan: &TradeoffPlan) -> SourceFigures {
    sweep(std::slice::from_ref(source), plan, &AtomicBool::new(false), |_, _| {}).unwrap().sources.remove(0)
}

fn without_times(figures: &SourceFigures) -> Vec<(ParameterChoice, f64, f64, f64)> {
    figures.points.iter().map(|p| (p.choice, p.error, p.error_p95, p.dfr_error)).collect()
}

#[test]
fn every_knob_has_a_curve_and_every_point_its_figures() {
    let figures = swept(&source(3.0, 1000.0), &tiny());
    for knob in [Knob::Degree, Knob::Window, Knob::Rate, Knob::Delay, Knob::Differentiator, Knob::Mode, Knob::Grid] {
        assert!(figures.curves.iter().any(|curve| curve.knob == knob && !curve.points.is_empty()), "{knob:?}");
    }
    for point in &figures.points {
        assert!(point.cost_us.p50 > 0.0 && point.cost_us.p99 >= point.cost_us.p50, "{point:?}");
        assert!(point.error.is_finite(), "{point:?}");
        assert!(point.judged > if point.choice.method.mode().is_some() { 500 } else { 19 }, "{point:?}");
    }
    let dfr = figures.dfr(50.0).unwrap();
    assert!((dfr.ratio - 1.0).abs() < 1e-12, "{dfr:?}");
    for mode in [Mode::Anchored, Mode::Matched, Mode::Best] {
        let of: Vec<_> = figures.points.iter().filter(|p| p.choice.method == PlanMethod::Mode(mode)).collect();
        assert!(of.iter().all(|point| point.ratio < 0.8), "{of:?}");
        let once =
            |p: &&&SweepPoint| (p.choice.degree, p.choice.every) == (2, 1) && (p.choice.window_ms - 200.0).abs() < 1e-9;
        assert_eq!(of.iter().filter(once).count(), 1, "it has neither degree nor window: {of:?}");
    }
    let of_nima = figures.curves.iter().filter(|c| c.method == PlanMethod::Mode(Mode::Nima)).map(|c| c.knob);
    assert!(of_nima.eq([Knob::Rate, Knob::Delay, Knob::Degree, Knob::Window, Knob::Differentiator, Knob::Grid]));
    assert!(figures.skipped.is_empty());
}

#[test]
fn figures_repeat_but_for_the_times() {
    let source = source(2.0, 1000.0);
    assert_eq!(without_times(&swept(&source, &tiny())), without_times(&swept(&source, &tiny())));
}

/// The sweep and the replay of `nima identify` (which is tested to be causal) must give the same mean error.
#[test]
fn the_error_is_that_of_the_causal_replay() {
    let source = source(3.0, 1000.0);
    let figures = swept(&source, &tiny());
    for mode in Mode::ALL {
        let literal = Recipe::default();
        let options = ReplayOptions { mode, window_s: 0.2, delay_s: 0.05, max_degree: 2, cross_talk: false, literal };
        let mut sum = 0.0;
        let mut count = 0;
        replay(&source.recording, &options, |row| {
            if row.t_s >= figures.judged_from_s + 0.05 {
                sum += (row.rendered.unwrap_or_default() - row.measured).norm();
                count += 1;
            }
        })
        .unwrap();
        let point = figures
            .curves
            .iter()
            .find(|curve| curve.knob == Knob::Mode)
            .and_then(|curve| {
                curve.points.iter().map(|&i| &figures.points[i]).find(|p| p.choice.method == PlanMethod::Mode(mode))
            })
            .unwrap();
        assert_eq!(point.judged, count, "{mode}");
        assert!((point.error - sum / f64::from(count as u32)).abs() < 1e-12, "{mode}: {}", point.error);
    }
}

#[test]
fn every_solver_is_measured_on_the_same_instants() {
    let plan = TradeoffPlan { instants: 40, ..tiny() };
    let figures = swept(&source(3.0, 1000.0), &plan);
    let of = |solver: LeastSquaresSolver| {
        let method = PlanMethod::Solver(solver);
        figures.points.iter().find(|p| p.choice.method == method && p.choice.degree == 1).copied().unwrap()
    };
    let [ours, qr] = [LeastSquaresSolver::Sliding, LeastSquaresSolver::FreshQr].map(of);
    assert!((ours.error - qr.error).abs() < 1e-2 * qr.error, "{} {}", ours.error, qr.error);
    assert!(LeastSquaresSolver::ALL.map(of).iter().all(|p| p.judged == ours.judged && p.judged >= 40 && !p.pareto));
    assert!(LeastSquaresSolver::ALL.map(of).iter().all(|p| (p.dfr_error - ours.dfr_error).abs() < 1e-12));
}

#[test]
fn the_front_holds_what_nothing_beats() {
    let template = swept(&source(2.0, 1000.0), &tiny()).points[0];
    let at = |cost: f64, error: f64, delay_ms: f64| SweepPoint {
        choice: ParameterChoice { delay_ms, ..template.choice },
        cost_us: CostUs { p50: cost, p99: cost },
        error,
        pareto: false,
        ..template
    };
    let mut points = [
        at(1.0, 5.0, 50.0),
        at(2.0, 3.0, 50.0),
        at(2.5, 3.0, 50.0),
        at(4.0, 1.0, 50.0),
        at(5.0, 2.0, 50.0),
        at(4.0, 1.0, 50.0),
        at(6.0, f64::NAN, 50.0),
        at(9.0, 9.0, 100.0),
        at(0.1, 0.1, 50.0),
    ];
    let on_grid = [0, 1, 2, 3, 4, 5, 6, 7];
    mark_front(&mut points, &on_grid);
    assert_eq!(points.map(|p| p.pareto), [true, true, false, true, false, true, false, true, false]);
}

#[test]
fn what_does_not_fit_is_left_out_and_named() {
    let plan = TradeoffPlan { windows_s: vec![0.1, 0.2, 1.0], rates_hz: vec![66.0], ..tiny() };
    let figures = swept(&source(3.0, 1000.0), &plan);
    assert!(figures.skipped.iter().all(|skipped| skipped.choice.window_ms > 999.0));
    assert!(!figures.skipped.is_empty() && figures.skipped[0].reason.contains("a quarter of the 3.0 s"));
    let slow = swept(&source(3.0, 66.0), &plan);
    assert!(slow.skipped.iter().any(|skipped| skipped.reason.contains("10 to 10000")), "{:?}", slow.skipped);
    let error = sweep(&[source(0.2, 1000.0)], &tiny(), &AtomicBool::new(false), |_, _| {}).unwrap_err();
    assert!(error.to_string().starts_with("press: no point"), "{error}");
}

#[test]
fn a_sweep_tells_its_progress_and_stops_when_asked() {
    let cancel = AtomicBool::new(false);
    let mut seen = Vec::new();
    let result = sweep(&[source(3.0, 1000.0)], &tiny(), &cancel, |done, total| {
        seen.push((done, total));
        cancel.store(done == 3, Ordering::Relaxed);
    });
    assert!(matches!(result, Err(SweepError::Cancelled)));
    assert_eq!(seen.len(), 4);
    assert!(seen.iter().all(|(_, total)| *total == seen[0].1 && *total > 10));
}

#[test]
fn a_scene_is_recorded_open_loop_and_repeats() {
    let scene = Scene::load("peg_transfer").unwrap();
    let [one, two] = [0, 1].map(|_| TradeoffSource::from_scene(&scene, 1000.0, 5.0));
    assert_eq!(one.recording.samples, two.recording.samples);
    assert_eq!((one.recording.samples.len(), one.recording.axes.len()), (5000, 3));
    assert!(one.recording.samples.iter().any(|sample| sample.force_n.z > 1.0), "it touches the tissue");
    assert!((one.slower(5).rate_hz - 200.0).abs() < 1e-9 && one.slower(5).samples.len() == 1000);
}

#[test]
fn a_real_recording_has_a_front() {
    let Some(path) = unjudged::recording("tue_1dof/m1_question1a_foam.csv") else { return };
    let mapping = ColumnMapping::parse(&["x=pos_follower_rad", "fx=Fe_Nm"]).unwrap();
    let source = TradeoffSource::from_recording(CsvRecording::read(&path, &mapping).unwrap(), "Nm");
    let figures = swept(&source, &tiny());
    // On foam `matched` alone is about as good as its mixture with `anchored`, and cheaper.
    let ours = [Mode::Best, Mode::Matched].map(PlanMethod::Mode);
    assert!(figures.points.iter().any(|p| p.pareto && ours.contains(&p.choice.method)));
    let min = |method| {
        let errors = figures.points.iter().filter(|p| p.choice.method == method).map(|p| p.error);
        errors.fold(f64::INFINITY, f64::min)
    };
    let [best, matched] = ours.map(min);
    assert!(best < 1.05 * matched, "{best} Nm, {matched} Nm");
    assert!(figures.points.iter().any(|p| p.pareto && p.choice.method == PlanMethod::Mode(Mode::Dfr)));
}
