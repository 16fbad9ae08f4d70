use std::{
    io::{Read as _, Write as _},
    net::{TcpListener, TcpStream},
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};

use nima_testing::real_time;

use super::*;
use crate::{
    FrameFault,
    jpeg::{encode, tests::four_colours},
};

fn frame(value: u8) -> Vec<u8> {
    let jpeg = encode(&vec![value; 3 * 32 * 32], [32, 32], 80);
    let head = format!("--f\r\nContent-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n", jpeg.len());
    [head.as_bytes(), &jpeg, b"\r\n"].concat()
}

/// Answers a client's request.
fn greet(mut stream: &TcpStream) {
    let mut request = [0; 1000];
    assert!(stream.read(&mut request).unwrap() > 0);
    stream.write_all(b"HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace;boundary=f\r\n\r\n").unwrap();
}

fn until(
    feed: &EndoscopeFeed,
    what: &str,
    wanted: impl Fn(&FeedSnapshot<Arc<DecodedImage>>) -> bool,
) -> FeedSnapshot<Arc<DecodedImage>> {
    let begin = Instant::now();
    loop {
        let look = feed.look(Instant::now());
        if wanted(&look) {
            return look;
        }
        assert!(begin.elapsed() < Duration::from_secs(20), "not {what}: {:?}", look.standing);
        thread::sleep(Duration::from_millis(1));
    }
}

fn value(look: &FeedSnapshot<Arc<DecodedImage>>) -> Option<u8> {
    look.image.as_ref().map(|(_, image)| image.rgba[0])
}

#[test]
fn the_newest_picture_is_there_and_what_stops_is_frozen_then_lost_then_there_again() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}/", listener.local_addr().unwrap()).parse().unwrap();
    let wakes = Arc::new(AtomicUsize::new(0));
    let counts = Arc::clone(&wakes);
    let feed = EndoscopeFeed::start(address, None, move || {
        counts.fetch_add(1, Ordering::Relaxed);
    })
    .unwrap();
    let (mut first, _) = listener.accept().unwrap();
    greet(&first);
    assert_eq!(feed.look(Instant::now()).standing, FrameHealth::Opening);
    for number in 1..=20 {
        first.write_all(&frame(10 * number)).unwrap();
    }
    // Some images may be skipped, but the last one is decoded.
    let look = until(&feed, "the newest", |look| value(look) == Some(200));
    assert!(look.rate_hz >= 1.0 && look.age.is_some(), "{look:?}");
    assert!(wakes.load(Ordering::Relaxed) >= 1);
    until(&feed, "frozen", |look| matches!(look.standing, FrameHealth::Wrong(FrameFault::Frozen(_))));
    drop(first);
    let lost = until(&feed, "lost", |look| matches!(look.standing, FrameHealth::Lost(EndoscopeError::Closed { .. })));
    assert_eq!(value(&lost), Some(200), "the last image stays");
    let (mut second, _) = listener.accept().unwrap();
    greet(&second);
    second.write_all(&frame(90)).unwrap();
    let look = until(&feed, "there again", |look| value(look) == Some(90));
    assert!(!matches!(look.standing, FrameHealth::Lost(_)), "{look:?}");
}

#[test]
fn a_cut_is_mended_within_a_second() {
    real_time::judged(|| {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = format!("http://{}/", listener.local_addr().unwrap()).parse().unwrap();
        let feed = EndoscopeFeed::start(address, None, || {}).unwrap();
        let (mut first, _) = listener.accept().unwrap();
        greet(&first);
        for number in 0..20 {
            first.write_all(&frame(number)).unwrap();
            thread::sleep(Duration::from_millis(33));
        }
        let cut = Instant::now();
        drop(first);
        let (mut second, _) = listener.accept().unwrap();
        greet(&second);
        second.write_all(&frame(200)).unwrap();
        until(&feed, "there again", |look| value(look) == Some(200));
        assert!(cut.elapsed() < Duration::from_secs(1), "{:?}", cut.elapsed());
    });
}

#[test]
fn a_camera_with_four_colours_is_told_with_what_to_set_and_never_shown_as_stripes() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}/", listener.local_addr().unwrap()).parse().unwrap();
    let feed = EndoscopeFeed::start(address, None, || {}).unwrap();
    let (mut stream, _) = listener.accept().unwrap();
    greet(&stream);
    let jpeg = four_colours();
    let head = format!("--f\r\nContent-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n", jpeg.len());
    let image = [head.as_bytes(), &jpeg, b"\r\n"].concat();
    let begin = Instant::now();
    loop {
        stream.write_all(&image).unwrap();
        let look = feed.look(Instant::now());
        assert_eq!(value(&look), None, "no stripes");
        if let FrameHealth::Wrong(FrameFault::Damaged(damage)) = &look.standing {
            let words = damage.to_string();
            assert!(words.contains("CMYK") && words.contains("set the camera to colour"), "{words}");
            break;
        }
        assert!(begin.elapsed() < Duration::from_secs(20), "{:?}", look.standing);
        thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_torn_picture_is_told_and_the_last_whole_one_stays() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}/", listener.local_addr().unwrap()).parse().unwrap();
    let feed = EndoscopeFeed::start(address, Some([32, 32]), || {}).unwrap();
    let (mut stream, _) = listener.accept().unwrap();
    greet(&stream);
    stream.write_all(&frame(50)).unwrap();
    until(&feed, "there", |look| value(look) == Some(50));
    let whole = frame(90);
    let body = whole.windows(2).position(|two| two == [0xff, 0xd8]).unwrap();
    let half = &whole[body..body + 300];
    let torn = [b"--f\r\nContent-Length: 300\r\n\r\n", half, b"\r\n"].concat();
    let begin = Instant::now();
    loop {
        stream.write_all(&torn).unwrap();
        let look = feed.look(Instant::now());
        assert_eq!(value(&look), Some(50));
        if look.standing == FrameHealth::Wrong(FrameFault::Damaged(crate::Damage::Torn)) {
            break;
        }
        assert!(begin.elapsed() < Duration::from_secs(20), "{:?}", look.standing);
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_feed_that_is_dropped_ends_its_threads() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}/", listener.local_addr().unwrap()).parse().unwrap();
    let alive = Arc::new(());
    let held = Arc::clone(&alive);
    let feed = EndoscopeFeed::start(address, None, move || drop(Arc::clone(&held))).unwrap();
    drop(feed);
    let begin = Instant::now();
    while Arc::strong_count(&alive) > 1 {
        assert!(begin.elapsed() < Duration::from_secs(20));
        thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn another_tone_is_seen_at_once_also_in_a_picture_that_stands_still() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jpg");
    std::fs::write(&path, encode(&vec![100; 3 * 32 * 32], [32, 32], 95)).unwrap();
    let feed = EndoscopeFeed::start(Address::File(path), None, || {}).unwrap();
    until(&feed, "the picture", |look| value(look).is_some_and(|value| value.abs_diff(100) < 3));
    feed.set_tone(Tone { brightness: 0.2, ..Tone::default() });
    until(&feed, "brighter", |look| value(look).is_some_and(|value| value.abs_diff(151) < 3));
    feed.set_tone(Tone::default());
    until(&feed, "unchanged", |look| value(look).is_some_and(|value| value.abs_diff(100) < 3));
}
