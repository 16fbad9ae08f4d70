//! Processor cost of the traces per frame, without a window: 12 traces of 120 s at 2 kHz, our panel compared with the same
//! plots given every sample. Includes layout, our own code and the generation of triangles; the graphics card draws them.
//!
//! Prints ms per frame as percentiles of each of several runs, and the ratio of the medians; with `--ratios` only the ratio
//! that `./dev bench` stores. Everything is measured on this computer; nothing is asserted.

#![expect(clippy::unwrap_used, reason = "a benchmark that cannot begin has nothing to say")]

#[path = "../../benches/ratio.rs"]
mod ratio;

use std::{hint::black_box, time::Instant};

use egui::{Context, Pos2, RawInput, Rect, Ui, vec2};
use egui_plot::{Line, Plot, PlotPoint, PlotPoints};
use nima_machine::{config::RigConfig, rig::Side};
use nima_panels::{TracesState, force_traces_ui};
use nima_screen::{history::CHANNELS, live::LiveState, theme};
use nima_simulation::scene::Scene;

const RATE_HZ: f64 = 2000.0;
const SECONDS: f64 = 120.0;
const FRAME_S: f64 = 1.0 / 30.0;
const RUNS: usize = 5;
const FRAMES: usize = 60;
const SIZE: egui::Vec2 = vec2(1600.0, 1000.0);

/// Returns the force of contacts with tremor and sensor noise over one second, N.
fn force_n(t_s: f64, channel: usize) -> f64 {
    let contact = (2.5 * (t_s * 1.3 + channel as f64).sin()).max(0.0);
    let noise = ((t_s * 7919.0 + channel as f64 * 31.0).sin() * 43_758.547).fract();
    contact + 0.05 * (t_s * 56.0).sin() + 0.06 * noise
}

/// Both hands' histories up to a time.
fn fill(live: &mut LiveState, from_s: f64, to_s: f64) {
    let first = (from_s * RATE_HZ).round() as u64;
    let end = (to_s * RATE_HZ).round() as u64;
    for sample in first..end {
        let t_s = sample as f64 / RATE_HZ;
        for side in Side::ALL {
            let values: [f32; CHANNELS] =
                std::array::from_fn(|channel| force_n(t_s, channel + CHANNELS * side.index()) as f32);
            live.history[side.index()].push(t_s, &values);
        }
    }
}

/// Returns the time of one frame of this content, triangles included, ms.
fn frame_ms(ctx: &Context, number: usize, content: &mut dyn FnMut(&mut Ui)) -> f64 {
    let input = RawInput {
        screen_rect: Some(Rect::from_min_size(Pos2::ZERO, SIZE)),
        time: Some(number as f64 * FRAME_S),
        ..RawInput::default()
    };
    let began = Instant::now();
    let mut output = ctx.run_ui(input, |ui| content(ui));
    let shapes = std::mem::take(&mut output.shapes);
    black_box(ctx.tessellate(shapes, output.pixels_per_point));
    let frame_ms = began.elapsed().as_secs_f64() * 1e3;
    output.drop_without_applying_deltas();
    frame_ms
}

/// Returns a frame of our panel, twice: three plots with two traces for each hand. Returns its time, ms.
fn ours() -> impl FnMut() -> f64 {
    let mut live = LiveState::new(RigConfig::load("simulated").unwrap(), Scene::load("bimanual").unwrap());
    let mut now_s = SECONDS;
    fill(&mut live, 0.0, now_s);
    let ctx = Context::default();
    theme::apply(&ctx);
    let mut states = Side::ALL.map(TracesState::of);
    for state in &mut states {
        state.show_last(SECONDS);
    }
    let mut numbers = 0..;
    move || {
        fill(&mut live, now_s, now_s + FRAME_S);
        now_s += FRAME_S;
        frame_ms(&ctx, numbers.next().unwrap(), &mut |ui| {
            ui.columns(2, |columns| {
                for (ui, state) in columns.iter_mut().zip(&mut states) {
                    ui.push_id(state.side().word(), |ui| force_traces_ui(ui, &mut live, state, None));
                }
            });
        })
    }
}

/// Returns a frame of the same twelve lines, with every sample given to the plots. Returns its time, ms.
fn all_samples() -> impl FnMut() -> f64 {
    let count = (SECONDS * RATE_HZ) as u64;
    let lines: Vec<Vec<PlotPoint>> = (0..2 * CHANNELS)
        .map(|channel| {
            let point = |sample| {
                let t_s = sample as f64 / RATE_HZ;
                PlotPoint::new(t_s - SECONDS, force_n(t_s, channel))
            };
            (0..count).map(point).collect()
        })
        .collect();
    let ctx = Context::default();
    theme::apply(&ctx);
    let mut numbers = 0..;
    move || {
        frame_ms(&ctx, numbers.next().unwrap(), &mut |ui| {
            ui.columns(2, |columns| {
                for (side, ui) in columns.iter_mut().enumerate() {
                    let height = ui.available_height() / 3.0 - 8.0;
                    for axis in 0..3 {
                        Plot::new((side, axis)).height(height).show(ui, |plot| {
                            for channel in [axis, axis + 3] {
                                let points = &lines[channel + CHANNELS * side];
                                plot.line(Line::new(channel.to_string(), PlotPoints::Borrowed(points)));
                            }
                        });
                    }
                }
            });
        })
    }
}

/// Returns the times of some runs of this many frames, ms.
fn runs(frames: usize, mut frame: impl FnMut() -> f64) -> Vec<Vec<f64>> {
    (0..RUNS).map(|_| (0..frames).map(|_| frame()).collect()).collect()
}

/// Prints the percentiles of each run; returns the median of all.
fn report(name: &str, runs: &[Vec<f64>]) -> f64 {
    let at = |sorted: &[f64], fraction: f64| sorted[((fraction * sorted.len() as f64) as usize).min(sorted.len() - 1)];
    let mut all = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        let mut sorted = run.clone();
        sorted.sort_by(f64::total_cmp);
        let [p10, p50, p90, p99] = [0.1, 0.5, 0.9, 0.99].map(|fraction| at(&sorted, fraction));
        println!("{name}, run {}: p10 {p10:.2}, p50 {p50:.2}, p90 {p90:.2}, p99 {p99:.2} ms a frame", number + 1);
        all.extend(sorted);
    }
    all.sort_by(f64::total_cmp);
    at(&all, 0.5)
}

fn main() {
    let mut ours = ours();
    let mut theirs = all_samples();
    if ratio::alone() {
        ratio::report(
            "plots_every_sample",
            || {
                ours();
            },
            || {
                theirs();
            },
        );
        return;
    }
    println!("12 traces of {SECONDS:.0} s at {RATE_HZ:.0} Hz, {RUNS} runs");
    let (ours_ms, theirs_ms) =
        (report("this panel", &runs(FRAMES, ours)), report("every sample", &runs(FRAMES / 4, theirs)));
    println!("medians: this panel {ours_ms:.2} ms, every sample {theirs_ms:.2} ms, ratio {:.1}", theirs_ms / ours_ms);
}
