//! `nima console`: the window over a running loop.

use std::{path::PathBuf, time::Duration};

use anyhow::Context as _;
use clap::Args;
use nima::{
    config::SchedulingClass,
    runtime::{self, Plan},
};

use super::{emulators::Emulators, setup::Setup};
use crate::console::{self, Options, in_force::InForce, pictures::Album, roles::Role, wizards::Which};

#[derive(Debug, Default, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    setup: Setup,
    /// Begin in this role (otherwise the one of the last time)
    #[arg(long)]
    role: Option<Role>,
    /// Begin with this calibration wizard
    #[arg(long, value_name = "WIZARD")]
    calibrate: Option<Which>,
    /// Close after this many seconds
    #[arg(long, value_name = "S", value_parser = super::run::positive_seconds)]
    exit_after: Option<f64>,
    /// Save a picture of the window (PNG) just before closing; needs --exit-after
    #[arg(long, value_name = "FILE", requires = "exit_after")]
    screenshot: Option<PathBuf>,
    /// What to ask of the operating system for the loop: ordinary, fifo or deadline (default: the rig's)
    #[arg(long, value_name = "CLASS")]
    scheduling: Option<SchedulingClass>,
    /// Take pictures of every view (PNG) into this folder, then close
    #[arg(long, value_name = "DIR", conflicts_with_all = ["exit_after", "calibrate", "role"])]
    pictures: Option<PathBuf>,
    /// Write the loop's figures (JSON) here when the window is closed
    #[arg(long, value_name = "FILE")]
    summary: Option<PathBuf>,
    /// Write what the screen costs (JSON: time from picture to picture, processor, memory, start) here when the window is closed
    #[arg(long, value_name = "FILE")]
    frames: Option<PathBuf>,
    /// Show this many seconds in the traces at first
    #[arg(long, value_name = "S", value_parser = super::run::positive_seconds)]
    traces: Option<f64>,
    /// Do not engage by itself, as it otherwise does on a simulated or emulated rig
    #[arg(long)]
    at_rest: bool,
    /// Hold the window up for this many seconds, once: to see that the loop does not mind
    #[arg(long, value_name = "S", value_parser = super::run::positive_seconds)]
    stall: Option<f64>,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (mut rig, scene) = arguments.setup.load()?;
    rig.scheduling = arguments.scheduling.unwrap_or(rig.scheduling);
    let _emulators = Emulators::start(&arguments.setup, rig.devices.as_ref())?;
    let calibrations = InForce::load(None, &scene).calibrations(&rig);
    let left_calibrations = calibrations.clone();
    let mut plan = Plan { rig: rig.clone(), scene: scene.clone(), calibrations, left_calibrations, engage: false };
    // The simulated hand cannot be hurt: the demo runs at once.
    let by_itself = rig.devices.as_ref().is_none_or(|devices| devices.emulated);
    plan.engage = by_itself && !arguments.at_rest && plan.may_engage();
    let handle = runtime::start(&plan)?;
    let options = Options {
        exit_after: arguments.exit_after.map(Duration::from_secs_f64),
        screenshot: arguments.screenshot.clone(),
        pictures: arguments.pictures.as_deref().map(Album::new),
        role: arguments.role,
        wizard: arguments.calibrate,
        summary: arguments.summary.clone(),
        frames: arguments.frames.clone(),
        traces_s: arguments.traces,
        stall: arguments.stall.map(Duration::from_secs_f64),
    };
    let album = options.pictures.clone();
    if let Some(folder) = &arguments.pictures {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("the folder for pictures {} cannot be made", folder.display()))?;
    }
    console::run(handle, rig, scene, options)?;
    anyhow::ensure!(
        album.is_none_or(|album| album.is_complete()),
        "not all pictures were taken: the loop stopped or the window was closed; try again on a machine at rest"
    );
    Ok(())
}
