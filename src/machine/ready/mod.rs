//! The ready check: a short list of checks before the first engagement of the day, mostly automatic.
//!
//! A [`ReadySession`] is a state machine without input, output or a clock. It receives data published by the loop (ticks,
//! healths, gauges, refusals) and the time (s, any origin), reports the action that it needs from a person ([`PersonRequest`])
//! and the command that must be sent, and ends with the [`ReadyState`] of every [`ReadyPoint`]: a measured [`ReadyFigure`] with its
//! limit, a [`ReadyCause`], or the part that the rig [`Lacks`]. It never engages an arm and never requests a force. A
//! watchdog is tested by [`Command::TestWatchdog`](crate::messages::Command::TestWatchdog), which the loop accepts only
//! in idle.

mod arms;
mod bias;
mod ceiling;
mod clocks;
mod devices;
mod handle;
mod item;
mod push;
mod rates;
mod session;
mod side_check;
mod stop;
#[cfg(test)]
mod tests;
mod trocar;
mod watchdog;

use nalgebra::{UnitVector3, Vector3};
use nima_core::{
    calibration::{
        frames::ViewMove,
        gravity::{GravityModel, NotChecked},
    },
    safety::ChainSettings,
};

pub use session::{ReadyEntry, ReadySession};

use crate::{
    config::RigConfig,
    messages::{Fault, ForceSource, Refusal, Watchdog},
    rig::{Prompt, RigPart, SIDES, Side, SideSwap, checkup::CheckupFinding},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadyPoint {
    /// Every device of the rig file is connected and stays connected.
    Devices,
    /// Each device delivers data at its rate, without losses.
    Rates,
    /// The loop meets its deadlines, and the computer's date is plausible.
    Clocks,
    /// If the instrument of this side is moved, its arm and its marker move, and those of the other side do not.
    Own(Side),
    /// The bias of the wrist sensor is unchanged since its calibration.
    Bias(Side),
    /// A push is measured in its own direction.
    Push(Side),
    /// The handle is free, does not pull, and its axes are correct.
    Handle(Side),
    /// The trocar is at its position in the rig file.
    Trocar(Side),
    /// The force ceiling equals the one in the rig file.
    Ceiling,
    Stop,
    Watchdog(Watchdog),
}

impl ReadyPoint {
    pub const fn side(self) -> Option<Side> {
        match self {
            Self::Own(side) | Self::Bias(side) | Self::Push(side) | Self::Handle(side) | Self::Trocar(side) => {
                Some(side)
            }
            Self::Devices | Self::Rates | Self::Clocks | Self::Ceiling | Self::Stop | Self::Watchdog(_) => None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PersonRequest {
    Nothing,
    /// Move the instrument by 10 cm, outside its trocar.
    Move(Side),
    /// Take the instrument out of its trocar, so that nothing touches it.
    TakeOut(Side),
    /// The instrument is out: do not touch it.
    LeaveAlone(Side),
    /// Push the instrument's tip in this direction (`world`).
    Push(Side, UnitVector3<f64>),
    LetGo(Side),
    /// Move the handle in this direction of the image.
    MoveHandle(Side, ViewMove),
    /// Put the instrument through its trocar, and leave it there.
    PutBack(Side),
    PressStop,
    /// Release the stop or the fault, as usual.
    Release,
}

impl PersonRequest {
    /// Returns the instruction to the person at an arm.
    pub const fn prompt(&self) -> Prompt {
        match self {
            Self::Push(_, direction) => Prompt::Push { direction: *direction },
            Self::MoveHandle(_, way) => Prompt::MoveHandle(*way),
            _ => Prompt::Rest,
        }
    }

    /// Returns the arm at which the action takes place.
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

    /// Returns whether the action takes place with the instrument outside its trocar.
    pub const fn is_out_of_trocar(&self) -> bool {
        !matches!(self, Self::Nothing | Self::PutBack(_) | Self::PressStop | Self::Release)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FigureUnit {
    Count,
    Newton,
    Millimetre,
    Degree,
    Percent,
    Second,
}

/// A measured value and its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadyFigure {
    pub value: f64,
    pub limit: f64,
    pub unit: FigureUnit,
}

/// Part that a rig lacks, so that a check is skipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lacks {
    Devices,
    /// The force is measured at the tip, so there is neither weight nor a calibrated bias.
    WristSensor,
    Person,
    /// There is only one arm, so nothing can be swapped.
    OtherArm,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReadyCause {
    /// This device of the roster is not connected, or does not stay connected.
    Missing {
        place: usize,
    },
    /// The test of this device has a finding.
    Found {
        place: usize,
        finding: CheckupFinding,
    },
    /// The deliveries of the devices were not published.
    NoGauges,
    NoTicks,
    Missed {
        /// Fraction of missed periods, 0 to 1.
        fraction: f64,
    },
    /// The loop's clock does not agree with this computer's.
    LoopClock {
        /// Difference between the clocks within the check, s.
        by_s: f64,
    },
    DateBehind,
    /// No gravity calibration exists for this sensor and tool.
    Uncalibrated,
    /// The force at the tip is unknown, for this reason.
    ForceUnknown(ForceSource),
    /// The bias has drifted, or something rests on the tool.
    BiasMoved {
        /// Force that remains at rest, N.
        by_n: f64,
        limit_n: f64,
    },
    BiasUnseen(NotChecked),
    Exchanged(SideSwap),
    ArmStuck {
        by_m: f64,
    },
    /// The tracker does not detect the marker on the instrument, or the marker does not move with the instrument.
    MarkerStuck {
        by_m: f64,
    },
    NoPush {
        max_n: f64,
    },
    /// The push was measured in another direction.
    PushAskew {
        /// Angle of the deviation, degrees; near 180 the sign is wrong.
        by_deg: f64,
    },
    HandlePulls {
        by_m: f64,
    },
    /// A force was commanded to the handle in idle.
    HandleForce {
        force_n: f64,
    },
    HandleStuck {
        by_m: f64,
    },
    /// The handle's reading moved in a different direction than the hand.
    HandleAskew {
        /// Angle of the deviation, degrees.
        by_deg: f64,
    },
    BesideTrocar {
        /// Distance between shaft and trocar, m.
        miss_m: f64,
    },
    TrocarMoved {
        /// Distance across the shaft, m.
        by_m: f64,
    },
    NoRigFile,
    /// The loop has a different limit than the rig file.
    OtherCeiling {
        /// Active limit, N.
        in_force_n: f64,
        /// Limit in the rig file, N.
        in_file_n: f64,
    },
    NoStop,
    HalfStop(Side),
    /// There was a force in a state that permits none.
    Force {
        force_n: f64,
    },
    /// The stop or the fault was not released; the reason of the loop's refusal, if a release was attempted.
    NotReleased(Option<Refusal>),
    NoBite(Watchdog),
    /// The watchdog took too long.
    LateBite {
        /// Time until the fault, s.
        after_s: f64,
    },
    OtherFault(Fault),
    Refused(Refusal),
    Engaged(Side),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReadyState {
    Waiting,
    /// In progress; the required action.
    Asking(PersonRequest),
    Passed(ReadyFigure),
    Failed(ReadyCause),
    LeftOut(Lacks),
}

#[derive(Clone, Debug)]
pub struct ReadyArm {
    pub at_wrist: bool,
    /// Gravity calibration, and the limit of the force that remains at rest, N.
    pub gravity: Option<(GravityModel, f64)>,
    /// A person is at the arm and can follow instructions.
    pub has_person: bool,
}

#[derive(Clone, Debug)]
pub struct CheckSubject {
    /// The rig that the loop is running.
    pub rig: RigConfig,
    pub arms: [Option<ReadyArm>; SIDES],
    /// The parts of the rig, in the order of the roster.
    pub parts: Vec<Option<RigPart>>,
    /// The gates in the current rig file; `None` if it cannot be read.
    pub gates_in_file: Option<ChainSettings>,
    /// An active calibration is dated in the future.
    pub is_date_behind: bool,
}

impl CheckSubject {
    fn sides(&self) -> impl Iterator<Item = Side> + '_ {
        Side::ALL.into_iter().filter(|side| self.arms[side.index()].is_some())
    }

    /// Returns the whole list, without the checks that this rig skips.
    fn list(&self) -> Vec<ReadyEntry> {
        let has_devices = self.rig.devices.is_some();
        let on_devices = if has_devices { ReadyState::Waiting } else { ReadyState::LeftOut(Lacks::Devices) };
        let entry = |check, state| ReadyEntry { check, state };
        let mut list: Vec<ReadyEntry> =
            [ReadyPoint::Devices, ReadyPoint::Rates, ReadyPoint::Clocks].map(|check| entry(check, on_devices)).into();
        for side in self.sides() {
            let Some(arm) = &self.arms[side.index()] else { continue };
            let at_wrist = if arm.at_wrist { ReadyState::Waiting } else { ReadyState::LeftOut(Lacks::WristSensor) };
            let by_person = if arm.has_person { ReadyState::Waiting } else { ReadyState::LeftOut(Lacks::Person) };
            let beside = if self.arms.iter().flatten().count() < SIDES { Some(Lacks::OtherArm) } else { None };
            list.push(entry(
                ReadyPoint::Own(side),
                beside.filter(|_| has_devices).map_or(on_devices, ReadyState::LeftOut),
            ));
            list.push(entry(ReadyPoint::Bias(side), at_wrist));
            list.push(entry(ReadyPoint::Push(side), by_person));
            list.push(entry(ReadyPoint::Handle(side), by_person));
            list.push(entry(ReadyPoint::Trocar(side), on_devices));
        }
        list.extend([ReadyPoint::Ceiling, ReadyPoint::Stop].map(|check| entry(check, ReadyState::Waiting)));
        list.extend(Watchdog::ALL.map(|watchdog| entry(ReadyPoint::Watchdog(watchdog), ReadyState::Waiting)));
        list
    }
}

/// Returns the angle between two directions, degrees; 180 if one of them is zero.
fn angle_deg(one: &Vector3<f64>, other: &Vector3<f64>) -> f64 {
    let lengths = one.norm() * other.norm();
    if lengths > 0.0 { libm::acos((one.dot(other) / lengths).clamp(-1.0, 1.0)).to_degrees() } else { 180.0 }
}
