//! Calibration wizards, which guide a single technician step by step from an uncalibrated sensor to a verified calibration.
//!
//! A wizard receives every tick, gives the person at the arm instructions ([`Prompt`]) and returns a record to save. It does
//! not change the loop; saving activates the new calibration.
// These macros panic if stderr or stdout is closed.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

pub mod active_calibrations;
mod attend;
pub mod checks;
mod correspondence;
pub mod drawings;
pub mod frame;
mod frames;
mod gravity;
mod guide;
pub mod overview;
pub mod ready;
pub mod report;
mod tip_force;

use std::sync::{Arc, OnceLock};

use clap::{ValueEnum, builder::PossibleValue};
use egui::{RichText, Ui};
use nima_core::{
    calibration::{
        Judgement,
        correspondence::{Correspondence, CorrespondenceRecord},
        frames::RigChange,
        gravity::GravityRecord,
    },
    tip_force::ForceModel,
};
use nima_endoscope::DecodedImage;
use nima_machine::{
    config::RigFile,
    messages::Tick,
    rig::{Prompt, Side},
};
use nima_recording::store::Store;
use nima_screen::{scene3d::side_name, theme, widgets::small};
use nima_simulation::scene::Scene;
use nima_words::{report_text::side_word, text};

pub use attend::WizardOutcome;
pub use correspondence::CorrespondenceWizard;
pub use frames::sizes_text;
pub use frames::{FrameCalibration, FrameKind, FrameSaving, FrameSubject, FrameWizard, StoredFrame, frame_kept};
pub use gravity::GravityWizard;
pub use tip_force::TipForceWizard;

pub use frame::Wizard;

use self::frame::wizard_ui;

/// Sensor, tool and existing data for a new calibration.
#[derive(Clone, Debug, Default)]
pub struct Binding {
    pub sensor: String,
    pub tool: String,
    /// Current time, ISO 8601, UTC.
    pub date: String,
    /// Rotation of the sensor under the tissue, if known.
    pub correspondence: Option<Correspondence>,
    /// Store of calibrations and their data; `None` without a folder.
    pub store: Option<Store>,
    /// The arm in its rig file; `None` if the rig has no such arm.
    pub subject: Option<FrameSubject>,
    /// Name or path of the rig.
    pub rig: String,
}

impl Binding {
    /// Returns a value of the rig file as TOML text.
    fn rig_value(&self, key: &str) -> Option<String> {
        RigFile::of(&self.rig).ok()?.value(key)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WizardKind {
    Gravity,
    /// Rotation between the sensor under the tissue and the one at the wrist.
    Correspondence,
    /// The network that removes the trocar's friction.
    TipForce,
    Frame(FrameKind),
    /// Lens and position of the endoscope's camera.
    Camera,
}

/// Each wizard is one word on the command line, including the frame calibrations.
impl ValueEnum for WizardKind {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let value = match self {
            Self::Gravity => PossibleValue::new("gravity"),
            Self::Correspondence => PossibleValue::new("correspondence"),
            Self::TipForce => PossibleValue::new("tip-force"),
            Self::Frame(kind) => kind.to_possible_value()?,
            Self::Camera => PossibleValue::new("camera"),
        };
        Some(value.help(self.meaning()))
    }
}

/// The wizard of the endoscope's camera, which an extra has.
static CAMERA: OnceLock<fn() -> Box<dyn Wizard>> = OnceLock::new();

pub fn offer_camera(wizard: fn() -> Box<dyn Wizard>) {
    CAMERA.get_or_init(|| wizard);
}

impl WizardKind {
    /// All wizards, in the order of use; the frames come first because they rotate the forces measured at the wrist.
    pub const ALL: [Self; 10] = [
        Self::Frame(FrameKind::Mount),
        Self::Frame(FrameKind::Tip),
        Self::Frame(FrameKind::HandEye),
        Self::Frame(FrameKind::Table),
        Self::Frame(FrameKind::View),
        Self::Frame(FrameKind::Trocar),
        Self::Gravity,
        Self::Correspondence,
        Self::TipForce,
        Self::Camera,
    ];

    /// Wizards of this build.
    pub fn built() -> impl Iterator<Item = Self> {
        let has_camera = CAMERA.get().is_some();
        Self::ALL.into_iter().filter(move |which| has_camera || *which != Self::Camera)
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Gravity => text::wizards::GRAVITY.get(),
            Self::Correspondence => text::wizards::CORRESPONDENCE.get(),
            Self::TipForce => text::wizards::TIP_FORCE.get(),
            Self::Frame(kind) => kind.name(),
            Self::Camera => text::wizards::CAMERA.get(),
        }
    }

    pub fn meaning(self) -> &'static str {
        match self {
            Self::Gravity => text::wizards::GRAVITY_MEANING.get(),
            Self::Correspondence => text::wizards::CORRESPONDENCE_MEANING.get(),
            Self::TipForce => text::wizards::TIP_FORCE_MEANING.get(),
            Self::Frame(kind) => kind.meaning(),
            Self::Camera => text::wizards::CAMERA_MEANING.get(),
        }
    }

    /// Returns the simulated experiment for it; `None` if it needs a rig with devices.
    pub const fn scene(self) -> Option<&'static str> {
        match self {
            Self::Gravity => Some("gravity"),
            Self::Correspondence => Some("correspondence"),
            Self::TipForce => Some("isolation"),
            Self::Frame(_) | Self::Camera => None,
        }
    }

    /// Returns whether this scene has a person who guides the arm, and everything else that the wizard requires, so
    /// that it need not be changed.
    pub const fn suits(self, scene: &Scene) -> bool {
        let guided = scene.person.is_some() && scene.wrist.is_some();
        match self {
            Self::Gravity => guided,
            Self::Correspondence => guided && scene.tissue_sensor.is_some(),
            Self::TipForce => guided && scene.tissue_sensor.is_some() && scene.trocar.is_some(),
            Self::Frame(_) | Self::Camera => true,
        }
    }
}

/// One calibration of one arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CalibrationTarget {
    pub side: Side,
    /// Wizard for it.
    pub which: WizardKind,
    /// The handle's part of a view.
    pub by_handle: bool,
}

impl CalibrationTarget {
    pub fn name(&self) -> &'static str {
        if self.by_handle { text::overview::HANDLE.get() } else { self.which.name() }
    }
}

/// The step after a calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GoOn {
    Calibrate(CalibrationTarget),
    /// Nothing is missing: the ready check.
    Check,
}

impl GoOn {
    pub fn words(self) -> String {
        match self {
            Self::Calibrate(wanted) => text::wizards::following(side_name(wanted.side), wanted.name()),
            Self::Check => text::wizards::FOLLOWING_CHECK.get().to_owned(),
        }
    }
}

/// The technician's request on a wizard's page.
#[derive(Clone, Debug)]
pub enum WizardPageRequest {
    Save(SaveRequest),
    /// Continue elsewhere.
    GoOn(GoOn),
}

/// A record to be saved and used.
#[derive(Clone, Debug)]
pub enum SaveRequest {
    Gravity(Box<GravityRecord>),
    Correspondence(Box<CorrespondenceRecord>),
    /// A network with its check.
    TipForce(Box<ForceModel>),
    /// A frame calibration, with its changes to the rig file.
    Frame(Box<FrameSaving>),
    /// Lens and position of the camera, as changes to the rig file.
    Camera(Vec<RigChange>),
    /// Values to restore in the rig file.
    Undo(Vec<RigChange>),
}

impl SaveRequest {
    /// Returns its judgement; a network without a check has none.
    fn judgement_mut(&mut self) -> Option<&mut Judgement> {
        match self {
            Self::Gravity(record) => Some(&mut record.judgement),
            Self::Correspondence(record) => Some(&mut record.judgement),
            Self::TipForce(model) => model.origin.check.as_mut().map(|check| &mut check.judgement),
            Self::Frame(saving) => Some(saving.record.judgement_mut()),
            Self::Camera(_) | Self::Undo(_) => None,
        }
    }
}

/// All wizards; each keeps its data until it is reset.
#[derive(Debug)]
pub struct Wizards {
    pub open: Option<WizardKind>,
    gravity: GravityWizard,
    correspondence: CorrespondenceWizard,
    tip_force: TipForceWizard,
    /// In the order of [`FrameKind::ALL`].
    frames: [FrameWizard; FrameKind::ALL.len()],
    /// `None` in a build without it.
    camera: Option<Box<dyn Wizard>>,
}

impl Default for Wizards {
    fn default() -> Self {
        Self {
            open: None,
            gravity: GravityWizard::default(),
            correspondence: CorrespondenceWizard::default(),
            tip_force: TipForceWizard::default(),
            frames: FrameKind::ALL.map(FrameWizard::new),
            camera: CAMERA.get().map(|wizard| wizard()),
        }
    }
}

impl Wizards {
    pub fn at(which: WizardKind) -> Self {
        Self { open: Some(which), ..Self::default() }
    }

    fn the(&self, which: WizardKind) -> Option<&dyn Wizard> {
        Some(match which {
            WizardKind::Gravity => &self.gravity,
            WizardKind::Correspondence => &self.correspondence,
            WizardKind::TipForce => &self.tip_force,
            WizardKind::Frame(kind) => &self.frames[kind as usize],
            WizardKind::Camera => return self.camera.as_deref(),
        })
    }

    fn the_mut(&mut self, which: WizardKind) -> Option<&mut (dyn Wizard + 'static)> {
        Some(match which {
            WizardKind::Gravity => &mut self.gravity,
            WizardKind::Correspondence => &mut self.correspondence,
            WizardKind::TipForce => &mut self.tip_force,
            WizardKind::Frame(kind) => &mut self.frames[kind as usize],
            WizardKind::Camera => return self.camera.as_deref_mut(),
        })
    }

    /// Adds one tick of a loop of this rate (Hz).
    pub fn tick(&mut self, tick: &Tick, rate_hz: f64) {
        if let Some(wizard) = self.open.and_then(|which| self.the_mut(which)) {
            wizard.tick(tick, rate_hz);
        }
    }

    /// Passes the endoscope's newest image to a wizard that uses it; `newest` is called only then.
    pub fn see(&mut self, newest: impl FnOnce() -> Option<(u64, Arc<DecodedImage>)>, ctx: &egui::Context) {
        if let Some(wizard) = self.camera.as_mut().filter(|_| self.open == Some(WizardKind::Camera)) {
            wizard.see(newest(), ctx);
        }
    }

    /// Returns whether the open wizard is followed by looking at the endoscope image.
    pub fn looks_at_image(&self) -> bool {
        self.open == Some(WizardKind::Frame(FrameKind::View)) && self.frames[FrameKind::View as usize].records()
    }

    /// Returns the current instruction to the person at the arm.
    pub fn prompt(&self) -> Prompt {
        self.open.and_then(|which| self.the(which)).map_or(Prompt::Rest, Wizard::prompt)
    }

    /// Chooses between the two parts of a view.
    pub fn choose_part(&mut self, wanted: CalibrationTarget) {
        if wanted.which == WizardKind::Frame(FrameKind::View) {
            self.frames[FrameKind::View as usize].choose_way(wanted.by_handle);
        }
    }

    /// Returns the calibration of the open wizard.
    pub fn wanted(&self, side: Side) -> Option<CalibrationTarget> {
        let which = self.open?;
        let by_handle =
            which == WizardKind::Frame(FrameKind::View) && self.frames[FrameKind::View as usize].goes_the_other_way();
        Some(CalibrationTarget { side, which, by_handle })
    }

    /// Shows the result of saving in the open wizard, and the step after it.
    pub fn report_saved(&mut self, report: Result<String, String>, following: Option<GoOn>) {
        if let Some(wizard) = self.open.and_then(|which| self.the_mut(which)) {
            wizard.frame_mut().report_saved(report, following);
        }
    }

    /// Draws the open wizard; returns its request.
    pub fn ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<WizardPageRequest> {
        let which = self.open?;
        let arm = binding.subject.as_ref().map(|subject| side_word(subject.side));
        ui.label(RichText::new(text::wizards::title(which.name(), arm)).font(theme::strong(22.0)));
        ui.label(small(which.meaning()));
        ui.add_space(theme::GAP);
        let asked = wizard_ui(self.the_mut(which)?, ui, binding)?;
        if let WizardPageRequest::Save(saving) = &asked {
            self.forget_what_rests_on(saving);
        }
        Some(asked)
    }
}
