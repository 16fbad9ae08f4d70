//! `nima run`: the loop without a screen, with a live status line and figures at the end.

use std::{
    io::{self, IsTerminal as _, Write as _},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima::{
    calibration::gravity::Drift,
    config::SchedulingClass,
    device::{Health, Standing, Trouble},
    impedance::Mode,
    runtime::{self, Command, DeviceFigures, Handle, Plan, Summary, Tick},
    statistics::Quantiles,
};

use super::{emulators::Emulators, output, setup::Setup};
use crate::console::in_force::InForce;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    setup: Setup,
    /// Loop time to run; without it, until Ctrl-C (real clock) or 60 s (virtual clock)
    #[arg(long, value_name = "S", value_parser = positive_seconds, allow_negative_numbers = true)]
    seconds: Option<f64>,
    /// Rendering mode: literal, linear, dfr or anchored (default: the rig's)
    #[arg(long)]
    mode: Option<Mode>,
    /// One-way delay of the link in ms (default: the rig's)
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    delay_ms: Option<f64>,
    /// Let every axis' force depend on every axis' motion (anchored mode; costs more)
    #[arg(long)]
    cross_talk: bool,
    /// Run on the virtual clock, as fast as it goes
    #[arg(long = "virtual")]
    virtual_clock: bool,
    /// What to ask of the operating system for the loop: ordinary, fifo or deadline (default: the rig's)
    #[arg(long, value_name = "CLASS")]
    scheduling: Option<SchedulingClass>,
    /// Print the figures as one JSON object
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
    rig.scheduling = arguments.scheduling.unwrap_or(rig.scheduling);
    rig.validate()?;
    if arguments.virtual_clock && rig.devices.is_some() {
        bail!("rig \"{}\" has devices, and they live on the real clock: leave --virtual out", rig.name);
    }
    let emulators = Emulators::start(&arguments.setup, rig.devices.as_ref())?;
    let mut in_force = InForce::load(None, &scene);
    let calibrations = in_force.calibrations(&rig);
    // With a calibrated wrist the bias is looked at before the tool may touch anything; and only what can hurt nobody engages by
    // itself.
    let by_itself = rig.devices.as_ref().is_none_or(|devices| devices.emulated);
    let left_calibrations = calibrations.clone();
    let engage = by_itself && in_force.drift().is_none();
    let plan = Plan { rig, scene, calibrations, left_calibrations, engage };
    let mut start = Start { in_force, engaged: plan.engage || !by_itself };
    if !plan.may_engage() {
        bail!(
            "scene \"{}\" cannot be engaged: the force at its tip is not known; calibrate with `nima console --calibrate gravity`",
            plan.scene.name
        );
    }
    let summary = if arguments.virtual_clock {
        runtime::run_virtual(&plan, arguments.seconds.unwrap_or(60.0), |tick| start.watch(tick))?
    } else {
        on_the_real_clock(&plan, &mut start, arguments.seconds, arguments.json)?
    };
    drop(emulators);
    let drift = start.in_force.drift();
    if arguments.json {
        if let Some(drift @ Drift::Moved { .. }) = drift {
            eprintln!("warning: {}", drift.words());
        }
        return output::json(&summary);
    }
    let bias = drift.map_or_else(String::new, |drift| format!("\nbias of the wrist sensor: {}", drift.words()));
    output::line(&(in_words(&plan, &summary) + &bias))
}

/// Engages once it was looked whether the bias of the wrist sensor is where it was; whatever the answer.
struct Start {
    in_force: InForce,
    engaged: bool,
}

impl Start {
    fn watch(&mut self, tick: &Tick) -> Option<Command> {
        self.in_force.watch(tick);
        let go = !self.engaged && self.in_force.drift() != Some(Drift::Waiting);
        self.engaged |= go;
        go.then_some(Command::Engage)
    }
}

fn on_the_real_clock(plan: &Plan, start: &mut Start, seconds: Option<f64>, quiet: bool) -> anyhow::Result<Summary> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("Ctrl-C cannot be caught")?;
    let handle = runtime::start(plan)?;
    let mut status = StatusLine::new(!quiet);
    let mut troubles = Troubles::default();
    let end = seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    while handle.is_running() && !interrupted.load(Ordering::Relaxed) && end.is_none_or(|end| Instant::now() < end) {
        let rest = end.map_or(Duration::MAX, |end| end.saturating_duration_since(Instant::now()));
        thread::sleep(rest.min(Duration::from_millis(50)));
        let (mut newest, mut command) = (None, None);
        handle.drain_ticks(|tick| {
            newest = Some(*tick);
            command = start.watch(tick).or(command);
        });
        troubles.tell(&handle);
        // The queue of commands holds nothing else: it takes this one.
        command.map(|command| handle.send(command));
        if let Some(tick) = newest {
            status.show(&tick);
        }
    }
    status.end();
    handle.stop_and_join().context("the real-time thread died; its figures are lost")
}

/// Tells of each device that cannot be opened why, and what to do; again only when that changes.
#[derive(Default)]
struct Troubles {
    told: Vec<Option<Trouble>>,
    looked: Option<Instant>,
}

impl Troubles {
    fn tell(&mut self, handle: &Handle) {
        const LOOK_EVERY: Duration = Duration::from_millis(500);
        if self.looked.is_some_and(|looked| looked.elapsed() < LOOK_EVERY) {
            return;
        }
        self.looked = Some(Instant::now());
        self.told.resize(handle.roster().len(), None);
        for (entry, told) in handle.roster().iter().zip(&mut self.told) {
            let trouble = entry.view.report().trouble;
            if let Some(trouble) = trouble.as_ref().filter(|trouble| told.as_ref() != Some(trouble)) {
                eprintln!("{}: {trouble}. {}", entry.name, trouble.cure());
            }
            *told = trouble;
        }
    }
}

/// One line on stderr that is rewritten in place; on a pipe one line a second.
struct StatusLine {
    wanted: bool,
    terminal: bool,
    last: Option<Instant>,
}

impl StatusLine {
    fn new(wanted: bool) -> Self {
        Self { wanted, terminal: io::stderr().is_terminal(), last: None }
    }

    fn show(&mut self, tick: &Tick) {
        let pause = Duration::from_millis(if self.terminal { 100 } else { 1000 });
        if !self.wanted || self.last.is_some_and(|last| last.elapsed() < pause) {
            return;
        }
        self.last = Some(Instant::now());
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
        let mut err = io::stderr().lock();
        let written = if self.terminal { write!(err, "\r{text}") } else { writeln!(err, "{text}") };
        written.and_then(|()| err.flush()).ok();
    }

    fn end(&self) {
        if self.wanted && self.terminal && self.last.is_some() {
            eprintln!();
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
         processor   {:.1} % of a core in the loop's thread, {:.1} % in the whole program{}\n\
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
    );
    for error in &summary.error {
        let fields = format!(
            "\n  {:5}  {:8}  mean {:10.4} N   sd {:10.4} N   max {:10.4} N   invalid {}",
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
    let mut text = String::new();
    for DeviceFigures { name, health } in &summary.devices {
        let standing = match health.standing {
            Standing::Connected => "connected".to_owned(),
            Standing::Opening => "never came".to_owned(),
            Standing::Closed => "disconnected".to_owned(),
            Standing::Lost(loss) => format!("lost: {}", loss.cause()),
        };
        let Health { readings, rate_hz, lost, damaged, refused, .. } = health;
        let line = format!(
            "\n  {name:14}  {standing:12}  {readings:8} readings   {rate_hz:7.1} Hz   lost {lost}   damaged {damaged}   refused {refused}"
        );
        text.push_str(&line);
    }
    text
}
