//! One cell: a run of both machines over one link in one mode, and its results.

use nalgebra::Vector3;
use nima_core::impedance::{Mode, OwnMotion};
use nima_machine::{messages::LoopState, runtime::VirtualClock};
use nima_network::playout::PlayoutCounts;

use super::{
    ConditionJitter, NetworkCondition, NetworkError, NetworkRow,
    bench::{NetworkBench, RATE_HZ, TickObservation},
    operator::Operator,
    trace::{RunTrace, TraceSample},
};
use crate::gates::{Breaches, GateWatch};

/// Parts of every cell's run, s, and the motion from which the console computes the force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Runs {
    /// The line is open and being measured, the loops are not running yet; with jitter, and without.
    pub(super) known_s: [f64; 2],
    /// Not engaged.
    pub(super) settle_s: f64,
    /// Engaged, but not evaluated yet, while the models learn, s.
    pub(super) learn_s: f64,
    /// Evaluated, s.
    pub(super) task_s: f64,
    pub(super) own_motion: OwnMotion,
}

/// Time after which a stopped machine must be at rest, s; after an engagement, its tip is observed for this time, s.
const HOLDS_AFTER_S: f64 = 0.1;
const WATCHED_S: f64 = 0.1;
/// Interval, in ticks, at which the clock estimate is compared with the true clock.
const CLOCK_EVERY: u32 = 50;

/// Counters of a running cell.
struct CellCounts {
    watch: GateWatch<3>,
    breaches: Breaches,
    /// Number of ticks since the last payload was delivered to the console, and its maximum while there was still
    /// force.
    silent: u32,
    force_after: u32,
    /// Ticks for which the follower has been stopped, and for which it has been engaged again since.
    stopped: u32,
    engaged: u32,
    has_returned: bool,
    tip_m: Option<Vector3<f64>>,
    step_m: Option<f64>,
    under_way: [(u64, u64); 2],
    clock_error_s: f64,
    clock_bound_s: f64,
}

impl CellCounts {
    fn look(&mut self, seen: &TickObservation, is_judged: bool) {
        let tick = &seen.console;
        if seen.is_new {
            self.watch.look(tick.t_s, &tick.rendering.rendered_n, &tick.gates, 1.0, &mut self.breaches);
        }
        self.silent = if seen.under_way[1].1 > 0 { 0 } else { self.silent + 1 };
        if tick.rendering.rendered_n.norm() > 0.0 {
            self.force_after = self.force_after.max(self.silent);
        }
        self.look_at_tip(seen);
        if is_judged {
            for (all, (ticks, count)) in self.under_way.iter_mut().zip(seen.under_way) {
                *all = (all.0 + u64::from(ticks), all.1 + u64::from(count));
            }
        }
    }

    /// Measures the largest step of a tip that was held, until it has been following again for a moment.
    fn look_at_tip(&mut self, seen: &TickObservation) {
        let [_, follower] = seen.states;
        self.stopped = if follower.is_latched() { self.stopped + 1 } else { 0 };
        self.has_returned |= f64::from(self.stopped) > HOLDS_AFTER_S * RATE_HZ;
        self.engaged = if follower == LoopState::Engaged { self.engaged + 1 } else { 0 };
        self.has_returned &= f64::from(self.engaged) < WATCHED_S * RATE_HZ;
        if let Some(before_m) = self.tip_m.replace(seen.tip_m).filter(|_| self.has_returned) {
            self.step_m = Some(self.step_m.unwrap_or(0.0).max((seen.tip_m - before_m).norm()));
        }
    }

    fn look_at_clock(&mut self, bench: &NetworkBench) {
        let estimate = bench.ends()[0].stream.clock().estimate(bench.now_s());
        if let Some(estimate) = estimate {
            self.clock_error_s = self.clock_error_s.max((estimate.offset_s - bench.ahead_s()).abs());
            self.clock_bound_s = self.clock_bound_s.max(estimate.bound_s);
        }
    }
}

pub(super) fn measured(
    clock: VirtualClock,
    condition: NetworkCondition,
    mode: Mode,
    runs: Runs,
) -> Result<NetworkRow, NetworkError> {
    let Runs { known_s, settle_s, learn_s, task_s, own_motion } = runs;
    let known_s = known_s[usize::from(condition.jitter == ConditionJitter::None)];
    let mut bench = NetworkBench::new(clock, condition, mode, own_motion, known_s)?;
    let mut operator = Operator::new(bench.now_s() + settle_s);
    let ticks = ((settle_s + learn_s + task_s) * RATE_HZ) as u32;
    let mut counting = CellCounts {
        watch: GateWatch::of(&bench.rig.gates, 1.0 / RATE_HZ),
        breaches: Breaches::default(),
        silent: 0,
        force_after: 0,
        stopped: 0,
        engaged: 0,
        has_returned: false,
        tip_m: None,
        step_m: None,
        under_way: [(0, 0); 2],
        clock_error_s: 0.0,
        clock_bound_s: 0.0,
    };
    let judged_from = ((settle_s + learn_s) * RATE_HZ) as u32;
    let mut trace = RunTrace::new(judged_from as usize);
    let mut before = [PlayoutCounts::default(); 2];
    let mut clock_set = None;
    let mut round_trip_s = 0.0;
    while bench.ticks() < ticks {
        let tick = bench.ticks();
        let ahead_s = bench.ahead_s();
        if tick == judged_from {
            before = counts(&bench);
        }
        let command = operator.command(bench.now_s());
        let Some(seen) = bench.step(command) else { continue };
        if condition.happening.sets_clock() && (bench.ahead_s() - ahead_s).abs() > 1e-3 {
            clock_set = Some(bench.tick);
        }
        operator.look(bench.now_s(), seen.states);
        counting.look(&seen, tick >= judged_from);
        if tick >= judged_from && tick.is_multiple_of(CLOCK_EVERY) && !condition.happening.sets_clock() {
            counting.look_at_clock(&bench);
        }
        round_trip_s = seen.console.delay_s;
        trace.push(TraceSample {
            hand_m: seen.hand_m,
            tip_n: seen.tip_n,
            rendered_n: seen.console.rendering.rendered_n,
            asked_n: seen.console.rendering.asked_n[mode.index()],
            is_engaged: seen.states[0] == LoopState::Engaged,
            newest: seen.newest,
        });
    }
    let named = |set: u32| {
        let found = bench.ends().map(|end| end.stepped.map(|tick| f64::from(tick.saturating_sub(set)) * 1e3 / RATE_HZ));
        found[0].zip(found[1]).map(|(one, other)| one.max(other))
    };
    let fractions = fractions(&before, &counts(&bench));
    let felt = trace.felt();
    let [console, follower] = bench.faults();
    Ok(NetworkRow {
        clock: clock.profile,
        condition,
        mode,
        error_n: felt.error_n,
        asked_error_n: felt.asked_error_n,
        tissue_n: felt.tissue_n,
        over_clean: None,
        over_same_playout: None,
        over_reflection: None,
        injected_mj: 1e3 * felt.injected_j,
        tissue_injected_mj: 1e3 * felt.tissue_injected_j,
        oscillation_n: felt.oscillation_n,
        tissue_oscillation_n: felt.tissue_oscillation_n,
        ceiling_breaches: counting.breaches.ceiling + counting.breaches.not_finite,
        slew_breaches: counting.breaches.slew,
        without_force_ms: felt.without_force_ms,
        force_after_data_ms: f64::from(counting.force_after) * 1e3 / RATE_HZ,
        engaged: felt.engaged,
        stops: operator.stops,
        resumed: operator.resumed,
        console_faults: console.clone(),
        follower_faults: follower.clone(),
        return_step_mm: counting.step_m.map(|step_m| 1e3 * step_m),
        under_way_ms: counting.under_way.map(|(ticks, count)| ticks as f64 / count.max(1) as f64 * 1e3 / RATE_HZ),
        round_trip_ms: 1e3 * round_trip_s,
        late_percent: fractions.map(|fractions| fractions[0]),
        lost_percent: fractions.map(|fractions| fractions[1]),
        recovered_percent: fractions.map(|fractions| fractions[2]),
        copies: copies(&bench),
        clock_error_ms: 1e3 * counting.clock_error_s,
        clock_bound_ms: 1e3 * counting.clock_bound_s,
        clock_step_named_ms: clock_set.and_then(named),
    })
}

/// Returns the counts of the payloads to the follower and to the console.
fn counts(bench: &NetworkBench) -> [PlayoutCounts; 2] {
    let [console, follower] = bench.ends();
    [follower, console].map(|end| end.stream.figures(bench.now_s()).counts)
}

/// Returns the requested and used number of redundant copies at the end, to the follower and to the console.
fn copies(bench: &NetworkBench) -> [[usize; 2]; 2] {
    bench.ends().map(|end| end.stream.figures(bench.now_s()).copies).map(|copies| [copies.wanted, copies.used])
}

/// Returns the fractions of payloads that were late, lost and recovered, %.
fn fractions(before: &[PlayoutCounts; 2], after: &[PlayoutCounts; 2]) -> [[f64; 3]; 2] {
    std::array::from_fn(|way| {
        let before = &before[way];
        let after = &after[way];
        let [delivered, late, lost, recovered] = [
            after.delivered - before.delivered,
            after.late - before.late,
            after.lost - before.lost,
            after.recovered - before.recovered,
        ];
        let all = (delivered + lost).max(1) as f64;
        [late, lost, recovered].map(|count| 100.0 * count as f64 / all)
    })
}
