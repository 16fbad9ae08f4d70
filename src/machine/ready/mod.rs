//! The ready check: a short list that is gone through before the first engagement of the day, mostly by itself.
//!
//! A [`Session`] is a state machine without input, output or a clock. It is fed with what the loop publishes (ticks, healths, gauges,
//! refusals) and with the time (s, any origin), tells what it needs of a person ([`Ask`]) and which command it wants sent, and ends with
//! the [`State`] of every [`Check`]: a measured [`Figure`] with its limit, a [`Cause`], or what the rig [`Lacks`]. Nothing here engages,
//! and no force is asked for. A watchdog is tested by [`Command::TestWatchdog`](crate::messages::Command::TestWatchdog), which the loop
//! obeys in idle only.

mod arms;
mod bias;
mod ceiling;
mod clocks;
mod devices;
mod handle;
mod item;
mod own;
mod push;
mod rates;
mod session;
mod stop;
#[cfg(test)]
mod tests;
mod trocar;
mod watchdog;

use nalgebra::{UnitVector3, Vector3};
use nima_core::{
    calibration::{
        frames::Move,
        gravity::{GravityModel, NotChecked},
    },
    safety::ChainSettings,
};

pub use session::{Entry, Session};

use crate::{
    config::RigConfig,
    messages::{Fault, ForceSource, Refusal, Watchdog},
    rig::{Exchange, Part, Prompt, SIDES, Side, checkup::Finding},
};

/// One point of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// Every device of the rig file is there and stays.
    Devices,
    /// Each delivers at its rate, without losses.
    Rates,
    /// The loop keeps its deadlines, and the computer's date can be right.
    Clocks,
    /// The arm of this side moves when its instrument is moved, its marker with it, and the other side's do not.
    Own(Side),
    /// The bias of the wrist sensor is where it was when it was calibrated.
    Bias(Side),
    /// A push is measured in the direction in which it is made.
    Push(Side),
    /// The handle is free, does not pull, and its axes are right.
    Handle(Side),
    /// The trocar is where the rig file has it.
    Trocar(Side),
    /// The largest force is the one of the rig file.
    Ceiling,
    /// The stop works.
    Stop,
    /// A watchdog bites.
    Watchdog(Watchdog),
}

impl Check {
    /// The arm that it is about.
    pub const fn side(self) -> Option<Side> {
        match self {
            Self::Own(side) | Self::Bias(side) | Self::Push(side) | Self::Handle(side) | Self::Trocar(side) => {
                Some(side)
            }
            Self::Devices | Self::Rates | Self::Clocks | Self::Ceiling | Self::Stop | Self::Watchdog(_) => None,
        }
    }
}

/// What is needed of a person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ask {
    /// Nothing: wait.
    Nothing,
    /// Move the instrument by 10 cm, out of its trocar.
    Move(Side),
    /// Take the instrument out of its trocar, so that nothing touches it.
    TakeOut(Side),
    /// It is out: do not touch it.
    LeaveAlone(Side),
    /// Push the instrument's tip in this direction (`world`).
    Push(Side, UnitVector3<f64>),
    /// Let the handle go.
    LetGo(Side),
    /// Move the handle in this direction of the picture.
    MoveHandle(Side, Move),
    /// Put the instrument through its trocar, and leave it there.
    PutBack(Side),
    /// Press the stop.
    PressStop,
    /// Release the stop or the fault, as always.
    Release,
}

impl Ask {
    /// The instruction to the person at an arm.
    pub const fn prompt(&self) -> Prompt {
        match self {
            Self::Push(_, direction) => Prompt::Push { direction: *direction },
            Self::MoveHandle(_, way) => Prompt::MoveHandle(*way),
            _ => Prompt::Rest,
        }
    }

    /// The arm at which something is to be done.
    pub const fn side(&self) -> Option<Side> {
        match self {
            Self::Move(side)
            | Self::TakeOut(side)
            | Self::LeaveAlone(side)
            | Self::Push(side, _)
            | Self::LetGo(side)
            | Self::MoveHandle(side, _)
            | Self::PutBack(side) => Some(*side),
            Self::Nothing | Self::PressStop | Self::Release => None,
        }
    }

    /// Whether it is done with the instrument out of its trocar.
    pub const fn is_out_of_trocar(&self) -> bool {
        !matches!(self, Self::Nothing | Self::PutBack(_) | Self::PressStop | Self::Release)
    }
}

/// Unit of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    Count,
    Newton,
    Millimetre,
    Degree,
    Percent,
    Second,
}

/// What was measured, and its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    pub value: f64,
    pub limit: f64,
    pub unit: Unit,
}

/// What a rig has not, so that a check is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lacks {
    /// Everything is simulated.
    Devices,
    /// The force is measured at the tip: there is no weight and no calibrated bias.
    WristSensor,
    /// Nobody stands at the simulated arm.
    Person,
    /// There is one arm only: nothing can be exchanged.
    OtherArm,
}

/// Why a check failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// This device of the roster is not there, or does not stay.
    Missing {
        /// Its place in the roster.
        place: usize,
    },
    /// The test of this device has found something.
    Found {
        /// Its place in the roster.
        place: usize,
        /// What.
        finding: Finding,
    },
    /// What the devices deliver was not published.
    NoGauges,
    /// The loop sends nothing.
    NoTicks,
    /// Too many periods were missed.
    Missed {
        /// Their share, 0 to 1.
        share: f64,
    },
    /// The loop's clock does not go as this computer's.
    LoopClock {
        /// How far apart they went within the check, s.
        by_s: f64,
    },
    /// A calibration is dated in the future.
    DateBehind,
    /// There is no gravity calibration for this sensor and tool.
    Uncalibrated,
    /// The force at the tip is not known, for this reason.
    ForceUnknown(ForceSource),
    /// The bias has moved, or something rests on the tool.
    BiasMoved {
        /// Force that remains at rest, N.
        by_n: f64,
        /// Its limit, N.
        limit_n: f64,
    },
    /// The bias could not be looked at.
    BiasUnseen(NotChecked),
    /// Right and left are exchanged.
    Exchanged(Exchange),
    /// The arm did not move.
    ArmStuck {
        /// How far it came, m.
        by_m: f64,
    },
    /// The tracker does not see the marker on the instrument, or it does not move with it.
    MarkerStuck {
        /// How far it came, m.
        by_m: f64,
    },
    /// No push was felt.
    NoPush {
        /// The largest force, N.
        most_n: f64,
    },
    /// The push was measured in another direction.
    PushAskew {
        /// How far off, degrees; near 180 the sign is wrong.
        by_deg: f64,
    },
    /// The handle moves by itself.
    HandlePulls {
        /// How far, m.
        by_m: f64,
    },
    /// A force was asked of the handle in idle.
    HandleForce {
        /// N.
        force_n: f64,
    },
    /// The handle was not moved.
    HandleStuck {
        /// How far it came, m.
        by_m: f64,
    },
    /// The handle's reading moved in another direction than the hand.
    HandleAskew {
        /// How far off, degrees.
        by_deg: f64,
    },
    /// The shaft does not pass through the trocar.
    BesideTrocar {
        /// How far it misses it, m.
        miss_m: f64,
    },
    /// The trocar has moved.
    TrocarMoved {
        /// How far across the shaft, m.
        by_m: f64,
    },
    /// The rig file cannot be read any more.
    NoRigFile,
    /// The loop has another limit than the rig file.
    OtherCeiling {
        /// In force, N.
        in_force_n: f64,
        /// In the rig file, N.
        in_file_n: f64,
    },
    /// No stop was seen.
    NoStop,
    /// Only one of the arms has stopped.
    HalfStop(Side),
    /// There was a force in a state that permits none.
    Force {
        /// N.
        force_n: f64,
    },
    /// The stop or the fault was not released; why the loop refused it, if somebody tried.
    NotReleased(Option<Refusal>),
    /// The watchdog raised no fault.
    NoBite(Watchdog),
    /// It took too long.
    LateBite {
        /// Until the fault, s.
        after_s: f64,
    },
    /// Another fault was raised.
    OtherFault(Fault),
    /// The loop refused the test.
    Refused(Refusal),
    /// An arm was engaged during the check.
    Engaged(Side),
}

/// Where a check stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    /// Not begun.
    Waiting,
    /// Going on; what it needs.
    Asking(Ask),
    /// In order.
    Passed(Figure),
    /// Not in order.
    Failed(Cause),
    /// The rig has no such part.
    LeftOut(Lacks),
}

/// What is known of one arm.
#[derive(Clone, Debug)]
pub struct Arm {
    /// The force is measured at the wrist.
    pub at_wrist: bool,
    /// Its gravity calibration, and the limit of the force that remains at rest, N.
    pub gravity: Option<(GravityModel, f64)>,
    /// Somebody is at the arm who can be asked for something.
    pub has_person: bool,
}

/// What is checked.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The rig as the loop runs it.
    pub rig: RigConfig,
    /// Its arms.
    pub arms: [Option<Arm>; SIDES],
    /// The parts of the rig, in the order of the roster.
    pub parts: Vec<Option<Part>>,
    /// The gates as the rig file has them now; `None` if it cannot be read.
    pub gates_in_file: Option<ChainSettings>,
    /// A calibration in force is dated in the future.
    pub is_date_behind: bool,
}

impl Subject {
    fn sides(&self) -> impl Iterator<Item = Side> + '_ {
        Side::ALL.into_iter().filter(|side| self.arms[side.index()].is_some())
    }

    /// The whole list, with what this rig has not left out.
    fn list(&self) -> Vec<Entry> {
        let has_devices = self.rig.devices.is_some();
        let on_devices = if has_devices { State::Waiting } else { State::LeftOut(Lacks::Devices) };
        let entry = |check, state| Entry { check, state };
        let mut list: Vec<Entry> =
            [Check::Devices, Check::Rates, Check::Clocks].map(|check| entry(check, on_devices)).into();
        for side in self.sides() {
            let Some(arm) = &self.arms[side.index()] else { continue };
            let at_wrist = if arm.at_wrist { State::Waiting } else { State::LeftOut(Lacks::WristSensor) };
            let by_person = if arm.has_person { State::Waiting } else { State::LeftOut(Lacks::Person) };
            let beside = if self.arms.iter().flatten().count() < SIDES { Some(Lacks::OtherArm) } else { None };
            list.push(entry(Check::Own(side), beside.filter(|_| has_devices).map_or(on_devices, State::LeftOut)));
            list.push(entry(Check::Bias(side), at_wrist));
            list.push(entry(Check::Push(side), by_person));
            list.push(entry(Check::Handle(side), by_person));
            list.push(entry(Check::Trocar(side), on_devices));
        }
        list.extend([Check::Ceiling, Check::Stop].map(|check| entry(check, State::Waiting)));
        list.extend(Watchdog::ALL.map(|watchdog| entry(Check::Watchdog(watchdog), State::Waiting)));
        list
    }
}

/// Angle between two directions, degrees; 180 if one of them is none.
fn angle_deg(one: &Vector3<f64>, other: &Vector3<f64>) -> f64 {
    let lengths = one.norm() * other.norm();
    if lengths > 0.0 { libm::acos((one.dot(other) / lengths).clamp(-1.0, 1.0)).to_degrees() } else { 180.0 }
}
