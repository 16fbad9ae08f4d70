//! The Field panel: the operating field in three dimensions.

use egui::Ui;
use nima_screen::scene3d::scene_ui;
use nima_words::{language::Text, text};

use crate::panel::{Panel, PanelContext, PanelSize};

#[derive(Debug, Default)]
pub(crate) struct FieldPanel;

impl Panel for FieldPanel {
    const NAME: Text = text::field::NAME;
    const MEANING: Text = text::field::MEANING;
    const SIZE: PanelSize = PanelSize::filling([160.0, 120.0]);

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        // The camera can be turned during playback, but while a page is using the machine, mouse control is disabled
        // too.
        ui.add_enabled_ui(!at.is_locked, |ui| scene_ui(ui, at.live, &mut at.panels.scene, at.outbox));
    }
}
