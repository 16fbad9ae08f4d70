//! Measures the trade-off between computing time and accuracy on this computer, in the background, and applies a chosen
//! point.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread::{Builder, JoinHandle},
};

use egui::{Button, ProgressBar, Ui, vec2};
use nima_machine::config::RigConfig;
use nima_panels::Tile;
use nima_screen::{live::LiveState, outbox::Outbox, widgets::small};
use nima_study::tradeoff::{
    ParameterChoice, PlanMethod, SourceFigures, SweepError, SweepPoint, SweepStudy, TradeoffPlan, TradeoffSource, sweep,
};
use nima_words::{
    report_text::{mode_meaning, mode_name, three_digits},
    text::calibrations,
};

use super::{tradeoff_apply::Apply, tradeoff_plot::plot_ui};
use crate::extras::lab::text;

/// Duration of the scene on which it is measured, s.
const SCENE_S: f64 = 6.0;
const BUTTON: egui::Vec2 = vec2(120.0, 30.0);

#[derive(Debug, Default)]
pub(in crate::extras::lab) struct TradeoffPanel {
    job: Option<SweepJob>,
    measured: Option<SourceFigures>,
    selected: Option<usize>,
    message: String,
}

/// A background sweep. Dropping it asks the sweep to end.
#[derive(Debug)]
struct SweepJob {
    cancel: Arc<AtomicBool>,
    progress: Arc<[AtomicUsize; 2]>,
    thread: JoinHandle<Result<SweepStudy, SweepError>>,
}

impl SweepJob {
    fn start(live: &LiveState) -> std::io::Result<Self> {
        let plan = plan(live);
        let rate_hz = live.rig.rate_hz;
        let scene = live.scene.clone();
        let cancel = Arc::new(AtomicBool::new(false));
        let progress = Arc::new([AtomicUsize::new(0), AtomicUsize::new(1)]);
        let stop = Arc::clone(&cancel);
        let report = Arc::clone(&progress);
        // This thread has normal priority, so it does not delay the loop's thread, which has real-time priority where
        // that is granted.
        let thread = Builder::new().name("trade-off".to_owned()).spawn(move || {
            let source = TradeoffSource::from_scene(&scene, rate_hz, SCENE_S);
            sweep(&[source], &plan, &stop, |done, total| {
                report[0].store(done, Ordering::Relaxed);
                report[1].store(total, Ordering::Relaxed);
            })
        })?;
        Ok(Self { cancel, progress, thread })
    }

    fn fraction(&self) -> f32 {
        let [done, total] = [&self.progress[0], &self.progress[1]].map(|count| count.load(Ordering::Relaxed) as f32);
        done / total.max(1.0)
    }

    fn join(self) -> Option<Result<SweepStudy, SweepError>> {
        let Self { thread, .. } = self;
        thread.join().ok()
    }
}

/// Returns the plan of the measurement: the current rig, at the current delay.
pub(super) fn plan(live: &LiveState) -> TradeoffPlan {
    let mut rig = live.rig.clone();
    rig.delay_s = live.delay_s();
    TradeoffPlan::quick(rig.settings())
}

impl TradeoffPanel {
    fn notify(&mut self, message: impl Into<String>) {
        self.message = message.into();
    }

    fn take_in(&mut self) {
        let Some(job) = self.job.take_if(|job| job.thread.is_finished()) else { return };
        match job.join() {
            Some(Ok(mut study)) if !study.sources.is_empty() => {
                let figures = study.sources.swap_remove(0);
                self.selected = most_accurate(&figures);
                self.measured = Some(figures);
                self.message.clear();
            }
            Some(Err(SweepError::Cancelled)) => self.notify(text::CANCELLED.get()),
            Some(Err(error)) => self.notify(error.to_string()),
            Some(Ok(_)) | None => self.notify(text::FAILED.get()),
        }
    }
}

impl Drop for TradeoffPanel {
    fn drop(&mut self) {
        self.stop();
    }
}

impl Tile for TradeoffPanel {
    fn ui(&mut self, ui: &mut Ui, live: &LiveState, outbox: &mut Outbox) -> Option<RigConfig> {
        tradeoff_ui(ui, live, self, outbox)
    }

    fn restarted(&mut self, outcome: Result<(), String>) {
        self.notify(match outcome {
            Ok(()) => text::APPLIED_BY_RESTART.get().to_owned(),
            Err(reason) => text::not_applied(&reason),
        });
    }

    fn stop(&self) {
        if let Some(job) = &self.job {
            job.cancel.store(true, Ordering::Relaxed);
        }
    }

    fn is_measured(&self) -> bool {
        self.measured.is_some()
    }
}

/// Draws the panel. Returns a rig if the operator applies a point that the running loop cannot change to: the loop must
/// then be restarted with it.
fn tradeoff_ui(ui: &mut Ui, live: &LiveState, state: &mut TradeoffPanel, outbox: &mut Outbox) -> Option<RigConfig> {
    state.take_in();
    measure_ui(ui, live, state);
    if !state.message.is_empty() {
        ui.label(small(state.message.clone()));
    }
    let Some(figures) = &state.measured else {
        ui.label(small(text::NOT_MEASURED));
        return None;
    };
    if let Some(clicked) = plot_ui(ui, figures, state.selected) {
        state.selected = Some(clicked);
    }
    front_ui(ui, figures, &mut state.selected);
    let point = state.selected.and_then(|index| figures.points.get(index)).copied()?;
    apply_ui(ui, live, &point, state, outbox)
}

fn measure_ui(ui: &mut Ui, live: &LiveState, state: &mut TradeoffPanel) {
    let Some(job) = &state.job else {
        let meaning = text::MEASURE_HOVER.get();
        let button = Button::new(text::MEASURE).min_size(vec2(ui.available_width(), 30.0));
        if ui.add(button).on_hover_text(meaning).clicked() {
            match SweepJob::start(live) {
                Ok(job) => state.job = Some(job),
                Err(error) => state.notify(text::not_started(&error)),
            }
        }
        return;
    };
    ui.horizontal(|ui| {
        let fraction = job.fraction();
        let width = (ui.available_width() - BUTTON.x - 8.0).max(60.0);
        let bar = ui.add(ProgressBar::new(fraction).desired_width(width).text(format!("{:.0} %", 100.0 * fraction)));
        bar.widget_info(|| {
            let words = text::measured(100.0 * fraction);
            egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, words)
        });
        let cancel = ui.add(Button::new(text::CANCEL).min_size(BUTTON));
        if cancel.on_hover_text(text::CANCEL_HOVER).clicked() {
            job.cancel.store(true, Ordering::Relaxed);
        }
    });
}

/// Draws the points of the Pareto front, fastest first, each a button.
fn front_ui(ui: &mut Ui, figures: &SourceFigures, selected: &mut Option<usize>) {
    ui.label(small(text::FRONT)).on_hover_text(text::FRONT_HOVER);
    for index in front(figures) {
        let point = &figures.points[index];
        let row = Button::selectable(*selected == Some(index), format!("{}: {}", name(point), figures_of(point)));
        if ui.add(row.min_size(vec2(ui.available_width(), 24.0))).on_hover_text(words(point)).clicked() {
            *selected = Some(index);
        }
    }
}

fn apply_ui(
    ui: &mut Ui,
    live: &LiveState,
    point: &SweepPoint,
    state: &mut TradeoffPanel,
    outbox: &mut Outbox,
) -> Option<RigConfig> {
    let mode = point.choice.method.mode()?;
    let apply = Apply::of(live, mode, &point.choice);
    let restart = matches!(apply, Apply::Restart(_));
    // After a restart the loop is idle, so a restart must not be a way out of a stop or a fault.
    let closed = calibrations::closed(live.state()).filter(|_| restart);
    let size = vec2(ui.available_width(), 30.0);
    let button = ui.add_enabled(closed.is_none(), Button::new(text::APPLY).min_size(size));
    let note = if restart { text::APPLY_BY_RESTART.get() } else { text::APPLY_AT_ONCE.get() };
    ui.label(small(format!("{}. {note}", name(point))));
    let clicked = button
        .on_hover_text(format!("{}\n{}\n{note}", words(point), mode_meaning(mode)))
        .on_disabled_hover_text(closed.unwrap_or_default())
        .clicked();
    if !clicked {
        return None;
    }
    match apply {
        Apply::Restart(rig) => return Some(*rig),
        Apply::AtOnce(commands) => commands.into_iter().for_each(|command| outbox.push(command)),
    }
    state.notify(text::applied(&name(point)));
    None
}

/// Returns the indices of the Pareto front at the source's own rate, fastest first.
fn front(figures: &SourceFigures) -> Vec<usize> {
    let points = &figures.points;
    let mut front: Vec<usize> =
        (0..points.len()).filter(|&i| points[i].pareto && points[i].choice.every == 1).collect();
    front.sort_by(|&a, &b| points[a].cost_us.p50.total_cmp(&points[b].cost_us.p50));
    front
}

fn most_accurate(figures: &SourceFigures) -> Option<usize> {
    front(figures).into_iter().min_by(|&a, &b| figures.points[a].error.total_cmp(&figures.points[b].error))
}

/// Returns the name of a point: mode, degree and window, as far as they apply.
pub(super) fn name(point: &SweepPoint) -> String {
    let ParameterChoice { method, degree, window_ms, .. } = point.choice;
    match method {
        PlanMethod::Mode(mode) if mode.has_degrees() => format!("{}, N = {degree}, {window_ms:.0} ms", mode_name(mode)),
        PlanMethod::Mode(mode) if mode.has_window() => format!("{}, {window_ms:.0} ms", mode_name(mode)),
        PlanMethod::Mode(mode) => mode_name(mode).to_owned(),
        PlanMethod::Solver(solver) => solver.name().to_owned(),
    }
}

fn figures_of(point: &SweepPoint) -> String {
    format!("{} µs, {} N", three_digits(point.cost_us.p50), three_digits(point.error))
}

/// Returns the hover text of a point.
pub(super) fn words(point: &SweepPoint) -> String {
    let front = if point.pareto { text::ON_FRONT.get() } else { "" };
    let [median_us, p99_us, error_n, ratio] =
        [point.cost_us.p50, point.cost_us.p99, point.error, point.ratio].map(three_digits);
    let figures = text::point(&name(point), [&median_us, &p99_us], point.choice.delay_ms, [&error_n, &ratio]);
    figures + front
}
