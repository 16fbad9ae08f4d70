//! What crosses between the loop and the screen: commands in, ticks and events out. Nothing else does.

mod force;
mod refusal;
mod scheduling;

use nalgebra::Vector3;
use nima_core::{
    frames::WristSample,
    impedance::{MODES, Mode},
    safety::{ChainSettings, GateReport, Implausible, State, Why},
};
use nima_devices::Loss;

pub use force::{ForceReport, ForceSource};
pub use refusal::Refusal;
pub use scheduling::Scheduling;

use crate::rig::{DeviceEvent, Prompt, Side};

/// State of an arm pair.
pub type LoopState = State<Fault>;

/// What a screen (or a script) may ask of the loop. Applied at the start of a tick, in order, at most a few per tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Render with this mode from the next tick on.
    SetMode(Mode),
    /// Feedback gain, 0 to 1; a value above 1 is refused here, see [`Command::SetGainAboveOne`].
    SetGain(f64),
    /// Feedback gain up to 3, given by the operator's second, deliberate action.
    SetGainAboveOne(f64),
    /// One-way delay of the link, seconds, 0 to [`nima_core::impedance::MAX_DELAY_S`].
    SetDelay(f64),
    /// Speed (m/s) below which nothing is rendered.
    SetDeadBand(f64),
    /// Keep rendering at standstill (true) or fade to zero in the dead band as the paper does (false).
    SetStaticHold(bool),
    /// Ask the person at the arm of this side for something while calibrating; in idle only.
    Prompt(Side, Prompt),
    /// Lead the handle from the screen to this place, m (workspace), at most [`crate::teleop::GUIDE_MAX_M`] from its middle on
    /// each axis; `None` lets it go. A stop and a fault let it go too.
    Guide(Option<Vector3<f64>>),
    /// The tip's way per way of the hand, within [`nima_core::kinematics::SCALES`].
    SetScale(f64),
    /// Start force feedback and motion of every arm pair that is idle. Refused while the force at the tip is not known.
    Engage,
    /// The same for one arm pair.
    EngageOne(Side),
    /// End force feedback and motion without a latch.
    Rest,
    /// Zero force and a resting follower at once; latched until released.
    Stop,
    /// First of two steps out of a stop or a fault: back to idle. Refused while the cause of a fault is still present.
    ReleaseStop,
    /// End the loop; its thread returns its final timing.
    Shutdown,
}

impl Command {
    /// It is for the pair of this side. The screen leads the right hand.
    pub fn concerns(self, side: Side) -> bool {
        match self {
            Self::EngageOne(of) | Self::Prompt(of, _) => of == side,
            Self::Guide(_) => side == Side::Right,
            _ => true,
        }
    }
}

/// One tick of an arm pair as the screen and the recorder see it. Frame: workspace (z up, tissue at rest near z = 0).
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Tick {
    /// Counts executed ticks from 0.
    pub index: u64,
    pub side: Side,
    /// Time of the tick on the loop's clock, seconds since its start.
    pub t_s: f64,
    /// State of the pair in this tick.
    pub state: LoopState,
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
    pub asked_n: [Vector3<f64>; MODES],
    /// Force commanded to the hand after all gates, N.
    pub rendered_n: Vector3<f64>,
    /// What the gates did in this tick.
    pub gates: GateReport,
    /// Limits and knobs of the gates in force (the gain the operator chose; the ramp is in `gates`).
    pub gate_settings: ChainSettings,
    /// What identification says in this tick.
    pub identification: nima_core::impedance::Report,
    /// How late this tick woke after its deadline, s (0 on the virtual clock).
    pub wake_s: f64,
    /// How long the tick before this one worked, s.
    pub work_s: f64,
    /// From the arrival of the oldest measurement of the tick before this one to when its force was given to the device, s;
    /// `None`: it had no measurement, or the clock is virtual.
    pub sample_to_force_s: Option<f64>,
    pub missed: u64,
    /// Ticks that did not reach the screen because its queue was full, so far.
    pub dropped: u64,
}

/// A fault: zero force, shown with its cause and its cure; the first one is kept until released.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
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
    Implausible { what: Implausible },
}

/// How much attention a state needs: of two arm pairs the one with the larger number is shown first.
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

/// Something that happened once, told when it happens.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Event {
    /// The loop went from one state to another at this time (s).
    StateChanged {
        /// Time on the loop's clock, s.
        t_s: f64,
        side: Side,
        from: LoopState,
        to: LoopState,
        why: Why,
    },
    /// A fault was raised at this time (s).
    FaultRaised {
        /// Time on the loop's clock, s.
        t_s: f64,
        side: Side,
        fault: Fault,
    },
    /// A command was not carried out, or an engagement that had begun was given up.
    CommandRefused {
        /// Time on the loop's clock, s.
        t_s: f64,
        side: Side,
        /// The command as it came.
        command: Command,
        why: Refusal,
    },
    /// A device of the rig came or went.
    Device(DeviceEvent),
    /// What the operating system granted the real-time thread.
    Scheduling(Scheduling),
}
