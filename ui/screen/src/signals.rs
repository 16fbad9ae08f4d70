//! Signals of a tick that the traces can show, and the plots that show them.

use nalgebra::Vector3;
use nima_core::impedance::Mode;
use nima_machine::messages::Tick;
use nima_words::{language::Text, text};

use crate::degree_record::chosen_degree;

/// Number of values per tick.
pub const CHANNELS: usize = 18;

/// A longer time between two ticks gives no speed, s.
const NEXT_TICK_S: f64 = 0.02;

/// Time (s) and tip position (m) of a tick, for the speed at the next one.
pub type TipThen = (f64, Vector3<f64>);

/// Returns the signals of a tick in the order of their channels; NaN if unknown.
pub fn signals_of(tick: &Tick, before: Option<TipThen>) -> [f32; CHANNELS] {
    let m = tick.measured_n;
    let r = tick.rendering.rendered_n;
    let tip_mm = tick.positions.tip_m * 1e3;
    let speed_mm_s = before.and_then(|(then_s, tip_m)| {
        let dt_s = tick.t_s - then_s;
        (dt_s > 0.0 && dt_s < NEXT_TICK_S).then(|| (tick.positions.tip_m - tip_m).norm() / dt_s * 1e3)
    });
    let report = &tick.identification;
    let is_compared = report.modes.contains(Mode::Literal);
    [
        m.x,
        m.y,
        m.z,
        r.x,
        r.y,
        r.z,
        m.norm(),
        r.norm(),
        (r - m).norm(),
        tip_mm.x,
        tip_mm.y,
        tip_mm.z,
        speed_mm_s.unwrap_or(f64::NAN),
        tick.gates.gain,
        tick.gates.governed,
        f64::from(chosen_degree(tick)),
        if is_compared { f64::from(report.degrees.paper) } else { f64::NAN },
        tick.calibration.wrist.map_or(f64::NAN, |wrist| wrist.raw.torque_nm.norm() * 1e3),
    ]
    .map(|x| x as f32)
}

/// Colour of a line, by its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceInk {
    Measured,
    Rendered,
    Other,
    Third,
}

/// A line of a plot.
#[derive(Clone, Copy, Debug)]
pub struct TraceLine {
    pub channel: usize,
    pub name: &'static Text,
    pub ink: TraceInk,
}

const fn line(channel: usize, name: &'static Text, ink: TraceInk) -> TraceLine {
    TraceLine { channel, name, ink }
}

const fn forces(measured: usize, rendered: usize) -> [TraceLine; 2] {
    // The measured force is drawn last, over the rendered one.
    [
        line(rendered, &text::traces::RENDERED, TraceInk::Rendered),
        line(measured, &text::traces::MEASURED, TraceInk::Measured),
    ]
}

/// A plot of the Traces panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TracePlot {
    ForceX,
    ForceY,
    ForceZ,
    Magnitude,
    Error,
    Position,
    Speed,
    Gates,
    Degree,
    Torque,
}

impl TracePlot {
    /// All plots, in their order on the screen.
    pub const ALL: [Self; 10] = [
        Self::ForceX,
        Self::ForceY,
        Self::ForceZ,
        Self::Magnitude,
        Self::Error,
        Self::Position,
        Self::Speed,
        Self::Gates,
        Self::Degree,
        Self::Torque,
    ];
    pub const FORCES: [Self; 3] = [Self::ForceX, Self::ForceY, Self::ForceZ];

    pub const fn index(self) -> usize {
        self as usize
    }

    /// Returns the lines, the lowest first.
    pub const fn lines(self) -> &'static [TraceLine] {
        const X: [TraceLine; 2] = forces(0, 3);
        const Y: [TraceLine; 2] = forces(1, 4);
        const Z: [TraceLine; 2] = forces(2, 5);
        const MAGNITUDE: [TraceLine; 2] = forces(6, 7);
        match self {
            Self::ForceX => &X,
            Self::ForceY => &Y,
            Self::ForceZ => &Z,
            Self::Magnitude => &MAGNITUDE,
            Self::Error => &const { [line(8, &text::traces::ERROR, TraceInk::Other)] },
            Self::Position => {
                &const {
                    [
                        line(9, &text::traces::X, TraceInk::Measured),
                        line(10, &text::traces::Y, TraceInk::Rendered),
                        line(11, &text::traces::Z, TraceInk::Third),
                    ]
                }
            }
            Self::Speed => &const { [line(12, &text::traces::SPEED, TraceInk::Other)] },
            Self::Gates => {
                &const {
                    [line(14, &text::traces::GOVERNED, TraceInk::Third), line(13, &text::traces::GAIN, TraceInk::Other)]
                }
            }
            Self::Degree => {
                &const {
                    [
                        line(16, &text::degrees::KEY_PAPER, TraceInk::Other),
                        line(15, &text::degrees::KEY_OURS, TraceInk::Rendered),
                    ]
                }
            }
            Self::Torque => &const { [line(17, &text::traces::TORQUE, TraceInk::Other)] },
        }
    }

    /// Returns the short name of the vertical axis.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::ForceX => "x",
            Self::ForceY => "y",
            Self::ForceZ => "z",
            Self::Magnitude => "|f|",
            Self::Error => "df",
            Self::Position => "tip",
            Self::Speed => "v",
            Self::Gates => "gates",
            Self::Degree => "N",
            Self::Torque => "M",
        }
    }

    /// Returns the unit; empty for a number without one.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::ForceX | Self::ForceY | Self::ForceZ | Self::Magnitude | Self::Error => "N",
            Self::Position => "mm",
            Self::Speed => "mm/s",
            Self::Gates | Self::Degree => "",
            Self::Torque => "mNm",
        }
    }

    /// Returns the smallest range of the vertical axis.
    pub const fn min_range(self) -> f64 {
        match self {
            Self::ForceX | Self::ForceY | Self::ForceZ | Self::Magnitude | Self::Error => 0.25,
            Self::Position | Self::Torque | Self::Gates => 1.0,
            Self::Speed => 4.0,
            Self::Degree => 5.0,
        }
    }

    pub const fn name(self) -> &'static Text {
        match self {
            Self::ForceX => &text::traces::PLOT_X,
            Self::ForceY => &text::traces::PLOT_Y,
            Self::ForceZ => &text::traces::PLOT_Z,
            Self::Magnitude => &text::traces::PLOT_MAGNITUDE,
            Self::Error => &text::traces::PLOT_ERROR,
            Self::Position => &text::traces::PLOT_POSITION,
            Self::Speed => &text::traces::PLOT_SPEED,
            Self::Gates => &text::traces::PLOT_GATES,
            Self::Degree => &text::traces::PLOT_DEGREE,
            Self::Torque => &text::traces::PLOT_TORQUE,
        }
    }

    /// Returns whether its values have a sign.
    pub const fn has_direction(self) -> bool {
        matches!(self, Self::ForceX | Self::ForceY | Self::ForceZ)
    }

    /// Returns whether its lines are the measured and the rendered force, whose legend is in the header.
    pub const fn is_of_forces(self) -> bool {
        matches!(self, Self::ForceX | Self::ForceY | Self::ForceZ | Self::Magnitude)
    }
}

/// The chosen plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlotSet(u16);

impl Default for PlotSet {
    fn default() -> Self {
        TracePlot::FORCES.into_iter().collect()
    }
}

impl FromIterator<TracePlot> for PlotSet {
    fn from_iter<I: IntoIterator<Item = TracePlot>>(plots: I) -> Self {
        Self(plots.into_iter().fold(0, |set, plot| set | 1 << plot.index()))
    }
}

impl PlotSet {
    #[must_use]
    pub fn toggled(self, plot: TracePlot) -> Self {
        Self(self.0 ^ (1 << plot.index()))
    }

    pub const fn contains(self, plot: TracePlot) -> bool {
        self.0 & (1 << plot.index()) != 0
    }

    pub fn plots(self) -> impl Iterator<Item = TracePlot> {
        TracePlot::ALL.into_iter().filter(move |plot| self.contains(*plot))
    }
}
