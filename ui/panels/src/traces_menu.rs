//! The menus of the traces: choice of signals; copy, export and cursors.

use egui::{Button, Ui, vec2};
use nima_screen::{
    exports,
    history::SignalHistory,
    live::LiveState,
    signals::{TraceLine, TracePlot},
    units::{ForceUnit, LengthUnit, PlotUnits},
};
use nima_words::{
    language::{self, Language},
    text,
};

use super::{traces_plot::with_unit, traces_state::TracesState};

/// Draws a switch for each plot, and the choice of units.
pub(super) fn signals_ui(ui: &mut Ui, state: &mut TracesState) {
    let units = PlotUnits::of(ui.ctx());
    for plot in state.offered.plots() {
        let mut shown = state.plots.contains(plot);
        if ui.checkbox(&mut shown, text::traces::plot_entry(plot.name().get(), units.of_plot(plot).name)).changed() {
            state.plots = state.plots.toggled(plot);
        }
    }
    ui.separator();
    units_ui(ui);
}

fn units_ui(ui: &mut Ui) {
    let before = PlotUnits::of(ui.ctx());
    let mut units = before;
    ui.label(text::traces::UNITS).on_hover_text(text::traces::UNITS_HOVER);
    ui.horizontal(|ui| {
        for force in ForceUnit::ALL {
            ui.selectable_value(&mut units.force, force, force.name());
        }
        ui.separator();
        for length in LengthUnit::ALL {
            ui.selectable_value(&mut units.length, length, length.name());
        }
    });
    if units != before {
        units.choose(ui.ctx());
    }
}

/// Draws the menu of the right mouse button.
pub(super) fn menu_ui(ui: &mut Ui, live: &LiveState, state: &mut TracesState, plots: &[TracePlot], max: usize) {
    let entry = |ui: &mut Ui, name: &str| {
        let clicked = ui.add(Button::new(name).min_size(vec2(200.0, 26.0))).clicked();
        if clicked {
            ui.close();
        }
        clicked
    };
    for (cursor, name) in [&text::traces::CURSOR_1_HERE, &text::traces::CURSOR_2_HERE].into_iter().enumerate() {
        if entry(ui, name.get()) {
            state.cursors_s[cursor] = Some(state.menu_s);
        }
    }
    if entry(ui, text::traces::COPY.get()) {
        ui.ctx().copy_text(values(live, state, plots, PlotUnits::of(ui.ctx())));
    }
    if entry(ui, text::traces::SAVE_CSV.get()) {
        let table = language::with(Language::English, || table(state.history(live), state, plots, max));
        exports::save_csv(ui.ctx(), "traces", &table);
    }
    if entry(ui, text::traces::SAVE_PNG.get()) {
        state.want_png();
    }
    if entry(ui, text::traces::RESET.get()) {
        state.reset();
    }
}

fn lines_of(state: &TracesState, plots: &[TracePlot]) -> Vec<(TracePlot, &'static TraceLine)> {
    let all = plots.iter().flat_map(|plot| plot.lines().iter().map(|line| (*plot, line)));
    all.filter(|(_, line)| !state.is_hidden(line.channel)).collect()
}

/// Returns the values of the visible lines at the cursors, or where the menu was opened: a line of text for each, columns
/// separated by tabs.
fn values(live: &LiveState, state: &TracesState, plots: &[TracePlot], units: PlotUnits) -> String {
    let history = state.history(live);
    let cursors_s: Vec<f64> = state.cursors_s.into_iter().flatten().collect();
    let times_s = if cursors_s.is_empty() { vec![state.menu_s] } else { cursors_s };
    let row = |name: String, cells: &dyn Fn(f64) -> String| {
        let cells = times_s.iter().map(|t_s| cells(*t_s));
        std::iter::once(name).chain(cells).collect::<Vec<_>>().join("\t") + "\n"
    };
    let lines = lines_of(state, plots).into_iter().map(|(plot, line)| {
        let value = |t_s| with_unit(history.value_at(line.channel, t_s), units.of_plot(plot));
        row(format!("{} {}", plot.symbol(), line.name.get()), &value)
    });
    let head = row(text::traces::TIME.get().to_owned(), &|t_s| format!("{t_s:.3} s"));
    std::iter::once(head).chain(lines).collect()
}

/// Returns the visible lines between the ends of the time axis as a table: lowest and highest value of each column.
fn table(history: &SignalHistory, state: &TracesState, plots: &[TracePlot], max: usize) -> String {
    let lines = lines_of(state, plots);
    let names = lines.iter().map(|(plot, line)| {
        let unit = if plot.unit().is_empty() { String::new() } else { format!("_{}", plot.unit()) };
        let name = format!("{}_{}{unit}", plot.symbol(), line.name.get()).replace(' ', "_");
        ["min", "max"].map(|end| format!("{name}_{end}")).join(",")
    });
    let mut table = format!("time_s,{}\n", names.collect::<Vec<_>>().join(","));
    let channels: Vec<usize> = lines.iter().map(|(_, line)| line.channel).collect();
    let now_s = state.now_s(history);
    for (t_s, values) in history.table(&channels, (now_s + state.view_s.0, now_s + state.view_s.1), max) {
        let ends = values.into_iter().flat_map(|ends| {
            let (low, high) = ends.unzip();
            [low.map(f64::from), high.map(f64::from)]
        });
        exports::row(&mut table, std::iter::once(Some(t_s)).chain(ends));
    }
    table
}

#[cfg(test)]
mod tests {
    use nima_machine::rig::Side;

    use super::*;
    use nima_screen::history::CHANNELS;

    #[test]
    fn a_table_has_what_is_shown() {
        let plan = nima_tests::plan("peg_transfer");
        let mut live = LiveState::new(plan.rig, plan.scene);
        for number in 0..12_000_u32 {
            let mut values = [f32::NAN; CHANNELS];
            values[2] = number as f32;
            live.history[Side::Right.index()].push(f64::from(number) * 1e-3, &values);
        }
        let mut state = TracesState::default();
        state.show_last(2.0);
        let rows = |state: &TracesState, plots: &[TracePlot]| table(state.history(&live), state, plots, 10_000);
        let all = rows(&state, &[TracePlot::ForceZ]);
        let mut lines = all.lines();
        assert_eq!(lines.next(), Some("time_s,z_rendered_N_min,z_rendered_N_max,z_measured_N_min,z_measured_N_max"));
        let first: Vec<&str> = lines.next().unwrap().split(',').collect();
        assert_eq!(
            first.iter().map(|cell| cell.parse::<f64>().ok()).collect::<Vec<_>>()[1..],
            [None, None, Some(9996.0), Some(9999.0)]
        );
        assert!((495..=501).contains(&lines.count()));
        state.toggle(&[5]);
        assert!(rows(&state, &[TracePlot::ForceZ]).starts_with("time_s,z_measured_N_min,z_measured_N_max\n"));
        state.cursors_s = [Some(10.0), Some(11.0)];
        let copied = |units| values(&live, &state, &[TracePlot::ForceZ], units);
        let plain = PlotUnits::default();
        assert_eq!(copied(plain), "time\t10.000 s\t11.000 s\nz measured\t+10001.50 N\t+11001.50 N\n");
        let small = PlotUnits { force: ForceUnit::Millinewton, ..plain };
        assert_eq!(copied(small), "time\t10.000 s\t11.000 s\nz measured\t+10001500 mN\t+11001500 mN\n");
    }
}
