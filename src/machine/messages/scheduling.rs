//! What the operating system grants a real-time thread.

/// What was asked for and what was granted.
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
    /// What to grant, in words; `None` when everything was granted.
    pub const fn advice(&self) -> Option<&'static str> {
        if cfg!(not(target_os = "linux")) {
            return Some("real-time scheduling is used on Linux only; expect more missed ticks here");
        }
        match (self.fifo || self.deadline, self.memory_locked) {
            (true, true) => None,
            (false, _) => Some(
                "no real-time priority: add the line \"@realtime - rtprio 95\" to /etc/security/limits.d/realtime.conf, join the group realtime and log in again",
            ),
            (true, false) => Some(
                "memory is not locked: add the line \"@realtime - memlock unlimited\" to /etc/security/limits.d/realtime.conf, join the group realtime and log in again",
            ),
        }
    }
}
