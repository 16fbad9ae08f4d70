//! The endoscope image on the surgeon's monitor. It has no effect on the loop.

use nalgebra::Vector3;
use nima_core::{
    limits::{BASELINE_M, DISTORTION},
    units,
};
use serde::{Deserialize, Serialize};

use super::{ConfigError, Ranges};

/// Source of the image, and pose of the endoscope's camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndoscopeConfig {
    /// Motion JPEG over HTTP (`http://HOST:PORT/PATH`), H.264 over RTSP (`rtsp://HOST/PATH`), a camera of this computer (`/dev/video0`), or the
    /// path of a `.mjpeg`, a folder of JPEGs or a JPEG.
    pub url: String,
    /// Clockwise rotation of the image for the screen, degrees: 0, 90, 180 or 270.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rotation_deg: u16,
    /// Swaps left and right on the screen, before the rotation.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mirror: bool,
    /// Margins removed at the left, top, right and bottom of the unmodified image, px.
    #[serde(default, skip_serializing_if = "is_whole")]
    pub crop_px: [usize; 4],
    /// Whether sessions contain the images, unmodified.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub record: bool,
    /// For an image with two halves side by side, from a left and a right lens: the initial view. Without it, the image
    /// comes from one lens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<StereoView>,
    /// Distance of the right lens to the right of the left one, m; without it no forces are drawn into the right half.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub baseline_m: Option<f64>,
    /// The camera (for two lenses, the left one); without it, no forces are drawn into the image.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<EndoscopeCamera>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StereoView {
    Left,
    Right,
    Both,
}

impl Default for EndoscopeConfig {
    fn default() -> Self {
        Self {
            url: String::new(),
            rotation_deg: 0,
            mirror: false,
            crop_px: [0; 4],
            record: true,
            view: None,
            baseline_m: None,
            camera: None,
        }
    }
}

fn is_whole(crop_px: &[usize; 4]) -> bool {
    *crop_px == [0; 4]
}

const fn yes() -> bool {
    true
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
const fn is_yes(value: &bool) -> bool {
    *value
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
const fn is_zero(value: &u16) -> bool {
    *value == 0
}

/// A pinhole camera with distortion, and its position in the workspace once it is known. Its frame: x to the right of
/// the image, y down, z away from the lens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndoscopeCamera {
    /// Width and height of the image, px.
    pub size_px: [usize; 2],
    pub focal_px: f64,
    /// Vertical focal length, px, if the pixels are not square.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub focal_y_px: Option<f64>,
    /// Intersection of the lens axis with the image, px; by default the image centre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre_px: Option<[f64; 2]>,
    /// Radial distortion: the tangent `t` of the angle from the axis appears at `t (1 + k1 t^2)`.
    #[serde(default)]
    pub k1: f64,
    /// The next radial term, with `t^4`.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub k2: f64,
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub p1: f64,
    /// Tangential distortion, horizontal.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub p2: f64,
    /// Position of the lens in the workspace, m; without it no forces are drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_m: Option<Vector3<f64>>,
    /// Roll, pitch, yaw of the camera's frame in the workspace, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world_from_camera_deg: Option<Vector3<f64>>,
    /// Position of the lens in the frame of the endoscope's marker (`devices.endoscope`), m: the camera then follows
    /// the endoscope.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub n_from_camera_m: Option<Vector3<f64>>,
    /// Roll, pitch, yaw of the camera's frame in the marker's frame, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub n_from_camera_deg: Option<Vector3<f64>>,
    /// Error with which touched points appear in the image, px: root mean square of held-out points, measured by the
    /// wizard.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checked_px: Option<f64>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_nothing(value: &f64) -> bool {
    *value == 0.0
}

impl EndoscopeConfig {
    pub(super) fn check(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        let named = if self.url.trim().is_empty() { 0.0 } else { 1.0 };
        ranges.check(
            "endoscope.url (number of addresses)",
            named,
            named > 0.0,
            "1: http://HOST:PORT/PATH, or a file",
        )?;
        let turn = self.rotation_deg;
        let turns = matches!(turn, 0 | 90 | 180 | 270);
        ranges.check("endoscope.rotation_deg", f64::from(turn), turns, "0, 90, 180 or 270")?;
        let size_px = self.camera.map(|camera| camera.size_px);
        let [left, top, right, bottom] = self.crop_px.map(|edge| edge as f64);
        // Without a size, use the size of the largest possible image.
        let [width, height] = size_px.unwrap_or([4096; 2]).map(|side| side as f64);
        let leaves = left + right <= 0.9 * width && top + bottom <= 0.9 * height;
        let max = left.max(top).max(right).max(bottom);
        ranges.check(
            "endoscope.crop_px",
            max,
            leaves,
            "[left, top, right, bottom] that leave at least a tenth of the image",
        )?;
        if let Some(baseline_m) = self.baseline_m {
            let place = "endoscope.baseline_m";
            ranges.within(place, baseline_m, &BASELINE_M)?;
            let halves = if self.view.is_some() { 2.0 } else { 1.0 };
            ranges.check(
                "endoscope.view (halves, with baseline_m)",
                halves,
                halves > 1.0,
                "2: view = \"left\", \"right\" or \"both\"",
            )?;
        }
        self.camera.as_ref().map_or(Ok(()), |camera| camera.check(ranges))
    }
}

impl EndoscopeCamera {
    fn check(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        let [width, height] = self.size_px.map(|side| side as f64);
        let sides = |side: f64| (16.0..=4096.0).contains(&side);
        ranges.check("endoscope.camera.size_px", width, sides(width) && sides(height), "16 to 4096 px each")?;
        let focals = [self.focal_px, self.focal_y_px.unwrap_or(self.focal_px)];
        for (key, focal) in ["endoscope.camera.focal_px", "endoscope.camera.focal_y_px"].into_iter().zip(focals) {
            ranges.check(key, focal, (1.0..=1e5).contains(&focal), "1 to 100000 px")?;
        }
        let [x, y] = self.centre_px.unwrap_or([0.5 * width, 0.5 * height]);
        let inside = (0.0..=width).contains(&x) && (0.0..=height).contains(&y);
        ranges.check("endoscope.camera.centre_px", x, inside, "within the image")?;
        ranges.within("endoscope.camera.k1", self.k1, &DISTORTION)?;
        ranges.check("endoscope.camera.k2", self.k2, (-5.0..=5.0).contains(&self.k2), "-5 to 5")?;
        for (key, value) in [("endoscope.camera.p1", self.p1), ("endoscope.camera.p2", self.p2)] {
            ranges.check(key, value, (-0.5..=0.5).contains(&value), "-0.5 to 0.5")?;
        }
        if let Some(checked_px) = self.checked_px {
            ranges.not_negative("endoscope.camera.checked_px", checked_px)?;
        }
        self.check_place(ranges)
    }

    fn check_place(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        let in_world = [
            ("endoscope.camera.position_m", self.position_m),
            ("endoscope.camera.world_from_camera_deg", self.world_from_camera_deg),
        ];
        let on_marker = [
            ("endoscope.camera.n_from_camera_m", self.n_from_camera_m),
            ("endoscope.camera.n_from_camera_deg", self.n_from_camera_deg),
        ];
        let wholes = [
            "2: position_m and world_from_camera_deg, or neither",
            "2: n_from_camera_m and n_from_camera_deg, or neither",
        ];
        for (parts, whole) in [in_world, on_marker].into_iter().zip(wholes) {
            let count = parts.iter().filter(|(_, part)| part.is_some()).count();
            ranges.check("endoscope.camera (parts of its pose)", count as f64, count != 1, whole)?;
            for (key, part) in parts {
                ranges.finite(key, &part.unwrap_or_default())?;
            }
        }
        for (key, place_m, max_m) in
            [(in_world[0].0, self.position_m, 5.0), (on_marker[0].0, self.n_from_camera_m, 1.0)]
        {
            let distance_m = place_m.unwrap_or_default().norm();
            ranges.check(key, distance_m, distance_m <= max_m, units::length_remedy(distance_m, max_m))?;
        }
        let places = [in_world, on_marker].iter().filter(|parts| parts[0].1.is_some()).count();
        let one = "1: in the workspace, or on the endoscope's marker";
        ranges.check("endoscope.camera (poses)", places as f64, places < 2, one)
    }
}

#[cfg(test)]
mod tests {
    use crate::config::RigConfig;

    const WHOLE: &str = "\n[endoscope]\nurl = \"http://127.0.0.1:47150/\"\nrotation_deg = 90\nmirror = true\nrecord = false\nview = \"both\"\nbaseline_m = 0.004\n\n[endoscope.camera]\n\
        size_px = [1280, 720]\nfocal_px = 726.6\nk1 = -0.3\nposition_m = [0.0, -0.1, 0.09]\nworld_from_camera_deg = [-131.0, 0.0, 0.0]\n";

    fn rig(more: &str) -> Result<RigConfig, String> {
        let text = include_str!("../../../config/rigs/simulated.toml").to_owned() + more;
        RigConfig::parse("rig.toml".as_ref(), &text).map_err(|error| error.to_string())
    }

    #[test]
    fn a_rig_names_its_picture_and_is_written_as_it_was_read() {
        assert_eq!(rig("").unwrap().endoscope, None);
        let rig = rig(WHOLE).unwrap();
        let endoscope = rig.endoscope.as_ref().unwrap();
        assert!(!endoscope.record && endoscope.mirror && endoscope.rotation_deg == 90 && endoscope.camera.is_some());
        assert_eq!((endoscope.view, endoscope.baseline_m), (Some(super::StereoView::Both), Some(0.004)));
        let again = RigConfig::parse("rig.toml".as_ref(), &toml::to_string(&rig).unwrap()).unwrap();
        assert_eq!(again, rig);
        assert_eq!(rig.anonymous().endoscope, None, "its address reveals its location");
    }

    #[test]
    fn its_pictures_are_recorded_unless_the_rig_file_says_otherwise() {
        let rig = rig("\n[endoscope]\nurl = \"film.mjpeg\"\n").unwrap();
        assert!(rig.endoscope.as_ref().unwrap().record);
        assert!(!toml::to_string(&rig).unwrap().contains("record = "));
    }

    #[test]
    fn what_cannot_be_is_named() {
        for (from, to, word) in [
            ("http://127.0.0.1:47150/", " ", "endoscope.url"),
            ("= 90", "= 45", "0, 90, 180 or 270"),
            ("[1280, 720]", "[0, 720]", "16 to 4096"),
            ("726.6", "nan", "focal_px"),
            ("-0.3", "7.0", "k1 is 7"),
            ("k1 = -0.3", "k2 = 9.0", "k2 is 9"),
            ("k1 = -0.3", "focal_y_px = 0.0", "focal_y_px is 0"),
            ("k1 = -0.3", "checked_px = -1.0", "checked_px"),
            ("position_m = [0.0, -0.1, 0.09]", "", "position_m and world_from_camera_deg"),
            ("position_m", "n_from_camera_m", "position_m and world_from_camera_deg"),
            ("k1 = -0.3", "n_from_camera_m = [0.0, 0.0, 0.1]", "n_from_camera_m and n_from_camera_deg"),
            ("k1 = -0.3", "n_from_camera_m = [0.0, 0.0, 0.1]\nn_from_camera_deg = [0.0, 0.0, 0.0]", "poses"),
            (
                "position_m = [0.0, -0.1, 0.09]\nworld_from_camera_deg",
                "n_from_camera_m = [0.0, 0.0, 0.1]\nn_from_camera_deg",
                "[devices.endoscope]",
            ),
            ("mirror", "mirrors", "mirrors"),
            ("\"both\"", "\"middle\"", "middle"),
            ("0.004", "4.0", "baseline_m is 4"),
            ("view = \"both\"\n", "", "endoscope.view"),
            ("record = false", "crop_px = [700, 0, 700, 0]", "leave at least a tenth"),
            ("record = false", "crop_px = [1, 2, 3]", "invalid length 3"),
        ] {
            let report = rig(&WHOLE.replace(from, to)).unwrap_err();
            assert!(report.contains(word) && !report.contains('\n'), "{to}: {report}");
        }
    }
}
