//! Every instrument: knobs and gates on the left, figures on the right, the field and the traces between them.

use egui::{Button, CentralPanel, Frame, Margin, Panel, ScrollArea, Ui, vec2};

use super::{Panels, Tab, Wishes};
use crate::console::{
    in_force::InForce,
    live::Live,
    outbox::Outbox,
    panels::{
        calibrations_ui, degrees_ui, devices_ui, feedback_ui, force_space_ui, forces_ui, gates_ui, horizon_ui,
        safety_ui, timing_ui, tradeoff_ui,
    },
    scene3d::scene_ui,
    theme,
};

/// Width of the force space.
const FORCE_SPACE: f32 = 300.0;

/// The view.
pub(super) fn technician_ui(
    ui: &mut Ui,
    tab: &mut Tab,
    live: &mut Live,
    panels: &mut Panels,
    in_force: &InForce,
    outbox: &mut Outbox,
) -> Wishes {
    let mut wishes = Wishes::default();
    let side = Frame::new().fill(theme::now().panel).inner_margin(Margin::same(8));
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
        let traces = (0.47 * ui.available_height()).clamp(262.0, 492.0);
        let frame = Frame::new().inner_margin(Margin::symmetric(12, 8));
        Panel::bottom("forces").exact_size(traces).resizable(false).frame(frame).show(ui, |ui| {
            tabs_ui(ui, tab);
            match *tab {
                Tab::Traces => traces_ui(ui, live, panels),
                Tab::Safety => safety_ui(ui, live),
            }
        });
        scene_ui(ui, live, &mut panels.scene, outbox);
    });
    wishes
}

/// What is shown under the field.
fn tabs_ui(ui: &mut Ui, now: &mut Tab) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for tab in Tab::ALL {
            let button =
                Button::selectable(*now == tab, tab.name()).frame_when_inactive(true).min_size(vec2(84.0, 26.0));
            if ui.add(button).on_hover_text(tab.meaning()).clicked() {
                *now = tab;
            }
        }
    });
    ui.add_space(2.0);
}

/// Forces over time, and beside them in force space where there is room.
fn traces_ui(ui: &mut Ui, live: &mut Live, panels: &mut Panels) {
    if ui.available_width() > 720.0 {
        Panel::right("force_space").exact_size(FORCE_SPACE).resizable(false).frame(Frame::new()).show(ui, |ui| {
            let Panels { forces, space, .. } = panels;
            force_space_ui(ui, live, forces.side(), space, forces.cursor_at_s(live));
        });
    }
    // The last number of the time axis stands half beyond the plot.
    let frame = Frame::new().inner_margin(Margin { right: 12, ..Margin::ZERO });
    CentralPanel::default().frame(frame).show(ui, |ui| forces_ui(ui, live, &mut panels.forces, &[0, 1, 2]));
}
