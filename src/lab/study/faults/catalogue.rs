//! Every kind of fault on the virtual clock: its description, its location, and, if it cannot be detected, the reason.

use serde::Serialize;

/// Location of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultPart {
    Force,
    /// Orientation of the wrist, from accelerometer or arm.
    Orientation,
    Handle,
    Arm,
    /// Pedal and presence detection.
    Switches,
    /// The loop's clock.
    Clock,
    /// The link between follower and leader.
    Link,
    /// Commands from the screen.
    Commands,
}

impl FaultPart {
    /// Returns whether the force to the hand is computed from data of this part.
    pub const fn is_on_force_path(self) -> bool {
        matches!(self, Self::Force | Self::Orientation | Self::Clock | Self::Link)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    ForceSilent,
    ForceGaps,
    ForceFrozen,
    ForceBlock,
    ForceAxisFrozen,
    ForceDead,
    ForceFalls,
    ForceStep,
    ForceSmallStep,
    ForceDrift,
    ForceSlowDrift,
    ForceSign,
    ForceAxes,
    ForceSpike,
    ForceSpikes,
    ForceSaturated,
    ForceNoise,
    ForceLate,
    ForceLateTold,
    ForceDoubled,
    ForceReordered,
    ForceNan,
    ForceInfinite,
    ForceAbsurd,
    ForceGain,
    ForceLost,
    ImuStops,
    ImuFrozen,
    ImuSign,
    ImuNan,
    ImuDead,
    OrientationMissing,
    OrientationJump,
    HandFrozen,
    HandBlock,
    HandJump,
    HandSpike,
    HandSign,
    HandAxes,
    HandNan,
    HandNoise,
    HandLate,
    HandDrift,
    HandleWithoutForce,
    HandleInverted,
    HandleKeepsForce,
    TipFrozen,
    TipBlock,
    TipJump,
    TipDrift,
    TipSign,
    TipNan,
    ArmIgnores,
    ArmAxes,
    DrivesOff,
    PedalDown,
    PedalUp,
    PedalBounces,
    HandAbsent,
    ClockForward,
    ClockBackward,
    ClockStops,
    ClockSlow,
    ClockNan,
    PeriodsMissed,
    FewPeriodsMissed,
    LinkSilent,
    LinkHalf,
    LinkLate,
    LinkJitter,
    LinkSwaps,
    LinkDoubles,
    LinkPoisoned,
    LinkRepeats,
    CommandsPoisoned,
    CommandsDoubled,
    SliderShakes,
}

use FaultKind as K;

impl FaultKind {
    /// All of them, part by part.
    #[rustfmt::skip]
    pub const ALL: [Self; 77] = [
        K::ForceSilent, K::ForceGaps, K::ForceFrozen, K::ForceBlock, K::ForceAxisFrozen, K::ForceDead, K::ForceFalls, K::ForceStep,
        K::ForceSmallStep, K::ForceDrift, K::ForceSlowDrift, K::ForceSign, K::ForceAxes, K::ForceSpike, K::ForceSpikes, K::ForceSaturated,
        K::ForceNoise, K::ForceLate, K::ForceLateTold, K::ForceDoubled, K::ForceReordered, K::ForceNan, K::ForceInfinite,
        K::ForceAbsurd, K::ForceGain, K::ForceLost,
        K::ImuStops, K::ImuFrozen, K::ImuSign, K::ImuNan, K::ImuDead, K::OrientationMissing, K::OrientationJump,
        K::HandFrozen, K::HandBlock, K::HandJump, K::HandSpike, K::HandSign, K::HandAxes, K::HandNan, K::HandNoise, K::HandLate,
        K::HandDrift, K::HandleWithoutForce, K::HandleInverted, K::HandleKeepsForce,
        K::TipFrozen, K::TipBlock, K::TipJump, K::TipDrift, K::TipSign, K::TipNan, K::ArmIgnores, K::ArmAxes, K::DrivesOff,
        K::PedalDown, K::PedalUp, K::PedalBounces, K::HandAbsent,
        K::ClockForward, K::ClockBackward, K::ClockStops, K::ClockSlow, K::ClockNan, K::PeriodsMissed, K::FewPeriodsMissed,
        K::LinkSilent, K::LinkHalf, K::LinkLate, K::LinkJitter, K::LinkSwaps, K::LinkDoubles, K::LinkPoisoned,
        K::LinkRepeats,
        K::CommandsPoisoned, K::CommandsDoubled, K::SliderShakes,
    ];

    pub const fn part(self) -> FaultPart {
        match self {
            K::ImuStops
            | K::ImuFrozen
            | K::ImuSign
            | K::ImuNan
            | K::ImuDead
            | K::OrientationMissing
            | K::OrientationJump => FaultPart::Orientation,
            K::HandFrozen
            | K::HandBlock
            | K::HandJump
            | K::HandSpike
            | K::HandSign
            | K::HandAxes
            | K::HandNan
            | K::HandNoise
            | K::HandLate
            | K::HandDrift
            | K::HandleWithoutForce
            | K::HandleInverted
            | K::HandleKeepsForce => FaultPart::Handle,
            K::TipFrozen
            | K::TipBlock
            | K::TipJump
            | K::TipDrift
            | K::TipSign
            | K::TipNan
            | K::ArmIgnores
            | K::ArmAxes
            | K::DrivesOff => FaultPart::Arm,
            K::PedalDown | K::PedalUp | K::PedalBounces | K::HandAbsent => FaultPart::Switches,
            K::ClockForward
            | K::ClockBackward
            | K::ClockStops
            | K::ClockSlow
            | K::ClockNan
            | K::PeriodsMissed
            | K::FewPeriodsMissed => FaultPart::Clock,
            K::LinkSilent
            | K::LinkHalf
            | K::LinkLate
            | K::LinkJitter
            | K::LinkSwaps
            | K::LinkDoubles
            | K::LinkPoisoned
            | K::LinkRepeats => FaultPart::Link,
            K::CommandsPoisoned | K::CommandsDoubled | K::SliderShakes => FaultPart::Commands,
            _ => FaultPart::Force,
        }
    }

    /// Readings of a repeated block.
    pub(super) const BLOCK: usize = 32;

    /// Returns whether the fault is in the readings or the actions of a device; it is then also tested on rigs with an
    /// arm. The other faults do not depend on the rig.
    pub const fn is_of_devices(self) -> bool {
        match self.part() {
            FaultPart::Force => !matches!(self, K::ForceLateTold | K::ForceLost),
            FaultPart::Orientation => !matches!(self, K::OrientationMissing | K::OrientationJump),
            FaultPart::Handle => true,
            FaultPart::Arm => !matches!(self, K::TipSign | K::DrivesOff),
            FaultPart::Switches | FaultPart::Clock | FaultPart::Link | FaultPart::Commands => false,
        }
    }

    /// Returns whether it needs a sensor at the wrist.
    pub const fn needs_wrist(self) -> bool {
        matches!(self.part(), FaultPart::Orientation)
    }

    #[rustfmt::skip]
    pub const fn words(self) -> &'static str {
        match self {
            K::ForceSilent => "sensor sends nothing",
            K::ForceGaps => "every second sample is lost",
            K::ForceFrozen => "force repeats itself",
            K::ForceBlock => "force repeats a block of 32 readings",
            K::ForceAxisFrozen => "one axis of the force repeats itself",
            K::ForceDead => "force reads exactly zero",
            K::ForceFalls => "force falls to its noise within 3 ms",
            K::ForceStep => "bias steps by 1.5 N",
            K::ForceSmallStep => "bias steps by 0.3 N",
            K::ForceDrift => "bias drifts by 0.5 N/s",
            K::ForceSlowDrift => "bias drifts by 0.05 N/s",
            K::ForceSign => "sign of the force is inverted",
            K::ForceAxes => "axes of the force are swapped",
            K::ForceSpike => "one sample is 10 N off",
            K::ForceSpikes => "every 50th sample is 10 N off",
            K::ForceSaturated => "force saturates 1 N above its present value",
            K::ForceNoise => "noise of 0.4 N",
            K::ForceLate => "force is 50 ms late, without time stamps",
            K::ForceLateTold => "samples are 15 ms old, with time stamps",
            K::ForceDoubled => "every sample comes twice, every second is lost",
            K::ForceReordered => "neighbouring samples are swapped",
            K::ForceNan => "force is NaN",
            K::ForceInfinite => "force is infinite",
            K::ForceAbsurd => "force is 1e18 N",
            K::ForceGain => "force is doubled",
            K::ForceLost => "driver reports the sensor lost",
            K::ImuStops => "accelerometer is silent",
            K::ImuFrozen => "accelerometer repeats itself",
            K::ImuSign => "accelerometer is inverted",
            K::ImuNan => "accelerometer is NaN",
            K::ImuDead => "accelerometer reads exactly zero",
            K::OrientationMissing => "arm's orientation is missing",
            K::OrientationJump => "arm's orientation turns by 90 degrees",
            K::HandFrozen => "handle's position repeats itself",
            K::HandBlock => "handle repeats a block of 32 positions",
            K::HandJump => "handle's position jumps by 20 mm",
            K::HandSpike => "one handle position is 20 mm off",
            K::HandSign => "handle's axes are inverted",
            K::HandAxes => "handle's axes are swapped",
            K::HandNan => "handle's position is NaN",
            K::HandNoise => "handle's position has 0.3 mm of noise",
            K::HandLate => "handle's position comes 50 ms late",
            K::HandDrift => "handle's position drifts by 5 mm/s",
            K::HandleWithoutForce => "handle gives no force",
            K::HandleInverted => "handle gives the opposite force",
            K::HandleKeepsForce => "handle keeps its last force",
            K::TipFrozen => "arm's position repeats itself",
            K::TipBlock => "arm repeats a block of 32 readings",
            K::TipJump => "arm's position jumps by 10 mm",
            K::TipDrift => "arm's position drifts by 5 mm/s",
            K::TipSign => "arm's axes are inverted",
            K::TipNan => "arm's position is NaN",
            K::ArmIgnores => "arm does not move",
            K::ArmAxes => "arm moves along swapped axes",
            K::DrivesOff => "drives switch themselves off",
            K::PedalDown => "pedal is stuck down",
            K::PedalUp => "pedal is stuck up",
            K::PedalBounces => "pedal bounces every 20 ms",
            K::HandAbsent => "hand opens, detected by the handle",
            K::ClockForward => "clock jumps 1 s ahead",
            K::ClockBackward => "clock jumps 1 s back",
            K::ClockStops => "clock stands still",
            K::ClockSlow => "clock runs at half its rate",
            K::ClockNan => "time is NaN",
            K::PeriodsMissed => "100 periods are missed",
            K::FewPeriodsMissed => "10 periods are missed",
            K::LinkSilent => "link loses everything",
            K::LinkHalf => "link loses every second packet",
            K::LinkLate => "link is 100 ms later than programmed",
            K::LinkJitter => "link is 3 ms later than programmed",
            K::LinkSwaps => "link exchanges neighbours",
            K::LinkDoubles => "link delivers everything twice",
            K::LinkPoisoned => "link delivers NaN",
            K::LinkRepeats => "link repeats one packet under new times",
            K::CommandsPoisoned => "commands with NaN and out of range",
            K::CommandsDoubled => "every command comes twice",
            K::SliderShakes => "gain is commanded up and down in each tick",
        }
    }

    /// Returns the reason if the fault is accepted as fresh data by design.
    pub const fn passes_as_fresh(self) -> Option<&'static str> {
        match self {
            K::LinkJitter | K::LinkHalf | K::LinkSwaps | K::ForceDoubled | K::ForceReordered | K::ForceSpikes => {
                Some("late by less than 5 ms, which the age gate accepts; gates with a memory then differ for a while")
            }
            _ => None,
        }
    }

    /// Returns the reason if the fault cannot be distinguished from normal operation. The error must then be bounded.
    pub const fn untellable(self) -> Option<&'static str> {
        Some(match self {
            K::ForceStep => "an instrument that moves 0.2 mm between two readings could have met something stiff",
            K::ForceSmallStep => "a small step is within what a contact does in a tick",
            K::ForceDrift | K::ForceSlowDrift => "a slow bias looks like a slow contact",
            K::ForceAxes => "before a contact, an inclined surface would look the same",
            K::ForceGain => "before a contact, stiffer tissue would look the same",
            K::ForceLate => "without time stamps of the sensor, a lagging arm would look the same",
            K::ForceFalls => "a contact that ends would look the same",
            K::ForceDead => "without contact, an ideal sensor would look the same",
            K::HandleWithoutForce | K::HandleInverted | K::HandleKeepsForce => {
                "nothing measures the force in the handle"
            }
            K::HandDrift | K::HandLate | K::HandNoise | K::HandSign | K::HandAxes => {
                "a different motion of the hand would look the same"
            }
            K::TipDrift => "a different position would look the same",
            _ => return None,
        })
    }
}
