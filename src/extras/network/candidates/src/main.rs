//! Compares candidates for the stream between two machines in one loop: raw UDP, the link of `nima-network` (UDP with
//! snow), quinn-proto and zenoh. Two processes in two network namespaces, 1 kHz, real-time priority. Needs root, and
//! Linux.
//!
//! `cargo run --release -- [seconds] [rounds] [engine ...]`

mod datagrams;
mod own;
mod quic;
mod zen;

use std::{
    path::Path,
    process::{Command, Stdio, id},
    thread::sleep,
    time::{Duration, Instant},
};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Addresses of the sender and the receiver.
const HERE: &str = "10.78.0.1";
const THERE: &str = "10.78.0.2";
const PORT: u16 = 47_200;
/// Length of a payload, bytes.
const LEN: usize = 64;
const TICK: Duration = Duration::from_millis(1);
/// Polling interval of the receiver.
const NAP: Duration = Duration::from_micros(50);
const ENGINES: [&str; 4] = ["raw", "snow", "quinn", "zenoh"];

/// One end of a stream of payloads.
trait Engine {
    /// Whether payloads can be sent.
    fn is_ready(&mut self) -> bool;
    fn send(&mut self, payload: &[u8]);
    /// Does pending work, and passes the received payloads to `got`, with the time at which each was seen, ns.
    fn poll(&mut self, got: &mut dyn FnMut(&[u8], u64));
}

/// Monotonic time of the machine, which both processes share, ns.
fn now_ns() -> u64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the pointer is valid for the call.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut time) };
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}

/// Processor time of this process, s.
fn processor_s() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the pointer is valid for the call.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &raw mut time) };
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn be_urgent() {
    let parameters = libc::sched_param { sched_priority: 50 };
    // SAFETY: the pointer is valid for the call; where it is refused, the priority stays.
    if unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameters) } != 0 {
        eprintln!("no real-time priority here");
    }
}

fn engine(name: &str, sends: bool, folder: &Path) -> Outcome<Box<dyn Engine>> {
    Ok(match name {
        "raw" => Box::new(datagrams::Raw::open(sends)?),
        "snow" => Box::new(own::Link::open(sends, folder)?),
        "quinn" => Box::new(quic::Quic::open(sends, folder)?),
        "zenoh" => Box::new(zen::Zenoh::open(sends)?),
        _ => return Err(format!("no engine is called {name}").into()),
    })
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    sorted
        .get(((sorted.len() as f64 * share) as usize).min(sorted.len().saturating_sub(1)))
        .copied()
        .unwrap_or(f64::NAN)
}

/// The process on the sender's host: prints median and 99th percentile of the sending time (us), its load (%), and the
/// number of payloads sent.
fn sender(mut engine: Box<dyn Engine>, seconds: f64) -> Outcome<()> {
    let begin = Instant::now();
    while !engine.is_ready() {
        engine.poll(&mut |_, _| {});
        sleep(TICK);
        if begin.elapsed() > Duration::from_secs(10) {
            return Err("nobody answers".into());
        }
    }
    let begin = Instant::now();
    let before_s = processor_s();
    let mut wake = Instant::now();
    let mut costs_us = Vec::with_capacity(100_000);
    let mut number = 0_u64;
    let mut payload = [0; LEN];
    while begin.elapsed().as_secs_f64() < seconds {
        payload[..8].copy_from_slice(&number.to_le_bytes());
        let sent_ns = now_ns();
        payload[8..16].copy_from_slice(&sent_ns.to_le_bytes());
        engine.send(&payload);
        costs_us.push((now_ns() - sent_ns) as f64 * 1e-3);
        number += 1;
        engine.poll(&mut |_, _| {});
        // Like the loop: missed periods are skipped, never made up in a burst.
        wake = (wake + TICK).max(Instant::now());
        sleep(wake.saturating_duration_since(Instant::now()));
    }
    let load = (processor_s() - before_s) / begin.elapsed().as_secs_f64() * 100.0;
    costs_us.sort_by(f64::total_cmp);
    println!("RESULT {:.1} {:.1} {load:.1} {number}", quantile(&costs_us, 0.5), quantile(&costs_us, 0.99));
    sleep(Duration::from_millis(300));
    Ok(())
}

/// The process on the receiver's host: prints the number of payloads received, quantiles of the one-way delay (us) and
/// its load (%).
fn receiver(mut engine: Box<dyn Engine>, seconds: f64) -> Outcome<()> {
    let mut delays_us = Vec::with_capacity(100_000);
    let mut last = Instant::now();
    let begin = Instant::now();
    let mut start = None;
    while begin.elapsed().as_secs_f64() < seconds + 12.0 {
        engine.poll(&mut |payload, seen_ns| {
            if let Some(Ok(sent)) = payload.get(8..16).map(TryInto::try_into) {
                delays_us.push(seen_ns.saturating_sub(u64::from_le_bytes(sent)) as f64 * 1e-3);
                last = Instant::now();
                start.get_or_insert((Instant::now(), processor_s()));
            }
        });
        if start.is_some() && last.elapsed() > Duration::from_millis(250) {
            break;
        }
        sleep(NAP);
    }
    let load = start.map_or(0.0, |(at, before_s)| (processor_s() - before_s) / at.elapsed().as_secs_f64() * 100.0);
    delays_us.sort_by(f64::total_cmp);
    let [p50, p99, p999, max] = [0.5, 0.99, 0.999, 1.0].map(|share| quantile(&delays_us, share));
    println!("RESULT {} {p50:.0} {p99:.0} {p999:.0} {max:.0} {load:.1}", delays_us.len());
    Ok(())
}

fn ip(arguments: &str) -> Outcome<()> {
    let done = Command::new("ip").args(arguments.split(' ')).status()?.success();
    if done { Ok(()) } else { Err(format!("ip {arguments}: failed").into()) }
}

/// Two hosts with a cable, removed when dropped.
struct Hosts([String; 2]);

impl Hosts {
    fn new() -> Outcome<Self> {
        let this = Self(["a", "b"].map(|end| format!("candidates-{}-{end}", id())));
        let [one, other] = &this.0;
        ip(&format!("netns add {one}"))?;
        ip(&format!("netns add {other}"))?;
        ip(&format!("-n {one} link add cable type veth peer name cable netns {other}"))?;
        for (host, address) in [(one, HERE), (other, THERE)] {
            ip(&format!("-n {host} addr add {address}/24 dev cable"))?;
            ip(&format!("-n {host} link set cable up"))?;
            ip(&format!("-n {host} link set lo up"))?;
        }
        Ok(this)
    }
}

impl Drop for Hosts {
    fn drop(&mut self) {
        for host in &self.0 {
            ip(&format!("netns del {host}")).ok();
        }
    }
}

/// Returns the receiver's and the sender's results of one run.
fn run(hosts: &Hosts, name: &str, seconds: f64, folder: &Path) -> Outcome<[Vec<f64>; 2]> {
    let start = |host: usize, role: &str| {
        let mut command = Command::new("ip");
        command.args(["netns", "exec", &hosts.0[host]]).arg(std::env::current_exe()?);
        command.args([role, name, &seconds.to_string()]).arg(folder).stdout(Stdio::piped()).spawn()
    };
    let there = start(1, "receiver")?;
    sleep(Duration::from_millis(500));
    let here = start(0, "sender")?;
    let mut figures = [Vec::new(), Vec::new()];
    for (child, figures) in [there, here].into_iter().zip(&mut figures) {
        let text = String::from_utf8(child.wait_with_output()?.stdout)?;
        let line = text.lines().find_map(|line| line.strip_prefix("RESULT ")).ok_or("no result")?;
        *figures = line.split(' ').map(str::parse).collect::<Result<_, _>>()?;
    }
    Ok(figures)
}

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        // The threads that an engine starts inherit the priority.
        ["sender" | "receiver", ..] => be_urgent(),
        _ => {}
    }
    match words[..] {
        ["sender", name, seconds, folder] => return sender(engine(name, true, folder.as_ref())?, seconds.parse()?),
        ["receiver", name, seconds, folder] => {
            return receiver(engine(name, false, folder.as_ref())?, seconds.parse()?);
        }
        _ => {}
    }
    let seconds = words.first().map_or(Ok(8.0), |word| word.parse())?;
    let rounds = words.get(1).map_or(Ok(3), |word| word.parse())?;
    let folder = std::env::temp_dir().join(format!("candidates-{}", id()));
    own::prepare(&folder)?;
    quic::prepare(&folder)?;
    let hosts = Hosts::new()?;
    println!("| engine | p50 us | p99 | p99.9 | max | send us p50 | p99 | load of sender, receiver % | lost |");
    for _ in 0..rounds {
        for name in ENGINES.into_iter().filter(|name| words.len() < 3 || words[2..].contains(name)) {
            match run(&hosts, name, seconds, &folder) {
                Ok([there, here]) => println!(
                    "| {name} | {} | {} | {} | {} | {} | {} | {}, {} | {} of {} |",
                    there[1],
                    there[2],
                    there[3],
                    there[4],
                    here[0],
                    here[1],
                    here[2],
                    there[5],
                    here[3] - there[0],
                    here[3]
                ),
                Err(error) => println!("| {name} | {error} |"),
            }
        }
    }
    std::fs::remove_dir_all(folder)?;
    Ok(())
}
