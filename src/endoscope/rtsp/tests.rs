use std::{
    io::{Read as _, Write as _},
    net::{TcpListener, TcpStream},
    thread,
};

use nima_testing::fuzz;

use super::*;
use crate::{
    h264::{H264Encoder, nal_units},
    jpeg::tests::pattern,
};

const SIZE_PX: [usize; 2] = [64, 48];
const STAMP_STEP: u32 = 3000;

fn endpoint(port: u16) -> Endpoint {
    Endpoint { host: "127.0.0.1".to_owned(), port, path: "/s".to_owned(), login: None }
}

/// Returns a camera's responses to DESCRIBE, SETUP and PLAY; `N` is replaced by the number of the request. Some images
/// and a report follow the last response.
fn answers(encoding: &str) -> [Vec<u8>; 3] {
    let body = format!(
        "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=x\r\nt=0 0\r\na=control:*\r\nm=audio 0 RTP/AVP 0\r\na=control:a\r\nm=video 0 RTP/AVP 96\r\n\
         a=rtpmap:96 {encoding}/90000\r\na=fmtp:96 packetization-mode=1\r\na=control:v\r\n"
    );
    let length = body.len();
    let described = format!(
        "RTSP/1.0 200 OK\r\nCSeq: N\r\nContent-Base: rtsp://127.0.0.1/s/\r\nContent-Type: application/sdp\r\nContent-Length: {length}\r\n\r\n{body}"
    );
    let set_up =
        "RTSP/1.0 200 OK\r\nCSeq: N\r\nTransport: RTP/AVP/TCP;unicast;interleaved=0-1\r\nSession: 7;timeout=60\r\n\r\n";
    let plays = "RTSP/1.0 200 OK\r\nCSeq: N\r\nSession: 7\r\nRange: npt=0.000-\r\n\r\n";
    let mut bytes = plays.as_bytes().to_vec();
    let mut encoder = H264Encoder::new(30.0).unwrap();
    let mut sequence = 7_u16;
    let mut packets = Vec::new();
    for number in 0..4 {
        let mut rgb = pattern(SIZE_PX);
        rgb.rotate_right(6 * number as usize);
        let unit = encoder.encode(&rgb, SIZE_PX, false).unwrap();
        let nals: Vec<&[u8]> = nal_units(&unit).collect();
        for (at, nal) in nals.iter().enumerate() {
            let marks = if at + 1 == nals.len() { 0x80 } else { 0 };
            let stamp = STAMP_STEP * number;
            let head =
                [&[0x80, 0x60 | marks][..], &sequence.to_be_bytes(), &stamp.to_be_bytes(), &[0, 0, 0, 9]].concat();
            sequence += 1;
            packets.push((0, [&head, *nal].concat()));
        }
        if number == 1 {
            // The sender's clock says 2.5 s since 1970.
            let mut report = vec![0x80, 200, 0, 6, 0, 0, 0, 9];
            report.extend_from_slice(&(2_208_988_802_u32).to_be_bytes());
            report.extend_from_slice(&(1_u32 << 31).to_be_bytes());
            report.extend_from_slice(&STAMP_STEP.to_be_bytes());
            report.extend_from_slice(&[0; 8]);
            packets.push((1, report));
        }
    }
    for (channel, packet) in packets {
        bytes.extend_from_slice(&[b'$', channel]);
        bytes.extend_from_slice(&(packet.len() as u16).to_be_bytes());
        bytes.extend_from_slice(&packet);
    }
    [described.into_bytes(), set_up.as_bytes().to_vec(), bytes]
}

/// Sends these responses to one client in order, and closes the connection.
fn serve(stream: &mut TcpStream, answers: &[Vec<u8>]) {
    stream.set_nodelay(true).ok();
    // A client that waits for the response to another request does not get it.
    stream.set_read_timeout(Some(Duration::from_millis(20))).ok();
    for answer in answers {
        let mut request = Vec::new();
        let mut buffer = [0; 2048];
        while !request.windows(4).any(|four| four == b"\r\n\r\n") {
            match stream.read(&mut buffer) {
                Ok(count) if count > 0 => request.extend_from_slice(&buffer[..count]),
                _ => return,
            }
        }
        let text = String::from_utf8_lossy(&request).to_lowercase();
        let number = text.lines().find_map(|line| line.strip_prefix("cseq:")).unwrap_or("0").trim().to_owned();
        let at = answer.windows(8).position(|eight| eight == b"CSeq: N\r");
        let whole = at.map_or(answer.clone(), |at| [&answer[..at + 6], number.as_bytes(), &answer[at + 7..]].concat());
        if stream.write_all(&whole).is_err() {
            return;
        }
    }
}

fn camera(answers: Vec<Vec<u8>>) -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    thread::spawn(move || serve(&mut listener.accept().unwrap().0, &answers));
    port
}

#[test]
fn pictures_come_with_the_stamps_of_the_sender_and_their_end_is_told() {
    let port = camera(answers("H264").to_vec());
    let mut source = open(&endpoint(port)).unwrap();
    let mut keys = Vec::new();
    let mut stamps_s = Vec::new();
    let mut decoder = crate::h264::H264Decoder::default();
    let report = loop {
        match source.next() {
            Ok(Some(compressed)) => {
                let Format::H264 { is_key } = compressed.format else { panic!("{:?}", compressed.format) };
                let taken = decoder.take(&compressed.bytes, is_key, true).unwrap().unwrap();
                assert_eq!(taken.image.unwrap().size_px, SIZE_PX);
                keys.push(is_key);
                stamps_s.push(compressed.stamp_s.unwrap());
            }
            Ok(None) => {}
            Err(trouble) => break trouble,
        }
    };
    assert_eq!(
        (keys, report),
        (vec![true, false, false, false], EndoscopeError::Closed { place: format!("127.0.0.1:{port}") })
    );
    let period_s = 1.0 / 30.0;
    for (number, expected_s) in [(2, 2.5 + period_s), (3, 2.5 + 2.0 * period_s)] {
        assert!((stamps_s[number] - expected_s).abs() < 1e-6, "{stamps_s:?}");
    }
    assert!((stamps_s[1] - stamps_s[0] - period_s).abs() < 1e-6);
}

#[test]
fn each_cause_is_told_with_its_cure() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let report = |port| open(&endpoint(port)).err().unwrap();
    assert!(matches!(report(port), EndoscopeError::NobodyListens { .. }));
    let status = |status: &str| camera(vec![format!("RTSP/1.0 {status}\r\nCSeq: N\r\n\r\n").into_bytes()]);
    assert!(matches!(report(status("404 Not Found")), EndoscopeError::Refused { status: 404, .. }));
    assert!(matches!(report(status("501 Not Implemented")), EndoscopeError::Refused { status: 501, .. }));
    let other = report(camera(answers("H265").to_vec()));
    assert!(matches!(&other, EndoscopeError::OtherFormat { found, .. } if found == "h265"), "{other}");
    assert!(other.to_string().ends_with("sends h265, not H.264") && other.cure().contains("Set the camera to H.264"));
    let mail = report(camera(vec![b"220 mail ready\r\n\r\n".to_vec()]));
    assert!(matches!(mail, EndoscopeError::Unreadable { .. } | EndoscopeError::Closed { .. }), "{mail}");
    assert!(!mail.to_string().contains('\n'), "{mail}");
}

#[test]
fn a_client_that_panics_ends_what_was_asked_for_and_not_the_thread() {
    let report = guarded::<()>("cam:554", || panic!("as the client does")).unwrap_err();
    assert_eq!(report.to_string(), "cam:554 sent an unreadable response: a response that cannot be parsed");
}

#[test]
fn a_description_whose_lines_are_out_of_order_is_told() {
    let [described, set_up, plays] = answers("H264");
    let text = String::from_utf8(described).unwrap().replace("m=audio 0 RTP/AVP 0\r\n", "t=0 0\r\n");
    let trouble = open(&endpoint(camera(vec![text.into_bytes(), set_up, plays]))).err();
    let report = trouble.map(|trouble| trouble.to_string()).unwrap_or_default();
    assert!(report.contains("cannot be"), "{report}");
}

/// Runs this many conversations with a camera whose responses are randomly damaged; returns the number of images that
/// arrived.
fn mutate(seed: u64, count: usize) -> usize {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let sound = answers("H264");
    let server = thread::spawn(move || {
        let mut random = fastrand::Rng::with_seed(seed);
        for _ in 0..count {
            let mut answers = sound.clone();
            for _ in 0..random.usize(1..4) {
                let answer = random.choice(&mut answers).unwrap();
                let at = random.usize(..answer.len());
                match random.u8(..4) {
                    0 => answer[at] = random.u8(..),
                    1 => answer[at] ^= 1 << random.u8(..8),
                    2 => drop(answer.drain(at..(at + random.usize(1..30)).min(answer.len()))),
                    _ => {
                        let copied = answer[at..(at + random.usize(1..60)).min(answer.len())].to_vec();
                        answer.splice(at..at, copied);
                    }
                }
                if answer.is_empty() {
                    answer.push(b'R');
                }
            }
            serve(&mut listener.accept().unwrap().0, &answers);
        }
    });
    let mut images = 0;
    for _ in 0..count {
        let Ok(mut source) = open(&endpoint(port)) else { continue };
        while let Ok(next) = source.next() {
            images += usize::from(next.is_some());
        }
    }
    server.join().unwrap();
    images
}

#[test]
fn damaged_answers_never_panic() {
    assert!(mutate(1, 200) > 50);
}

#[test]
#[ignore = "as long as ./dev fuzz asks for"]
fn fuzz_damaged_conversations() {
    // The threads wait for each other most of the time.
    let rounds = fuzz::rounds(|seed| {
        thread::scope(|scope| {
            for lane in 0..10 {
                scope.spawn(move || mutate(10 * seed + lane, 1000));
            }
        });
    });
    println!("{rounds} x 10000 conversations");
}
