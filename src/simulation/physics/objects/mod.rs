//! The objects and the instruments among them: one step for each tick.

mod rings;
mod state;
mod tools;

use nalgebra::Vector3;
use nima_core::SIDES;

use crate::physics::{
    contact::{ContactMemory, ContactPair, Law},
    geometry::{PLACES, Segment, directions},
    instrument::{Instrument, InstrumentLoads},
    ring::Ring,
    setting::{BoardSettings, ObjectSettings, RingStart, ViewBox},
    tool::{PARTS, PhysicsTool},
};
pub use state::{RingActivity, RingState};

/// Maximum sub-step, s. The loops run at 1 kHz, so one step for each of their ticks is enough where no ring vibrates.
const SUBSTEP_MAX_S: f64 = 1e-3;
/// Maximum period of a step, s. A longer one is probably in a wrong unit, and would need thousands of sub-steps in one
/// call.
const PERIOD_MAX_S: f64 = 0.1;
/// Maximum sub-step, relative to the fastest vibration of a ring between four fingers (12 contact stiffnesses on its
/// mass, as the effective mass at the rim is a third of the whole). Semi-implicit Euler is stable below 2, less with
/// damping.
const SUBSTEP_OF_VIBRATION: f64 = 0.75;

/// Rings, pegs and board, and two instruments among them.
///
/// Deterministic: the same calls give the same bits, on every processor. A step allocates nothing.
///
/// ```
/// use nalgebra::{UnitQuaternion, Vector3};
/// use nima_core::Side;
/// use nima_simulation::physics::{RingActivity, Instrument, Objects, ObjectSettings};
///
/// let setting = ObjectSettings::default();
/// setting.validate()?;
/// let mut objects = Objects::new(&setting, 1e-3);
/// // An instrument that points downwards and has been pressed 1 mm into the board.
/// let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
/// let trocar_m = Vector3::new(0.0, 0.0, 0.15);
/// let tip_m = Vector3::new(0.0, 0.0, -0.001);
/// let right = Instrument { tip_m, world_from_jaws: down, trocar_m, opening_rad: 0.0 };
/// let loads = objects.step(&Side::Right.alone(right))[Side::Right.index()];
/// assert!(loads.touching.board && (loads.tip_n.z - 3.6).abs() < 0.01, "both fingers, 1 kN/m each, 1.8 mm deep");
/// assert_eq!(objects.rings()[3].doing, RingActivity::OnPeg(3));
/// # Ok::<(), nima_simulation::physics::SettingError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Objects {
    period_s: f64,
    substeps: u32,
    setting: ObjectSettings,
    laws: Laws,
    directions: [[f64; 2]; PLACES],
    /// Forces on ring 0 at a point, N, for tests.
    #[cfg(test)]
    pub(crate) pulled_n: Option<(Vector3<f64>, Vector3<f64>)>,
    pegs: Vec<Segment>,
    rings: Vec<Ring>,
    tools: [Option<PhysicsTool>; SIDES],
    memories: Memories,
    notes: Vec<RingNote>,
    states: Vec<RingState>,
}

#[derive(Clone, Copy, Debug)]
struct Laws {
    instrument: Law,
    jaw_ring: Law,
    ring_peg: Law,
    /// Contact law for each contact of a ring.
    ring_board: Law,
    ring_ring: Law,
}

/// States of contacts. Indexed by the ring, then by the body that it touches.
#[derive(Clone, Debug)]
struct Memories {
    ring_board: Vec<[ContactMemory; PLACES]>,
    ring_pegs: Vec<ContactPair>,
    ring_tools: Vec<[[ContactPair; PARTS]; SIDES]>,
    ring_rings: Vec<RingPair>,
    tool_board: [[ContactMemory; PARTS]; SIDES],
    tool_pegs: Vec<[[ContactMemory; PARTS]; SIDES]>,
    tool_tool: [[ContactMemory; PARTS]; PARTS],
}

/// Contacts of one ring on another.
#[derive(Clone, Copy, Debug, Default)]
struct RingPair {
    places: [ContactMemory; PLACES],
    touched: bool,
}

/// Observations of a ring during a step.
#[derive(Clone, Copy, Debug, Default)]
struct RingNote {
    /// Whether board, peg or ring touches it.
    supported: bool,
    touched_by: [bool; SIDES],
    /// Direction and size of the fingers' pressure in the last sub-step, N.
    fingers_n: [[Vector3<f64>; 2]; SIDES],
    outside_s: f64,
}

impl Objects {
    /// Puts every ring where it is in `start`, at rest, without allocating; the instruments stay where they are.
    pub fn begin_as(&mut self, start: &Self) {
        let Memories { ring_board, ring_pegs, ring_tools, ring_rings, .. } = &start.memories;
        self.rings.clone_from(&start.rings);
        self.memories.ring_board.clone_from(ring_board);
        self.memories.ring_pegs.clone_from(ring_pegs);
        self.memories.ring_tools.clone_from(ring_tools);
        self.memories.ring_rings.clone_from(ring_rings);
        self.notes.clone_from(&start.notes);
        self.states.clone_from(&start.states);
    }

    /// Creates the objects of a setting with a step every `period_s`. The setting must have been validated.
    pub fn new(setting: &ObjectSettings, period_s: f64) -> Self {
        let period_s = if period_s > 0.0 { period_s.min(PERIOD_MAX_S) } else { SUBSTEP_MAX_S };
        let BoardSettings { z_m, .. } = setting.board;
        let peg = |[x, y]: &[f64; 2]| Segment {
            from_m: Vector3::new(*x, *y, z_m),
            // A peg ends in a half sphere, so its line ends one radius below its top.
            to_m: Vector3::new(*x, *y, z_m + setting.pegs.height_m - setting.pegs.radius_m),
        };
        let directions = directions();
        let mut rings: Vec<Ring> = Vec::with_capacity(setting.rings.len());
        for (i, start) in setting.rings.iter().enumerate() {
            // Rings that start on the same peg are stacked, because overlapping rings would be thrown apart in the
            // first step.
            let below = setting.rings.iter().take(i).filter(|other| *other == start).count() as f64;
            let tube_m = setting.ring.tube_radius_m;
            let centre_m = match start {
                RingStart::Peg(peg) => {
                    let [x, y] = setting.pegs.position_m.get(*peg).copied().unwrap_or_default();
                    Vector3::new(x, y, z_m + tube_m * (1.0 + 2.0 * below))
                }
                RingStart::At(position_m) => Vector3::from(*position_m),
            };
            rings.push(Ring::new(&setting.ring, centre_m, &directions));
        }
        let count = rings.len();
        let pegs = setting.pegs.position_m.len();
        let mut objects = Self {
            period_s,
            substeps: substeps(setting, period_s),
            laws: laws(setting),
            directions,
            #[cfg(test)]
            pulled_n: None,
            pegs: setting.pegs.position_m.iter().map(peg).collect(),
            tools: [None, None],
            memories: Memories {
                ring_board: vec![[ContactMemory::default(); PLACES]; count],
                ring_pegs: vec![ContactPair::default(); count * pegs],
                ring_tools: vec![[[ContactPair::default(); PARTS]; SIDES]; count],
                ring_rings: vec![RingPair::default(); count * count],
                tool_board: [[ContactMemory::default(); PARTS]; SIDES],
                tool_pegs: vec![[[ContactMemory::default(); PARTS]; SIDES]; pegs],
                tool_tool: [[ContactMemory::default(); PARTS]; PARTS],
            },
            notes: vec![RingNote::default(); count],
            states: rings.iter().map(RingState::of).collect(),
            setting: setting.clone(),
            rings,
        };
        objects.report();
        objects
    }

    /// Advances by one period, at whose end the instruments have these poses. An instrument with a value that is not
    /// finite counts as absent. Returns the loads on each.
    pub fn step(&mut self, instruments: &[Option<Instrument>; SIDES]) -> [InstrumentLoads; SIDES] {
        for (tool, at) in self.tools.iter_mut().zip(instruments) {
            match (tool.as_mut(), at.filter(Instrument::is_sane)) {
                (Some(tool), Some(at)) => tool.aim(&at),
                (None, Some(at)) => {
                    let stiffness_n_m = self.setting.contact.ring_stiffness_n_m;
                    *tool = Some(PhysicsTool::new(&self.setting.jaws, stiffness_n_m, &at, self.period_s));
                }
                (_, None) => *tool = None,
            }
        }
        for note in &mut self.notes {
            note.supported = false;
            note.touched_by = [false; SIDES];
        }
        let step_s = self.period_s / f64::from(self.substeps);
        for substep in 1..=self.substeps {
            let fraction = f64::from(substep) / f64::from(self.substeps);
            self.tools.iter_mut().flatten().for_each(|tool| tool.place(fraction));
            // Both use the poses at the same moment, and the reactions on an instrument must be complete before its
            // fingers are driven.
            self.touch_rings(step_s);
            self.touch_tools(step_s);
            self.tools.iter_mut().flatten().for_each(|tool| tool.drive(step_s));
            #[cfg(test)]
            self.pull();
            for ring in &mut self.rings {
                if ring.moves() {
                    ring.advance(step_s, &self.directions);
                } else {
                    // A sleeping ring does not use up its forces; they would add up until it wakes.
                    ring.clear_forces();
                }
            }
        }
        self.report();
        let substeps = f64::from(self.substeps);
        self.tools
            .each_ref()
            .map(|tool| tool.as_ref().map_or_else(InstrumentLoads::default, |tool| tool.loads(substeps)))
    }

    pub fn rings(&self) -> &[RingState] {
        &self.states
    }

    /// Returns the actual angle between the fingers of each instrument, rad; `None` if there is none.
    pub fn openings_rad(&self) -> [Option<f64>; SIDES] {
        self.tools.each_ref().map(|tool| tool.as_ref().map(|tool| tool.opening_rad))
    }

    /// Returns the time between steps, s.
    pub const fn period_s(&self) -> f64 {
        self.period_s
    }

    #[cfg(test)]
    fn pull(&mut self) {
        if let (Some((position_m, force_n)), Some(ring)) = (self.pulled_n, self.rings.first_mut()) {
            ring.push(
                &position_m,
                &crate::physics::contact::ContactPush { force_n, ..crate::physics::contact::ContactPush::default() },
            );
        }
    }

    #[cfg(test)]
    pub(crate) fn ring_mut(&mut self, ring: usize) -> &mut Ring {
        &mut self.rings[ring]
    }

    /// Returns the force of an instrument's fingers on a ring, N, for tests.
    #[cfg(test)]
    pub(crate) fn grip_n(&self, ring: usize, side: usize) -> f64 {
        0.5 * self.notes[ring].fingers_n[side].iter().map(Vector3::norm).sum::<f64>()
    }

    /// Returns the kinetic and potential energy, J, for tests.
    #[cfg(test)]
    pub(crate) fn energy_j(&self) -> f64 {
        self.rings.iter().map(Ring::energy_j).sum()
    }

    const fn view(&self) -> &ViewBox {
        &self.setting.view
    }
}

fn substeps(setting: &ObjectSettings, period_s: f64) -> u32 {
    let longest_s = if setting.rings.is_empty() {
        SUBSTEP_MAX_S
    } else {
        // Twelve contact stiffnesses act on the mass of the ring; see [`SUBSTEP_OF_VIBRATION`].
        let fastest_rad_s = (12.0 * setting.contact.ring_stiffness_n_m / setting.ring.mass_kg).sqrt();
        (SUBSTEP_OF_VIBRATION / fastest_rad_s).min(SUBSTEP_MAX_S)
    };
    // Rounding must not split a step that fits.
    (period_s / longest_s - 1e-9).ceil().max(1.0) as u32
}

fn laws(setting: &ObjectSettings) -> Laws {
    let contact = &setting.contact;
    let friction = &setting.friction;
    let stiffness_n_m = contact.ring_stiffness_n_m;
    // Half of the critical damping of a ring between two fingers; the effective mass at its rim is a third of the
    // whole.
    let damping_s = (setting.ring.mass_kg / (6.0 * stiffness_n_m)).sqrt();
    let ring = |fraction: f64, friction: f64, patch_radius_m: f64| Law {
        stiffness_n_m: stiffness_n_m * fraction,
        damping_n_s_m: stiffness_n_m * fraction * damping_s,
        friction,
        patch_radius_m,
    };
    // A ring on its edge touches at two or three points, and a ring that lies flat at all of them, so each point gets a
    // fraction.
    let of_many = 0.25;
    Laws {
        instrument: Law {
            stiffness_n_m: contact.stiffness_n_m,
            damping_n_s_m: contact.damping_n_s_m,
            friction: friction.instrument,
            patch_radius_m: 0.0,
        },
        jaw_ring: ring(1.0, friction.jaw_ring, friction.patch_radius_m),
        ring_peg: ring(1.0, friction.ring_peg, 0.0),
        ring_board: ring(of_many, friction.ring_board, 0.0),
        ring_ring: ring(of_many, friction.ring_ring, 0.0),
    }
}
