//! When peg transfer is done: every ring was on a peg of the other side, and is home again.

use nima_core::{Side, task::Event};

use crate::physics::setting::{Setting, Start};

/// How far a ring has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// It has to go to the other side.
    Outward,
    /// It was there, and has to come home.
    Homeward,
    Home,
    /// Out of the picture: it cannot come any more.
    Lost,
}

/// The state of peg transfer, from its events. Rings that were lost out of view are not waited for.
///
/// ```
/// use nima_core::Side;
/// use nima_simulation::physics::{PegTransfer, Setting, Start};
/// use nima_core::task::Event;
///
/// let mut task = PegTransfer::new(&Setting { rings: vec![Start::Peg(0)], ..Setting::default() });
/// assert_eq!(task.goal(0), Some(Side::Right), "peg 0 is on the left");
/// task.take(Event::RingPlaced { ring: 0, side: Side::Right, peg: 7 });
/// assert_eq!((task.goal(0), task.is_done()), (Some(Side::Left), false));
/// task.take(Event::RingPlaced { ring: 0, side: Side::Left, peg: 1 });
/// assert_eq!((task.goal(0), task.is_done()), (None, true));
/// ```
#[derive(Clone, Debug)]
pub struct PegTransfer {
    pegs: Vec<Side>,
    rings: Vec<(Side, Stage)>,
}

fn side_of(x_m: f64) -> Side {
    if x_m < 0.0 { Side::Left } else { Side::Right }
}

impl PegTransfer {
    /// At the beginning: every ring is at home.
    pub fn new(setting: &Setting) -> Self {
        let pegs: Vec<Side> = setting.pegs.at_m.iter().map(|[x_m, _]| side_of(*x_m)).collect();
        let home = |start: &Start| match start {
            Start::Peg(peg) => pegs.get(*peg).copied().unwrap_or(Side::Left),
            Start::At([x_m, ..]) => side_of(*x_m),
        };
        let rings = setting.rings.iter().map(|start| (home(start), Stage::Outward)).collect();
        Self { pegs, rings }
    }

    /// Takes what happened.
    pub fn take(&mut self, event: Event) {
        match event {
            Event::RingPlaced { ring, peg, .. } => {
                let Some(((home, stage), on)) = self.rings.get_mut(ring).zip(self.pegs.get(peg)) else { return };
                *stage = match *stage {
                    Stage::Outward if on != home => Stage::Homeward,
                    Stage::Homeward if on == home => Stage::Home,
                    stage => stage,
                };
            }
            Event::RingLifted { ring, .. } | Event::RingKnockedOff { ring, .. } => {
                if let Some((_, stage @ Stage::Home)) = self.rings.get_mut(ring) {
                    *stage = Stage::Homeward;
                }
            }
            Event::RingDropped { ring, in_view: false, .. } => {
                if let Some((_, stage)) = self.rings.get_mut(ring) {
                    *stage = Stage::Lost;
                }
            }
            _ => {}
        }
    }

    /// The side to whose pegs a ring has to go; `None` if it is home again, lost or no ring.
    pub fn goal(&self, ring: usize) -> Option<Side> {
        match self.rings.get(ring)? {
            (home, Stage::Outward) => Some(home.other()),
            (home, Stage::Homeward) => Some(*home),
            (_, Stage::Home | Stage::Lost) => None,
        }
    }

    /// Whether no ring has to go anywhere, and there is at least one.
    pub fn is_done(&self) -> bool {
        !self.rings.is_empty() && (0..self.rings.len()).all(|ring| self.goal(ring).is_none())
    }
}
