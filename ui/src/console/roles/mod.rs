//! Three people, three views on the same loop: a calm monitor for the surgeon, every instrument for the technician, and a
//! demonstration that runs by itself for the presenter. A role changes what is shown and never what the loop does; the one
//! exception is the demonstration's script, which plays on simulated rigs only and puts back what it found.

pub mod demo;
mod surgeon;
mod technician;

use egui::{Button, Key, Ui, vec2};
use nima_machine::config::RigConfig;
use serde::{Deserialize, Serialize};

pub use demo::DemoState;

use super::{
    desk::Desk,
    in_force::InForce,
    live::Live,
    outbox::Outbox,
    panels::{CalibrationWish, FeedbackState, ForceSpaceState, ForcesState, GatesState, TimingState, TradeoffState},
    scene3d::{Look, SceneView},
    settings::Settings,
};
use crate::console::text;

/// Who sits before the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The scene as the endoscope sees it, large; six figures; alarms.
    Surgeon,
    /// Every panel.
    #[default]
    Technician,
    /// A demonstration that runs by itself.
    Demo,
}

impl Role {
    /// In the order of their keys.
    pub const ALL: [Self; 3] = [Self::Surgeon, Self::Technician, Self::Demo];

    /// On its button.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Surgeon => text::roles::SURGEON,
            Self::Technician => text::roles::TECHNICIAN,
            Self::Demo => text::roles::DEMO,
        }
    }

    /// The key that leads there.
    pub const fn key(self) -> Key {
        match self {
            Self::Surgeon => Key::F1,
            Self::Technician => Key::F2,
            Self::Demo => Key::F3,
        }
    }

    /// What it shows.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Surgeon => text::roles::SURGEON_HOVER,
            Self::Technician => text::roles::TECHNICIAN_HOVER,
            Self::Demo => text::roles::DEMO_HOVER,
        }
    }
}

/// What the panels of all roles remember between frames.
#[derive(Debug, Default)]
pub struct Panels {
    /// Mode, gain, delay.
    pub feedback: FeedbackState,
    /// Traces.
    pub forces: ForcesState,
    /// Force space.
    pub space: ForceSpaceState,
    /// Speed against accuracy.
    pub tradeoff: TradeoffState,
    /// The operating field.
    pub scene: SceneView,
    /// Whose gates are told.
    pub gates: GatesState,
    /// Histograms of the loop's durations.
    pub timing: TimingState,
    /// The technician's tiles.
    pub desk: Desk,
    /// Where the demonstration is.
    pub demo: DemoState,
}

/// What the operator asked for that the panels cannot do by a command.
#[derive(Debug, Default)]
pub struct Wishes {
    /// Another rig.
    pub restart: Option<RigConfig>,
    /// A wizard.
    pub calibration: Option<CalibrationWish>,
}

/// The view of the role in force, under the top bar.
pub fn role_ui(
    ui: &mut Ui,
    settings: &mut Settings,
    live: &mut Live,
    panels: &mut Panels,
    in_force: &InForce,
    outbox: &mut Outbox,
) -> Wishes {
    let role = settings.role;
    panels.scene.look = if role == Role::Surgeon { Look::Endoscope } else { Look::Free };
    panels.scene.figures = role != Role::Surgeon;
    if role != Role::Demo {
        panels.demo.leave(outbox);
    }
    match role {
        Role::Surgeon => {
            surgeon::surgeon_ui(ui, live, panels, outbox);
            Wishes::default()
        }
        Role::Technician => technician::technician_ui(ui, &mut settings.layout, live, panels, in_force, outbox),
        Role::Demo => {
            demo::demo_ui(ui, live, panels, outbox);
            Wishes::default()
        }
    }
}

/// One click for each role.
pub fn switch_ui(ui: &mut Ui, now: &mut Role, allowed: bool) {
    ui.spacing_mut().item_spacing.x = 4.0;
    for role in Role::ALL {
        let button = Button::selectable(*now == role, role.name()).frame_when_inactive(true).min_size(vec2(62.0, 30.0));
        let response = ui.add_enabled(allowed, button);
        let response = response.on_hover_text(text::roles::meaning_and_key(role.meaning(), role.key().name()));
        if response.on_disabled_hover_text(text::roles::SWITCH_DISABLED_HOVER).clicked() {
            *now = role;
        }
    }
}
