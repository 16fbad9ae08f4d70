//! A scene made fit for one side of an emulated rig.

use super::EmulatedRigError;
use crate::{
    config::Scene,
    device::{Side, rig::ArmSet},
};

/// The scene as this side sees it: the left one mirrored in x and with other noise; trocar and shaft are the rig's own.
pub(super) fn of_side(scene: &Scene, side: Side, set: &ArmSet) -> Result<Scene, EmulatedRigError> {
    if scene.person.is_some() {
        return Err(EmulatedRigError::Person { scene: scene.name.clone() });
    }
    let mut scene = scene.clone();
    if side == Side::Left {
        scene.targets_m.iter_mut().for_each(|target_m| target_m.x = -target_m.x);
        scene.seed = scene.seed.wrapping_add(1);
    }
    scene.trocar_m = set.rcm.trocar_m;
    if let Some(wrist) = &mut scene.wrist {
        wrist.shaft_m = set.mount.shaft_m;
    }
    Ok(scene)
}
