//! Wizards: a technician alone, step by step, from an uncalibrated sensor to a calibration that has proven itself.
//!
//! A wizard sees every tick, asks the person at the arm for something ([`Prompt`]) and hands out a record when it shall be
//! saved. It never changes the loop: saving restarts it, idle, with the new calibration.

mod checks;
mod correspondence;
mod frame;
mod gravity;
mod pictures;
mod report;
mod tip_force;

use egui::{RichText, Ui};
use nima_core::{
    calibration::{
        Judgement,
        correspondence::{Correspondence, CorrespondenceRecord},
        gravity::GravityRecord,
    },
    tip_force::Model,
};
use nima_machine::{messages::Tick, rig::Prompt};
use nima_recording::store::Store;
use nima_world::scene::Scene;

pub use correspondence::CorrespondenceWizard;
pub use gravity::GravityWizard;
pub use tip_force::TipForceWizard;

use self::frame::{Wizard, wizard_ui};
use super::{theme, widgets::small};
use crate::console::text;

/// What a calibration belongs to, and what a later one builds on.
#[derive(Clone, Debug, Default)]
pub struct Binding {
    /// Serial number of the wrist sensor.
    pub sensor: String,
    /// Name of the tool.
    pub tool: String,
    /// Now, ISO 8601, UTC.
    pub date: String,
    /// How the sensor under the tissue is turned, if that is known.
    pub correspondence: Option<Correspondence>,
    /// Where calibrations and their data are kept; none where no folder is known.
    pub store: Option<Store>,
}

/// Which wizard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Which {
    /// Weight and bias.
    Gravity,
    /// How the sensor under the tissue is turned against the one at the wrist.
    Correspondence,
    /// A network that takes the trocar's friction out.
    TipForce,
}

impl Which {
    /// All of them, in the order of work.
    pub const ALL: [Self; 3] = [Self::Gravity, Self::Correspondence, Self::TipForce];

    /// On buttons.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gravity => text::wizards::GRAVITY,
            Self::Correspondence => text::wizards::CORRESPONDENCE,
            Self::TipForce => text::wizards::TIP_FORCE,
        }
    }

    /// What it is for.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Gravity => text::wizards::GRAVITY_MEANING,
            Self::Correspondence => text::wizards::CORRESPONDENCE_MEANING,
            Self::TipForce => text::wizards::TIP_FORCE_MEANING,
        }
    }

    /// The simulated experiment that it needs.
    pub const fn scene(self) -> &'static str {
        match self {
            Self::Gravity => "gravity",
            Self::Correspondence => "correspondence",
            Self::TipForce => "isolation",
        }
    }

    /// Whether somebody guides the arm in this scene and all that is needed is there, so that it need not be left.
    pub const fn suits(self, scene: &Scene) -> bool {
        let guided = scene.person.is_some() && scene.wrist.is_some();
        match self {
            Self::Gravity => guided,
            Self::Correspondence => guided && scene.tissue_sensor.is_some(),
            Self::TipForce => guided && scene.tissue_sensor.is_some() && scene.trocar.is_some(),
        }
    }
}

/// Something to be saved and used.
#[derive(Clone, Debug)]
pub enum Saving {
    /// A gravity calibration.
    Gravity(Box<GravityRecord>),
    /// A correspondence.
    Correspondence(Box<CorrespondenceRecord>),
    /// A network with its check.
    TipForce(Box<Model>),
}

impl Saving {
    /// What was judged of it; a network without a check has no judgement.
    fn judgement_mut(&mut self) -> Option<&mut Judgement> {
        match self {
            Self::Gravity(record) => Some(&mut record.judgement),
            Self::Correspondence(record) => Some(&mut record.judgement),
            Self::TipForce(model) => model.origin.check.as_mut().map(|check| &mut check.judgement),
        }
    }
}

/// All wizards; each keeps what it has until it is started over.
#[derive(Debug, Default)]
pub struct Wizards {
    /// The one on the screen.
    pub open: Option<Which>,
    gravity: GravityWizard,
    correspondence: CorrespondenceWizard,
    tip_force: TipForceWizard,
}

impl Wizards {
    /// With this one on the screen.
    pub fn at(which: Which) -> Self {
        Self { open: Some(which), ..Self::default() }
    }

    fn the(&self, which: Which) -> &dyn Wizard {
        match which {
            Which::Gravity => &self.gravity,
            Which::Correspondence => &self.correspondence,
            Which::TipForce => &self.tip_force,
        }
    }

    fn the_mut(&mut self, which: Which) -> &mut dyn Wizard {
        match which {
            Which::Gravity => &mut self.gravity,
            Which::Correspondence => &mut self.correspondence,
            Which::TipForce => &mut self.tip_force,
        }
    }

    /// Takes in one tick of a loop of this rate (Hz).
    pub fn tick(&mut self, tick: &Tick, rate_hz: f64) {
        if let Some(which) = self.open {
            self.the_mut(which).tick(tick, rate_hz);
        }
    }

    /// What the person at the arm is to do now.
    pub fn prompt(&self) -> Prompt {
        self.open.map_or(Prompt::Rest, |which| self.the(which).prompt())
    }

    /// Tells the open wizard what became of its record.
    pub fn tell_saved(&mut self, words: String) {
        if let Some(which) = self.open {
            self.the_mut(which).frame_mut().saved = Some(words);
        }
    }

    /// The open wizard; gives what shall be saved.
    pub fn ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<Saving> {
        let which = self.open?;
        ui.label(RichText::new(text::wizards::title(which.name())).font(theme::strong(22.0)));
        ui.label(small(which.meaning()));
        ui.add_space(theme::GAP);
        let saving = wizard_ui(self.the_mut(which), ui, binding)?;
        if matches!(saving, Saving::Gravity(_)) {
            // Pushes and recordings are free of gravity by the calibration before this one: both do not mix.
            self.correspondence = CorrespondenceWizard::default();
            self.tip_force = TipForceWizard::default();
        }
        Some(saving)
    }
}
