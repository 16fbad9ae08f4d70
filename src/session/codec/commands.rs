//! Operations on the loop between two ticks.

use nalgebra::{UnitQuaternion, UnitVector3, Vector3};
use nima_core::{
    calibration::frames::ViewMove,
    impedance::{Baseline, MODES, Mode},
};
use nima_devices::{ConnectionState, Loss};
use nima_machine::{
    messages::{Command, Watchdog},
    rig::{DeviceEvent, Prompt, Side, TaskAction},
    runtime::Operation,
};

use super::{CodecError, FromWords, ToWords, WordSink, WordSource, choice, record};

choice!(Operation {
    0 => Command { command: command: Command, t_s: t_s: f64 },
    1 => Device { 0: event: DeviceEvent },
    2 => Suspend { 0: side: Side },
    3 => Calibrations { side: side: Side, number: number: u64 },
    4 => Stall { silent_s: silent_s: f64, t_s: t_s: f64 },
});

choice!(Command {
    0 => SetMode { 0: mode: Mode },
    1 => Compare { 0: compares: bool },
    2 => SetGain { 0: gain: f64 },
    3 => SetGainAboveOne { 0: gain: f64 },
    4 => SetDelay { 0: delay_s: f64 },
    5 => SetDeadBand { 0: speed_m_s: f64 },
    6 => SetStaticHold { 0: holds: bool },
    7 => Prompt { 0: side: Side, 1: prompt: Prompt },
    8 => Guide { 0: side: Side, 1: guide_m: Option<Vector3<f64>> },
    9 => LetGo { 0: lets_go: bool },
    10 => SetGovernor { 0: on: bool },
    11 => SetScale { 0: scale: f64 },
    12 => Engage {},
    13 => EngageOne { 0: side: Side },
    14 => Rest {},
    15 => Stop {},
    16 => ReleaseStop {},
    17 => TestWatchdog { 0: watchdog: Watchdog },
    18 => Checked { 0: passed: bool },
    19 => Shutdown {},
    20 => Grip { 0: side: Side, 1: grip_rad: Option<f64> },
    21 => Task { 0: side: Side, 1: act: TaskAction },
});

choice!(nima_core::task::TaskEvent {
    0 => Begun {},
    1 => Ended {},
    2 => Aborted {},
    3 => RingGrasped { ring: ring: usize, side: side: Side },
    4 => RingLifted { ring: ring: usize, side: side: Side },
    5 => RingTransferred { ring: ring: usize, to: taker: Side },
    6 => RingPlaced { ring: ring: usize, side: side: Side, peg: peg: usize },
    7 => RingDropped { ring: ring: usize, side: side: Side, in_view: in_view: bool },
    8 => RingKnockedOff { ring: ring: usize, side: side: Option<Side> },
    9 => LumpMarked { side: side: Side, lump: lump: Option<usize> },
    10 => WireTouched { side: side: Side },
    11 => WireLeft { side: side: Side },
});

choice!(TaskAction { 0 => Begin {}, 1 => Mark {}, 2 => End {} });
choice!(Side { 0 => Right {}, 1 => Left {} });
choice!(Watchdog { 0 => Loop {}, 1 => Source {}, 2 => Link {} });

/// Encoded by its position in the list, so that another list is another version of the journal.
impl ToWords for Mode {
    const COLUMNS: usize = 1 + <Baseline as ToWords>::COLUMNS;

    fn put(&self, to: &mut impl WordSink) {
        self.index().put(to);
        match self {
            Self::Baseline(baseline) => baseline.put(to),
            _ => to.skip(<Baseline as ToWords>::COLUMNS),
        }
    }
}

impl FromWords for Mode {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        let place = usize::take(from)?;
        if place == MODES {
            return Baseline::take(from).map(Self::Baseline);
        }
        from.skip(<Baseline as ToWords>::COLUMNS);
        Self::ALL.get(place).copied().ok_or(CodecError::NoSuchValue)
    }
}

choice!(Baseline {
    0 => ModelMediated {},
    1 => Waves {},
    2 => Passivity {},
    3 => Kalman {},
    4 => Autoregressive {},
    5 => Increments {},
});

choice!(Prompt {
    0 => Rest {},
    1 => Hold { world_from_s1: world_from_s1: UnitQuaternion<f64> },
    2 => Wave {},
    3 => Push { direction: direction: UnitVector3<f64> },
    4 => Work {},
    5 => WorkFree {},
    6 => PivotInDimple {},
    7 => Turn {},
    8 => PivotInTrocar {},
    9 => Touch { point: point: u8 },
    10 => MoveTip { 0: to: ViewMove },
    11 => MoveHandle { 0: to: ViewMove },
});

choice!(ViewMove { 0 => Right {}, 1 => Up {}, 2 => Deeper {}, 3 => Left {}, 4 => Down {}, 5 => Back {} });

record!(DeviceEvent { t_s: f64, device: u8, standing: ConnectionState, of_side: [bool; 2] });

choice!(ConnectionState {
    0 => Closed {},
    1 => Opening {},
    2 => Connected {},
    3 => Lost { 0: loss: Loss },
});

choice!(Loss {
    0 => Disconnected {},
    1 => Silent {},
    2 => Corrupt {},
    3 => Implausible {},
    4 => Device { code: code: u32 },
});
