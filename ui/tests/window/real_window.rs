//! Tests of the real window on a real X server without a screen: it opens, draws and closes.
#![cfg(target_os = "linux")]
use std::{collections::HashMap, process::Stdio, thread, time::Duration};

use crate::server::{Xvfb, wait_until};

#[test]
fn the_window_opens_shows_changing_frames_and_closes() {
    let _alone = nima_testing::real_time::alone();
    let Some(x) = Xvfb::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own.png");
    let mut nima = x
        .command(env!("CARGO_BIN_EXE_nima"))
        .env("XDG_RUNTIME_DIR", folder.path())
        .env("NIMA_DATA_DIR", folder.path())
        .args(["console", "--exit-after", "8", "--screenshot"])
        .arg(&own)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    wait_until("the window", || x.window_is_open());
    thread::sleep(Duration::from_secs(4));
    let root = folder.path().join("root.png");
    assert!(x.command("import").args(["-window", "root"]).arg(&root).status().unwrap().success());
    assert!(nima.wait().unwrap().success(), "the console closes by itself with success");
    for image in [root, own] {
        let (colours, commonest) = colours(&image);
        println!("{}: {colours} colours, the commonest on {:.0} % of the picture", image.display(), commonest * 100.0);
        assert!(colours > 500 && commonest < 0.8, "{}: blank or nearly so", image.display());
    }
}

#[test]
fn a_window_that_is_asked_to_end_writes_its_figures_and_closes() {
    let _alone = nima_testing::real_time::alone();
    let Some(x) = Xvfb::start() else { return };
    for signal in ["-TERM", "-HUP"] {
        let folder = tempfile::tempdir().unwrap();
        let figures = folder.path().join("summary.json");
        let mut nima = x
            .command(env!("CARGO_BIN_EXE_nima"))
            .env("XDG_RUNTIME_DIR", folder.path())
            .env("NIMA_DATA_DIR", folder.path())
            .args(["console", "--summary"])
            .arg(&figures)
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        wait_until("the window", || x.window_is_open());
        thread::sleep(Duration::from_secs(1));
        assert!(x.command("kill").args([signal, &nima.id().to_string()]).status().unwrap().success());
        assert!(nima.wait().unwrap().success(), "{signal}");
        let figures: serde_json::Value = serde_json::from_slice(&std::fs::read(&figures).unwrap()).unwrap();
        assert!(figures["final_state"].is_string() && figures["ticks"].as_u64() > Some(0), "{signal}: {figures}");
        wait_until("no window", || !x.window_is_open());
    }
}

/// Returns the number of colours of an image, and fraction of the most common one.
fn colours(path: &std::path::Path) -> (usize, f64) {
    let image = image::open(path).unwrap().to_rgb8();
    let mut counts: HashMap<[u8; 3], u32> = HashMap::new();
    for pixel in image.pixels() {
        *counts.entry(pixel.0).or_default() += 1;
    }
    let commonest = counts.values().copied().max().unwrap_or(0);
    (counts.len(), f64::from(commonest) / f64::from(image.width() * image.height()))
}
