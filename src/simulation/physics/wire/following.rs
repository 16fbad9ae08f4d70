//! Detects the events of loops on a wire, and the end of the task.

use nima_core::{SIDES, Side, task::TaskEvent};

use super::{Wire, WireSetting, WireState};

/// A touch is over when the loop has been clear of the wire for this long, s: a loop that slides along the wire bounces
/// a little.
const CLEAR_AFTER_S: f64 = 0.05;
/// A loop is at the beginning of the wire up to this distance from its free end, m.
const BEGINNING_M: f64 = 0.012;

/// The state of the task: a loop that entered the wire at its free end has to reach the goal.
///
/// ```
/// use nalgebra::{UnitQuaternion, Vector3};
/// use nima_core::Side;
/// use nima_simulation::physics::{Instrument, Wire, WireSetting, WireTask};
/// use nima_core::task::TaskEvent;
///
/// let setting = WireSetting { points_m: vec![[0.0, 0.0, 0.03], [0.05, 0.0, 0.03]], goal_point: 1, ..WireSetting::default() };
/// let (mut wire, mut task, mut ended) = (Wire::new(&setting, 1e-3), WireTask::new(&setting), false);
/// for tick in -100..=501 {
///     let tip_m = Vector3::new(f64::from(tick) * 1e-4, 0.0, 0.03);
///     let trocar_m = Vector3::new(0.0, -0.06, 0.14);
///     let right = Instrument { tip_m, world_from_jaws: UnitQuaternion::identity(), trocar_m, opening_rad: 0.0 };
///     wire.step(&Side::Right.alone(right));
///     task.look(&wire, &mut |_, event| ended |= event == TaskEvent::Ended);
/// }
/// assert!(ended && task.is_done() && task.touches() == 0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct WireTask {
    goal_m: f64,
    loops: [WireFollower; SIDES],
    touches: u32,
    is_done: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct WireFollower {
    touching: bool,
    clear_s: f64,
    /// Whether it entered the wire at its free end and has stayed on it since.
    on_its_way: bool,
    farthest_m: f64,
}

/// A loop nearer than this to the goal has reached it, m: the end of a wire cannot be passed with the wire still in the
/// loop.
const REACHED_M: f64 = 1e-3;

impl WireTask {
    pub fn new(setting: &WireSetting) -> Self {
        let goal_m = setting.curve().given_m(setting.goal_point) - REACHED_M;
        Self { goal_m, loops: [WireFollower::default(); SIDES], touches: 0, is_done: false }
    }

    /// Restarts the task; a current touch then counts as a new one.
    pub fn begin(&mut self) {
        *self = Self { loops: [WireFollower::default(); SIDES], touches: 0, is_done: false, ..*self };
    }

    /// Examines the loops after a step; call it once for each step. `report` receives each event and its age, s.
    pub fn look(&mut self, wire: &Wire, report: &mut dyn FnMut(f64, TaskEvent)) {
        if self.is_done {
            return;
        }
        for side in Side::LEFT_TO_RIGHT {
            let state = &wire.states()[side.index()];
            let following = &mut self.loops[side.index()];
            self.touches += u32::from(following.touch(side, state, wire.period_s(), report));
            self.is_done |= following.goes(state) >= self.goal_m;
        }
        if self.is_done {
            report(0.0, TaskEvent::Ended);
        }
    }

    /// Returns whether a loop has reached the goal.
    pub const fn is_done(&self) -> bool {
        self.is_done
    }

    /// Returns the number of contacts between loops and wire.
    pub const fn touches(&self) -> u32 {
        self.touches
    }

    /// Returns the completed fraction of the path to the goal.
    pub fn fraction(&self) -> f64 {
        let farthest_m = self.loops.iter().map(|following| following.farthest_m).fold(0.0, f64::max);
        (farthest_m / self.goal_m.max(1e-9)).clamp(0.0, 1.0)
    }
}

impl WireFollower {
    fn touch(&mut self, side: Side, state: &WireState, period_s: f64, report: &mut dyn FnMut(f64, TaskEvent)) -> bool {
        if state.touches {
            self.clear_s = 0.0;
            let begins = !std::mem::replace(&mut self.touching, true);
            if begins {
                report(0.0, TaskEvent::WireTouched { side });
            }
            return begins;
        }
        self.clear_s += period_s;
        if self.touching && self.clear_s >= CLEAR_AFTER_S {
            self.touching = false;
            report(self.clear_s, TaskEvent::WireLeft { side });
        }
        false
    }

    /// Returns the distance covered from the free end, m.
    fn goes(&mut self, state: &WireState) -> f64 {
        match state.along_m {
            Some(along_m) => self.on_its_way |= along_m <= BEGINNING_M,
            None => self.on_its_way = false,
        }
        self.farthest_m = match state.along_m {
            Some(along_m) if self.on_its_way => self.farthest_m.max(along_m),
            _ => 0.0,
        };
        self.farthest_m
    }
}
