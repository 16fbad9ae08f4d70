//! Leaving in order: Ctrl-C, SIGTERM, SIGHUP, or the end of an input that a parent process holds.
//!
//! Whoever runs something looks at [`Leave::is_asked`] and ends it; what must not wait for that, such as an arm that is engaged, is
//! ended at once by [`Leave::at_once`].

use std::{
    io,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use anyhow::Context as _;

/// Whether this process was asked to end. Copies are of one and the same.
#[derive(Clone, Default)]
pub struct Leave(Arc<Asked>);

#[derive(Default)]
struct Asked {
    flag: AtomicBool,
    at_once: Mutex<Option<Box<dyn Fn() + Send>>>,
}

impl Leave {
    /// Asked by Ctrl-C, SIGTERM and SIGHUP; for one time in a process.
    ///
    /// # Errors
    /// The operating system does not let them be caught.
    pub fn on_signals() -> anyhow::Result<Self> {
        let leave = Self::default();
        let asked = leave.clone();
        ctrlc::set_handler(move || asked.ask()).context("Ctrl-C cannot be caught")?;
        Ok(leave)
    }

    /// Asked also by the end of standard input. A parent holds its other end and never writes: it ends with the parent, however that ends.
    pub fn with_input(&self) {
        let asked = self.clone();
        thread::spawn(move || {
            io::copy(&mut io::stdin().lock(), &mut io::sink()).ok();
            asked.ask();
        });
    }

    /// Asks.
    pub fn ask(&self) {
        self.0.flag.store(true, Ordering::Release);
        self.act();
    }

    /// It was asked.
    pub fn is_asked(&self) -> bool {
        self.0.flag.load(Ordering::Acquire)
    }

    /// The same as a flag.
    pub fn flag(&self) -> &AtomicBool {
        &self.0.flag
    }

    /// What is done as soon as it is asked, on another thread; it replaces what was given before.
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
        let (leave, done) = (Leave::default(), Arc::new(AtomicBool::new(false)));
        assert!(!leave.is_asked());
        leave.ask();
        let mark = Arc::clone(&done);
        leave.at_once(move || mark.store(true, Ordering::Relaxed));
        assert!(leave.is_asked() && done.load(Ordering::Relaxed));
    }
}
