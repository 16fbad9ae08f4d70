//! Every instrument: knobs and gates on the left, figures on the right, the field and the traces between them.

use egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, Ui};

use super::{Panels, Wishes};
use crate::console::{
    in_force::InForce,
    live::Live,
    outbox::Outbox,
    panels::{
        calibrations_ui, degrees_ui, devices_ui, feedback_ui, forces_ui, gates_ui, horizon_ui, timing_ui, tradeoff_ui,
    },
    scene3d::scene_ui,
    theme,
};

/// The view.
pub(super) fn technician_ui(
    ui: &mut Ui,
    live: &mut Live,
    panels: &mut Panels,
    in_force: &InForce,
    outbox: &mut Outbox,
) -> Wishes {
    let mut wishes = Wishes::default();
    let side = Frame::new().fill(theme::PANEL).inner_margin(Margin::same(8));
    Panel::left("feedback").exact_size(316.0).resizable(false).frame(side).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            feedback_ui(ui, live, &mut panels.feedback, outbox);
            devices_ui(ui, live);
            wishes.calibration = calibrations_ui(ui, live, in_force, None);
            gates_ui(ui, live);
        });
    });
    Panel::right("figures").exact_size(348.0).resizable(false).frame(side).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            horizon_ui(ui, live);
            degrees_ui(ui, live);
            timing_ui(ui, live);
            wishes.restart = tradeoff_ui(ui, live, &mut panels.tradeoff, outbox);
        });
    });
    CentralPanel::no_frame().show(ui, |ui| {
        let traces = (0.44 * ui.available_height()).clamp(230.0, 460.0);
        let frame = Frame::new().inner_margin(Margin::symmetric(12, 8));
        Panel::bottom("forces").exact_size(traces).resizable(false).frame(frame).show(ui, |ui| {
            forces_ui(ui, live, &mut panels.forces, &[0, 1, 2]);
        });
        scene_ui(ui, live, &mut panels.scene, outbox);
    });
    wishes
}
