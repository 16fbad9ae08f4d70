//! `nima calibrate rig`: all calibrations of an emulated rig without a screen.
//!
//! The wizards and their order of steps are the same as in the console: gravity of both arms, correspondence, tip
//! force. The simulated technician at the arms follows their instructions; the wizards receive data only through the
//! drivers. The results are saved as in the console, for the sensors and tools of the rig.

use std::{
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_machine::{
    messages::{Command, LoopState, Tick},
    rig::{Prompt, Roster, SIDES, Side},
    runtime::LoopHandle,
};
use nima_recording::store::Store;
use nima_screen::stderr::print_line;
use nima_simulation::{
    SimulationPlan,
    screen::{PersonTask, Screen},
};
use nima_wizards::{Binding, SaveRequest, WizardKind, WizardOutcome, Wizards, active_calibrations::ActiveCalibrations};

use crate::{
    command::rig_args::{Setup, side},
    console::reader::{ScreenReader, task_of},
    emulators::Emulators,
    shutdown::Leave,
};

/// Timeout of a step.
const PATIENCE: Duration = Duration::from_mins(5);

#[derive(Debug, Args)]
pub(in crate::command) struct CalibrateRigArguments {
    /// Rig: built-in name or TOML file; must be emulated
    #[arg(long, value_name = "RIG", default_value = "emulated")]
    rig: String,
    /// Scene: built-in name or TOML file; must contain tissue (default: `bimanual` for a rig with two arms, else
    /// `peg_transfer`)
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
    /// Calibrate only the wrist sensor of this arm: right or left
    #[arg(long, value_name = "SIDE", value_parser = side)]
    arm: Option<Side>,
    /// Run only this calibration
    #[arg(long, value_name = "WIZARD")]
    only: Option<WizardKind>,
    /// Also run the frame calibrations: sensor mount, tip, hand-eye, table, view and trocar
    #[arg(long, conflicts_with = "only")]
    frames: bool,
}

impl CalibrateRigArguments {
    /// By default only the force calibrations: the file of an emulated rig has the right frames.
    fn does(&self, which: WizardKind) -> bool {
        let usual = self.frames || !matches!(which, WizardKind::Frame(_));
        // The simulated technician has no board.
        which != WizardKind::Camera && self.only.map_or(usual, |only| only == which)
    }
}

pub(in crate::command) fn run(arguments: &CalibrateRigArguments) -> anyhow::Result<()> {
    if arguments.only == Some(WizardKind::Camera) {
        bail!("the simulated technician has no board; calibrate the camera with `nima console --calibrate camera`");
    }
    let setup = Setup::of(&arguments.rig, arguments.scene.as_deref());
    let (rig, scene) = setup.load()?;
    let sides: Vec<_> = Side::ALL.into_iter().filter(|side| arguments.arm.is_none_or(|arm| arm == *side)).collect();
    let sides: Vec<_> = sides.into_iter().filter(|side| scene.measures_at_wrist(&rig, *side)).collect();
    if sides.is_empty() {
        bail!("rig \"{}\" has no wrist sensor on the selected arm: nothing to calibrate", rig.name);
    }
    let leave = setup.leave()?;
    let Some(emulators) = Emulators::start(setup.rig(), setup.scene(), rig.devices.as_ref())? else {
        bail!("rig \"{}\" has no simulated technician; calibrate with `nima console --calibrate gravity`", rig.name);
    };
    let active = ActiveCalibrations::load(None, &rig, &scene);
    let rig = active.with_checked(rig);
    let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: false };
    let mut bench = CalibrationBench::start(plan, arguments.rig.clone(), active, emulators.technician(), leave)?;
    for which in WizardKind::built().filter(|which| arguments.does(*which)) {
        for side in &sides {
            let began = Instant::now();
            bench.calibrate(which, *side)?;
            print_line(format_args!(
                "{} arm, {}: {:.0} s",
                side.word(),
                which.name().to_lowercase(),
                began.elapsed().as_secs_f64()
            ));
        }
    }
    super::output::line(&bench.saved.join("\n"))
}

struct CalibrationBench {
    plan: SimulationPlan,
    rig: String,
    handle: Option<LoopHandle>,
    active: ActiveCalibrations,
    reader: ScreenReader,
    read: Option<Screen>,
    wizards: Wizards,
    ticks: [Option<Tick>; SIDES],
    /// The active calibrations after the last saving, line by line.
    saved: Vec<String>,
    leave: Leave,
}

impl CalibrationBench {
    fn start(
        plan: SimulationPlan,
        rig: String,
        active: ActiveCalibrations,
        reader: ScreenReader,
        leave: Leave,
    ) -> anyhow::Result<Self> {
        let wizards = Wizards::default();
        let ticks = [None; SIDES];
        let saved = Vec::new();
        let mut this = Self { plan, rig, handle: None, active, reader, read: None, wizards, ticks, saved, leave };
        this.restart()?;
        Ok(this)
    }

    /// Ends the loop and restarts it idle, as the console does when a calibration is saved.
    fn restart(&mut self) -> anyhow::Result<()> {
        self.handle = None;
        self.active.bind(&self.plan.rig, &self.plan.scene);
        self.plan.calibrations = self.active.calibrations(&self.plan.rig);
        let handle = nima_simulation::start(&self.plan)?;
        let ender = handle.ender();
        self.leave.at_once(move || ender.end());
        self.handle = Some(handle);
        self.ticks = [None; SIDES];
        Ok(())
    }

    fn calibrate(&mut self, which: WizardKind, side: Side) -> anyhow::Result<()> {
        self.active.choose(side);
        self.wizards = Wizards::default();
        let what = format!("{} arm, {}", side.word(), which.name().to_lowercase());
        let mut shown = None;
        let mut since = Instant::now();
        let saving = loop {
            if self.leave.is_asked() {
                bail!("ended on request; the finished calibrations are saved");
            }
            self.look(side, which)?;
            let binding = self.binding();
            if binding.sensor.is_empty() {
                Self::wait(since, &what, "the wrist sensor", self.missing().as_deref())?;
                continue;
            }
            match self.wizards.attend(which, &binding).context("this build lacks the wizard")? {
                WizardOutcome::Proven(saving) => break saving,
                WizardOutcome::NotProven(reason) => bail!("{what}: not proven: {reason}"),
                WizardOutcome::Working(step, notice) => {
                    if shown != Some(step) {
                        print_line(format_args!("{what}: {}", step.to_lowercase()));
                        shown = Some(step);
                        since = Instant::now();
                    }
                    Self::wait(since, &what, step, notice.as_deref())?;
                }
            }
        };
        self.save(saving)
    }

    fn binding(&self) -> Binding {
        let none = Roster::new();
        let roster = self.handle.as_ref().map_or(&none, |handle| handle.roster());
        self.active.binding_of(&self.rig, &self.plan.rig, roster)
    }

    fn wait(since: Instant, what: &str, step: &str, notice: Option<&str>) -> anyhow::Result<()> {
        if since.elapsed() > PATIENCE {
            bail!(
                "{what}: step \"{step}\" did not finish: {}",
                notice.unwrap_or("the rig does not deliver the required data")
            );
        }
        thread::sleep(Duration::from_millis(2));
        Ok(())
    }

    /// Returns the reason why a device is missing.
    fn missing(&self) -> Option<String> {
        let roster = self.handle.as_ref()?.roster();
        roster.iter().find_map(|entry| Some(format!("{}: {}", entry.name(), entry.view.report().trouble?)))
    }

    /// Receives the data of the loop, and shows the wizard's instruction to the technician.
    fn look(&mut self, side: Side, which: WizardKind) -> anyhow::Result<()> {
        let Some(handle) = &self.handle else { bail!("the loop has ended") };
        if !handle.is_running() {
            bail!("the loop has ended");
        }
        let rate_hz = self.plan.rig.rate_hz;
        handle.drain_ticks(|tick| {
            if tick.side == side {
                self.wizards.tick(which, tick, rate_hz);
            }
            self.active.watch(tick);
            self.ticks[tick.side.index()] = Some(*tick);
        });
        handle.drain_events(|_| {});
        self.active.meet(handle, &self.plan.rig);
        let prompt = self.wizards.prompt(which);
        self.reader.show(Screen { side, task: task_of(Some(which)), prompt }, &mut self.read);
        let tick = self.ticks[side.index()];
        if tick.is_some_and(|tick| tick.state == LoopState::Idle && tick.guidance.prompt != prompt) {
            handle.send(Command::Prompt(side, prompt));
        }
        Ok(())
    }

    fn save(&mut self, saving: SaveRequest) -> anyhow::Result<()> {
        let side = self.active.side();
        self.wizards = Wizards::default();
        self.reader.show(Screen { side, task: PersonTask::Surgery, prompt: Prompt::Rest }, &mut self.read);
        let report = match saving {
            SaveRequest::Frame(saving) => {
                let folder = Store::of_user().ok().and_then(|store| Some(store.folder().parent()?.to_path_buf()));
                let saved = self.active.save_frame(*saving, &self.rig, folder.as_deref());
                let (rig, path, words) = saved.map_err(anyhow::Error::msg)?;
                self.plan.rig = rig;
                self.rig = path.display().to_string();
                words
            }
            saving => self.active.save(saving).map_err(anyhow::Error::msg)?,
        };
        print_line(report);
        self.saved = self.active.lines();
        self.restart()
    }
}
