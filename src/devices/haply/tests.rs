//! The driver with a handle that lives in the test and answers at once.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex},
};

use nalgebra::Vector3;

use super::{
    CENTRE_M, HaplyDriver, HaplySettings,
    codec::{DeviceInfo, HaplyState, STATE, STATE_BYTES, WAKE_UP, force_of, force_request},
};
use crate::{
    ConnectionState, Device as _, DeviceError, HandleReading, Leader as _, Lever, Loss, transport::ByteStream,
};

const INFO: DeviceInfo = DeviceInfo { id: 0x049D, model: 4, hardware: 2, firmware: 9, uuid: [7; 16] };

/// State of the device and the requests that it received.
struct Inner {
    state: HaplyState,
    waiting: VecDeque<u8>,
    forces_n: Vec<[f32; 3]>,
    /// Whether the device answers, and whether it is connected.
    answers: bool,
    gone: bool,
    /// Sent instead of an answer.
    instead: Option<Vec<u8>>,
    /// Byte of an older answer that arrives with the next position.
    late: Option<u8>,
}

#[derive(Clone)]
struct Fake(Arc<Mutex<Inner>>);

impl Fake {
    fn new() -> Self {
        let state = HaplyState { position_m: CENTRE_M.map(|axis| axis as f32), velocity_m_s: [0.0; 3] };
        // The rest of an older answer.
        let waiting = VecDeque::from([0x2B, 1, 2]);
        let inner =
            Inner { state, waiting, forces_n: Vec::new(), answers: true, gone: false, instead: None, late: None };
        Self(Arc::new(Mutex::new(inner)))
    }

    fn change(&self, change: impl FnOnce(&mut Inner)) {
        change(&mut self.0.lock().unwrap());
    }

    fn newest_n(&self) -> Vector3<f64> {
        Vector3::from(*self.0.lock().unwrap().forces_n.last().unwrap()).map(f64::from)
    }
}

impl ByteStream for Fake {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss> {
        let mut inner = self.0.lock().unwrap();
        if inner.gone {
            return Err(Loss::Disconnected);
        }
        // A serial port may deliver this few bytes at a time.
        let count = inner.waiting.len().min(buffer.len()).min(STATE_BYTES);
        buffer.iter_mut().zip(inner.waiting.drain(..count)).for_each(|(to, byte)| *to = byte);
        Ok(count)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        let mut inner = self.0.lock().unwrap();
        if inner.gone {
            return Err(Loss::Disconnected);
        }
        inner.forces_n.extend(force_of(bytes));
        let answer = match &inner.instead {
            _ if !inner.answers => Vec::new(),
            Some(instead) => instead.clone(),
            None if bytes == [WAKE_UP] => INFO.encode().to_vec(),
            None => inner.state.encode().to_vec(),
        };
        let late = if bytes == [WAKE_UP] { None } else { inner.late.take() };
        inner.waiting.extend(late);
        inner.waiting.extend(answer);
        Ok(())
    }
}

fn opened(settings: &HaplySettings) -> (Fake, HaplyDriver) {
    let fake = Fake::new();
    let driver = HaplyDriver::over(Box::new(fake.clone()), settings).unwrap();
    (fake, driver)
}

#[test]
fn a_late_byte_before_the_first_position_is_skipped() {
    for late in [0x2B, STATE] {
        let fake = Fake::new();
        fake.change(|inner| inner.late = Some(late));
        assert!(HaplyDriver::over(Box::new(fake), &HaplySettings::at("/dev/ttyACM0")).is_ok(), "{late:#x}");
    }
}

/// Runs ticks of the loop with this force; returns the newest reading.
fn ticks(driver: &mut HaplyDriver, now_s: &mut f64, count: u32, force_n: Vector3<f64>) -> Option<HandleReading> {
    let mut newest = None;
    for _ in 0..count {
        *now_s += 1e-3;
        newest = driver.poll(*now_s).map(|stamped| stamped.value);
        driver.set_force(force_n, 0.0);
    }
    newest
}

#[test]
fn it_tells_where_the_grip_is_from_the_centre_and_takes_a_force_within_its_limit() {
    let (fake, mut driver) = opened(&HaplySettings::at("/dev/ttyACM0"));
    let mut now_s = 0.0;
    assert_eq!((driver.identity().serial.as_str(), driver.identity().firmware.as_str()), ("049D", "9"));
    fake.change(|inner| inner.state.velocity_m_s = [0.25, 0.0, -0.5]);
    fake.change(|inner| inner.state.position_m[2] += 0.0625);
    let reading = ticks(&mut driver, &mut now_s, 5, Vector3::x()).unwrap();
    assert!((reading.position_m - Vector3::new(0.0, 0.0, 0.0625)).norm() < 1e-6, "{reading:?}");
    assert_eq!(reading.velocity_m_s, Some(Vector3::new(0.25, 0.0, -0.5)));
    assert_eq!((reading.orientation, reading.gripper_rad), (None, None));
    assert_eq!((fake.newest_n(), driver.force_change()), (Vector3::zeros(), Some(false)), "it is not switched on");
    driver.switch_force(true);
    ticks(&mut driver, &mut now_s, 3, Vector3::x());
    assert_eq!((fake.newest_n(), driver.force_change()), (Vector3::x(), Some(true)));
    ticks(&mut driver, &mut now_s, 1, Vector3::new(-1e300, 1e300, 0.0));
    let size_n = fake.newest_n().norm();
    assert!((size_n - 4.0).abs() < 1e-5, "{size_n}");
    ticks(&mut driver, &mut now_s, 1, Vector3::new(f64::NAN, 1.0, 1.0));
    assert_eq!(fake.newest_n(), Vector3::zeros());
    ticks(&mut driver, &mut now_s, 1, Vector3::x());
    let lever = Lever::default();
    driver.attach(&lever);
    assert!(lever.pull());
    ticks(&mut driver, &mut now_s, 1, Vector3::x());
    assert_eq!(fake.newest_n(), Vector3::zeros());
    driver.switch_force(true);
    ticks(&mut driver, &mut now_s, 1, Vector3::x());
    assert_eq!(fake.newest_n(), Vector3::x());
    drop(driver);
    assert_eq!(fake.newest_n(), Vector3::zeros(), "closing it removes the force");
}

#[test]
fn each_question_has_one_answer_and_without_one_the_next_is_asked_in_time() {
    let (fake, mut driver) = opened(&HaplySettings::at("/dev/ttyACM0"));
    let mut now_s = 0.0;
    ticks(&mut driver, &mut now_s, 100, Vector3::zeros());
    let asked = fake.0.lock().unwrap().forces_n.len();
    assert!((101..=103).contains(&asked), "{asked}");
    fake.change(|inner| inner.answers = false);
    ticks(&mut driver, &mut now_s, 12, Vector3::zeros());
    assert!(fake.0.lock().unwrap().forces_n.len() - asked <= 6, "nothing piles up");
    fake.change(|inner| inner.answers = true);
    assert!(ticks(&mut driver, &mut now_s, 8, Vector3::zeros()).is_some(), "{:?}", driver.health());
    assert!(driver.health().lost >= 2);
}

#[test]
fn what_is_wrong_is_told_in_time() {
    let run = |change: fn(&mut Inner)| {
        let (fake, mut driver) = opened(&HaplySettings::at("/dev/ttyACM0"));
        let mut now_s = 0.0;
        ticks(&mut driver, &mut now_s, 10, Vector3::zeros());
        fake.change(change);
        let begin_s = now_s;
        while !matches!(driver.health().standing, ConnectionState::Lost(_)) {
            ticks(&mut driver, &mut now_s, 1, Vector3::x());
            assert!(now_s - begin_s < 0.05, "{:?}", driver.health());
        }
        assert!(now_s - begin_s < super::SILENCE_S + 0.003, "{} s", now_s - begin_s);
        let ConnectionState::Lost(loss) = driver.health().standing else { panic!() };
        assert_eq!(ticks(&mut driver, &mut now_s, 5, Vector3::x()), None, "it stays lost");
        loss
    };
    assert_eq!(run(|inner| inner.answers = false), Loss::Silent);
    assert_eq!(run(|inner| inner.gone = true), Loss::Disconnected);
    assert_eq!(run(|inner| inner.state.position_m[1] = f32::NAN), Loss::Implausible);
    assert_eq!(run(|inner| inner.state.velocity_m_s[0] = 100.0), Loss::Implausible);
    assert_eq!(run(|inner| inner.instead = Some(vec![0x1B; 25])), Loss::Corrupt);
}

#[test]
fn who_is_not_the_handle_is_told_with_what_to_do() {
    let report = |settings: &HaplySettings, change: fn(&mut Inner)| {
        let fake = Fake::new();
        fake.change(change);
        let trouble = HaplyDriver::over(Box::new(fake), settings).err().unwrap();
        assert!(!trouble.cure().is_empty());
        trouble
    };
    let usual = HaplySettings::at("/dev/ttyACM0");
    assert!(matches!(
        report(&usual, |inner| inner.answers = false),
        DeviceError::WrongProduct { .. } | DeviceError::Silent { .. }
    ));
    assert!(matches!(report(&usual, |inner| inner.gone = true), DeviceError::Absent { .. }));
    assert!(matches!(report(&usual, |inner| inner.instead = Some(vec![9; 30])), DeviceError::WrongProduct { .. }));
    assert!(matches!(report(&usual, |inner| inner.state.position_m[0] = 7.0), DeviceError::NotReady { .. }));
    let other = HaplySettings { serial_number: Some("04a0".to_owned()), ..usual.clone() };
    assert!(matches!(report(&other, |_| {}), DeviceError::OtherSerial { .. }));
    let own = HaplySettings { serial_number: Some("049d".to_owned()), ..usual.clone() };
    assert!(HaplyDriver::over(Box::new(Fake::new()), &own).is_ok());
    for bad in [
        HaplySettings { port: " ".to_owned(), ..usual.clone() },
        HaplySettings { force_max_n: 12.0, ..usual.clone() },
        HaplySettings { force_max_n: f64::NAN, ..usual.clone() },
        HaplySettings { centre_m: [0.0, f64::NAN, 0.0], ..usual },
    ] {
        assert!(matches!(report(&bad, |_| {}), DeviceError::Setting { .. }));
    }
    assert_eq!(force_request([0.0; 3])[1..], [0; 12]);
}

#[test]
fn a_force_is_taken_back_at_once_also_from_a_handle_that_does_not_answer() {
    let (fake, mut driver) = opened(&HaplySettings::at("/dev/ttyACM0"));
    let mut now_s = 0.0;
    driver.switch_force(true);
    ticks(&mut driver, &mut now_s, 5, Vector3::x());
    fake.change(|inner| inner.answers = false);
    ticks(&mut driver, &mut now_s, 3, Vector3::x());
    assert_eq!(fake.newest_n(), Vector3::x());
    ticks(&mut driver, &mut now_s, 1, Vector3::zeros());
    assert_eq!(fake.newest_n(), Vector3::zeros(), "although older answers are missing");
    ticks(&mut driver, &mut now_s, 10, Vector3::x());
    assert_eq!(fake.newest_n(), Vector3::x(), "the request is repeated");
    ticks(&mut driver, &mut now_s, 20, Vector3::x());
    assert!(matches!(driver.health().standing, ConnectionState::Lost(Loss::Silent)));
    assert_eq!(fake.newest_n(), Vector3::zeros(), "it may still listen");
}
