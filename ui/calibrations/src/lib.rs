//! The calibrations of a rig: which there are, those that are active, their age and verdict, and what a new one is saved as.
//! Without a window: the commands use them too. The wizards that make them are in `nima-wizards`.
// These macros panic if stderr or stdout is closed.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

pub mod active_calibrations;
pub mod frames;
pub mod overview;

use std::sync::atomic::{AtomicBool, Ordering};

use clap::{ValueEnum, builder::PossibleValue};
use nima_core::{
    calibration::{
        Judgement,
        correspondence::{Correspondence, CorrespondenceRecord},
        frames::RigChange,
        gravity::GravityRecord,
    },
    tip_force::ForceModel,
};
use nima_machine::{config::RigFile, rig::Side};
use nima_recording::store::Store;
use nima_simulation::scene::Scene;
use nima_words::text;

use crate::frames::{FrameKind, FrameSaving, FrameSubject};

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
    /// The rig has an endoscope, whose image the console shows.
    pub has_image: bool,
}

impl Binding {
    /// Returns a value of the rig file as TOML text.
    pub fn rig_value(&self, key: &str) -> Option<String> {
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

/// Whether this build has the wizard of the endoscope's camera.
static HAS_CAMERA: AtomicBool = AtomicBool::new(false);

pub fn offer_camera() {
    HAS_CAMERA.store(true, Ordering::Relaxed);
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

    /// Returns the wizards of this build.
    pub fn built() -> impl Iterator<Item = Self> {
        let has_camera = HAS_CAMERA.load(Ordering::Relaxed);
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
    pub fn judgement_mut(&mut self) -> Option<&mut Judgement> {
        match self {
            Self::Gravity(record) => Some(&mut record.judgement),
            Self::Correspondence(record) => Some(&mut record.judgement),
            Self::TipForce(model) => model.origin.check.as_mut().map(|check| &mut check.judgement),
            Self::Frame(saving) => Some(saving.record.judgement_mut()),
            Self::Camera(_) | Self::Undo(_) => None,
        }
    }
}
