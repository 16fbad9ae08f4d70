//! Plausibility: numbers that are finite and in time and still cannot be true.
//!
//! In: one exchange's measurements ([`Observed`]: m, N, workspace frame; time in s) and the readings that they were made of
//! ([`RawReadings`]: the devices' own frames, units and times). Out: the same with single leaps taken out ([`Admitted`]), and what cannot be
//! true ([`Implausible`]). A reading that is looked at again is no new one: a device may be slower than the loop. Each look takes constant time
//! and allocates nothing. What a limit is taken from stands beside it; all were tried against the ordinary scenes (`nima study faults`).
//! Numbers that are not finite must be kept away before.
//!
//! What no look can tell: a bias that creeps, a gain that is wrong from the start, axes that are exchanged before a first
//! contact. `docs/results/faults.md` says how large those errors become.

mod channel;
mod device;
mod leap;
mod opposed;
mod raw;
mod release;
mod repeats;
mod stuck;

use nalgebra::{SVector, UnitQuaternion, Vector3};

use self::{
    channel::{Around, FROZEN_S, Wrong},
    device::Device,
    stuck::{HandleStuck, Stuck},
};

pub use leap::Leap;
pub use opposed::Opposed;
pub use raw::{ARM_CHANNELS, CHANNELS, HANDLE_CHANNELS, Raw, RawReadings};
pub use release::{Fall, Release};

/// A handle moves no faster than this, m/s: the fastest arm movements of people reach 2 to 3 m/s in throwing, not in operating.
const HAND_MAX_M_S: f64 = 3.0;
/// An arm's tip moves no faster than this, m/s: three times the fastest command.
const TIP_MAX_M_S: f64 = 1.0;
/// Where positions may differ for other reasons than motion, m.
const POSITION_SLACK_M: f64 = 2e-3;
/// A force of a resting tip changes by less than this from one sample to the next, N: nine deviations of the noisiest sensor here.
const FORCE_SLACK_N: f64 = 0.5;
/// And by so much per metre that the tip moved, N/m: fifteen times soft tissue. With the slack it lets 15 kN/m pass at 50 mm/s.
const STIFFEST_N_M: f64 = 5e3;
/// After a start or a gap the filters behind a force settle for so long: it may leap, s.
const SETTLE_S: f64 = 0.05;
/// An arm's joints turn no faster than this together, rad/s: three times the fastest of a Gen3. So does its wrist (way of its axes).
const TURN_MAX_RAD_S: f64 = 5.0;
/// Where angles may differ for other reasons than motion, rad.
const TURN_SLACK_RAD: f64 = 0.1;
/// The tip's way between two readings of the arm is the largest of so many: arm and force sensor tick by their own clocks.
const WAY_READINGS: usize = 4;
/// A torque of the sensor divided by this is compared with forces, m: a force at the tip has the lever of the shaft.
const LEVER_M: f64 = 0.5;
/// A tip that stands to the last bit while its command goes this far does not follow, m.
const STUCK_COMMAND_M: f64 = 0.5e-3;
/// A longer gap between two looks tells nothing of how far anything may have gone, s.
const GAP_S: f64 = 0.015;
/// A force that the link repeats for longer than the sensor was late is the link's, s. The silence of a sensor is told after the longest time;
/// it is forgotten at this rate, which is slower than any delay of the link.
const LINK_S: f64 = 0.015;
const LATE_MAX_S: f64 = 0.02;
const FORGETS_LATE: f64 = 0.02;
/// A tip so far from its command has lost it, m: an arm of 60 ms lag at the fastest command.
const ASTRAY_M: f64 = 0.02;
/// Readings in a row that change as those of a block before: a force sensor's numbers are fine, and none of six comes twice. Whole counts of an
/// encoder come and go, thirty times by chance once in 2^30.
const SENSOR_BLOCK: u32 = 6;
const ENCODER_BLOCK: u32 = 30;

/// What cannot be true.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Implausible {
    /// A reading of the force sensor, or of the accelerometer in it, repeats itself to the last bit.
    ForceFrozen,
    /// A number of the force sensor is cut off at the end of its range.
    ForceSaturated,
    /// The force sensor tells a block of readings that it has told before.
    ForceRepeats,
    /// The force jumped farther than any contact can make it, and not to nothing as a contact that ends.
    ForceJumped,
    /// The force pushes along the motion into a contact.
    ForceAlong,
    /// What comes over the link repeats itself under new time stamps.
    LinkFrozen,
    /// The handle jumped farther than a hand can move it.
    HandleJumped,
    /// The handle stands still to the last bit while its force changes.
    HandleFrozen,
    /// The handle tells a block of readings that it has told before.
    HandleRepeats,
    /// The arm's tip or joints jumped farther than the arm can move them.
    TipJumped,
    /// The arm tells a block of readings that it has told before.
    ArmRepeats,
    /// The arm does not go where it is commanded.
    ArmAstray,
}

/// What is looked at in one tick.
#[derive(Clone, Copy, Debug)]
pub struct Observed {
    /// Loop time, s.
    pub t_s: f64,
    /// The readings of the devices that all of it was made of.
    pub raw: RawReadings,
    /// Force at the tip made of them, N.
    pub force_n: Vector3<f64>,
    /// A force below this is none, N: what is made of a wrist sensor's reading errs by more than one at the tip does.
    pub least_n: f64,
    /// Orientation of the wrist by the arm, where it is known.
    pub world_from_s1: Option<UnitQuaternion<f64>>,
    /// The instrument's tip in the workspace, m.
    pub tip_m: Vector3<f64>,
    /// The handle, m (its device's axes).
    pub hand_m: Vector3<f64>,
    /// Where the tip was commanded to be one tick ago, m; `None` while it rests.
    pub command_m: Option<Vector3<f64>>,
    /// Force on the hand as commanded one tick ago, N.
    pub hand_force_n: Vector3<f64>,
    /// The handle is led from the screen: then it may stand still under a force.
    pub guided: bool,
    /// How long ago tip and handle came over a network, s; 0 for what is at this machine. After a gap they may have gone farther.
    pub tip_silent_s: f64,
    /// See above.
    pub hand_silent_s: f64,
}

/// What may be used of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Admitted {
    /// Force at the tip, N.
    pub force_n: Vector3<f64>,
    /// The instrument's tip in the workspace, m.
    pub tip_m: Vector3<f64>,
    /// The handle, m.
    pub hand_m: Vector3<f64>,
}

/// The looks and their memory.
#[derive(Clone, Debug)]
pub struct Plausibility {
    sensor: Device<CHANNELS>,
    handle: Device<HANDLE_CHANNELS>,
    arm: Device<ARM_CHANNELS>,
    link: Device<3>,
    moves: Moves,
    handle_stuck: HandleStuck,
    /// Way of the tip so far, m.
    way_m: f64,
    /// When the force sensor last told something new, s, and how late it was lately.
    felt_s: f64,
    late_s: f64,
    last_t_s: f64,
    doubt: Option<Implausible>,
}

/// The memory of what moves between two looks; nothing is known of it after a gap.
#[derive(Clone, Debug, Default)]
struct Moves {
    force: Leap,
    release: Release,
    load: Leap<6>,
    tip: Leap,
    hand: Leap,
    joints: Leap<ARM_CHANNELS>,
    turn: Leap<6>,
    opposed: Opposed,
    tip_stuck: Stuck,
    ways_m: [f64; WAY_READINGS],
    /// Way of the tip since the newest reading of the force sensor, m.
    unfelt_m: f64,
    /// How long tip and handle had been silent at the last look, s.
    silent_s: [f64; 2],
    /// When this began, s; not known before the first look.
    began_s: Option<f64>,
}

impl Default for Plausibility {
    fn default() -> Self {
        Self {
            sensor: Device::new(SENSOR_BLOCK),
            handle: Device::new(ENCODER_BLOCK),
            arm: Device::new(ENCODER_BLOCK),
            link: Device::new(SENSOR_BLOCK),
            moves: Moves::default(),
            handle_stuck: HandleStuck::default(),
            way_m: 0.0,
            felt_s: 0.0,
            late_s: LATE_MAX_S,
            last_t_s: f64::NEG_INFINITY,
            doubt: None,
        }
    }
}

impl Plausibility {
    /// What cannot be true of the newest look, if anything.
    pub fn doubt(&self) -> Option<Implausible> {
        self.doubt.or_else(|| self.link.wrong().map(|_| Implausible::LinkFrozen))
    }

    /// A new engagement: what was commanded and felt before it counts no more.
    pub fn engage(&mut self) {
        self.moves.opposed = Opposed::default();
        self.moves.tip_stuck = Stuck::default();
        self.handle_stuck.engage();
    }

    /// The force is known from now on, or computed in another way: what it was before says nothing about a jump.
    pub fn force_is_new(&mut self) {
        let moves = &mut self.moves;
        moves.force = Leap::default();
        moves.release = Release::default();
        moves.load = Leap::default();
        moves.began_s = None;
    }

    /// Takes one exchange in and gives what may be used of it.
    pub fn step(&mut self, seen: &Observed) -> Admitted {
        let dt_s = self.pass(seen.t_s);
        let (tip_m, tip_jumped) = self.admit_tip(seen, dt_s);
        let (hand_m, hand_jumped) = self.admit_hand(seen, dt_s);
        let (force_n, force_jumped) = self.admit_force(seen, dt_s);
        self.moves.silent_s = [seen.tip_silent_s, seen.hand_silent_s];
        let went_m = *self.moves.tip.moved();
        let along = self.moves.opposed.look(dt_s, &force_n, seen.least_n, &went_m, seen.command_m.is_some());
        let of_sensor = |wrong: Wrong| match wrong {
            Wrong::Frozen => Implausible::ForceFrozen,
            Wrong::Saturated => Implausible::ForceSaturated,
            Wrong::Repeats => Implausible::ForceRepeats,
        };
        let doubts = [
            force_jumped.then_some(Implausible::ForceJumped),
            seen.raw.sensor.and(self.sensor.wrong()).map(of_sensor),
            along.then_some(Implausible::ForceAlong),
            hand_jumped.then_some(Implausible::HandleJumped),
            seen.raw.handle.and(self.handle.wrong()).map(|_| Implausible::HandleRepeats),
            tip_jumped.then_some(Implausible::TipJumped),
            seen.raw.arm.and(self.arm.wrong()).map(|_| Implausible::ArmRepeats),
            self.handle_stuck.is_stuck().then_some(Implausible::HandleFrozen),
            self.arm_is_astray(seen).then_some(Implausible::ArmAstray),
        ];
        self.doubt = doubts.into_iter().flatten().next();
        Admitted { force_n, tip_m, hand_m }
    }

    /// Time passes until this look, s.
    fn pass(&mut self, t_s: f64) -> f64 {
        let dt_s = t_s - self.last_t_s;
        self.last_t_s = t_s;
        if dt_s > 0.0 && dt_s <= GAP_S {
            return dt_s;
        }
        // After a gap, or a clock that was set, nothing is known of how far anything may have gone. What a device's numbers are like is.
        self.moves = Moves::default();
        self.handle_stuck = HandleStuck::default();
        0.0
    }

    fn admit_tip(&mut self, seen: &Observed, dt_s: f64) -> (Vector3<f64>, bool) {
        let moves = &mut self.moves;
        let moved_s = news(&mut self.arm, seen.raw.arm.as_ref(), dt_s + moves.silent_s[0]);
        let most_m = POSITION_SLACK_M + TIP_MAX_M_S * moved_s.unwrap_or(dt_s);
        let (tip_m, jumped) = moves.tip.admit(&seen.tip_m, most_m, moved_s.is_some());
        let way_m = moves.tip.moved().norm();
        self.way_m += way_m;
        moves.unfelt_m += way_m;
        let Some(moved_s) = moved_s else { return (tip_m, jumped) };
        moves.ways_m.rotate_right(1);
        moves.ways_m[0] = way_m;
        if moved_s > 0.0 {
            let t_s = seen.raw.arm.map_or(seen.t_s, |arm| arm.arrival_s);
            moves.tip_stuck.look(&seen.tip_m, &seen.command_m.unwrap_or(seen.tip_m), STUCK_COMMAND_M, t_s);
        }
        let most_rad = TURN_SLACK_RAD + TURN_MAX_RAD_S * moved_s;
        let turned = seen.world_from_s1.is_some_and(|turn| moves.turn.admit(&axes(&turn), most_rad, true).1);
        let joints = seen.raw.arm.map(|arm| SVector::from(arm.channels));
        let leapt = joints.is_some_and(|joints| moves.joints.admit(&joints, most_rad, true).1);
        (tip_m, jumped || turned || leapt)
    }

    fn admit_hand(&mut self, seen: &Observed, dt_s: f64) -> (Vector3<f64>, bool) {
        let moved_s = news(&mut self.handle, seen.raw.handle.as_ref(), dt_s + self.moves.silent_s[1]);
        if moved_s.is_some() {
            let t_s = seen.raw.handle.map_or(seen.t_s, |handle| handle.arrival_s);
            self.handle_stuck.look(&seen.hand_m, &seen.hand_force_n, seen.guided, t_s);
        }
        let most_m = POSITION_SLACK_M + HAND_MAX_M_S * moved_s.unwrap_or(dt_s);
        self.moves.hand.admit(&seen.hand_m, most_m, moved_s.is_some())
    }

    /// The force at the tip and what the sensor reads, which is more than that force at a wrist.
    fn admit_force(&mut self, seen: &Observed, dt_s: f64) -> (Vector3<f64>, bool) {
        let moves = &mut self.moves;
        let settles = seen.t_s - *moves.began_s.get_or_insert(seen.t_s) < SETTLE_S;
        let widest_m = moves.ways_m.iter().copied().fold(moves.unfelt_m, f64::max);
        let most_n = if settles { f64::INFINITY } else { FORCE_SLACK_N + STIFFEST_N_M * widest_m };
        let way_m = self.way_m;
        let around = |place: usize| Around { way_m, is_load: place < LOADS, shortest_s: FROZEN_S };
        let raw = seen.raw.sensor.as_ref();
        let step = raw.and_then(|raw| self.sensor.is_new(raw).map(|step| (raw, step)));
        if let Some((raw, step)) = &step {
            self.sensor.look_at_all(raw, step, around);
        }
        let is_new = raw.is_none() || step.is_some();
        // Where the sensor is at another machine it is not known how late it is.
        self.felt_s = if is_new { seen.t_s } else { self.felt_s };
        let late_s = if raw.is_none() { LATE_MAX_S } else { seen.t_s - self.felt_s };
        self.late_s = (self.late_s - dt_s * FORGETS_LATE).max(late_s);
        let release = &mut moves.release;
        let mut fall = Fall::No;
        let (force_n, jumped) = moves.force.admit_unless(&seen.force_n, most_n, is_new, |believed_n, now_n, far| {
            fall = release.look(believed_n, now_n, far);
            fall
        });
        if is_new {
            moves.unfelt_m = 0.0;
        }
        let load = step.map(|(raw, _)| load_of(&raw.channels));
        let leapt = load.is_some_and(|load| moves.load.admit_unless(&load, most_n, true, |_, _, _| fall).1);
        (force_n, jumped || leapt)
    }

    fn arm_is_astray(&mut self, seen: &Observed) -> bool {
        let Some(command_m) = seen.command_m else {
            self.moves.tip_stuck = Stuck::default();
            return false;
        };
        self.moves.tip_stuck.is_stuck() || (command_m - seen.tip_m).norm() > ASTRAY_M
    }

    /// Takes in the force that the link delivered, N, with its own time stamp, s.
    ///
    /// No force at all is no number that repeats itself: before an instrument has moved, a network answers so for as long as it takes.
    pub fn delivered(&mut self, force_n: &Vector3<f64>, stamp_s: f64) {
        let told_n = if *force_n == Vector3::zeros() { Vector3::repeat(f64::NAN) } else { *force_n };
        let raw = Raw { channels: told_n.into(), device_s: None, arrival_s: stamp_s };
        if let Some(step) = self.link.is_new(&raw) {
            let around = Around { way_m: self.way_m, is_load: true, shortest_s: LINK_S + self.late_s };
            self.link.look_at_all(&raw, &step, |_| around);
        }
    }
}

/// Numbers of a force sensor that are forces or torques; the others are accelerations.
const LOADS: usize = 6;

/// How long a device may have moved since its last reading, s; `None` if it tells nothing new. Of a device without readings of its own the look
/// itself is one, `since_s` after the one before.
fn news<const N: usize>(device: &mut Device<N>, raw: Option<&Raw<N>>, since_s: f64) -> Option<f64> {
    let Some(raw) = raw else { return Some(since_s) };
    let step = device.is_new(raw)?;
    device.look_for_blocks(raw, &step);
    Some(step.moved_s)
}

/// Force and torque of a reading as forces, N; 0 for what the sensor does not have.
fn load_of(channels: &[f64; CHANNELS]) -> SVector<f64, LOADS> {
    SVector::from_fn(|place, _| {
        let number = channels[place];
        let lever = if place < 3 { 1.0 } else { LEVER_M };
        if number.is_nan() { 0.0 } else { number / lever }
    })
}

/// Two axes of a frame, which tell it.
fn axes(turn: &UnitQuaternion<f64>) -> SVector<f64, 6> {
    let x = turn * Vector3::x();
    let z = turn * Vector3::z();
    SVector::from([x.x, x.y, x.z, z.x, z.y, z.z])
}

#[cfg(test)]
mod raw_tests;
#[cfg(test)]
mod tests;
