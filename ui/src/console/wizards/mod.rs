//! Wizards: a technician alone, step by step, from an uncalibrated sensor to a calibration that has proven itself.
//!
//! A wizard sees every tick, asks the person at the arm for something ([`Prompt`]) and hands out a record when it shall be
//! saved. It never changes the loop: saving restarts it, idle, with the new calibration.

mod checks;
mod correspondence;
mod gravity;
mod pictures;
mod tip_force;

use crate::console::text;
use egui::{Button, RichText, TextEdit, Ui, vec2};
use nima::{
    calibration::{
        correspondence::{Correspondence, CorrespondenceRecord},
        gravity::GravityRecord,
        store::Store,
    },
    config::Scene,
    device::Prompt,
    runtime::Tick,
    tip_force::Model,
};

pub use correspondence::CorrespondenceWizard;
pub use gravity::GravityWizard;
pub use tip_force::TipForceWizard;

use super::{
    theme,
    widgets::{card, figure, small, weak},
};

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

/// One step of a wizard.
#[derive(Clone, Copy, Debug)]
struct Step {
    name: &'static str,
    meaning: &'static str,
}

/// Where the technician wants to go.
#[derive(Clone, Copy, Debug)]
enum Wish {
    GoTo(usize),
    StartOver,
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
            Self::Gravity => text::wizards::TAKES_THE_TOOL_S,
            Self::Correspondence => text::wizards::FINDS_HOW_THE_SENSOR,
            Self::TipForce => text::wizards::TEACHES_A_NETWORK_TO,
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

    /// Takes in one tick of a loop of this rate (Hz).
    pub fn tick(&mut self, tick: &Tick, rate_hz: f64) {
        match self.open {
            Some(Which::Gravity) => self.gravity.tick(tick, rate_hz),
            Some(Which::Correspondence) => self.correspondence.tick(tick),
            Some(Which::TipForce) => self.tip_force.tick(tick),
            None => {}
        }
    }

    /// What the person at the arm is to do now.
    pub fn prompt(&self) -> Prompt {
        match self.open {
            Some(Which::Gravity) => self.gravity.prompt(),
            Some(Which::Correspondence) => self.correspondence.prompt(),
            Some(Which::TipForce) => self.tip_force.prompt(),
            None => Prompt::Rest,
        }
    }

    /// Tells the open wizard what became of its record.
    pub fn tell_saved(&mut self, words: String) {
        match self.open {
            Some(Which::Gravity) => self.gravity.tell_saved(words),
            Some(Which::Correspondence) => self.correspondence.tell_saved(words),
            Some(Which::TipForce) => self.tip_force.tell_saved(words),
            None => {}
        }
    }

    /// The open wizard; gives what shall be saved.
    pub fn ui(&mut self, ui: &mut Ui, binding: &Binding) -> Option<Saving> {
        let which = self.open?;
        ui.label(RichText::new(format!("{} calibration", which.name())).font(theme::strong(22.0)));
        ui.label(small(which.meaning()));
        ui.add_space(theme::GAP);
        match which {
            Which::Gravity => {
                let record = self.gravity.ui(ui, binding)?;
                // Pushes and recordings are free of gravity by the calibration before this one: both do not mix.
                self.correspondence = CorrespondenceWizard::default();
                self.tip_force = TipForceWizard::default();
                Some(Saving::Gravity(Box::new(record)))
            }
            Which::Correspondence => self.correspondence.ui(ui, binding).map(Box::new).map(Saving::Correspondence),
            Which::TipForce => self.tip_force.ui(ui, binding).map(Box::new).map(Saving::TipForce),
        }
    }
}

/// The row of steps with the ways back, on and over. Nothing good is lost by going back.
fn steps_ui(ui: &mut Ui, steps: &[Step], now: usize, may_go_on: Result<(), &'static str>) -> Option<Wish> {
    let mut wish = None;
    ui.horizontal_wrapped(|ui| {
        for (i, step) in steps.iter().enumerate() {
            let (font, colour) = if i == now {
                (theme::strong(15.0), theme::now().text)
            } else {
                (theme::regular(14.0), theme::now().text_weak)
            };
            let mark = if i < now { "(done)" } else { "" };
            let words = format!("{}. {} {mark}", i + 1, step.name);
            ui.label(RichText::new(words.trim_end()).font(font).color(colour)).on_hover_text(step.meaning);
            ui.add_space(10.0);
        }
    });
    ui.label(small(steps[now].meaning));
    ui.horizontal(|ui| {
        let size = vec2(96.0, 34.0);
        if ui.add_enabled(now > 0, Button::new(text::wizards::BACK).min_size(size)).clicked() {
            wish = Some(Wish::GoTo(now - 1));
        }
        let last = now + 1 == steps.len();
        let next = ui.add_enabled(!last && may_go_on.is_ok(), Button::new(text::wizards::NEXT).min_size(size));
        if next.clicked() {
            wish = Some(Wish::GoTo(now + 1));
        }
        if let (Err(reason), false) = (may_go_on, last) {
            next.on_disabled_hover_text(reason);
            ui.label(small(reason));
        }
        ui.add_space(24.0);
        if ui.button(text::wizards::START_OVER).on_hover_text(text::wizards::THROWS_AWAY_THE_DATA).clicked() {
            wish = Some(Wish::StartOver);
        }
    });
    wish
}

/// The last step of every wizard: what it will be bound to, and the button; true when it shall be saved. Without `proof` it takes
/// a name and a reason.
fn save_card(ui: &mut Ui, binding: &Binding, proof: Option<&str>, by: [&mut String; 2], saved: Option<&str>) -> bool {
    card(ui, text::wizards::SAVE, text::wizards::BOUND_TO_THIS_SENSOR, |ui| {
        figure(ui, text::wizards::SENSOR, &binding.sensor, text::wizards::SERIAL_NUMBER_OF_THE);
        figure(ui, text::wizards::TOOL, &binding.tool, text::wizards::WHAT_HANGS_ON_IT);
        let wanted = if let Some(proof) = proof {
            ui.label(proof);
            ui.add(Button::new(text::wizards::SAVE_AND_USE).min_size(vec2(180.0, 36.0))).clicked()
        } else {
            ui.label(weak(text::wizards::THIS_CALIBRATION_IS_NOT));
            override_ui(ui, by)
        };
        if let Some(saved) = saved {
            ui.label(saved);
        }
        wanted
    })
}

/// Name and reason of whoever overrides a verdict; true when both are there and it shall be done.
fn override_ui(ui: &mut Ui, by: [&mut String; 2]) -> bool {
    let mut named = true;
    for (label, text) in [text::wizards::YOUR_NAME, text::wizards::REASON].into_iter().zip(by) {
        ui.horizontal(|ui| {
            let label = ui.label(label);
            ui.add(TextEdit::singleline(text).desired_width(280.0).char_limit(120)).labelled_by(label.id);
        });
        named &= !text.trim().is_empty();
    }
    ui.add_enabled(named, Button::new(text::wizards::SAVE_IN_SPITE_OF).min_size(vec2(220.0, 36.0)))
        .on_disabled_hover_text(text::wizards::GIVE_A_NAME_AND)
        .clicked()
}
