//! Plausibility: detects numbers that are finite and in time but cannot be true.
//!
//! Input: the measurements of one exchange ([`PlausibilityInput`]: m, N, workspace frame; time in s) and the readings
//! from which they were computed ([`RawReadings`]: the devices' own frames, units and times). Out: the same
//! measurements without single jumps ([`AdmittedReadings`]), and the quantity that cannot be true ([`Implausible`]). A
//! reading that arrives twice is not a new reading: a device may be slower than the loop. Each check takes constant
//! time and allocates nothing. The basis of each limit is given with it; all limits were tried against the ordinary
//! scenes (`nima study faults`). The caller must remove non-finite numbers first.
//!
//! No check can detect a bias that creeps, a gain that is wrong from the start, or axes that are swapped before the
//! first contact. `docs/results/faults.md` lists how large those errors become.

mod channel;
mod device;
mod jump_detector;
mod opposed;
mod raw;
mod release;
mod repeats;
mod stuck;

use nalgebra::{SVector, UnitQuaternion, Vector3};

use self::{
    channel::{Around, FROZEN_S, ReadingFault},
    device::DeviceMemory,
    stuck::{HandleStuck, Stuck},
};

pub use jump_detector::JumpDetector;
pub use opposed::TouchMemory;
pub use raw::{ARM_CHANNELS, CHANNELS, HANDLE_CHANNELS, RawReading, RawReadings};
pub use release::{Fall, ReleaseMemory};

/// Maximum speed of a handle, m/s: the fastest human arm movements reach 2 to 3 m/s in throwing, not in operating.
const HAND_MAX_M_S: f64 = 3.0;
/// Maximum speed of an arm's tip, m/s: three times the fastest command.
const TIP_MAX_M_S: f64 = 1.0;
/// Difference of positions that has other causes than motion, m.
/// Quantisation, noise and the scatter of the poll times, which exist at rest too. Larger values hide jumps of a slow
/// hand.
const POSITION_SLACK_M: f64 = 2e-3;
/// Maximum change of the force of a resting tip between two samples, N: nine standard deviations of the noisiest sensor
/// here.
const FORCE_SLACK_N: f64 = 0.5;
/// Additional change of the force per metre of tip travel, N/m: fifteen times soft tissue. Together with
/// [`FORCE_SLACK_N`] it permits 15 kN/m at 50 mm/s.
const STIFFEST_N_M: f64 = 5e3;
/// Time for which the filters behind a force settle after a start or a gap, s: until then the force may jump.
const SETTLE_S: f64 = 0.05;
/// Maximum combined speed of an arm's joints, rad/s: three times that of the fastest joint of a Gen3. It also applies
/// to the wrist (travel of the axes).
const TURN_MAX_RAD_S: f64 = 5.0;
/// Difference of angles that has other causes than motion, rad.
/// About 6 degrees: as for positions, noise and poll times turn a resting wrist a little.
const TURN_SLACK_RAD: f64 = 0.1;
/// The tip's travel between two readings of the arm is the maximum over this many readings, because arm and force
/// sensor run on their own clocks.
const WAY_READINGS: usize = 4;
/// A torque of the sensor is divided by this length before comparison with forces, m: a force at the tip acts on the
/// lever of the shaft.
const LEVER_M: f64 = 0.5;
/// If the command moves this far while the tip's position stays identical to the last bit, the tip does not follow, m.
/// Design choice, with no false alarm in 136 healthy minutes (`docs/results/faults.md`).
const STUCK_COMMAND_M: f64 = 0.5e-3;
/// After a longer gap between two checks the possible travel is unknown, s.
const GAP_S: f64 = 0.015;
/// If the link repeats a force for longer than the sensor's lateness plus this time, the link is at fault, s. The
/// silence of a sensor is reported after the longest time; the lateness is forgotten at this rate, which is slower than
/// any delay of the link.
const LINK_S: f64 = 0.015;
const LATE_MAX_S: f64 = 0.02;
const FORGETS_LATE: f64 = 0.02;
/// If the tip is this far from its command, the arm has lost it, m: an arm with a lag of 60 ms at the fastest command.
const ASTRAY_M: f64 = 0.02;
/// Number of consecutive readings that must change like an earlier block: a force sensor's numbers are fine, and none
/// of six occurs twice. Whole encoder counts recur; thirty of them recur by chance once in 2^30.
const SENSOR_BLOCK: u32 = 6;
const ENCODER_BLOCK: u32 = 30;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Implausible {
    /// A reading of the force sensor, or of its accelerometer, repeats to the last bit.
    ForceFrozen,
    /// A number of the force sensor is stuck at the end of its range.
    ForceSaturated,
    /// The force sensor repeats an earlier block of readings.
    ForceRepeats,
    /// The force changed by more than a contact can cause, and not to zero as at the end of a contact.
    ForceJumped,
    /// The force points along the motion into a contact.
    ForceAlong,
    /// The data from the link repeat with new time stamps.
    LinkFrozen,
    /// The handle jumped farther than a hand can move it.
    HandleJumped,
    /// The handle's position stays identical to the last bit while its force changes.
    HandleFrozen,
    /// The handle repeats an earlier block of readings.
    HandleRepeats,
    /// The tip or the joints jumped farther than the arm can move.
    TipJumped,
    /// The arm repeats an earlier block of readings.
    ArmRepeats,
    ArmAstray,
}

#[derive(Clone, Copy, Debug)]
pub struct PlausibilityInput {
    pub t_s: f64,
    /// The devices' readings from which the other fields were computed.
    pub raw: RawReadings,
    /// Force at the tip computed from the readings, N.
    pub force_n: Vector3<f64>,
    /// A force below this counts as zero, N: a force computed from a wrist sensor has a larger error than a force
    /// measured at the tip.
    pub min_n: f64,
    /// Orientation of the wrist from the arm, if known.
    pub world_from_s1: Option<UnitQuaternion<f64>>,
    pub tip_m: Vector3<f64>,
    /// Position of the handle, m (in its device's axes).
    pub hand_m: Vector3<f64>,
    /// Tip position commanded to the arm one tick ago, m: its plan if that is known, otherwise the hand's command.
    /// `None` while the tip is at rest.
    pub command_m: Option<Vector3<f64>>,
    /// Commanded force on the hand one tick ago, N.
    pub hand_force_n: Vector3<f64>,
    /// Whether the handle is guided from the screen: it may then be at rest under a force.
    pub guided: bool,
    /// Age of the tip's data received over a network, s; 0 for a device on this machine. After a gap, the tip may have
    /// moved farther.
    pub tip_silent_s: f64,
    /// Age of the handle's data, like `tip_silent_s`.
    pub hand_silent_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdmittedReadings {
    pub force_n: Vector3<f64>,
    pub tip_m: Vector3<f64>,
    /// The handle, m.
    pub hand_m: Vector3<f64>,
}

#[derive(Clone, Debug)]
pub struct Plausibility {
    sensor: DeviceMemory<CHANNELS>,
    handle: DeviceMemory<HANDLE_CHANNELS>,
    arm: DeviceMemory<ARM_CHANNELS>,
    link: DeviceMemory<3>,
    moves: PlausibilityMoves,
    handle_stuck: HandleStuck,
    /// Travel of the tip so far, m.
    travel_m: f64,
    /// Time of the force sensor's last new reading, s, and its recent lateness.
    felt_s: f64,
    late_s: f64,
    last_t_s: f64,
    doubt: Option<Implausible>,
}

#[derive(Clone, Debug, Default)]
struct PlausibilityMoves {
    force: JumpDetector,
    release: ReleaseMemory,
    load: JumpDetector<6>,
    tip: JumpDetector,
    hand: JumpDetector,
    joints: JumpDetector<ARM_CHANNELS>,
    turn: JumpDetector<6>,
    opposed: TouchMemory,
    tip_stuck: Stuck,
    travels_m: [f64; WAY_READINGS],
    /// Travel of the tip since the newest reading of the force sensor, m.
    unfelt_m: f64,
    /// Ages of the data of tip and handle at the last check, s.
    silent_s: [f64; 2],
    /// Time of the first check, s; `None` before the check.
    began_s: Option<f64>,
}

impl Default for Plausibility {
    fn default() -> Self {
        Self {
            sensor: DeviceMemory::new(SENSOR_BLOCK),
            // Position channels repeat whole counts, hence the longer block for handle and arm.
            handle: DeviceMemory::new(ENCODER_BLOCK),
            arm: DeviceMemory::new(ENCODER_BLOCK),
            link: DeviceMemory::new(SENSOR_BLOCK),
            moves: PlausibilityMoves::default(),
            handle_stuck: HandleStuck::default(),
            travel_m: 0.0,
            felt_s: 0.0,
            late_s: LATE_MAX_S,
            last_t_s: f64::NEG_INFINITY,
            doubt: None,
        }
    }
}

impl Plausibility {
    /// Returns the quantity that cannot be true at the newest check, if any.
    pub fn doubt(&self) -> Option<Implausible> {
        self.doubt.or_else(|| self.link.wrong().map(|_| Implausible::LinkFrozen))
    }

    /// Starts a new engagement: earlier commands and forces no longer count.
    pub fn engage(&mut self) {
        self.moves.opposed = TouchMemory::default();
        // The handle's memory of its values is kept: only forces of the previous engagement are irrelevant.
        self.moves.tip_stuck = Stuck::default();
        self.handle_stuck.engage();
    }

    /// Declares that the force becomes known now, or is computed in a new way, so that a difference from the previous
    /// force is not a jump.
    pub fn force_is_new(&mut self) {
        let moves = &mut self.moves;
        moves.force = JumpDetector::default();
        moves.release = ReleaseMemory::default();
        moves.load = JumpDetector::default();
        moves.began_s = None;
    }

    /// Checks the measurements of one exchange and returns the usable ones.
    pub fn step(&mut self, seen: &PlausibilityInput) -> AdmittedReadings {
        let dt_s = self.pass(seen.t_s);
        let (tip_m, tip_jumped) = self.admit_tip(seen, dt_s);
        let (hand_m, hand_jumped) = self.admit_hand(seen, dt_s);
        let (force_n, force_jumped) = self.admit_force(seen, dt_s);
        self.moves.silent_s = [seen.tip_silent_s, seen.hand_silent_s];
        let went_m = *self.moves.tip.moved();
        let along = self.moves.opposed.look(dt_s, &force_n, seen.min_n, &went_m, seen.command_m.is_some());
        let of_sensor = |wrong: ReadingFault| match wrong {
            ReadingFault::Frozen => Implausible::ForceFrozen,
            ReadingFault::Saturated => Implausible::ForceSaturated,
            ReadingFault::Repeats => Implausible::ForceRepeats,
        };
        // The order is the priority: a wrong sensor explains a force along the motion, not the reverse.
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
        AdmittedReadings { force_n, tip_m, hand_m }
    }

    /// Advances to the time of this check; returns the time since the last one, s.
    fn pass(&mut self, t_s: f64) -> f64 {
        let dt_s = t_s - self.last_t_s;
        self.last_t_s = t_s;
        // Also false for NaN times, which then count as a gap.
        if dt_s > 0.0 && dt_s <= GAP_S {
            return dt_s;
        }
        // After a gap or a change of the clock, the possible travel is unknown. The value properties of a device remain
        // known.
        self.moves = PlausibilityMoves::default();
        self.handle_stuck = HandleStuck::default();
        0.0
    }

    fn admit_tip(&mut self, seen: &PlausibilityInput, dt_s: f64) -> (Vector3<f64>, bool) {
        let moves = &mut self.moves;
        // The silence of a remote device is added, because its tip may have moved while no data arrived.
        let moved_s = news(&mut self.arm, seen.raw.arm.as_ref(), dt_s + moves.silent_s[0]);
        let max_m = POSITION_SLACK_M + TIP_MAX_M_S * moved_s.unwrap_or(dt_s);
        // Without a new reading of the arm the tip can change only through other inputs, so it is bridged but not
        // counted.
        let (tip_m, jumped) = moves.tip.admit(&seen.tip_m, max_m, moved_s.is_some());
        let travel_m = moves.tip.moved().norm();
        self.travel_m += travel_m;
        moves.unfelt_m += travel_m;
        let Some(moved_s) = moved_s else { return (tip_m, jumped) };
        moves.travels_m.rotate_right(1);
        moves.travels_m[0] = travel_m;
        // A repeated time gives no travel, so nothing can be said about a stuck tip.
        if moved_s > 0.0 {
            let t_s = seen.raw.arm.map_or(seen.t_s, |arm| arm.arrival_s);
            moves.tip_stuck.look(&seen.tip_m, &seen.command_m.unwrap_or(seen.tip_m), STUCK_COMMAND_M, t_s);
        }
        let max_rad = TURN_SLACK_RAD + TURN_MAX_RAD_S * moved_s;
        // Two axes as one vector, because the detector compares vectors.
        let turned = seen.world_from_s1.is_some_and(|turn| moves.turn.admit(&axes(&turn), max_rad, true).1);
        let joints = seen.raw.arm.map(|arm| SVector::from(arm.channels));
        let leapt = joints.is_some_and(|joints| moves.joints.admit(&joints, max_rad, true).1);
        (tip_m, jumped || turned || leapt)
    }

    fn admit_hand(&mut self, seen: &PlausibilityInput, dt_s: f64) -> (Vector3<f64>, bool) {
        let moved_s = news(&mut self.handle, seen.raw.handle.as_ref(), dt_s + self.moves.silent_s[1]);
        if moved_s.is_some() {
            let t_s = seen.raw.handle.map_or(seen.t_s, |handle| handle.arrival_s);
            self.handle_stuck.look(&seen.hand_m, &seen.hand_force_n, seen.guided, t_s);
        }
        let max_m = POSITION_SLACK_M + HAND_MAX_M_S * moved_s.unwrap_or(dt_s);
        self.moves.hand.admit(&seen.hand_m, max_m, moved_s.is_some())
    }

    /// Checks the force at the tip and the readings of the sensor, which at a wrist contain more than that force.
    fn admit_force(&mut self, seen: &PlausibilityInput, dt_s: f64) -> (Vector3<f64>, bool) {
        let moves = &mut self.moves;
        let settles = seen.t_s - *moves.began_s.get_or_insert(seen.t_s) < SETTLE_S;
        // The largest of the last readings: the sensor may have measured before the arm reported the motion that
        // caused it.
        let widest_m = moves.travels_m.iter().copied().fold(moves.unfelt_m, f64::max);
        let max_n = if settles { f64::INFINITY } else { FORCE_SLACK_N + STIFFEST_N_M * widest_m };
        let travel_m = self.travel_m;
        let around = |place: usize| Around { travel_m, is_load: place < LOADS, shortest_s: FROZEN_S };
        let raw = seen.raw.sensor.as_ref();
        let step = raw.and_then(|raw| self.sensor.is_new(raw).map(|step| (raw, step)));
        if let Some((raw, step)) = &step {
            self.sensor.look_at_all(raw, step, around);
        }
        let is_new = raw.is_none() || step.is_some();
        // For a sensor on another machine, the lateness is unknown.
        self.felt_s = if is_new { seen.t_s } else { self.felt_s };
        // The memory decays more slowly than a link can be late, so one punctual reading does not tighten the limit.
        let late_s = if raw.is_none() { LATE_MAX_S } else { seen.t_s - self.felt_s };
        self.late_s = (self.late_s - dt_s * FORGETS_LATE).max(late_s);
        let release = &mut moves.release;
        let mut fall = Fall::No;
        let (force_n, jumped) = moves.force.admit_unless(&seen.force_n, max_n, is_new, |believed_n, now_n, far| {
            fall = release.look(believed_n, now_n, far);
            fall
        });
        // Travel counts from the newest reading of the sensor: a sensor slower than the loop may show all of it at
        // once.
        if is_new {
            moves.unfelt_m = 0.0;
        }
        let load = step.map(|(raw, _)| load_of(&raw.channels));
        let leapt = load.is_some_and(|load| moves.load.admit_unless(&load, max_n, true, |_, _, _| fall).1);
        (force_n, jumped || leapt)
    }

    fn arm_is_astray(&mut self, seen: &PlausibilityInput) -> bool {
        let Some(command_m) = seen.command_m else {
            self.moves.tip_stuck = Stuck::default();
            return false;
        };
        self.moves.tip_stuck.is_stuck() || (command_m - seen.tip_m).norm() > ASTRAY_M
    }

    /// Checks the force that the link delivered, N, with its own time stamp, s.
    ///
    /// A force of exactly zero is not a repeated number: before an instrument has moved, the network returns zero for
    /// as long as that takes.
    pub fn delivered(&mut self, force_n: &Vector3<f64>, stamp_s: f64) {
        // NaN makes the detector forget the number, as for a missing channel.
        let reported_n = if *force_n == Vector3::zeros() { Vector3::repeat(f64::NAN) } else { *force_n };
        let raw = RawReading { channels: reported_n.into(), device_s: None, arrival_s: stamp_s };
        if let Some(step) = self.link.is_new(&raw) {
            let around = Around { travel_m: self.travel_m, is_load: true, shortest_s: LINK_S + self.late_s };
            self.link.look_at_all(&raw, &step, |_| around);
        }
    }
}

/// Number of channels of a force sensor that are forces or torques; the others are accelerations.
/// The order of `RawReading::of_sensor`: force, torque, acceleration.
const LOADS: usize = 6;

/// Returns how long a device may have moved since its last reading, s; `None` if its reading is not new. If a device
/// has no raw readings, each check counts as a reading, `since_s` after the previous one.
fn news<const N: usize>(device: &mut DeviceMemory<N>, raw: Option<&RawReading<N>>, since_s: f64) -> Option<f64> {
    let Some(raw) = raw else { return Some(since_s) };
    let step = device.is_new(raw)?;
    device.look_for_blocks(raw, &step);
    Some(step.moved_s)
}

/// Returns force and torque of a reading as forces, N; 0 for channels that the sensor lacks.
fn load_of(channels: &[f64; CHANNELS]) -> SVector<f64, LOADS> {
    SVector::from_fn(|place, _| {
        let number = channels[place];
        let lever = if place < 3 { 1.0 } else { LEVER_M };
        if number.is_nan() { 0.0 } else { number / lever }
    })
}

/// Returns two axes of a frame, which determine the frame.
fn axes(turn: &UnitQuaternion<f64>) -> SVector<f64, 6> {
    // The third axis follows from the other two, so it would add no information.
    let x = turn * Vector3::x();
    let z = turn * Vector3::z();
    SVector::from([x.x, x.y, x.z, z.x, z.y, z.z])
}

#[cfg(test)]
mod raw_tests;
#[cfg(test)]
mod tests;
