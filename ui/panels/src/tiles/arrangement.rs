//! The built-in layouts: few panels for a newcomer, those of a calibration, and all of them.

use egui::Vec2;
use nima_words::text::tiles as text;
use serde::{Deserialize, Serialize};

use super::{LayoutNode, LayoutPart, PanelId, layout::WHOLE};

/// Width of the column of settings and of the column of figures.
const KNOBS: f32 = 316.0;
const FIGURES: f32 = 348.0;
/// Width of the force-space panel next to the traces, and the width between the columns from which it is placed there.
const FORCE_SPACE: f32 = 300.0;
const FORCE_SPACE_FROM: f32 = 720.0;
/// Width of the traces.
const TRACES: f32 = 560.0;
/// Height of the desk from which degrees and timing are placed below one another instead
/// of in tabs.
const TALL_FROM: f32 = 860.0;
/// Heights of panels that should not need scrolling.
const FEEDBACK: f32 = 494.0;
const HORIZON: f32 = 240.0;
const DEGREES: f32 = 424.0;

/// A built-in layout. In each, every panel is at most one click away: those that are not shown are tabs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// Field, forces and settings; the layout of a first start.
    Simple,
    /// Calibrations, devices and forces.
    Calibration,
    /// Every panel that fits; also the layout of settings that were saved before there was a choice.
    #[default]
    Research,
}

impl Arrangement {
    pub const ALL: [Self; 3] = [Self::Simple, Self::Calibration, Self::Research];

    pub fn name(self) -> &'static str {
        match self {
            Self::Simple => text::SIMPLE.get(),
            Self::Calibration => text::CALIBRATION_LAYOUT.get(),
            Self::Research => text::RESEARCH.get(),
        }
    }

    pub fn meaning(self) -> &'static str {
        match self {
            Self::Simple => text::SIMPLE_HOVER.get(),
            Self::Calibration => text::CALIBRATION_LAYOUT_HOVER.get(),
            Self::Research => text::RESEARCH_HOVER.get(),
        }
    }

    /// Returns the places of the panels in a window of this size.
    pub(super) fn places(self, size: Vec2) -> LayoutNode {
        match self {
            Self::Simple => simple(size),
            Self::Calibration => calibration(size),
            Self::Research => research(size),
        }
    }
}

/// Returns the settings on the left, the 3-D view above the traces; everything else in tabs behind them.
fn simple(size: Vec2) -> LayoutNode {
    let width = size.x.max(KNOBS + TRACES);
    let height = size.y.max(200.0);
    let traces = (0.42 * height).clamp(250.0, 420.0);
    let above = tabs(&[PanelId::Field, PanelId::Devices, PanelId::Safety, PanelId::Link]);
    let under = tabs(&[
        PanelId::Traces,
        PanelId::ForceSpace,
        PanelId::Horizon,
        PanelId::Degrees,
        PanelId::Timing,
        PanelId::Tradeoff,
    ]);
    let right = column(vec![(height - traces, above), (traces, under)]);
    row(vec![(KNOBS, tabs(&[PanelId::Feedback, PanelId::Calibrations])), (width - KNOBS, right)])
}

/// Returns the calibrations on the left, the devices above the traces, and the 3-D view behind the devices.
fn calibration(size: Vec2) -> LayoutNode {
    let width = size.x.max(KNOBS + TRACES);
    let height = size.y.max(200.0);
    let traces = (0.42 * height).clamp(250.0, 420.0);
    let above = tabs(&[PanelId::Devices, PanelId::Field, PanelId::Safety, PanelId::Link]);
    let under = tabs(&[
        PanelId::Traces,
        PanelId::ForceSpace,
        PanelId::Horizon,
        PanelId::Degrees,
        PanelId::Timing,
        PanelId::Tradeoff,
    ]);
    let right = column(vec![(height - traces, above), (traces, under)]);
    row(vec![(KNOBS, tabs(&[PanelId::Calibrations, PanelId::Feedback])), (width - KNOBS, right)])
}

/// Returns the settings on the left, figures on the right, the 3-D view above the traces in between; panels that do not
/// fit are placed in tabs.
fn research(size: Vec2) -> LayoutNode {
    let middle = (size.x - KNOBS - FIGURES).max(200.0);
    let height = size.y.max(200.0);
    let traces = (0.47 * height).clamp(250.0, 492.0);
    if middle < TRACES {
        return narrow(size.x.max(KNOBS + FIGURES + 200.0), height, traces);
    }
    let [left, right] = if height >= TALL_FROM { tall_sides(height) } else { short_sides(height) };
    let under = if middle > FORCE_SPACE_FROM {
        row(vec![
            (middle - FORCE_SPACE, tabs(&[PanelId::Traces])),
            (FORCE_SPACE, tabs(&[PanelId::ForceSpace, PanelId::Safety])),
        ])
    } else {
        tabs(&[PanelId::Traces, PanelId::ForceSpace, PanelId::Safety])
    };
    let between = column(vec![(height - traces, tabs(&[PanelId::Field, PanelId::Devices])), (traces, under)]);
    row(vec![(KNOBS, left), (middle, between), (FIGURES, right)])
}

/// For windows too narrow for the traces between two columns: the figures next to the 3-D view, and the traces below both.
fn narrow(width: f32, height: f32, traces: f32) -> LayoutNode {
    let [left, _] = short_sides(height);
    let above = row(vec![
        (width - KNOBS - FIGURES, tabs(&[PanelId::Field, PanelId::Devices])),
        (FIGURES, tabs(&[PanelId::Horizon, PanelId::Degrees, PanelId::Timing, PanelId::Tradeoff])),
    ]);
    let under = tabs(&[PanelId::Traces, PanelId::ForceSpace, PanelId::Safety, PanelId::Link]);
    row(vec![(KNOBS, left), (width - KNOBS, column(vec![(height - traces, above), (traces, under)]))])
}

fn tall_sides(height: f32) -> [LayoutNode; 2] {
    [
        column(vec![(FEEDBACK, tabs(&[PanelId::Feedback])), (height - FEEDBACK, tabs(&[PanelId::Calibrations]))]),
        column(vec![
            (HORIZON, tabs(&[PanelId::Horizon])),
            (DEGREES, tabs(&[PanelId::Degrees, PanelId::Tradeoff])),
            (height - HORIZON - DEGREES, tabs(&[PanelId::Timing, PanelId::Link])),
        ]),
    ]
}

fn short_sides(height: f32) -> [LayoutNode; 2] {
    let horizon = (height - 150.0).min(HORIZON);
    [
        tabs(&[PanelId::Feedback, PanelId::Calibrations]),
        column(vec![
            (horizon, tabs(&[PanelId::Horizon])),
            (height - horizon, tabs(&[PanelId::Degrees, PanelId::Timing, PanelId::Link, PanelId::Tradeoff])),
        ]),
    ]
}

fn tabs(panels: &[PanelId]) -> LayoutNode {
    LayoutNode::Tabs(panels.iter().map(|panel| LayoutNode::Panel(*panel)).collect())
}

fn parts(of: Vec<(f32, LayoutNode)>) -> Vec<LayoutPart> {
    let whole: f32 = of.iter().map(|(points, _)| points).sum();
    of.into_iter().map(|(points, of)| LayoutPart { fraction: (points / whole * WHOLE).round() as u16, of }).collect()
}

fn row(of: Vec<(f32, LayoutNode)>) -> LayoutNode {
    LayoutNode::Row(parts(of))
}

fn column(of: Vec<(f32, LayoutNode)>) -> LayoutNode {
    LayoutNode::Column(parts(of))
}
