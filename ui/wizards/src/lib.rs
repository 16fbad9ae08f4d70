//! Calibration wizards, which guide a single technician step by step from an uncalibrated sensor to a verified calibration.
//!
//! A wizard receives every tick, gives the person at the arm instructions ([`Prompt`]) and returns a record to save. It does
//! not change the loop; saving activates the new calibration.
// These macros panic if stderr or stdout is closed.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

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

use egui::{Frame, Margin, RichText, Stroke, Ui};
use nima_endoscope::DecodedImage;
use nima_machine::{
    messages::Tick,
    rig::{Prompt, Side},
};
use nima_screen::{scene3d::side_name, theme, widgets::small};
use nima_words::text;

pub use attend::WizardOutcome;
pub use correspondence::CorrespondenceWizard;
pub use frames::FrameWizard;
pub use gravity::GravityWizard;
pub use nima_calibrations::{
    Binding, CalibrationTarget, SaveRequest, WizardKind, active_calibrations,
    frames::{FrameCalibration, FrameKind, FrameSaving, FrameSubject},
};
pub use tip_force::TipForceWizard;

pub use frame::Wizard;

use self::frame::wizard_ui;

/// The wizard of the endoscope's camera, which an extra has.
static CAMERA: OnceLock<fn() -> Box<dyn Wizard>> = OnceLock::new();

pub fn offer_camera(wizard: fn() -> Box<dyn Wizard>) {
    CAMERA.get_or_init(|| wizard);
    nima_calibrations::offer_camera();
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

/// Draws the name of an arm on a chip of its colour.
fn arm_chip(ui: &mut Ui, side: Side) {
    let colour = theme::now().arms[side.index()];
    let frame = Frame::new().stroke(Stroke::new(1.5, colour)).corner_radius(theme::CORNER);
    frame.inner_margin(Margin::symmetric(8, 2)).show(ui, |ui| {
        ui.label(RichText::new(text::calibrations::arm(side_name(side))).font(theme::strong(14.0)).color(colour));
    });
}

/// The technician's request on a wizard's page.
#[derive(Clone, Debug)]
pub enum WizardPageRequest {
    Save(SaveRequest),
    /// Continue elsewhere.
    GoOn(GoOn),
}

/// All wizards; each keeps its data until it is reset.
#[derive(Debug)]
pub struct Wizards {
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
            gravity: GravityWizard::default(),
            correspondence: CorrespondenceWizard::default(),
            tip_force: TipForceWizard::default(),
            frames: FrameKind::ALL.map(FrameWizard::new),
            camera: CAMERA.get().map(|wizard| wizard()),
        }
    }
}

impl Wizards {
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

    /// Adds one tick of a loop of this rate (Hz) to this wizard.
    pub fn tick(&mut self, which: WizardKind, tick: &Tick, rate_hz: f64) {
        if let Some(wizard) = self.the_mut(which) {
            wizard.tick(tick, rate_hz);
        }
    }

    /// Passes the endoscope's newest image to a wizard that uses it; `newest` is called only then.
    pub fn see(
        &mut self,
        which: WizardKind,
        newest: impl FnOnce() -> Option<(u64, Arc<DecodedImage>)>,
        ctx: &egui::Context,
    ) {
        if let Some(wizard) = self.camera.as_mut().filter(|_| which == WizardKind::Camera) {
            wizard.see(newest(), ctx);
        }
    }

    /// Returns whether this wizard is followed by looking at the endoscope image.
    pub fn looks_at_image(&self, which: WizardKind) -> bool {
        which == WizardKind::Frame(FrameKind::View) && self.frames[FrameKind::View as usize].records()
    }

    /// Returns this wizard's current instruction to the person at the arm.
    pub fn prompt(&self, which: WizardKind) -> Prompt {
        self.the(which).map_or(Prompt::Rest, Wizard::prompt)
    }

    /// Chooses between the two parts of a view.
    pub fn choose_part(&mut self, wanted: CalibrationTarget) {
        if wanted.which == WizardKind::Frame(FrameKind::View) {
            self.frames[FrameKind::View as usize].choose_way(wanted.by_handle);
        }
    }

    /// Returns the calibration of this wizard.
    pub fn wanted(&self, which: WizardKind, side: Side) -> CalibrationTarget {
        let by_handle =
            which == WizardKind::Frame(FrameKind::View) && self.frames[FrameKind::View as usize].goes_the_other_way();
        CalibrationTarget { side, which, by_handle }
    }

    /// Shows the result of saving in this wizard, and the step after it.
    pub fn report_saved(&mut self, which: WizardKind, report: Result<String, String>, following: Option<GoOn>) {
        if let Some(wizard) = self.the_mut(which) {
            wizard.frame_mut().report_saved(report, following);
        }
    }

    /// Draws this wizard; returns its request.
    pub fn ui(&mut self, which: WizardKind, ui: &mut Ui, binding: &Binding) -> Option<WizardPageRequest> {
        let side = binding.subject.as_ref().map(|subject| subject.side);
        ui.horizontal(|ui| {
            let title = RichText::new(text::wizards::title(which.name())).font(theme::strong(22.0));
            ui.label(title);
            if let Some(side) = side {
                arm_chip(ui, side);
            }
        });
        ui.label(small(which.meaning()));
        ui.add_space(theme::GAP);
        let asked = wizard_ui(self.the_mut(which)?, ui, binding)?;
        if let WizardPageRequest::Save(saving) = &asked {
            self.forget_what_rests_on(which, saving);
        }
        Some(asked)
    }
}
