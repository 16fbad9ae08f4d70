//! `nima console`: the window over a running loop; `nima view`: the same window with a recording.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use anyhow::Context as _;
use clap::Args;
use nima_calibrations::{WizardKind, active_calibrations::ActiveCalibrations};
use nima_machine::config::SchedulingClass;
use nima_panels::roles::Role;
use nima_recording::csv::{ColumnMapping, Signals};
use nima_report::output;
use nima_screen::{link::Reopen, stderr::print_line};
use nima_session::open_signals;
use nima_simulation::SimulationPlan;
use nima_words::language::Language;

use super::{remote_follower::ToFollower, rig_args::Setup};
use crate::{
    by_itself::{self, Starter},
    console::{
        self, ConsoleOptions, InitialRun, app::start_recorded, screenshots::ScreenshotFolder, sessions::ConsoleSessions,
    },
    emulators::Emulators,
    extras::{self, Extra},
    watching::WatchArguments,
};

#[derive(Debug, Default, Args)]
pub(super) struct ConsoleArguments {
    #[command(flatten)]
    setup: Setup,
    #[command(flatten)]
    watching: WatchArguments,
    #[command(flatten)]
    network: ToFollower,
    /// Start in this view (default: the last view used)
    #[arg(long)]
    role: Option<Role>,
    /// Language of the window: en or de (default: the last language chosen, initially en); the command line is always
    /// in English
    #[arg(long, value_name = "LANGUAGE", hide_possible_values = true)]
    language: Option<Language>,
    /// Open this calibration wizard at the start
    #[arg(long, value_name = "WIZARD")]
    calibrate: Option<WizardKind>,
    /// Show this recorded session at the start; the rig starts idle
    #[arg(long, value_name = "FILE", conflicts_with_all = ["calibrate", "pictures"])]
    session: Option<PathBuf>,
    /// Close after this many seconds
    #[arg(long, visible_alias = "seconds", value_name = "S", value_parser = super::run::positive_seconds)]
    exit_after: Option<f64>,
    /// Save a screenshot (PNG) just before closing; needs --exit-after
    #[arg(long, value_name = "FILE", requires = "exit_after")]
    screenshot: Option<PathBuf>,
    /// Scheduling class to request for the loop: ordinary, fifo or deadline (default: the rig's)
    #[arg(long, value_name = "CLASS")]
    scheduling: Option<SchedulingClass>,
    /// Save a screenshot of every view (PNG) in this folder, then close
    #[arg(long = "pictures", id = "pictures", value_name = "DIR", conflicts_with_all = ["exit_after", "calibrate", "role", "live", "share", "igtl", "lsl"])]
    images: Option<PathBuf>,
    /// Write the loop's timing and errors (JSON) to this file when the window closes
    #[arg(long, value_name = "FILE")]
    summary: Option<PathBuf>,
    /// Write the cost of the display (JSON: frame times, processor, memory, start-up) to this file when the window closes
    #[arg(long, value_name = "FILE")]
    frames: Option<PathBuf>,
    /// Time span of the traces at the start, s
    #[arg(long, value_name = "S", value_parser = super::run::positive_seconds)]
    traces: Option<f64>,
    /// Start idle (default: the built-in rigs `simulated` and `emulated` engage automatically)
    #[arg(long)]
    at_rest: bool,
    /// Block the window once for this many seconds, to show that the loop is not affected
    #[arg(long, value_name = "S", value_parser = super::run::positive_seconds)]
    stall: Option<f64>,
}

#[derive(Debug, Args)]
pub(super) struct ViewArguments {
    /// A table (CSV), an MCAP file, the folder of a ROS 2 bag, or a recorded session
    recording: PathBuf,
    /// Column, or topic and field, of a force or a position: `fz=Fz*0.001`, `xyz=px_mm,py_mm,pz_mm*0.001`,
    /// `fz=/ft/wrench.wrench.force.z`
    #[arg(long, value_name = "NAME=COLUMN[*SCALE]")]
    map: Vec<String>,
    /// Language of the window: en or de
    #[arg(long, value_name = "LANGUAGE", hide_possible_values = true)]
    language: Option<Language>,
    /// Close after this many seconds
    #[arg(long, visible_alias = "seconds", value_name = "S", value_parser = super::run::positive_seconds)]
    exit_after: Option<f64>,
    /// Save a screenshot (PNG) just before closing; needs --exit-after
    #[arg(long, value_name = "FILE", requires = "exit_after")]
    screenshot: Option<PathBuf>,
}

/// Shows a recording; the simulated rig behind it stays idle.
pub(super) fn view(arguments: ViewArguments) -> anyhow::Result<()> {
    let ViewArguments { recording, map, language, exit_after, screenshot } = arguments;
    let mapping = ColumnMapping::parse(&map)?;
    anyhow::ensure!(!mapping.names_leader(), "--map selects the leader's own motion, which is not shown: omit it");
    let signals = open_signals(&recording, &mapping, !map.is_empty())?;
    anyhow::ensure!(
        signals.is_some() || map.is_empty(),
        "--map applies only to tables and other programs' recordings, and {} is a session: omit it",
        recording.display()
    );
    let session = Some(recording);
    let console = ConsoleArguments { language, session, exit_after, screenshot, ..ConsoleArguments::default() };
    open(&console, signals.map(Arc::new))
}

pub(super) fn run(arguments: &ConsoleArguments) -> anyhow::Result<()> {
    open(arguments, None)
}

/// Opens the window; `signals`: of another program's recording that it shows.
fn open(arguments: &ConsoleArguments, signals: Option<Arc<Signals>>) -> anyhow::Result<()> {
    if arguments.calibrate == Some(WizardKind::Camera) && extras::part(Extra::camera_wizard).is_none() {
        return Err(extras::not_built("calibration of the camera", "camera"));
    }
    let outputs = [&arguments.screenshot, &arguments.summary, &arguments.frames];
    for out in outputs.into_iter().flatten() {
        output::check(out, &[arguments.setup.rig(), arguments.setup.scene()].map(Path::new))?;
    }
    let (mut rig, scene) = arguments.setup.load_for_a_trial()?;
    rig.scheduling = arguments.scheduling.unwrap_or(rig.scheduling);
    let line = arguments.network.open(&mut rig, &scene)?;
    let leave = arguments.setup.leave()?;
    let choice = arguments.setup.choice();
    // The follower runs the emulators of the whole rig.
    let emulated = rig.devices.as_ref().filter(|_| line.is_none());
    let emulators = Emulators::start(&choice.rig, &choice.scene, emulated)?;
    let mut active = ActiveCalibrations::load(None, &rig, &scene);
    let (rig, calibrations) = (active.with_checked(rig.clone()), active.calibrations(&rig));
    let mut plan = SimulationPlan { rig: rig.clone(), scene: scene.clone(), calibrations, engage: false };
    let at_rest = arguments.at_rest || arguments.calibrate.is_some() || arguments.session.is_some();
    let by_itself = by_itself::engages(Starter::Window, arguments.setup.rig(), &rig, arguments.network.arm());
    plan.engage = by_itself && !at_rest && plan.may_engage();
    // Screenshots are taken of a session that is not needed afterwards.
    let folder = active.store().and_then(|store| store.folder().parent()).filter(|_| arguments.images.is_none());
    let servers = arguments.watching.start()?;
    anyhow::ensure!(
        servers.is_empty() || folder.is_some(),
        "viewers need a recorded session, but no folder for sessions was found: set NIMA_DATA_DIR"
    );
    let mut sessions = ConsoleSessions::of_user(folder, servers);
    let network = arguments.network.clone();
    let far = line.as_ref().map(|line| (line.door(), Reopen::new(move |rig, scene| network.open(rig, scene))));
    let started = start_recorded(&plan, &mut sessions, line)?;
    let options = ConsoleOptions {
        exit_after: arguments.exit_after.map(Duration::from_secs_f64),
        screenshot: arguments.screenshot.clone(),
        images: arguments.images.as_deref().map(ScreenshotFolder::new),
        role: arguments.role,
        language: arguments.language,
        session: arguments.session.clone(),
        signals,
        wizard: arguments.calibrate,
        summary: arguments.summary.clone(),
        frames: arguments.frames.clone(),
        traces_s: arguments.traces,
        stall: arguments.stall.map(Duration::from_secs_f64),
        leave: leave.clone(),
    };
    let album = options.images.clone();
    if let Some(folder) = &arguments.images {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot create the folder {}", folder.display()))?;
    }
    console::run(InitialRun { choice, emulators, started, rig, scene, sessions, far }, options)?;
    if leave.is_asked() {
        print_line("nima: ended on request: force and drives are off");
    }
    anyhow::ensure!(
        album.is_none_or(|album| album.is_complete()),
        "some screenshots are missing: the loop stopped or the window was closed; try again on an idle computer"
    );
    Ok(())
}
