//! Communication with the program of an external device over a real socket allocates nothing.

use std::{
    net::UdpSocket,
    sync::{
        Arc,
        atomic::{AtomicU8, Ordering::Relaxed},
    },
    time::{Duration, Instant},
};

use nalgebra::Vector3;
use nima_devices::{
    ConnectionState, Device as _, Leader as _,
    external::{
        ExternalHandle, ExternalKind, ExternalSettings,
        codec::{BYTES_MAX, Datagram, ExternalMessage},
    },
};
use nima_testing::real_time::{alone, judged};

use crate::counting::calls;

/// Modes of the program.
const SENDS: u8 = 0;
const SENDS_NONSENSE: u8 = 1;
const FLOODS: u8 = 2;
const ENDS: u8 = 3;

/// A program that sends a thousand times per second until its mode changes.
fn program(port: u16, does: &AtomicU8) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(("127.0.0.1", port)).unwrap();
    socket.set_nonblocking(true).unwrap();
    let mut reading =
        Datagram { session: 5, watchdog_us: 20_000, ..Datagram::blank(ExternalMessage::Reading(ExternalKind::Handle)) };
    let begin = Instant::now();
    let mut wire = [0; BYTES_MAX];
    let mut received = [0; BYTES_MAX];
    while does.load(Relaxed) != ENDS {
        while let Ok(count) = socket.recv(&mut received) {
            reading.echo_us = Datagram::decode(&received[..count]).unwrap().time_us;
        }
        for _ in 0..if does.load(Relaxed) == FLOODS { 300 } else { 1 } {
            reading.sequence += 1;
            reading.time_us = (begin.elapsed().as_micros() as u64).max(reading.time_us + 1);
            let length = reading.encode(&mut wire);
            if does.load(Relaxed) == SENDS_NONSENSE && reading.sequence.is_multiple_of(2) {
                wire[60] ^= 1;
            }
            socket.send(&wire[..length]).ok();
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn polling_and_answering_allocate_nothing_also_when_the_program_floods_and_ends() {
    let _alone = alone();
    judged(|| {
        let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let does = Arc::new(AtomicU8::new(SENDS));
        let of_thread = Arc::clone(&does);
        let thread = std::thread::spawn(move || program(port, &of_thread));
        let settings = ExternalSettings {
            age_max_ms: 20.0,
            silence_ms: 20.0,
            ..ExternalSettings::at(([127, 0, 0, 1], port).into())
        };
        let opened = ExternalHandle::open(&settings);
        let begin = Instant::now();
        let judge = |mut handle: ExternalHandle| {
            handle.switch_force(true);
            for what in [SENDS, SENDS_NONSENSE, FLOODS, ENDS] {
                does.store(what, Relaxed);
                let before = calls();
                for _ in 0..100 {
                    handle.poll(begin.elapsed().as_secs_f64());
                    handle.set_force(Vector3::new(1.0, f64::NAN, 3.0), 0.0);
                    std::thread::sleep(Duration::from_millis(1));
                }
                assert_eq!(calls() - before, 0, "{what}");
            }
            let health = handle.health();
            assert!(health.readings > 100 && health.damaged > 10, "{health:?}");
            assert!(matches!(health.standing, ConnectionState::Lost(_)));
        };
        // End the thread in any case, even if the test panics.
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| judge(opened.unwrap())));
        does.store(ENDS, Relaxed);
        thread.join().unwrap();
        if let Err(cause) = result {
            std::panic::resume_unwind(cause);
        }
    });
}
