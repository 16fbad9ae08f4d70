//! `nima emulate endoscope`: an image of a scene whose hands perform their task in the air.
//!
//! Settings: `port`, `scene` (a name or a file), `rate_hz`, `k1` (radial distortion), `width` and `height` (px),
//! `quality` (of the JPEGs), `baseline_m` (of a second lens), `pipe` (a file or named pipe that also gets the images:
//! H.264 if it ends in `.h264`, else JPEGs); `board` (inner corners, as `9x6`) and `square_mm` show a calibration board
//! instead of the scene.

use std::io::{Error, ErrorKind, Result};

use nima_core::limits::{BASELINE_M, DISTORTION};
use nima_endoscope::{Checkerboard, board::BoardCorners};
use nima_machine::rig::Side;
use nima_simulation::{
    Hand,
    camera::{camera_of, usual},
    scene::Scene,
};

use super::{EmulatedEndoscope, EndoscopeBody, EndoscopeInstrument, held};
use crate::emulators::{Emulator, EmulatorSettings, standalone::unusable};

/// Default port.
const PORT: u16 = 47_150;
/// Side of a square of a board, mm.
const SQUARE_MM: f64 = 10.0;
/// Step of the hands, s, and maximum time made up after a pause.
const STEP_S: f64 = 1e-3;
/// Otherwise a paused process would move the hands at many times their speed.
const CATCH_UP_S: f64 = 0.5;
const SIDES_PX: std::ops::RangeInclusive<usize> = 64..=4096;

pub(in crate::emulators) fn endoscope(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let name = settings.get_or("scene", "bimanual".to_owned())?;
    let scene = Scene::load(&name).map_err(|error| Error::new(ErrorKind::InvalidInput, error))?;
    let mut camera = usual(&scene);
    camera.k1 = settings.get_or("k1", camera.k1)?;
    let [width, height] = camera.size_px;
    camera.size_px = [settings.get_or("width", width)?, settings.get_or("height", height)?];
    if let Some(side) = camera.size_px.iter().find(|side| !SIDES_PX.contains(side)) {
        return Err(unusable("width or height", side, "give 64 to 4096"));
    }
    // Keep the field of view at any image size.
    camera.focal_px *= camera.size_px[1] as f64 / height as f64;
    if !DISTORTION.contains(camera.k1) {
        return Err(unusable("k1", camera.k1, &format!("give {DISTORTION}")));
    }
    let usual = EmulatedEndoscope::of(&scene, settings.get_or("port", PORT)?);
    let rate_hz = settings.get_or("rate_hz", usual.rate_hz)?;
    if !(1.0..=120.0).contains(&rate_hz) {
        return Err(unusable("rate_hz", rate_hz, "give 1 to 120"));
    }
    let quality = settings.get_or("quality", usual.quality)?;
    if !(1..=100).contains(&quality) {
        return Err(unusable("quality", quality, "give 1 to 100"));
    }
    let baseline_m = settings.get("baseline_m")?;
    if let Some(baseline_m) = baseline_m.filter(|baseline_m| !BASELINE_M.contains(*baseline_m)) {
        return Err(unusable("baseline_m", baseline_m, &format!("give {BASELINE_M}")));
    }
    let pipe = settings.get::<std::path::PathBuf>("pipe")?;
    if let Some(path) = &pipe {
        super::pipe::check(path, rate_hz)?;
    }
    let emulated = EmulatedEndoscope { rate_hz, camera: camera_of(&camera), baseline_m, quality, pipe, ..usual };
    if let Some(board) = board(settings)? {
        let hands = held(board, &emulated.camera.lens);
        return Ok(emulated.with_board(board, hands));
    }
    Ok(emulated.with(&scene, in_the_air(&scene)))
}

/// Returns the board to be shown, if any.
fn board(settings: &EmulatorSettings) -> Result<Option<Checkerboard>> {
    let square_mm = settings.get_or("square_mm", SQUARE_MM)?;
    let Some(named) = settings.get::<String>("board")? else { return Ok(None) };
    let made =
        named.parse::<BoardCorners>().and_then(|BoardCorners(corners)| Checkerboard::new(corners, square_mm * 1e-3));
    made.map(Some).map_err(|error| unusable("board", &named, &error.to_string()))
}

/// Returns the hands of a scene perform their task without contact.
pub(super) fn in_the_air(scene: &Scene) -> EndoscopeBody {
    let sides: Vec<Scene> = Side::ALL.into_iter().filter_map(|side| scene.of_side(side)).collect();
    let mut hands: Vec<Hand> = sides.iter().map(Hand::new).collect();
    let mut reached_s = 0.0;
    Box::new(move |now_s| {
        reached_s = f64::max(reached_s, now_s - CATCH_UP_S);
        while reached_s < now_s {
            reached_s += STEP_S;
            for hand in &mut hands {
                hand.advance(STEP_S, &nalgebra::Vector3::zeros());
            }
        }
        let seen = hands.iter().zip(&sides);
        seen.map(|(hand, scene)| EndoscopeInstrument { tip_m: hand.position_m(), trocar_m: scene.trocar_m }).collect()
    })
}
