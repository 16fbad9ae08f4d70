//! Rebuilds recorded frames and arrows at another time, only from the numbers that this program draws.

use nima_machine::rig::Side;
use nima_recording::messages::foxglove::{FrameTransform, FrameTransforms, SceneEntity, SceneUpdate, timestamp};

use super::scene::{DRAWN, WORLD, name_of_arrows, name_of_frame};

/// Returns the frames of tips and leaders. The endoscope is left out, because its position reveals the room, and its
/// images are left out too.
pub(crate) fn frames(time_ns: u64, of: &FrameTransforms) -> FrameTransforms {
    let names = Side::ALL.into_iter().flat_map(|side| DRAWN.map(|name| name_of_frame(side, name)));
    let anew = |name: String| {
        let &FrameTransform { translation, rotation, .. } =
            of.transforms.iter().find(|frame| frame.child_frame_id == name)?;
        let timestamp = Some(timestamp(time_ns));
        Some(FrameTransform {
            timestamp,
            parent_frame_id: WORLD.to_owned(),
            child_frame_id: name,
            translation,
            rotation,
        })
    };
    FrameTransforms { transforms: names.filter_map(anew).collect() }
}

/// Returns the arrows of the forces.
pub(crate) fn arrows(time_ns: u64, of: &SceneUpdate) -> SceneUpdate {
    let anew = |id: String| {
        let arrows = of.entities.iter().find(|entity| entity.id == id)?.arrows.clone();
        let timestamp = Some(timestamp(time_ns));
        let frame_id = WORLD.to_owned();
        Some(SceneEntity { timestamp, frame_id, id, arrows, ..SceneEntity::default() })
    };
    let entities = Side::ALL.into_iter().map(name_of_arrows).filter_map(anew).collect();
    SceneUpdate { entities, ..SceneUpdate::default() }
}
