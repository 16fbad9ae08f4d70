//! Inputs of the loop in each tick.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_core::{
    calibration::frames::FrameSample,
    frames::{Wrench, WristSample},
    impedance::{ModeSet, PACKED_MAX, ParameterPack, SLOTS},
    kinematics::{ArmStartError, HandPose},
    safety::{ARM_CHANNELS, CHANNELS, HANDLE_CHANNELS, RawReading, RawReadings},
};
use nima_machine::{
    messages::{FarStop, ForceSource},
    rig::{
        AwaitedDevice, EngageBlocker, Inputs, PlannedTip, RemoteIdentification, SensedForce, SideSwap, Switches,
        ViewOrientation,
    },
    teleop::Timing,
};

use super::{CodecError, FromWords, ToWords, WordSink, WordSource, choice, record};

record!(Timing { now_s: f64, wake_s: f64, work_s: f64, sample_to_force_s: Option<f64>, missed_now: u64 });

record!(Inputs {
    hand: HandPose,
    gripper_rad: Option<f64>,
    grip_n: Option<f64>,
    tip_m: Vector3<f64>,
    planned: PlannedTip,
    world_from_jaws: Option<UnitQuaternion<f64>>,
    sensed: SensedForce,
    view: ViewOrientation,
    frames: FrameSample,
    switches: Switches,
    powered: bool,
    obstacle: Option<EngageBlocker>,
    age_s: f64,
    silent_s: f64,
    raw: RawReadings,
});

/// Without columns here: those of both sides are the last ones of a row, which older journals lack.
impl ToWords for PlannedTip {
    const COLUMNS: usize = 0;

    fn put(&self, _: &mut impl WordSink) {}
}

impl FromWords for PlannedTip {
    fn take(_: &mut impl WordSource) -> Result<Self, CodecError> {
        Ok(Self::default())
    }
}

record!(RawReadings {
    handle: Option<RawReading<HANDLE_CHANNELS>>,
    arm: Option<RawReading<ARM_CHANNELS>>,
    sensor: Option<RawReading<CHANNELS>>,
});
record!(RawReading<HANDLE_CHANNELS> { channels: [f64; HANDLE_CHANNELS], device_s: Option<f64>, arrival_s: f64 });
record!(RawReading<ARM_CHANNELS> { channels: [f64; ARM_CHANNELS], device_s: Option<f64>, arrival_s: f64 });
record!(RawReading<CHANNELS> { channels: [f64; CHANNELS], device_s: Option<f64>, arrival_s: f64 });

record!(HandPose { position_m: Vector3<f64>, orientation: Option<UnitQuaternion<f64>> });
record!(Switches { clutch: bool, presence: Option<bool> });
record!(Wrench { force_n: Vector3<f64>, torque_nm: Vector3<f64> });

choice!(SensedForce {
    0 => AtTip { 0: force_n: Vector3<f64> },
    1 => AtWrist { 0: sample: WristSample },
    2 => FarEnd { 0: identified: RemoteIdentification },
});

record!(RemoteIdentification {
    t_s: f64,
    delay_s: f64,
    force_n: Vector3<f64>,
    source: ForceSource,
    fresh: bool,
    resting: bool,
    modes: ModeSet,
    packed: ParameterPack,
    errors_n: Option<[f32; SLOTS]>,
    stop: Option<FarStop>,
});

record!(ParameterPack { slot: u8, len: u8, numbers: [f32; PACKED_MAX] });

choice!(FarStop {
    0 => Stopped {},
    1 => SourceSilent {},
    2 => LoopStalled {},
    3 => ForceUnknown {},
    4 => DeviceLost {},
    5 => DrivesOff {},
    6 => SamplesLost {},
    7 => LinkSilent {},
    8 => ClockJumped {},
    9 => Implausible {},
    10 => Other {},
});

/// Orientation of the endoscope, as the loop uses it. The position of its marker serves only the display, and is in the
/// plotted frames.
enum ViewTurn {
    Fixed,
    Unseen,
    Seen(UnitQuaternion<f64>),
}

choice!(ViewTurn {
    0 => Fixed {},
    1 => Unseen {},
    2 => Seen { 0: world_from_view: UnitQuaternion<f64> },
});

impl ToWords for ViewOrientation {
    const COLUMNS: usize = ViewTurn::COLUMNS;

    fn put(&self, to: &mut impl WordSink) {
        let turned = match self {
            Self::Fixed => ViewTurn::Fixed,
            Self::Unseen => ViewTurn::Unseen,
            Self::Seen(world_from_view) | Self::SeenAt { world_from_view, world_from_n: _ } => {
                ViewTurn::Seen(*world_from_view)
            }
        };
        turned.put(to);
    }
}

impl FromWords for ViewOrientation {
    fn take(from: &mut impl WordSource) -> Result<Self, CodecError> {
        Ok(match ViewTurn::take(from)? {
            ViewTurn::Fixed => Self::Fixed,
            ViewTurn::Unseen => Self::Unseen,
            ViewTurn::Seen(world_from_view) => Self::Seen(world_from_view),
        })
    }
}

record!(WristSample {
    raw: Wrench,
    acceleration_m_s2: Option<Vector3<f64>>,
    world_from_s1: Option<UnitQuaternion<f64>>,
    world_from_m: Option<UnitQuaternion<f64>>,
    m_from_c: Option<UnitQuaternion<f64>>,
    insertion_m: Option<f64>,
    tissue_n: Option<Vector3<f64>>,
});

record!(FrameSample {
    base_from_flange: Option<Isometry3<f64>>,
    other_base_from_flange: Option<Isometry3<f64>>,
    c_from_m: Option<Isometry3<f64>>,
    c_from_other_m: Option<Isometry3<f64>>,
    leader_from_handle: Option<Isometry3<f64>>,
    wrench: Option<Wrench>,
});

choice!(EngageBlocker {
    0 => Start { 0: error: ArmStartError },
    1 => Waiting { 0: awaited: AwaitedDevice },
    2 => Exchanged { 0: exchange: SideSwap },
    3 => FarEnd {},
    // Without fields, so that a tick has as many columns as in older journals.
    4 => OneHandle {},
    5 => OneArm {},
    6 => OneSensor {},
});

choice!(AwaitedDevice { 0 => Servos {}, 1 => Markers {} });

choice!(SideSwap {
    0 => Handles {},
    1 => Arms {},
    2 => Sensors {},
    3 => Servos {},
    4 => Markers {},
    5 => Trocars {},
});

choice!(ArmStartError {
    0 => Period { period_s: period_s: f64 },
    1 => ShortShaft { shaft_m: shaft_m: f64, insertion_max_m: insertion_max_m: f64 },
    2 => NotFinite { joint: joint: usize },
    3 => AtLimit { joint: joint: usize, angle_deg: angle_deg: f64, limit_deg: limit_deg: f64 },
    4 => BesideTrocar { miss_m: miss_m: f64, max_m: max_m: f64 },
    5 => NotInserted { insertion_m: insertion_m: f64 },
});
