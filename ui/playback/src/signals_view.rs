//! The view of another program's recording: only its signals are known, so only these are shown.

use egui::{Frame, Label, Margin, RichText, Ui};
use nima_machine::rig::Side;
use nima_panels::{TracesState, force_traces_ui};
use nima_recording::csv::{AXIS_NAMES, Signals};
use nima_screen::{
    signals::{PlotSet, TracePlot},
    theme,
    units::{DisplayUnit, PlotUnits},
};
use nima_words::{report_text::UNKNOWN, text};

use super::{Playback, session_index::TRACES_S};

/// Chooses the plots of the signals that are known at some time, and as much of the recording as the traces keep.
pub(super) fn choose(signals: &Signals, traces: &mut TracesState) {
    let [forces, positions] = [signals.force_axes(), signals.position_axes()];
    let of_force = TracePlot::FORCES.into_iter().zip(forces).filter(|(_, known)| *known).map(|(plot, _)| plot);
    let all = |axes: [bool; 3], plot| axes.into_iter().all(|known| known).then_some(plot);
    let position = positions.contains(&true).then_some(TracePlot::Position);
    let derived = [all(forces, TracePlot::Magnitude), position, all(positions, TracePlot::Speed)];
    let offered: PlotSet = of_force.chain(derived.into_iter().flatten()).collect();
    traces.offer(offered);
    traces.show_last(signals.end_s().min(TRACES_S));
}

/// Returns which signals are known.
pub(super) fn known(signals: &Signals) -> String {
    let axes = |known: [bool; 3]| {
        let names = AXIS_NAMES.into_iter().zip(known).filter(|(_, known)| *known).map(|(name, _)| name);
        names.collect::<Vec<_>>().join(", ")
    };
    text::playback::known_signals(&axes(signals.force_axes()), &axes(signals.position_axes()))
}

/// Draws the values at the moment on the screen, and the traces up to it.
pub fn signals_ui(ui: &mut Ui, past: &mut Playback) {
    let Some(live) = &mut past.live else { return };
    let Some(tick) = live.tick_of(Side::Right) else { return };
    let units = PlotUnits::of(ui.ctx());
    let force = values(tick.measured_n.as_slice(), 1.0, units.of_plot(TracePlot::ForceX));
    let position = values(tick.positions.tip_m.as_slice(), 1e3, units.of_plot(TracePlot::Position));
    let words = text::playback::values_now(&force, &position);
    Frame::new().inner_margin(Margin { left: 8, right: 18, top: 6, bottom: 6 }).show(ui, |ui| {
        ui.add(Label::new(RichText::new(words).font(theme::strong(15.0))).truncate());
        force_traces_ui(ui, live, &mut past.panels.forces, None);
    });
}

/// Returns the values along x, y, z, in the unit of a plot after this factor.
fn values(of: &[f64], factor: f64, unit: DisplayUnit) -> String {
    let value = |value: f64| {
        let DisplayUnit { name, factor: of_unit, decimals } = unit;
        let known = value.is_finite().then(|| format!("{:.decimals$} {name}", value * factor * of_unit));
        known.unwrap_or_else(|| UNKNOWN.to_owned())
    };
    let named = AXIS_NAMES.into_iter().zip(of).map(|(name, along)| format!("{name} {}", value(*along)));
    named.collect::<Vec<_>>().join("   ")
}
