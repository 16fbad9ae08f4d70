//! Detects the end of peg transfer: every ring was on a peg of the other side and has returned.

use nima_core::{Side, task::TaskEvent};

use crate::physics::setting::{ObjectSettings, RingStart};

/// Progress of a ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RingStage {
    /// On the way to the other side.
    Outward,
    /// The ring was on the other side and has to return.
    Homeward,
    Home,
    /// Out of view and not recoverable.
    Lost,
}

/// The state of peg transfer, computed from its events. Rings that were lost out of view are ignored.
///
/// ```
/// use nima_core::Side;
/// use nima_simulation::physics::{PegTransfer, ObjectSettings, RingStart};
/// use nima_core::task::TaskEvent;
///
/// let mut task = PegTransfer::new(&ObjectSettings { rings: vec![RingStart::Peg(0)], ..ObjectSettings::default() });
/// assert_eq!(task.goal(0), Some(Side::Right), "peg 0 is on the left");
/// task.take(TaskEvent::RingPlaced { ring: 0, side: Side::Right, peg: 7 });
/// assert_eq!((task.goal(0), task.is_done(), task.fraction()), (Some(Side::Left), false, 0.5));
/// task.take(TaskEvent::RingPlaced { ring: 0, side: Side::Left, peg: 1 });
/// assert_eq!((task.goal(0), task.is_done()), (None, true));
/// ```
#[derive(Clone, Debug)]
pub struct PegTransfer {
    pegs: Vec<Side>,
    rings: Vec<(Side, RingStage)>,
}

fn side_of(x_m: f64) -> Side {
    if x_m < 0.0 { Side::Left } else { Side::Right }
}

impl PegTransfer {
    /// Creates the beginning: every ring is on its own side.
    pub fn new(setting: &ObjectSettings) -> Self {
        let pegs: Vec<Side> = setting.pegs.position_m.iter().map(|[x_m, _]| side_of(*x_m)).collect();
        let home = |start: &RingStart| match start {
            RingStart::Peg(peg) => pegs.get(*peg).copied().unwrap_or(Side::Left),
            RingStart::At([x_m, ..]) => side_of(*x_m),
        };
        let rings = setting.rings.iter().map(|start| (home(start), RingStage::Outward)).collect();
        Self { pegs, rings }
    }

    /// Returns to the beginning.
    pub fn begin(&mut self) {
        self.rings.iter_mut().for_each(|(_, stage)| *stage = RingStage::Outward);
    }

    /// Returns the fraction of the ways that are done, 0 to 1: each ring goes to the other side and back.
    pub fn fraction(&self) -> f64 {
        let ways_left = |(_, stage): &(Side, RingStage)| match stage {
            RingStage::Outward => 2.0,
            RingStage::Homeward => 1.0,
            RingStage::Home | RingStage::Lost => 0.0,
        };
        let left: f64 = self.rings.iter().map(ways_left).sum();
        1.0 - left / (2.0 * self.rings.len().max(1) as f64)
    }

    /// Processes an event.
    pub fn take(&mut self, event: TaskEvent) {
        match event {
            TaskEvent::RingPlaced { ring, peg, .. } => {
                let Some(((home, stage), on)) = self.rings.get_mut(ring).zip(self.pegs.get(peg)) else { return };
                *stage = match *stage {
                    RingStage::Outward if on != home => RingStage::Homeward,
                    RingStage::Homeward if on == home => RingStage::Home,
                    stage => stage,
                };
            }
            TaskEvent::RingLifted { ring, .. } | TaskEvent::RingKnockedOff { ring, .. } => {
                if let Some((_, stage @ RingStage::Home)) = self.rings.get_mut(ring) {
                    *stage = RingStage::Homeward;
                }
            }
            TaskEvent::RingDropped { ring, in_view: false, .. } => {
                if let Some((_, stage)) = self.rings.get_mut(ring) {
                    *stage = RingStage::Lost;
                }
            }
            _ => {}
        }
    }

    /// Returns the side to whose pegs a ring has to go; `None` if it has returned, is lost, or does not exist.
    pub fn goal(&self, ring: usize) -> Option<Side> {
        match self.rings.get(ring)? {
            (home, RingStage::Outward) => Some(home.other()),
            (home, RingStage::Homeward) => Some(*home),
            (_, RingStage::Home | RingStage::Lost) => None,
        }
    }

    /// Returns whether there is at least one ring and no ring has to go anywhere.
    pub fn is_done(&self) -> bool {
        !self.rings.is_empty() && (0..self.rings.len()).all(|ring| self.goal(ring).is_none())
    }
}
