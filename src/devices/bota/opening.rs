//! Opens and configures a sensor, for the three types of connection; every failure has its cause. Blocks.

use std::{
    net::{IpAddr, SocketAddr, ToSocketAddrs as _, UdpSocket},
    time::{Duration, Instant},
};

use nima_files::quoted;

use super::{
    BotaSettings, Transport,
    codec::{BotaFrame, STATUS_BITS},
    gen_a, gen0,
    link::BotaLink,
    session::{BotaSession, BotaTimeouts},
};
use crate::{
    DeviceError, DeviceIdentity,
    transport::{Serial, SerialSettings, Tcp, TransportDatagrams, Udp},
};

pub(super) struct OpenSensor {
    pub(super) link: BotaLink,
    pub(super) identity: DeviceIdentity,
    pub(super) rate_hz: f64,
    /// Whether the port delivers bytes without delay (always true for the network).
    pub(super) low_latency: bool,
    /// The command that stops the measurement.
    pub(super) stop: &'static [u8],
}

/// TCP port for commands of a network sensor, to which the manufacturer's driver connects, too.
pub const TCP_PORT: u16 = 23;
/// Maximum number of restarts of a first-generation sensor that has not loaded its calibration, as in `RoboComp`'s
/// `bota_force_sensor`: some sensors occasionally start with the calibration inactive.
const RESTARTS: u32 = 5;
// Parameter 1.2 (requested state), value 1 (Config).
const STOP_GEN_A: &[u8] = b"wh,1,2,1\n";
const FIRST_GENERATION: &str = "first-generation Bota sensor";
const SECOND_GENERATION: &str = "second-generation Bota sensor";

pub(super) fn open(settings: &BotaSettings, timeouts: BotaTimeouts) -> Result<OpenSensor, DeviceError> {
    settings.check()?;
    match settings.transport {
        Transport::Gen0 => open_gen0(settings, timeouts),
        Transport::GenA => open_gen_a(settings, timeouts),
        Transport::Socket => open_socket(settings, timeouts),
    }
}

fn serial(settings: &BotaSettings, timeouts: BotaTimeouts) -> Result<(BotaSession, bool), DeviceError> {
    let line = Serial::open(&SerialSettings { port: settings.port.clone(), baud: settings.baud })?;
    let low_latency = line.has_low_latency();
    Ok((BotaSession::new(Box::new(line), &settings.port, timeouts), low_latency))
}

fn open_gen0(settings: &BotaSettings, timeouts: BotaTimeouts) -> Result<OpenSensor, DeviceError> {
    let (mut session, low_latency) = serial(settings, timeouts)?;
    let mut boot = gen0::BootText::default();
    session.listen(timeouts.boot, |received| {
        boot = gen0::BootText::of(received);
        boot.firmware.is_some().then_some(())
    })?;
    enter_config_gen0(&mut session, settings)?;
    let identity = identity_gen0(&mut session, boot)?;
    check_serial(settings, &identity)?;
    let rate_hz = settings.expected_hz();
    for _ in 0..=RESTARTS {
        configure_gen0(&mut session, settings)?;
        let place = session.place.clone();
        let mut link = BotaLink::new(session.into_line(), None);
        match first_readings(&mut link, &place, rate_hz, settings, timeouts) {
            // The only fault that a restart may clear; every other one needs a person.
            Err(DeviceError::DeviceFault { words, .. }) if words == RAW => {
                session = BotaSession::new(link.into_lines().0, &place, timeouts);
                restart_gen0(&mut session, settings)?;
            }
            Err(other) => return Err(other),
            Ok(()) => return Ok(OpenSensor { link, identity, rate_hz, low_latency, stop: gen0::CONFIG }),
        }
    }
    Err(fault_of(&settings.port, RAW_BIT))
}

/// Stops the stream. Any unexpected answer indicates the problem.
fn enter_config_gen0(session: &mut BotaSession, settings: &BotaSettings) -> Result<(), DeviceError> {
    for _ in 0..session.timeouts.tries {
        match session.ask(gen0::CONFIG, |received| gen0::acknowledged(received, b'C'))? {
            Some(0) => return session.flush(),
            Some(code) => return Err(refused(session, "C", &format!("code {code}"))),
            None => {}
        }
    }
    // No answer to its own protocol: ask in the other one, so that a swapped setting is named instead of a silent line.
    if session.ask(gen_a::read(gen_a::SERIAL).as_bytes(), |received| gen_a::answer(received, b"rh"))?.is_some() {
        return Err(wrong_generation(session, FIRST_GENERATION, SECOND_GENERATION));
    }
    Err(session.why_no_answer("C", Some(settings.baud)))
}

/// Reads the identity with the command of the manufacturer's driver, or from the text that the sensor sends at start,
/// because not every firmware supports the command.
fn identity_gen0(session: &mut BotaSession, boot: gen0::BootText) -> Result<DeviceIdentity, DeviceError> {
    let asked = session.ask(gen0::PRODUCT, |received| {
        gen0::acknowledged(received, b'p').map(|code| (code == 0).then(|| gen0::product(received)).flatten())
    })?;
    let (serial, product) = asked.flatten().unzip();
    Ok(DeviceIdentity {
        product: product.or(boot.product).unwrap_or_default(),
        serial: serial.or(boot.serial).unwrap_or_default(),
        firmware: boot.firmware.unwrap_or_default(),
    })
}

/// Configures communication, filter and offset, then starts the measurement. Nothing is saved in the sensor, whose
/// memory wears out; it is configured every time.
fn configure_gen0(session: &mut BotaSession, settings: &BotaSettings) -> Result<(), DeviceError> {
    let baud_index = gen0::BAUDS.iter().position(|baud| *baud == settings.baud).unwrap_or_default();
    let communication = gen0::communication(baud_index);
    let filter = gen0::filter(settings.sinc);
    // The measurement starts last: otherwise the answers would be hidden between frames.
    for command in [communication.as_bytes(), filter.as_bytes(), gen0::NO_OFFSET, gen0::RUN] {
        let name = String::from_utf8_lossy(command);
        match session.ask(command, |received| gen0::acknowledged(received, command[0]))? {
            Some(0) => {}
            Some(code) => return Err(refused(session, name.trim(), &format!("code {code}"))),
            None => return Err(refused(session, name.trim(), "no answer")),
        }
    }
    Ok(())
}

fn restart_gen0(session: &mut BotaSession, settings: &BotaSettings) -> Result<(), DeviceError> {
    session.ask(gen0::INIT, |received| gen0::acknowledged(received, b'I'))?;
    session.listen(session.timeouts.init, |_| None::<()>)?;
    enter_config_gen0(session, settings)
}

fn open_gen_a(settings: &BotaSettings, timeouts: BotaTimeouts) -> Result<OpenSensor, DeviceError> {
    let (mut session, low_latency) = serial(settings, timeouts)?;
    enter_config_gen_a(&mut session, Some(settings.baud))?;
    let identity = identity_gen_a(&mut session)?;
    check_serial(settings, &identity)?;
    let rate_hz = configure_gen_a(&mut session, settings)?;
    let mut link = BotaLink::new(session.into_line(), None);
    first_readings(&mut link, &settings.port, rate_hz, settings, timeouts)?;
    Ok(OpenSensor { link, identity, rate_hz, low_latency, stop: STOP_GEN_A })
}

fn open_socket(settings: &BotaSettings, timeouts: BotaTimeouts) -> Result<OpenSensor, DeviceError> {
    let address = address_of(&settings.port)?;
    let line = Tcp::open(&address.to_string(), timeouts.stream)?;
    let here = line.local_ip();
    let mut session = BotaSession::new(Box::new(line), &address.to_string(), timeouts);
    enter_config_gen_a(&mut session, None)?;
    let mut destination = [0; 4];
    for (part, byte) in (gen_a::DESTINATION.1..).zip(&mut destination) {
        let value = number(&mut session, (gen_a::DESTINATION.0, part))?;
        *byte = u8::try_from(value).map_err(|_| refused(&session, "rh,30", &format!("{value:x} is not a byte")))?;
    }
    let port = number(&mut session, gen_a::DESTINATION_PORT)?;
    let port = u16::try_from(port).map_err(|_| refused(&session, "rh,31,1", &format!("{port:x} is not a port")))?;
    let destination = SocketAddr::new(destination.into(), port);
    let stream: Box<dyn TransportDatagrams> = Box::new(readings(destination, here, address)?);
    let identity = identity_gen_a(&mut session)?;
    check_serial(settings, &identity)?;
    let rate_hz = configure_gen_a(&mut session, settings)?;
    let mut link = BotaLink::new(session.into_line(), Some(stream));
    match first_readings(&mut link, &address.to_string(), rate_hz, settings, timeouts) {
        Err(DeviceError::Silent { place }) => Err(sends_elsewhere(place, address, destination)),
        Err(other) => Err(other),
        Ok(()) => Ok(OpenSensor { link, identity, rate_hz, low_latency: true, stop: STOP_GEN_A }),
    }
}

/// Returns the sensor's address; it supports IPv4 only.
fn address_of(port: &str) -> Result<SocketAddr, DeviceError> {
    let unreachable = || DeviceError::Unreachable { place: port.to_owned() };
    let resolved = match port.parse::<IpAddr>() {
        Ok(ip) => Some(SocketAddr::new(ip, TCP_PORT)),
        Err(_) if port.contains(':') => port.to_socket_addrs().map_err(|_| unreachable())?.find(SocketAddr::is_ipv4),
        Err(_) => (port, TCP_PORT).to_socket_addrs().map_err(|_| unreachable())?.find(SocketAddr::is_ipv4),
    };
    resolved.ok_or_else(unreachable)
}

/// Opens the socket for readings: at the address to which the sensor sends, if it belongs to this computer, otherwise
/// at the address through which the sensor is reached. Never at all addresses, so that another network cannot inject
/// readings.
fn readings(destination: SocketAddr, here: Option<IpAddr>, sensor: SocketAddr) -> Result<Udp, DeviceError> {
    let at = Some(destination.ip()).filter(|ip| Udp::is_local(*ip)).or(here);
    let at = at.ok_or_else(|| DeviceError::Unreachable { place: sensor.to_string() })?;
    Udp::listen(SocketAddr::new(at, destination.port()), sensor.ip())
}

/// Returns the error for missing readings: checks whether the sensor sends them to another computer.
fn sends_elsewhere(place: String, sensor: SocketAddr, to: SocketAddr) -> DeviceError {
    // Connecting a UDP socket sends nothing, but makes the system choose the interface towards the sensor.
    let route = UdpSocket::bind(("0.0.0.0", 0)).and_then(|socket| {
        socket.connect(sensor)?;
        socket.local_addr()
    });
    match route {
        Ok(here) if here.ip() != to.ip() => {
            DeviceError::SendsElsewhere { place, to: to.to_string(), here: here.ip().to_string() }
        }
        _ => DeviceError::Silent { place },
    }
}

fn enter_config_gen_a(session: &mut BotaSession, baud: Option<u32>) -> Result<(), DeviceError> {
    let command = gen_a::write(gen_a::STATE, gen_a::CONFIG);
    for _ in 0..session.timeouts.tries {
        match session.ask(command.as_bytes(), |received| gen_a::answer(received, b"wh"))? {
            Some(answer) if answer.status == 0 => return session.flush(),
            Some(answer) => return Err(refused(session, command.trim(), gen_a::words(answer.status))),
            None => {}
        }
    }
    // Not over a network, where the first generation does not exist.
    if baud.is_some() && session.ask(gen0::CONFIG, |received| gen0::acknowledged(received, b'C'))?.is_some() {
        return Err(wrong_generation(session, SECOND_GENERATION, FIRST_GENERATION));
    }
    Err(session.why_no_answer(command.trim(), baud))
}

fn identity_gen_a(session: &mut BotaSession) -> Result<DeviceIdentity, DeviceError> {
    let mut text = |parameter| {
        let command = gen_a::read(parameter);
        let answer = good(session, &command)?;
        answer.text().ok_or_else(|| refused(session, command.trim(), &format!("{} is not text", answer.value)))
    };
    Ok(DeviceIdentity {
        product: text(gen_a::PRODUCT)?,
        serial: text(gen_a::SERIAL)?,
        firmware: text(gen_a::FIRMWARE)?,
    })
}

/// Configures frames, rate and offset, then starts the measurement; returns the rate that the sensor reports, Hz.
fn configure_gen_a(session: &mut BotaSession, settings: &BotaSettings) -> Result<f64, DeviceError> {
    let mut writes = vec![
        (gen_a::MODE, u32::from(settings.mode)),
        (gen_a::SUBMODE, settings.submode().unwrap_or_default()),
        (gen_a::OUTPUT_RATE, 0),
    ];
    // An offset stored by another program would shift every force, and our own calibration determines the bias.
    let zero = 0_f32.to_bits();
    writes.extend((0..6).map(|part| ((gen_a::OFFSET.0, gen_a::OFFSET.1 + part), zero)));
    for (parameter, value) in writes {
        good(session, &gen_a::write(parameter, value))?;
    }
    let reported_hz = number(session, gen_a::RATE)?;
    // 1 Hz may be rounding; with a larger difference the sensor has kept another rate.
    if reported_hz.abs_diff(settings.rate_hz) > 1 {
        let command = format!("{} Hz", settings.rate_hz);
        return Err(refused(session, &command, &format!("its rate is {reported_hz} Hz")));
    }
    good(session, &gen_a::write(gen_a::STATE, gen_a::RUN))?;
    Ok(f64::from(reported_hz))
}

/// Sends a command and requires a good answer.
fn good(session: &mut BotaSession, command: &str) -> Result<gen_a::GenAAnswer, DeviceError> {
    let letters = if command.starts_with("wh") { b"wh" } else { b"rh" };
    match session.ask(command.as_bytes(), |received| gen_a::answer(received, letters))? {
        Some(answer) if answer.status == 0 => Ok(answer),
        Some(answer) => {
            let words = format!("{} ({})", gen_a::words(answer.status), answer.status);
            Err(refused(session, command.trim(), &words))
        }
        None => Err(refused(session, command.trim(), "no answer")),
    }
}

fn number(session: &mut BotaSession, parameter: gen_a::Parameter) -> Result<u32, DeviceError> {
    let command = gen_a::read(parameter);
    let answer = good(session, &command)?;
    answer.number().ok_or_else(|| refused(session, command.trim(), &format!("{} is not a number", answer.value)))
}

fn refused(session: &BotaSession, command: &str, answer: &str) -> DeviceError {
    DeviceError::Refused { place: session.place.clone(), command: format!("\"{command}\""), answer: quoted(answer) }
}

fn wrong_generation(session: &BotaSession, expected: &str, found: &str) -> DeviceError {
    DeviceError::WrongProduct { place: session.place.clone(), expected: expected.to_owned(), found: found.to_owned() }
}

fn check_serial(settings: &BotaSettings, identity: &DeviceIdentity) -> Result<(), DeviceError> {
    if settings.accepts_serial(&identity.serial) {
        return Ok(());
    }
    let expected = settings.serial_number.clone().unwrap_or_default();
    let found = if identity.serial.is_empty() { "unknown" } else { &identity.serial };
    Err(DeviceError::OtherSerial { place: settings.port.clone(), expected, found: found.to_owned() })
}

/// Number of readings examined before a sensor counts as open.
/// Six readings have five intervals, whose median bridges two lost frames.
const FIRST_READINGS: usize = 6;
/// Maximum factor between the measured and the reported rate, because of jitter and rounding.
const RATE_FACTOR: f64 = 1.2;
const RAW: &str = "its calibration is not loaded (raw)";

/// Waits for readings that are usable and have the right rate and format.
fn first_readings(
    link: &mut BotaLink,
    place: &str,
    rate_hz: f64,
    settings: &BotaSettings,
    timeouts: BotaTimeouts,
) -> Result<(), DeviceError> {
    // The time of the readings at their rate, and two more that may be lost.
    let wait = timeouts.stream + Duration::from_secs_f64((FIRST_READINGS + 2) as f64 / rate_hz);
    let begin = Instant::now();
    let place = place.to_owned();
    let mut frames: Vec<BotaFrame> = Vec::new();
    while frames.len() < FIRST_READINGS {
        link.receive(|frame| frames.push(frame))
            .map_err(|_| DeviceError::Other { place: place.clone(), reason: "the connection broke".to_owned() })?;
        if begin.elapsed() > wait {
            return Err(match settings.transport {
                Transport::Gen0 | Transport::GenA if link.skipped() > 0 && frames.is_empty() => {
                    DeviceError::WrongBaud { place, baud: settings.baud }
                }
                _ => DeviceError::Silent { place },
            });
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let newest = frames[frames.len() - 1];
    if newest.inertial.is_some() != settings.is_inertial() {
        let command = format!("mode {}", settings.mode);
        return Err(DeviceError::Refused { place, command, answer: "frames in a different format".to_owned() });
    }
    // Throttled frames are usable: the sensor skipped some, but those that arrive are right.
    if newest.status & STATUS_BITS & !THROTTLED_BIT != 0 {
        return Err(fault_of(&place, newest.status));
    }
    let mut steps_us: Vec<u32> =
        frames.windows(2).map(|pair| pair[1].timestamp_us.wrapping_sub(pair[0].timestamp_us)).collect();
    // The median, because one frame lost on the line would double a mean of so few.
    steps_us.sort_unstable();
    let measured_hz = 1e6 / f64::from(steps_us[steps_us.len() / 2].max(1));
    if measured_hz > rate_hz * RATE_FACTOR || measured_hz < rate_hz / RATE_FACTOR {
        let command = format!("{rate_hz:.0} Hz");
        let answer = format!("it measures at {measured_hz:.0} Hz");
        return Err(DeviceError::Refused { place, command, answer });
    }
    Ok(())
}

// Bits of the status word (`rokubimini_serial`): 0 throttled, 1 overrange, 2 invalid, 3 raw.
const THROTTLED_BIT: u16 = 1;
const INVALID_BIT: u16 = 1 << 2;
const RAW_BIT: u16 = 1 << 3;

/// Returns the fault that the status bits indicate.
fn fault_of(place: &str, status: u16) -> DeviceError {
    let (words, cure) = if status & RAW_BIT != 0 {
        (RAW, "Switch the sensor off and on again.")
    } else if status & INVALID_BIT != 0 {
        (
            "saturated, shorted or open (invalid)",
            "Remove every load from it; if this persists, the sensor may be damaged.",
        )
    } else {
        ("load above its range (overrange)", "Remove the load from the sensor.")
    };
    DeviceError::DeviceFault { place: place.to_owned(), words: words.to_owned(), cure: cure.to_owned() }
}
