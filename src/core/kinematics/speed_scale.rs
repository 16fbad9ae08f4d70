//! Computes how much of a planned step may be taken, given the acceleration limits of the joints. One factor applies to
//! all joints, so that the shaft stays in the trocar. Steps are in rad per period.

use super::{arm_model::JOINTS, joint_chain::Joints};

/// Returns the largest first step on a path of length `way` (in the same unit) that still leaves room to stop, when
/// each period may reduce the step by `braking`: `v^2 / 2a + v = way`. Without a limit on braking it is the whole path.
pub(super) fn stopping_step(way: f64, braking: f64) -> f64 {
    if way > 0.0 { 2.0 * way / (1.0 + (1.0 + 2.0 * way / braking).sqrt()) } else { 0.0 }
}

/// Returns the largest change per period of a factor on this step such that no joint changes its speed by more than
/// `change`.
pub(super) fn braking(step: &Joints, change: &Joints) -> f64 {
    (0..JOINTS).map(|joint| change[joint] / step[joint].abs()).fold(f64::INFINITY, f64::min)
}

/// Returns the number of periods for which a step can be repeated until a joint has used up its `room` (rad, below and
/// above); limited to a large number.
pub(super) fn periods(step: &Joints, room: &[Joints; 2]) -> f64 {
    let mut periods: f64 = 1e9;
    for joint in 0..JOINTS {
        let room = if step[joint] > 0.0 { room[1][joint] } else { room[0][joint] };
        if step[joint] != 0.0 {
            periods = periods.min(room.max(0.0) / step[joint].abs());
        }
    }
    periods
}

/// Returns the step from `coast` (continue as now) as far towards `wanted` as the permitted change of speed since
/// `moved` allows. Every step between the two keeps the shaft in the trocar. If even coasting exceeds the limit,
/// because the path is curved, the excess is the smallest possible on that line.
pub(super) fn towards(moved: &Joints, coast: &Joints, wanted: &Joints, change: &Joints) -> Joints {
    let mut min = 0.0_f64;
    let mut max = 1.0_f64;
    for joint in 0..JOINTS {
        let bend = coast[joint] - moved[joint];
        let way = wanted[joint] - coast[joint];
        if way.abs() <= f64::EPSILON * change[joint] || change[joint].is_infinite() {
            continue;
        }
        let ends = [(-change[joint] - bend) / way, (change[joint] - bend) / way];
        min = min.max(ends[0].min(ends[1]));
        max = max.min(ends[0].max(ends[1]));
    }
    let fraction = if min <= max { max } else { f64::midpoint(min, max).clamp(0.0, 1.0) };
    if fraction < 1.0 { coast + (wanted - coast) * fraction } else { *wanted }
}

/// Returns whether all joints can come to rest from this step, slowed by one common factor, before one of them has used
/// up its room.
pub(super) fn can_stop(step: &Joints, room: &[Joints; 2], change: &Joints) -> bool {
    0.5 / braking(step, change) <= periods(step, room)
}

/// Returns the largest fraction (0 to 1) of a step that stays within the bounds (`min <= 0 <= max` up to rounding).
pub(super) fn fraction_within(step: &Joints, min: &Joints, max: &Joints) -> f64 {
    let mut fraction: f64 = 1.0;
    for joint in 0..JOINTS {
        let bound = if step[joint] > 0.0 { max[joint] } else { min[joint] };
        // A zero component never limits the others.
        if step[joint].abs() > bound.abs() {
            fraction = fraction.min((bound / step[joint]).max(0.0));
        }
    }
    fraction
}
