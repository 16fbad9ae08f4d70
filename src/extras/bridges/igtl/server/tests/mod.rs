//! Tests of the server with clients over real sockets; a loop is simulated in the way of a recorder.

mod figures;

use std::{
    io::{Read as _, Write as _},
    sync::atomic::AtomicBool,
    thread::{JoinHandle, spawn},
    time::Instant,
};

use nima_core::{kinematics::HandPose, safety::InterlockState};
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, Tick},
    rig::{Inputs, SensedForce},
    teleop::{Calibrations, Loop, Timing},
};

use super::{
    super::{Content, IgtlMessage, Image},
    super::{
        ContentKind, ContentStatus, ContentStream, IgtlFormatError, IgtlHeader, IgtlUnit, PoseMatrix, SensorContent,
        StatusCode, TextContent, ToolKind, TrackingTool, Verb,
    },
    *,
};

const STARTED_NS: u64 = 1_700_000_000_000_000_000;
const TROCAR_M: Vector3<f64> = Vector3::new(0.0, -0.06, 0.14);

/// A loop whose right arm follows a hand, tick by tick.
struct Rig {
    control: Loop,
    ticks: u32,
}

impl Rig {
    fn new() -> Self {
        let rig = RigConfig::load("simulated").unwrap();
        Self { control: Loop::new(&rig, &[Some(Calibrations::default()), None]).unwrap(), ticks: 0 }
    }

    /// Runs the next tick and reports it like a recorder.
    fn step(&mut self, audience: &mut dyn Audience) -> [Option<Tick>; SIDES] {
        let t_s = f64::from(self.ticks) * 1e-3;
        let hand = HandPose::at(Vector3::new(0.0, 0.0, 0.01 * (6.0 * t_s).sin()));
        let sensed = SensedForce::AtTip(Vector3::new(0.0, 0.0, 2.0 * (6.0 * t_s).sin().max(0.0)));
        let inputs = Inputs { hand, sensed, tip_m: hand.position_m, powered: true, ..Inputs::NOTHING };
        if self.ticks == 5 {
            self.control.obey(Command::Engage, t_s);
        }
        let (_, ticks) = self.control.step([Some(inputs), None], &Timing { now_s: t_s, ..Timing::default() });
        let events: Vec<Event> = self.control.events().copied().collect();
        self.control.clear_events();
        audience.tick(t_s, &ticks, &events);
        self.ticks += 1;
        ticks
    }
}

/// Runs a loop of about 1 kHz until it is dropped.
struct Runs {
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<Vec<[Option<Tick>; SIDES]>>>,
}

impl Runs {
    fn on(server: &IgtlServer) -> Self {
        let outline = LoopOutline { trocars_m: [Some(TROCAR_M), None] };
        let ends = Arc::new(AtomicBool::new(false));
        let mut audience = server.audience(outline);
        audience.begins("nima test", STARTED_NS);
        let ended = Arc::clone(&ends);
        let run = move || {
            let mut rig = Rig::new();
            let mut ticks = Vec::new();
            while !ended.load(Ordering::Relaxed) {
                ticks.push(rig.step(&mut *audience));
                sleep(Duration::from_millis(1));
            }
            ticks
        };
        Self { ends, thread: Some(spawn(run)) }
    }

    /// Ends the loop; returns its ticks.
    fn end(mut self) -> Vec<[Option<Tick>; SIDES]> {
        self.ends.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap()
    }
}

impl Drop for Runs {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
    }
}

fn server() -> IgtlServer {
    IgtlServer::start("127.0.0.1:0".parse().unwrap(), |state| format!("it is {}", state.word())).unwrap()
}

struct Peer(TcpStream);

impl Peer {
    fn of(server: &IgtlServer) -> Self {
        let stream = TcpStream::connect(server.address()).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        Self(stream)
    }

    fn next(&mut self) -> Option<IgtlMessage> {
        let mut head = [0; IgtlHeader::BYTES];
        self.0.read_exact(&mut head).ok()?;
        let header = IgtlHeader::read(&head).unwrap();
        let mut body = vec![0; header.body_bytes as usize];
        self.0.read_exact(&mut body).ok()?;
        Some(IgtlMessage::read(&header, &body).unwrap())
    }

    /// Returns the first value that `wanted` finds in the next messages.
    fn find<T>(&mut self, wanted: impl Fn(&IgtlMessage) -> Option<T>) -> T {
        loop {
            let message = self.next().expect("the connection ended");
            if let Some(found) = wanted(&message) {
                return found;
            }
        }
    }

    /// Returns the next message of this device and this kind.
    fn of_device(&mut self, device: &str, kind: ContentKind) -> IgtlMessage {
        self.find(|message| {
            (message.device == device && message.content.kind() == kind.name()).then(|| message.clone())
        })
    }

    fn ask(&mut self, verb: Verb, kind: ContentKind, stream: Option<ContentStream>) {
        self.0.write_all(&IgtlMessage::new("", 0, Content::Request(verb, kind, stream)).encode()).unwrap();
    }

    fn answer(&mut self, to: ContentKind) -> u8 {
        self.find(|message| match message.content {
            Content::Answer(kind, status) if kind == to => Some(status),
            _ => None,
        })
    }

    fn status(&mut self, wanted: StatusCode) -> ContentStatus {
        self.find(|message| match &message.content {
            Content::Status(status) if status.code == wanted => Some(status.clone()),
            _ => None,
        })
    }
}

fn until(what: &str, is: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is() {
        assert!(begin.elapsed() < Duration::from_secs(30), "{what}");
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_client_gets_tips_handles_forces_and_states_of_the_same_tick_without_asking() {
    let server = server();
    let runs = Runs::on(&server);
    let mut peer = Peer::of(&server);
    let engaged = peer.find(|message| match &message.content {
        Content::Status(status) if status.subcode == 3 => Some(message.clone()),
        _ => None,
    });
    let Content::Status(status) = engaged.content else { unreachable!() };
    assert_eq!(
        (engaged.device.as_str(), status.code, status.text.as_str()),
        ("right.state", StatusCode::OK, "it is Engaged")
    );
    // A state change precedes a waiting batch, which may belong to an earlier tick.
    let tip = peer.find(|message| {
        let is_later = message.device == "right.tip" && message.time_ns >= engaged.time_ns;
        (is_later && message.content.kind() == ContentKind::Transform.name()).then(|| message.clone())
    });
    let Content::Transform(leader) = peer.of_device("right.leader", ContentKind::Transform).content else {
        unreachable!()
    };
    let bundle = peer.of_device("nima", ContentKind::Tracking);
    let Content::Sensor(measured) = peer.of_device("right.measured", ContentKind::Sensor).content else {
        unreachable!()
    };
    let Content::Sensor(rendered) = peer.of_device("right.rendered", ContentKind::Sensor).content else {
        unreachable!()
    };
    let Content::Text(text) = peer.of_device("nima", ContentKind::Text).content else { unreachable!() };
    let ticks = runs.end();
    // A batch belongs to a single tick, with its time.
    assert_eq!(tip.time_ns, bundle.time_ns);
    let number = ((tip.time_ns - STARTED_NS) as f64 / 1e6).round() as usize;
    let tick = ticks[number][0].unwrap();
    let millimetres = |of: Vector3<f64>| <[f32; 3]>::from((of * 1e3).cast::<f32>());
    let Content::Transform(tip) = tip.content else { unreachable!() };
    assert_eq!((tip.0[3], leader.0[3]), (millimetres(tick.positions.tip_m), millimetres(tick.positions.leader_m)));
    let axis = Vector3::from(tip.0[2]).cast::<f64>();
    assert!((axis - (tick.positions.tip_m - TROCAR_M).normalize()).norm() < 1e-6, "out of the shaft: {axis}");
    assert_eq!(leader.0[..3], PoseMatrix::at([0.0; 3]).0[..3]);
    let tool = |name: &str, kind, pose| TrackingTool { name: name.to_owned(), kind, pose };
    let tools = vec![tool("right.tip", ToolKind::FiveD, tip), tool("right.leader", ToolKind::ThreeD, leader)];
    assert_eq!(bundle.content, Content::Tracking(tools));
    let newton = |of: Vector3<f64>| SensorContent { status: 0, unit: IgtlUnit::NEWTON, values: of.as_slice().to_vec() };
    assert_eq!((measured, rendered), (newton(tick.measured_n), newton(tick.rendering.rendered_n)));
    let report: serde_json::Value = serde_json::from_slice(&text.bytes).unwrap();
    assert_eq!(report["right"]["state"], "Engaged");
    let near = |report: &serde_json::Value, meant: f64| (report.as_f64().unwrap() - meant).abs() < 1e-9;
    assert!(near(&report["t_s"], tick.t_s) && near(&report["right"]["measured_n"][2], tick.measured_n.z), "{report}");
    assert!(report.get("left").is_none(), "there is no left arm: {report}");
}

#[test]
fn requests_are_answered_and_what_was_stopped_does_not_come() {
    let server = server();
    let _runs = Runs::on(&server);
    let mut peer = Peer::of(&server);
    for kind in [ContentKind::Transform, ContentKind::Sensor, ContentKind::Text, ContentKind::Status] {
        peer.ask(Verb::Stop, kind, None);
        assert_eq!(peer.answer(kind), 0);
    }
    let stream = |frame: &str| Some(ContentStream { interval_ms: 50, frame: frame.to_owned() });
    peer.ask(Verb::Start, ContentKind::Tracking, stream("patient"));
    assert_eq!(peer.answer(ContentKind::Tracking), 1, "there is no such frame");
    peer.ask(Verb::Start, ContentKind::Tracking, stream("world"));
    assert_eq!(peer.answer(ContentKind::Tracking), 0);
    peer.of_device("nima", ContentKind::Tracking);
    let times: Vec<u64> = (0..5)
        .map(|_| {
            let message = peer.next().unwrap();
            assert_eq!(message.content.kind(), "TDATA", "nothing else is wanted");
            message.time_ns
        })
        .collect();
    for pair in times.windows(2) {
        // A batch may have been replaced by a newer one, but none arrives too early.
        let between_ms = ((pair[1] - pair[0]) as f64 / 1e6).round();
        assert!(between_ms >= 50.0 && between_ms % 50.0 < 1.5, "{between_ms} ms");
    }
    peer.ask(Verb::Get, ContentKind::Position, None);
    peer.of_device("right.tip", ContentKind::Position);
    peer.ask(Verb::Get, ContentKind::Turned, None);
    peer.of_device("nima", ContentKind::Turned);
    peer.ask(Verb::Get, ContentKind::Status, None);
    assert_eq!(peer.status(StatusCode::OK).text, "it is Engaged");
    peer.ask(Verb::Get, ContentKind::Capability, None);
    let Content::Capability(types) = peer.of_device("nima", ContentKind::Capability).content else { unreachable!() };
    assert!(types.iter().any(|name| name == "STT_TDATA") && types.iter().all(|name| name.len() <= 12), "{types:?}");
    peer.ask(Verb::Start, ContentKind::Image, None);
    assert_eq!(peer.answer(ContentKind::Image), 1, "there is no endoscope");
}

/// An image that changes every time.
#[derive(Debug)]
struct Grey(u8);

impl ImageProvider for Grey {
    fn newest(&mut self, is_wanted: bool) -> Option<(Image, Duration)> {
        self.0 = self.0.wrapping_add(u8::from(is_wanted));
        let image = Image { size_px: [320, 200], colours: 1, pixels: vec![self.0; 64_000] };
        is_wanted.then_some((image, Duration::from_millis(30)))
    }
}

#[test]
fn pictures_come_once_or_again_and_again_as_they_are_asked_for() {
    let server = server();
    server.show(Some(Box::new(Grey(0))));
    let mut peer = Peer::of(&server);
    let grey = |peer: &mut Peer| {
        let Content::Image(image) = peer.of_device(IMAGE_DEVICE, ContentKind::Image).content else { unreachable!() };
        assert_eq!((image.size_px, image.pixels.len()), ([320, 200], 64_000));
        image.pixels[0]
    };
    peer.ask(Verb::Get, ContentKind::Image, None);
    assert_eq!(grey(&mut peer), 1, "nothing was read before");
    peer.ask(Verb::Start, ContentKind::Image, None);
    assert_eq!(peer.answer(ContentKind::Image), 0);
    let [first, second] = [grey(&mut peer), grey(&mut peer)];
    assert!((2..second).contains(&first), "{first}, {second}");
    peer.ask(Verb::Stop, ContentKind::Image, None);
    assert_eq!(peer.answer(ContentKind::Image), 0);
}

#[test]
fn one_loop_follows_the_other_and_between_them_clients_are_told() {
    let server = server();
    let mut peer = Peer::of(&server);
    assert!(peer.status(StatusCode::NOT_READY).text.contains("no data now"));
    for _ in 0..2 {
        let runs = Runs::on(&server);
        assert_eq!(peer.status(StatusCode::OK).name, InterlockState::<()>::Idle.word());
        peer.of_device("right.tip", ContentKind::Transform);
        runs.end();
        peer.status(StatusCode::NOT_READY);
    }
}

#[test]
fn clients_that_stall_flood_or_die_harm_nobody() {
    let server = server();
    let runs = Runs::on(&server);
    let mut good = Peer::of(&server);
    // This client reads nothing.
    let stalled = Peer::of(&server);
    // This client dies in the middle of a message.
    let mut killed = Peer::of(&server);
    killed
        .0
        .write_all(&IgtlMessage::new("", 0, Content::Request(Verb::Get, ContentKind::Status, None)).encode()[..40])
        .unwrap();
    drop(killed);
    // This client sends more than the server reads: requests, and bytes that are not messages.
    let request =
        IgtlMessage::new("", 0, Content::Request(Verb::Get, ContentKind::Capability, None)).encode().repeat(1000);
    let ends = Arc::new(AtomicBool::new(false));
    let flood = |bytes: Vec<u8>| {
        let mut stream = Peer::of(&server).0;
        let ends = Arc::clone(&ends);
        stream.set_write_timeout(Some(Duration::from_millis(100))).unwrap();
        let is_open = |written: io::Result<usize>| match written {
            Ok(count) => count > 0,
            Err(error) => matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut),
        };
        spawn(move || while !ends.load(Ordering::Relaxed) && is_open(stream.write(&bytes)) {})
    };
    let floods = [flood(request), flood(b"GET / HTTP/1.1\r\n\r\n".repeat(1000))];
    for _ in 0..120 {
        good.of_device("nima", ContentKind::Tracking);
    }
    // A closed connection no longer counts; the client that reads nothing is disconnected once its buffers are full.
    good.0.set_read_timeout(None).unwrap();
    let reads = spawn(move || while good.next().is_some() {});
    ends.store(true, Ordering::Relaxed);
    for flood in floods {
        flood.join().unwrap();
    }
    let image = Image { size_px: [1024, 1024], colours: 1, pixels: vec![0; 1 << 20] };
    let frame = IgtlMessage::new(IMAGE_DEVICE, 0, Content::Image(image)).encode();
    until("only one client is left", || {
        server.shared.clients().iter().for_each(|client| client.mailbox.image(frame.clone()));
        server.clients() == 1
    });
    drop(stalled);
    let ticks = runs.end();
    assert!(ticks.len() > 500);
    drop(server);
    reads.join().unwrap();
}

#[test]
fn a_client_too_many_is_told_and_has_room_when_another_one_has_left() {
    let server = server();
    let mut peers: Vec<Peer> = (0..MAX_CLIENTS).map(|_| Peer::of(&server)).collect();
    until("all are in", || server.clients() == MAX_CLIENTS);
    let mut late = Peer::of(&server);
    assert!(late.status(StatusCode::BUSY).text.contains("8 clients"));
    assert_eq!(late.next(), None);
    peers.pop();
    until("one has left", || server.clients() == MAX_CLIENTS - 1);
    Peer::of(&server).status(StatusCode::NOT_READY);
}

#[test]
fn what_is_damaged_is_answered_and_what_is_no_message_ends_the_connection() {
    let server = server();
    let mut peer = Peer::of(&server);
    let mut damaged = IgtlMessage::new("", 0, Content::Text(TextContent::of("hello"))).encode();
    *damaged.last_mut().unwrap() ^= 1;
    peer.0.write_all(&damaged).unwrap();
    assert_eq!(peer.status(StatusCode::ILLEGAL).text, IgtlFormatError::Checksum.to_string());
    peer.0.write_all(&[0; 58]).unwrap();
    while peer.next().is_some() {}
    until("it is gone", || server.clients() == 0);
}

#[test]
fn a_newer_header_is_told_before_the_connection_ends_and_a_short_request_is_answered() {
    let server = server();
    let mut peer = Peer::of(&server);
    let mut short = IgtlMessage::new("", 0, Content::Request(Verb::Start, ContentKind::Tracking, None)).encode();
    let body = [0, 0, 0, 20, 0];
    let head = IgtlHeader::BYTES;
    short[head - 16..head - 8].copy_from_slice(&(body.len() as u64).to_be_bytes());
    short[head - 8..head].copy_from_slice(&crate::igtl::message::CRC.checksum(&body).to_be_bytes());
    short.extend(body);
    peer.0.write_all(&short).unwrap();
    assert_eq!(peer.answer(ContentKind::Tracking), 1, "refused, but answered");
    let mut newer = IgtlMessage::new("", 0, Content::Text(TextContent::of("hello"))).encode();
    newer[1] = 3;
    peer.0.write_all(&newer).unwrap();
    let words = peer.find(|message| match &message.content {
        Content::Status(status) if status.text.contains("version is 3") => Some(status.text.clone()),
        _ => None,
    });
    assert!(words.contains("only 1 and 2"), "{words}");
    until("it is gone", || server.clients() == 0);
}

#[test]
fn an_address_in_use_is_told_in_one_line_and_is_free_when_the_server_has_ended() {
    let server = server();
    let address = server.address();
    let error = IgtlServer::start(address, |_| String::new()).unwrap_err().to_string();
    assert!(error.contains(&address.to_string()) && error.contains("choose another port"), "{error}");
    assert_eq!(error.lines().count(), 1);
    let mut audience = server.audience(LoopOutline::default());
    let _peer = Peer::of(&server);
    until("the client is in", || server.clients() == 1);
    drop(server);
    Rig::new().step(&mut *audience);
    assert!(TcpStream::connect(address).is_err());
}
