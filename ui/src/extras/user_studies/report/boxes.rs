//! Box plots of a measure, one box per condition.

use std::collections::BTreeMap;

use maud::{Markup, html};
use nima_analysis::SampleSummary;
use nima_charts::COLOURS;
use nima_report::{html::drawing, plots::step};
use nima_study::trials::TrialTable;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 260.0;
const LEFT: f64 = 80.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 34.0;
const HALF_BOX: f64 = 28.0;
/// Maximum length of the whiskers, in box heights (Tukey 1977, Exploratory Data Analysis).
const REACH: f64 = 1.5;

/// Draws the means of the participants under each condition, in this order; empty without values.
pub(super) fn svg(table: &TrialTable, measure: &str, order: &[String], axis: &str) -> Markup {
    let groups: Vec<(&String, Vec<f64>)> =
        order.iter().map(|name| (name, means(table, measure, name))).filter(|(_, values)| !values.is_empty()).collect();
    let all: Vec<f64> = groups.iter().flat_map(|(_, values)| values.iter().copied()).collect();
    let Ok(whole) = SampleSummary::of(&all) else { return html! {} };
    let [low, high] = whole.extremes;
    let room = 0.05 * if high > low { high - low } else { high.abs().max(1.0) };
    let low = low - room;
    let high = high + room;
    let down = |value: f64| HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM);
    let mark = step(high - low, 5.0);
    let decimals = (-mark.log10().floor()).max(0.0) as usize;
    let middle = f64::midpoint(TOP, HEIGHT - BOTTOM);
    let apart = (WIDTH - LEFT - RIGHT) / groups.len() as f64;
    let body = html! {
        @for number in (low / mark).ceil() as i64..=(high / mark).floor() as i64 {
            @let value = number as f64 * mark;
            @let y = down(value);
            path d=(format_args!("M{LEFT} {y:.1}H{}", WIDTH - RIGHT)) stroke="#dddddd" {}
            text x=(LEFT - 6.0) y=(format_args!("{:.1}", y + 4.0)) text-anchor="end" { (format_args!("{value:.decimals$}")) }
        }
        text transform=(format_args!("translate(16 {middle:.0}) rotate(-90)")) text-anchor="middle" { (axis) }
        @for (at, (name, values)) in groups.iter().enumerate() {
            @let x = LEFT + (at as f64 + 0.5) * apart;
            (group(x, values, COLOURS[at % COLOURS.len()], down))
            text x=(format_args!("{x:.1}")) y=(HEIGHT - 12.0) text-anchor="middle" { (name) " (n = " (values.len()) ")" }
        }
    };
    drawing([WIDTH, HEIGHT], &format!("{axis} under each condition"), &body)
}

fn group(x: f64, values: &[f64], colour: &str, down: impl Fn(f64) -> f64) -> Markup {
    let Ok(SampleSummary { quartiles: [first, third], median, .. }) = SampleSummary::of(values) else {
        return html! {};
    };
    let reach = REACH * (third - first);
    let within = values.iter().copied().filter(|value| (first - reach..=third + reach).contains(value));
    let (min, max) = within.fold((first, third), |(min, max), value| (min.min(value), max.max(value)));
    let top = down(third);
    let bottom = down(first);
    let left = x - HALF_BOX;
    let width = 2.0 * HALF_BOX;
    html! {
        path d=(format_args!("M{x:.1} {:.1}V{top:.1}M{x:.1} {bottom:.1}V{:.1}", down(max), down(min))) stroke=(colour) {}
        rect x=(format_args!("{left:.1}")) y=(format_args!("{top:.1}")) width=(width) height=(format_args!("{:.1}", bottom - top))
            fill=(colour) fill-opacity="0.2" stroke=(colour) {}
        path d=(format_args!("M{left:.1} {:.1}h{width}", down(median))) stroke=(colour) stroke-width="2.5" {}
        @for (place, value) in values.iter().enumerate() {
            // Draw the points next to the box, in columns, so that equal values remain visible.
            @let aside = HALF_BOX + 8.0 + 5.0 * (place % 4) as f64;
            circle cx=(format_args!("{:.1}", x + aside)) cy=(format_args!("{:.1}", down(*value))) r="2.5" fill=(colour) {}
        }
    }
}

/// Returns the mean of each participant under a condition.
fn means(table: &TrialTable, measure: &str, condition: &str) -> Vec<f64> {
    let Some(column) = table.measures.iter().position(|known| known == measure) else { return Vec::new() };
    let mut of: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for trial in table.trials.iter().filter(|trial| trial.condition == condition) {
        if let Some(value) = trial.values.get(column).copied().flatten() {
            of.entry(&trial.participant).or_default().push(value);
        }
    }
    of.values().filter_map(|values| Some(SampleSummary::of(values).ok()?.mean)).collect()
}

#[cfg(test)]
mod tests {
    use nima_study::trials::TableTrial;

    use super::*;

    #[test]
    fn a_box_for_each_condition_a_point_for_each_participant() {
        let trial = |participant: &str, condition: &str, value: f64| TableTrial {
            participant: participant.to_owned(),
            condition: condition.to_owned(),
            number: None,
            values: vec![Some(value)],
        };
        let trials =
            vec![trial("P01", "A", 1.0), trial("P01", "A", 3.0), trial("P02", "A", 5.0), trial("P01", "B", 2.0)];
        let table = TrialTable { measures: vec!["time_s".to_owned()], trials };
        let order = ["A", "B", "C"].map(str::to_owned);
        assert_eq!(means(&table, "time_s", "A"), [2.0, 5.0]);
        let image = svg(&table, "time_s", &order, "time_s (s)").into_string();
        assert_eq!((image.matches("<rect").count(), image.matches("<circle").count()), (2, 3), "{image}");
        assert!(image.contains("A (n = 2)") && image.contains("B (n = 1)") && !image.contains("NaN"), "{image}");
        assert_eq!(svg(&table, "absent", &order, "absent").into_string(), "");
    }
}
