//! `nima run`: the loop without a window, with a live status line and results at the end.

mod engaging;
mod record;
mod status;
mod text;

use std::{
    path::PathBuf,
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_calibrations::active_calibrations::ActiveCalibrations;
use nima_core::{calibration::gravity::GravityDrift, impedance::Mode};
use nima_endoscope::FrameQueue;
use nima_machine::{
    config::{RigConfig, SchedulingClass},
    messages::{Command, Tick},
    rig::RigEnds,
    runtime::{self, Assembly, ClockProfile, RuntimeSummary, Tap, VirtualClock},
};
use nima_recording::store::WristId;
use nima_report::output;
use nima_screen::{
    link::{LineConnection, RemoteLine},
    objects::OfSimulation,
    stderr::print_line,
};
use nima_session::sinks::Destination;
use nima_simulation::{ObjectFeed, SimulationPlan, scene::Scene};
use nima_words::report_text::{Remedy as _, drift as drift_text};
use serde::Serialize;
use serde_json::Value;

use self::{
    engaging::RunEngagement,
    record::{RecordingFigures, RunRecording},
    status::{StatusLine, Troubles},
    text::as_text,
};
use super::{remote_follower::ToFollower, rig_args::Setup, run_outcome::Reasons};
use crate::{
    by_itself::{self, ArmLocation, Starter},
    emulators::Emulators,
    extras::{self, Extra},
    ground_truth::{self, TruthComparison},
    scoring::RunScorer,
    shutdown::Leave,
    watching::WatchArguments,
};

/// Reports of the true tip forces per second.
const TRUTH_HZ: u32 = 200;

#[derive(Debug, Default, Args)]
#[expect(clippy::struct_excessive_bools, reason = "switches of a command")]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) setup: Setup,
    /// Seconds to run (default: until Ctrl-C; 60 with --virtual)
    #[arg(long, value_name = "S", value_parser = positive_seconds, allow_negative_numbers = true)]
    pub(crate) seconds: Option<f64>,
    /// Rendering mode: anchored, matched, best, nima, dfr, linear, literal, or a baseline: `model_mediated`, waves, passivity,
    /// kalman, autoregressive, increments (default: the rig's)
    #[arg(long)]
    pub(crate) mode: Option<Mode>,
    /// One-way delay of the link in ms (default: the rig's)
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    pub(crate) delay_ms: Option<f64>,
    /// Let the force on each axis depend on the motion of all axes (matched and best; slower)
    #[arg(long)]
    pub(crate) cross_talk: bool,
    /// Compute every mode and compare their errors (default: only the rendered mode and delayed reflection)
    #[arg(long)]
    pub(crate) compare: bool,
    /// Run on a virtual clock, as fast as possible
    #[arg(long = "virtual", conflicts_with_all = ["live", "share", "igtl", "lsl", "follower"])]
    pub(crate) virtual_clock: bool,
    #[command(flatten)]
    pub(crate) late: Late,
    /// Scheduling class to request for the loop: ordinary, fifo or deadline (default: the rig's)
    #[arg(long, value_name = "CLASS")]
    pub(crate) scheduling: Option<SchedulingClass>,
    /// Record the session into a new file, which `nima replay` can reproduce bit by bit
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) record: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) watching: WatchArguments,
    #[command(flatten)]
    pub(crate) network: ToFollower,
    /// Print the results as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Default, Args)]
pub(crate) struct Late {
    /// Wake-up times of the virtual clock: perfect, quiet or busy (recorded on such a computer), late-PERCENT (this
    /// percentage of ticks is 0.5 to 4 ms late), stall-MS (a pause about once per second)
    #[arg(long, value_name = "NAME", default_value_t, requires = "virtual_clock")]
    clock: ClockProfile,
    /// Random seed for the times of late ticks
    #[arg(long, value_name = "N", default_value_t = 1, requires = "clock")]
    clock_seed: u64,
}

impl RunArguments {
    /// Returns the virtual clock; `None` for the real clock.
    fn virtual_clock(&self) -> Option<VirtualClock> {
        let Late { clock: profile, clock_seed: seed } = self.late;
        self.virtual_clock.then_some(VirtualClock { profile, seed })
    }
}

/// Longest run, s: almost four months.
const SECONDS_MAX: f64 = 1e7;

/// Returns a number of seconds above zero.
pub fn positive_seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= SECONDS_MAX => Ok(seconds),
        Ok(seconds) if seconds > SECONDS_MAX => Err(format!("enter at most {SECONDS_MAX} seconds")),
        _ => Err("enter a number of seconds above 0".to_owned()),
    }
}

pub(super) fn run(arguments: &RunArguments) -> anyhow::Result<()> {
    run_with(arguments, |rig, scene| arguments.network.open(rig, scene))
}

/// Like [`run`], with the link that `open` returns; `open` reduces the rig to the parts at this machine.
pub(crate) fn run_with(
    arguments: &RunArguments,
    open: impl FnOnce(&mut RigConfig, &Scene) -> anyhow::Result<Option<Box<dyn RemoteLine>>>,
) -> anyhow::Result<()> {
    let (mut rig, scene) = arguments.setup.load()?;
    rig.mode = arguments.mode.unwrap_or(rig.mode);
    rig.delay_s = arguments.delay_ms.map_or(rig.delay_s, |delay_ms| delay_ms * 1e-3);
    rig.identification.cross_talk |= arguments.cross_talk;
    rig.identification.compare |= arguments.compare;
    rig.scheduling = arguments.scheduling.unwrap_or(rig.scheduling);
    rig.validate()?;
    if arguments.virtual_clock && !rig.has_simulated_hand() {
        bail!("rig \"{}\" has devices, which need the real clock: omit --virtual", rig.name);
    }
    let line = open(&mut rig, &scene)?;
    let here = line.as_ref().map_or(RigEnds::Both, |line| line.here());
    let leave = arguments.setup.leave()?;
    // The follower runs the emulators of the whole rig.
    let emulated = rig.devices.as_ref().filter(|_| here.have_follower());
    let emulators = Emulators::start(arguments.setup.rig(), arguments.setup.scene(), emulated)?;
    if let Some(emulators) = &emulators {
        emulators.print_truth(TRUTH_HZ);
    }
    let mut active = ActiveCalibrations::load(None, &rig, &scene);
    let calibrations = active.calibrations(&rig);
    // With a calibrated wrist sensor, check the bias before the tool may touch anything.
    let arm = arguments.network.arm();
    if arm == ArmLocation::Elsewhere {
        print_line(
            "the arm on another machine may be real, so it stays idle: engage it in `nima console --follower \
             HOST`",
        );
    }
    let by_itself = by_itself::engages(Starter::Run, arguments.setup.rig(), &rig, arm);
    let by_itself = by_itself && here.have_leader();
    let engage = by_itself && active.drift().is_none() && !active.is_waiting();
    let rig = active.with_checked(rig);
    let plan = SimulationPlan { rig, scene, calibrations, engage };
    let mut start = RunStart {
        active,
        engaging: RunEngagement::left_to_others(plan.engage || !by_itself),
        reasons: Reasons::default(),
        emulators,
        comparison: extras::part(Extra::comparison),
        lacking: None,
        line: line.as_ref().map(|line| line.door()),
        scorer: None,
    };
    if !plan.may_engage() {
        bail!(
            "scene \"{}\" cannot be engaged: the force at the instrument's tip is unknown; calibrate with `nima console \
             --calibrate gravity`",
            plan.scene.name
        );
    }
    let servers = arguments.watching.start()?;
    let reel = FrameQueue::default();
    let to = Destination { file: arguments.record.as_deref(), audiences: servers.audiences(&plan, &reel) };
    let images = (&reel, servers.show_images());
    let (tap, mut recording) = RunRecording::begin(to, &plan, arguments.virtual_clock(), arguments.seconds, images)?;
    let mut summary = if let Some(clock) = arguments.virtual_clock() {
        let (assembly, watched) = plan.watched()?;
        start.watch_objects(&plan, watched, &recording)?;
        runtime::run_virtual_on(clock, Assembly { tap, ..assembly }, arguments.seconds.unwrap_or(60.0), |tick| {
            let command = start.watch(tick);
            if leave.is_asked() || recording.is_over() { Some(Command::Shutdown) } else { command }
        })
    } else {
        on_the_real_clock(&plan, (tap, line), &mut start, &mut recording, &leave, arguments)?
    };
    let recorded = recording.end();
    drop(start.emulators.take());
    summary.explain(|fault| [fault.cause(), fault.cure()]);
    let drift = start.active.drift();
    let score = start.scorer.take().and_then(RunScorer::end);
    if arguments.json {
        if let Some(drift @ GravityDrift::Moved { .. }) = drift {
            print_line(format_args!("warning: the bias of the wrist sensor has {}", drift_text(drift)));
        }
        output::json(&RunReport {
            summary: &summary,
            tip_error: start.comparison.as_ref().map(|comparison| comparison.figures()).unwrap_or_default(),
            recorded: recorded.as_ref().ok().and_then(Option::as_ref),
            link: start.line.as_ref().and_then(|line| line.figures()),
            score,
        })?;
    } else {
        let bias = drift.map_or_else(String::new, |drift| format!("\nbias of the wrist sensor: {}", drift_text(drift)));
        let kept = recorded.as_ref().ok().and_then(Option::as_ref).map_or_else(String::new, RecordingFigures::as_text);
        let rows = start.line.as_ref().map(|line| line.rows()).unwrap_or_default();
        let link = rows.iter().fold(String::new(), |all, [name, value]| all + "\n" + name + ": " + value);
        let tip_error = start.comparison.as_ref().map_or_else(String::new, |comparison| comparison.as_text());
        let is_measured = start.line.as_ref().is_some_and(|line| line.has_reported());
        output::line(&(as_text(&plan, &summary, is_measured) + &tip_error + &bias + &link + &kept))?;
    }
    recorded?;
    // Without its calibrations, an emulated rig runs as far as it can, which is not what the command was to do.
    if let Some(wrist) = start.active.uncalibrated().filter(|_| by_itself) {
        let rig = arguments.setup.rig();
        bail!(
            "no arm was engaged: wrist sensor {} with tool \"{}\" has no gravity calibration; calibrate with `nima calibrate rig --rig {rig}`",
            wrist.serial_number,
            wrist.tool
        );
    }
    let link = start.line.as_ref().and_then(|line| line.trouble());
    start.reasons.of(&summary, by_itself, link.as_ref()).map_or(Ok(()), |why| Err(anyhow::anyhow!(why)))
}

/// Results of a run; ground truth only from emulated rigs.
#[derive(Serialize)]
struct RunReport<'a> {
    #[serde(flatten)]
    summary: &'a RuntimeSummary,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    tip_error: Vec<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    recorded: Option<&'a RecordingFigures>,
    #[serde(skip_serializing_if = "Option::is_none")]
    link: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    score: Option<Value>,
}

/// Engages after the check of the wrist sensor's bias, whatever its result.
struct RunStart {
    active: ActiveCalibrations,
    engaging: RunEngagement,
    reasons: Reasons,
    emulators: Option<Emulators>,
    /// Compares forces with the true forces, in a build with emulators.
    comparison: Option<Box<dyn TruthComparison>>,
    /// The missing calibration that was last reported.
    lacking: Option<String>,
    /// Link to the machine with the other half of the rig.
    line: Option<Box<dyn LineConnection>>,
    /// Only in a scene with a task.
    scorer: Option<Box<dyn RunScorer>>,
}

impl RunStart {
    /// Passes the scene's objects to the recording, and to the score if there is a task.
    fn watch_objects(
        &mut self,
        plan: &SimulationPlan,
        mut watched: Option<ObjectFeed>,
        recording: &RunRecording,
    ) -> anyhow::Result<()> {
        if let Some(watched) = watched.as_mut().and_then(ObjectFeed::another) {
            recording.watch(OfSimulation::source(plan, watched));
        }
        self.scorer = extras::part(|extra| extra.scorer(plan, &mut watched)).transpose()?;
        Ok(())
    }

    fn watch(&mut self, tick: &Tick) -> Option<Command> {
        self.scorer.iter_mut().for_each(|scorer| scorer.tick(tick));
        self.active.watch(tick);
        self.reasons.watch(tick);
        let known = !self.active.is_waiting() && self.active.uncalibrated().is_none();
        let ready = known && self.active.drift() != Some(GravityDrift::Waiting);
        self.engaging.asks(ready, tick.t_s).then_some(Command::Engage)
    }

    /// Compares the tip forces with the true forces, if known.
    fn compare(&mut self) {
        if let (Some(emulators), Some(comparison)) = (&self.emulators, &mut self.comparison) {
            comparison.receive(&mut emulators.report());
        }
    }

    /// Returns the missing calibration of an emulated rig with its remedy, if it has not been reported yet.
    fn newly_lacking(&mut self, rig: &str) -> Option<String> {
        self.emulators.as_ref().filter(|_| !self.active.is_waiting())?;
        let lacking = self.active.lacking();
        let of = |(wrist, lacks): &(&WristId, Vec<&str>)| {
            format!("sensor {} with \"{}\": {}", wrist.serial_number, wrist.tool, lacks.join(", ").to_lowercase())
        };
        let words = lacking.iter().map(of).collect::<Vec<_>>().join("; ");
        let effect = match self.active.uncalibrated() {
            Some(_) => "the arms stay idle",
            None => "the force contains the trocar's friction",
        };
        let report = format!("not calibrated ({effect}): {words}; calibrate with `nima calibrate rig --rig {rig}`");
        let report = Some(report).filter(|_| !words.is_empty());
        // Also report unusable files, and sensors or tools at the wrong place.
        let report = report.into_iter().chain(self.active.report()).collect::<Vec<_>>().join(". ");
        let is_new = !report.is_empty() && self.lacking.as_ref() != Some(&report);
        is_new.then(|| self.lacking.insert(report).clone())
    }
}

fn on_the_real_clock(
    plan: &SimulationPlan,
    (tap, line): (Option<Tap>, Option<Box<dyn RemoteLine>>),
    start: &mut RunStart,
    recording: &mut RunRecording,
    leave: &Leave,
    arguments: &RunArguments,
) -> anyhow::Result<RuntimeSummary> {
    let (assembly, watched) = plan.watched_assembly()?;
    start.watch_objects(plan, watched, recording)?;
    let assembly = Assembly { tap, ..assembly };
    let handle = runtime::start(match line {
        Some(line) => line.join(assembly),
        None => assembly,
    })?;
    let ender = handle.ender();
    leave.at_once(move || ender.end());
    let mut status = StatusLine::new(!arguments.json);
    let mut troubles = Troubles::default();
    let end = arguments.seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    while handle.is_running() && !leave.is_asked() && end.is_none_or(|end| Instant::now() < end) {
        let rest = end.map_or(Duration::MAX, |end| end.saturating_duration_since(Instant::now()));
        thread::sleep(rest.min(Duration::from_millis(50)));
        let mut newest = None;
        let mut command = None;
        let seen_s = ground_truth::now_s();
        handle.drain_ticks(|tick| {
            newest = Some(*tick);
            if let Some(comparison) = &mut start.comparison {
                comparison.tick(tick, seen_s);
            }
            command = start.watch(tick).or(command);
        });
        handle.drain_events(|event| {
            start.engaging.receives(event);
            if let Some(words) = start.reasons.take(event) {
                status.notify(&words);
            }
        });
        for words in recording.news() {
            status.notify(&words);
        }
        if let Some(words) = start.line.as_mut().and_then(|line| line.receive()) {
            status.notify(&words);
        }
        troubles.look(&handle, &status);
        start.active.meet(&handle, &plan.rig);
        start.compare();
        if let Some(lacking) = start.newly_lacking(arguments.setup.rig()) {
            print_line(lacking);
        }
        if let Some(wrist) = start.active.uncalibrated().filter(|_| start.emulators.is_none()) {
            bail!(
                "the loop cannot be engaged: wrist sensor {} with tool \"{}\" has no gravity calibration; \
                 calibrate with `nima console --calibrate gravity`",
                wrist.serial_number,
                wrist.tool
            );
        }
        // The command queue is empty here, so it has room for this command.
        command.map(|command| handle.send(command));
        if let Some(tick) = newest {
            status.show(&tick, troubles.first().as_deref());
        }
    }
    status.end();
    let summary = handle
        .stop_and_join()
        .context("the real-time thread ended unexpectedly: its results are lost; run the command again")?;
    if leave.is_asked() {
        print_line("nima: ended on request: force and drives are off");
    }
    Ok(summary)
}
