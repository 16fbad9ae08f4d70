//! Detects the events of the rings. Very short states are not events: a ring that slips for 10 ms and is caught was not
//! dropped.

mod following;

use std::collections::VecDeque;

use nima_core::{Side, task::TaskEvent};

use crate::physics::objects::Objects;
use following::RingFollower;

/// Maximum number of waiting events; further events are dropped and counted.
const WAITING_MAX: usize = 256;

/// ```
/// use nima_simulation::physics::{Objects, ObjectSettings, RingWatch};
///
/// let mut objects = Objects::new(&ObjectSettings::default(), 1e-3);
/// let mut watch = RingWatch::new(&objects);
/// objects.step(&[None, None]);
/// watch.look(&objects);
/// assert_eq!(watch.next_event(), None, "nothing was touched");
/// ```
#[derive(Clone, Debug)]
pub struct RingWatch {
    rings: Vec<RingFollower>,
    waiting: VecDeque<TaskEvent>,
    missed: u64,
    /// The side that last touched any ring.
    last: Option<Side>,
}

impl RingWatch {
    /// Begins to watch; the current states of the rings are not events.
    pub fn new(objects: &Objects) -> Self {
        Self {
            rings: objects.rings().iter().map(RingFollower::new).collect(),
            waiting: VecDeque::with_capacity(WAITING_MAX),
            missed: 0,
            last: None,
        }
    }

    /// Begins again, without allocating.
    pub fn begin(&mut self, objects: &Objects) {
        for (following, state) in self.rings.iter_mut().zip(objects.rings()) {
            *following = RingFollower::new(state);
        }
        self.waiting.clear();
        self.last = None;
    }

    /// Examines the rings after a step; call it once for each step.
    pub fn look(&mut self, objects: &Objects) {
        for (ring, (following, state)) in self.rings.iter_mut().zip(objects.rings()).enumerate() {
            // If both instruments touch a ring, the right one counts as the last.
            for side in Side::LEFT_TO_RIGHT {
                if state.touched_by[side.index()] {
                    self.last = Some(side);
                }
            }
            let waiting = &mut self.waiting;
            let missed = &mut self.missed;
            following.look(ring, state, self.last, objects.period_s(), &mut |event| {
                if waiting.len() < WAITING_MAX {
                    waiting.push_back(event);
                } else {
                    *missed += 1;
                }
            });
        }
    }

    /// Returns the next event that has not been taken yet.
    pub fn next_event(&mut self) -> Option<TaskEvent> {
        self.waiting.pop_front()
    }

    /// Returns the number of events that were dropped because the queue was full.
    pub const fn missed(&self) -> u64 {
        self.missed
    }
}
