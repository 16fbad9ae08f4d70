//! An emulated rig: an emulator for every device of a rig file, at its place, all around one simulated world per side.
//!
//! Takes what the rig file says of the devices and a scene; gives devices on real wires (pseudo-terminals, TCP, UDP, the handle's
//! library), which the real drivers open; for the handles their program first calls [`provide_handles`]. Move the emulated handle and the arm that follows it presses the tissue, and the
//! sensor feels it. Where the sensors sit at the wrists, a simulated technician obeys the calibrations' instructions:
//! [`EmulatedRig::technician`] takes what the screen shows him. Frames: everything inside is in `world`; each device tells in its
//! own. Needs Unix; the pedal needs Linux. Bad input: what cannot be emulated here (another computer's address) is refused in one
//! line.

mod clocked;
mod errors;
mod flawed;
#[cfg(test)]
mod frame_tests;
mod guiding;
#[cfg(test)]
mod network_tests;
mod picture;
mod places;
mod scene;
mod seen;
mod serving;
mod side;
mod stand_in;
mod technician;
#[cfg(test)]
mod tests;

use std::{
    sync::{
        Arc, Mutex, OnceLock, PoisonError,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
    time::Instant,
};

use nalgebra::UnitQuaternion;
use nima_core::kinematics::{Arm, ArmError, Mapping, Rcm, RcmError, ReadyError, find};
use nima_devices::Trouble;
use nima_machine::{
    config::ConfigError,
    rig::{ArmSet, Flaws, Prompt, SIDES, Settings, Side},
};
use side::SideWorld;

pub use clocked::{ArmReadings, Clocked, Wiring};
pub use errors::{DoubtShares, FreeError, IN_USE, TipError, TipErrors};
pub use side::Truth;
pub use stand_in::provide_handles;

use crate::emulators::{EmulatedFault, FaultSwitch, Serving};
use nima_simulation::{
    Hand,
    scene::Scene,
    screen::{Screen, Task},
};

/// How a side's handle stands to the workspace: the inverse of the rig's mapping from hand to tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandFrame {
    /// From the workspace to the handle's own frame.
    pub leader_from_world: UnitQuaternion<f64>,
    /// The tip's way per way of the hand.
    pub scale: f64,
}

impl HandFrame {
    /// The inverse of a rig's mapping.
    pub fn of(mapping: &Mapping) -> Self {
        Self { leader_from_world: mapping.world_from_leader().inverse(), scale: mapping.scale() }
    }
}

impl Default for HandFrame {
    fn default() -> Self {
        Self { leader_from_world: UnitQuaternion::identity(), scale: 1.0 }
    }
}

/// Why a rig cannot be emulated.
#[derive(Debug, thiserror::Error)]
pub enum EmulatedRigError {
    /// The rig has no arm pair.
    #[error("this rig names no arm pair to emulate: give it [devices.right], or use the rig `emulated`")]
    NoArm,
    /// There is no emulator for this make.
    #[error("the {device} cannot be emulated: there is no emulator for its `make`")]
    Make {
        /// Its name in the rig.
        device: String,
    },
    /// The place is not on this computer.
    #[error("the {device} cannot be emulated at \"{place}\": {wanted}")]
    Place {
        /// Its name in the rig.
        device: String,
        /// As the rig file has it.
        place: String,
        /// What it must be.
        wanted: &'static str,
    },
    /// The scene that describes the paper's rig.
    #[error("the paper's rig is not known")]
    Paper(#[from] ConfigError),
    /// The rig file says something impossible.
    #[error("the rig cannot be emulated")]
    Settings(#[from] Trouble),
    /// The arm's mount is impossible.
    #[error("the {device} cannot be mounted so")]
    Mount {
        /// Its name in the rig.
        device: String,
        /// Why.
        source: ArmError,
    },
    /// The trocar is impossible.
    #[error("the trocar of the {device} is not possible")]
    Trocar {
        /// Name of the arm.
        device: String,
        /// Why.
        source: RcmError,
    },
    /// The arm has no pose for where the hand begins.
    #[error("the {device} cannot begin where the scene's hand does")]
    Ready {
        /// Its name in the rig.
        device: String,
        /// Why.
        source: ReadyError,
    },
    /// The place cannot be served.
    #[error("the {device} cannot be emulated")]
    Serve {
        /// Its name in the rig.
        device: String,
        /// Why.
        source: std::io::Error,
    },
}

/// One device that is emulated.
#[derive(Debug)]
pub struct EmulatedDevice {
    /// Its name in the rig: `right sensor`.
    pub name: String,
    /// Its endpoint and its faults.
    pub serving: Serving,
}

/// The world of a side, shared by its emulators, and the clock that all sides have.
#[derive(Clone)]
struct Shared {
    begin: Instant,
    side: Arc<Mutex<SideWorld>>,
}

impl Shared {
    fn with<T>(&self, work: impl FnOnce(&mut SideWorld, f64) -> T) -> T {
        let now_s = self.begin.elapsed().as_secs_f64();
        work(&mut self.side.lock().unwrap_or_else(PoisonError::into_inner), now_s)
    }
}

/// All devices of a rig, emulated. Dropping it ends them all.
pub struct EmulatedRig {
    devices: Vec<EmulatedDevice>,
    sides: [Option<Shared>; SIDES],
    pedal: Arc<AtomicU32>,
    markers_exchanged: Arc<AtomicBool>,
    /// The fault of the endoscope, on which the tracker's marker is, once its picture is served.
    endoscope: Arc<OnceLock<FaultSwitch>>,
}

impl std::fmt::Debug for EmulatedRig {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EmulatedRig").field("devices", &self.devices).finish_non_exhaustive()
    }
}

/// Knows what only a simulation knows, from any thread.
#[derive(Clone)]
pub struct Witness {
    sides: [Option<Shared>; SIDES],
}

impl Witness {
    /// The truth of a side now; `None` where the rig has none.
    pub fn truth(&self, side: Side) -> Option<Truth> {
        self.sides[side.index()].as_ref().map(|shared| shared.with(SideWorld::truth))
    }
}

/// The simulated technician, who reads the screen: whoever shows instructions tells him. He goes to the arm that is
/// calibrated, and away from the other one.
#[derive(Clone)]
pub struct Technician {
    sides: [Option<Shared>; SIDES],
}

impl std::fmt::Debug for Technician {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Technician").finish_non_exhaustive()
    }
}

impl Technician {
    /// He reads what the screen shows now.
    pub fn reads(&self, screen: &Screen) {
        for (side, shared) in Side::ALL.into_iter().zip(&self.sides) {
            let here = side == screen.side;
            let (task, prompt) = if here { (screen.task, screen.prompt) } else { (Task::Surgery, Prompt::Rest) };
            if let Some(shared) = shared {
                shared.with(|side, now_s| side.reads(now_s, task, prompt));
            }
        }
    }
}

impl EmulatedRig {
    /// Starts an emulator for every device in `devices`, at its place. `hands` tells, in the order of [`Side::ALL`], how the
    /// handles stand to the workspace. Takes under a second, for the arms' poses.
    ///
    /// # Errors
    /// When a place is taken or not on this computer, or arm, trocar and scene do not fit together.
    pub fn start(devices: &Settings, scene: &Scene, hands: &[HandFrame; SIDES]) -> Result<Self, EmulatedRigError> {
        let begin = Instant::now();
        let sides = sides(devices, scene, hands)?;
        let sides = sides.map(|side| side.map(|side| Shared { begin, side: Arc::new(Mutex::new(side)) }));
        let pedal = Arc::new(AtomicU32::new(0));
        let markers_exchanged = Arc::new(AtomicBool::new(false));
        let endoscope = Arc::default();
        let devices = serving::all(devices, &sides, &pedal, &markers_exchanged, &endoscope)?;
        Ok(Self { devices, sides, pedal, markers_exchanged, endoscope })
    }

    /// Everything that serves.
    pub fn servings(&self) -> &[EmulatedDevice] {
        &self.devices
    }

    /// Sets the fault of a device by its name, with blanks or dashes (`right-sensor`); false where there is none.
    pub fn set_fault(&self, name: &str, fault: EmulatedFault) -> bool {
        let plain = name.replace('-', " ");
        let device = self.devices.iter().find(|device| device.name == plain);
        device.map(|device| device.serving.faults.set(fault)).is_some()
    }

    /// The technician at the arms.
    pub fn technician(&self) -> Technician {
        Technician { sides: self.sides.clone() }
    }

    /// Presses the pedal's switches, first in the lowest bit, until told otherwise.
    pub fn press(&self, switches: u32) {
        self.pedal.store(switches, Ordering::Release);
    }

    /// Puts each marker on the other side's instrument.
    pub fn exchange_markers(&self) {
        self.markers_exchanged.fetch_xor(true, Ordering::AcqRel);
    }

    /// What only a simulation knows of a side; `None` where the rig has none.
    pub fn truth(&self, side: Side) -> Option<Truth> {
        self.witness().truth(side)
    }

    /// The same, from any thread.
    pub fn witness(&self) -> Witness {
        Witness { sides: self.sides.clone() }
    }
}

type Sides = [Option<SideWorld>; SIDES];

/// The worlds, both arms' poses sought at once: each takes some hundred milliseconds.
fn sides(devices: &Settings, scene: &Scene, hands: &[HandFrame; SIDES]) -> Result<Sides, EmulatedRigError> {
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
    let arm = Arm::new(&set.mount).map_err(|source| EmulatedRigError::Mount { device: device(), source })?;
    let rcm = Rcm::new(&set.rcm).map_err(|source| EmulatedRigError::Trocar { device: device(), source })?;
    let ready = find(&arm, &rcm, &Hand::new(&scene).position_m());
    let ready = ready.map_err(|source| EmulatedRigError::Ready { device: device(), source })?;
    Ok(SideWorld::new(&scene, set, arm, &ready.joint_rad, hand, flaws))
}
