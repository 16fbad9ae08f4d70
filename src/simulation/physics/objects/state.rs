//! State of each ring.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::SIDES;

use super::{Objects, RingNote};
use crate::physics::{ring::Ring, setting::ViewBox};

/// Minimum pressure of both fingers on a ring that counts as held, N: with a friction of 0.4 just enough for 2 g.
const HOLDS_N: f64 = 0.03;
/// A ring that is out of view for this long without being held is lost, s.
const LOST_AFTER_S: f64 = 0.1;
/// Beyond this distance from the origin a ring is lost even if it is held, m.
const LOST_BEYOND_M: f64 = 1.5;
/// A ring that is more upright than this is not on a peg: cosine of the angle between its axis and the vertical.
const UPRIGHT: f64 = 0.2;

/// State of a ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RingActivity {
    /// On a peg, counted from 0, and not held by jaws.
    OnPeg(usize),
    /// Both fingers of one instrument, or of both, press the ring from opposite sides.
    Held {
        /// The instruments that hold it.
        by: [bool; SIDES],
    },
    /// On the board, against a peg or on another ring.
    Lying,
    /// Touched by nothing, or by an instrument only.
    Falling,
    /// Lost out of view: the ring stays where it was.
    OutOfView,
}

/// A ring at the end of a step. Workspace frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingState {
    /// Middle, m.
    pub centre_m: Vector3<f64>,
    /// Orientation; z is the axis through the hole.
    pub world_from_ring: UnitQuaternion<f64>,
    pub doing: RingActivity,
    /// The peg through the ring, whether the ring is held or not.
    pub around: Option<usize>,
    /// Whether board, a peg or another ring touches it.
    pub supported: bool,
    /// The instruments that touch it.
    pub touched_by: [bool; SIDES],
    /// Whether it is nearly at rest.
    pub slow: bool,
}

/// Below this speed a ring looks at rest to an operator, m/s.
const SLOW_M_S: f64 = 0.01;

impl RingState {
    pub(super) fn of(ring: &Ring) -> Self {
        Self {
            centre_m: ring.centre_m,
            world_from_ring: ring.world_from_ring,
            doing: RingActivity::Falling,
            around: None,
            supported: false,
            touched_by: [false; SIDES],
            slow: false,
        }
    }
}

impl ViewBox {
    fn shows(&self, position_m: &Vector3<f64>) -> bool {
        (0..3).all(|axis| (self.from_m[axis]..=self.to_m[axis]).contains(&position_m[axis]))
    }
}

impl RingNote {
    fn held_by(&self) -> [bool; SIDES] {
        self.fingers_n.map(|[one, other]| {
            one.norm() > HOLDS_N && other.norm() > HOLDS_N && one.dot(&other) < -0.3 * one.norm() * other.norm()
        })
    }
}

impl Objects {
    /// Determines, at the end of a step, which rings are lost or at rest, and the published state of each.
    pub(super) fn report(&mut self) {
        for i in 0..self.rings.len() {
            let around = self.peg_in(&self.rings[i]);
            let view = *self.view();
            let ring = &mut self.rings[i];
            let note = &mut self.notes[i];
            let by = note.held_by();
            let held = by.contains(&true);
            if !ring.lost {
                let outside = !held && !view.shows(&ring.centre_m);
                note.outside_s = if outside { note.outside_s + self.period_s } else { 0.0 };
                if note.outside_s > LOST_AFTER_S || ring.centre_m.norm() > LOST_BEYOND_M {
                    ring.lose();
                }
                ring.settle(!note.touched_by.contains(&true), self.period_s);
                if !ring.asleep && ring.quiet() && note.supported {
                    ring.sleep();
                }
            }
            let supported = note.supported || ring.asleep;
            let doing = match around {
                _ if ring.lost => RingActivity::OutOfView,
                _ if held => RingActivity::Held { by },
                Some(peg) => RingActivity::OnPeg(peg),
                None if supported => RingActivity::Lying,
                None => RingActivity::Falling,
            };
            self.states[i] = RingState {
                centre_m: ring.centre_m,
                world_from_ring: ring.world_from_ring,
                doing,
                around,
                supported,
                touched_by: note.touched_by,
                slow: ring.velocity_m_s.norm() < SLOW_M_S,
            };
        }
    }

    /// Returns the peg through a ring.
    fn peg_in(&self, ring: &Ring) -> Option<usize> {
        let axis = ring.circle.axis;
        if axis.z.abs() < UPRIGHT {
            return None;
        }
        self.pegs.iter().position(|peg| {
            let across_m = peg.from_m - ring.centre_m;
            // Intersection of the peg's axis with the plane of the ring, relative to its middle.
            let up_m = -(axis.x * across_m.x + axis.y * across_m.y) / axis.z;
            let z_m = ring.centre_m.z + up_m;
            let through = across_m.xy().norm_squared() + up_m * up_m < ring.circle.radius_m * ring.circle.radius_m;
            through && z_m > peg.from_m.z && z_m < peg.to_m.z + self.setting.pegs.radius_m
        })
    }
}
