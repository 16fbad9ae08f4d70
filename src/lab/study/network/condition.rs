//! Impairments of the datagrams and the clocks: the factors of the study.

use nima_network::impairment::{Flap, ImpairmentJitter as LineJitter, ImpairmentSettings, LossModel, OUTAGES};
use serde::{Serialize, Serializer};

/// Delay in each direction, ms.
pub const DELAYS_MS: [f64; 11] = [0.0, 5.0, 15.0, 36.0, 72.0, 100.0, 150.0, 300.0, 450.0, 600.0, 900.0];
pub const JITTERS: [ConditionJitter; 5] = [
    ConditionJitter::None,
    ConditionJitter::Normal(5.0),
    ConditionJitter::Normal(20.0),
    ConditionJitter::Normal(50.0),
    ConditionJitter::Pareto,
];
/// Fractions of datagrams lost, %.
pub const LOSSES_PERCENT: [f64; 6] = [0.0, 1.0, 5.0, 10.0, 20.0, 30.0];
/// Mean lengths of bursts of loss, ms.
pub const BURSTS_MS: [f64; 3] = [10.0, 50.0, 200.0];
/// Mean (s) and shape of the Pareto jitter: one datagram in a thousand is 90 ms late.
const PARETO: LineJitter = LineJitter::Pareto { mean_s: 5e-3, shape: 3.0 };
/// A line that is interrupted for a moment, too short for a fault.
const FLAP: Flap = Flap { down_s: 0.05, every_s: 1.0 };
/// Offset of the follower's clock, s; time at which it is set (s of the run) and size of the step (s); and its maximum
/// rate error.
const AHEAD_S: f64 = 1800.0;
const CLOCK_SET_AT_S: f64 = 12.0;
const CLOCK_STEP_S: f64 = 0.05;
const CLOCK_DRIFT: f64 = 1e-4;
/// Delay of the longer direction if they differ, ms.
const LONG_WAY_MS: f64 = 100.0;

/// Additional delay of a datagram. A late datagram delays those behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConditionJitter {
    /// None.
    None,
    /// Absolute value of a normal random number with this standard deviation, ms.
    Normal(f64),
    /// A Pareto number with a mean of 5 ms: rarely very large.
    Pareto,
}

impl ConditionJitter {
    /// Returns the name in tables.
    pub fn word(self) -> String {
        match self {
            Self::None => "0".to_owned(),
            Self::Normal(deviation_ms) => format!("{deviation_ms}"),
            Self::Pareto => "Pareto".to_owned(),
        }
    }
}

impl Serialize for ConditionJitter {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.word())
    }
}

/// An impairment other than delay, jitter and loss.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LinkEvent {
    /// None.
    Nothing,
    /// No connection for 0.8 s of every 4 s, the published profile.
    Outages,
    /// No connection for 50 ms of every second.
    Flap,
    /// The follower's clock is set forward by 50 ms.
    ClockForward,
    /// The follower's clock is set back by 50 ms.
    ClockBack,
    /// The follower's clock runs 100 ppm fast.
    ClockDrift,
    /// One datagram in twenty is overtaken by those of the next 10 ms.
    Reorder,
    /// Every fifth datagram arrives twice.
    Duplicates,
    /// The return direction takes 100 ms.
    Asymmetric,
}

impl LinkEvent {
    pub const ALL: [Self; 9] = [
        Self::Nothing,
        Self::Outages,
        Self::Flap,
        Self::ClockForward,
        Self::ClockBack,
        Self::ClockDrift,
        Self::Reorder,
        Self::Duplicates,
        Self::Asymmetric,
    ];

    /// Returns the word for tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Nothing => "-",
            Self::Outages => "outages 0.8 s of 4 s",
            Self::Flap => "flap 50 ms of 1 s",
            Self::ClockForward => "clock +50 ms",
            Self::ClockBack => "clock -50 ms",
            Self::ClockDrift => "clock 100 ppm fast",
            Self::Reorder => "5 % reordered",
            Self::Duplicates => "20 % doubled",
            Self::Asymmetric => "100 ms back",
        }
    }

    /// Returns whether the follower's clock is set.
    pub const fn sets_clock(self) -> bool {
        matches!(self, Self::ClockForward | Self::ClockBack)
    }
}

/// One combination of the factors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NetworkCondition {
    /// In each direction, ms.
    pub delay_ms: f64,
    /// Jitter in addition to the delay.
    pub jitter: ConditionJitter,
    /// Fraction of datagrams lost, %.
    pub loss_percent: f64,
    /// Mean length of the bursts in which they are lost, ms; `None` for independent losses.
    pub burst_ms: Option<f64>,
    /// Other impairment.
    pub happening: LinkEvent,
}

impl NetworkCondition {
    /// Creates a line with only this delay, ms.
    pub const fn clean(delay_ms: f64) -> Self {
        Self {
            delay_ms,
            jitter: ConditionJitter::None,
            loss_percent: 0.0,
            burst_ms: None,
            happening: LinkEvent::Nothing,
        }
    }

    /// Returns whether the link has only a delay.
    pub fn is_clean(&self) -> bool {
        *self == Self::clean(self.delay_ms)
    }

    /// Returns the line from console to follower, and the one back.
    pub(super) fn lines(&self) -> [ImpairmentSettings; 2] {
        let fraction = self.loss_percent / 100.0;
        let there = ImpairmentSettings {
            delay_s: self.delay_ms * 1e-3,
            jitter: match self.jitter {
                ConditionJitter::None => LineJitter::None,
                ConditionJitter::Normal(deviation_ms) => LineJitter::Normal { deviation_s: deviation_ms * 1e-3 },
                ConditionJitter::Pareto => PARETO,
            },
            loss: match self.burst_ms {
                _ if fraction <= 0.0 => LossModel::None,
                Some(burst_ms) => LossModel::Bursts { fraction, burst_s: burst_ms * 1e-3 },
                None => LossModel::Independent { fraction },
            },
            ..ImpairmentSettings::default()
        };
        let both = match self.happening {
            LinkEvent::Outages => ImpairmentSettings { flap: Some(OUTAGES), ..there },
            LinkEvent::Flap => ImpairmentSettings { flap: Some(FLAP), ..there },
            LinkEvent::Reorder => ImpairmentSettings { reorder: 0.05, reorder_s: 0.01, ..there },
            LinkEvent::Duplicates => ImpairmentSettings { duplicate: 0.2, ..there },
            _ => there,
        };
        let back_ms = if self.happening == LinkEvent::Asymmetric { LONG_WAY_MS } else { self.delay_ms };
        [both, ImpairmentSettings { delay_s: back_ms * 1e-3, ..both }]
    }

    /// Returns the follower's clock minus the console's at this time of the run, s.
    pub(super) fn ahead_s(&self, t_s: f64) -> f64 {
        let is_set = t_s >= CLOCK_SET_AT_S;
        AHEAD_S
            + match self.happening {
                LinkEvent::ClockForward if is_set => CLOCK_STEP_S,
                LinkEvent::ClockBack if is_set => -CLOCK_STEP_S,
                LinkEvent::ClockDrift => CLOCK_DRIFT * t_s,
                _ => 0.0,
            }
    }
}
