use std::{
    io::{Read as _, Write as _},
    net::{TcpListener, TcpStream},
    thread,
};

use nima_testing::fuzz;
use proptest::prelude::*;

use super::{answer::IMAGE_MAX, *};
use crate::Login;

const HEAD: &str = "HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=frame\r\n\r\n";

fn body(number: usize) -> Vec<u8> {
    let mut body = vec![0xff, 0xd8];
    body.extend((0..50 + 37 * number).map(|at| (at * 7 + number) as u8));
    // Bytes that look like the beginning of a boundary.
    body.extend_from_slice(b"\r\n--fram\xff\xd9");
    body
}

fn parts(with_length: bool) -> Vec<u8> {
    let mut bytes = b"\r\n".to_vec();
    for number in 0..3 {
        let body = body(number);
        let length = if with_length { format!("content-length: {}\r\n", body.len()) } else { String::new() };
        let head = format!("--frame\r\nContent-Type: image/jpeg\r\n{length}X-Timestamp: {number}.5\r\n\r\n");
        bytes.extend_from_slice(head.as_bytes());
        bytes.extend_from_slice(&body);
        bytes.extend_from_slice(b"\r\n");
    }
    bytes.extend_from_slice(b"--frame");
    bytes
}

fn in_chunks(bytes: &[u8], chunk: usize) -> Vec<u8> {
    bytes
        .chunks(chunk)
        .flat_map(|part| [format!("{:x};a=b\r\n", part.len()).as_bytes(), part, b"\r\n"].concat())
        .collect()
}

fn taken(bytes: &[u8], chunk: usize) -> Result<Vec<ImagePart>, HttpFault> {
    let mut answer = HttpAnswer::default();
    let mut parts = VecDeque::new();
    for chunk in bytes.chunks(chunk) {
        answer.take(chunk, &mut parts)?;
    }
    Ok(parts.into())
}

fn expected() -> Vec<ImagePart> {
    (0..3).map(|number| ImagePart { body: body(number), stamp_s: Some(number as f64 + 0.5) }).collect()
}

proptest! {
    #[test]
    fn the_pictures_are_the_same_however_they_are_cut(
        chunk in 1_usize..400, sent in 1_usize..300, with_length: bool, chunked: bool,
    ) {
        let bytes = if chunked {
            let head = HEAD.replace("\r\n\r\n", "\r\nTransfer-Encoding: chunked\r\n\r\n");
            [head.into_bytes(), in_chunks(&parts(with_length), sent)].concat()
        } else {
            [HEAD.as_bytes(), &parts(with_length)].concat()
        };
        prop_assert_eq!(taken(&bytes, chunk), Ok(expected()));
    }
}

#[test]
fn habits_of_cameras_are_understood() {
    for (from, to) in [
        ("boundary=frame", "boundary=\"frame\""),
        ("boundary=frame", "boundary=--frame"),
        ("boundary=frame", "charset=x; Boundary = frame "),
        ("HTTP/1.1 200 OK", "HTTP/1.0 200 Fine"),
    ] {
        let bytes = [HEAD.replace(from, to).into_bytes(), parts(true)].concat();
        assert_eq!(taken(&bytes, 100), Ok(expected()), "{to}");
    }
    let bare = [HEAD.as_bytes(), &parts(true)].concat();
    let text: Vec<u8> = bare.iter().copied().filter(|byte| *byte != b'\r').collect();
    // Bodies lose their carriage returns too; the test only checks that the lines are parsed.
    assert!(taken(&text, 64).is_ok());
}

#[test]
fn what_is_no_motion_jpeg_is_told() {
    let of = |head: &str| taken(format!("{head}\r\n\r\n").as_bytes(), 7).unwrap_err();
    assert_eq!(of("HTTP/1.1 404 Not Found"), HttpFault::Status(404));
    assert_eq!(of("HTTP/1.1 200 OK\r\nContent-Type: text/html; a"), HttpFault::Format("text/html".to_owned()));
    assert_eq!(of("HTTP/1.1 200 OK\r\nContent-Type: image/jpeg"), HttpFault::Format("a single image".to_owned()));
    assert_eq!(of("HTTP/1.1 200 OK"), HttpFault::Format("a response without a content type".to_owned()));
    assert!(matches!(of("SSH-2.0-OpenSSH_9.6"), HttpFault::Unreadable(_)));
    assert!(matches!(of("HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace"), HttpFault::Unreadable(_)));
    let png = [HEAD, "--frame\r\nContent-Type: image/png\r\n\r\n"].concat();
    assert_eq!(taken(png.as_bytes(), 9), Err(HttpFault::Format("image/png".to_owned())));
    let end = [HEAD, "--frame--"].concat();
    assert_eq!(taken(end.as_bytes(), 9), Err(HttpFault::Ended));
}

#[test]
fn what_is_too_long_is_refused_and_memory_stays_small() {
    let mut answer = HttpAnswer::default();
    let mut parts = VecDeque::new();
    let endless = [HEAD, "--frame\r\n\r\n"].concat();
    answer.take(endless.as_bytes(), &mut parts).unwrap();
    let mut report = Ok(());
    for _ in 0..3 * IMAGE_MAX / READ_BYTES {
        report = answer.take(&vec![7; READ_BYTES], &mut parts);
        if report.is_err() {
            break;
        }
    }
    assert!(report.is_err() && answer.held() < 3 * IMAGE_MAX, "{} bytes", answer.held());
    let says = |length: &str| [HEAD, "--frame\r\nContent-Length: ", length, "\r\n\r\n"].concat();
    for length in ["99999999999", "-1", "99999999999999999999999"] {
        assert!(taken(says(length).as_bytes(), 50).is_err(), "{length}");
    }
    assert!(taken(&[&b"HTTP/1.1 200 OK\r\nX: "[..], &vec![b'a'; 40_000]].concat(), 999).is_err());
}

/// Damages responses at random.
fn mutate(seed: u64, count: usize) {
    let mut random = fastrand::Rng::with_seed(seed);
    let chunked = HEAD.replace("\r\n\r\n", "\r\nTransfer-Encoding: chunked\r\n\r\n");
    let answers = [
        [HEAD.as_bytes(), &parts(true)].concat(),
        [HEAD.as_bytes(), &parts(false)].concat(),
        [chunked.as_bytes(), &in_chunks(&parts(true), 100)].concat(),
    ];
    for _ in 0..count {
        let mut bytes = random.choice(&answers).unwrap().clone();
        for _ in 0..random.usize(1..8) {
            let at = random.usize(..bytes.len());
            match random.u8(..4) {
                0 => bytes[at] = random.u8(..),
                1 => bytes[at] ^= 1 << random.u8(..8),
                2 => drop(bytes.drain(at..(at + random.usize(1..60)).min(bytes.len()))),
                _ => {
                    let copied = bytes[at..(at + random.usize(1..60)).min(bytes.len())].to_vec();
                    bytes.splice(at..at, copied);
                }
            }
            if bytes.is_empty() {
                bytes.push(b'H');
            }
        }
        let chunk = random.usize(1..300);
        let mut answer = HttpAnswer::default();
        let mut parts = VecDeque::new();
        for chunk in bytes.chunks(chunk) {
            if answer.take(chunk, &mut parts).is_err() {
                break;
            }
        }
        assert!(answer.held() < 1 << 16);
    }
}

#[test]
fn damaged_answers_never_panic() {
    mutate(1, 10_000);
}

#[test]
#[ignore = "as long as ./dev fuzz asks for"]
fn fuzz_damaged_answers() {
    let rounds = fuzz::rounds(|seed| mutate(seed, 100_000));
    println!("{rounds} x 100000 answers");
}

fn endpoint(port: u16) -> Endpoint {
    Endpoint { host: "127.0.0.1".to_owned(), port, path: "/a?b".to_owned(), login: None }
}

/// Starts a camera that answers one client in this way; returns its address.
fn camera(act: impl FnOnce(TcpStream) + Send + 'static) -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    thread::spawn(move || {
        act(asked(&listener).0);
    });
    port
}

/// Returns the next client and its request.
fn asked(listener: &TcpListener) -> (TcpStream, String) {
    let (mut stream, _) = listener.accept().unwrap();
    let mut request = [0; 1000];
    let count = stream.read(&mut request).unwrap();
    assert!(request[..count].starts_with(b"GET /a?b HTTP/1.1\r\nHost: 127.0.0.1:"));
    (stream, String::from_utf8(request[..count].to_vec()).unwrap())
}

/// Returns the result of a client with this login at a camera that requests a password in this way, and the second
/// request of the client.
fn logged_in(
    challenges: &'static str,
    login: Option<Login>,
) -> (Result<CompressedFrame, EndoscopeError>, Option<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let asks_twice = login.is_some() && challenges.contains("realm");
    let served = thread::spawn(move || {
        let (mut stream, request) = asked(&listener);
        assert!(!request.contains("Authorization"));
        stream
            .write_all(format!("HTTP/1.1 401 Unauthorized\r\n{challenges}Content-Length: 0\r\n\r\n").as_bytes())
            .unwrap();
        asks_twice.then(|| {
            let (mut stream, request) = asked(&listener);
            let authorization =
                request.lines().find_map(|line| line.strip_prefix("Authorization: ")).unwrap().to_owned();
            if authorization.contains("wrong") {
                stream
                    .write_all(
                        b"HTTP/1.1 401 Unauthorized\r\nWWW-Authenticate: Digest realm=\"x\", nonce=\"1\"\r\n\r\n",
                    )
                    .unwrap();
            } else {
                stream.write_all(&[HEAD.as_bytes(), &parts(true)].concat()).unwrap();
            }
            authorization
        })
    });
    let mut source = Http::open(&Endpoint { login, ..endpoint(port) }).unwrap();
    let first = std::iter::repeat_with(|| source.next()).find_map(Result::transpose).unwrap();
    (first, served.join().unwrap())
}

#[test]
fn a_password_is_given_as_the_camera_asks_for_it() {
    let login = |user: &str| Some(Login { user: user.to_owned(), password: "secret".to_owned() });
    let (image, sent) = logged_in("WWW-Authenticate: Basic realm=\"x\"\r\n", login("eva"));
    // base64 of eva:secret
    assert_eq!((image.unwrap().bytes, sent.as_deref()), (body(0), Some("Basic ZXZhOnNlY3JldA==")));
    // If both are offered, Digest is used, because it is safer.
    let both = "WWW-Authenticate: Basic realm=\"x\"\r\nWWW-Authenticate: Digest realm=\"x\", nonce=\"1\"\r\n";
    for challenges in [both, "www-authenticate: Digest realm=\"x\", qop=\"auth\", nonce=\"1\", algorithm=MD5\r\n"] {
        let (image, sent) = logged_in(challenges, login("eva"));
        assert_eq!(image.unwrap().bytes, body(0));
        let sent = sent.unwrap();
        assert!(sent.starts_with("Digest ") && sent.contains("uri=\"/a?b\"") && !sent.contains("secret"), "{sent}");
    }
    let refused = |challenges, login| {
        let trouble = logged_in(challenges, login).0.err().unwrap();
        assert!(
            matches!(trouble, EndoscopeError::Refused { status: 401, .. }) && trouble.cure().contains("USER:PASSWORD")
        );
    };
    refused("WWW-Authenticate: Digest realm=\"x\", nonce=\"1\"\r\n", login("wrong"));
    refused("WWW-Authenticate: Digest realm=\"x\", nonce=\"1\"\r\n", None);
    refused("WWW-Authenticate: Other\r\n", login("eva"));
    refused("", login("eva"));
}

#[test]
fn pictures_come_over_a_connection_and_its_end_is_told() {
    let port = camera(|mut stream| {
        stream.write_all(HEAD.as_bytes()).unwrap();
        stream.write_all(&parts(true)).unwrap();
    });
    let mut source = Http::open(&endpoint(port)).unwrap();
    let mut seen = Vec::new();
    let report = loop {
        match source.next() {
            Ok(Some(compressed)) => seen.push(ImagePart { body: compressed.bytes, stamp_s: compressed.stamp_s }),
            Ok(None) => {}
            Err(trouble) => break trouble,
        }
    };
    assert_eq!((seen, report), (expected(), EndoscopeError::Closed { place: format!("127.0.0.1:{port}") }));
}

#[test]
fn who_does_not_listen_or_does_not_speak_http_is_told_with_a_cure() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let report = Http::open(&endpoint(port)).err().unwrap();
    assert!(matches!(report, EndoscopeError::NobodyListens { .. }) && report.cure().contains("port"), "{report}");
    let port = camera(|mut stream| stream.write_all(b"220 mail ready\r\n").unwrap());
    let mut source = Http::open(&endpoint(port)).unwrap();
    let report = std::iter::repeat_with(|| source.next()).find_map(Result::err).unwrap();
    assert!(report.to_string().contains("not HTTP") && report.cure().contains("another program"), "{report}");
}

/// Returns the outcome of a client at a camera that first redirects to this location; `PORT` stands for its port.
fn redirected_to(location: &str, login: Option<Login>) -> (Result<CompressedFrame, EndoscopeError>, Vec<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let location = location.replace("PORT", &port.to_string());
    let (give, requests) = std::sync::mpsc::channel();
    thread::spawn(move || {
        for count in 0..8 {
            let Ok((mut stream, _)) = listener.accept() else { return };
            let mut request = [0; 1000];
            let length = stream.read(&mut request).unwrap();
            let request = String::from_utf8(request[..length].to_vec()).unwrap();
            let answer = if count == 0 || request.starts_with("GET /loop ") {
                format!("HTTP/1.1 302 Found\r\nLocation: {location}\r\nContent-Length: 0\r\n\r\n").into_bytes()
            } else {
                [HEAD.as_bytes(), &parts(true)].concat()
            };
            give.send(request).ok();
            stream.write_all(&answer).ok();
        }
    });
    let mut source = Http::open(&Endpoint { login, ..endpoint(port) }).unwrap();
    let first = std::iter::repeat_with(|| source.next()).find_map(Result::transpose).unwrap();
    (first, requests.try_iter().collect())
}

#[test]
fn a_redirect_within_the_camera_is_followed_and_none_to_another_host() {
    for (location, path) in [
        ("/other?x=1", "/other?x=1"),
        ("http://127.0.0.1:PORT/other", "/other"),
        ("//127.0.0.1:PORT/other", "/other"),
        ("other", "/other"),
    ] {
        let (image, requests) = redirected_to(location, None);
        assert_eq!(image.unwrap().bytes, body(0), "{location}");
        assert!(requests[1].starts_with(&format!("GET {path} HTTP/1.1")), "{requests:?}");
    }
    let login = || Some(Login { user: "eva".to_owned(), password: "secret".to_owned() });
    for location in [
        "http://192.0.2.1/other?pwd=secret",
        "https://127.0.0.1:PORT/other",
        "http://eva:secret@127.0.0.1:PORT/other",
        "/loop",
        "",
    ] {
        let (report, requests) = redirected_to(location, login());
        let report = report.err().unwrap();
        assert!(matches!(report, EndoscopeError::Redirected { .. } | EndoscopeError::Refused { .. }), "{report}");
        assert!(!report.to_string().contains("secret"), "{report}");
        assert!(requests.iter().all(|request| !request.contains("Authorization")));
    }
}
