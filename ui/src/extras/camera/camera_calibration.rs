//! Changes of a camera calibration to a rig file.

use nalgebra::Isometry3;
use nima_core::{calibration::frames::RigChange, frames::to_roll_pitch_yaw_deg};
use nima_endoscope::{Bend, Lens};
use nima_machine::config::RigFile;

const CAMERA: &str = "endoscope.camera";

/// Result for the camera pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FoundPlace {
    /// In the workspace, or in the frame of the endoscope's marker.
    pub(super) pose: Isometry3<f64>,
    pub(super) on_marker: bool,
    /// Error on held-out points, px.
    pub(super) checked_px: f64,
}

/// Returns the changes that write this lens to a rig file. The camera pose was found with another lens and is removed,
/// unless a new one is given.
pub(super) fn changes(file: &RigFile, lens: &Lens, place: Option<FoundPlace>) -> Vec<RigChange> {
    let [width, height] = lens.size_px;
    let Bend { k1, k2, p1, p2 } = lens.bend;
    let focal_px = lens.focal_px;
    let centre_px = lens.centre_px;
    let term = |value: f64| (value != 0.0).then(|| format!("{value:.6}"));
    let at = |place: &FoundPlace| {
        let position_m = place.pose.translation.vector;
        let deg = to_roll_pitch_yaw_deg(&place.pose.rotation);
        let position_m = format!("[{:.6}, {:.6}, {:.6}]", position_m.x, position_m.y, position_m.z);
        [position_m, format!("[{:.4}, {:.4}, {:.4}]", deg.x, deg.y, deg.z)]
    };
    let in_world = place.as_ref().filter(|place| !place.on_marker).map(at);
    let on_marker = place.as_ref().filter(|place| place.on_marker).map(at);
    let [position, angles] = in_world.map_or([None, None], |parts| parts.map(Some));
    let [marker_m, marker_deg] = on_marker.map_or([None, None], |parts| parts.map(Some));
    let is_square = (focal_px.x - focal_px.y).abs() < 0.005;
    let values = [
        ("size_px", Some(format!("[{width}, {height}]"))),
        ("focal_px", Some(format!("{:.3}", focal_px.x))),
        ("focal_y_px", (!is_square).then(|| format!("{:.3}", focal_px.y))),
        ("centre_px", Some(format!("[{:.3}, {:.3}]", centre_px.x, centre_px.y))),
        ("k1", Some(format!("{k1:.6}"))),
        ("k2", term(k2)),
        ("p1", term(p1)),
        ("p2", term(p2)),
        ("position_m", position),
        ("world_from_camera_deg", angles),
        ("n_from_camera_m", marker_m),
        ("n_from_camera_deg", marker_deg),
        ("checked_px", place.map(|place| format!("{:.2}", place.checked_px))),
    ];
    let change = |(name, after): (&str, Option<String>)| {
        let key = format!("{CAMERA}.{name}");
        RigChange { before: file.value(&key), after, key }
    };
    values.into_iter().map(change).filter(|change| change.before != change.after).collect()
}

/// Returns the changes that undo these. A camera that did not exist before is removed again, without an empty table.
pub(super) fn undone(changes: &[RigChange]) -> Vec<RigChange> {
    let size = format!("{CAMERA}.size_px");
    if changes.iter().any(|change| change.key == size && change.before.is_none()) {
        return vec![RigChange { key: CAMERA.to_owned(), before: None, after: None }];
    }
    changes.iter().cloned().map(RigChange::undone).collect()
}

#[cfg(test)]
mod tests {
    use nima_machine::config::{RigConfig, change_rig};
    use nima_simulation::camera::camera_of;

    use super::*;

    #[test]
    fn a_rig_file_has_the_camera_as_it_was_found_and_comes_back_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rig.toml");
        let text = include_str!("../../../../config/rigs/simulated.toml").to_owned()
            + "\n[endoscope]\nurl = \"http://127.0.0.1:1/\" # the tower\n\n[endoscope.camera]\nsize_px = [640, 480]\nfocal_px = 500.0\nk2 = 0.1\n";
        std::fs::write(&path, &text).unwrap();
        let name = path.to_str().unwrap();
        let mut lens = Lens::simple([1280, 720], 750.25, -0.3);
        lens.bend.p1 = 0.002;
        lens.focal_px.y = 740.5;
        let pose = Isometry3::new([0.01, -0.09, 0.08].into(), [-2.1, 0.2, 0.1].into());
        let place = FoundPlace { pose, on_marker: false, checked_px: 2.5 };
        let all = changes(&RigFile::of(name).unwrap(), &lens, Some(place));
        change_rig(name, folder.path(), &all).unwrap();
        let camera = RigConfig::load(name).unwrap().endoscope.unwrap().camera.unwrap();
        assert_eq!((camera.size_px, camera.k2, camera.checked_px), ([1280, 720], 0.0, Some(2.5)));
        let again = camera_of(&camera);
        assert!((again.lens.focal_px - lens.focal_px).norm() < 1e-3 && again.lens.bend == lens.bend);
        let moved = again.world_from_camera.inverse() * pose;
        assert!(moved.translation.vector.norm() < 1e-5 && moved.rotation.angle() < 1e-5, "{moved}");
        assert!(std::fs::read_to_string(&path).unwrap().contains("# the tower"));
        // On the endoscope's marker: the previous workspace pose is removed.
        let place = FoundPlace { on_marker: true, ..place };
        let all = changes(&RigFile::of(name).unwrap(), &lens, Some(place));
        let after = |key: &str| all.iter().find(|change| change.key.ends_with(key)).unwrap().after.clone();
        assert_eq!((after(".position_m"), after(".world_from_camera_deg")), (None, None));
        assert!(after(".n_from_camera_m").is_some() && after(".n_from_camera_deg").is_some());
        // Another lens: the camera pose becomes unknown.
        let all = changes(&RigFile::of(name).unwrap(), &Lens::simple([1280, 720], 700.0, 0.0), None);
        change_rig(name, folder.path(), &all).unwrap();
        let camera = RigConfig::load(name).unwrap().endoscope.unwrap().camera.unwrap();
        assert_eq!((camera.position_m, camera.checked_px, camera.p1), (None, None, 0.0));
        change_rig(name, folder.path(), &undone(&all)).unwrap();
        let camera = RigConfig::load(name).unwrap().endoscope.unwrap().camera.unwrap();
        assert!((camera.focal_px - 750.25).abs() < 1e-3 && camera.position_m.is_some());
        // A camera that did not exist before is removed again.
        let bare = folder.path().join("bare.toml");
        std::fs::write(&bare, text.split("[endoscope.camera]").next().unwrap()).unwrap();
        let bare = bare.to_str().unwrap();
        let all = changes(&RigFile::of(bare).unwrap(), &lens, None);
        change_rig(bare, folder.path(), &all).unwrap();
        change_rig(bare, folder.path(), &undone(&all)).unwrap();
        assert_eq!(RigConfig::load(bare).unwrap().endoscope.unwrap().camera, None);
    }
}
