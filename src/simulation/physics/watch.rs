//! Tells from the rings what happens. What lasts only a moment is no event: a ring that slips for 10 ms and is caught was not dropped.

mod following;

use std::collections::VecDeque;

use nima_core::{Side, task::Event};

use crate::physics::objects::Objects;
use following::Following;

/// Most events that wait to be taken; later ones are lost, and counted.
const WAITING_MOST: usize = 256;

/// Watches the rings.
///
/// ```
/// use nima_simulation::physics::{Objects, Setting, Watch};
///
/// let mut objects = Objects::new(&Setting::default(), 1e-3);
/// let mut watch = Watch::new(&objects);
/// objects.step(&[None, None]);
/// watch.look(&objects);
/// assert_eq!(watch.next_event(), None, "nobody has touched anything");
/// ```
#[derive(Clone, Debug)]
pub struct Watch {
    rings: Vec<Following>,
    waiting: VecDeque<Event>,
    missed: u64,
    /// Who touched any ring last.
    last: Option<Side>,
}

impl Watch {
    /// Begins to watch; where the rings are now is no event.
    pub fn new(objects: &Objects) -> Self {
        Self {
            rings: objects.rings().iter().map(Following::new).collect(),
            waiting: VecDeque::with_capacity(WAITING_MOST),
            missed: 0,
            last: None,
        }
    }

    /// Looks at the rings after a step; once for each step.
    pub fn look(&mut self, objects: &Objects) {
        for (ring, (following, state)) in self.rings.iter_mut().zip(objects.rings()).enumerate() {
            // The right one counts as the last if both touch.
            for side in Side::LEFT_TO_RIGHT {
                if state.touched_by[side.index()] {
                    self.last = Some(side);
                }
            }
            let waiting = &mut self.waiting;
            let missed = &mut self.missed;
            following.look(ring, state, self.last, objects.period_s(), &mut |event| {
                if waiting.len() < WAITING_MOST {
                    waiting.push_back(event);
                } else {
                    *missed += 1;
                }
            });
        }
    }

    /// The next event that was not yet taken.
    pub fn next_event(&mut self) -> Option<Event> {
        self.waiting.pop_front()
    }

    /// Events that were lost because nobody took them.
    pub const fn missed(&self) -> u64 {
        self.missed
    }
}
