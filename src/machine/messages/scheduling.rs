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
    /// How to get the missing privileges, for the user; `None` if all were granted.
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
