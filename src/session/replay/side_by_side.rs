//! Runs the ticks of both arms in parallel, one thread for each arm.
//!
//! Between two operations the arms share one input: whether the other arm had failed after the previous tick. It rarely
//! changes. So each arm is stepped as if it did not change; if it did, both are restarted from earlier copies and
//! stepped one after the other. The result equals that of [`Loop::step`] to the bit. Synchronising the threads at every
//! tick would be faster on an idle computer, but slower than one thread on a busy one.

use std::{
    io,
    thread::{self, Builder},
};

use nima_machine::{
    messages::Event,
    rig::{Outputs, SIDES, Side},
    teleop::{Loop, Pair},
};

use super::{ReplayError, is_from};
use crate::{
    digest::{DigestCheck, STAGES, of_side},
    journal::TickRow,
};

/// With fewer ticks, the copies, each of 13 MB, cost more time than they save.
const MIN_TICKS: usize = 2000;

/// Outputs of a run of ticks.
#[derive(Debug)]
pub(super) struct RunOutput {
    /// Commands that were refused before its first tick.
    refused: Vec<Event>,
    sides: [SideBySideLane; SIDES],
}

/// Outputs of one side.
#[derive(Debug, Default)]
struct SideBySideLane {
    /// One per compared tick.
    digests: Vec<[u64; STAGES]>,
    /// With the index of their tick in the run.
    events: Vec<(usize, Event)>,
}

impl RunOutput {
    /// Steps the loop with these rows. Rows before `from_s` (loop time, s) are not compared, so their digests are not
    /// computed.
    pub(super) fn of(control: &mut Loop, rows: &[Vec<TickRow>], from_s: f64) -> Result<Self, ReplayError> {
        let refused = control.refusals().copied().collect();
        let sides = match control.pairs_mut() {
            [Some(right), Some(left)] => both([right, left], rows, from_s)?,
            pairs => pairs.map(|pair| match pair {
                Some(pair) => of_one(pair, rows, from_s),
                None => absent(rows, from_s),
            }),
        };
        control.clear_events();
        Ok(Self { refused, sides })
    }

    /// Returns, for each row that is compared, its index, the row, and its newly computed check.
    pub(super) fn checks<'a>(
        &'a self,
        rows: &'a [Vec<TickRow>],
        from_s: f64,
    ) -> impl Iterator<Item = (usize, &'a TickRow, DigestCheck)> {
        let Self { refused, sides: [right, left] } = self;
        let rows = rows.iter().flatten().enumerate().filter(move |(_, row)| is_compared(row, from_s));
        rows.zip(right.digests.iter().zip(&left.digests)).map(move |((number, row), (right_now, left_now))| {
            let refused = refused.iter().filter(move |_| number == 0);
            let events = refused.chain(right.events_of(number)).chain(left.events_of(number));
            (number, row, DigestCheck::of_sides(events, [*right_now, *left_now]))
        })
    }
}

impl SideBySideLane {
    fn step(&mut self, pair: &mut Pair, other_has_failed: bool, number: usize, row: &TickRow, from_s: f64) {
        let (outputs, tick) = pair.step(other_has_failed, row.inputs[pair.side().index()], &row.timing);
        self.events.extend(pair.events().map(|event| (number, *event)));
        pair.clear_events();
        if is_compared(row, from_s) {
            self.digests.push(of_side(&outputs, Some(&tick)));
        }
    }

    fn events_of(&self, tick: usize) -> impl Iterator<Item = &Event> {
        let first = self.events.partition_point(|(of, _)| *of < tick);
        self.events[first..].iter().take_while(move |(of, _)| *of == tick).map(|(_, event)| event)
    }
}

pub(super) fn is_compared(row: &TickRow, from_s: f64) -> bool {
    is_from(row.timing.now_s, from_s)
}

/// Returns a side without a pair.
fn absent(rows: &[Vec<TickRow>], from_s: f64) -> SideBySideLane {
    let compared = rows.iter().flatten().filter(|row| is_compared(row, from_s)).count();
    SideBySideLane { digests: vec![of_side(&Outputs::SAFE, None); compared], events: Vec::new() }
}

/// Returns the only pair.
fn of_one(pair: &mut Pair, rows: &[Vec<TickRow>], from_s: f64) -> SideBySideLane {
    let mut lane = SideBySideLane::default();
    rows.iter().flatten().enumerate().for_each(|(number, row)| lane.step(pair, false, number, row, from_s));
    lane
}

/// Steps each pair on its own thread if that is faster and correct; otherwise one after the other.
fn both(
    pairs: [&mut Box<Pair>; SIDES],
    rows: &[Vec<TickRow>],
    from_s: f64,
) -> Result<[SideBySideLane; SIDES], ReplayError> {
    let [right, left] = pairs;
    if rows.iter().map(Vec::len).sum::<usize>() >= MIN_TICKS {
        let had_failed = [right.has_failed(), left.has_failed()];
        let [of_right, of_left] = thread::scope(|scope| {
            let there = || alone(left, rows, from_s, had_failed[0]);
            let name = format!("{} arm", Side::Left.word());
            let there = Builder::new().name(name).spawn_scoped(scope, there)?;
            let here = alone(right, rows, from_s, had_failed[1]);
            Ok::<_, io::Error>([here, there.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))])
        })
        .map_err(ReplayError::Thread)?;
        match (of_right, of_left) {
            (LonePair { lane: here, changes: false, .. }, LonePair { lane: there, changes: false, .. }) => {
                return Ok([here, there]);
            }
            (here, there) => (*right, *left) = (here.before, there.before),
        }
    }
    let mut lanes: [SideBySideLane; SIDES] = Default::default();
    for (number, row) in rows.iter().flatten().enumerate() {
        let have_failed = [right.has_failed(), left.has_failed()];
        lanes[0].step(right, have_failed[1], number, row, from_s);
        lanes[1].step(left, have_failed[0], number, row, from_s);
    }
    Ok(lanes)
}

/// A pair that was stepped without the other one.
struct LonePair {
    lane: SideBySideLane,
    /// Copy from before the run.
    before: Box<Pair>,
    /// The arm failed or recovered before the last tick, so the other pair must be stepped again.
    changes: bool,
}

fn alone(pair: &mut Box<Pair>, rows: &[Vec<TickRow>], from_s: f64, other_has_failed: bool) -> LonePair {
    let before = pair.clone();
    let had_failed = pair.has_failed();
    let mut lane = SideBySideLane::default();
    let mut changes = false;
    for (number, row) in rows.iter().flatten().enumerate() {
        changes |= pair.has_failed() != had_failed;
        lane.step(pair, other_has_failed, number, row, from_s);
    }
    LonePair { lane, before, changes }
}
