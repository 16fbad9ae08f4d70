//! `nima calibrate camera` and `nima calibrate board`, as a user types them.

use std::{
    path::Path,
    process::{Command, Output},
};

use nima_emulation::emulators::endoscope::held;
use nima_endoscope::{Checkerboard, Lens, board::Portrait, jpeg};
use nima_machine::config::{RigConfig, RigFile};
use serde_json::Value;

use crate::one_line;

fn nima(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nima")).args(arguments).output().unwrap()
}

fn lens() -> Lens {
    let mut lens = Lens::simple([640, 360], 370.0, -0.25);
    lens.centre_px.x += 7.0;
    lens.centre_px.y -= 5.0;
    lens
}

/// Creates a folder with images of a board at these poses of the emulator.
fn images(folder: &Path, poses: impl Iterator<Item = u32>) {
    let board = Checkerboard::new([9, 6], 0.01).unwrap();
    let portrait = Portrait::new(&lens());
    let mut hands = held(board, &lens());
    for number in poses {
        let greys = portrait.draw(&board, &hands(2.2 * f64::from(number) + 0.5));
        let rgb: Vec<u8> = greys.iter().flat_map(|grey| [*grey as u8; 3]).collect();
        std::fs::write(folder.join(format!("{number:02}.jpg")), jpeg::encode(&rgb, [640, 360], 92)).unwrap();
    }
}

#[test]
fn a_folder_of_pictures_gives_the_lens_and_changes_the_rig_file() {
    let folder = tempfile::tempdir().unwrap();
    images(folder.path(), 0..18);
    // This image shows no board: it must be reported and left out.
    std::fs::write(folder.path().join("99.jpg"), jpeg::encode(&vec![120; 3 * 640 * 360], [640, 360], 90)).unwrap();
    let rig = folder.path().join("rig.toml");
    let mut file = RigFile::of("simulated").unwrap();
    file.set("endoscope.url", "http://127.0.0.1:1/");
    file.save(&rig).unwrap();
    let from = folder.path().to_str().unwrap();
    let to = rig.to_str().unwrap();
    let output = nima(&["calibrate", "camera", from, "--square-mm", "10", "--out", to, "--json"]);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && errors.contains("99.jpg: no board detected"), "{errors}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["verdict"], "accepted", "{report}");
    assert!(report["lens"]["held_out_px"].as_f64().unwrap() < 0.3, "{report}");
    let camera = RigConfig::load(to).unwrap().endoscope.unwrap().camera.unwrap();
    let [x, y] = camera.centre_px.unwrap();
    for (found, real) in [(camera.focal_px, 370.0), (x, lens().centre_px.x), (y, lens().centre_px.y)] {
        assert!((found - real).abs() < 0.005 * 370.0, "{found} {real}");
    }
    assert_eq!((camera.size_px, camera.position_m), ([640, 360], None));
    let words = nima(&["calibrate", "camera", from]);
    let words = String::from_utf8(words.stdout).unwrap();
    assert!(words.starts_with("Accepted\n") && words.contains("px held out"), "{words}");
}

#[test]
fn what_cannot_be_used_is_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    images(folder.path(), 0..4);
    let from = folder.path().to_str().unwrap();
    let rig = folder.path().join("rig.toml");
    RigFile::of("simulated").unwrap().save(&rig).unwrap();
    let rig = rig.to_str().unwrap();
    for (arguments, word) in [
        (vec![from], "4 usable views of 8"),
        (vec![from, "--out", rig], "has no endoscope"),
        (vec![from, "--out", "/nowhere/rig.toml"], "is not a rig file"),
        (vec![from, "--board", "8x6"], "upside down"),
        (vec![from, "--square-mm", "0"], "0.5 to 200 mm"),
        (vec!["/nowhere"], "cannot read the images in /nowhere"),
        (vec![rig], "cannot read the images"),
        (vec!["http://127.0.0.1:1/"], "no response from"),
        (vec!["ftp://127.0.0.1/"], "not a valid image source"),
    ] {
        let output = nima(&[&["calibrate", "camera"], &arguments[..]].concat());
        let errors = one_line(&output);
        assert!(errors.contains(word), "{arguments:?}: {errors}");
    }
    assert!(RigConfig::load(rig).unwrap().endoscope.is_none());
    std::fs::write(folder.path().join("05.jpg"), b"no picture").unwrap();
    assert!(one_line(&nima(&["calibrate", "camera", from])).contains("05.jpg: it is not a JPEG"));
}

#[test]
fn a_board_is_drawn_for_a_printer() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("board.svg");
    let output = nima(&["calibrate", "board", "--board", "7x4", "--square-mm", "12.5", "--out", out.to_str().unwrap()]);
    assert!(output.status.success());
    let drawn = std::fs::read_to_string(&out).unwrap();
    assert!(drawn.contains("width=\"125mm\" height=\"87.5mm\""), "{drawn}");
    assert!(
        one_line(&nima(&["calibrate", "board", "--board", "7x5", "--out", "/tmp/none.svg"])).contains("upside down")
    );
}
