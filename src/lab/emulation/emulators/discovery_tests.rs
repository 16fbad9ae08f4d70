//! Tests every cause that can be provoked here; `diagnose` reports each with its own remedy.

use std::{
    collections::BTreeSet,
    net::TcpListener,
    time::{Duration, Instant},
};
#[cfg(unix)]
use std::{
    io::Write as _,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use nima_devices::{
    ConnectionState, Device, DeviceError, DeviceIdentity, Health, Loss, TimedReading,
    discovery::{
        DataTiming, DeviceProbe, DiscoveryDiagnosis, FoundDevice, Probe, SerialProbe, TIMEOUT, TcpProbe, TestOutcome,
        diagnose, frames, probe_named, rules,
    },
    force_dimension,
};
use nima_testing::real_time::judged;

/// A device whose behaviour a test sets.
struct Fake {
    health: Health,
    identity: DeviceIdentity,
    then: Option<Loss>,
    period_s: f64,
    next_s: Option<f64>,
}

impl Fake {
    fn new(rate_hz: f64, then: Option<Loss>) -> Self {
        let identity = DeviceIdentity { product: "Fake".to_owned(), serial: "7".to_owned(), firmware: String::new() };
        Self { health: Health::opening(), identity, then, period_s: 1.0 / rate_hz, next_s: None }
    }
}

impl Device for Fake {
    type Reading = ();

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<()>> {
        if let Some(loss) = self.then {
            self.health.lose(loss);
            return None;
        }
        let next_s = self.next_s.get_or_insert(now_s);
        let mut news = None;
        while *next_s <= now_s {
            *next_s += self.period_s;
            self.health.accept(now_s);
            news = Some(TimedReading { device_s: None, arrival_s: now_s, value: () });
        }
        news
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.health, &self.identity)
    }
}

fn of_fake(open: impl FnMut() -> Result<Fake, DeviceError> + Send + 'static) -> Box<dyn Probe> {
    Box::new(DeviceProbe::new("fake", "/dev/fake", DataTiming::Always, open))
}

fn one(probe: Box<dyn Probe>) -> Result<FoundDevice, DeviceError> {
    let Some(DiscoveryDiagnosis { outcome, .. }) = diagnose(vec![probe], TIMEOUT).pop() else {
        panic!("nothing was diagnosed")
    };
    match outcome {
        TestOutcome::Connected(found) => Ok(found),
        TestOutcome::Trouble { trouble, .. } => Err(trouble),
    }
}

/// Writes `frame` to a pseudo-terminal every 2 ms; returns the port, and a guard that ends it.
#[cfg(unix)]
fn talking(frame: impl FnMut() -> Vec<u8> + Send + 'static) -> (String, Stop) {
    use serialport::SerialPort as _;
    let (mut device, port) = serialport::TTYPort::pair().unwrap();
    let name = port.name().unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let mut frame = frame;
    let thread = std::thread::spawn(move || {
        // Kept open, so that the name persists; not exclusive, so that the probe may open it.
        let _port = port;
        while !flag.load(Ordering::Acquire) {
            device.write_all(&frame()).ok();
            std::thread::sleep(Duration::from_millis(2));
        }
    });
    (name, Stop(stop, Some(thread)))
}

#[cfg(unix)]
struct Stop(Arc<AtomicBool>, Option<std::thread::JoinHandle<()>>);

#[cfg(unix)]
impl Drop for Stop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
        self.1.take().map(std::thread::JoinHandle::join);
    }
}

#[test]
fn a_device_that_works_tells_who_it_is_and_how_fast() {
    judged(|| {
        let found = one(of_fake(|| Ok(Fake::new(100.0, None)))).unwrap();
        assert_eq!((found.identity.serial.as_str(), found.standing, found.lost), ("7", ConnectionState::Connected, 0));
        let rate_hz = found.rate_hz.unwrap();
        assert!((80.0..120.0).contains(&rate_hz), "{rate_hz}");
        assert!(found.latency_s.unwrap() < 0.5);
    });
}

#[test]
fn twelve_causes_come_out_each_with_a_cure_of_its_own() {
    judged(|| {
        let fail = |trouble: DeviceError| of_fake(move || Err(trouble.clone()));
        let place = || "/dev/fake".to_owned();
        let denied = std::io::Error::from(std::io::ErrorKind::PermissionDenied);
        let timed_out = std::io::Error::from(std::io::ErrorKind::TimedOut);
        let probes: Vec<Box<dyn Probe>> = vec![
            probe_named("serial=/dev/no-such-port@460800").unwrap(),
            fail(DeviceError::of_port(std::path::Path::new("/dev/fake"), &denied, &rules::of_serial(None))),
            fail(DeviceError::Busy { place: place() }),
            fail(DeviceError::WrongProduct { place: place(), expected: "one".to_owned(), found: "other".to_owned() }),
            fail(DeviceError::WrongBaud { place: place(), baud: 9600 }),
            of_fake(|| Ok(Fake::new(1.0, Some(Loss::Silent)))),
            fail(DeviceError::of_address("192.168.1.10:10000", &timed_out)),
            probe_named(&format!("tcp={}", free_address())).unwrap(),
            fail(DeviceError::RefusedLogin { place: place(), user: "admin".to_owned() }),
            nima_devices::discovery::probes::handle(
                "handle",
                force_dimension::ForceDimensionSettings { library: Some("/no/such/file".into()), ..Default::default() },
            ),
            fail(DeviceError::NotReady {
                place: place(),
                mode: "calibration".to_owned(),
                cure: "Press reset.".to_owned(),
            }),
            of_fake(|| Ok(Fake::new(1.0, Some(Loss::Device { code: 0x20 })))),
        ];
        let count = probes.len();
        let begin = Instant::now();
        let found = diagnose(probes, TIMEOUT);
        assert!(begin.elapsed() < Duration::from_secs(2), "they are tried at the same time");
        let mut kinds = BTreeSet::new();
        let mut causes = BTreeSet::new();
        let mut cures = BTreeSet::new();
        for diagnosis in &found {
            let text = serde_json::to_value(diagnosis).unwrap();
            assert_eq!(text["state"], "trouble", "{text}");
            let word = |key: &str| text[key].as_str().unwrap().to_owned();
            assert!(word("cure").len() > 10 && word("cure").lines().count() == 1, "{text}");
            kinds.insert(word("trouble"));
            causes.insert(word("cause"));
            cures.insert(word("cure"));
        }
        assert_eq!((kinds.len(), causes.len(), cures.len()), (count, count, count), "{kinds:?}\n{cures:?}");
        let wanted = ["absent", "busy", "device_fault", "nobody_listens", "not_ready", "permission", "refused_login"];
        assert!(wanted.iter().all(|wanted| kinds.contains(*wanted)), "{kinds:?}");
    });
}

/// Returns an address at which no server listens any more.
fn free_address() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.local_addr().unwrap().to_string()
}

#[test]
fn a_listener_is_found_and_a_wrong_port_and_a_wrong_name_are_told_apart() {
    judged(|| {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let found = one(Box::new(TcpProbe::new(&address).unwrap())).unwrap();
        assert!(found.latency_s.unwrap() < 0.5);
        drop(listener);
        assert!(matches!(one(Box::new(TcpProbe::new(&address).unwrap())), Err(DeviceError::NobodyListens { .. })));
        for wrong in ["localhost", "localhost:x", ":80", "localhost:99999"] {
            assert!(matches!(TcpProbe::new(wrong), Err(DeviceError::Setting { .. })), "{wrong}");
        }
    });
}

#[test]
fn an_address_without_a_way_is_unreachable() {
    for kind in [
        std::io::ErrorKind::HostUnreachable,
        std::io::ErrorKind::NetworkUnreachable,
        std::io::ErrorKind::NetworkDown,
        std::io::ErrorKind::TimedOut,
    ] {
        assert!(matches!(DeviceError::of_address("a:1", &kind.into()), DeviceError::Unreachable { .. }), "{kind:?}");
    }
}

#[test]
fn one_that_hangs_and_one_that_fails_are_told_so_and_hold_up_nobody() {
    judged(|| {
        struct Hangs;
        impl Probe for Hangs {
            fn name(&self) -> &'static str {
                "hangs"
            }
            fn probe(&mut self, _: Duration) -> Result<FoundDevice, DeviceError> {
                std::thread::sleep(Duration::from_secs(3));
                Ok(FoundDevice::default())
            }
        }
        let short = Duration::from_millis(600);
        let begin = Instant::now();
        let found = diagnose(vec![Box::new(Hangs), of_fake(|| Ok(Fake::new(100.0, None)))], short);
        assert!(begin.elapsed() < Duration::from_secs(2));
        let [hanging, working] = &found[..] else { panic!("{found:?}") };
        assert!(
            matches!(&hanging.outcome, TestOutcome::Trouble { cause, .. } if cause.contains("no answer within 0.6 s"))
        );
        assert!(matches!(working.outcome, TestOutcome::Connected(_)), "{working:?}");
    });
}

#[cfg(unix)]
#[test]
fn a_port_that_another_program_holds_is_busy() {
    judged(|| {
        use serialport::SerialPort as _;
        let (_device, mut port) = serialport::TTYPort::pair().unwrap();
        let text = format!("serial={}@460800", port.name().unwrap());
        // A second program locks any port when it opens it. A pair of terminals does not lock itself.
        port.set_exclusive(true).unwrap();
        let held = serialport::new(port.name().unwrap(), 460_800).open_native();
        let trouble = one(probe_named(&text).unwrap());
        assert!(matches!(trouble, Err(DeviceError::Busy { .. })), "{trouble:?} {}", held.is_ok());
    });
}

#[cfg(unix)]
#[test]
fn a_silent_port_is_trouble_unless_its_device_speaks_only_when_asked() {
    judged(|| {
        let (port, _stop) = talking(Vec::new);
        assert!(matches!(one(probe_named(&format!("serial={port}@460800")).unwrap()), Err(DeviceError::Silent { .. })));
        assert!(one(probe_named(&format!("serial={port}@460800,quiet")).unwrap()).is_ok());
    });
}

#[cfg(unix)]
#[test]
fn frames_are_recognised_and_noise_is_a_wrong_line_speed() {
    judged(|| {
        let mut random = fastrand::Rng::with_seed(4);
        let frame = move || {
            let mut frame: Vec<u8> = (0..37).map(|_| random.u8(..)).collect();
            frame[0] = 0xaa;
            frame
        };
        let (port, _stop) = talking(frame);
        let found = one(probe_named(&format!("serial={port}@460800,aa")).unwrap()).unwrap();
        assert!(found.readings > 20 && found.rate_hz.unwrap() > 20.0, "{found:?}");
        let mut random = fastrand::Rng::with_seed(5);
        let (port, _stop) = talking(move || (0..37).map(|_| random.u8(..)).collect());
        let trouble = one(probe_named(&format!("serial={port}@9600,aa")).unwrap()).unwrap_err();
        assert_eq!(trouble, DeviceError::WrongBaud { place: port, baud: 9600 });
        assert!(trouble.cure().contains("baud"));
    });
}

#[test]
fn headers_at_a_constant_distance_are_frames_and_accidents_are_not() {
    let mut random = fastrand::Rng::with_seed(9);
    for length in [5, 37, 61, 200] {
        let mut bytes: Vec<u8> = (0..length * 20).map(|_| random.u8(..)).collect();
        (7..bytes.len()).step_by(length).for_each(|at| bytes[at] = 0xaa);
        assert!(frames(&bytes, &[0xaa]).is_some_and(|count| (19..=20).contains(&count)), "{length}");
    }
    for _ in 0..200 {
        let bytes: Vec<u8> = (0..4000).map(|_| random.u8(..)).collect();
        assert_eq!(frames(&bytes, &[0xaa]), None);
    }
    assert_eq!(frames(&[], &[0xaa]), None);
    assert_eq!(frames(&[0xaa], &[0xaa, 0xbb]), None);
}

#[test]
fn settings_of_a_serial_probe_are_checked() {
    for wrong in ["/dev/ttyUSB0", "/dev/ttyUSB0@", "p@0", "p@9600,a", "p@9600,zz", "p@9600,"] {
        assert!(matches!(wrong.parse::<SerialProbe>(), Err(DeviceError::Setting { .. })), "{wrong}");
    }
    assert!("p@9600,aa55,quiet".parse::<SerialProbe>().is_ok());
    let Err(trouble) = probe_named("nonsense=1") else { panic!("it was made") };
    assert!(trouble.cure().contains("spacemouse") && trouble.cure().contains("serial=PORT@BAUD"));
}

/// Root may open every file. On Linux, this thread and the threads that it starts then lose this privilege.
#[cfg(unix)]
#[cfg_attr(target_os = "linux", expect(unsafe_code, reason = "std sets rights of whole processes only"))]
fn without_roots_rights<T>(action: impl FnOnce() -> T) -> T {
    #[cfg(target_os = "linux")]
    // SAFETY: takes a number (the user `nobody`), and affects this thread only.
    unsafe {
        libc::setfsuid(65_534);
    }
    action()
}

#[cfg(unix)]
#[test]
fn a_file_without_rights_asks_for_the_rule_of_just_that_device() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hidraw9");
    std::fs::write(&path, b"").unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    let tried = || one(probe_named(&format!("spacemouse={}", path.display())).unwrap());
    let trouble = std::thread::scope(|scope| scope.spawn(|| without_roots_rights(tried)).join().unwrap());
    assert!(matches!(&trouble, Err(DeviceError::Permission { udev, .. }) if udev.contains("hidraw")), "{trouble:?}");
}

#[test]
fn rules_name_every_device_of_the_project_and_the_kernels_keys() {
    for ids in ["0403", "256f", "046d", "0c45", "3553", "05f3", "1451"] {
        assert!(rules::RULES.contains(&format!("\"{ids}\"")), "{ids}");
    }
    for line in rules::RULES.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        assert!(line.contains("==\"") && line.matches('"').count() % 2 == 0, "{line}");
        assert!(["MODE=", "ATTR{latency_timer}=", "ENV{LIBINPUT"].iter().any(|key| line.contains(key)), "{line}");
        // Any user who is logged in at the computer, also without a group `plugdev`.
        assert_eq!(line.contains("MODE="), line.contains(r#"TAG+="uaccess""#), "{line}");
    }
    for model in nima_devices::hid::MODELS.iter().filter(|model| model.vendor == 0x046d) {
        let family = model.product >> 4;
        let last = model.product & 15;
        assert!(family == 0xc62 && ((5..=9).contains(&last) || last == 0xb), "{} is not in the rules", model.name);
    }
    assert!(rules::install_command("/a b/nima").starts_with("'/a b/nima' devices --udev-rules | sudo tee"));
}

#[cfg(unix)]
#[test]
fn what_is_plugged_in_is_read_from_the_kernels_files() {
    use std::os::unix::fs::symlink;

    use nima_devices::discovery::{PluggedDevices, SerialPort};

    let folder = tempfile::tempdir().unwrap();
    let sys = folder.path();
    let put = |path: &str, text: &str| {
        let path = sys.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    let link = |from: &str, to: &str| {
        let from = sys.join(from);
        std::fs::create_dir_all(from.parent().unwrap()).unwrap();
        symlink(sys.join(to), from).unwrap();
    };
    // A U2D2, a port that the board lacks, one that it has, a virtual console, a cap, a mouse, a haptic device.
    put("devices/usb1/1-2/idVendor", "0403\n");
    put("devices/usb1/1-2/idProduct", "6014\n");
    put("devices/usb1/1-2/product", "USB <-> Serial Converter\n");
    put("devices/usb1/1-2/serial", "FT4THC\n");
    put("devices/usb1/1-2/1-2:1.0/ttyUSB0/x", "");
    link("class/tty/ttyUSB0/device", "devices/usb1/1-2/1-2:1.0/ttyUSB0");
    put("class/tty/ttyUSB0/type", "0x0\n");
    put("devices/board/serial/x", "");
    link("class/tty/ttyS0/device", "devices/board/serial");
    put("class/tty/ttyS0/type", "4\n");
    link("class/tty/ttyS1/device", "devices/board/serial");
    put("class/tty/ttyS1/type", "0\n");
    put("class/tty/tty1/active", "");
    put(
        "class/hidraw/hidraw0/device/uevent",
        "DRIVER=hid\nHID_ID=0003:0000046D:0000C626\nHID_NAME=3Dconnexion Cap\nHID_UNIQ=\n",
    );
    put("class/hidraw/hidraw1/device/uevent", "HID_ID=0003:0000046D:0000C077\nHID_NAME=Mouse");
    put("class/hidraw/hidraw2/device/uevent", "HID_ID=nonsense");
    put("bus/usb/devices/1-3/idVendor", "1451");
    put("bus/usb/devices/1-3/idProduct", "0402");
    put("bus/usb/devices/1-2/idVendor", "0403");
    let plugged = PluggedDevices::under(sys);
    let paths: Vec<_> = plugged.serial.iter().map(|port| port.path.display().to_string()).collect();
    assert_eq!(paths, ["/dev/ttyS0", "/dev/ttyUSB0"]);
    let Some(SerialPort { usb: Some(ids), .. }) = plugged.serial.last() else { panic!("{plugged:?}") };
    assert_eq!((ids.vendor, ids.product, ids.serial.as_str()), (0x0403, 0x6014, "FT4THC"));
    assert_eq!(
        rules::of_serial(Some(ids)),
        r#"SUBSYSTEM=="tty", ATTRS{idVendor}=="0403", ATTRS{idProduct}=="6014", MODE="0660", GROUP="plugdev", TAG+="uaccess""#
    );
    let used: Vec<_> = plugged.hid.iter().map(|node| (node.usb.name.as_str(), node.usable_as)).collect();
    assert_eq!(used, [("3Dconnexion Cap", Some("SpaceMouse")), ("Mouse", None)]);
    assert_eq!(plugged.usb.len(), 1);
    assert_eq!(plugged.usb[0].usb.product, 0x0402);
    assert_eq!(PluggedDevices::under(&sys.join("nothing")), PluggedDevices::default());
}

#[cfg(target_os = "linux")]
#[test]
fn an_emulated_cap_and_pedal_are_diagnosed_over_their_sockets() {
    judged(|| {
        use crate::emulators::hid::{CapBody, CapModel, PedalBody, PedalModel, cap, pedal};
        let cap = cap(None, CapModel::Split, CapBody::alone()).serve().unwrap();
        let pedal = pedal(None, PedalModel::Switches, PedalBody::alone()).serve().unwrap();
        let named = |kind: &str, place: &str| probe_named(&format!("{kind}={place}")).unwrap();
        let found = one(named("spacemouse", &cap.endpoint)).unwrap();
        assert!(found.identity.product.contains("046d:c626") && found.damaged == 0, "{found:?}");
        assert!(one(named("pedal", &pedal.endpoint)).is_ok());
        assert!(matches!(one(named("pedal", &cap.endpoint)), Err(DeviceError::WrongProduct { .. })));
    });
}
