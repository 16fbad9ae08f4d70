//! Orderly end of the program on Ctrl-C, SIGTERM, SIGHUP, or when a parent process closes standard input.
//!
//! Long-running code checks [`Leave::is_asked`] and ends. [`Leave::at_once`] stops anything that must not wait for that
//! check, such as an engaged arm.

use std::{
    io,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use anyhow::Context as _;

/// Request to end this process. Clones share the same state.
#[derive(Clone, Default)]
pub struct Leave(Arc<ExitRequest>);

#[derive(Default)]
struct ExitRequest {
    flag: AtomicBool,
    at_once: Mutex<Option<Box<dyn Fn() + Send>>>,
}

impl Leave {
    /// Reacts to Ctrl-C, SIGTERM and SIGHUP. Call it at most once per process.
    ///
    /// # Errors Returns an error if the operating system rejects a signal handler.
    pub fn on_signals() -> anyhow::Result<Self> {
        let leave = Self::default();
        let asked = leave.clone();
        ctrlc::set_handler(move || asked.ask()).context("cannot install the Ctrl-C handler")?;
        Ok(leave)
    }

    /// Also reacts to the end of standard input. A parent process holds the other end without writing; it closes when the
    /// parent ends for any reason.
    pub fn with_input(&self) {
        let asked = self.clone();
        thread::spawn(move || {
            io::copy(&mut io::stdin().lock(), &mut io::sink()).ok();
            asked.ask();
        });
    }

    pub fn ask(&self) {
        self.0.flag.store(true, Ordering::Release);
        self.act();
    }

    pub fn is_asked(&self) -> bool {
        self.0.flag.load(Ordering::Acquire)
    }

    pub fn flag(&self) -> &AtomicBool {
        &self.0.flag
    }

    /// Sets a function that is called on another thread as soon as the end is requested. It replaces the previous one.
    pub fn at_once(&self, act: impl Fn() + Send + 'static) {
        *self.lock() = Some(Box::new(act));
        if self.is_asked() {
            self.act();
        }
    }

    fn act(&self) {
        if let Some(act) = &*self.lock() {
            act();
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Option<Box<dyn Fn() + Send>>> {
        self.0.at_once.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl std::fmt::Debug for Leave {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Leave").field(&self.is_asked()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_given_after_it_was_asked_is_done_at_once() {
        let leave = Leave::default();
        let done = Arc::new(AtomicBool::new(false));
        assert!(!leave.is_asked());
        leave.ask();
        let mark = Arc::clone(&done);
        leave.at_once(move || mark.store(true, Ordering::Relaxed));
        assert!(leave.is_asked() && done.load(Ordering::Relaxed));
    }
}
