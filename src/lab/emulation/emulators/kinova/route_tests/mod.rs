//! The device route and the base's own motions, over real sockets.

mod actions;
mod golden;

use std::{
    io::{Read as _, Write as _},
    net::TcpStream,
    time::{Duration, Instant},
};

use nima_devices::kinova::{
    KinovaSettings,
    frame::{KinovaHeader, NOTIFICATION, PacketReader, REQUEST, RESPONSE, encode_packet},
    messages::{CreateSessionInfo, ErrorInfo, JointAngles, KinovaNumber, Rpc, sub},
};
use nima_testing::real_time::judged;
use prost::Message;

use super::{
    EmulatedKinova, StandIn,
    forms::{JointsLimit, KinematicLimits, TwistLimit},
    interface::{ABOVE_MAXIMUM, INVALID_PARAM, InterfaceError, JOINT_COUNT},
};
use crate::emulators::EmulatorThread;

const HOME_DEG: [f64; 7] = [0.0, 15.0, 180.0, -130.0, 0.0, 55.0, 90.0];
/// Maximum wait for an answer or a notification.
const TIMEOUT: Duration = Duration::from_secs(30);

/// A client that is independent of the emulator's code.
struct Client {
    stream: TcpStream,
    packets: PacketReader,
    session: u16,
    message: u16,
    report: Vec<(KinovaHeader, Vec<u8>)>,
}

impl Client {
    fn connect(serving: &EmulatorThread) -> Self {
        let settings = KinovaSettings::at(&serving.endpoint).unwrap();
        let stream = TcpStream::connect((settings.host.as_str(), settings.tcp_port)).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        let mut client = Self { stream, packets: PacketReader::default(), session: 0, message: 0, report: Vec::new() };
        let login = CreateSessionInfo {
            username: "admin".to_owned(),
            session_inactivity_ms: 60_000,
            password: "admin".to_owned(),
            connection_inactivity_ms: 60_000,
        };
        client.ask(0, Rpc::CREATE_SESSION, &login).unwrap();
        client
    }

    fn frame(&mut self) -> (KinovaHeader, Vec<u8>) {
        let asked = Instant::now();
        loop {
            if let Some(frame) = self.packets.next_frame() {
                return (frame.header, frame.payload.to_vec());
            }
            assert!(asked.elapsed() < TIMEOUT, "nothing comes");
            let count = self.stream.read(self.packets.room()).expect("an answer");
            assert!(count > 0, "the connection is closed");
            self.packets.filled(count);
        }
    }

    fn answer(&mut self) -> (KinovaHeader, Vec<u8>) {
        loop {
            let (header, payload) = self.frame();
            if header.kind == RESPONSE {
                return (header, payload);
            }
            self.report.push((header, payload));
        }
    }

    fn ask(&mut self, device: u8, rpc: Rpc, question: &impl Message) -> Result<Vec<u8>, InterfaceError> {
        self.message += 1;
        let Rpc { service, function } = rpc;
        let session = self.session;
        let message = self.message;
        let header =
            KinovaHeader { kind: REQUEST, device, session, message, service, function, ..KinovaHeader::default() };
        let mut out = Vec::new();
        encode_packet(&header, question, &mut out);
        self.stream.write_all(&out).unwrap();
        let (answer, payload) = self.answer();
        assert_eq!((answer.message, answer.rpc(), answer.device), (message, rpc, device));
        if answer.error == 0 {
            self.session = answer.session;
            return Ok(payload);
        }
        let report = ErrorInfo::decode(payload.as_slice()).unwrap();
        assert_eq!((report.code, report.sub_code), (u32::from(answer.error), u32::from(answer.sub_error)));
        assert!(!report.text.is_empty());
        Err((answer.error, answer.sub_error))
    }

    fn read<T: Message + Default>(&mut self, device: u8, rpc: Rpc, question: &impl Message) -> T {
        T::decode(self.ask(device, rpc, question).unwrap().as_slice()).unwrap()
    }

    fn subscribe(&mut self, topic: Rpc) -> u32 {
        self.read::<KinovaNumber>(0, topic, &()).value
    }

    /// Returns the next notification.
    fn next_report<T: Message + Default>(&mut self, topic: Rpc, subscription: u32) -> T {
        if self.report.is_empty() {
            let frame = self.frame();
            self.report.push(frame);
        }
        let (header, payload) = self.report.remove(0);
        assert_eq!((header.kind, header.rpc(), u32::from(header.message)), (NOTIFICATION, topic, subscription));
        T::decode(payload.as_slice()).unwrap()
    }

    fn angles_deg(&mut self) -> Vec<f32> {
        let angles: JointAngles = self.read(0, Rpc::MEASURED_ANGLES, &());
        angles.angles.iter().map(|angle| angle.value_deg).collect()
    }

    fn is_at(&mut self, degrees: [f64; 7]) -> bool {
        let turned = |(is, wanted): (&f32, f64)| (f64::from(*is) - wanted + 180.0).rem_euclid(360.0) - 180.0;
        self.angles_deg().iter().zip(degrees).map(turned).all(|off| off.abs() < 0.1)
    }
}

fn arm(degrees: [f64; 7]) -> EmulatorThread {
    EmulatedKinova::default().with(StandIn::at(degrees.map(f64::to_radians))).serve().unwrap()
}

const fn of(service: u16, function: u16) -> Rpc {
    Rpc { service, function }
}

#[test]
fn each_device_answers_for_itself_and_keeps_what_is_set() {
    judged(|| {
        let serving = arm(HOME_DEG);
        let mut client = Client::connect(&serving);
        let kinds: Vec<u32> = (0..9).map(|device| client.read::<KinovaNumber>(device, of(9, 3), &()).value).collect();
        assert_eq!(kinds, [1, 3, 3, 3, 3, 4, 4, 4, 5]);
        for function in [4, 5, 6, 7, 8, 9, 12] {
            assert!((0..9).all(|device| !client.ask(device, of(9, function), &()).unwrap().is_empty()), "{function}");
        }
        client.ask(6, of(10, 7), &KinovaNumber { value: 6 }).unwrap();
        assert_eq!(client.ask(6, of(10, 7), &KinovaNumber { value: 7 }), Err(INVALID_PARAM));
        let modes: Vec<u32> = (1..8).map(|device| client.read::<KinovaNumber>(device, of(10, 6), &()).value).collect();
        assert_eq!(modes, [1, 1, 1, 1, 1, 6, 1]);
        assert!(client.ask(3, of(10, 25), &()).is_ok());
        assert_eq!(client.ask(8, of(10, 25), &()), Err((1, sub::UNSUPPORTED_SERVICE)));
        assert_eq!(client.ask(3, Rpc::ARM_STATE, &()), Err((1, sub::UNSUPPORTED_SERVICE)));
        assert_eq!(client.ask(9, Rpc::SERIAL_NUMBER, &()), Err((3, 50)));
    });
}

#[test]
fn limits_are_kept_per_mode_and_set_back_and_never_above_the_arms() {
    judged(|| {
        let serving = arm(HOME_DEG);
        let mut client = Client::connect(&serving);
        let hard: KinematicLimits = client.read(0, of(16, 18), &());
        assert_eq!((hard.linear_m_s, hard.joint_deg_s.len(), hard.joint_deg_s2.len()), (0.5, 7, 7));
        let limit = |value| TwistLimit { mode: 5, value };
        client.ask(0, of(16, 15), &limit(0.2)).unwrap();
        assert_eq!(client.ask(0, of(16, 15), &limit(0.6)), Err(ABOVE_MAXIMUM));
        assert_eq!(client.ask(0, of(16, 15), &limit(f32::NAN)), Err(INVALID_PARAM));
        assert_eq!(client.ask(0, of(16, 14), &JointsLimit { mode: 1, values: vec![1.0; 6] }), Err(JOINT_COUNT));
        let soft = |client: &mut Client, mode: u32| {
            client.read::<KinematicLimits>(0, of(16, 19), &KinovaNumber { value: mode }).linear_m_s
        };
        assert_eq!((soft(&mut client, 5), soft(&mut client, 2)), (0.2, 0.5));
        assert_eq!(client.read::<TwistLimit>(0, of(16, 29), &KinovaNumber { value: 5 }), limit(0.5));
        assert_eq!((soft(&mut client, 5), soft(&mut client, 1)), (0.5, 0.5));
        assert_eq!(client.ask(0, of(16, 19), &KinovaNumber { value: 3 }), Err(INVALID_PARAM));
    });
}
