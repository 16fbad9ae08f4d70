//! Straightness of the path between grasps and placements.

use crate::{
    signal::RATE_HZ,
    tip_motion::{TipMotion, path_m},
};

/// A shorter path, m, is noise.
const MIN_PATH_M: f64 = 1e-3;

/// Returns the total length of straight lines between the positions at these times (s from the beginning, in order)
/// over the tip's path length; `None` if it is zero. A segment with a gap in it is left out.
pub(crate) fn path_economy(motion: &TipMotion<'_>, times_s: &[f64]) -> Option<f64> {
    let mut straight_m = 0.0;
    let mut travel_m = 0.0;
    for leg in times_s.windows(2) {
        let [from, to] = [leg[0], leg[1]].map(|t_s| (t_s * RATE_HZ).round() as usize);
        let within = |stretch: &&crate::tip_motion::TrackSegment<'_>| {
            stretch.grid <= from && to < stretch.grid + stretch.points.len()
        };
        let Some(stretch) = motion.stretches.iter().find(within) else { continue };
        let Some([first, .., last]) = stretch.points.get(from - stretch.grid..=to.max(from) - stretch.grid) else {
            continue;
        };
        straight_m += (last - first).norm();
        travel_m += stretch.points.get(from - stretch.grid..=to - stretch.grid).map_or(0.0, path_m);
    }
    (travel_m >= MIN_PATH_M).then(|| straight_m / travel_m)
}
