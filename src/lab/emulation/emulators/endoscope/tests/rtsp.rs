//! The emulated endoscope as a network camera, with third-party programs at either end.

use std::{
    path::Path,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use nima_endoscope::{Damage, EndoscopeError, EndoscopeFeed, FrameFault, FrameHealth, time_code};
use nima_testing::{real_time, unjudged};

use super::{SQUARE_PX, every_fault_is_told, is_live, serve, time_us, until};
use crate::emulators::{EmulatedFault, EmulatorThread};

/// Returns the RTSP address of the same emulator.
fn rtsp(serving: &EmulatorThread) -> String {
    format!("rtsp{}stream", serving.endpoint.strip_prefix("http").unwrap())
}

fn feed(serving: &EmulatorThread) -> EndoscopeFeed {
    EndoscopeFeed::start(rtsp(serving).parse().unwrap(), Some([640, 360]), || {}).unwrap()
}

#[test]
fn a_stream_is_shown_and_every_fault_in_it_is_told_by_its_name() {
    let serving = serve();
    let feed = feed(&serving);
    every_fault_is_told(&serving, &feed, |fault| match fault {
        EmulatedFault::Torn => {
            Some(|standing| matches!(standing, FrameHealth::Wrong(FrameFault::Damaged(Damage::Undecodable { .. }))))
        }
        EmulatedFault::OtherFormat => Some(
            |standing| matches!(standing, FrameHealth::Lost(EndoscopeError::OtherFormat { found, .. }) if found == "h265"),
        ),
        _ => None,
    });
    let look = until(&feed, "live", |look| {
        is_live(look) && look.image.as_ref().is_some_and(|(_, image)| time_us(image).is_some())
    });
    assert_eq!(look.image.unwrap().1.size_px, [640, 360]);
}

#[test]
fn a_cut_is_mended_within_a_second() {
    real_time::judged(|| {
        let _alone = real_time::alone();
        let serving = serve();
        let feed = feed(&serving);
        until(&feed, "live", |look| is_live(look) && look.rate_hz > 25.0);
        serving.faults.set(EmulatedFault::Disconnect);
        until(&feed, "lost", |look| matches!(look.standing, FrameHealth::Lost(_)));
        thread::sleep(Duration::from_millis(300));
        serving.faults.set(EmulatedFault::None);
        let begin = Instant::now();
        until(&feed, "live", is_live);
        assert!(begin.elapsed() < Duration::from_secs(1), "{:?}", begin.elapsed());
    });
}

#[test]
fn a_wrong_path_is_told() {
    let serving = serve();
    let address = rtsp(&serving).replace("stream", "nothing").parse().unwrap();
    let feed = EndoscopeFeed::start(address, None, || {}).unwrap();
    until(&feed, "404", |look| matches!(look.standing, FrameHealth::Lost(EndoscopeError::Refused { status: 404, .. })));
}

/// Waits until a feed from this address is live with images of this size.
fn plays(address: &str, size_px: [usize; 2]) {
    let feed = EndoscopeFeed::start(address.parse().unwrap(), Some(size_px), || {}).unwrap();
    let look = until(&feed, address, is_live);
    assert_eq!(look.image.unwrap().1.size_px, size_px);
}

#[test]
#[ignore = "needs ffmpeg: set NIMA_FFMPEG to its program"]
fn ffmpeg_plays_our_streams_and_we_play_those_of_ffmpeg() {
    let Ok(ffmpeg) = std::env::var("NIMA_FFMPEG") else {
        unjudged::left_out("NIMA_FFMPEG names no program");
        return;
    };
    let serving = serve();
    let read = Command::new(&ffmpeg)
        .args(["-v", "error", "-rtsp_transport", "tcp", "-i", &rtsp(&serving), "-frames:v", "15"])
        .args(["-f", "rawvideo", "-pix_fmt", "gray", "-"])
        .output()
        .unwrap();
    let images: Vec<_> = read.stdout.chunks_exact(640 * 360).collect();
    let codes: Vec<_> = images.iter().map(|grey| time_code::read(SQUARE_PX, |x, y| grey[640 * y + x])).collect();
    assert!(codes.len() == 15 && codes.is_sorted(), "{codes:?} {}", String::from_utf8_lossy(&read.stderr));
    assert!(codes.iter().all(Option::is_some), "{codes:?}");
    println!("ffmpeg has read 15 pictures over RTSP");

    let folder = tempfile::tempdir().unwrap();
    let test = ["-v", "error", "-f", "lavfi", "-i", "testsrc2=size=640x360:rate=30"];
    let file = folder.path().join("test.h264");
    let wrote = Command::new(&ffmpeg)
        .args(test)
        .args(["-t", "3", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-bf", "0"])
        .arg(&file)
        .status()
        .unwrap();
    assert!(wrote.success());
    plays(file.to_str().unwrap(), [640, 360]);
    println!("H.264 in a file that ffmpeg wrote is played");
    for (option, what) in [("mjpeg", "motion JPEG"), ("h264", "H.264")] {
        // Raw streams through named pipes.
        let pipe = folder.path().join("pipe").with_extension(option);
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let mut writer = Command::new(&ffmpeg)
            .args(["-v", "error", "-y", "-re"])
            .args(&test[2..])
            .args(["-bf", "0", "-pix_fmt", if option == "mjpeg" { "yuvj420p" } else { "yuv420p" }, "-f", option])
            .arg(&pipe)
            .stdin(Stdio::null())
            .spawn()
            .unwrap();
        plays(pipe.to_str().unwrap(), [640, 360]);
        writer.kill().unwrap();
        writer.wait().unwrap();
        println!("{what} through a pipe that ffmpeg writes is played");
    }
    http(&ffmpeg, &test);
}

/// ffmpeg as a camera with motion JPEG over HTTP.
fn http(ffmpeg: &str, test: &[&str]) {
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let address = format!("http://127.0.0.1:{port}/stream");
    let mut server = Command::new(ffmpeg)
        .args(["-v", "error", "-re"])
        .args(&test[2..])
        .args(["-c:v", "mjpeg", "-pix_fmt", "yuvj420p", "-f", "mpjpeg"])
        .args(["-content_type", "multipart/x-mixed-replace;boundary=ffmpeg", "-listen", "1", &address])
        .stdin(Stdio::null())
        .spawn()
        .unwrap();
    plays(&address, [640, 360]);
    server.kill().unwrap();
    server.wait().unwrap();
    println!("motion JPEG that ffmpeg serves is played");
}

#[test]
fn a_stream_of_h264_is_written_for_who_reads_raw_ones() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stream.h264");
    let _serving = super::serve_with(Some(path.clone()));
    let begin = Instant::now();
    while std::fs::metadata(&path).map_or(0, |about| about.len()) < 50_000 {
        assert!(begin.elapsed() < Duration::from_secs(30));
        thread::sleep(Duration::from_millis(10));
    }
    let copy = folder.path().join("copy.h264");
    std::fs::copy(&path, &copy).unwrap();
    has_time_codes(&copy);
}

fn has_time_codes(path: &Path) {
    let feed = EndoscopeFeed::start(path.to_str().unwrap().parse().unwrap(), None, || {}).unwrap();
    until(&feed, "a time code", |look| look.image.as_ref().is_some_and(|(_, image)| time_us(image).is_some()));
}
