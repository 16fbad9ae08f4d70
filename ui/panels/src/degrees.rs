//! The identified polynomial degrees: how often each is chosen, how they change over time, and how well the motion
//! determines them.

use egui::{Align2, Button, Label, Rect, Sense, Stroke, Ui, pos2, vec2};
use nima_core::impedance::Mode;
use nima_machine::messages::LoopState;
use nima_screen::{
    degree_record::{DEGREES_S, DegreeRule, POINT_S},
    exports,
    live::LiveState,
    rolling::DEGREES,
    theme,
    widgets::{figure, small},
};
use nima_words::{
    language::Text,
    report_text::{UNKNOWN, three_digits},
    text,
};

use crate::panel::{Panel, PanelContext, PanelSize};

const CHART_HEIGHT: f32 = 80.0;
const COURSE_HEIGHT: f32 = 44.0;
const AXES: [&str; 3] = ["x", "y", "z"];

/// The degrees on display.
#[derive(Clone, Copy, Debug, Default)]
pub struct DegreesState {
    /// One axis; `None` for all together.
    axis: Option<usize>,
    in_contact: bool,
    pub is_seen: bool,
}

impl DegreesState {
    /// Returns the rules on display, with their colours.
    fn rules(self) -> Vec<(DegreeRule, egui::Color32)> {
        let colours = theme::now();
        self.axis.map_or_else(
            || vec![(DegreeRule::Console, colours.rendered), (DegreeRule::Paper, colours.reference)],
            |axis| vec![(DegreeRule::Axis(axis), colours.reference)],
        )
    }
}

#[derive(Debug, Default)]
pub struct DegreesPanel;

impl Panel for DegreesPanel {
    const NAME: Text = text::degrees::NAME;
    const MEANING: Text = text::degrees::MEANING;
    const SIZE: PanelSize = PanelSize::FIGURES;

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        degrees_ui(ui, at.live, &mut at.panels.degrees);
    }
}

pub fn degrees_ui(ui: &mut Ui, live: &LiveState, state: &mut DegreesState) {
    state.is_seen = true;
    let compares = live.first_tick().is_some_and(|tick| tick.identification.modes.contains(Mode::Literal));
    ui.horizontal_wrapped(|ui| {
        for (rule, colour) in state.rules() {
            let [name, meaning] = key(rule);
            key_ui(ui, colour, name, meaning);
        }
        // Added as one piece, so that a long text moves to the next row as a whole.
        ui.add(Label::new(small(text::degrees::last_minutes(DEGREES_S / 60.0))).extend());
    });
    switches_ui(ui, live, state);
    chart_ui(ui, live, *state);
    course_ui(ui, live, *state);
    if !compares && !live.is_shown_only() && live.state() != LoopState::Engaged {
        ui.label(small(text::degrees::WAITS));
    }
    exports::report_ui(ui);
    if !live.is_shown_only() {
        cost_ui(ui, live);
    }
    let nonlinear = |rule| {
        let fractions = live.degrees.fractions(rule, state.in_contact);
        fractions.map_or_else(|| UNKNOWN.to_owned(), |fractions| format!("{:.0} %", 100.0 * fractions.nonlinear()))
    };
    let axes = [0, 1, 2].map(|axis| nonlinear(DegreeRule::Axis(axis)));
    for (name, value, meaning) in [
        (&text::degrees::NONLINEAR_OURS, nonlinear(DegreeRule::Console), &text::degrees::NONLINEAR_OURS_HOVER),
        (&text::degrees::NONLINEAR_PAPER, nonlinear(DegreeRule::Paper), &text::degrees::NONLINEAR_PAPER_HOVER),
        (&text::degrees::NONLINEAR_AXES, axes.join(" / "), &text::degrees::NONLINEAR_AXES_HOVER),
    ] {
        figure(ui, name.get(), value, meaning.get());
    }
    quality_ui(ui, live, compares);
}

const fn key_text(rule: DegreeRule) -> [&'static nima_words::language::Text; 2] {
    match rule {
        DegreeRule::Console => [&text::degrees::KEY_OURS, &text::degrees::KEY_OURS_HOVER],
        DegreeRule::Paper => [&text::degrees::KEY_PAPER, &text::degrees::KEY_PAPER_HOVER],
        DegreeRule::Axis(_) => [&text::degrees::KEY_PAPER, &text::degrees::NONLINEAR_AXES_HOVER],
    }
}

fn key(rule: DegreeRule) -> [&'static str; 2] {
    key_text(rule).map(|text| text.get())
}

/// Draws the choice of axis and ticks, and the export.
fn switches_ui(ui: &mut Ui, live: &LiveState, state: &mut DegreesState) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let all = (None, text::degrees::ALL_AXES.get(), text::degrees::ALL_AXES_HOVER.get().to_owned());
        let axes = (0..).zip(AXES).map(|(axis, name)| (Some(axis), name, text::degrees::axis_hover(name)));
        for (axis, name, meaning) in std::iter::once(all).chain(axes) {
            let button = Button::selectable(state.axis == axis, name).frame_when_inactive(true);
            if ui.add(button.min_size(vec2(28.0, 24.0))).on_hover_text(meaning).clicked() {
                state.axis = axis;
            }
        }
        ui.add_space(4.0);
        let contact = ui.checkbox(&mut state.in_contact, text::degrees::CONTACT);
        contact.on_hover_text(text::degrees::CONTACT_HOVER);
        let export = ui.add(Button::new(text::degrees::EXPORT).min_size(vec2(40.0, 24.0)));
        if export.on_hover_text(text::degrees::EXPORT_HOVER).clicked() {
            for (name, table) in tables(live, *state) {
                exports::save_csv(ui.ctx(), name, &table);
            }
        }
    });
}

fn column(rule: DegreeRule) -> &'static str {
    match rule {
        DegreeRule::Console => "console",
        DegreeRule::Paper => "paper",
        DegreeRule::Axis(axis) => AXES[axis],
    }
}

/// Returns what is on display as tables: the fraction of each degree, and the mean degree of each half second.
fn tables(live: &LiveState, state: DegreesState) -> [(&'static str, String); 2] {
    let rules = DegreeRule::ALL.map(|rule| (rule, live.degrees.fractions(rule, state.in_contact)));
    let names = |unit: &str| rules.map(|(rule, _)| format!("{}_{unit}", column(rule))).join(",");
    let mut fractions = format!("degree,{}\n", names("fraction"));
    for degree in 0..DEGREES {
        let of_rules = rules.map(|(_, of)| of.map(|of| of.fractions()[degree]));
        exports::row(&mut fractions, std::iter::once(Some(degree as f64)).chain(of_rules));
    }
    let courses = rules.map(|(rule, _)| live.degrees.course_of(rule, state.in_contact).collect::<Vec<_>>());
    let mut course = format!("time_s,{}\n", names("mean_degree"));
    for (t_s, _) in &courses[0] {
        let at = |of: &Vec<(f64, f64)>| {
            of.iter().find(|(at_s, _)| (at_s - t_s).abs() < 0.5 * POINT_S).map(|(_, degree)| *degree)
        };
        exports::row(&mut course, std::iter::once(Some(*t_s)).chain(courses.iter().map(at)));
    }
    [("degrees", fractions), ("degrees-over-time", course)]
}

fn quality_ui(ui: &mut Ui, live: &LiveState, compares: bool) {
    let Some(tick) = live.first_tick() else { return };
    let report = &tick.identification;
    let excitation = &report.excitation;
    let rank = text::degrees::columns(report.rank, 3 * live.rig.identification.max_degree, report.columns);
    let moves =
        format!("{:.1} mm   {:.0} mm/s", excitation.position_m.norm() * 1e3, excitation.velocity_m_s.norm() * 1e3);
    for (name, value, meaning) in [
        (&text::degrees::CONDITION, three_digits(report.condition), &text::degrees::CONDITION_HOVER),
        (&text::degrees::RANK, rank, &text::degrees::RANK_HOVER),
        (&text::degrees::EXCITATION, moves, &text::degrees::EXCITATION_HOVER),
    ] {
        figure(ui, name.get(), if compares { value } else { UNKNOWN.to_owned() }, meaning.get());
    }
}

/// Draws what it costs to compute this panel.
fn cost_ui(ui: &mut Ui, live: &LiveState) {
    let [whole, added] = live.compare_cost.us();
    let added = added.map_or_else(|| UNKNOWN.to_owned(), |us| format!("{us:+.1}"));
    let whole = whole.map_or_else(|| UNKNOWN.to_owned(), |us| format!("{us:.1}"));
    figure(ui, text::degrees::COST, text::degrees::cost(&added, &whole), text::degrees::COST_HOVER);
}

fn key_ui(ui: &mut Ui, colour: egui::Color32, name: &str, meaning: &str) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().rect_filled(rect, 2.0, colour);
    ui.label(small(name)).on_hover_text(meaning);
}

/// Draws bars for the degrees 0 to 5, one for each rule, with their percentages above.
fn chart_ui(ui: &mut Ui, live: &LiveState, state: DegreesState) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), CHART_HEIGHT + 20.0), Sense::hover());
    let known = state.rules().into_iter().filter_map(|(rule, colour)| {
        let fractions = live.degrees.fractions(rule, state.in_contact)?.fractions();
        Some((rule, colour, fractions))
    });
    let known: Vec<_> = known.collect();
    let lines: Vec<String> = known.iter().map(|(rule, _, fractions)| in_words(*rule, fractions)).collect();
    let words = text::degrees::chosen(&if lines.is_empty() { UNKNOWN.to_owned() } else { lines.join("\n") });
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &words));
    response.on_hover_text(&words);
    let painter = ui.painter();
    let ground = Rect::from_min_size(rect.min, vec2(rect.width(), CHART_HEIGHT));
    painter.rect_filled(ground, 3.0, theme::now().groove);
    let cell = ground.width() / DEGREES as f32;
    let width = 0.32 * cell;
    let weak = theme::now().text_weak;
    for degree in 0..DEGREES {
        let middle = ground.left() + (degree as f32 + 0.5) * cell;
        for (place, (_, colour, fractions)) in known.iter().enumerate() {
            let left = middle - 0.5 * (width + 2.0) * state.rules().len() as f32 + (width + 2.0) * place as f32;
            let fraction = fractions[degree];
            let height = (CHART_HEIGHT - 18.0) * fraction as f32;
            let top = pos2(left, ground.bottom() - height.max(1.0));
            painter.rect_filled(Rect::from_min_max(top, pos2(left + width, ground.bottom())), 1.0, *colour);
            if fraction >= 0.005 {
                let at = pos2(left + 0.5 * width, ground.bottom() - height - 8.0);
                let percent = format!("{:.0}", 100.0 * fraction);
                painter.text(at, Align2::CENTER_CENTER, percent, theme::regular(11.0), weak);
            }
        }
        let name = if degree == 0 { text::degrees::NONE.get().to_owned() } else { degree.to_string() };
        let at = pos2(middle, ground.bottom() + 10.0);
        painter.text(at, Align2::CENTER_CENTER, name, theme::regular(12.5), weak);
    }
}

fn in_words(rule: DegreeRule, fractions: &[f64; DEGREES]) -> String {
    let each = fractions.iter().enumerate().map(|(n, fraction)| format!("{n}: {:.0} %", 100.0 * fraction));
    format!("{}  {}", key(rule)[0], each.collect::<Vec<_>>().join("   "))
}

/// Draws the mean degree of each half second of the last minutes.
fn course_ui(ui: &mut Ui, live: &LiveState, state: DegreesState) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), COURSE_HEIGHT), Sense::hover());
    let courses = state.rules().into_iter().map(|(rule, colour)| {
        let course: Vec<(f64, f64)> = live.degrees.course_of(rule, state.in_contact).collect();
        (rule, colour, course)
    });
    let courses: Vec<_> = courses.collect();
    let last = courses.iter().map(|(rule, _, course)| {
        let degree = course.last().map_or_else(|| UNKNOWN.to_owned(), |(_, degree)| format!("{degree:.1}"));
        format!("{} {degree}", key(*rule)[0])
    });
    let words = text::degrees::over_time(&last.collect::<Vec<_>>().join(", "));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &words));
    response.on_hover_text(&words);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, theme::now().groove);
    let now_s = live.first_tick().map_or(0.0, |tick| tick.t_s);
    let inner = rect.shrink2(vec2(0.0, 5.0));
    let place = |(t_s, degree): &(f64, f64)| {
        let x = inner.right() - ((now_s - t_s) / DEGREES_S) as f32 * inner.width();
        pos2(x, inner.bottom() - (*degree / (DEGREES - 1) as f64) as f32 * inner.height())
    };
    for (_, colour, course) in courses.iter().rev() {
        for run in course.chunk_by(|before, after| after.0 - before.0 < 1.5 * POINT_S) {
            match run {
                [alone] => drop(painter.circle_filled(place(alone), 1.5, *colour)),
                run => drop(painter.line(run.iter().map(place).collect(), Stroke::new(1.5, *colour))),
            }
        }
    }
    let weak = theme::now().text_weak;
    for (degree, at, align) in [
        (DEGREES - 1, rect.left_top() + vec2(4.0, 1.0), Align2::LEFT_TOP),
        (0, rect.left_bottom() + vec2(4.0, -1.0), Align2::LEFT_BOTTOM),
    ] {
        painter.text(at, align, degree, theme::regular(11.0), weak);
    }
}
