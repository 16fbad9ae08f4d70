//! Units of the plots, as the operator chooses them. Files keep the units of their columns.

use egui::{Context, Id};
use serde::{Deserialize, Serialize};

use crate::signals::TracePlot;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct PlotUnits {
    pub force: ForceUnit,
    pub length: LengthUnit,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceUnit {
    #[default]
    Newton,
    Millinewton,
}

/// Unit of positions, and of speeds per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LengthUnit {
    #[default]
    Millimetre,
    Metre,
}

/// A unit on the screen: `factor` of it are one unit of the signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayUnit {
    /// Empty for a number without a unit.
    pub name: &'static str,
    pub factor: f64,
    pub decimals: usize,
}

impl PlotUnits {
    /// Returns the units of the window: every plot in it uses the same, so they belong to its context.
    pub fn of(ctx: &Context) -> Self {
        ctx.data(|data| data.get_temp(Self::id())).unwrap_or_default()
    }

    pub fn choose(self, ctx: &Context) {
        ctx.data_mut(|data| data.insert_temp(Self::id(), self));
    }

    fn id() -> Id {
        Id::unique("units")
    }

    pub const fn of_plot(self, plot: TracePlot) -> DisplayUnit {
        match plot {
            TracePlot::ForceX | TracePlot::ForceY | TracePlot::ForceZ | TracePlot::Magnitude | TracePlot::Error => {
                match self.force {
                    ForceUnit::Newton => DisplayUnit { name: "N", factor: 1.0, decimals: 2 },
                    ForceUnit::Millinewton => DisplayUnit { name: "mN", factor: 1e3, decimals: 0 },
                }
            }
            TracePlot::Position => match self.length {
                LengthUnit::Millimetre => DisplayUnit { name: "mm", factor: 1.0, decimals: 2 },
                LengthUnit::Metre => DisplayUnit { name: "m", factor: 1e-3, decimals: 5 },
            },
            TracePlot::Speed => match self.length {
                LengthUnit::Millimetre => DisplayUnit { name: "mm/s", factor: 1.0, decimals: 2 },
                LengthUnit::Metre => DisplayUnit { name: "m/s", factor: 1e-3, decimals: 5 },
            },
            TracePlot::Gates | TracePlot::Degree | TracePlot::Torque => {
                DisplayUnit { name: plot.unit(), factor: 1.0, decimals: 2 }
            }
        }
    }
}

impl ForceUnit {
    pub const ALL: [Self; 2] = [Self::Newton, Self::Millinewton];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Newton => "N",
            Self::Millinewton => "mN",
        }
    }
}

impl LengthUnit {
    pub const ALL: [Self; 2] = [Self::Millimetre, Self::Metre];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "mm, mm/s",
            Self::Metre => "m, m/s",
        }
    }
}
