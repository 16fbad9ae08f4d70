//! The Technician view: every panel, in a layout that can be rearranged.

use egui::Ui;

use crate::{panel::PanelContext, tiles::PanelLayout};

pub(super) fn technician_ui(ui: &mut Ui, layout: &mut PanelLayout, at: &mut PanelContext<'_>) {
    let mut desk = std::mem::take(&mut at.panels.desk);
    let mut all = std::mem::take(&mut at.panels.all);
    desk.ui(ui, layout, &mut |ui, panel| all.ui(ui, panel, at));
    at.panels.desk = desk;
    at.panels.all = all;
}
