//! A loop whose tap is read into memory.

use std::{thread, time::Duration};

use nima_machine::{
    messages::{Command, Tick},
    runtime::{self, Assembly, TapEnd, TapItem, tap},
};
use nima_session::{
    journal::JournalStart,
    journal_writer::{JournalWriter, TimedMessage},
    replay::{Journal, ReplayError, ReplayOutcome, decoded, replay, verify},
};
use nima_simulation::SimulationPlan;

#[derive(Clone, Debug, Default)]
pub(crate) struct JournalMessages(pub(crate) Vec<Vec<u8>>);

impl JournalMessages {
    /// Reads a tap until its loop has ended.
    pub(crate) fn of(start: &JournalStart, end: &TapEnd) -> Self {
        let (mut scribe, TimedMessage { bytes, .. }) = JournalWriter::new(start).unwrap();
        let mut kept = vec![bytes];
        loop {
            match end.next(Duration::from_millis(100)) {
                TapItem::Entry(entry) => scribe.take(entry, end, &mut kept).unwrap(),
                TapItem::Nothing => {}
                TapItem::End => break,
            }
        }
        scribe.end(end, &mut kept).unwrap();
        Self(kept)
    }

    /// Replays it; every tick is passed to `each`.
    pub(crate) fn replayed(&self, mut each: impl FnMut(&Tick)) -> Result<ReplayOutcome, ReplayError> {
        let journal = || Journal::open(decoded(self.0.iter().map(|bytes| Ok(bytes.clone())), 0));
        let one_by_one = replay(journal()?, |replayed| replayed.ticks.iter().flatten().for_each(&mut each));
        let side_by_side = verify(journal()?, &(0.0..f64::INFINITY), |_| ());
        assert_eq!(format!("{one_by_one:?}"), format!("{side_by_side:?}"), "both ways of replaying");
        one_by_one
    }
}

pub(crate) fn start_of(plan: &SimulationPlan) -> JournalStart {
    JournalStart { program: "test".to_owned(), origin: plan.origin() }
}

/// Runs the simulated world of this plan on the virtual clock.
pub(crate) fn record(
    plan: &SimulationPlan,
    seconds: f64,
    each: impl FnMut(&Tick) -> Option<Command>,
) -> JournalMessages {
    record_on(plan, plan.simulated().unwrap(), seconds, each)
}

/// Like [`record`], with a given rig.
pub(crate) fn record_on(
    plan: &SimulationPlan,
    assembly: Assembly,
    seconds: f64,
    each: impl FnMut(&Tick) -> Option<Command>,
) -> JournalMessages {
    let (tap, end) = tap();
    let start = start_of(plan);
    let reader = thread::spawn(move || JournalMessages::of(&start, &end));
    runtime::run_virtual(Assembly { tap: Some(tap), ..assembly }, seconds, each);
    reader.join().unwrap()
}
