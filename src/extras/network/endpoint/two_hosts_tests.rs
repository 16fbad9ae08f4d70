//! Two processes on two hosts: network namespaces with a cable between them, where the system permits it.

use std::{
    net::SocketAddr,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio, id},
    thread::sleep,
    time::{Duration, Instant},
};

use nima_testing::{
    real_time::{alone, judged},
    unjudged,
};

use super::*;
use crate::keys::{NetworkKeys, Peers};

const TICK: Duration = Duration::from_millis(1);
/// Running time of a host, s; the cable is unplugged for a part of it.
const LENGTH_S: f64 = 4.0;
const CUT_AFTER: Duration = Duration::from_millis(1800);
const CUT_FOR: Duration = Duration::from_millis(700);
/// Environment variable with the process's host: the folder with its keys.
const FOLDER: &str = "NIMA_NETWORK_HOST";

fn ip(arguments: &[&str]) -> bool {
    let status = Command::new("ip").args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

/// Two namespaces with a cable; removed when dropped.
struct Hosts {
    names: [String; 2],
}

impl Hosts {
    /// Creates the hosts; `None` if this is not permitted.
    fn new() -> Option<Self> {
        let names = ["a", "b"].map(|end| format!("nima-{}-{end}", id()));
        let this = Self { names };
        let [one, other] = [0, 1].map(|i| this.names[i].as_str());
        let made = ip(&["netns", "add", one])
            && ip(&["netns", "add", other])
            && ip(&["-n", one, "link", "add", "cable", "type", "veth", "peer", "name", "cable", "netns", other])
            && ip(&["-n", one, "addr", "add", "10.77.0.1/24", "dev", "cable"])
            && ip(&["-n", other, "addr", "add", "10.77.0.2/24", "dev", "cable"])
            && this.names.iter().all(|name| ip(&["-n", name, "link", "set", "cable", "up"]));
        made.then_some(this)
    }

    fn cable(&self, state: &str) {
        assert!(ip(&["-n", &self.names[1], "link", "set", "cable", state]));
    }

    fn run(&self, host: usize, folder: &Path) -> Child {
        let program = std::env::current_exe().unwrap();
        let mut command = Command::new("ip");
        command.args(["netns", "exec", &self.names[host]]).arg(program);
        command.args(["--exact", "endpoint::two_hosts_tests::one_host", "--ignored", "--nocapture"]);
        command.env(FOLDER, folder).stdout(Stdio::piped()).stderr(Stdio::inherit()).spawn().unwrap()
    }
}

impl Drop for Hosts {
    fn drop(&mut self) {
        for name in &self.names {
            ip(&["netns", "del", name]);
        }
    }
}

/// The process on each host: a thousand ticks per second; prints each change of the state, and its measurements at the
/// end.
#[test]
#[ignore = "a part of the test with two hosts"]
fn one_host() {
    let Some(folder) = std::env::var_os(FOLDER).map(PathBuf::from) else { return };
    let keys = NetworkKeys::open(&folder).unwrap();
    let peers = Peers::open(&folder).unwrap();
    let follower: SocketAddr = (Ipv4Addr::new(10, 77, 0, 1), PORT).into();
    let role = match peers.list() {
        [peer] if peer.name == "follower" => EndpointRole::Console { follower, key: peer.key },
        _ => EndpointRole::Follower { at: Some(follower), consoles: peers },
    };
    let mut end = Endpoint::open(EndpointConfig::new(role, keys)).unwrap();
    let begin = Instant::now();
    let mut wake = Instant::now();
    let mut report = String::new();
    let mut ages_s = Vec::new();
    while begin.elapsed().as_secs_f64() < LENGTH_S {
        let now_s = begin.elapsed().as_secs_f64();
        let mut received = end.poll(now_s);
        while let Some(payload) = received.next_due() {
            ages_s.push(payload.age_s);
        }
        end.send(begin.elapsed().as_secs_f64(), &[5; 40]);
        let word = match end.state() {
            LinkState::Open => " open",
            LinkState::Waiting => " waiting",
            LinkState::Down(LinkCause::Silent { .. }) => " silent",
            LinkState::Down(LinkCause::ClockJumped { .. }) => " jumped",
            LinkState::Down(_) => " down",
        };
        if !report.ends_with(word) {
            report.push_str(word);
        }
        wake = (wake + TICK).max(Instant::now());
        sleep(wake.saturating_duration_since(Instant::now()));
    }
    let figures = end.figures();
    let dropped = end.dropped();
    ages_s.sort_by(f64::total_cmp);
    let fraction =
        |fraction: f64| ages_s.get((ages_s.len() as f64 * fraction) as usize).map_or(f64::NAN, |age_s| age_s * 1e3);
    let playout_ms = figures.playout_s.unwrap_or_default() * 1e3;
    println!(
        "HOST {} {} {} {:.3} {:.3} {:.3}{report}",
        ages_s.len(),
        figures.counts.lost,
        dropped.total() - dropped.unsent,
        playout_ms,
        fraction(0.5),
        fraction(0.99)
    );
    // Both stay until both are done.
    sleep(Duration::from_millis(300));
}

/// Payloads received and lost, datagrams dropped; playout delay, median and 99th percentile of the age (ms); the
/// states.
fn report(child: Child) -> (Vec<f64>, String) {
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let line = text.lines().find_map(|line| line.split("HOST ").nth(1)).unwrap_or_else(|| panic!("{text}"));
    let mut words = line.split(' ');
    let figures = words.by_ref().take(6).map(|word| word.parse().unwrap()).collect();
    (figures, words.collect::<Vec<_>>().join(" "))
}

#[test]
#[ignore = "real time: ./dev test runs it beside the wires"]
fn two_hosts_exchange_payloads_and_see_when_the_cable_is_out() {
    let _alone = alone();
    judged(|| {
        let Some(hosts) = Hosts::new() else {
            unjudged::left_out("two network namespaces cannot be made");
            return;
        };
        let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        let public = folders.each_ref().map(|folder| NetworkKeys::open(folder.path()).unwrap().public());
        for (folder, (name, key)) in folders.iter().zip([("console", public[1]), ("follower", public[0])]) {
            let mut peers = Peers::default();
            peers.add(name, key).unwrap();
            peers.save(folder.path()).unwrap();
        }
        let children = [0, 1].map(|host| hosts.run(host, folders[host].path()));
        sleep(CUT_AFTER);
        hosts.cable("down");
        sleep(CUT_FOR);
        hosts.cable("up");
        for (host, child) in children.into_iter().enumerate() {
            let (figures, states) = report(child);
            let [got, lost, dropped, playout_ms, median_ms, p99_ms] = figures[..] else { panic!("{figures:?}") };
            println!(
                "host {host}: {got} payloads, play-out {playout_ms} ms, age {median_ms} ms, p99 {p99_ms} ms; {states}"
            );
            assert_eq!(states, "waiting open silent open");
            assert!(got > 1900.0 && dropped < 1.0, "{figures:?}");
            // Payloads sent while the cable was unplugged and until the system had found the other host again, which
            // takes at most a second.
            assert!(lost > 300.0 && lost < 2000.0, "{figures:?}");
            assert!(median_ms < playout_ms + 1.5 && playout_ms < 20.0, "{figures:?}");
        }
    });
}
