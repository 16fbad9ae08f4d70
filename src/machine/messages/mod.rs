//! All communication between the loop and the screen: commands in, ticks and events out.

mod force;
mod peer_status;
mod refusal;
mod scheduling;
mod watchdog;

use nalgebra::Vector3;
use nima_core::{
    calibration::frames::FrameSample,
    frames::WristSample,
    impedance::{Mode, SLOTS},
    safety::{GateReport, Implausible, InterlockState, TransitionCause},
};
use nima_devices::Loss;

pub use force::{ForceReport, ForceSource, UNKNOWN_N};
pub use peer_status::{FarStop, PeerStatus};
pub use refusal::Refusal;
pub use scheduling::{Scheduling, SchedulingLack};
pub use watchdog::Watchdog;

use crate::rig::{DeviceEvent, Prompt, Side, TaskAction, ViewOrientation};

pub type LoopState = InterlockState<Fault>;

/// Commands from a screen or a script to the loop. They are applied in order at the start of a tick, at most a few per
/// tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Render with this mode from the next tick on.
    SetMode(Mode),
    /// Compute every mode in addition to the rendered one, for comparison (true), or only the rendered one (false).
    Compare(bool),
    /// Feedback gain, within [`nima_core::limits::GAIN`]; a larger value is refused here, see
    /// [`Command::SetGainAboveOne`].
    SetGain(f64),
    /// Feedback gain, within [`nima_core::limits::GAIN_ABOVE_ONE`], which the operator must confirm separately.
    SetGainAboveOne(f64),
    /// One-way delay of the link, s, within [`nima_core::limits::DELAY_S`].
    SetDelay(f64),
    /// Speed below which no force is rendered, m/s, within [`nima_core::limits::DEAD_BAND_M_S`].
    SetDeadBand(f64),
    /// Keep rendering at standstill (true) or fade to zero in the dead band as the paper does (false).
    SetStaticHold(bool),
    /// Give the person at the arm of this side an instruction for the calibration; in idle only.
    Prompt(Side, Prompt),
    /// Guide the handle of this side from the screen to this position, m (workspace), at most
    /// [`crate::rig::GUIDE_MAX_M`] from the centre on each axis; `None`, a stop or a fault ends it.
    Guide(Side, Option<Vector3<f64>>),
    /// Hold the gripper of this side's handle open from the screen by this angle, rad, at most
    /// [`crate::rig::GRIP_MAX_RAD`]; `None`, a stop or a fault ends it. On a simulated rig only.
    Grip(Side, Option<f64>),
    /// Perform this act in the training task, with the tip of this side's instrument. On a simulated rig only.
    Task(Side, TaskAction),
    /// The simulated hand releases its handle (true) or grips it again (false). On a simulated rig only.
    LetGo(bool),
    /// Switch the governor off (false) or on (true). On a simulated rig only, where no person holds the handle.
    SetGovernor(bool),
    /// Travel of the tip per travel of the hand, within [`nima_core::limits::SCALE`].
    SetScale(f64),
    /// Start force feedback and motion of every arm pair that is idle. Refused while the force at the tip is not known.
    Engage,
    /// Like [`Command::Engage`], for one arm pair.
    EngageOne(Side),
    /// End force feedback and motion without latching a stop.
    Rest,
    /// Zero force and follower at rest at once; latched until released.
    Stop,
    /// First of two steps to leave a stop or a fault: back to idle. Refused while the cause of a fault is still
    /// present.
    ReleaseStop,
    /// Test this watchdog: its input is suppressed until it raises its fault. Only while every arm pair is idle, so
    /// that there is neither force nor motion; the fault is latched like any other fault.
    TestWatchdog(Watchdog),
    /// A ready check passed today with the devices of the rig (true), or none has (false). Relevant if the rig file
    /// requires one.
    Checked(bool),
    /// End the loop; its thread returns its final timing.
    Shutdown,
}

impl Command {
    /// Returns whether the pair of this side carries out the command. Releasing the handle concerns the right hand.
    pub fn concerns(self, side: Side) -> bool {
        match self {
            Self::EngageOne(of) | Self::Prompt(of, _) | Self::Guide(of, _) | Self::Grip(of, _) | Self::Task(of, _) => {
                of == side
            }
            Self::LetGo(_) | Self::SetGovernor(_) => side == Side::Right,
            Self::SetMode(_)
            | Self::Compare(_)
            | Self::SetGain(_)
            | Self::SetGainAboveOne(_)
            | Self::SetDelay(_)
            | Self::SetDeadBand(_)
            | Self::SetStaticHold(_)
            | Self::SetScale(_)
            | Self::Engage
            | Self::Rest
            | Self::Stop
            | Self::ReleaseStop
            | Self::TestWatchdog(_)
            | Self::Checked(_)
            | Self::Shutdown => true,
        }
    }
}

/// One tick of an arm pair, for the screen and the recorder. Frame: workspace (z up, tissue at rest near z = 0).
#[derive(Clone, Copy, Debug)]
pub struct Tick {
    pub index: u64,
    pub side: Side,
    /// Time of the tick on the loop's clock, seconds since its start.
    pub t_s: f64,
    pub state: LoopState,
    pub mode: Mode,
    /// Active delay of the link, seconds.
    pub delay_s: f64,
    pub positions: TickPositions,
    /// Current tip force measured at the follower, N (on the instrument); [`UNKNOWN_N`] while it is unknown.
    pub measured_n: Vector3<f64>,
    /// Source and processing of the tip force.
    pub force: ForceReport,
    pub calibration: CalibrationReadings,
    pub guidance: Guidance,
    pub rendering: TickForces,
    pub gates: GateReport,
    /// Result of the identification in this tick.
    pub identification: nima_core::impedance::IdentificationReport,
    pub timing: TickTiming,
}

impl Tick {
    /// Returns the tip force measured at the follower, N; `None` while it is unknown.
    pub fn known_n(&self) -> Option<Vector3<f64>> {
        Some(self.measured_n).filter(|force_n| force_n.iter().all(|x| x.is_finite()))
    }
}

/// Positions of both ends of a pair, m (workspace).
#[derive(Clone, Copy, Debug)]
pub struct TickPositions {
    /// Commanded tip position of the hand; while not engaged, the position of the tip.
    pub leader_m: Vector3<f64>,
    pub tip_m: Vector3<f64>,
}

/// Readings of the wrist sensor and of the sensors used for calibration, if the rig has them and they are not too old.
#[derive(Clone, Copy, Debug)]
pub struct CalibrationReadings {
    pub wrist: Option<WristSample>,
    /// Input of the frame calibrations; empty without a new measurement.
    pub frames: FrameSample,
    /// Orientation of the endoscope, from the tracker's measurement of its marker.
    pub view: ViewOrientation,
}

/// Instruction of the screen to the person at the arm.
#[derive(Clone, Copy, Debug)]
pub struct Guidance {
    pub prompt: Prompt,
    /// Position to which the screen guides the handle, m.
    pub guide_m: Option<Vector3<f64>>,
}

/// The forces from the link to the hand.
#[derive(Clone, Copy, Debug)]
pub struct TickForces {
    /// Tip force that the link delivers now: delayed DFR, N; [`UNKNOWN_N`] before the first delivery, and when the
    /// force is too old.
    pub delayed_n: Vector3<f64>,
    /// Force of each mode in this tick before the gates, N, indexed by [`Mode::index`].
    pub asked_n: [Vector3<f64>; SLOTS],
    /// Force commanded to the hand after all gates, N.
    pub rendered_n: Vector3<f64>,
}

/// Whether the loop keeps its time.
#[derive(Clone, Copy, Debug)]
pub struct TickTiming {
    /// Delay of the wake-up of this tick after its deadline, s (0 on the virtual clock).
    pub wake_s: f64,
    /// Duration of the work of the previous tick, s.
    pub work_s: f64,
    /// Time from the arrival of the oldest measurement of the previous tick until its force was sent to the device, s;
    /// `None` without a measurement or on a virtual clock.
    pub sample_to_force_s: Option<f64>,
    pub missed: u64,
    /// Ticks dropped so far because the queue to the screen was full.
    pub dropped: u64,
}

/// A fault: the force is zero, and the screen shows cause and remedy. The first fault is kept until it is released.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The rig delivered no finite sample for longer than the age limit.
    SourceSilent,
    /// The loop stalled: it missed too many periods in a row, or the supervisor found it silent.
    LoopStalled {
        /// Number of consecutive missed periods.
        periods: u64,
    },
    /// The force at the tip is unknown while engaged.
    ForceUnknown { source: ForceSource },
    /// A device of the force path was lost.
    DeviceLost {
        /// Index into the rig's roster.
        device: u8,
        loss: Loss,
    },
    /// The arm does not follow, or the handle's motors are off, while engaged.
    DrivesOff,
    /// The other arm pair has a fault.
    OtherArm,
    /// The rig delivered samples, but too many were missing or not finite.
    SamplesLost,
    /// No packet has arrived over the link for too long while engaged.
    LinkSilent,
    /// The time did not advance by whole periods.
    ClockJumped,
    /// Measurements are in time and finite, but not plausible.
    Implausible { what: Implausible },
    /// The machine at the other end of the network is stopped.
    FarEnd { stop: FarStop },
}

/// Longest stall of the loop that is left by one step, s: a computer that sleeps this long, for example a virtual machine,
/// is not a fault of the rig. Longer ones need both steps, because a person may have touched the rig in the meantime.
pub const SHORT_STALL_MAX_S: f64 = 1.0;

impl Fault {
    /// Returns whether this is a stall of a loop with this rate after which a person may engage directly.
    pub fn is_short_stall(self, rate_hz: f64) -> bool {
        matches!(self, Self::LoopStalled { periods } if periods as f64 <= SHORT_STALL_MAX_S * rate_hz)
    }
}

/// Returns the priority of a state for display: of two arm pairs the one with the larger number is shown first.
pub const fn attention(state: LoopState) -> u8 {
    match state {
        LoopState::Engaged => 0,
        LoopState::Clutched => 1,
        LoopState::Ready => 2,
        LoopState::Idle => 3,
        LoopState::Disconnected => 4,
        LoopState::Stopped => 5,
        LoopState::Faulted(Fault::OtherArm) => 6,
        LoopState::Faulted(_) => 7,
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    StateChanged {
        /// Time on the loop's clock, s.
        t_s: f64,
        side: Side,
        from: LoopState,
        to: LoopState,
        why: TransitionCause,
    },
    FaultRaised {
        /// Time on the loop's clock, s.
        t_s: f64,
        side: Side,
        fault: Fault,
    },
    /// A command was refused, or an engagement in progress was abandoned.
    CommandRefused {
        /// Time on the loop's clock, s.
        t_s: f64,
        side: Side,
        command: Command,
        why: Refusal,
    },
    /// A device of the rig connected or was lost.
    Device(DeviceEvent),
    /// Privileges that the operating system granted to the real-time thread.
    Scheduling(Scheduling),
}
