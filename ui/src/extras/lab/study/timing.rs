//! `nima study timing`: the loop on the real clock while other load may delay it, with each scheduling class.
//!
//! Each case runs in a separate process, as in normal use; the load runs in this process. Cases with a window need a display.

use std::{
    convert::Infallible,
    fmt::Write as _,
    io::Write as _,
    path::PathBuf,
    process::{Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

use anyhow::Context as _;
use clap::Args;
use nima_machine::config::SchedulingClass;
use nima_screen::stderr::print_line;
use nima_study::{Experiment, Findings};
use serde::{Deserialize, Serialize};

use super::ExperimentArguments;
use crate::command::run::positive_seconds;

#[derive(Clone, Debug, Args)]
pub(in crate::extras::lab) struct TimingArguments {
    /// Length of each case, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = positive_seconds)]
    seconds: f64,
    /// Scene of the loop
    #[arg(long, default_value = "bimanual")]
    scene: String,
}

/// Load that runs parallel to the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum ParallelLoad {
    Nothing,
    Console,
    Hogs,
    StalledConsole,
    Disk,
}

impl ParallelLoad {
    const ALL: [Self; 5] = [Self::Nothing, Self::Console, Self::Hogs, Self::StalledConsole, Self::Disk];

    const fn words(self) -> &'static str {
        match self {
            Self::Nothing => "nothing else",
            Self::Console => "its console rendering",
            Self::Hogs => "a busy thread on each core",
            Self::StalledConsole => "its console, held up for 5 s",
            Self::Disk => "heavy disk writing",
        }
    }

    const fn has_window(self) -> bool {
        matches!(self, Self::Console | Self::StalledConsole)
    }
}

/// Displayed fields of [`nima_core::statistics::Quantiles`].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct TimingQuantiles {
    p50: f64,
    p99: f64,
    p999: f64,
    max: f64,
}

/// Displayed fields of [`nima_machine::runtime::RuntimeSummary`].
#[derive(Clone, Debug, Serialize, Deserialize)]
struct TimingFigures {
    ticks: u64,
    missed: u64,
    wake_us: TimingQuantiles,
    work_us: TimingQuantiles,
    scheduling: TimingScheduling,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct TimingScheduling {
    fifo: bool,
    deadline: bool,
    memory_locked: bool,
}

#[derive(Debug, Serialize)]
pub(super) struct TimingCase {
    beside: ParallelLoad,
    asked: SchedulingClass,
    #[serde(flatten)]
    figures: Option<TimingFigures>,
    /// Reason for missing results; `None` if there are some.
    skipped: Option<String>,
}

#[derive(Debug, Serialize)]
#[serde(transparent)]
pub(in crate::extras::lab) struct Cases(Vec<TimingCase>);

impl ExperimentArguments for TimingArguments {
    type Experiment = Self;

    fn experiment(&self) -> anyhow::Result<Self> {
        Ok(self.clone())
    }
}

impl Experiment for TimingArguments {
    const NAME: &'static str = "timing";
    type Findings = Cases;
    type Error = Infallible;

    fn inputs(&self) -> Vec<PathBuf> {
        vec![PathBuf::from(&self.scene)]
    }

    /// Prints one line per case, because each takes a while.
    fn run(&self, _: &mut dyn FnMut(usize, usize, &str)) -> Result<Cases, Infallible> {
        let mut cases = Vec::new();
        for beside in ParallelLoad::ALL {
            for asked in [SchedulingClass::Fifo, SchedulingClass::Deadline, SchedulingClass::Ordinary] {
                print_line(format_args!("{}, {}", beside.words(), asked.name()));
                let measured = measure(self, beside, asked);
                let skipped = measured.as_ref().err().map(|error| format!("{error:#}"));
                cases.push(TimingCase { beside, asked, figures: measured.ok(), skipped });
            }
        }
        Ok(Cases(cases))
    }
}

impl Findings for Cases {
    fn text(&self) -> String {
        table(&self.0)
    }
}

fn measure(arguments: &TimingArguments, beside: ParallelLoad, asked: SchedulingClass) -> anyhow::Result<TimingFigures> {
    let program = std::env::current_exe().context("cannot find the path of this program")?;
    let folder = tempfile::tempdir()?;
    let load = match beside {
        ParallelLoad::Hogs => Load::hogs(),
        ParallelLoad::Disk => Load::disk(folder.path().join("load")),
        _ => Load::default(),
    };
    let mut command = Command::new(program);
    let seconds = arguments.seconds.to_string();
    let summary = folder.path().join("summary.json");
    if beside.has_window() {
        command.args(["console", "--exit-after", &seconds, "--summary"]).arg(&summary);
    } else {
        command.args(["run", "--seconds", &seconds, "--json"]);
    }
    if beside == ParallelLoad::StalledConsole {
        command.args(["--stall", "5"]);
    }
    command.args(["--scene", &arguments.scene]);
    command.args(["--scheduling", asked.name()]);
    // Its standard input closes when this process ends for any reason, so no loop is left running.
    command.arg("--until-input-ends");
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let held = child.stdin.take();
    let done = child.wait_with_output()?;
    drop((held, load));
    let text = if beside.has_window() { std::fs::read(&summary).unwrap_or_default() } else { done.stdout };
    // A delayed loop ends in a fault; its results are still used.
    serde_json::from_slice(&text).map_err(|error| {
        let report = String::from_utf8_lossy(&done.stderr).lines().next_back().map(str::to_owned);
        report.filter(|_| !done.status.success()).map_or_else(|| error.into(), anyhow::Error::msg)
    })
}

/// Threads that generate load until this is dropped.
#[derive(Default)]
struct Load {
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Load {
    fn start(count: usize, work: impl Fn() + Clone + Send + 'static) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let threads = (0..count).map(|_| {
            let flag = Arc::clone(&stop);
            let work = work.clone();
            thread::spawn(move || {
                while !flag.load(Ordering::Relaxed) {
                    work();
                }
            })
        });
        Self { threads: threads.collect(), stop }
    }

    fn hogs() -> Self {
        let cores = thread::available_parallelism().map_or(2, std::num::NonZero::get);
        Self::start(cores, || {
            std::hint::black_box((0..100_000_u64).fold(1.0_f64, |sum, k| (sum + k as f64).sqrt()));
        })
    }

    /// Writes 4 MB at a time to the disk, with synchronisation.
    fn disk(path: PathBuf) -> Self {
        let bytes = vec![0x5a_u8; 4 << 20];
        Self::start(1, move || {
            let written = std::fs::File::create(&path).and_then(|mut file| {
                file.write_all(&bytes)?;
                file.sync_all()
            });
            if written.is_err() {
                thread::sleep(std::time::Duration::from_millis(10));
            }
        })
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            thread.join().ok();
        }
    }
}

fn table(cases: &[TimingCase]) -> String {
    let mut out = String::from(
        "| load | class | ticks | missed | wake-up us p50 | p99 | p99.9 | max | work us p50 | p99 \
         |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for TimingCase { beside, asked, figures, skipped } in cases {
        // Writing to a String cannot fail.
        write!(out, "| {} | {} |", beside.words(), asked.name()).ok();
        let Some(TimingFigures { ticks, missed, wake_us: wake, work_us: work, scheduling }) = figures else {
            let why = skipped.as_deref().unwrap_or("not measured");
            writeln!(out, " {why} | | | | | | | |").ok();
            continue;
        };
        let granted = match asked {
            SchedulingClass::Ordinary => true,
            SchedulingClass::Fifo => scheduling.fifo,
            SchedulingClass::Deadline => scheduling.deadline,
        };
        let refused = if granted { "" } else { " (refused)" };
        writeln!(
            out,
            " {ticks}{refused} | {missed} | {:.0} | {:.0} | {:.0} | {:.0} | {:.1} | {:.1} |",
            wake.p50, wake.p99, wake.p999, wake.max, work.p50, work.p99
        )
        .ok();
    }
    out
}
