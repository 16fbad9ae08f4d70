//! Plausibility: numbers that are finite and in time and still cannot be true.
//!
//! In: one exchange's measurements ([`Observed`]: m, N, workspace frame; time in s). Out: the same with single leaps taken out
//! ([`Admitted`]), and what cannot be true ([`Implausible`]). Each look takes constant time and allocates nothing. What a limit is taken
//! from stands beside it; all were tried against ten minutes of the ordinary scenes (`nima study faults`). Numbers that are
//! not finite must be kept away before.
//!
//! What no look can tell: a bias that creeps, a gain that is wrong from the start, axes that are exchanged before a first
//! contact. `docs/faults.md` says how large those errors become.

mod frozen;
mod leap;
mod opposed;
mod release;

use nalgebra::{SVector, UnitQuaternion, Vector3};

pub use frozen::{CHANNELS, Frozen};
pub use leap::Leap;
pub use opposed::Opposed;
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
/// A wrist turns by no more than this in a tick (length of the way of its axes): 50 rad/s at 1 kHz.
const TURN_MAX: f64 = 0.1;
/// The tip's way in one tick is the largest of so many ticks: arm and force sensor tick by their own clocks.
const WAY_TICKS: usize = 4;
/// A handle that stands to the last bit while its force changes by this much is stuck, N: a gripping hand of 900 N/m gives way by 0.8 mm.
const STUCK_FORCE_N: f64 = 0.7;
/// Or that stands so for [`UNMOVED_S`] under this force, N: a hand that grips trembles, one that is gone gives way.
const UNMOVED_FORCE_N: f64 = 0.5;
const UNMOVED_S: f64 = 0.1;
/// That holds for a handle which has not stood for [`RESTFUL_S`] in this time, s: one that is led by a machine may stand.
const TREMBLED_S: f64 = 10.0;
const RESTFUL_S: f64 = 0.05;
/// A tip that stands to the last bit while its command goes this far does not follow, m.
const STUCK_COMMAND_M: f64 = 0.5e-3;
/// Shortest time to call something stuck, s.
const STUCK_S: f64 = 0.015;
/// A tip so far from its command has lost it, m: an arm of 60 ms lag at the fastest command.
const ASTRAY_M: f64 = 0.02;

/// What cannot be true.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Implausible {
    /// A reading of the force sensor, or of the accelerometer in it, repeats itself to the last bit.
    ForceFrozen,
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
    /// The arm's tip jumped farther than the arm can move it.
    TipJumped,
    /// The arm does not go where it is commanded.
    ArmAstray,
}

/// What is looked at in one tick.
#[derive(Clone, Copy, Debug)]
pub struct Observed {
    /// Loop time, s.
    pub t_s: f64,
    /// Age of the oldest part of it, s.
    pub age_s: f64,
    /// The force sensor's numbers as they were read (force, torque, acceleration); NaN where there is none.
    pub sensed: [f64; CHANNELS],
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

/// Something that stands to the last bit while something else moves.
#[derive(Clone, Copy, Debug, Default)]
struct Stuck {
    at: Option<(Vector3<f64>, Vector3<f64>, f64)>,
}

impl Stuck {
    /// `still` has not changed for [`STUCK_S`] while `moving` went farther than `most` from where it was then.
    fn look(&mut self, still: &Vector3<f64>, moving: &Vector3<f64>, most: f64, t_s: f64) -> bool {
        match self.at {
            Some((was, from, since_s)) if was == *still => t_s - since_s > STUCK_S && (moving - from).norm() > most,
            _ => {
                self.at = Some((*still, *moving, t_s));
                false
            }
        }
    }
}

/// The looks and their memory.
#[derive(Clone, Debug)]
pub struct Plausibility {
    period_s: f64,
    frozen: Frozen<CHANNELS>,
    link_frozen: Frozen<3>,
    force: Leap,
    release: Release,
    tip: Leap,
    hand: Leap,
    turn: Leap<6>,
    opposed: Opposed,
    handle_stuck: Stuck,
    tip_stuck: Stuck,
    hand_before_m: Option<Vector3<f64>>,
    unmoved_since_s: f64,
    /// Since when the handle has not stood for [`RESTFUL_S`], s.
    trembles_since_s: f64,
    ways_m: [f64; WAY_TICKS],
    /// How long tip and handle had been silent at the last look, s.
    silent_s: [f64; 2],
    last_t_s: f64,
    /// When this watch began, s; not known before the first look.
    began_s: Option<f64>,
    doubt: Option<Implausible>,
    link_doubt: bool,
}

impl Plausibility {
    /// Nothing seen yet, for a loop of this period (s).
    pub fn new(period_s: f64) -> Self {
        Self {
            period_s,
            frozen: Frozen::default(),
            link_frozen: Frozen::default(),
            force: Leap::default(),
            release: Release::default(),
            tip: Leap::default(),
            hand: Leap::default(),
            turn: Leap::default(),
            opposed: Opposed::new(period_s),
            handle_stuck: Stuck::default(),
            tip_stuck: Stuck::default(),
            hand_before_m: None,
            unmoved_since_s: f64::INFINITY,
            trembles_since_s: f64::INFINITY,
            ways_m: [0.0; WAY_TICKS],
            silent_s: [0.0; 2],
            last_t_s: f64::NEG_INFINITY,
            began_s: None,
            doubt: None,
            link_doubt: false,
        }
    }

    /// What cannot be true of the newest look, if anything.
    pub fn doubt(&self) -> Option<Implausible> {
        self.doubt.or_else(|| self.link_doubt.then_some(Implausible::LinkFrozen))
    }

    /// A new engagement: what was commanded and felt before it counts no more.
    pub fn engage(&mut self) {
        self.opposed = Opposed::new(self.period_s);
        (self.handle_stuck, self.tip_stuck) = (Stuck::default(), Stuck::default());
    }

    /// The force is known from now on, or computed in another way: what it was before says nothing about a jump.
    pub fn force_is_new(&mut self) {
        (self.force, self.release) = (Leap::default(), Release::default());
        self.began_s = None;
    }

    /// Takes one exchange in and gives what may be used of it.
    pub fn step(&mut self, seen: &Observed) -> Admitted {
        let dt_s = seen.t_s - self.last_t_s;
        // After a gap, or a clock that was set, nothing is known of how far anything may have gone.
        if !(dt_s > 0.0 && dt_s <= STUCK_S) {
            *self = Self::new(self.period_s);
        }
        self.last_t_s = seen.t_s;
        let dt_s = if dt_s.is_finite() { dt_s.max(self.period_s) } else { self.period_s };
        let [tip_s, hand_s] = self.silent_s.map(|silent_s| dt_s + silent_s);
        self.silent_s = [seen.tip_silent_s, seen.hand_silent_s];
        let (tip_m, tip_jumped) = self.tip.admit(&seen.tip_m, POSITION_SLACK_M + TIP_MAX_M_S * tip_s);
        let (hand_m, hand_jumped) = self.hand.admit(&seen.hand_m, POSITION_SLACK_M + HAND_MAX_M_S * hand_s);
        let way_m = self.tip.moved().norm();
        self.ways_m.rotate_right(1);
        self.ways_m[0] = way_m;
        let widest_m = self.ways_m.iter().copied().fold(0.0, f64::max);
        let settles = seen.t_s - *self.began_s.get_or_insert(seen.t_s) < SETTLE_S;
        let most_n = if settles { f64::INFINITY } else { FORCE_SLACK_N + STIFFEST_N_M * widest_m };
        let release = &mut self.release;
        let falls = |believed_n: &Vector3<f64>, now_n: &Vector3<f64>, far| release.look(believed_n, now_n, far);
        let (force_n, force_jumped) = self.force.admit_unless(&seen.force_n, most_n, falls);
        // A sensor that sends nothing is late, not frozen: its last reading grows old, and other watches tell so.
        let frozen = self.frozen.look(&seen.sensed, seen.t_s - seen.age_s);
        let along = self.opposed.look(&force_n, seen.least_n, self.tip.moved(), seen.command_m.is_some());
        let turned = seen.world_from_s1.is_some_and(|turn| self.turn.admit(&axes(&turn), TURN_MAX).1);
        let doubts = [
            (force_jumped, Implausible::ForceJumped),
            (frozen, Implausible::ForceFrozen),
            (along, Implausible::ForceAlong),
            (hand_jumped, Implausible::HandleJumped),
            (tip_jumped || turned, Implausible::TipJumped),
            (self.handle_is_stuck(seen), Implausible::HandleFrozen),
            (self.arm_is_astray(seen), Implausible::ArmAstray),
        ];
        self.doubt = doubts.into_iter().find_map(|(is, what)| is.then_some(what));
        Admitted { force_n, tip_m, hand_m }
    }

    fn handle_is_stuck(&mut self, seen: &Observed) -> bool {
        let stuck = self.handle_stuck.look(&seen.hand_m, &seen.hand_force_n, STUCK_FORCE_N, seen.t_s);
        let pressed = !seen.guided && seen.hand_force_n.norm() >= UNMOVED_FORCE_N;
        if self.hand_before_m != Some(seen.hand_m) {
            self.unmoved_since_s = seen.t_s;
        }
        self.hand_before_m = Some(seen.hand_m);
        self.trembles_since_s = self.trembles_since_s.min(seen.t_s);
        let stood_s = seen.t_s - self.unmoved_since_s;
        let trembled = self.unmoved_since_s - self.trembles_since_s >= TREMBLED_S;
        if stood_s > RESTFUL_S && !(trembled && pressed) {
            self.trembles_since_s = seen.t_s;
        }
        (stuck && !seen.guided) || (trembled && pressed && stood_s > UNMOVED_S)
    }

    fn arm_is_astray(&mut self, seen: &Observed) -> bool {
        let Some(command_m) = seen.command_m else {
            self.tip_stuck = Stuck::default();
            return false;
        };
        let stuck = self.tip_stuck.look(&seen.tip_m, &command_m, STUCK_COMMAND_M, seen.t_s);
        stuck || (command_m - seen.tip_m).norm() > ASTRAY_M
    }

    /// Takes in the force that the link delivered, N, with its own time stamp, s.
    ///
    /// No force at all is no number that repeats itself: before an instrument has moved, a network answers so for as long as it takes.
    pub fn delivered(&mut self, force_n: &Vector3<f64>, stamp_s: f64) {
        let told_n = if *force_n == Vector3::zeros() { Vector3::repeat(f64::NAN) } else { *force_n };
        self.link_doubt = self.link_frozen.look(told_n.as_ref(), stamp_s);
    }
}

/// Two axes of a frame, which tell it.
fn axes(turn: &UnitQuaternion<f64>) -> SVector<f64, 6> {
    let (x, z) = (turn * Vector3::x(), turn * Vector3::z());
    SVector::from([x.x, x.y, x.z, z.x, z.y, z.z])
}

#[cfg(test)]
mod tests;
