//! Status messages of `nima run` on stderr while the loop runs: its state, and devices that cannot be opened.

use std::{
    io::{self, IsTerminal as _, Write as _},
    time::{Duration, Instant},
};

use nima_devices::DeviceError;
use nima_machine::{
    messages::{LoopState, Tick},
    runtime::LoopHandle,
};
use nima_screen::stderr::print_line;
use nima_words::report_text::newtons;

/// Reports why a device cannot be opened, once per cause.
#[derive(Default)]
pub(super) struct Troubles {
    report: Vec<Option<DeviceError>>,
    first: Option<String>,
    looked: Option<Instant>,
}

impl Troubles {
    pub(super) fn look(&mut self, handle: &LoopHandle, status: &StatusLine) {
        const LOOK_EVERY: Duration = Duration::from_millis(500);
        if self.looked.is_some_and(|looked| looked.elapsed() < LOOK_EVERY) {
            return;
        }
        self.looked = Some(Instant::now());
        self.report.resize(handle.roster().len(), None);
        self.first = None;
        for (entry, report) in handle.roster().iter().zip(&mut self.report) {
            let trouble = entry.view.report().trouble;
            if let Some(trouble) = &trouble {
                let words = format!("{}: {trouble}. {}", entry.name(), trouble.cure());
                if report.as_ref() != Some(trouble) {
                    status.notify(&words);
                }
                self.first.get_or_insert(words);
            }
            *report = trouble;
        }
    }

    /// Returns the first missing device, with cause and remedy.
    pub(super) fn first(&self) -> Option<String> {
        let others = self.report.iter().flatten().count().saturating_sub(1);
        let more = if others > 0 { format!(" (and {others} more)") } else { String::new() };
        self.first.as_ref().map(|first| format!("{first}{more}"))
    }
}

/// A status line on stderr that is rewritten in place; one line per second if stderr is not a terminal.
pub(super) struct StatusLine {
    wanted: bool,
    terminal: bool,
    last: Option<Instant>,
}

impl StatusLine {
    pub(super) fn new(wanted: bool) -> Self {
        Self { wanted, terminal: io::stderr().is_terminal(), last: None }
    }

    /// Shows the current state; `missing` is the device that the loop is waiting for.
    pub(super) fn show(&mut self, tick: &Tick, missing: Option<&str>) {
        let pause = Duration::from_millis(if self.terminal { 100 } else { 1000 });
        if !self.wanted || self.last.is_some_and(|last| last.elapsed() < pause) {
            return;
        }
        self.last = Some(Instant::now());
        if let (LoopState::Disconnected, Some(missing)) = (tick.state, missing) {
            return self.write(&format!("{:8.1} s  {}: {missing}", tick.t_s, tick.state.word()));
        }
        let text = format!(
            "{:8.1} s  {:8}  {:8}  measured {:>7}  rendered {:5.2} N  degree {}  missed {}",
            tick.t_s,
            tick.state.word(),
            tick.mode,
            newtons(tick.known_n().map(|force_n| force_n.norm()), 2),
            tick.rendering.rendered_n.norm(),
            tick.identification.degrees.anchored,
            tick.timing.missed,
        );
        self.write(&text);
    }

    fn write(&self, text: &str) {
        let mut err = io::stderr().lock();
        // The terminal truncates a line that is too long, and clears the rest of the previous one.
        let written =
            if self.terminal { write!(err, "\r\x1b[?7l{text}\x1b[K\x1b[?7h") } else { writeln!(err, "{text}") };
        written.and_then(|()| err.flush()).ok();
    }

    /// Prints a permanent line above the status line.
    pub(super) fn notify(&self, line: &str) {
        if self.wanted && self.terminal && self.last.is_some() {
            print_line(format_args!("\r\x1b[K{line}"));
        } else {
            print_line(line);
        }
    }

    pub(super) fn end(&self) {
        if self.wanted && self.terminal && self.last.is_some() {
            print_line("");
        }
    }
}
