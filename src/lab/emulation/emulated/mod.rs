//! An emulated rig: an emulator for every device of a rig file, at its address, all around one simulated world per
//! side.
//!
//! Takes the devices of a rig file and a scene; provides devices on real connections (pseudo-terminals, TCP, UDP, the
//! handle's library), which the real drivers open. A program with emulated handles first calls [`provide_handles`].
//! When the emulated handle moves, the arm that follows it presses the tissue, and the sensor measures the force. If
//! the sensors sit at the wrists, a simulated technician follows the calibrations' instructions:
//! [`EmulatedRig::technician`] receives the content of the screen. Frames: everything inside is in `world`; each device
//! reports in its own frame. Needs Unix; the pedal needs Linux. A device that cannot be emulated here (for example at
//! another computer's address) is refused in one line.

mod addresses;
mod clocked;
mod errors;
#[cfg(test)]
mod frame_tests;
mod guiding;
mod image;
#[cfg(test)]
mod network_tests;
mod noise_model;
mod scene;
mod serving;
mod side;
mod stand_in;
mod technician;
#[cfg(test)]
mod tests;
mod tracker_view;

use std::{
    sync::{
        Arc, Mutex, OnceLock, PoisonError,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
    time::Instant,
};

use nalgebra::UnitQuaternion;
use nima_core::kinematics::{ArmError, MotionMapping, Rcm, RcmError, ReadyError, find};
use nima_devices::DeviceError;
use nima_machine::{
    config::ConfigError,
    rig::{ArmSet, Flaws, Prompt, RigSettings, SIDES, Side},
};
use side::SideWorld;

pub use clocked::{ArmReadings, ClockedSide, Wiring};
pub use errors::{DoubtFractions, FreeError, IN_USE, TipError, TipErrors};
pub use side::Truth;
pub use stand_in::provide_handles;

use crate::emulators::{EmulatedFault, EmulatorThread, FaultSwitch};
use nima_simulation::{
    Hand,
    scene::Scene,
    screen::{PersonTask, Screen},
};

/// Relation of a side's handle to the workspace: the inverse of the rig's mapping from hand to tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandFrame {
    /// Rotation from the workspace to the handle's own frame.
    pub leader_from_world: UnitQuaternion<f64>,
    /// Travel of the tip per travel of the hand.
    pub scale: f64,
}

impl HandFrame {
    pub fn of(mapping: &MotionMapping) -> Self {
        Self { leader_from_world: mapping.world_from_leader().inverse(), scale: mapping.scale() }
    }
}

impl Default for HandFrame {
    fn default() -> Self {
        Self { leader_from_world: UnitQuaternion::identity(), scale: 1.0 }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum EmulatedRigError {
    /// The rig has no arm pair.
    #[error("cannot emulate this rig: it has no arm pair; add [devices.right], or use the rig `emulated`")]
    NoArm,
    #[error("cannot emulate the {device}: there is no emulator for its `make`; use another make")]
    Make { device: String },
    /// The address is not on this computer.
    #[error("cannot emulate the {device} at \"{place}\": {wanted}")]
    Place {
        device: String,
        place: String,
        /// The required form.
        wanted: &'static str,
    },
    /// The scene that describes the paper's rig.
    #[error("cannot load the built-in scene of the paper's rig")]
    Paper(#[from] ConfigError),
    #[error("cannot emulate the rig")]
    Settings(#[from] DeviceError),
    /// The arm's mount is impossible.
    #[error("the mount of the {device} is invalid; correct it in the rig file")]
    Mount { device: String, source: ArmError },
    /// The trocar is impossible.
    #[error("the trocar of the {device} is invalid; correct it in the rig file")]
    Trocar { device: String, source: RcmError },
    /// The arm cannot reach the start position of the hand.
    #[error("the {device} cannot reach the start position of the scene's hand")]
    Ready { device: String, source: ReadyError },
    /// The emulator cannot be started.
    #[error("cannot emulate the {device}")]
    Serve { device: String, source: std::io::Error },
}

/// An emulated device.
#[derive(Debug)]
pub struct EmulatedDevice {
    /// Name of the device in the rig, such as `right sensor`.
    pub name: String,
    /// Endpoint of the device, and its faults.
    pub serving: EmulatorThread,
}

/// The world of a side, shared by its emulators, and the clock shared by all sides.
#[derive(Clone)]
struct SharedWorld {
    begin: Instant,
    side: Arc<Mutex<SideWorld>>,
}

impl SharedWorld {
    fn with<T>(&self, work: impl FnOnce(&mut SideWorld, f64) -> T) -> T {
        let now_s = self.begin.elapsed().as_secs_f64();
        work(&mut self.side.lock().unwrap_or_else(PoisonError::into_inner), now_s)
    }
}

/// All devices of a rig, emulated. Dropping it stops all of them.
pub struct EmulatedRig {
    devices: Vec<EmulatedDevice>,
    sides: [Option<SharedWorld>; SIDES],
    pedal: Arc<AtomicU32>,
    markers_exchanged: Arc<AtomicBool>,
    /// The fault of the endoscope, which carries the tracker's marker, once its image is served.
    endoscope: Arc<OnceLock<FaultSwitch>>,
}

impl std::fmt::Debug for EmulatedRig {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EmulatedRig").field("devices", &self.devices).finish_non_exhaustive()
    }
}

/// Reads the simulation's true state, from any thread.
#[derive(Clone)]
pub struct GroundTruth {
    sides: [Option<SharedWorld>; SIDES],
}

impl GroundTruth {
    /// Returns the true current state of a side; `None` if the rig does not have that side.
    pub fn truth(&self, side: Side) -> Option<Truth> {
        self.sides[side.index()].as_ref().map(|shared| shared.with(SideWorld::truth))
    }
}

/// The simulated technician. The program that shows instructions passes them on. The technician goes to the arm that is
/// being calibrated, and leaves the other one.
#[derive(Clone)]
pub struct Technician {
    sides: [Option<SharedWorld>; SIDES],
}

impl std::fmt::Debug for Technician {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Technician").finish_non_exhaustive()
    }
}

impl Technician {
    /// Updates the content of the screen.
    pub fn reads(&self, screen: &Screen) {
        for (side, shared) in Side::ALL.into_iter().zip(&self.sides) {
            let here = side == screen.side;
            let (task, prompt) = if here { (screen.task, screen.prompt) } else { (PersonTask::Surgery, Prompt::Rest) };
            if let Some(shared) = shared {
                shared.with(|side, now_s| side.reads(now_s, task, prompt));
            }
        }
    }
}

impl EmulatedRig {
    /// Starts an emulator for every device in `devices`, at its address. `hands`, in the order of [`Side::ALL`],
    /// describes the relation of the handles to the workspace. Takes less than a second, for the arms' poses.
    ///
    /// # Errors
    /// If an address is in use or not on this computer, or arm, trocar and scene do not fit together.
    pub fn start(devices: &RigSettings, scene: &Scene, hands: &[HandFrame; SIDES]) -> Result<Self, EmulatedRigError> {
        let begin = Instant::now();
        let sides = sides(devices, scene, hands)?;
        let sides = sides.map(|side| side.map(|side| SharedWorld { begin, side: Arc::new(Mutex::new(side)) }));
        let pedal = Arc::new(AtomicU32::new(0));
        let markers_exchanged = Arc::new(AtomicBool::new(false));
        let endoscope = Arc::default();
        let devices = serving::all(devices, &sides, &pedal, &markers_exchanged, &endoscope)?;
        Ok(Self { devices, sides, pedal, markers_exchanged, endoscope })
    }

    /// Returns the running emulators.
    pub fn servings(&self) -> &[EmulatedDevice] {
        &self.devices
    }

    /// Sets the fault of a device by its name, with spaces or dashes (`right-sensor`); returns false if there is no
    /// such device.
    pub fn set_fault(&self, name: &str, fault: EmulatedFault) -> bool {
        let plain = name.replace('-', " ");
        let device = self.devices.iter().find(|device| device.name == plain);
        device.map(|device| device.serving.faults.set(fault)).is_some()
    }

    pub fn technician(&self) -> Technician {
        Technician { sides: self.sides.clone() }
    }

    /// Presses the pedal's switches, the first in the lowest bit, until the next call.
    pub fn press(&self, switches: u32) {
        self.pedal.store(switches, Ordering::Release);
    }

    /// Puts each marker on the other side's instrument.
    pub fn exchange_markers(&self) {
        self.markers_exchanged.fetch_xor(true, Ordering::AcqRel);
    }

    /// Returns the true state of a side; `None` if the rig does not have it.
    pub fn truth(&self, side: Side) -> Option<Truth> {
        self.witness().truth(side)
    }

    /// Returns access to the true state from any thread.
    pub fn witness(&self) -> GroundTruth {
        GroundTruth { sides: self.sides.clone() }
    }
}

type EmulationSides = [Option<SideWorld>; SIDES];

/// Creates the worlds and searches for the poses of both arms in parallel, because each search takes some hundred
/// milliseconds.
fn sides(devices: &RigSettings, scene: &Scene, hands: &[HandFrame; SIDES]) -> Result<EmulationSides, EmulatedRigError> {
    if Side::ALL.iter().all(|side| devices.arm(*side).is_none()) {
        return Err(EmulatedRigError::NoArm);
    }
    let seek = |side: Side| {
        devices.arm(side).map(|set| of_side(side, set, scene, hands[side.index()], devices.flaws)).transpose()
    };
    let (right, left) = std::thread::scope(|scope| {
        let left = scope.spawn(|| seek(Side::Left));
        (seek(Side::Right), left.join())
    });
    let broken = || EmulatedRigError::Serve {
        device: "left arm".to_owned(),
        source: std::io::Error::other("the search for its pose ended early"),
    };
    Ok([right?, left.map_err(|_| broken())??])
}

fn of_side(
    side: Side,
    set: &ArmSet,
    scene: &Scene,
    hand: HandFrame,
    flaws: Flaws,
) -> Result<SideWorld, EmulatedRigError> {
    let device = || format!("{} arm", side.word());
    let scene = scene::of_side(scene, side, set)?;
    let arm = set.kinematics().map_err(|source| EmulatedRigError::Mount { device: device(), source })?;
    let rcm = Rcm::new(&set.rcm).map_err(|source| EmulatedRigError::Trocar { device: device(), source })?;
    let ready = find(&arm, &rcm, &Hand::new(&scene).position_m());
    let ready = ready.map_err(|source| EmulatedRigError::Ready { device: device(), source })?;
    Ok(SideWorld::new(&scene, set, &arm, &ready.joint_rad, hand, flaws))
}
