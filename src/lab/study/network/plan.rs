//! The cells of the study.

use nima_core::impedance::{Mode, OwnMotion};
use nima_machine::runtime::VirtualClock;
use serde::Serialize;

use super::{BURSTS_MS, ConditionJitter, DELAYS_MS, JITTERS, LOSSES_PERCENT, LinkEvent, NetworkCondition, cell::Runs};

/// Delay of the point around which each factor is varied alone, ms.
pub const BASE_MS: f64 = 36.0;
/// On this link, at most 10 % of additional error is permitted.
pub(super) const JUDGED_JITTER: ConditionJitter = ConditionJitter::Normal(20.0);
pub(super) const JUDGED_LOSS_PERCENT: f64 = 30.0;
/// Jitter at which the clock is evaluated.
pub(super) const CLOCK_JITTER: ConditionJitter = ConditionJitter::Normal(1.0);
/// %.
const BURST_LOSSES_PERCENT: [f64; 2] = [5.0, 20.0];

/// Extent of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PlanExtent {
    /// A few short cells.
    Quick,
    /// Every mode over every delay; every other factor alone, and loss with jitter, at [`BASE_MS`], in three modes.
    Usual,
    /// Every combination.
    Full,
}

/// Options of the study.
#[derive(Clone, Debug)]
pub struct NetworkOptions {
    pub extent: PlanExtent,
    /// Clocks of both loops, in the order of the tables.
    pub clocks: Vec<VirtualClock>,
    /// The modes; the first is evaluated. If empty, all modes are run and the default one is evaluated. Delayed
    /// reflection is always included, because the others are compared with it.
    pub modes: Vec<Mode>,
    /// Motion from which the console computes the force.
    pub own_motion: OwnMotion,
}

impl NetworkOptions {
    pub fn judged(&self) -> Mode {
        self.modes.first().copied().unwrap_or(Mode::Best)
    }

    fn modes_or(&self, all: impl IntoIterator<Item = Mode>) -> Vec<Mode> {
        let mut modes: Vec<Mode> = Vec::new();
        let asked = if self.modes.is_empty() { all.into_iter().collect() } else { self.modes.clone() };
        for mode in asked.into_iter().chain([Mode::Dfr]) {
            if !modes.contains(&mode) {
                modes.push(mode);
            }
        }
        modes
    }
}

pub(super) const fn runs(options: &NetworkOptions) -> Runs {
    let own_motion = options.own_motion;
    match options.extent {
        PlanExtent::Quick => Runs { known_s: [20.0, 5.0], settle_s: 1.0, learn_s: 4.0, task_s: 10.0, own_motion },
        _ => Runs { known_s: [60.0, 5.0], settle_s: 5.0, learn_s: 5.0, task_s: 20.0, own_motion },
    }
}

/// A run: clock, condition and mode.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) clock: VirtualClock,
    pub(super) condition: NetworkCondition,
    pub(super) mode: Mode,
}

/// Returns the cells, in the order in which they are run.
pub(super) fn plan(options: &NetworkOptions) -> Vec<Cell> {
    nima_baselines::provide();
    let cells = of_one_clock(options);
    let on = |clock: &VirtualClock| {
        let clock = *clock;
        cells.iter().map(move |&(condition, mode)| Cell { clock, condition, mode })
    };
    options.clocks.iter().flat_map(on).collect()
}

fn of_one_clock(options: &NetworkOptions) -> Vec<(NetworkCondition, Mode)> {
    let all = || Mode::ALL.into_iter().chain(Mode::BASELINES);
    let cells = |conditions: Vec<NetworkCondition>, modes: Vec<Mode>| {
        modes.into_iter().flat_map(move |mode| conditions.clone().into_iter().map(move |condition| (condition, mode)))
    };
    match options.extent {
        PlanExtent::Quick => cells(quick(), options.modes_or([Mode::Best])).collect(),
        PlanExtent::Full => cells(full(), options.modes_or(all())).collect(),
        PlanExtent::Usual => {
            let delays = DELAYS_MS.map(NetworkCondition::clean).to_vec();
            let over_delays = cells(delays.clone(), options.modes_or(all()));
            let others = around().into_iter().filter(|condition| !delays.contains(condition)).collect();
            over_delays.chain(cells(others, options.modes_or([Mode::Best, Mode::Matched]))).collect()
        }
    }
}

/// Returns the condition on which the study judges the modes, with this delay, ms.
pub(super) const fn judged_line(delay_ms: f64) -> NetworkCondition {
    NetworkCondition { jitter: JUDGED_JITTER, loss_percent: JUDGED_LOSS_PERCENT, ..NetworkCondition::clean(delay_ms) }
}

fn quick() -> Vec<NetworkCondition> {
    let base = NetworkCondition::clean(BASE_MS);
    vec![base, judged_line(BASE_MS), NetworkCondition { happening: LinkEvent::Outages, ..base }]
}

/// Returns loss with jitter, and every other factor alone.
fn around() -> Vec<NetworkCondition> {
    let base = NetworkCondition::clean(BASE_MS);
    let crossed = JITTERS
        .into_iter()
        .flat_map(|jitter| LOSSES_PERCENT.map(|loss_percent| NetworkCondition { jitter, loss_percent, ..base }));
    let bursts = BURST_LOSSES_PERCENT.into_iter().flat_map(|loss_percent| {
        BURSTS_MS.map(|burst_ms| NetworkCondition { loss_percent, burst_ms: Some(burst_ms), ..base })
    });
    let happenings = LinkEvent::ALL.into_iter().skip(1).map(|happening| NetworkCondition { happening, ..base });
    crossed.chain([NetworkCondition { jitter: CLOCK_JITTER, ..base }]).chain(bursts).chain(happenings).collect()
}

fn full() -> Vec<NetworkCondition> {
    let mut all = Vec::new();
    for delay_ms in DELAYS_MS {
        for jitter in JITTERS {
            for loss_percent in LOSSES_PERCENT {
                let bursts = if loss_percent > 0.0 { &BURSTS_MS[..] } else { &[] };
                for burst_ms in [None].into_iter().chain(bursts.iter().copied().map(Some)) {
                    for happening in LinkEvent::ALL {
                        all.push(NetworkCondition { delay_ms, jitter, loss_percent, burst_ms, happening });
                    }
                }
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planned(extent: PlanExtent, modes: &[Mode]) -> Vec<(NetworkCondition, Mode)> {
        let own_motion = OwnMotion::default();
        let clocks = vec![VirtualClock::PERFECT];
        let cells = plan(&NetworkOptions { extent, clocks, modes: modes.to_vec(), own_motion });
        cells.into_iter().map(|Cell { condition, mode, .. }| (condition, mode)).collect()
    }

    #[test]
    fn no_cell_is_run_twice_and_each_has_what_it_is_compared_with() {
        for extent in [PlanExtent::Quick, PlanExtent::Usual] {
            for modes in [&[][..], &[Mode::Matched, Mode::Dfr, Mode::Matched]] {
                let cells = planned(extent, modes);
                for (at, (condition, mode)) in cells.iter().enumerate() {
                    assert!(!cells[..at].contains(&(*condition, *mode)), "{condition:?} {mode}");
                    assert!(
                        cells.contains(&(NetworkCondition::clean(condition.delay_ms), *mode)),
                        "{condition:?} {mode}"
                    );
                    assert!(cells.contains(&(*condition, Mode::Dfr)), "{condition:?}");
                }
            }
        }
    }

    #[test]
    fn the_whole_is_every_combination() {
        let delays = DELAYS_MS.len();
        let jitters = JITTERS.len();
        let losses = 1 + 5 * (1 + BURSTS_MS.len());
        let modes = Mode::ALL.len() + Mode::BASELINES.into_iter().count();
        assert_eq!(planned(PlanExtent::Full, &[]).len(), delays * jitters * losses * LinkEvent::ALL.len() * modes);
    }
}
