//! The Technician view: every panel, in a layout that can be rearranged.

use egui::{Frame, Margin, Ui};
use nima_screen::{
    live::{LiveState, ScreenSource},
    outbox::Outbox,
    scene3d::scene_ui,
    widgets::weak,
};
use nima_wizards::active_calibrations::ActiveCalibrations;
use nima_words::text;

use super::{Panels, Wishes, acts};
use crate::{
    calibrations_ui, degrees_ui, devices, devices_ui, feedback_ui, force_space_ui, force_traces_ui, horizon_ui,
    link_ui, safety_ui,
    tiles::{Panel, PanelLayout},
    timing_ui,
};

pub(super) fn technician_ui(
    ui: &mut Ui,
    layout: &mut PanelLayout,
    live: &mut LiveState,
    panels: &mut Panels,
    active: &ActiveCalibrations,
    outbox: &mut Outbox,
) -> Wishes {
    let mut wishes = Wishes::default();
    let past = live.is_shown_only();
    let mut desk = std::mem::take(&mut panels.desk);
    desk.ui(ui, layout, &mut |ui, panel| match panel {
        Panel::Field => scene_ui(ui, live, &mut panels.scene, outbox),
        Panel::Traces => traces_ui(ui, live, panels),
        Panel::ForceSpace => {
            let Panels { forces, space, .. } = &mut *panels;
            force_space_ui(ui, live, forces.side(), space, forces.cursor_at_s(live));
        }
        Panel::Feedback => acts(ui, past, |ui| feedback_ui(ui, live, &mut panels.feedback, outbox)),
        Panel::Devices if past => devices_then_ui(ui, live),
        Panel::Devices => wishes.devices = devices_ui(ui, live, &mut panels.devices),
        Panel::Calibrations => {
            let back = text::calibrations::CLOSE_WIZARD;
            wishes.calibration = acts(ui, past, |ui| calibrations_ui(ui, live, active, None, back));
        }
        Panel::Safety => safety_ui(ui, live, &mut panels.safety),
        Panel::Horizon => horizon_ui(ui, live, outbox, false),
        Panel::Degrees => degrees_ui(ui, live, &mut panels.degrees),
        Panel::Timing => timing_ui(ui, live, &mut panels.timing),
        Panel::Link if past => {
            let elsewhere = live.of == ScreenSource::Elsewhere;
            ui.label(weak(if elsewhere { text::monitor::NO_LINK.get() } else { text::link::NOT_IN_SESSIONS.get() }));
        }
        Panel::Link => link_ui(ui, live),
        Panel::Tradeoff => {
            let tradeoff = panels.tradeoff.as_mut();
            wishes.restart = acts(ui, past, |ui| tradeoff.and_then(|panel| panel.ui(ui, live, outbox)));
        }
    });
    panels.desk = desk;
    wishes
}

/// Draws the devices of a recorded session or of another machine, and a note on data that are missing here.
fn devices_then_ui(ui: &mut Ui, live: &LiveState) {
    let elsewhere = live.of == ScreenSource::Elsewhere;
    Frame::new().inner_margin(Margin::same(8)).show(ui, |ui| {
        devices::wrap_to_visible(ui);
        if live.devices_then.is_empty() {
            ui.label(if elsewhere { text::monitor::SIMULATED.get() } else { text::playback::SIMULATED.get() });
        }
        for (name, standing) in &live.devices_then {
            ui.label(text::playback::device(*name, *standing));
        }
        ui.add_space(6.0);
        ui.label(weak(if elsewhere {
            text::monitor::NOT_OF_DEVICES.get()
        } else {
            text::playback::NOT_OF_DEVICES.get()
        }));
    });
}

/// Draws the traces, with space for the last number of the time axis, half of which is outside the plot.
fn traces_ui(ui: &mut Ui, live: &mut LiveState, panels: &mut Panels) {
    Frame::new().inner_margin(Margin { left: 8, right: 18, top: 6, bottom: 6 }).show(ui, |ui| {
        force_traces_ui(ui, live, &mut panels.forces, None);
    });
}
