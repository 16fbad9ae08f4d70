//! Contacts of the rings.

use nalgebra::Vector3;
use nima_core::Side;

use super::{Objects, RingPair};
use crate::physics::{
    contact::{ContactMemory, ContactPair, ContactPush, ContactTouch, Law},
    geometry::{PLACES, Segment, unit_or},
    ring::Ring,
    tool::{PARTS, PhysicsTool, SHAFT},
};

/// An impact faster than this wakes a ring, m/s. A slower one does not move a resting ring visibly, and waking for it
/// would keep a stack of rings awake for ever.
const WAKES_M_S: f64 = 5e-3;
/// A ring this far below the surface of the board counts as next to the board, m. Without this limit a ring that fell
/// over the edge would be shot upwards as soon as it is under the board.
const BESIDE_M: f64 = 0.004;

impl Objects {
    /// Computes the forces on all rings, and the reactions on the instruments.
    pub(super) fn touch_rings(&mut self, step_s: f64) {
        for i in 0..self.rings.len() {
            if self.rings[i].lost {
                continue;
            }
            self.tools_on_ring(i, step_s);
            if self.rings[i].moves() {
                self.board_under_ring(i, step_s);
                self.pegs_in_ring(i, step_s);
            }
            for other in i + 1..self.rings.len() {
                self.ring_on_ring(i, other, step_s);
            }
        }
    }

    fn tools_on_ring(&mut self, i: usize, step_s: f64) {
        let ring = &mut self.rings[i];
        let note = &mut self.notes[i];
        note.fingers_n = Default::default();
        for side in Side::LEFT_TO_RIGHT.map(Side::index) {
            let pairs = &mut self.memories.ring_tools[i][side];
            let Some(tool) = &mut self.tools[side] else {
                pairs.iter_mut().for_each(ContactPair::forget);
                continue;
            };
            for part in 0..PARTS {
                let pressed_n = tool_on_ring(ring, tool, part, &mut pairs[part], &self.laws.jaw_ring, step_s);
                let Some(pressed_n) = pressed_n else { continue };
                note.touched_by[side] = true;
                tool.touching.ring = true;
                if part != SHAFT {
                    note.fingers_n[side][part] = pressed_n;
                }
            }
        }
    }

    fn board_under_ring(&mut self, i: usize, step_s: f64) {
        let ring = &mut self.rings[i];
        let memories = &mut self.memories.ring_board[i];
        let board = &self.setting.board;
        // Too high to touch, whatever its tilt; this test saves most of the work for a carried ring.
        if ring.centre_m.z > board.z_m + ring.reach_m() {
            return;
        }
        let half_m = board.size_m.map(|size_m| 0.5 * size_m);
        for (memory, position_m) in memories.iter_mut().zip(ring.places_m) {
            let depth_m = board.z_m + ring.tube_radius_m - position_m.z;
            let above = position_m.x.abs() <= half_m[0] && position_m.y.abs() <= half_m[1];
            if depth_m <= 0.0 || depth_m > ring.tube_radius_m + BESIDE_M || !above {
                *memory = ContactMemory::default();
                continue;
            }
            // The force acts in the middle of the overlap.
            let touched_m = position_m - Vector3::z() * (ring.tube_radius_m - 0.5 * depth_m);
            let touch = ContactTouch {
                depth_m,
                normal: Vector3::z(),
                velocity_m_s: ring.velocity_at(&touched_m),
                spin_rad_s: 0.0,
            };
            let push = self.laws.ring_board.push(memory, &touch, step_s);
            ring.push(&touched_m, &push);
            self.notes[i].supported = true;
        }
    }

    fn pegs_in_ring(&mut self, i: usize, step_s: f64) {
        let ring = &mut self.rings[i];
        let radius_m = self.setting.pegs.radius_m;
        let far_m = ring.reach_m() + radius_m;
        let top_m = self.setting.board.z_m + self.setting.pegs.height_m + ring.reach_m();
        for (peg, segment) in self.pegs.iter().enumerate() {
            let pair = &mut self.memories.ring_pegs[i * self.pegs.len() + peg];
            let across_m = (ring.centre_m - segment.from_m).xy().norm_squared();
            if across_m > far_m * far_m || ring.centre_m.z > top_m {
                pair.forget();
                continue;
            }
            let touched = capsule_on_ring(ring, segment, radius_m, pair, |ring, memory, contact| {
                let touch = ContactTouch { velocity_m_s: ring.velocity_at(&contact.position_m), ..contact.touch };
                self.laws.ring_peg.push(memory, &touch, step_s)
            });
            self.notes[i].supported |= touched;
        }
    }

    fn ring_on_ring(&mut self, i: usize, other: usize, step_s: f64) {
        let pair = &mut self.memories.ring_rings[i * self.notes.len() + other];
        // Two mutable borrows of one list: it must be split between them.
        let (before, after) = self.rings.split_at_mut(other);
        let a = &mut before[i];
        let b = &mut after[0];
        let still = !a.moves() && !b.moves();
        let far_m = a.reach_m() + b.reach_m();
        if still || b.lost {
            return;
        }
        let touching = (a.centre_m - b.centre_m).norm_squared() < far_m * far_m
            && places_on_ring(a, b, pair, &self.laws.ring_ring, step_s);
        if touching {
            self.notes[i].supported = true;
            self.notes[other].supported = true;
            let fast = (a.velocity_m_s - b.velocity_m_s).norm() > WAKES_M_S;
            let led = |i: usize| self.notes[i].touched_by.contains(&true);
            if fast || led(i) || led(other) {
                wake_both(a, b);
            }
        } else if pair.touched {
            // A ring that rested on the other one must not stay in the air.
            wake_both(a, b);
            *pair = RingPair::default();
        }
        pair.touched = touching;
    }
}

fn wake_both(a: &mut Ring, b: &mut Ring) {
    for ring in [a, b] {
        if ring.asleep {
            ring.wake();
        }
    }
}

/// One contact of a capsule with a ring; the normal points to the ring.
struct RingContact {
    position_m: Vector3<f64>,
    touch: ContactTouch,
}

/// Applies `law` wherever the capsule touches the ring; returns whether it does.
fn capsule_on_ring(
    ring: &mut Ring,
    segment: &Segment,
    radius_m: f64,
    pair: &mut ContactPair,
    mut law: impl FnMut(&Ring, &mut ContactMemory, &RingContact) -> ContactPush,
) -> bool {
    let reach_m = ring.tube_radius_m + radius_m;
    let nearest = ring.circle.nearest(&ring.places_m, segment, reach_m);
    if nearest[0].is_none() {
        pair.forget();
        return false;
    }
    let ring_from_world = ring.world_from_ring.inverse();
    let on_ring_m = nearest.map(|nearest| nearest.map(|[ours_m, _]| ring_from_world * (ours_m - ring.centre_m)));
    // The contacts are identified by their place on the ring and not by their order, because the order changes while a
    // ring rolls.
    let mut memories = pair.of(on_ring_m);
    pair.forget();
    for (place, nearest) in nearest.iter().enumerate() {
        let (Some([ours_m, theirs_m]), Some(on_ring_m)) = (nearest, on_ring_m[place]) else { continue };
        let (normal, distance_m) = unit_or(&(ours_m - theirs_m), &ring.circle.axis);
        let depth_m = reach_m - distance_m;
        let position_m = theirs_m + normal * (radius_m - 0.5 * depth_m);
        let touch = ContactTouch { depth_m, normal, velocity_m_s: Vector3::zeros(), spin_rad_s: 0.0 };
        let push = law(ring, &mut memories[place], &RingContact { position_m, touch });
        ring.push(&position_m, &push);
        pair.keep(place, on_ring_m, memories[place]);
    }
    true
}

/// Returns the contact of one part of an instrument with a ring: its pressure, N towards the ring, if it touches.
fn tool_on_ring(
    ring: &mut Ring,
    tool: &mut PhysicsTool,
    part: usize,
    pair: &mut ContactPair,
    law: &Law,
    step_s: f64,
) -> Option<Vector3<f64>> {
    let segment = tool.parts[part];
    let radius_m = tool.radii_m[part];
    let mut pressed_n = Vector3::zeros();
    let touched = capsule_on_ring(ring, &segment, radius_m, pair, |ring, memory, contact| {
        let RingContact { position_m, touch } = contact;
        let touch = ContactTouch {
            velocity_m_s: ring.velocity_at(position_m) - tool.velocity_at(part, position_m),
            spin_rad_s: ring.turning_rad_s.dot(&touch.normal) - tool.spin_about(part, &touch.normal),
            ..*touch
        };
        let push = law.push(memory, &touch, step_s);
        pressed_n += touch.normal * push.normal_n;
        tool.push(part, position_m, &push.reverse());
        push
    });
    // An instrument wakes at any speed: a ring that ignores a slow finger would look glued to the board.
    if touched && ring.asleep {
        ring.wake();
    }
    touched.then_some(pressed_n)
}

/// Applies the contacts of a ring with the tube of another; returns whether there are any.
fn places_on_ring(a: &mut Ring, b: &mut Ring, pair: &mut RingPair, law: &Law, step_s: f64) -> bool {
    let reach_m = a.tube_radius_m + b.tube_radius_m;
    let mut touching = false;
    for place in 0..PLACES {
        let memory = &mut pair.places[place];
        let ours_m = a.places_m[place];
        let theirs_m = b.circle.closest(&ours_m);
        let (normal, distance_m) = unit_or(&(ours_m - theirs_m), &b.circle.axis);
        let depth_m = reach_m - distance_m;
        if depth_m <= 0.0 {
            *memory = ContactMemory::default();
            continue;
        }
        touching = true;
        let position_m = theirs_m + normal * (b.tube_radius_m - 0.5 * depth_m);
        let velocity_m_s = a.velocity_at(&position_m) - b.velocity_at(&position_m);
        let push = law.push(memory, &ContactTouch { depth_m, normal, velocity_m_s, spin_rad_s: 0.0 }, step_s);
        a.push(&position_m, &push);
        b.push(&position_m, &push.reverse());
    }
    touching
}
