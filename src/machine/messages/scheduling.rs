//! Real-time privileges that the operating system granted.

use std::{path::Path, sync::OnceLock};

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
    pub fn lack(&self) -> Option<SchedulingLack> {
        if cfg!(not(target_os = "linux")) {
            return Some(SchedulingLack::NotLinux);
        }
        self.lack_in(is_container())
    }

    fn lack_in(self, is_container: bool) -> Option<SchedulingLack> {
        match (self.fifo || self.deadline, self.memory_locked) {
            (true, true) => None,
            (false, _) if is_container => Some(SchedulingLack::PriorityInContainer),
            (false, _) => Some(SchedulingLack::Priority),
            (true, false) if is_container => Some(SchedulingLack::MemoryInContainer),
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
    /// In a container, whose files of limits have no effect.
    PriorityInContainer,
    MemoryInContainer,
}

/// Returns whether this program runs in a container, as far as its files and its control group show.
fn is_container() -> bool {
    static FOUND: OnceLock<bool> = OnceLock::new();
    *FOUND.get_or_init(|| {
        let marks = ["/.dockerenv", "/run/.containerenv", "/run/systemd/container"];
        let group = std::fs::read_to_string("/proc/1/cgroup").unwrap_or_default();
        marks.iter().any(|mark| Path::new(mark).exists())
            || ["container", "KUBERNETES_SERVICE_HOST"].iter().any(|name| std::env::var_os(name).is_some())
            || is_container_group(&group)
    })
}

/// Returns whether a control group is one of a container.
fn is_container_group(group: &str) -> bool {
    ["docker", "containerd", "kubepods", "libpod", "lxc", "podman"].iter().any(|name| group.contains(name))
}

impl SchedulingLack {
    pub const fn words(self) -> [&'static str; 2] {
        match self {
            Self::NotLinux => ["real-time scheduling is available on Linux only", "expect more missed ticks here"],
            Self::Priority => [
                "no real-time priority",
                "add the line \"@realtime - rtprio 95\" to /etc/security/limits.d/realtime.conf, join the group realtime and log in again",
            ],
            Self::PriorityInContainer => [
                "no real-time priority in this container",
                "start it with --cap-add=sys_nice --ulimit rtprio=95; if its control group has no real-time budget, also with --cpu-rt-runtime=950000",
            ],
            Self::MemoryInContainer => {
                ["memory is not locked in this container", "start it with --cap-add=ipc_lock --ulimit memlock=-1"]
            }
            Self::Memory => [
                "memory is not locked",
                "add the line \"@realtime - memlock unlimited\" to /etc/security/limits.d/realtime.conf, join the group realtime and log in again",
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_container_has_its_own_remedy() {
        let lacks = |fifo, memory_locked, is_container| {
            Scheduling { fifo, deadline: false, memory_locked }.lack_in(is_container).map(SchedulingLack::words)
        };
        assert_eq!(lacks(true, true, true), None);
        let [cause, cure] = lacks(false, false, true).unwrap();
        assert!(cause.contains("container") && cure.contains("--cap-add=sys_nice --ulimit rtprio=95"));
        assert!(lacks(true, false, true).unwrap()[1].contains("--ulimit memlock=-1"));
        assert!(lacks(false, false, false).unwrap()[1].contains("limits.d"));
        assert!(is_container_group("12:cpu:/docker/4f2a\n") && is_container_group("0::/kubepods.slice/x\n"));
        assert!(!is_container_group("0::/init.scope\n") && !is_container_group(""));
    }
}
