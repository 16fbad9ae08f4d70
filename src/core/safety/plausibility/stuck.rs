//! Detects a handle or an arm whose reading stays identical to the last bit although it should change. Both may be at
//! rest: a handle on the table reports whole encoder counts, and an arm holds its angles. Only the cause of motion
//! distinguishes rest from a fault.

use nalgebra::Vector3;

/// A handle whose reading stays identical to the last bit while its force changes by this much is stuck, N: a gripping
/// hand of 900 N/m yields by 0.8 mm.
const STUCK_FORCE_N: f64 = 0.7;
/// The same applies to a handle that is motionless for [`UNMOVED_S`] under this force, N: a gripping hand trembles, and
/// a free handle yields.
const UNMOVED_FORCE_N: f64 = 0.5;
const UNMOVED_S: f64 = 0.1;
/// The rule applies to a handle that was not motionless for [`RESTFUL_S`] within this time, s: a handle guided by a
/// machine may be motionless.
const TREMBLED_S: f64 = 10.0;
const RESTFUL_S: f64 = 0.05;
/// Shortest time after which a position counts as stuck, s, and the minimum number of readings that repeat the first
/// one. Design choice, with no false alarm in 136 healthy minutes (`docs/results/faults.md`).
const STUCK_S: f64 = 0.015;
const REPEATED: u32 = 2;

/// Detects that one quantity stays identical to the last bit while another moves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stuck {
    at: Option<StuckState>,
    is_stuck: bool,
}

/// Value of both quantities when the first one stopped, and the time of the stop.
#[derive(Clone, Copy, Debug)]
struct StuckState {
    still: Vector3<f64>,
    moving: Vector3<f64>,
    since_s: f64,
    repeats: u32,
}

impl Stuck {
    /// Adds a new reading: `still` counts as stuck if it has not changed for [`STUCK_S`] while `moving` changed by more
    /// than `max`.
    pub(super) fn look(&mut self, still: &Vector3<f64>, moving: &Vector3<f64>, max: f64, t_s: f64) {
        let Some(at) = self.at.as_mut().filter(|at| at.still == *still) else {
            // Exact comparison: a living position changes at least its last bit, so any tolerance would hide a slow
            // hand.
            let at = StuckState { still: *still, moving: *moving, since_s: t_s, repeats: 0 };
            self.at = Some(at);
            self.is_stuck = false;
            return;
        };
        at.repeats += 1;
        // Both: the time for slow devices, the number of readings for a loop that polled once after a pause.
        let is_long = t_s - at.since_s > STUCK_S && at.repeats >= REPEATED;
        self.is_stuck = is_long && (moving - at.moving).norm() > max;
    }

    pub(super) const fn is_stuck(&self) -> bool {
        self.is_stuck
    }
}

/// Detects a handle that does not yield to the force on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandleStuck {
    by_change: Stuck,
    before_m: Option<Vector3<f64>>,
    unmoved_since_s: f64,
    /// Time since which the handle has not stood still for [`RESTFUL_S`], s.
    trembles_since_s: f64,
    is_stuck: bool,
}

impl Default for HandleStuck {
    fn default() -> Self {
        let [unmoved_since_s, trembles_since_s] = [f64::INFINITY; 2];
        Self { by_change: Stuck::default(), before_m: None, unmoved_since_s, trembles_since_s, is_stuck: false }
    }
}

impl HandleStuck {
    /// Starts a new engagement: earlier forces no longer count.
    pub(super) fn engage(&mut self) {
        self.by_change = Stuck::default();
    }

    /// Adds a new reading of the handle, m, and the force on it, N; a handle that is `guided` from the screen may be
    /// motionless under a force.
    pub(super) fn look(&mut self, hand_m: &Vector3<f64>, force_n: &Vector3<f64>, guided: bool, t_s: f64) {
        self.by_change.look(hand_m, force_n, STUCK_FORCE_N, t_s);
        // A handle guided from the screen has no hand, so it may rest under any force.
        let pressed = !guided && force_n.norm() >= UNMOVED_FORCE_N;
        if self.before_m != Some(*hand_m) {
            self.unmoved_since_s = t_s;
        }
        self.before_m = Some(*hand_m);
        self.trembles_since_s = self.trembles_since_s.min(t_s);
        let stood_s = t_s - self.unmoved_since_s;
        let trembled = self.unmoved_since_s - self.trembles_since_s >= TREMBLED_S;
        // A rest without a force says that this handle can rest (it lies on a table), so trembling has to be seen
        // again.
        if stood_s > RESTFUL_S && !(trembled && pressed) {
            self.trembles_since_s = t_s;
        }
        self.is_stuck = (self.by_change.is_stuck() && !guided) || (trembled && pressed && stood_s > UNMOVED_S);
    }

    pub(super) const fn is_stuck(&self) -> bool {
        self.is_stuck
    }
}
