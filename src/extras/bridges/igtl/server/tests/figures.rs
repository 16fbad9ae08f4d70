//! Cost of the bridge for the loop, and delay of its clients, on the real clock.

use std::collections::BTreeMap;

use hdrhistogram::Histogram;
use nima_machine::runtime::{self, Assembly, tap};
use nima_session::{
    SentenceChannel,
    recorder::{RecordingInfo, SessionRecorder},
    sinks::Destination,
};
use nima_simulation::{SimulationPlan, scene::Scene};

use super::*;

const SECONDS: u64 = 10;

fn histogram() -> Histogram<u64> {
    Histogram::new_with_bounds(1, 60_000_000, 3).unwrap()
}

fn percentiles(of: &Histogram<u64>) -> String {
    let at = |quantile| of.value_at_quantile(quantile) as f64 * 1e-3;
    format!(
        "p50 {:.3} ms, p99 {:.3} ms, p99.9 {:.3} ms, max {:.3} ms, n {}",
        at(0.5),
        at(0.99),
        at(0.999),
        of.max() as f64 * 1e-3,
        of.len()
    )
}

/// Runs the simulated rig on the real clock with the bridge as the only recipient; returns the lateness of its ticks.
fn run(server: &IgtlServer, seconds: u64) -> Histogram<u64> {
    let rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load("bimanual").unwrap();
    let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: true };
    let (tap, end) = tap();
    let started_ns = super::super::client::now_ns();
    let words =
        SentenceChannel { event: |_, _| String::new(), operation: |_, _| String::new(), happening: |_| String::new() };
    let about = RecordingInfo {
        program: "figures".to_owned(),
        started_ns,
        metadata: BTreeMap::default(),
        files: Vec::new(),
        words,
    };
    let to = Destination { audiences: vec![server.audience(LoopOutline::default())], ..Destination::default() };
    let recorder = SessionRecorder::start(to, about, plan.origin(), end).unwrap();
    let handle = runtime::start(Assembly { tap: Some(tap), ..plan.assembly().unwrap() }).unwrap();
    let begin = Instant::now();
    let mut late = histogram();
    while begin.elapsed() < Duration::from_secs(seconds) {
        sleep(Duration::from_millis(20));
        handle.drain_ticks(|tick| late.saturating_record((tick.timing.wake_s * 1e6) as u64));
        handle.drain_events(|_| {});
    }
    handle.stop_and_join().unwrap();
    recorder.finish().unwrap();
    late
}

/// Returns the delay of bundles: arrival minus time stamp, minus the minimum of all (the recorder's estimate of the
/// loop's start).
fn lateness(server: &IgtlServer, ends: &Arc<AtomicBool>) -> JoinHandle<(Histogram<u64>, Histogram<u64>)> {
    let mut peer = Peer::of(server);
    let ends = Arc::clone(ends);
    spawn(move || {
        let mut ages = Vec::new();
        let mut stamps = Vec::new();
        while !ends.load(Ordering::Relaxed) {
            let Some(message) = peer.next() else { break };
            if matches!(message.content, Content::Tracking(_)) {
                ages.push(super::super::client::now_ns().cast_signed() - message.time_ns.cast_signed());
                stamps.push(message.time_ns);
            }
        }
        let min = ages.iter().copied().min().unwrap_or_default();
        let mut late = histogram();
        let mut between = histogram();
        for age in ages {
            late.saturating_record(((age - min) / 1000) as u64);
        }
        for pair in stamps.windows(2) {
            between.saturating_record((pair[1] - pair[0]) / 1000);
        }
        (late, between)
    })
}

#[test]
#[ignore = "a minute, on a quiet machine: ./dev figures"]
fn figures_of_the_bridge_and_its_clients() {
    for case in
        ["no client", "one client", "a stalled client", "a flooding client", "a client that is killed again and again"]
    {
        let server = server();
        let ends = Arc::new(AtomicBool::new(false));
        let reads = (case != "no client").then(|| lateness(&server, &ends));
        let address = server.address();
        let ended = Arc::clone(&ends);
        let connect = move || TcpStream::connect(address).unwrap();
        let harms: Option<JoinHandle<()>> = match case {
            "a stalled client" => Some(spawn(move || {
                while !ended.load(Ordering::Relaxed) {
                    let _stalled = connect();
                    sleep(Duration::from_secs(5));
                }
            })),
            "a flooding client" => Some(spawn(move || {
                let bytes = IgtlMessage::new("", 0, Content::Request(Verb::Get, ContentKind::Capability, None))
                    .encode()
                    .repeat(1000);
                let mut stream = connect();
                stream.set_write_timeout(Some(Duration::from_millis(100))).unwrap();
                while !ended.load(Ordering::Relaxed) {
                    stream.write_all(&bytes).ok();
                }
            })),
            "a client that is killed again and again" => Some(spawn(move || {
                while !ended.load(Ordering::Relaxed) {
                    connect().write_all(&[0, 1, 2]).ok();
                    sleep(Duration::from_millis(50));
                }
            })),
            _ => None,
        };
        let loop_late = run(&server, SECONDS);
        ends.store(true, Ordering::Relaxed);
        println!("{case}: the loop's ticks wake late by {}", percentiles(&loop_late));
        drop(server);
        if let Some((late, between)) = reads.map(|reads| reads.join().unwrap()) {
            println!("  bundles arrive after the first of them by {}", percentiles(&late));
            println!("  between two bundles {}", percentiles(&between));
        }
        if let Some(harms) = harms {
            harms.join().unwrap();
        }
    }
}
