use nima_core::impedance::{Baseline, Mode};
use nima_recording::csv::{ColumnMapping, CsvRecording};
use nima_simulation::scene::Scene;
use nima_testing::unjudged;

use super::{BaselineOptions, BaselineReport, CHOSEN_ON, Split};
use crate::{Experiment as _, Findings as _, tradeoff::TradeoffSource};

fn ratio(report: &BaselineReport, split: Split, mode: Mode, delay_ms: f64) -> f64 {
    let is_it = |mean: &&super::BaselineMean| {
        mean.split == split && mean.mode == mode && (mean.delay_ms - delay_ms).abs() < 1e-9
    };
    report.means.iter().find(is_it).unwrap().ratio.mean
}

fn scenes(names: &[&str], seconds: f64, delays_s: &[f64]) -> BaselineOptions {
    let source = |name: &&str| (TradeoffSource::from_scene(&Scene::load(name).unwrap(), 1000.0, seconds), Split::Scene);
    let sources = names.iter().map(source).collect();
    BaselineOptions { sources, delays_s: delays_s.to_vec(), cross_talk: false, inputs: Vec::new() }
}

#[test]
fn a_scene_gives_every_mode_a_figure_and_the_same_one_again() {
    let options = scenes(&["peg_transfer"], 3.0, &[0.01, 0.05]);
    let report = options.run(&mut |_, _, _| {}).unwrap();
    assert_eq!(report.rows.len(), 2 * (5 + Mode::BASELINES.len()));
    assert!(report.rows.iter().all(|row| row.ratio.is_finite() && row.ratio > 0.0), "{report:?}");
    for row in report.rows.iter().filter(|row| row.mode == Mode::Dfr) {
        assert!((row.ratio - 1.0).abs() < 1e-12, "reflection is what everything is compared with: {row:?}");
    }
    assert_eq!(report.rows, options.run(&mut |_, _, _| {}).unwrap().rows);
    let text = report.text();
    for mode in Mode::BASELINES {
        assert!(text.contains(&format!("| {mode} |")), "{text}");
    }
    assert_eq!(report.files()[1].1.lines().count(), 1 + report.rows.len());
}

#[test]
fn sources_of_different_rates_share_a_column() {
    let scene = Scene::load("peg_transfer").unwrap();
    let source = |rate_hz| (TradeoffSource::from_scene(&scene, rate_hz, 3.0), Split::Scene);
    let sources = vec![source(1000.0), source(66.0)];
    let options = BaselineOptions { sources, delays_s: vec![0.05], cross_talk: false, inputs: Vec::new() };
    let report = options.run(&mut |_, _, _| {}).unwrap();
    assert!(report.means.iter().all(|mean| mean.sources == 2), "{:?}", report.means);
    assert!(report.text().contains("| mode | 50 ms |\n"), "{}", report.text());
    let used_ms: Vec<f64> = report.rows.iter().map(|row| row.used_delay_ms).collect();
    assert!(used_ms.iter().any(|ms| (ms - 45.4545).abs() < 0.01), "three samples at 66 Hz: {used_ms:?}");
}

#[test]
fn sources_that_cannot_be_compared_are_named() {
    let none = scenes(&["free_motion"], 1.0, &[0.0]).run(&mut |_, _, _| {}).unwrap_err().to_string();
    assert!(none.contains("Free motion") && none.contains("--delay-ms"), "{none}");
    let short = scenes(&["peg_transfer"], 0.1, &[0.3]).run(&mut |_, _, _| {}).unwrap_err().to_string();
    assert!(short.contains("100 samples") && !short.contains('\n'), "{short}");
}

#[test]
fn recordings_are_split_by_name() {
    assert_eq!(Split::of_recording("m1_question1b_foam"), Split::ChosenOn);
    assert_eq!(Split::of_recording("m1_question1c_foam"), Split::HeldOut);
    assert!(CHOSEN_ON.iter().all(|name| Split::of_recording(name) == Split::ChosenOn));
}

#[test]
fn on_real_recordings_the_peers_are_as_good_as_their_literature() {
    let mapping = ColumnMapping::parse(&["x=pos_follower_rad".to_owned(), "fx=Fe_Nm".to_owned()]).unwrap();
    let source = |name: &str| {
        let path = unjudged::recording(&format!("tue_1dof/{name}.csv"))?;
        Some((TradeoffSource::from_recording(CsvRecording::read(&path, &mapping).unwrap(), "Nm"), Split::HeldOut))
    };
    let names = ["m1_question1c_foam", "m1_question1c_spring", "m2_question1a_spring"];
    let Some(sources) = names.into_iter().map(source).collect::<Option<Vec<_>>>() else { return };
    let delays_s = vec![0.01, 0.3];
    let report =
        BaselineOptions { sources, delays_s, cross_talk: false, inputs: Vec::new() }.run(&mut |_, _, _| {}).unwrap();
    let of = |baseline, delay_ms| ratio(&report, Split::HeldOut, Mode::Baseline(baseline), delay_ms);
    assert!(of(Baseline::Kalman, 10.0) < 0.9, "a short extrapolation is better than holding");
    assert!(of(Baseline::Autoregressive, 10.0) < 0.9);
    assert!(of(Baseline::ModelMediated, 300.0) < 0.6, "a model bridges a long delay");
    for baseline in Baseline::ALL {
        assert!(of(baseline, 300.0) < 1.5, "{baseline:?}: {}", of(baseline, 300.0));
    }
}
