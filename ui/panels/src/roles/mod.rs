//! Three views of the same loop: a simple monitor for the surgeon, every panel for the technician, and an automatic
//! demonstration. A role changes the display, never the loop. The one exception is the script of the demonstration, which
//! runs only on simulated rigs and restores the settings.

pub mod demo;
mod surgeon;
mod technician;

use egui::{Button, InnerResponse, Key, TextStyle, Ui, WidgetInfo, vec2};
use egui_material_icons::icons;
use nima_machine::config::RigConfig;
use nima_screen::{
    live::LiveState,
    outbox::Outbox,
    scene3d::{CameraLook, SceneView},
    theme::Icon,
    widgets::with_icon,
};
use nima_wizards::active_calibrations::ActiveCalibrations;
use nima_words::text;
use serde::{Deserialize, Serialize};

pub use demo::DemoState;

use crate::PanelExtras;
use crate::{
    CalibrationWish, DegreesState, DevicesState, FeedbackState, ForceSpaceState, Tile, TracesState,
    devices::RigEdit,
    endoscope_view::EndoscopeView,
    panel::{PanelContext, PanelSet},
    settings::ConsoleSettings,
    tiles::PanelTiles,
};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The field as seen by the endoscope, large; six numbers; alarms.
    Surgeon,
    /// Every panel.
    #[default]
    Technician,
    /// An automatic demonstration.
    Demo,
}

impl Role {
    /// All roles, in the order of their keys.
    pub const ALL: [Self; 3] = [Self::Surgeon, Self::Technician, Self::Demo];

    pub fn name(self) -> &'static str {
        match self {
            Self::Surgeon => text::roles::SURGEON.get(),
            Self::Technician => text::roles::TECHNICIAN.get(),
            Self::Demo => text::roles::DEMO.get(),
        }
    }

    pub const fn key(self) -> Key {
        match self {
            Self::Surgeon => Key::F1,
            Self::Technician => Key::F2,
            Self::Demo => Key::F3,
        }
    }

    const fn icon(self) -> Icon {
        match self {
            Self::Surgeon => icons::ICON_MEDICAL_SERVICES,
            Self::Technician => icons::ICON_BUILD,
            Self::Demo => icons::ICON_SLIDESHOW,
        }
    }

    pub fn meaning(self) -> &'static str {
        match self {
            Self::Surgeon => text::roles::SURGEON_HOVER.get(),
            Self::Technician => text::roles::TECHNICIAN_HOVER.get(),
            Self::Demo => text::roles::DEMO_HOVER.get(),
        }
    }
}

/// State of the panels of all roles.
#[derive(Debug)]
pub struct Panels {
    pub feedback: FeedbackState,
    pub forces: TracesState,
    pub space: ForceSpaceState,
    /// The Trade-off panel, in a build that has it.
    pub tradeoff: Option<Box<dyn Tile>>,
    pub scene: SceneView,
    pub eyes: EndoscopeView,
    pub devices: DevicesState,
    pub degrees: DegreesState,
    /// The panels, with the state that only they use.
    pub all: PanelSet,
    pub desk: PanelTiles,
    pub demo: DemoState,
}

impl Default for Panels {
    fn default() -> Self {
        Self {
            tradeoff: PanelExtras::offered().tradeoff.map(|panel| panel()),
            feedback: FeedbackState::default(),
            forces: TracesState::default(),
            space: ForceSpaceState::default(),
            scene: SceneView::default(),
            eyes: EndoscopeView::default(),
            devices: DevicesState::default(),
            degrees: DegreesState::default(),
            all: PanelSet::default(),
            desk: PanelTiles::default(),
            demo: DemoState::default(),
        }
    }
}

/// Requests of the operator that are not commands to the loop.
#[derive(Debug, Default)]
pub struct Wishes {
    pub restart: Option<RigConfig>,
    pub calibration: Option<CalibrationWish>,
    pub devices: Option<RigEdit>,
}

/// Draws the view of the current role, below the top bar.
pub fn role_ui(
    ui: &mut Ui,
    settings: &mut ConsoleSettings,
    live: &mut LiveState,
    panels: &mut Panels,
    active: &ActiveCalibrations,
    outbox: &mut Outbox,
) -> Wishes {
    let role = settings.role;
    panels.scene.look = if role == Role::Surgeon { CameraLook::Endoscope } else { CameraLook::Free };
    panels.scene.figures = role != Role::Surgeon;
    if role != Role::Demo {
        panels.demo.leave(outbox);
    }
    match role {
        Role::Surgeon => {
            surgeon::surgeon_ui(ui, live, panels, outbox);
            Wishes::default()
        }
        Role::Technician => {
            let mut wishes = Wishes::default();
            let mut at = PanelContext { live, panels, active, outbox, wishes: &mut wishes, is_locked: false };
            technician::technician_ui(ui, &mut settings.layout, &mut at);
            wishes
        }
        Role::Demo => {
            demo::demo_ui(ui, live, panels, outbox);
            Wishes::default()
        }
    }
}

/// Draws controls that act on the machine: disabled, with the reason on hover, if nothing may act on it.
fn acts<R>(ui: &mut Ui, live: &LiveState, controls: impl FnOnce(&mut Ui) -> R) -> R {
    let InnerResponse { inner, response } = ui.add_enabled_ui(!live.is_shown_only(), controls);
    response.on_disabled_hover_text(live.of.blocked());
    inner
}

/// Draws one button for each of these roles; returns the pressed one, also if it is the present one: it then leads back to
/// its view.
pub fn switch_ui(ui: &mut Ui, roles: &[Role], now: Role, allowed: bool) -> Option<Role> {
    let mut pressed = None;
    ui.spacing_mut().item_spacing.x = 4.0;
    for &role in roles {
        let words = with_icon(ui, role.icon(), role.name(), TextStyle::Button.resolve(ui.style()));
        let button = Button::selectable(now == role, words).frame_when_inactive(true).min_size(vec2(62.0, 30.0));
        let response = ui.add_enabled(allowed, button);
        let chosen = now == role;
        response.widget_info(|| WidgetInfo::selected(egui::Role::Button, allowed, chosen, role.name()));
        let response = response.on_hover_text(text::roles::meaning_and_key(role.meaning(), role.key().name()));
        if response.on_disabled_hover_text(text::roles::SWITCH_DISABLED_HOVER).clicked() {
            pressed = Some(role);
        }
    }
    pressed
}
