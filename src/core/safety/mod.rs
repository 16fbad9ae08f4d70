//! Between every model and the hand: a fixed chain of gates that no force bypasses.
//!
//! Takes the force (N) that a mode requests, its age (s), the hand's speed (m/s) and position (m); returns a force that
//! is finite, recent, permitted, passive and bounded, and reports which gates acted, why, and how often. One file per
//! gate; [`SafetyChain`] defines their order. Bad input (NaN, infinite, too old) gives zero, never a panic. Uses no devices,
//! files or threads.

mod chain;
mod governor;
mod interlock;
mod plausibility;
mod report;
mod settings;

pub use chain::{
    ALLOWANCE_J, AgeGate, Ceiling, DeadBand, Energy, ForceRequest, Gain, GripperChain, LEAK_S, MAX_J, PLAUSIBLE_N,
    SafetyChain, Slew, TorqueChain, admitted,
};
pub use governor::{FreeHandle, Governor, GovernorOutput, GovernorReading};
pub use interlock::{
    Interlock, InterlockInput, InterlockRequest, InterlockState, InvalidRequest, Permits, READY_WITHIN_S, StateChange,
    TransitionCause,
};
pub use plausibility::{
    ARM_CHANNELS, AdmittedReadings, CHANNELS, Fall, HANDLE_CHANNELS, Implausible, JumpDetector, Plausibility,
    PlausibilityInput, RawReading, RawReadings, ReleaseMemory, TouchMemory,
};
pub use report::{GATES, Gate, GateCounts, GateReport, Reason};
pub use settings::{ChainSettings, EnergyMode};
