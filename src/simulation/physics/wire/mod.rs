//! A loop that is guided along a bent wire: contact points and forces.
//!
//! Wire and board are fixed and each loop has the pose of its instrument, so a step evaluates the contact law at its
//! end, without integration. A penalty force alone would let a loop be pulled through the wire. Therefore each loop
//! stores whether the wire passes through it; if so, the wire is pushed back inside, however far out it is.

mod curve;
mod following;
mod geometry;

use nalgebra::Vector3;
use nima_core::SIDES;

use crate::physics::{
    contact::{ContactMemory, ContactTouch, Law},
    geometry::{Circle, unit_or},
    instrument::{Instrument, InstrumentLoads},
};
pub use curve::SmoothCurve;
use curve::{CurveReach, NearestPlace};
pub use following::WireTask;
pub use geometry::{LoopGeometry, WireContact, WireSetting};

/// Maximum number of simultaneous contacts of a loop with the wire.
const PLACES: usize = 3;
/// A contact that is farther than this along the wire from its last position is a different one, m.
const MOVED_M: f64 = 2e-3;
/// Range along the wire in which the crossing of a loop is searched from one step to the next, m. Longer than a hand
/// moves in one step, but short, so that the crossing cannot switch to another part of the wire.
const SEARCH_M: f64 = 0.015;
/// If the wire is this far outside its loop, it has been torn off, m.
const TORN_OFF_M: f64 = 0.012;
/// Maximum distance, m along the wire, between the closest point of a wire outside its loop and its crossing of the
/// loop's plane.
const AROUND_M: f64 = 0.006;
/// Beyond this distance between two steps, an instrument counts as placed again, m. At 1 kHz that would be 30 m/s,
/// which no hand reaches; a speed from it would throw the instrument away.
const JUMP_M: f64 = 0.03;

/// A wire, the board under it, and a loop at the tip of each of two instruments.
///
/// Deterministic: the same calls give the same bits, on every processor. A step allocates nothing.
///
/// ```
/// use nalgebra::{UnitQuaternion, Vector3};
/// use nima_core::Side;
/// use nima_simulation::physics::{Instrument, Wire, WireSetting};
///
/// let points_m = vec![[-0.05, 0.0, 0.03], [0.05, 0.0, 0.03]];
/// let setting = WireSetting { points_m, goal_point: 1, ..WireSetting::default() };
/// setting.validate()?;
/// let mut wire = Wire::new(&setting, 1e-3);
/// // The loop is around the wire, and pulled up until it overlaps it by 0.5 mm.
/// let room_m = setting.hoop.radius_m - setting.hoop.tube_radius_m - setting.radius_m;
/// let mut right = Instrument {
///     tip_m: Vector3::new(0.0, 0.0, 0.03),
///     world_from_jaws: UnitQuaternion::identity(),
///     trocar_m: Vector3::new(0.0, -0.06, 0.14),
///     opening_rad: 0.0,
/// };
/// wire.step(&Side::Right.alone(right));
/// right.tip_m.z += room_m + 0.0005;
/// wire.step(&Side::Right.alone(right));
/// let loads = wire.step(&Side::Right.alone(right))[Side::Right.index()];
/// let law_n = setting.contact.stiffness_n_m * 0.0005;
/// assert!((loads.tip_n.z + law_n).abs() < 0.02 * law_n, "{} N", loads.tip_n.z);
/// assert!(wire.states()[Side::Right.index()].touches);
/// # Ok::<(), nima_simulation::physics::SettingError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Wire {
    setting: WireSetting,
    period_s: f64,
    curve: SmoothCurve,
    law: Law,
    loops: [Option<TipLoop>; SIDES],
    states: [WireState; SIDES],
}

/// State of a loop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WireState {
    /// Whether it touches the wire.
    pub touches: bool,
    /// Position along the wire, m from its free end, at which it passes through the loop; `None` if it does not.
    pub along_m: Option<f64>,
    /// Maximum overlap of loop and wire, m.
    pub deepest_m: f64,
}

/// A loop within a step, with its stored state.
#[derive(Clone, Copy, Debug)]
struct TipLoop {
    circle: Circle,
    velocity_m_s: Vector3<f64>,
    turning_rad_s: Vector3<f64>,
    /// Position along the wire at which it passes through the loop, m.
    through_m: Option<f64>,
    places: [Option<(f64, ContactMemory)>; PLACES],
    on_board: ContactMemory,
}

impl Wire {
    /// Creates the wire of a setting with a step every `period_s`. The setting must have been validated.
    pub fn new(setting: &WireSetting, period_s: f64) -> Self {
        // The limits of `Objects::new`.
        let period_s = if period_s > 0.0 { period_s.min(0.1) } else { 1e-3 };
        let contact = &setting.contact;
        let law = Law {
            stiffness_n_m: contact.stiffness_n_m,
            damping_n_s_m: contact.damping_n_s_m,
            friction: contact.friction,
            patch_radius_m: 0.0,
        };
        let curve = setting.curve();
        let loops = [None, None];
        let states = [WireState::default(); SIDES];
        Self { setting: setting.clone(), period_s, curve, law, loops, states }
    }

    /// Returns the curve of the wire's middle.
    pub const fn curve(&self) -> &SmoothCurve {
        &self.curve
    }

    /// Returns the state of each side's loop.
    pub const fn states(&self) -> &[WireState; SIDES] {
        &self.states
    }

    /// Returns the time between steps, s.
    pub const fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Advances by one period, at whose end the instruments have these poses. An instrument with a value that is not
    /// finite counts as absent. Returns the loads on each.
    pub fn step(&mut self, instruments: &[Option<Instrument>; SIDES]) -> [InstrumentLoads; SIDES] {
        let mut loads = [InstrumentLoads::default(); SIDES];
        for side in 0..SIDES {
            let Some(at) = instruments[side].filter(Instrument::is_sane) else {
                self.loops[side] = None;
                self.states[side] = WireState::default();
                continue;
            };
            let circle = self.setting.hoop.circle(&at);
            let mut held = match self.loops[side] {
                Some(before) if (circle.centre_m - before.circle.centre_m).norm() <= JUMP_M => {
                    before.moved(circle, self.period_s)
                }
                _ => TipLoop::at(circle),
            };
            (loads[side], self.states[side]) = self.touch(&mut held);
            self.loops[side] = Some(held);
        }
        loads
    }

    fn touch(&self, held: &mut TipLoop) -> (InstrumentLoads, WireState) {
        let both_m = self.setting.radius_m + self.setting.hoop.tube_radius_m;
        let found = self.curve.near(&held.circle, both_m);
        held.through_m = self.through_m(held, &found, both_m);
        let mut loads = InstrumentLoads::default();
        let mut state = WireState { along_m: held.through_m, ..WireState::default() };
        let outside = held.through_m.filter(|along_m| {
            let beyond_m = held.off_axis_m(&self.curve.at(*along_m)) - held.circle.radius_m;
            beyond_m > 0.0
        });
        let mut before = std::mem::take(&mut held.places);
        let touched = match outside {
            Some(along_m) => {
                let place = self.curve.closest_around(&held.circle, along_m, AROUND_M);
                [Some(held.outside(&place, both_m)), None, None]
            }
            None => found.places.map(|place| place.map(|place| held.inside(&place, both_m))),
        };
        for (at, place) in touched.into_iter().enumerate() {
            let Some((along_m, point_m, touch)) = place else { continue };
            let mut memory = TipLoop::remembered(&mut before, along_m);
            loads.add(held, &point_m, &self.law, &mut memory, &touch, self.period_s);
            held.places[at] = Some((along_m, memory));
            state.touches = true;
            state.deepest_m = state.deepest_m.max(touch.depth_m);
        }
        self.on_board(held, &mut loads);
        (loads, state)
    }

    /// Returns the current position along the wire at which it passes through the loop, m.
    fn through_m(&self, held: &TipLoop, found: &CurveReach, both_m: f64) -> Option<f64> {
        let radius_m = held.circle.radius_m;
        let Some(before_m) = held.through_m else {
            // The wire enters the loop over a free end, or the loop is placed around the wire.
            return found.through.filter(|(_, off_axis_m)| *off_axis_m < radius_m - both_m).map(|(along_m, _)| along_m);
        };
        let along_m = self.curve.crossing(&held.circle, before_m, SEARCH_M)?;
        (held.off_axis_m(&self.curve.at(along_m)) < radius_m + TORN_OFF_M).then_some(along_m)
    }

    /// Applies the contact of the loop's lowest point with the board.
    fn on_board(&self, held: &mut TipLoop, loads: &mut InstrumentLoads) {
        let Circle { centre_m, axis, radius_m, .. } = held.circle;
        let board = &self.setting.board;
        let down = -Vector3::z() + axis * axis.z;
        // A loop that lies flat has no lowest point; its centre is then used.
        let (lowest, _) = unit_or(&down, &Vector3::zeros());
        let position_m = centre_m + lowest * radius_m - Vector3::z() * self.setting.hoop.tube_radius_m;
        let depth_m = board.z_m - position_m.z;
        let [half_x_m, half_y_m] = board.size_m.map(|size_m| 0.5 * size_m);
        if depth_m <= 0.0 || position_m.x.abs() > half_x_m || position_m.y.abs() > half_y_m {
            held.on_board = ContactMemory::default();
            return;
        }
        let velocity_m_s = held.velocity_at(&position_m);
        let touch = ContactTouch { depth_m, normal: Vector3::z(), velocity_m_s, spin_rad_s: 0.0 };
        let mut memory = held.on_board;
        loads.add(held, &position_m, &self.law, &mut memory, &touch, self.period_s);
        held.on_board = memory;
        loads.touching.board = true;
    }
}

impl InstrumentLoads {
    /// Adds a contact to a loop.
    fn add(
        &mut self,
        held: &TipLoop,
        position_m: &Vector3<f64>,
        law: &Law,
        memory: &mut ContactMemory,
        touch: &ContactTouch,
        period_s: f64,
    ) {
        let push = law.push(memory, touch, period_s);
        self.tip_n += push.force_n;
        self.torque_nm += (position_m - held.circle.centre_m).cross(&push.force_n);
    }
}

impl TipLoop {
    fn at(circle: Circle) -> Self {
        Self {
            circle,
            velocity_m_s: Vector3::zeros(),
            turning_rad_s: Vector3::zeros(),
            through_m: None,
            places: [None; PLACES],
            on_board: ContactMemory::default(),
        }
    }

    fn moved(self, circle: Circle, period_s: f64) -> Self {
        Self {
            velocity_m_s: (circle.centre_m - self.circle.centre_m) / period_s,
            // The cross product is the sine of the angle; for the turn of one step both are the same.
            turning_rad_s: self.circle.axis.cross(&circle.axis) / period_s,
            circle,
            ..self
        }
    }

    fn velocity_at(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        self.velocity_m_s + self.turning_rad_s.cross(&(point_m - self.circle.centre_m))
    }

    /// Returns the distance of a point from the axis of the loop, m.
    fn off_axis_m(&self, point_m: &Vector3<f64>) -> f64 {
        self.outwards(point_m).1
    }

    fn outwards(&self, point_m: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let offset_m = point_m - self.circle.centre_m;
        unit_or(&(offset_m - self.circle.axis * self.circle.axis.dot(&offset_m)), &self.circle.across[0])
    }

    /// Returns the contact of a point of the wire with the loop's tube from inside: position along the wire, position
    /// in space, and geometry.
    fn inside(&self, place: &NearestPlace, both_m: f64) -> (f64, Vector3<f64>, ContactTouch) {
        let (outwards, _) = self.outwards(&place.wire_m);
        let (normal, distance_m) = unit_or(&(place.loop_m - place.wire_m), &outwards);
        self.touched(place.along_m, &place.loop_m, both_m - distance_m, normal)
    }

    /// Returns the same for a wire that passes through the loop and lies beyond the middle line of its tube: it is
    /// pushed back in.
    fn outside(&self, place: &NearestPlace, both_m: f64) -> (f64, Vector3<f64>, ContactTouch) {
        let (outwards, _) = self.outwards(&place.wire_m);
        let (normal, distance_m) = unit_or(&(place.wire_m - place.loop_m), &outwards);
        self.touched(place.along_m, &place.loop_m, both_m + distance_m, normal)
    }

    fn touched(
        &self,
        along_m: f64,
        position_m: &Vector3<f64>,
        depth_m: f64,
        normal: Vector3<f64>,
    ) -> (f64, Vector3<f64>, ContactTouch) {
        (
            along_m,
            *position_m,
            ContactTouch { depth_m, normal, velocity_m_s: self.velocity_at(position_m), spin_rad_s: 0.0 },
        )
    }

    /// Returns the state of the contact that was here, and removes it from the list.
    fn remembered(before: &mut [Option<(f64, ContactMemory)>; PLACES], along_m: f64) -> ContactMemory {
        let near = |place: &&mut Option<(f64, ContactMemory)>| {
            place.is_some_and(|(before_m, _)| (before_m - along_m).abs() < MOVED_M)
        };
        // Taken, so that two contacts cannot continue the friction of the same one.
        before.iter_mut().find(near).and_then(Option::take).map_or_else(ContactMemory::default, |(_, memory)| memory)
    }
}
