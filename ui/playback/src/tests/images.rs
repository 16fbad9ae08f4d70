//! The recorded image of a moment, identified by a time code in the image.

use std::sync::Arc;

use nima_endoscope::{DecodedImage, jpeg, time_code};
use nima_recording::{
    messages::foxglove::{CompressedImage, CompressedVideo, encoding, timestamp},
    session::{Encoding, SessionWriter},
};
use nima_screen::theme;
use nima_session::images::{IMAGE_TOPIC, VIDEO_TOPIC};
use prost::Message as _;

use super::*;

const SQUARE_PX: usize = 8;
const SIZE_PX: [usize; 2] = [256, 24];
/// Time between two images, ns, and the time of the last one, s.
const PERIOD_NS: u64 = 33_333_333;
const STOPS_S: f64 = 4.0;

/// Returns an image with this time (us) as code.
fn pixels(time_us: u64) -> Vec<u8> {
    let mut rgb = vec![120; 3 * SIZE_PX[0] * SIZE_PX[1]];
    time_code::draw(time_us, SQUARE_PX, &mut rgb, SIZE_PX[0]);
    rgb
}

fn code_of(image: &DecodedImage) -> u64 {
    let brightness = |x: usize, y: usize| image.rgba[4 * (image.size_px[0] * y + x) + 1];
    time_code::read(SQUARE_PX, brightness).expect("a sound code")
}

/// Returns the session with JPEGs as a camera would have sent them, up to 4 s, one of them damaged; returns its start,
/// ns.
fn with_images(from: &Path, to: &Path, damaged: u64) -> u64 {
    with_messages(from, to, IMAGE_TOPIC, encoding::<CompressedImage>(), |number, time_ns| {
        let mut data = jpeg::encode(&pixels(time_ns / 1000), SIZE_PX, 90);
        if number == damaged {
            data.truncate(data.len() / 2);
        }
        let timestamp = Some(timestamp(time_ns));
        let frame_id = "endoscope".to_owned();
        CompressedImage { timestamp, data: data.into(), format: "jpeg".to_owned(), frame_id }.encode_to_vec()
    })
}

/// Like [`with_images`], as a stream whose images come from `coded`.
fn with_stream(from: &Path, to: &Path, mut coded: impl FnMut(u64, u64) -> Vec<u8>) -> u64 {
    with_messages(from, to, VIDEO_TOPIC, encoding::<CompressedVideo>(), |number, time_ns| {
        let timestamp = Some(timestamp(time_ns));
        let frame_id = "endoscope".to_owned();
        let data = coded(number, time_ns).into();
        CompressedVideo { timestamp, frame_id, data, format: "h264".to_owned() }.encode_to_vec()
    })
}

/// Returns the session with these image messages, by number and time; returns its start, ns.
fn with_messages(
    from: &Path,
    to: &Path,
    topic: &str,
    encoding: Encoding,
    mut message_of: impl FnMut(u64, u64) -> Vec<u8>,
) -> u64 {
    let reader = SessionReader::open(from).unwrap();
    let begin_ns = plot_channels::beginning_ns(&reader).unwrap();
    let mut writer = SessionWriter::create(to, "nima test").unwrap();
    for (name, entries) in reader.metadata().unwrap() {
        writer.metadata(&name, &entries).unwrap();
    }
    for one in reader.attachments() {
        writer.attachment(&one.name, &one.media_type, one.log_time_ns, &reader.attachment(one).unwrap()).unwrap();
    }
    let channel = writer.channel(topic, encoding).unwrap();
    let mut channels = std::collections::BTreeMap::new();
    for channel in reader.channels() {
        channels.insert(channel.id, writer.channel(&channel.topic, channel.encoding.clone()).unwrap());
    }
    let mut number = 0;
    for message in reader.messages(&[], 0..u64::MAX) {
        let message = message.unwrap();
        let time_ns = begin_ns + 5_000_000 + number * PERIOD_NS;
        if message.log_time_ns() >= time_ns && time_ns < begin_ns + (STOPS_S * 1e9) as u64 {
            writer.message(channel, time_ns, &message_of(number, time_ns)).unwrap();
            number += 1;
        }
        writer.message(channels[&message.channel()], message.log_time_ns(), message.data()).unwrap();
    }
    writer.finish().unwrap();
    begin_ns
}

/// Returns all texts in one frame of the image.
fn drawn(past: &mut Playback) -> String {
    let context = Context::default();
    theme::apply(&context);
    let eyes = &mut past.panels.eyes;
    let live = past.live.as_ref().unwrap();
    let mut output = context.run_ui(egui::RawInput::default(), |ui| eyes.ui(ui, live));
    output.textures_delta.clear();
    let mut all = String::new();
    output.shapes.iter().for_each(|clipped| texts(&clipped.shape, &mut all));
    all
}

/// Draws until the image of the moment on the screen is shown.
fn shown(past: &mut Playback) -> Option<Arc<DecodedImage>> {
    let began = Instant::now();
    loop {
        past.step(0.0, false);
        if past.live.is_some() {
            // A moment is found only if a frame has requested it.
            drawn(past);
            if let Some(found) = past.panels.eyes.projected(past.shown_s()) {
                return found.0;
            }
        }
        assert!(began.elapsed() < TIMEOUT, "no picture at {} s: {:?}", past.shown_s(), past.panels.eyes);
        thread::sleep(Duration::from_millis(1));
    }
}

/// Returns the time between the moment on the screen and the code in its image, s.
fn behind_s(past: &mut Playback, begin_ns: u64) -> Option<f64> {
    let image = shown(past)?;
    Some(past.shown_s() - (code_of(&image) as f64 - begin_ns as f64 / 1e3) / 1e6)
}

/// Checks that no image is older than its frame, at these moments (s) and in one second of playback.
fn in_time_at_each_and_while_played(past: &mut Playback, begin_ns: u64, moments_s: &[f64]) {
    let frame_s = PERIOD_NS as f64 / 1e9;
    let judge = |past: &mut Playback| {
        let behind_s = behind_s(past, begin_ns).unwrap();
        let is_in_time = (-1e-5..frame_s + 1e-5).contains(&behind_s);
        assert!(is_in_time, "at {} s the picture is {behind_s} s old", past.shown_s());
    };
    for t_s in moments_s {
        settled(past, *t_s);
        judge(past);
    }
    settled(past, 2.5);
    past.toggle();
    for _ in 0..50 {
        let before = past.shown_s();
        past.step(0.02, false);
        until(past, "went on", |past| past.shown_s() > before);
        judge(past);
    }
}

#[test]
fn the_picture_of_a_moment_is_that_of_the_frame_before_it_also_while_it_is_played() {
    let folder = tempfile::tempdir().unwrap();
    let [path, filmed] = ["session.mcap", "filmed.mcap"].map(|name| folder.path().join(name));
    record(&path, "bimanual", 6.5, |_| None);
    let begin_ns = with_images(&path, &filmed, 45);
    let mut past = open(&filmed);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    assert!(past.panels.eyes.is_on());
    in_time_at_each_and_while_played(&mut past, begin_ns, &[3.9, 0.005, 0.8, 2.0005, 1.234, 0.039, 3.0]);
    past.toggle();
    // A damaged image is reported, and the last intact one remains.
    let frame_s = PERIOD_NS as f64 / 1e9;
    settled(&mut past, 0.005 + 45.5 * frame_s);
    let behind_s = behind_s(&mut past, begin_ns).unwrap();
    assert!((frame_s..2.0 * frame_s).contains(&behind_s), "{behind_s} s");
    // An image frozen in the recording is frozen in playback; after two seconds without images, none is shown.
    settled(&mut past, 5.0);
    assert!((0.99..1.04).contains(&self::behind_s(&mut past, begin_ns).unwrap()));
    settled(&mut past, 6.3);
    assert!(shown(&mut past).is_none());
}

/// Returns an open, read session of 4.5 s with a stream, and its start, ns.
fn streamed(folder: &Path, coded: impl FnMut(u64, u64) -> Vec<u8>) -> (Playback, u64) {
    let [path, filmed] = ["session.mcap", "filmed.mcap"].map(|name| folder.join(name));
    record(&path, "bimanual", 4.5, |_| None);
    let begin_ns = with_stream(&path, &filmed, coded);
    let mut past = open(&filmed);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    (past, begin_ns)
}

#[cfg(feature = "h264")]
#[test]
fn a_recorded_stream_is_shown_at_every_moment_and_while_it_is_played() {
    let folder = tempfile::tempdir().unwrap();
    let mut encoder = nima_endoscope::h264::H264Encoder::new(30.0).unwrap();
    let coded = |number: u64, time_ns: u64| {
        encoder.encode(&pixels(time_ns / 1000), SIZE_PX, number.is_multiple_of(45)).unwrap()
    };
    let (mut past, begin_ns) = streamed(folder.path(), coded);
    assert!(past.panels.eyes.is_on());
    in_time_at_each_and_while_played(&mut past, begin_ns, &[3.9, 0.8, 0.805, 2.0005, 0.039, 0.09, 3.0, 2.96, 3.95]);
}

#[cfg(not(feature = "h264"))]
#[test]
fn a_recorded_stream_says_which_program_shows_it() {
    let folder = tempfile::tempdir().unwrap();
    let (mut past, _) = streamed(folder.path(), |_, _| vec![0, 0, 0, 1, 0x65, 0x88, 1]);
    settled(&mut past, 2.0);
    shown(&mut past);
    let words = drawn(&mut past);
    assert!(words.contains("Image is damaged") && words.contains("built without H.264"), "{words}");
}

#[test]
fn a_session_without_pictures_shows_the_drawn_field() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, "peg_transfer", 1.0, |_| None);
    let mut past = open(&path);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    assert!(!past.panels.eyes.is_on());
}

#[test]
fn the_words_over_a_recorded_picture_are_those_of_its_moment() {
    let folder = tempfile::tempdir().unwrap();
    let [path, filmed] = ["session.mcap", "filmed.mcap"].map(|name| folder.path().join(name));
    record(&path, "bimanual", 6.5, |_| None);
    with_images(&path, &filmed, u64::MAX);
    let mut past = open(&filmed);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    let words = |past: &mut Playback, t_s: f64| {
        settled(past, t_s);
        shown(past);
        drawn(past)
    };
    let live = words(&mut past, 3.0);
    assert!(live.contains("Recorded image, ") && live.contains(" ms old then"), "{live}");
    let frozen = words(&mut past, 4.8);
    assert!(frozen.contains("Image is frozen: no new image for 0."), "{frozen}");
    let none = words(&mut past, 6.4);
    assert!(none.contains("No image in the two seconds before this time"), "{none}");
}

fn texts(shape: &egui::Shape, all: &mut String) {
    match shape {
        egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| texts(shape, all)),
        egui::Shape::Text(text) => {
            all.push_str(text.galley.text());
            all.push('\n');
        }
        _ => {}
    }
}
