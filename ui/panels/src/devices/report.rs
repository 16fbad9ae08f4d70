//! Result of a device test: a verdict, problems with remedies, and the measurements.

use egui::{Grid, Label, RichText, Ui};
use nalgebra::Vector3;
use nima_machine::rig::{
    PartKind,
    checkup::{Checkup, CheckupNumber},
};
use nima_screen::{
    theme,
    widgets::{Sign, sign_ui, small},
};
use nima_words::{
    report_text::{channel_group, finding_text, three_digits},
    text::{self, checkup as words},
};

pub(super) fn report_ui(ui: &mut Ui, checkup: &Checkup) {
    ui.scope(|ui| result_ui(ui, checkup));
}

fn result_ui(ui: &mut Ui, checkup: &Checkup) {
    let fine = checkup.findings.is_empty();
    let (what, colour, verdict) = if fine {
        (Sign::Disc, theme::now().engaged, text::devices::FINE.get())
    } else {
        (Sign::Triangle, theme::now().alarm_medium, text::devices::LOOK_AT.get())
    };
    ui.horizontal(|ui| {
        sign_ui(ui, what, 5.0, colour);
        ui.label(RichText::new(verdict).font(theme::strong(14.0)));
    });
    for finding in &checkup.findings {
        let [cause, cure] = finding_text(checkup.part.kind(), finding);
        ui.add(Label::new(cause).wrap());
        ui.add(Label::new(small(cure)).wrap());
    }
    // The rows are only text, so they need not be as high as buttons.
    ui.spacing_mut().interact_size.y = 0.0;
    Grid::new(("checkup", checkup.part)).num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
        for (name, value, meaning) in figures(checkup) {
            ui.label(small(name)).on_hover_text(meaning);
            ui.add(Label::new(RichText::new(value).text_style(egui::TextStyle::Small)).wrap()).on_hover_text(meaning);
            ui.end_row();
        }
    });
}

type ConsoleFigure = (String, String, &'static str);

fn figures(checkup: &Checkup) -> Vec<ConsoleFigure> {
    let Checkup { rate_hz, nominal_hz, age_s, lost, damaged, refused, .. } = *checkup;
    let named = |name: &str, value: String, meaning| (name.to_owned(), value, meaning);
    let mut figures = Vec::new();
    if checkup.part.kind() != PartKind::Pedal {
        figures.push(named(words::RATE.get(), words::rate(rate_hz, nominal_hz), words::RATE_HOVER.get()));
        let age = age_s.map_or_else(|| words::NO_AGE.get().to_owned(), words::age);
        figures.push(named(words::AGE.get(), age, words::AGE_HOVER.get()));
    }
    figures.push(named(words::LOSSES.get(), words::losses(lost, damaged, refused), words::LOSSES_HOVER.get()));
    for (name, unit, scale, members) in groups(checkup) {
        let noise: Vec<_> = members.iter().map(|one| three_digits(one.noise * scale)).collect();
        figures.push((words::noise_of(name), format!("{} {unit}", noise.join(", ")), words::NOISE_HOVER.get()));
        let spans: Vec<_> = members.iter().map(|one| span(one, scale)).collect();
        let mut value = format!("{} {unit}", spans.join(", "));
        let fractions: Vec<f64> = members.iter().filter_map(|one| reached_percent(one)).collect();
        if let Some(max) = fractions.into_iter().reduce(f64::max) {
            value = format!("{value}; {}", words::fraction(max));
        }
        figures.push((words::span_of(name), value, words::SPAN_HOVER.get()));
    }
    if let Some((axis, off_deg, size)) = checkup.up_m_s2.and_then(|up| nearest_axis(&up)) {
        figures.push(named(words::UP.get(), words::up(axis, off_deg, size), words::UP_HOVER.get()));
    }
    figures
}

type Group<'a> = (&'static str, &'static str, f64, Vec<&'a CheckupNumber>);

/// Returns the values of the readings, grouped by quantity.
fn groups(checkup: &Checkup) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for one in &checkup.measured {
        let Some((name, unit, scale)) = channel_group(checkup.part.kind(), one.channel) else { continue };
        match groups.last_mut().filter(|(last, ..)| *last == name) {
            Some((.., members)) => members.push(one),
            None => groups.push((name, unit, scale, vec![one])),
        }
    }
    groups
}

/// Returns the lowest and highest reading; one number if they hardly differ.
fn span(one: &CheckupNumber, scale: f64) -> String {
    let [low, high] = [one.low, one.high].map(|value| short(value * scale));
    if low == high { low } else { format!("{low}\u{2026}{high}") }
}

/// Returns a number with as many decimals as a person at the device can use.
fn short(value: f64) -> String {
    let decimals = if value.abs() >= 10.0 { 1 } else { 2 };
    let words = format!("{value:.decimals$}");
    // Avoids `-0`.
    if words.trim_start_matches(['-', '0', '.']).is_empty() { words.trim_start_matches('-').to_owned() } else { words }
}

/// Returns the maximum distance from the middle of the range, in percent of the possible distance.
fn reached_percent(one: &CheckupNumber) -> Option<f64> {
    let [low, high] = one.range?;
    let middle = f64::midpoint(low, high);
    let half = (high - low) / 2.0;
    Some(100.0 * (one.high - middle).max(middle - one.low) / half)
}

/// Returns the axis nearest to this direction, the angle to it (degrees), and the length.
fn nearest_axis(up: &Vector3<f64>) -> Option<(&'static str, f64, f64)> {
    let size = up.norm();
    if !size.is_finite() || size <= 0.0 {
        return None;
    }
    let axis = up.iamax();
    let name = match (axis, up[axis] < 0.0) {
        (0, false) => "+x",
        (0, true) => "-x",
        (1, false) => "+y",
        (1, true) => "-y",
        (_, false) => "+z",
        (_, true) => "-z",
    };
    Some((name, (up[axis].abs() / size).min(1.0).acos().to_degrees(), size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_that_points_up_is_named_with_its_angle() {
        let (axis, off_deg, size) = nearest_axis(&Vector3::new(0.0, -9.0, 0.9)).unwrap();
        assert_eq!(axis, "-y");
        assert!((off_deg - 5.71).abs() < 0.01 && (size - 9.045).abs() < 1e-3, "{off_deg} {size}");
        assert_eq!(nearest_axis(&Vector3::zeros()), None);
        assert_eq!(nearest_axis(&Vector3::repeat(f64::NAN)), None);
    }

    #[test]
    fn ranges_are_short_and_zero_has_no_sign() {
        let one = |low, high, range| CheckupNumber { channel: 0, noise: 0.0, low, high, range };
        assert_eq!(span(&one(-0.001, 0.5, None), 1.0), "0.00\u{2026}0.50");
        assert_eq!(span(&one(0.012_34, 0.012_34, None), 1e3), "12.3");
        assert_eq!(reached_percent(&one(-0.5, 1.2, Some([-1.6, 1.6]))).map(f64::round), Some(75.0));
        assert_eq!(reached_percent(&one(-0.5, 1.2, None)), None);
    }
}
