//! Real-time privileges that the operating system granted.

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
    /// Returns the missing privilege; `None` if all were granted.
    pub const fn lack(&self) -> Option<SchedulingLack> {
        if cfg!(not(target_os = "linux")) {
            return Some(SchedulingLack::NotLinux);
        }
        match (self.fifo || self.deadline, self.memory_locked) {
            (true, true) => None,
            (false, _) => Some(SchedulingLack::Priority),
            (true, false) => Some(SchedulingLack::Memory),
        }
    }

    /// Returns the missing privilege and how to get it, for the user; `None` if all were granted.
    pub fn advice(&self) -> Option<String> {
        let [cause, cure] = self.lack()?.words();
        Some(format!("{cause}: {cure}"))
    }
}

/// A privilege that a loop lacks for real time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SchedulingLack {
    /// This program does not use real-time functions of this operating system.
    NotLinux,
    Priority,
    Memory,
}

impl SchedulingLack {
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
