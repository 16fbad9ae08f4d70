//! `nima check rig`: the ready check without a screen.
//!
//! The list is the same as in the console. The simulated technician of an emulated rig, or the simulated person of a scene,
//! follows the instructions at the arms; stop and releases go to the loop as in the console. A real rig is checked in the
//! console, where a person presses its stop.

use std::{
    thread,
    time::{Duration, Instant},
};

use anyhow::bail;
use clap::Args;
use nima_machine::{
    config::RigConfig,
    messages::{Command, Tick},
    ready::{PersonRequest, ReadyEntry, ReadyState},
    rig::{Roster, SIDES},
    runtime::LoopHandle,
};
use nima_recording::store::Store;
use nima_report::output;
use nima_screen::stderr::print_line;
use nima_simulation::{SimulationPlan, scene::Scene, screen::Screen};
use nima_wizards::{
    active_calibrations::ActiveCalibrations,
    ready::{ReadyRun, record, subject},
};
use nima_words::report_text::{ask_text, cause_text, check_name, figure_text, lacks_text, sentence};

use crate::{command::rig_args::Setup, console::reader::ScreenReader, emulators::Emulators, shutdown::Leave};

/// Timeout for the serial numbers of the force sensors.
const SENSORS_WITHIN: Duration = Duration::from_secs(15);
/// Response time of the simulated person at the screen.
const ANSWERS_AFTER: Duration = Duration::from_millis(300);
/// Scene of a simulated rig with a simulated person at the arm; emulated arms have one in every scene.
const SIMULATED: &str = "correspondence";

#[derive(Debug, Args)]
pub(in crate::command) struct CheckRigArguments {
    /// Rig: built-in name or TOML file; must be emulated or simulated
    #[arg(long, value_name = "RIG", default_value = "emulated")]
    rig: String,
    /// Scene: built-in name or TOML file (default: one with a simulated person at the arm)
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
    /// Name of the person who checks, stored in the record
    #[arg(long, value_name = "NAME", default_value = "nima check rig")]
    by: String,
    /// Print the record (JSON) instead of one line per check
    #[arg(long)]
    json: bool,
}

pub(in crate::command) fn run(arguments: &CheckRigArguments) -> anyhow::Result<()> {
    let rig = RigConfig::load(&arguments.rig)?;
    let guided = if rig.devices.is_some() { Scene::default_for(&rig) } else { SIMULATED };
    let scene_name = arguments.scene.as_deref().unwrap_or(guided);
    let scene = Scene::load(scene_name)?.mounted_at(&rig)?;
    if !rig.is_harmless() {
        bail!(
            "rig \"{}\" has real devices, so a person must press Stop during the check; run it in `nima console`",
            rig.name
        );
    }
    let leave = Setup::of(&arguments.rig, Some(scene_name)).leave()?;
    let emulators = Emulators::start(&arguments.rig, scene_name, rig.devices.as_ref())?;
    let mut active = ActiveCalibrations::load(None, &rig, &scene);
    let calibrations = active.calibrations(&rig);
    let rig = active.with_checked(rig);
    let plan = SimulationPlan { rig, scene, calibrations, engage: false };
    let handle = nima_simulation::start(&plan)?;
    let ender = handle.ender();
    leave.at_once(move || ender.end());
    let reader = emulators.as_ref().map(Emulators::technician);
    let mut bench = CheckBench { plan, handle, active, reader, read: None, ticks: [None; SIDES], leave };
    bench.await_sensors()?;
    let roster = bench.handle.roster().clone();
    let mut run = ReadyRun::new(subject(&arguments.rig, &bench.plan.rig, &bench.plan.scene, &roster, &bench.active));
    bench.go_through(&mut run, arguments.json)?;
    end(&run, arguments, &roster)
}

/// Saves and prints the record; returns an error if the rig is not ready.
fn end(run: &ReadyRun, arguments: &CheckRigArguments, roster: &Roster) -> anyhow::Result<()> {
    let record = record(&run.session, &arguments.rig, &arguments.by, roster);
    let path = Store::of_user()?.save_check(&record)?;
    if arguments.json {
        output::json(&record)?;
    }
    print_line(format_args!("{:.0} s; record saved in {}", record.took_s, path.display()));
    if record.passed {
        return Ok(());
    }
    let failed = run.session.list().iter().filter(|entry| matches!(entry.state, ReadyState::Failed(_)));
    let names: Vec<_> = failed.map(|entry| check_name(entry.check)).collect();
    bail!("the rig is not ready: {}; see {} for causes and remedies", names.join(", "), path.display())
}

fn line(entry: &ReadyEntry, roster: &Roster) -> String {
    let name = check_name(entry.check);
    match &entry.state {
        ReadyState::Waiting | ReadyState::Asking(_) => name,
        ReadyState::Passed(figure) => format!("{name}: passed ({})", figure_text(figure)),
        ReadyState::Failed(cause) => {
            let [cause, cure] = cause_text(cause, roster);
            format!("{name}: FAILED. {}. {}", sentence(&cause), sentence(&cure))
        }
        ReadyState::LeftOut(lacks) => format!("{name}: skipped, {}", lacks_text(*lacks)),
    }
}

struct CheckBench {
    plan: SimulationPlan,
    handle: LoopHandle,
    active: ActiveCalibrations,
    reader: Option<ScreenReader>,
    read: Option<Screen>,
    ticks: [Option<Tick>; SIDES],
    leave: Leave,
}

impl CheckBench {
    fn may_go_on(&self) -> anyhow::Result<()> {
        if self.leave.is_asked() {
            bail!("ended on request; no record was saved");
        }
        if !self.handle.is_running() {
            bail!("the loop has ended; no record was saved");
        }
        thread::sleep(Duration::from_millis(2));
        Ok(())
    }

    /// Waits until the active calibrations are known.
    fn await_sensors(&mut self) -> anyhow::Result<()> {
        let began = Instant::now();
        while self.active.is_waiting() && began.elapsed() < SENSORS_WITHIN {
            self.may_go_on()?;
            self.handle.drain_ticks(|_| {});
            self.active.meet(&self.handle, &self.plan.rig);
        }
        Ok(())
    }

    fn go_through(&mut self, run: &mut ReadyRun, quiet: bool) -> anyhow::Result<()> {
        let mut report = 0;
        let mut asked = (PersonRequest::Nothing, Instant::now());
        while !run.session.is_finished() {
            self.may_go_on()?;
            self.look(run);
            let ask = run.session.ask();
            if ask != asked.0 {
                asked = (ask, Instant::now());
                if ask != PersonRequest::Nothing {
                    print_line(ask_text(&ask));
                }
            } else if asked.1.elapsed() >= ANSWERS_AFTER
                && let Some(answer) = run.answer()
            {
                self.handle.send(answer);
                asked.1 = Instant::now();
            }
            let list = run.session.list();
            while let Some(entry) =
                list.get(report).filter(|entry| !matches!(entry.state, ReadyState::Waiting | ReadyState::Asking(_)))
            {
                if !quiet {
                    output::line(&line(entry, self.handle.roster()))?;
                }
                report += 1;
            }
        }
        Ok(())
    }

    /// Receives the data of the loop, and shows the instruction at the arms.
    fn look(&mut self, run: &mut ReadyRun) {
        self.handle.drain_ticks(|tick| {
            run.session.tick(tick);
            self.ticks[tick.side.index()] = Some(*tick);
        });
        self.handle.drain_events(|event| run.session.event(event));
        self.handle.gauges().for_each(|gauges| run.session.gauges(&gauges));
        if let Some(healths) = self.handle.healths() {
            run.session.healths(&healths);
        }
        self.active.meet(&self.handle, &self.plan.rig);
        let command: Option<Command> = run.look();
        let prompts = self.ticks.iter().flatten().filter_map(|tick| run.prompt_for(tick));
        for command in command.into_iter().chain(prompts) {
            self.handle.send(command);
        }
        if let Some(reader) = &self.reader {
            reader.show(run.screen(), &mut self.read);
        }
    }
}
