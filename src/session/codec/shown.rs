//! Outputs of the loop: compared by a replay, and shown by remote screens.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{
    calibration::frames::FrameSample,
    frames::{Wrench, WristSample},
    impedance::{
        IdentificationFailures, IdentificationReport, IdentifiedDegrees, ImpedanceExcitation, MAX_DEGREE, Mode,
        ModeSet, SLOTS,
    },
    safety::{
        ChainSettings, EnergyMode, GATES, GateCounts, GateReport, Implausible, InterlockState, Reason, TransitionCause,
    },
    tip_force::{Fallback, TipForceReport, Unsure},
};
use nima_devices::Loss;
use nima_machine::{
    messages::{
        CalibrationReadings, Command, Event, FarStop, Fault, ForceReport, ForceSource, Guidance, Refusal, Scheduling,
        Tick, TickForces, TickPositions, TickTiming,
    },
    rig::{Acts, DeviceEvent, EngageBlocker, Outputs, Prompt, Side, ViewOrientation},
};

use super::{CodecError, FromWords, ToWords, WordSink, WordSource, choice, record};

record!(put Outputs {
    drives: bool,
    tip_command_m: Option<Vector3<f64>>,
    world_from_jaws: Option<UnitQuaternion<f64>>,
    hand_force_n: Vector3<f64>,
    gripper_n: f64,
    prompt: Prompt,
    guide_m: Option<Vector3<f64>>,
    grip_rad: Option<f64>,
    acts: Acts,
    lets_go: bool,
});

record!(put Acts { begins: u8, marks: u8, ends: u8 });

record!(Tick {
    index: u64,
    side: Side,
    t_s: f64,
    state: InterlockState<Fault>,
    mode: Mode,
    delay_s: f64,
    positions: TickPositions,
    measured_n: Vector3<f64>,
    force: ForceReport,
    calibration: CalibrationReadings,
    guidance: Guidance,
    rendering: TickForces,
    gates: GateReport,
    identification: IdentificationReport,
    timing: TickTiming,
});

record!(TickPositions { leader_m: Vector3<f64>, tip_m: Vector3<f64> });

record!(CalibrationReadings { wrist: Option<WristSample>, frames: FrameSample, view: ViewOrientation });

record!(Guidance { prompt: Prompt, guide_m: Option<Vector3<f64>> });

record!(TickForces { delayed_n: Vector3<f64>, asked_n: [Vector3<f64>; SLOTS], rendered_n: Vector3<f64> });

record!(TickTiming { wake_s: f64, work_s: f64, sample_to_force_s: Option<f64>, missed: u64, dropped: u64 });

record!(ForceReport {
    source: ForceSource,
    tip_n: Vector3<f64>,
    gravity_free: Option<Wrench>,
    tip_force: Option<TipForceReport>,
});

choice!(ForceSource {
    0 => AtTip {},
    1 => Wrist {},
    2 => Network {},
    3 => Extrapolated {},
    4 => InDoubt { unsure: unsure: Unsure, fallback: fallback: Fallback },
    5 => Uncalibrated {},
    6 => NoOrientation {},
    7 => Poisoned {},
    8 => NoSample {},
    9 => Unidentified {},
});

choice!(Unsure { 0 => OutsideTraining {}, 1 => NotMoved {}, 2 => Missing {} });
choice!(Fallback { 0 => WristForce {}, 1 => HoldAndFade {} });

record!(TipForceReport {
    force_s1_n: Vector3<f64>,
    network_fraction: f64,
    unsure: Option<Unsure>,
    extrapolates: bool,
    doubt: f32,
});

record!(IdentificationReport {
    t_s: f64,
    modes: ModeSet,
    resting: bool,
    learnt: u64,
    prediction_n: [Vector3<f64>; SLOTS],
    prediction_valid: [bool; SLOTS],
    reconstruction_n: [Vector3<f64>; MAX_DEGREE],
    degrees: IdentifiedDegrees,
    columns: u8,
    gain: f64,
    condition: f64,
    rank: u8,
    excitation: ImpedanceExcitation,
    failures: IdentificationFailures,
    horizon_error_n: [f64; SLOTS],
});

record!(IdentifiedDegrees { paper: u8, anchored: u8, matched: u8, nima: u8 });

record!(IdentificationFailures { samples: u64, restarts: u64, literal_solves: u64 });

record!(ImpedanceExcitation { position_m: Vector3<f64>, velocity_m_s: Vector3<f64>, acceleration_m_s2: Vector3<f64> });

impl ToWords for ModeSet {
    const COLUMNS: usize = 1;

    fn put(&self, to: &mut impl WordSink) {
        let bits = Mode::ALL.into_iter().chain(Mode::BASELINES).map(|mode| u64::from(self.contains(mode)));
        to.word(bits.fold(0, |word, bit| word << 1 | bit));
    }
}

impl FromWords for ModeSet {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        let word = from.word()?;
        let modes = || Mode::ALL.into_iter().chain(Mode::BASELINES);
        let last = modes().count() - 1;
        let asked = modes().enumerate().filter(|(place, _)| word >> (last - place) & 1 == 1);
        let set = asked.fold(Self::only(Mode::Dfr), |set, (_, mode)| set.with(mode));
        let mut again = Vec::new();
        set.put(&mut again);
        if again == [word] { Ok(set) } else { Err(CodecError::NoSuchValue) }
    }
}

record!(GateReport {
    reasons: [Reason; GATES],
    withheld_n: f64,
    governed: f64,
    gain: f64,
    stored_j: f64,
    counts: GateCounts,
    settings: ChainSettings,
});

record!(GateCounts { ticks: u64, acted: [u64; GATES], last: [Reason; GATES] });

/// By its place in the list, so that another list is another version of the journal.
impl ToWords for Reason {
    const COLUMNS: usize = 1;

    fn put(&self, to: &mut impl WordSink) {
        to.word(*self as u64);
    }
}

impl FromWords for Reason {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        Self::ALL.get(usize::take(from)?).copied().ok_or(CodecError::NoSuchValue)
    }
}

record!(ChainSettings {
    gain: f64,
    gain_rate_per_s: f64,
    ceiling_n: f64,
    device_limit_n: f64,
    slew_n_per_s: f64,
    fade_after_s: f64,
    zero_after_s: f64,
    dead_band_m_s: f64,
    static_hold: bool,
    energy: EnergyMode,
    handle_kg: f64,
    handle_n_s_m: f64,
    handle_step_m: f64,
    brake_n_s_m: f64,
});

choice!(EnergyMode { 0 => Off {}, 1 => Observe {}, 2 => Control {} });

choice!(InterlockState<Fault> {
    0 => Disconnected {},
    1 => Idle {},
    2 => Ready {},
    3 => Engaged {},
    4 => Clutched {},
    5 => Stopped {},
    6 => Faulted { 0: fault: Fault },
});

choice!(Fault {
    0 => SourceSilent {},
    1 => LoopStalled { periods: periods: u64 },
    2 => ForceUnknown { source: source: ForceSource },
    3 => DeviceLost { device: device: u8, loss: loss: Loss },
    4 => DrivesOff {},
    5 => OtherArm {},
    6 => SamplesLost {},
    7 => LinkSilent {},
    8 => ClockJumped {},
    9 => Implausible { what: what: Implausible },
    10 => FarEnd { stop: stop: FarStop },
});

choice!(Implausible {
    0 => ForceFrozen {},
    1 => ForceJumped {},
    2 => ForceAlong {},
    3 => LinkFrozen {},
    4 => HandleJumped {},
    5 => HandleFrozen {},
    6 => TipJumped {},
    7 => ArmAstray {},
    8 => ForceSaturated {},
    9 => ForceRepeats {},
    10 => HandleRepeats {},
    11 => ArmRepeats {},
});

choice!(Event {
    0 => StateChanged { t_s: t_s: f64, side: side: Side, from: from: InterlockState<Fault>, to: into: InterlockState<Fault>, why: why: TransitionCause },
    1 => FaultRaised { t_s: t_s: f64, side: side: Side, fault: fault: Fault },
    2 => CommandRefused { t_s: t_s: f64, side: side: Side, command: command: Command, why: why: Refusal },
    3 => Device { 0: event: DeviceEvent },
    4 => Scheduling { 0: granted: Scheduling },
});

choice!(TransitionCause {
    0 => Asked {},
    1 => Connected {},
    2 => Disconnected {},
    3 => Agreed {},
    4 => Clutch {},
    5 => Late {},
    6 => Absent {},
    7 => Fault {},
});

record!(Scheduling { fifo: bool, deadline: bool, memory_locked: bool });

choice!(Refusal {
    0 => State { 0: state: InterlockState<Fault> },
    1 => StillPresent { 0: fault: Fault },
    2 => ForceUnknown { 0: source: ForceSource },
    3 => Implausible { 0: what: Implausible },
    4 => Obstacle { 0: obstacle: EngageBlocker },
    5 => EndoscopeUnseen {},
    6 => DrivesOff {},
    7 => Moving {},
    8 => HandAbsent {},
    9 => ClutchPressed {},
    10 => NotChecked {},
    11 => OutOfRange {},
    12 => SimulatedOnly {},
    13 => NoSuchArm {},
    14 => DelayIsMeasured {},
});
