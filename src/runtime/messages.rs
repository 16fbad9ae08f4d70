//! What crosses between the loop and the screen: commands in, ticks and events out. Nothing else does.

use nalgebra::Vector3;

use crate::{
    device::{DeviceEvent, Loss, Prompt, Side},
    frames::WristSample,
    impedance::Mode,
    safety::{ChainSettings, GateReport, Implausible, Why},
    teleop::{ForceReport, LoopState},
};

/// What a screen (or a script) may ask of the loop. Applied at the start of a tick, in order, at most a few per tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Render with this mode from the next tick on.
    SetMode(Mode),
    /// Feedback gain, 0 to 1; a value above 1 is refused here, see [`Command::SetGainAboveOne`].
    SetGain(f64),
    /// Feedback gain up to 3, given by the operator's second, deliberate action.
    SetGainAboveOne(f64),
    /// One-way delay of the link, seconds, 0 to [`crate::impedance::MAX_DELAY_S`].
    SetDelay(f64),
    /// Speed (m/s) below which nothing is rendered.
    SetDeadBand(f64),
    /// Keep rendering at standstill (true) or fade to zero in the dead band as the paper does (false).
    SetStaticHold(bool),
    /// Ask the person at the arm for something while calibrating; in idle only.
    Prompt(Prompt),
    /// Lead the handle from the screen to this place, m (workspace), at most [`crate::teleop::GUIDE_MAX_M`] from its middle on
    /// each axis; `None` lets it go. A stop and a fault let it go too.
    Guide(Option<Vector3<f64>>),
    /// The tip's way per way of the hand, within [`crate::kinematics::SCALES`].
    SetScale(f64),
    /// Start force feedback and motion of every arm pair that is idle. Refused while the force at the tip is not known.
    Engage,
    /// The same for one arm pair.
    EngageOne(Side),
    /// End force feedback and motion without a latch.
    Rest,
    /// Zero force and a resting follower at once; latched until released.
    Stop,
    /// First of two steps out of a stop or a fault: back to idle. Refused while the cause of a fault lives.
    ReleaseStop,
    /// End the loop; its thread returns its final timing.
    Shutdown,
}

impl Command {
    /// It is for the pair of this side. The screen leads the right hand.
    pub fn concerns(self, side: Side) -> bool {
        match self {
            Self::EngageOne(of) => of == side,
            Self::Guide(_) | Self::Prompt(_) => side == Side::Right,
            _ => true,
        }
    }
}

/// One tick of an arm pair as the screen and the recorder see it. Frame: workspace (z up, tissue at rest near z = 0).
#[derive(Clone, Copy, Debug)]
pub struct Tick {
    /// Counts executed ticks from 0.
    pub index: u64,
    /// Which arm pair.
    pub side: Side,
    /// Time of the tick on the loop's clock, seconds since its start.
    pub t_s: f64,
    /// State of the pair in this tick.
    pub state: LoopState,
    /// Mode that rendered.
    pub mode: Mode,
    /// Delay of the link in force, seconds.
    pub delay_s: f64,
    /// Where the hand leads the tip, m (workspace); while it does not, where the tip is.
    pub leader_m: Vector3<f64>,
    /// Instrument tip (follower), m.
    pub tip_m: Vector3<f64>,
    /// Tip force as measured at the follower now, N (on the instrument).
    pub measured_n: Vector3<f64>,
    /// How the tip force was made.
    pub force: ForceReport,
    /// What the wrist sensor and its neighbours read, where the rig has one.
    pub wrist: Option<WristSample>,
    /// What the person at the arm is asked to do.
    pub prompt: Prompt,
    /// Where the screen leads the handle, m.
    pub guide_m: Option<Vector3<f64>>,
    /// The same force as the link delivers it now: delayed DFR, N.
    pub delayed_n: Vector3<f64>,
    /// What each mode asks for at this tick before the gates, N, indexed by [`Mode::index`].
    pub asked_n: [Vector3<f64>; 4],
    /// Force commanded to the hand after all gates, N.
    pub rendered_n: Vector3<f64>,
    /// What the gates did in this tick.
    pub gates: GateReport,
    /// Limits and knobs of the gates in force (the gain the operator chose; the ramp is in `gates`).
    pub gate_settings: ChainSettings,
    /// What identification says in this tick.
    pub identification: crate::impedance::Report,
    /// How late this tick woke after its deadline, s (0 on the virtual clock).
    pub wake_s: f64,
    /// How long the tick before this one worked, s.
    pub work_s: f64,
    /// From the arrival of the oldest measurement of the tick before this one to when its force was given to the device, s;
    /// `None`: it had no measurement, or the clock is virtual.
    pub sample_to_force_s: Option<f64>,
    /// Periods missed so far.
    pub missed: u64,
    /// Ticks that did not reach the screen because its queue was full, so far.
    pub dropped: u64,
}

/// A fault: zero force, shown with its cause and its cure; the first one is kept until released.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The rig gave no finite sample for longer than the age limit.
    SourceSilent,
    /// The loop was held up: it missed too many periods in a row, or the supervisor found it silent.
    LoopStalled {
        /// Periods missed at once.
        periods: u64,
    },
    /// Engaged, and the force at the tip is not known: a calibration or what it needs is missing.
    ForceUnknown,
    /// A device of the force path was lost.
    DeviceLost {
        /// Its place in the rig's roster.
        device: u8,
        /// Why.
        loss: Loss,
    },
    /// Engaged, and the arm does not follow or the handle's motors are off.
    DrivesOff,
    /// The other arm pair has a fault.
    OtherArm,
    /// The rig gave samples, and too many of them were missing or not finite.
    SamplesLost,
    /// Engaged, and nothing has come over the link for too long.
    LinkSilent,
    /// Time did not go on by whole periods.
    ClockJumped,
    /// Numbers came in time, are finite, and cannot be true.
    Implausible {
        /// Which, and how.
        what: Implausible,
    },
}

impl Fault {
    /// What happened, in one plain sentence.
    pub const fn cause(self) -> &'static str {
        match self {
            Self::SourceSilent => "The rig sent no valid sample for 20 ms",
            Self::LoopStalled { .. } => "The control loop was held up: drives and force were switched off",
            Self::ForceUnknown => "The force at the tip is not known: the wrist sensor is not calibrated for this tool",
            Self::DeviceLost { loss, .. } => match loss {
                Loss::Disconnected => "A device was lost: the connection is gone",
                Loss::Silent => "A device was lost: it sends nothing",
                Loss::Corrupt => "A device was lost: what it sends is damaged",
                Loss::Implausible => "A device was lost: it sends impossible numbers",
                Loss::Device { .. } => "A device was lost: it reports a fault of its own",
            },
            Self::DrivesOff => "The arm stopped obeying, or the handle switched its motors off",
            Self::OtherArm => "The other arm has a fault",
            Self::SamplesLost => "Too many samples of the rig are lost or damaged",
            Self::LinkSilent => "Nothing came over the link for 0.1 s",
            Self::ClockJumped => "The loop's clock jumped or stood still",
            Self::Implausible { what } => what.words(),
        }
    }

    /// What the operator can do.
    pub const fn cure(self) -> &'static str {
        match self {
            Self::SourceSilent => "Check the sensor and the leader device, then release the stop and engage again",
            Self::LoopStalled { .. } => {
                "Close other programs or grant real-time priority, then release the stop and engage again"
            }
            Self::ForceUnknown => "Calibrate gravity (Calibrate, Gravity), then release the stop and engage again",
            Self::DeviceLost { .. } => {
                "See the devices: it is opened again by itself; then release the stop and engage again"
            }
            Self::DrivesOff => {
                "Look at the arm's and the handle's own lamps and buttons, then release the stop and engage again"
            }
            Self::OtherArm => "Mend the other arm's fault, then release the stop and engage again",
            Self::SamplesLost => {
                "See the devices' counts of lost samples, check their cables; then release the stop and engage again"
            }
            Self::LinkSilent => "Check the link to the follower, then release the stop and engage again",
            Self::ClockJumped => "See what sets or stops this computer's clock, then release the stop and engage again",
            Self::Implausible { what } => what.cure(),
        }
    }
}

/// Something that happened once, told when it happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The loop went from one state to another at this time (s).
    StateChanged {
        /// Time on the loop's clock, s.
        t_s: f64,
        /// Which arm pair.
        side: Side,
        /// State before.
        from: LoopState,
        /// State now.
        to: LoopState,
        /// Why.
        why: Why,
    },
    /// A fault was raised at this time (s).
    FaultRaised {
        /// Time on the loop's clock, s.
        t_s: f64,
        /// Which arm pair.
        side: Side,
        /// Which.
        fault: Fault,
    },
    /// A command could not be carried out in the present state or range.
    CommandRefused {
        /// Time on the loop's clock, s.
        t_s: f64,
        /// The command as it came.
        command: Command,
    },
    /// A device of the rig came or went.
    Device(DeviceEvent),
    /// What the operating system granted the real-time thread.
    Scheduling(super::Scheduling),
}
