//! Alarms in order of urgency, each with cause and remedy. They are determined again in each frame, so an alarm ends exactly
//! when its cause ends; [`log`] stores the recent ones, [`strip`] shows them, [`sound`] plays their sound.

mod fault;
pub mod log;
pub mod sound;
pub mod strip;

use std::time::Duration;

use egui::Color32;
use nima_machine::{
    messages::{Fault, LoopState, Scheduling, Watchdog},
    rig::Side,
};
use nima_words::{
    report_text::{lack_text, sentence},
    text,
};

use self::fault::{fault_alarm, of_arm};
use crate::theme;

/// Urgency by IEC 60601-1-8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AlarmPriority {
    /// Act now. Red, flashing twice per second.
    High,
    /// Act soon. Yellow, flashing every 1.5 s.
    Medium,
    /// For information. Cyan, steady.
    Low,
}

impl AlarmPriority {
    /// Returns the colour of a text or a sign in the present palette.
    pub fn ink(self) -> Color32 {
        match self {
            Self::High => theme::now().alarm_high,
            Self::Medium => theme::now().alarm_medium,
            Self::Low => theme::now().alarm_low,
        }
    }

    /// Returns the colour at this time on the dark background of alarms; flashing dims it but never hides it.
    /// Acknowledged alarms and those of low priority do not flash.
    pub fn colour(self, time_s: f64, flashes: bool) -> Color32 {
        let colour = match self {
            Self::High => theme::DARK.alarm_high,
            Self::Medium => theme::DARK.alarm_medium,
            Self::Low => theme::DARK.alarm_low,
        };
        let dimmed = self.flash_hz().is_some_and(|hz| flashes && (time_s * hz).fract() >= 0.5);
        if dimmed { colour.gamma_multiply(0.35) } else { colour }
    }

    /// Returns how often it flashes, Hz; IEC 60601-1-8 allows 1.4 to 2.8 for high and 0.4 to 0.8 for medium priority.
    pub const fn flash_hz(self) -> Option<f64> {
        match self {
            Self::High => Some(2.0),
            Self::Medium => Some(0.6),
            Self::Low => None,
        }
    }

    /// Returns the time until the next change of the colour, s; `None` for a steady one.
    pub fn until_change_s(self, time_s: f64) -> Option<f64> {
        let half_s = 0.5 / self.flash_hz()?;
        Some(half_s - time_s.rem_euclid(half_s))
    }

    /// Returns a word for the priority, for readers who cannot distinguish the colours.
    pub fn word(self) -> &'static str {
        match self {
            Self::High => text::alarms::ALARM.get(),
            Self::Medium => text::alarms::WARNING.get(),
            Self::Low => text::alarms::NOTE.get(),
        }
    }
}

/// Kind of an alarm: if the values in an alarm change, its kind stays the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlarmKind {
    /// A stop did not reach the loop.
    StopStuck,
    /// A fault stopped the loop.
    Fault(Fault),
    /// The ready check tripped a watchdog.
    Tested,
    /// The loop sends no ticks.
    Silence,
    /// The device with this index in the roster is missing.
    Device(usize),
    /// Too many periods are missed.
    Missed,
    /// The wrist sensor's bias has changed.
    BiasMoved,
    /// The operating system refused real-time privileges.
    Scheduling,
    /// No ready check has passed today.
    Unchecked,
    /// A user on another machine requests something.
    Question,
    /// The session is not recorded, or soon will not be.
    Unrecorded,
}

impl AlarmKind {
    /// Returns whether its text may contain a name given by a person, such as that of a folder.
    pub const fn has_names(self) -> bool {
        match self {
            Self::Device(_) | Self::Unrecorded => true,
            Self::StopStuck
            | Self::Fault(_)
            | Self::Tested
            | Self::Silence
            | Self::Missed
            | Self::BiasMoved
            | Self::Scheduling
            | Self::Unchecked
            | Self::Question => false,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Alarm {
    pub kind: AlarmKind,
    pub priority: AlarmPriority,
    /// Cause, with its time if known.
    pub cause: String,
    /// Remedy.
    pub cure: String,
}

/// A required device that does not deliver.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingDevice {
    pub place: usize,
    /// Name in the roster.
    pub name: String,
    /// Whether it delivered before.
    pub was_there: bool,
    /// Reason why the device delivers no data.
    pub cause: String,
    /// Remedy.
    pub cure: String,
}

/// Input of the alarms.
#[derive(Clone, Debug, Default)]
pub struct Signs {
    /// Missing devices, in the order of the roster.
    pub missing: Vec<MissingDevice>,
    /// State of the loop as last seen.
    pub state: Option<LoopState>,
    /// The first fault since the last release, and its time (s on the loop's clock).
    pub first_fault: Option<(f64, Fault)>,
    /// The arm of that fault, on a rig with two.
    pub fault_side: Option<Side>,
    /// Name of the lost device that caused that fault, also after it has come back.
    pub fault_device: Option<String>,
    /// The watchdog that the ready check is testing.
    pub tested: Option<Watchdog>,
    /// Whether the loop's thread is running.
    pub running: bool,
    /// Time since the last tick.
    pub silence: Duration,
    /// Fraction of periods missed in the last seconds, 0 to 1.
    pub missed_fraction: f64,
    /// Real-time privileges that the operating system granted, once known.
    pub scheduling: Option<Scheduling>,
    /// A stop could not be sent to the loop.
    pub stop_is_stuck: bool,
    /// Change of the wrist sensor's bias since its calibration, N; `None` if it has not changed.
    pub bias_moved_n: Option<f64>,
    /// The arm of that sensor, on a rig with two.
    pub bias_side: Option<Side>,
    /// No ready check has passed on this rig today.
    pub is_unchecked: bool,
    /// Cause and remedy of a request over the link to another machine.
    pub question: Option<[&'static str; 2]>,
    /// Reason why the session is not recorded although it should be, or a coming problem.
    pub unrecorded: Option<String>,
}

/// Ticks arrive every few milliseconds; half a second without one is an alarm.
const SILENCE_MAX: Duration = Duration::from_millis(500);
/// A hand feels more than one missed period in a hundred as roughness.
const MISSED_FRACTION_MAX: f64 = 0.01;

/// Returns all alarms, most urgent first.
pub fn judge(signs: &Signs) -> Vec<Alarm> {
    let mut alarms = Vec::new();
    if signs.stop_is_stuck {
        alarms.push(Alarm {
            kind: AlarmKind::StopStuck,
            priority: AlarmPriority::High,
            cause: text::alarms::STOP_STUCK_CAUSE.get().to_owned(),
            cure: text::alarms::STOP_STUCK_CURE.get().to_owned(),
        });
    }
    if let (Some(LoopState::Faulted(_)), Some((t_s, fault))) = (signs.state, signs.first_fault) {
        alarms.push(fault_alarm(t_s, fault, signs));
    }
    if !signs.running || (signs.state.is_some() && signs.silence > SILENCE_MAX) {
        alarms.push(Alarm {
            kind: AlarmKind::Silence,
            priority: AlarmPriority::High,
            cause: text::alarms::LOOP_SILENT_CAUSE.get().to_owned(),
            cure: text::alarms::LOOP_SILENT_CURE.get().to_owned(),
        });
    }
    alarms.extend(signs.missing.iter().map(missing));
    if signs.missed_fraction > MISSED_FRACTION_MAX {
        // While no side is driven, no hand can feel missed periods, so they rank below the reasons why the arm cannot
        // be engaged.
        let driven = signs.state.is_none_or(|state| state.permits().drives);
        alarms.push(Alarm {
            kind: AlarmKind::Missed,
            priority: if driven { AlarmPriority::Medium } else { AlarmPriority::Low },
            cause: text::alarms::periods_missed(100.0 * signs.missed_fraction),
            cure: text::alarms::PERIODS_MISSED_CURE.get().to_owned(),
        });
    }
    if let Some(by_n) = signs.bias_moved_n {
        alarms.push(Alarm {
            kind: AlarmKind::BiasMoved,
            priority: AlarmPriority::Medium,
            cause: of_arm(&text::alarms::bias_moved(by_n), signs.bias_side),
            cure: text::alarms::BIAS_MOVED_CURE.get().to_owned(),
        });
    }
    if let Some(lack) = signs.scheduling.and_then(|granted| granted.lack()) {
        let [cause, cure] = lack_text(lack);
        alarms.push(Alarm {
            kind: AlarmKind::Scheduling,
            priority: AlarmPriority::Low,
            cause: sentence(cause),
            cure: sentence(cure),
        });
    }
    if signs.is_unchecked {
        alarms.push(Alarm {
            kind: AlarmKind::Unchecked,
            priority: AlarmPriority::Low,
            cause: text::alarms::UNCHECKED_CAUSE.get().to_owned(),
            cure: text::alarms::UNCHECKED_CURE.get().to_owned(),
        });
    }
    if let Some([cause, cure]) = signs.question {
        alarms.push(Alarm {
            kind: AlarmKind::Question,
            priority: AlarmPriority::Low,
            cause: cause.to_owned(),
            cure: cure.to_owned(),
        });
    }
    if let Some(why) = &signs.unrecorded {
        alarms.push(Alarm {
            kind: AlarmKind::Unrecorded,
            priority: AlarmPriority::Low,
            cause: text::sessions::cause(why),
            cure: text::sessions::CURE.get().to_owned(),
        });
    }
    alarms.sort_by_key(|alarm| alarm.priority);
    alarms
}

fn missing(device: &MissingDevice) -> Alarm {
    let words = if device.was_there { text::alarms::device_lost } else { text::alarms::device };
    Alarm {
        kind: AlarmKind::Device(device.place),
        priority: AlarmPriority::Medium,
        cause: words(&device.name, &device.cause),
        cure: device.cure.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nima_words::report_text::Remedy as _;

    fn healthy() -> Signs {
        Signs { state: Some(LoopState::Engaged), running: true, ..Signs::default() }
    }

    #[test]
    fn a_healthy_loop_has_no_alarm() {
        assert_eq!(judge(&healthy()), []);
    }

    #[test]
    fn the_most_urgent_comes_first_with_cause_and_cure() {
        let fault = Fault::SourceSilent;
        let alarms = judge(&Signs {
            state: Some(LoopState::Faulted(fault)),
            first_fault: Some((12.34, fault)),
            missed_fraction: 0.05,
            bias_moved_n: Some(0.41),
            scheduling: Some(Scheduling::default()),
            ..healthy()
        });
        assert!(alarms.is_sorted_by_key(|alarm| alarm.priority));
        assert!(alarms[0].cause.contains(fault.cause()) && alarms[0].cause.contains("12.3 s"));
        assert!(alarms.iter().all(|alarm| !alarm.cure.is_empty()), "{alarms:?}");
        assert!(alarms.iter().any(|alarm| alarm.priority == AlarmPriority::Medium && alarm.cause.contains("0.41 N")));
        assert_eq!(alarms.len(), 4);
    }

    #[test]
    fn the_fault_of_a_lost_device_names_it_also_after_it_has_come_back() {
        let fault = Fault::DeviceLost { device: 1, loss: nima_devices::Loss::Silent };
        let signs = Signs {
            state: Some(LoopState::Faulted(fault)),
            first_fault: Some((12.34, fault)),
            fault_device: Some("right arm".to_owned()),
            ..healthy()
        };
        let alarms = judge(&signs);
        assert!(alarms[0].cause.contains("right arm") && alarms[0].cause.contains(fault.cause()), "{alarms:?}");
    }

    #[test]
    fn an_alarm_of_an_arm_names_it_and_a_tested_watchdog_is_no_alarm() {
        let fault = Fault::SourceSilent;
        let faulted = Signs {
            state: Some(LoopState::Faulted(fault)),
            first_fault: Some((12.34, fault)),
            fault_side: Some(Side::Left),
            bias_moved_n: Some(0.41),
            bias_side: Some(Side::Right),
            ..healthy()
        };
        let alarms = judge(&faulted);
        assert!(alarms[0].cause.contains("left arm") && alarms[1].cause.contains("right arm"), "{alarms:?}");
        let tested = |tested| judge(&Signs { tested: Some(tested), bias_moved_n: None, ..faulted.clone() });
        let own = tested(Watchdog::Source);
        assert_eq!((own[0].kind, own[0].priority), (AlarmKind::Tested, AlarmPriority::Low));
        assert!(own[0].cause.contains("Ready check"), "{own:?}");
        assert_eq!(tested(Watchdog::Link)[0].priority, AlarmPriority::High, "another fault is real");
    }

    #[test]
    fn a_missing_device_stands_before_the_periods_that_its_absence_costs() {
        let device = MissingDevice {
            place: 1,
            name: "right arm".to_owned(),
            was_there: false,
            cause: "no response from 127.0.0.1:47100".to_owned(),
            cure: "Correct the port number in the rig file.".to_owned(),
        };
        let signs = Signs {
            state: Some(LoopState::Disconnected),
            missed_fraction: 0.05,
            missing: vec![device],
            scheduling: Some(Scheduling::default()),
            ..healthy()
        };
        let mut log = log::AlarmLog::default();
        // The missed periods come first here.
        log.update(&judge(&Signs { missing: Vec::new(), ..signs.clone() }), &log::AlarmMoment::now(None, 0.0));
        log.update(&judge(&signs), &log::AlarmMoment::now(None, 1.0));
        let pinned = &log.live()[0].alarm;
        assert_eq!(pinned.kind, AlarmKind::Device(1), "{pinned:?}");
        assert!(pinned.cause.contains("right arm") && pinned.cause.contains("127.0.0.1:47100"), "{pinned:?}");
        assert!(pinned.cure.contains("port number"), "{pinned:?}");
        let engaged = judge(&Signs { state: Some(LoopState::Engaged), missing: Vec::new(), ..signs });
        assert_eq!(engaged[0].priority, AlarmPriority::Medium, "an engaged hand feels missed periods");
    }

    #[test]
    fn silence_and_a_dead_loop_are_alarms() {
        assert_eq!(judge(&Signs { silence: Duration::from_secs(1), ..healthy() }).len(), 1);
        assert_eq!(judge(&Signs { running: false, ..healthy() }).len(), 1);
        assert_eq!(
            judge(&Signs { running: true, ..Signs::default() }),
            [],
            "before the first tick nothing is wrong yet"
        );
    }

    #[test]
    fn flashing_never_hides_and_low_is_steady() {
        for i in 0..100 {
            let time_s = f64::from(i) * 0.05;
            assert_eq!(AlarmPriority::Low.colour(time_s, true), theme::DARK.alarm_low);
            assert!(AlarmPriority::High.colour(time_s, true).a() > 0);
            assert_eq!(AlarmPriority::High.colour(time_s, false), theme::DARK.alarm_high, "acknowledged: steady");
        }
        assert_ne!(AlarmPriority::High.colour(0.1, true), AlarmPriority::High.colour(0.3, true));
        assert!((1.4..=2.8).contains(&AlarmPriority::High.flash_hz().unwrap()));
        assert!((0.4..=0.8).contains(&AlarmPriority::Medium.flash_hz().unwrap()));
        for priority in [AlarmPriority::High, AlarmPriority::Medium] {
            for i in 0..100 {
                let time_s = 0.013 + f64::from(i) * 0.07;
                let change_s = time_s + priority.until_change_s(time_s).unwrap();
                assert_eq!(priority.colour(time_s, true), priority.colour(change_s - 1e-6, true));
                assert_ne!(priority.colour(time_s, true), priority.colour(change_s + 1e-6, true));
            }
        }
        assert_eq!(AlarmPriority::Low.until_change_s(1.0), None);
    }
}
