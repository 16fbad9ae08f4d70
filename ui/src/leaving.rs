//! Orderly end of the program on Ctrl-C, SIGTERM, SIGHUP, or when a parent process closes standard input.
//!
//! Long-running code checks [`Leave::is_asked`] and ends. What must not wait for that, such as an engaged arm, is ended
//! immediately through [`Leave::at_once`].

use std::{
    io,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use anyhow::Context as _;

/// Whether this process has been asked to end. Clones share the same state.
#[derive(Clone, Default)]
pub struct Leave(Arc<Asked>);

#[derive(Default)]
struct Asked {
    flag: AtomicBool,
    at_once: Mutex<Option<Box<dyn Fn() + Send>>>,
}

impl Leave {
    /// Reacts to Ctrl-C, SIGTERM and SIGHUP; may be called once in a process.
    ///
    /// # Errors
    /// If the operating system does not allow a signal handler.
    pub fn on_signals() -> anyhow::Result<Self> {
        let leave = Self::default();
        let asked = leave.clone();
        ctrlc::set_handler(move || asked.ask()).context("Ctrl-C cannot be caught")?;
        Ok(leave)
    }

    /// Reacts also to the end of standard input. A parent process holds its other end without writing; it closes when
    /// the parent ends for whatever reason.
    pub fn with_input(&self) {
        let asked = self.clone();
        thread::spawn(move || {
            io::copy(&mut io::stdin().lock(), &mut io::sink()).ok();
            asked.ask();
        });
    }

    /// Asks the process to end.
    pub fn ask(&self) {
        self.0.flag.store(true, Ordering::Release);
        self.act();
    }

    /// Whether the process has been asked to end.
    pub fn is_asked(&self) -> bool {
        self.0.flag.load(Ordering::Acquire)
    }

    /// The same state as a flag.
    pub fn flag(&self) -> &AtomicBool {
        &self.0.flag
    }

    /// Sets a function that is called on another thread as soon as the process is asked to end; it replaces the
    /// previous one.
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
