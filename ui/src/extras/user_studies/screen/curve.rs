//! Learning of a participant: the times of the completed trials in order. Marked as practice or not, never by condition.

use egui::{Label, Ui};
use egui_plot::{AxisHints, Line, MarkerShape, Plot, PlotBounds, PlotPoints, Points};
use nima_screen::{
    theme,
    widgets::{small, still, weak},
};
use nima_user_study::LearningModel;

use crate::extras::user_studies::text;

const HEIGHT: f32 = 190.0;

pub(super) fn curve_ui(ui: &mut Ui, learning: Option<&LearningModel>) {
    let Some(learning) = learning.filter(|learning| learning.times_s.iter().any(Option::is_some)) else {
        ui.label(weak(text::studies::NO_TIMES));
        return;
    };
    let places = |wanted: bool| -> Vec<[f64; 2]> {
        let numbered = (1_u32..).zip(&learning.times_s);
        let of = numbered.filter(|(number, _)| (*number <= learning.practice) == wanted);
        of.filter_map(|(number, time_s)| Some([f64::from(number), (*time_s)?])).collect()
    };
    let [practice, trials] = [true, false].map(places);
    let described = text::studies::curve(&learning.participant, practice.len(), trials.len());
    let count = learning.times_s.len() as f64;
    let max_s = practice.iter().chain(&trials).map(|place| place[1]).fold(1.0, f64::max);
    let curve = learning.curve.as_ref().map(|curve| {
        let numbers = 1..=learning.times_s.len() as u32;
        numbers.map(|number| [f64::from(number), curve.time_s(number)]).collect::<Vec<_>>()
    });
    let plot = still(Plot::new("learning"))
        .height(HEIGHT)
        .custom_x_axes(vec![AxisHints::new_x().label(text::studies::TRIAL_AXIS)])
        .custom_y_axes(vec![AxisHints::new_y().label(text::studies::TIME_AXIS).min_thickness(48.0)]);
    let response = plot.show(ui, |plot| {
        plot.set_plot_bounds(PlotBounds::from_min_max([0.0, 0.0], [count + 1.0, 1.15 * max_s]));
        if let Some(curve) = curve {
            let line = Line::new("curve", PlotPoints::from(curve)).color(theme::now().text_weak).width(1.2);
            plot.line(line.allow_hover(false));
        }
        for (name, places, filled) in [("practice", practice, false), ("trials", trials, true)] {
            let marks = Points::new(name, PlotPoints::from(places)).shape(MarkerShape::Circle).filled(filled);
            plot.points(marks.radius(4.5).color(theme::now().text).allow_hover(false));
        }
    });
    ui.add(Label::new(small(text::studies::curve_marks(learning.curve.as_ref()))).wrap());
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, described.clone()));
}
