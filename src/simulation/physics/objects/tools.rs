//! Contacts of instruments with board, pegs and each other.

use nalgebra::Vector3;

use super::Objects;
use crate::physics::{
    contact::{ContactMemory, ContactTouch, Law},
    geometry::{Segment, unit_or},
    tool::{PARTS, PhysicsTool},
};

impl Objects {
    pub(super) fn touch_tools(&mut self, step_s: f64) {
        let law = self.laws.instrument;
        let radius_m = self.setting.pegs.radius_m;
        let top_m = self.setting.board.z_m + self.setting.pegs.height_m;
        for (side, tool) in self.tools.iter_mut().enumerate() {
            let Some(tool) = tool else {
                self.memories.tool_board[side] = [ContactMemory::default(); PARTS];
                self.memories
                    .tool_pegs
                    .iter_mut()
                    .for_each(|memories| memories[side] = [ContactMemory::default(); PARTS]);
                continue;
            };
            let board = &self.setting.board;
            let half_m = board.size_m.map(|size_m| 0.5 * size_m);
            board_under_tool(tool, board.z_m, half_m, &law, &mut self.memories.tool_board[side], step_s);
            for part in 0..PARTS {
                if tool.lowest_m(part) > top_m {
                    continue;
                }
                for (peg, memories) in self.pegs.iter().zip(&mut self.memories.tool_pegs) {
                    peg_on_tool(tool, part, peg, radius_m, &law, &mut memories[side][part], step_s);
                }
            }
        }
        self.tool_on_tool(step_s);
    }

    fn tool_on_tool(&mut self, step_s: f64) {
        let law = self.laws.instrument;
        let [Some(right), Some(left)] = &mut self.tools else {
            self.memories.tool_tool = [[ContactMemory::default(); PARTS]; PARTS];
            return;
        };
        for (ours, memories) in self.memories.tool_tool.iter_mut().enumerate() {
            for (theirs, memory) in memories.iter_mut().enumerate() {
                let [ours_m, theirs_m] = left.parts[ours].closest_pair(&right.parts[theirs]);
                let Some((position_m, touch)) =
                    between(&ours_m, left.radii_m[ours], &theirs_m, right.radii_m[theirs], &Vector3::x())
                else {
                    *memory = ContactMemory::default();
                    continue;
                };
                let velocity_m_s = left.velocity_at(ours, &position_m) - right.velocity_at(theirs, &position_m);
                let push = law.push(memory, &ContactTouch { velocity_m_s, ..touch }, step_s);
                left.push(ours, &position_m, &push);
                right.push(theirs, &position_m, &push.reverse());
                left.touching.other_instrument = true;
                right.touching.other_instrument = true;
            }
        }
    }
}

/// Returns the contact of two spheres at these positions: position and geometry; the normal points to the first.
fn between(
    ours_m: &Vector3<f64>,
    our_radius_m: f64,
    theirs_m: &Vector3<f64>,
    their_radius_m: f64,
    otherwise: &Vector3<f64>,
) -> Option<(Vector3<f64>, ContactTouch)> {
    let (normal, distance_m) = unit_or(&(ours_m - theirs_m), otherwise);
    let depth_m = our_radius_m + their_radius_m - distance_m;
    let position_m = theirs_m + normal * (their_radius_m - 0.5 * depth_m);
    let touch = ContactTouch { depth_m, normal, velocity_m_s: Vector3::zeros(), spin_rad_s: 0.0 };
    (depth_m > 0.0).then_some((position_m, touch))
}

/// Applies the contact of the finger ends and of the shaft with the board.
fn board_under_tool(
    tool: &mut PhysicsTool,
    z_m: f64,
    half_m: [f64; 2],
    law: &Law,
    memories: &mut [ContactMemory; PARTS],
    step_s: f64,
) {
    for (part, memory) in memories.iter_mut().enumerate() {
        let end_m = tool.parts[part].to_m;
        let radius_m = tool.radii_m[part];
        let depth_m = z_m + radius_m - end_m.z;
        if depth_m <= 0.0 || end_m.x.abs() > half_m[0] || end_m.y.abs() > half_m[1] {
            *memory = ContactMemory::default();
            continue;
        }
        let position_m = end_m - Vector3::z() * radius_m;
        let velocity_m_s = tool.velocity_at(part, &position_m);
        let push =
            law.push(memory, &ContactTouch { depth_m, normal: Vector3::z(), velocity_m_s, spin_rad_s: 0.0 }, step_s);
        tool.push(part, &position_m, &push);
        tool.touching.board = true;
    }
}

fn peg_on_tool(
    tool: &mut PhysicsTool,
    part: usize,
    peg: &Segment,
    radius_m: f64,
    law: &Law,
    memory: &mut ContactMemory,
    step_s: f64,
) {
    let [ours_m, theirs_m] = tool.parts[part].closest_pair(peg);
    let Some((position_m, touch)) = between(&ours_m, tool.radii_m[part], &theirs_m, radius_m, &Vector3::x()) else {
        *memory = ContactMemory::default();
        return;
    };
    let velocity_m_s = tool.velocity_at(part, &position_m);
    let push = law.push(memory, &ContactTouch { velocity_m_s, ..touch }, step_s);
    tool.push(part, &position_m, &push);
    tool.touching.peg = true;
}
