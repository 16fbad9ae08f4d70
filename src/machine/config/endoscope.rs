//! The endoscope's picture on the surgeon's monitor. Nothing of it touches the loop.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{ConfigError, Ranges};

/// Where the picture comes from, and where the endoscope looks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Endoscope {
    /// Motion JPEG over HTTP (`http://HOST:PORT/PATH`), or the path of a `.mjpeg`, a folder of JPEGs or a JPEG.
    pub url: String,
    /// How far the picture is turned clockwise for the screen, degrees: 0, 90, 180 or 270.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rotation_deg: u16,
    /// Left and right are exchanged on the screen, before it is turned.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mirror: bool,
    /// What is cut off at the left, top, right and bottom of the picture as it comes, px.
    #[serde(default, skip_serializing_if = "is_whole")]
    pub crop_px: [usize; 4],
    /// Whether sessions have its pictures, as they come.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub record: bool,
    /// The camera; without it no forces are drawn into the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<EndoscopeCamera>,
}

impl Default for Endoscope {
    /// Without an address.
    fn default() -> Self {
        Self { url: String::new(), rotation_deg: 0, mirror: false, crop_px: [0; 4], record: true, camera: None }
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

/// A pinhole with radial distortion at a place of the workspace. Its frame: x to the right of the picture, y down, z away from the lens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndoscopeCamera {
    /// Width and height of the picture, px.
    pub size_px: [usize; 2],
    /// Focal length, px.
    pub focal_px: f64,
    /// Where the lens's axis meets the picture, px; its middle if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre_px: Option<[f64; 2]>,
    /// Radial distortion: the tangent `t` of the angle from the axis is seen at `t (1 + k1 t^2)`.
    #[serde(default)]
    pub k1: f64,
    /// Place of the lens in the workspace, m.
    pub position_m: Vector3<f64>,
    /// Roll, pitch, yaw of the camera's frame in the workspace, degrees.
    pub world_from_camera_deg: Vector3<f64>,
}

impl Endoscope {
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
        // Without a size, what the largest picture has.
        let [width, height] = size_px.unwrap_or([4096; 2]).map(|side| side as f64);
        let leaves = left + right <= 0.9 * width && top + bottom <= 0.9 * height;
        let most = left.max(top).max(right).max(bottom);
        ranges.check(
            "endoscope.crop_px",
            most,
            leaves,
            "[left, top, right, bottom] that leave a tenth of the picture",
        )?;
        let Some(camera) = &self.camera else { return Ok(()) };
        let sides = |side: f64| (16.0..=4096.0).contains(&side);
        ranges.check("endoscope.camera.size_px", width, sides(width) && sides(height), "16 to 4096 px each")?;
        let focal = camera.focal_px;
        ranges.check("endoscope.camera.focal_px", focal, (1.0..=1e5).contains(&focal), "1 to 100000 px")?;
        let [x, y] = camera.centre_px.unwrap_or([0.5 * width, 0.5 * height]);
        let inside = (0.0..=width).contains(&x) && (0.0..=height).contains(&y);
        ranges.check("endoscope.camera.centre_px", x, inside, "within the picture")?;
        ranges.check("endoscope.camera.k1", camera.k1, (-2.0..=2.0).contains(&camera.k1), "-2 to 2")?;
        ranges.finite("endoscope.camera.position_m", &camera.position_m)?;
        ranges.finite("endoscope.camera.world_from_camera_deg", &camera.world_from_camera_deg)
    }
}

#[cfg(test)]
mod tests {
    use crate::config::RigConfig;

    const WHOLE: &str = "\n[endoscope]\nurl = \"http://127.0.0.1:47150/\"\nrotation_deg = 90\nmirror = true\nrecord = false\n\n[endoscope.camera]\n\
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
        let again = RigConfig::parse("rig.toml".as_ref(), &toml::to_string(&rig).unwrap()).unwrap();
        assert_eq!(again, rig);
        assert_eq!(rig.anonymous().endoscope, None, "its address tells where it is");
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
            ("mirror", "mirrors", "mirrors"),
            ("record = false", "crop_px = [700, 0, 700, 0]", "leave a tenth"),
            ("record = false", "crop_px = [1, 2, 3]", "invalid length 3"),
        ] {
            let told = rig(&WHOLE.replace(from, to)).unwrap_err();
            assert!(told.contains(word) && !told.contains('\n'), "{to}: {told}");
        }
    }
}
