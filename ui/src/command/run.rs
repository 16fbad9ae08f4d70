//! `nima run`: the loop without a window, with a live status line and figures at the end.

use std::{
    io::{self, IsTerminal as _, Write as _},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_core::{calibration::gravity::Drift, impedance::Mode, statistics::Quantiles};
use nima_devices::{Health, Standing, Trouble};
use nima_machine::{
    config::SchedulingClass,
    messages::{Command, LoopState, Tick},
    runtime::{ArmEnd, CauseAndCure, DeviceFigures, Handle, Summary},
};
use nima_recording::store::WristId;
use nima_world::{Plan, emulated::TipError};
use serde::Serialize;

use super::{
    ending::Reasons,
    output,
    setup::Setup,
    truth::{self, Comparison},
};
use crate::{
    console::in_force::InForce,
    emulators::Emulators,
    leaving::Leave,
    telling::tell,
    words::{self, Remedy as _},
};

/// True forces at the tips that emulators tell in a second.
const TRUTH_HZ: u32 = 200;

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "switches of a command")]
pub(super) struct Arguments {
    #[command(flatten)]
    setup: Setup,
    /// Seconds to run (default: until Ctrl-C; 60 with --virtual)
    #[arg(long, value_name = "S", value_parser = positive_seconds, allow_negative_numbers = true)]
    seconds: Option<f64>,
    /// Rendering mode: anchored, matched, best, nima, dfr, linear, literal, or a baseline: `model_mediated`, waves, passivity,
    /// kalman, autoregressive (default: the rig's)
    #[arg(long)]
    mode: Option<Mode>,
    /// One-way delay of the link in ms (default: the rig's)
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    delay_ms: Option<f64>,
    /// Let the force on each axis depend on the motion of all axes (matched and best; slower)
    #[arg(long)]
    cross_talk: bool,
    /// Compute every mode and compare their errors (default: only the mode that is rendered, beside delayed reflection)
    #[arg(long)]
    compare: bool,
    /// Run on a virtual clock, as fast as this computer can
    #[arg(long = "virtual")]
    virtual_clock: bool,
    /// Scheduling class to request for the loop: ordinary, fifo or deadline (default: the rig's)
    #[arg(long, value_name = "CLASS")]
    scheduling: Option<SchedulingClass>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

/// A finite number of seconds above zero.
pub(super) fn positive_seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= 1e7 => Ok(seconds),
        _ => Err("give a number of seconds above 0".to_owned()),
    }
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (mut rig, scene) = arguments.setup.load()?;
    rig.mode = arguments.mode.unwrap_or(rig.mode);
    rig.delay_s = arguments.delay_ms.map_or(rig.delay_s, |delay_ms| delay_ms * 1e-3);
    rig.identification.cross_talk |= arguments.cross_talk;
    rig.identification.compare |= arguments.compare;
    rig.scheduling = arguments.scheduling.unwrap_or(rig.scheduling);
    rig.validate()?;
    if arguments.virtual_clock && rig.devices.is_some() {
        bail!("rig \"{}\" has devices, which need the real clock: remove --virtual", rig.name);
    }
    let leave = arguments.setup.leave()?;
    let emulators = Emulators::start(arguments.setup.rig(), arguments.setup.scene(), rig.devices.as_ref())?;
    if let Some(emulators) = &emulators {
        emulators.tell_truth(TRUTH_HZ);
    }
    let mut in_force = InForce::load(None, &rig, &scene);
    let calibrations = in_force.calibrations(&rig);
    // With a calibrated wrist sensor the bias is checked before the tool may touch anything. Only rigs that cannot hurt
    // anybody engage automatically.
    let by_itself = rig.devices.as_ref().is_none_or(|devices| devices.emulated);
    let engage = by_itself && in_force.drift().is_none() && !in_force.is_waiting();
    let plan = Plan { rig, scene, calibrations, engage };
    let mut start = Start {
        in_force,
        engaged: plan.engage || !by_itself,
        reasons: Reasons::default(),
        emulators,
        comparison: Comparison::default(),
        lacking: None,
    };
    if !plan.may_engage() {
        bail!(
            "scene \"{}\" cannot be engaged: the force at its tip is not known; calibrate with `nima console --calibrate gravity`",
            plan.scene.name
        );
    }
    let mut summary = if arguments.virtual_clock {
        nima_world::run_virtual(&plan, arguments.seconds.unwrap_or(60.0), |tick| {
            let command = start.watch(tick);
            if leave.is_asked() { Some(Command::Shutdown) } else { command }
        })?
    } else {
        on_the_real_clock(&plan, &mut start, &leave, arguments)?
    };
    drop(start.emulators.take());
    let tip_error = start.comparison.figures();
    summary.explain(|fault| [fault.cause(), fault.cure()]);
    let drift = start.in_force.drift();
    if arguments.json {
        if let Some(drift @ Drift::Moved { .. }) = drift {
            tell(format_args!("warning: the bias of the wrist sensor has {}", words::drift(drift)));
        }
        output::json(&Told { summary: &summary, tip_error })?;
    } else {
        let bias =
            drift.map_or_else(String::new, |drift| format!("\nbias of the wrist sensor: {}", words::drift(drift)));
        output::line(&(in_words(&plan, &summary) + &truth::in_words(&tip_error) + &bias))?;
    }
    // Without its calibrations an emulated rig does what it can, and has said what it lacks.
    let was_to_engage = by_itself && start.in_force.uncalibrated().is_none();
    start.reasons.of(&summary, was_to_engage).map_or(Ok(()), |why| Err(anyhow::anyhow!(why)))
}

/// The figures of a run; the truth only where the rig knows it.
#[derive(Serialize)]
struct Told<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    tip_error: Vec<TipError>,
}

/// Engages after the bias of the wrist sensor has been checked, whatever the result.
struct Start {
    in_force: InForce,
    engaged: bool,
    reasons: Reasons,
    emulators: Option<Emulators>,
    comparison: Comparison,
    /// What was told to be missing.
    lacking: Option<String>,
}

impl Start {
    fn watch(&mut self, tick: &Tick) -> Option<Command> {
        self.in_force.watch(tick);
        self.reasons.watch(tick);
        let known = !self.in_force.is_waiting() && self.in_force.uncalibrated().is_none();
        let go = !self.engaged && known && self.in_force.drift() != Some(Drift::Waiting);
        self.engaged |= go;
        go.then_some(Command::Engage)
    }

    /// Compares the forces at the tips with the true ones, where they are known.
    fn compare(&mut self) {
        if let Some(emulators) = &self.emulators {
            self.comparison.know(emulators.known());
        }
    }

    /// What is missing on an emulated rig, with its cure, if it has not been told yet.
    fn newly_lacking(&mut self, rig: &str) -> Option<String> {
        self.emulators.as_ref().filter(|_| !self.in_force.is_waiting())?;
        let lacking = self.in_force.lacking();
        let of = |(wrist, lacks): &(&WristId, Vec<&str>)| {
            format!("sensor {} with \"{}\": {}", wrist.serial_number, wrist.tool, lacks.join(", ").to_lowercase())
        };
        let words = lacking.iter().map(of).collect::<Vec<_>>().join("; ");
        let effect = match self.in_force.uncalibrated() {
            Some(_) => "the arms stay idle",
            None => "the force contains the trocar's friction",
        };
        let told = format!("not calibrated ({effect}): {words}; calibrate with `nima calibrate rig --rig {rig}`");
        // A sensor or tool in another's place.
        let told = std::iter::once(told).chain(self.in_force.told()).collect::<Vec<_>>().join(". ");
        let is_new = !words.is_empty() && self.lacking.as_ref() != Some(&told);
        is_new.then(|| self.lacking.insert(told).clone())
    }
}

fn on_the_real_clock(plan: &Plan, start: &mut Start, leave: &Leave, arguments: &Arguments) -> anyhow::Result<Summary> {
    let handle = nima_world::start(plan)?;
    let ender = handle.ender();
    leave.at_once(move || ender.end());
    let mut status = StatusLine::new(!arguments.json);
    let mut troubles = Troubles::default();
    let end = arguments.seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    while handle.is_running() && !leave.is_asked() && end.is_none_or(|end| Instant::now() < end) {
        let rest = end.map_or(Duration::MAX, |end| end.saturating_duration_since(Instant::now()));
        thread::sleep(rest.min(Duration::from_millis(50)));
        let (mut newest, mut command) = (None, None);
        let seen_s = truth::now_s();
        handle.drain_ticks(|tick| {
            newest = Some(*tick);
            start.comparison.tick(tick, seen_s);
            command = start.watch(tick).or(command);
        });
        handle.drain_events(|event| {
            if let Some(words) = start.reasons.take(event) {
                status.tell(&words);
            }
        });
        troubles.look(&handle, &status);
        start.in_force.meet(&handle, &plan.rig);
        start.compare();
        if let Some(lacking) = start.newly_lacking(arguments.setup.rig()) {
            tell(lacking);
        }
        if let Some(wrist) = start.in_force.uncalibrated().filter(|_| start.emulators.is_none()) {
            bail!(
                "the loop cannot be engaged: wrist sensor {} with tool \"{}\" has no gravity calibration; \
                 calibrate with `nima console --calibrate gravity`",
                wrist.serial_number,
                wrist.tool
            );
        }
        // The queue of commands is empty here, so it has room for this one.
        command.map(|command| handle.send(command));
        if let Some(tick) = newest {
            status.show(&tick, troubles.first().as_deref());
        }
    }
    status.end();
    let summary = handle.stop_and_join().context("the real-time thread ended unexpectedly; its results are lost")?;
    if leave.is_asked() {
        tell("nima: ended as asked: force and drives are off");
    }
    Ok(summary)
}

/// Reports why a device cannot be opened, once per cause.
#[derive(Default)]
struct Troubles {
    told: Vec<Option<Trouble>>,
    first: Option<String>,
    looked: Option<Instant>,
}

impl Troubles {
    fn look(&mut self, handle: &Handle, status: &StatusLine) {
        const LOOK_EVERY: Duration = Duration::from_millis(500);
        if self.looked.is_some_and(|looked| looked.elapsed() < LOOK_EVERY) {
            return;
        }
        self.looked = Some(Instant::now());
        self.told.resize(handle.roster().len(), None);
        self.first = None;
        for (entry, told) in handle.roster().iter().zip(&mut self.told) {
            let trouble = entry.view.report().trouble;
            if let Some(trouble) = &trouble {
                let words = format!("{}: {trouble}. {}", entry.name, trouble.cure());
                if told.as_ref() != Some(trouble) {
                    status.tell(&words);
                }
                self.first.get_or_insert(words);
            }
            *told = trouble;
        }
    }

    /// The first missing device, with cause and cure.
    fn first(&self) -> Option<String> {
        let others = self.told.iter().flatten().count().saturating_sub(1);
        let more = if others > 0 { format!(" (and {others} more)") } else { String::new() };
        self.first.as_ref().map(|first| format!("{first}{more}"))
    }
}

/// A status line on stderr that is rewritten in place; one line per second if stderr is not a terminal.
struct StatusLine {
    wanted: bool,
    terminal: bool,
    last: Option<Instant>,
}

impl StatusLine {
    fn new(wanted: bool) -> Self {
        Self { wanted, terminal: io::stderr().is_terminal(), last: None }
    }

    /// Shows the present state; `missing` is the device that the loop is waiting for.
    fn show(&mut self, tick: &Tick, missing: Option<&str>) {
        let pause = Duration::from_millis(if self.terminal { 100 } else { 1000 });
        if !self.wanted || self.last.is_some_and(|last| last.elapsed() < pause) {
            return;
        }
        self.last = Some(Instant::now());
        if let (LoopState::Disconnected, Some(missing)) = (tick.state, missing) {
            return self.write(&format!("{:8.1} s  {}: {missing}", tick.t_s, tick.state.word()));
        }
        let text = format!(
            "{:8.1} s  {:8}  {:8}  measured {:5.2} N  rendered {:5.2} N  degree {}  missed {}",
            tick.t_s,
            tick.state.word(),
            tick.mode,
            tick.measured_n.norm(),
            tick.rendered_n.norm(),
            tick.identification.degree,
            tick.missed,
        );
        self.write(&text);
    }

    fn write(&self, text: &str) {
        let mut err = io::stderr().lock();
        // The terminal truncates a line that is too long, and clears the rest of the previous one.
        let written =
            if self.terminal { write!(err, "\r\x1b[?7l{text}\x1b[K\x1b[?7h") } else { writeln!(err, "{text}") };
        written.and_then(|()| err.flush()).ok();
    }

    /// Prints a permanent line above the status line.
    fn tell(&self, line: &str) {
        if self.wanted && self.terminal && self.last.is_some() {
            tell(format_args!("\r\x1b[K{line}"));
        } else {
            tell(line);
        }
    }

    fn end(&self) {
        if self.wanted && self.terminal && self.last.is_some() {
            tell("");
        }
    }
}

fn in_words(plan: &Plan, summary: &Summary) -> String {
    let times =
        |q: &Quantiles| format!("p50 {:7.1}   p99 {:7.1}   p99.9 {:7.1}   max {:7.1}", q.p50, q.p99, q.p999, q.max);
    let mut text = format!(
        "{} on \"{}\", {} clock: {:.1} s, {} ticks, {} missed, {:.1} times real time\n\
         link delay {:.0} ms, mode {}\n\
         wake-up us  {}\n\
         work us     {}\n\
         rig us      {}\n\
         sample to force us {}\n\
         processor   {:.1} % of a core in the loop's thread, {:.1} % in the whole program{}{}\n\
         error of each mode before the gates, against the force at the tip at the same instant:",
        plan.scene.name,
        plan.rig.name,
        summary.clock,
        summary.seconds,
        summary.ticks,
        summary.missed,
        summary.speed,
        plan.rig.delay_s * 1e3,
        plan.rig.mode,
        times(&summary.wake_us),
        times(&summary.work_us),
        times(&summary.rig_us),
        times(&summary.sample_to_force_us),
        summary.cpu.realtime * 100.0,
        summary.cpu.process * 100.0,
        devices_in_words(summary),
        ends_in_words(summary),
    );
    for error in &summary.error {
        let fields = format!(
            "\n  {:5}  {:14}  mean {:10.4} N   sd {:10.4} N   max {:10.4} N   invalid {}",
            error.side.word(),
            error.mode,
            error.mae_n,
            error.sd_n,
            error.max_n,
            error.invalid
        );
        text.push_str(&fields);
    }
    if let (Some(advice), "real") = (summary.scheduling.advice(), summary.clock) {
        text.push_str("\nnote: ");
        text.push_str(advice);
    }
    text
}

fn devices_in_words(summary: &Summary) -> String {
    summary.devices.iter().map(device_in_words).collect()
}

fn device_in_words(DeviceFigures { name, health, trouble }: &DeviceFigures) -> String {
    let standing = match health.standing {
        Standing::Connected => "connected".to_owned(),
        Standing::Opening => "never connected".to_owned(),
        Standing::Closed => "disconnected".to_owned(),
        Standing::Lost(loss) => format!("lost: {}", loss.cause()),
    };
    let Health { readings, rate_hz, lost, damaged, refused, outages, longest_outage_s, .. } = health;
    let outages = match outages {
        0 => String::new(),
        _ => format!("   outages {outages}, the longest {longest_outage_s:.1} s"),
    };
    let trouble = match trouble {
        Some(CauseAndCure { cause, cure, .. }) => format!("\n  {:14}  {cause}. {cure}", ""),
        None => String::new(),
    };
    format!(
        "\n  {name:14}  {standing:12}  {readings:8} readings   {rate_hz:7.1} Hz   lost {lost}   damaged {damaged}   refused {refused}{outages}{trouble}"
    )
}

fn ends_in_words(summary: &Summary) -> String {
    let end = |ArmEnd { side, final_state, fault, .. }: &ArmEnd| {
        let fault = fault.as_ref().map_or_else(String::new, |CauseAndCure { device, cause, .. }| {
            let device = device.as_ref().map_or_else(String::new, |device| format!(" ({device})"));
            format!(": {cause}{device}")
        });
        format!("\n{:5} arm ended: {}{fault}", side.word(), final_state.word())
    };
    summary.arms.iter().map(end).collect()
}
