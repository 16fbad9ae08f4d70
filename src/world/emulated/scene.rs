//! A scene made fit for one side of an emulated rig.

use nima_machine::rig::{ArmSet, Side};

use super::EmulatedRigError;
use crate::scene::Scene;

/// The scene as this side sees it: the left one mirrored where it has no part of its own; trocar and shaft are the rig's own.
pub(super) fn of_side(scene: &Scene, side: Side, set: &ArmSet) -> Result<Scene, EmulatedRigError> {
    if scene.person.is_some() {
        return Err(EmulatedRigError::Person { scene: scene.name.clone() });
    }
    let mut scene = scene.clone().with_left_hand().of_side(side).unwrap_or_else(|| scene.clone());
    scene.trocar_m = set.rcm.trocar_m;
    if let Some(wrist) = &mut scene.wrist {
        wrist.shaft_m = set.mount.shaft_m;
    }
    Ok(scene)
}
