//! Real-time privileges that the operating system granted.

/// Privileges granted to the loop's thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Scheduling {
    /// `SCHED_FIFO` was granted.
    pub fifo: bool,
    /// `SCHED_DEADLINE` was granted.
    pub deadline: bool,
    /// Memory is locked: no page fault can delay a tick.
    pub memory_locked: bool,
}

impl Scheduling {
    /// What is missing; `None` if all was granted.
    pub const fn lack(&self) -> Option<Lack> {
        if cfg!(not(target_os = "linux")) {
            return Some(Lack::NotLinux);
        }
        match (self.fifo || self.deadline, self.memory_locked) {
            (true, true) => None,
            (false, _) => Some(Lack::Priority),
            (true, false) => Some(Lack::Memory),
        }
    }

    /// What is missing and how to get it, for the user; `None` if all was granted.
    pub fn advice(&self) -> Option<String> {
        let [cause, cure] = self.lack()?.words();
        Some(format!("{cause}: {cure}"))
    }
}

/// What a loop lacks for real time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lack {
    /// The operating system has none, as far as this program uses it.
    NotLinux,
    /// A priority above that of other programs.
    Priority,
    /// Memory that is never paged out.
    Memory,
}

impl Lack {
    /// What is missing, and what to do.
    pub const fn words(self) -> [&'static str; 2] {
        match self {
            Self::NotLinux => ["real-time scheduling is available on Linux only", "expect more missed ticks here"],
            Self::Priority => [
                "no real-time priority",
                "add the line \"@realtime - rtprio 95\" to /etc/security/limits.d/realtime.conf, join the group realtime and log in again",
            ],
            Self::Memory => [
                "memory is not locked",
                "add the line \"@realtime - memlock unlimited\" to /etc/security/limits.d/realtime.conf, join the group realtime and log in again",
            ],
        }
    }
}
