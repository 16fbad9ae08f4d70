//! Measures the cost of the window: time between frames, work per frame, start-up time, processor time and memory. The
//! program measures itself, for `nima console --frames`.
//!
//! Times in ms or s as the names say, processor time as fractions of one core, memory in MB. Processor time and memory come
//! from `/proc` and are zero on systems without it.

use std::{
    collections::BTreeMap,
    fs,
    time::{Duration, Instant},
};

use serde::Serialize;

/// Time after which window, shaders and fonts have settled.
const WARM_UP: Duration = Duration::from_secs(4);
/// Maximum time between the end of the measurement and the end of the run, if the latter is known.
const LAST: Duration = Duration::from_secs(30);
/// Threads of the loop; all other threads belong to the window.
const MACHINE: [&str; 3] = ["realtime", "supervisor", "emulator"];
/// Clock ticks of `/proc` per second; always 100 for programs on Linux.
const TICKS_PER_S: f64 = 100.0;

/// Percentiles of durations, ms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FrameSpread {
    pub p50: f64,
    pub p90: f64,
    pub p99: f64,
    pub max: f64,
}

impl FrameSpread {
    /// Computes the percentiles of these durations (ms); zeros if there are none.
    pub fn of(durations_ms: &[f64]) -> Self {
        let mut sorted = durations_ms.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |fraction: f64| {
            let place = (fraction * sorted.len() as f64).ceil() as usize;
            sorted.get(place.saturating_sub(1)).copied().unwrap_or(0.0)
        };
        Self { p50: at(0.5), p90: at(0.9), p99: at(0.99), max: at(1.0) }
    }
}

/// Processor time as fractions of one core.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Processor {
    pub process: f64,
    /// Processor time of all threads except those of the loop: the cost of the window.
    pub window: f64,
    /// The loop and its supervisor.
    pub machine: f64,
    /// Each thread by name; threads of the same name are added.
    pub threads: BTreeMap<String, f64>,
}

/// Results of a run.
#[derive(Clone, Debug, Serialize)]
pub struct FrameFigures {
    /// Name of the OpenGL renderer.
    pub renderer: String,
    /// Time from the start of the process to the first frame that shows a tick, s.
    #[serde(rename = "first_live_picture_s")]
    pub first_live_image_s: Option<f64>,
    /// Duration of the measurement, s.
    pub seconds: f64,
    /// Number of frames in that time.
    #[serde(rename = "pictures")]
    pub images: usize,
    /// Time between two frames, while a side was engaged, ms.
    pub period_ms: FrameSpread,
    /// Work of a frame on the window's thread, without displaying it: layout, triangles, driver calls, ms.
    pub work_ms: FrameSpread,
    /// The program's own part of this work: panels and plots, without triangles and driver, ms.
    pub layout_ms: FrameSpread,
    /// Processor time over the same period.
    pub processor: Processor,
    /// Load average of the computer (last minute) at the end.
    pub load: f64,
    /// Resident memory of the process, one value per minute, MB.
    pub resident_mb: Vec<f64>,
}

#[derive(Debug)]
pub struct FrameMeter {
    opened: Instant,
    /// Time after the window opened at which measuring starts.
    from: Duration,
    began: Option<(Instant, BTreeMap<String, f64>)>,
    first_live_s: Option<f64>,
    live_pending: bool,
    periods_ms: Vec<f64>,
    work_ms: Vec<f64>,
    layout_ms: Vec<f64>,
    images: usize,
    resident_mb: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
pub struct FrameMeasurement {
    /// Time since the previous frame, if that one requested this one; `None` while nothing moves.
    pub period: Option<Duration>,
    /// Work of the previous frame, s.
    pub work_s: Option<f64>,
    pub live: bool,
}

impl FrameMeter {
    /// Starts to measure a window that opens now and closes after `exit_after`, if that is known.
    pub fn new(exit_after: Option<Duration>) -> Self {
        let from = exit_after.map_or(WARM_UP, |exit| exit.saturating_sub(LAST)).max(WARM_UP);
        Self {
            opened: Instant::now(),
            from,
            began: None,
            first_live_s: None,
            live_pending: false,
            periods_ms: Vec::new(),
            work_ms: Vec::new(),
            layout_ms: Vec::new(),
            images: 0,
            resident_mb: Vec::new(),
        }
    }

    /// Records the start of a frame. Returns true if another frame is needed at once: only its start shows when this one
    /// reached the screen.
    pub fn begin(&mut self, image: &FrameMeasurement) -> bool {
        if std::mem::take(&mut self.live_pending) {
            self.first_live_s = age_s().or_else(|| Some(self.opened.elapsed().as_secs_f64()));
        } else if image.live && self.first_live_s.is_none() {
            self.live_pending = true;
        }
        let open = self.opened.elapsed();
        if open.as_secs() / 60 >= self.resident_mb.len() as u64 {
            self.resident_mb.push(resident_mb());
        }
        if open >= self.from {
            if self.began.is_none() {
                self.began = Some((Instant::now(), threads_s()));
            }
            self.periods_ms.extend(image.period.map(|period| period.as_secs_f64() * 1e3));
            self.work_ms.extend(image.work_s.map(|work_s| work_s * 1e3));
            self.images += 1;
        }
        self.live_pending
    }

    /// Records how long the program's own part of a frame took.
    pub fn end(&mut self, layout: Duration) {
        if self.began.is_some() {
            self.layout_ms.push(layout.as_secs_f64() * 1e3);
        }
    }

    /// `renderer`: name of the OpenGL renderer.
    pub fn figures(&self, renderer: &str) -> FrameFigures {
        let seconds = self.began.as_ref().map_or(0.0, |(began, _)| began.elapsed().as_secs_f64());
        let before = self.began.as_ref().map(|(_, threads_s)| threads_s.clone()).unwrap_or_default();
        FrameFigures {
            renderer: renderer.to_owned(),
            first_live_image_s: self.first_live_s,
            seconds,
            images: self.images,
            period_ms: FrameSpread::of(&self.periods_ms),
            work_ms: FrameSpread::of(&self.work_ms),
            layout_ms: FrameSpread::of(&self.layout_ms),
            processor: Processor::between(&before, &threads_s(), seconds),
            load: first_number("/proc/loadavg").unwrap_or(0.0),
            resident_mb: self.resident_mb.iter().copied().chain([resident_mb()]).collect(),
        }
    }
}

impl Processor {
    /// Computes fractions of one core from two readings of the threads' times (s), `seconds` apart. A thread that
    /// started in between counts from zero; one that has ended is not included.
    fn between(before: &BTreeMap<String, f64>, now: &BTreeMap<String, f64>, seconds: f64) -> Self {
        let fraction = |(name, time_s): (&String, &f64)| {
            let used_s = (time_s - before.get(name).copied().unwrap_or(0.0)).max(0.0);
            (name.clone(), if seconds > 0.0 { used_s / seconds } else { 0.0 })
        };
        let threads: BTreeMap<String, f64> = now.iter().map(fraction).collect();
        let process: f64 = threads.values().sum();
        let machine: f64 = MACHINE.iter().filter_map(|name| threads.get(*name)).sum();
        Self { process, window: process - machine, machine, threads }
    }
}

/// Returns the processor time of each thread since it began, s, by name.
fn threads_s() -> BTreeMap<String, f64> {
    let mut times_s = BTreeMap::new();
    for task in fs::read_dir("/proc/self/task").into_iter().flatten().flatten() {
        let Some((name, time_s)) = fs::read_to_string(task.path().join("stat")).ok().as_deref().and_then(thread_s)
        else {
            continue;
        };
        *times_s.entry(name).or_insert(0.0) += time_s;
    }
    times_s
}

/// Returns the name and processor time (s) from a line of `stat`. The name may contain spaces and parentheses.
fn thread_s(stat: &str) -> Option<(String, f64)> {
    let (head, rest) = stat.rsplit_once(") ")?;
    let name = head.split_once('(')?.1.to_owned();
    let ticks = |place: usize| rest.split(' ').nth(place)?.parse::<f64>().ok();
    // User and system time are fields 14 and 15 of the line; field 3 is the first one after the name.
    Some((name, (ticks(11)? + ticks(12)?) / TICKS_PER_S))
}

/// Returns the age of this process, s, accurate to 0.02 s.
fn age_s() -> Option<f64> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    let began_ticks: f64 = stat.rsplit_once(") ")?.1.split(' ').nth(19)?.parse().ok()?;
    Some(first_number("/proc/uptime")? - began_ticks / TICKS_PER_S)
}

fn first_number(path: &str) -> Option<f64> {
    fs::read_to_string(path).ok()?.split_whitespace().next()?.parse().ok()
}

/// Returns the resident memory of this process, MB; zero if not available.
fn resident_mb() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kb = line.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok());
    kb.unwrap_or(0.0) / 1024.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_members_of_what_was_measured() {
        let durations: Vec<f64> = (1..=200).rev().map(f64::from).collect();
        assert_eq!(FrameSpread::of(&durations), FrameSpread { p50: 100.0, p90: 180.0, p99: 198.0, max: 200.0 });
        assert_eq!(FrameSpread::of(&[]), FrameSpread::default());
    }

    #[test]
    fn a_threads_time_is_read_whatever_its_name() {
        let line = "7 (a (b) c) S 1 2 3 4 5 6 7 8 9 10 250 50 13 14";
        assert_eq!(thread_s(line), Some(("a (b) c".to_owned(), 3.0)));
        assert_eq!(thread_s("7 (a) S 1"), None);
    }

    #[test]
    fn the_windows_share_is_what_the_machine_leaves() {
        let times = |main, realtime| BTreeMap::from([("nima".to_owned(), main), ("realtime".to_owned(), realtime)]);
        let processor = Processor::between(&times(1.0, 5.0), &times(2.0, 6.5), 10.0);
        assert!((processor.window - 0.1).abs() < 1e-12 && (processor.machine - 0.15).abs() < 1e-12);
        assert!((Processor::between(&times(0.0, 0.0), &times(1.0, 1.0), 0.0).process).abs() < 1e-12);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_is_found() {
        assert!(threads_s().values().all(|time_s| time_s.is_finite()) && !threads_s().is_empty());
        assert!(resident_mb() > 1.0 && age_s().is_some_and(|age_s| (-0.1..1e5).contains(&age_s)));
    }

    #[test]
    fn the_first_live_picture_is_told_when_it_stands() {
        let mut meter = FrameMeter::new(None);
        let image = |live| FrameMeasurement { period: None, work_s: None, live };
        assert!(!meter.begin(&image(false)));
        assert!(meter.begin(&image(true)), "its end is seen by the beginning of the next");
        assert!(meter.figures("").first_live_image_s.is_none());
        assert!(!meter.begin(&image(true)));
        assert!(meter.figures("").first_live_image_s.is_some());
    }
}
