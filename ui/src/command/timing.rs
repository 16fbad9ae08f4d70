//! `nima study timing`: the loop on the real clock beside everything that may hold it up, under each scheduling class.
//!
//! Each case is a process of its own, as in use; loads run in this one. Cases with a window need a display.

use std::{
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

use anyhow::{Context as _, bail};
use clap::Args;
use nima::{config::SchedulingClass, files::write_atomically};
use serde::{Deserialize, Serialize};

use super::output;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Length of each case, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = super::run::positive_seconds)]
    seconds: f64,
    /// Scene of the loop
    #[arg(long, default_value = "bimanual")]
    scene: String,
    /// Write timing.json and timing.md into this folder (made if absent)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the figures as one JSON object
    #[arg(long)]
    json: bool,
}

/// What goes on beside the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Beside {
    Nothing,
    Console,
    Hogs,
    StalledConsole,
    Disk,
}

impl Beside {
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

/// Of [`nima::statistics::Quantiles`], what is shown.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Quantiles {
    p50: f64,
    p99: f64,
    p999: f64,
    max: f64,
}

/// Of [`nima::runtime::Summary`], what is shown.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Figures {
    ticks: u64,
    missed: u64,
    wake_us: Quantiles,
    work_us: Quantiles,
    scheduling: Scheduling,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Scheduling {
    fifo: bool,
    deadline: bool,
    memory_locked: bool,
}

#[derive(Debug, Serialize)]
struct Case {
    beside: Beside,
    /// What was asked of the operating system.
    asked: SchedulingClass,
    #[serde(flatten)]
    figures: Option<Figures>,
    /// Why there are no figures.
    skipped: Option<String>,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    }
    let mut cases = Vec::new();
    for beside in Beside::ALL {
        for asked in [SchedulingClass::Fifo, SchedulingClass::Deadline, SchedulingClass::Ordinary] {
            eprintln!("{}, {}", beside.words(), asked.name());
            let measured = measure(arguments, beside, asked);
            let skipped = measured.as_ref().err().map(|error| format!("{error:#}"));
            cases.push(Case { beside, asked, figures: measured.ok(), skipped });
        }
    }
    let table = table(&cases);
    if let Some(folder) = &arguments.out {
        let json = serde_json::to_string_pretty(&cases)?;
        for (name, text) in [("timing.json", &json), ("timing.md", &table)] {
            let path = folder.join(name);
            write_atomically(&path, |file| file.write_all(text.as_bytes()))
                .with_context(|| format!("cannot write {}", path.display()))?;
        }
    }
    if arguments.json { output::json(&cases) } else { output::line(table.trim_end()) }
}

fn measure(arguments: &Arguments, beside: Beside, asked: SchedulingClass) -> anyhow::Result<Figures> {
    let program = std::env::current_exe().context("this program does not know where it is")?;
    let folder = tempfile::tempdir()?;
    let load = match beside {
        Beside::Hogs => Load::hogs(),
        Beside::Disk => Load::disk(folder.path().join("load")),
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
    if beside == Beside::StalledConsole {
        command.args(["--stall", "5"]);
    }
    command.args(["--scene", &arguments.scene]);
    command.args(["--scheduling", asked.name()]);
    let done = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).output()?;
    drop(load);
    if !done.status.success() {
        bail!("{}", String::from_utf8_lossy(&done.stderr).lines().next_back().unwrap_or("it failed").to_owned());
    }
    let text =
        if beside.has_window() { std::fs::read(&summary).context("no window: no figures")? } else { done.stdout };
    Ok(serde_json::from_slice(&text)?)
}

/// Threads that make work until it is dropped.
#[derive(Default)]
struct Load {
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Load {
    fn start(count: usize, work: impl Fn() + Clone + Send + 'static) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let threads = (0..count).map(|_| {
            let (flag, work) = (Arc::clone(&stop), work.clone());
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

    /// 4 MB at a time, each written through to the disk.
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

fn table(cases: &[Case]) -> String {
    let mut out = String::from(
        "| beside the loop | class | ticks | missed | wake-up us p50 | p99 | p99.9 | max | work us p50 | p99 |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    for Case { beside, asked, figures, skipped } in cases {
        // Writing into a String cannot fail.
        write!(out, "| {} | {} |", beside.words(), asked.name()).ok();
        let Some(Figures { ticks, missed, wake_us: wake, work_us: work, scheduling }) = figures else {
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
