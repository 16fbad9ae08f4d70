//! Recent alarms with their states (active, acknowledged or ended) and times.
//!
//! An acknowledgement ends flashing and sound and is displayed; the alarm itself ends only when its cause ends. A new alarm
//! of the same or a higher priority than the acknowledged ones flashes and sounds again.

use std::collections::VecDeque;

use jiff::{Timestamp, Zoned, tz::TimeZone};

use super::{Alarm, AlarmKind, AlarmPriority};

/// Number of alarms stored.
pub const KEPT: usize = 50;
/// If a cause returns within this time, it is the same alarm, s on the window's clock.
const SAME_S: f64 = 5.0;

/// A time on three clocks.
#[derive(Clone, Debug, PartialEq)]
pub struct AlarmMoment {
    /// Hours, minutes and seconds of this computer's clock.
    pub time: String,
    /// Time on the loop's clock, s; `None` before the loop has sent anything.
    pub loop_s: Option<f64>,
    /// Time on the window's clock, s.
    pub window_s: f64,
}

impl AlarmMoment {
    pub fn now(loop_s: Option<f64>, window_s: f64) -> Self {
        Self { time: time_of_day(Timestamp::now(), TimeZone::try_system().ok()), loop_s, window_s }
    }
}

/// Returns the local time of day; UTC, with its name, if the time zone is unknown.
fn time_of_day(now: Timestamp, zone: Option<TimeZone>) -> String {
    let format = "%H:%M:%S";
    match zone {
        Some(zone) => Zoned::new(now, zone).strftime(format).to_string(),
        None => format!("{} UTC", now.strftime(format)),
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct AlarmEntry {
    pub alarm: Alarm,
    /// Time at which the cause appeared.
    pub began: AlarmMoment,
    /// Time at which the cause ended; `None` while it is active.
    pub ended: Option<AlarmMoment>,
    pub acknowledged: bool,
}

/// Recent alarms, oldest first.
#[derive(Clone, Debug, Default)]
pub struct AlarmLog {
    entries: VecDeque<AlarmEntry>,
}

impl AlarmLog {
    pub fn update(&mut self, alarms: &[Alarm], now: &AlarmMoment) {
        let is_wrong = |kind: AlarmKind| alarms.iter().find(|alarm| alarm.kind == kind);
        for entry in self.entries.iter_mut().filter(|entry| entry.ended.is_none()) {
            match is_wrong(entry.alarm.kind) {
                Some(alarm) => entry.alarm.clone_from(alarm),
                None => entry.ended = Some(now.clone()),
            }
        }
        for alarm in alarms {
            let last = self.entries.iter_mut().rev().find(|entry| entry.alarm.kind == alarm.kind);
            match last {
                Some(entry) if entry.ended.is_none() => {}
                Some(entry) if entry.ended.as_ref().is_some_and(|end| now.window_s - end.window_s < SAME_S) => {
                    entry.ended = None;
                    entry.alarm.clone_from(alarm);
                }
                _ => {
                    let alarm = alarm.clone();
                    let began = now.clone();
                    self.entries.push_back(AlarmEntry { alarm, began, ended: None, acknowledged: false });
                }
            }
        }
        while self.entries.len() > KEPT {
            // There are fewer kinds of alarms than entries, so an active alarm is never removed.
            let gone = self.entries.iter().position(|entry| entry.ended.is_some()).unwrap_or(0);
            self.entries.remove(gone);
        }
    }

    /// Returns the active alarms, most urgent first; of the same urgency, earliest first.
    pub fn live(&self) -> Vec<&AlarmEntry> {
        let mut live: Vec<&AlarmEntry> = self.entries.iter().filter(|entry| entry.ended.is_none()).collect();
        live.sort_by_key(|entry| entry.alarm.priority);
        live
    }

    pub fn newest_first(&self) -> impl Iterator<Item = &AlarmEntry> {
        self.entries.iter().rev()
    }

    /// Returns the active alarms first, then those that have ended; each newest first.
    pub fn active_first(&self) -> impl Iterator<Item = &AlarmEntry> {
        let active = |entry: &&AlarmEntry| entry.ended.is_none();
        self.newest_first().filter(active).chain(self.newest_first().filter(move |entry| !active(entry)))
    }

    pub fn acknowledge(&mut self) {
        self.entries.iter_mut().filter(|entry| entry.ended.is_none()).for_each(|entry| entry.acknowledged = true);
    }

    /// Returns whether there is an active alarm that is not acknowledged.
    pub fn has_unseen(&self) -> bool {
        self.live().iter().any(|entry| !entry.acknowledged)
    }

    /// Returns the priority that requires flashing and sound; `None` if all active alarms are acknowledged, less urgent
    /// than an acknowledged one, or of low priority.
    pub fn calls(&self) -> Option<AlarmPriority> {
        let live = self.live();
        let seen = live.iter().filter(|entry| entry.acknowledged).map(|entry| entry.alarm.priority).min();
        let unseen = live.iter().filter(|entry| !entry.acknowledged).map(|entry| entry.alarm.priority).min();
        unseen.filter(|unseen| *unseen < AlarmPriority::Low && seen.is_none_or(|seen| *unseen <= seen))
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::messages::Fault;

    use super::*;

    fn alarm(kind: AlarmKind, priority: AlarmPriority) -> Alarm {
        Alarm { kind, priority, cause: format!("{kind:?}"), cure: "wait".to_owned() }
    }

    fn at(window_s: f64) -> AlarmMoment {
        AlarmMoment { time: "12:00:00".to_owned(), loop_s: Some(window_s), window_s }
    }

    fn fault() -> Alarm {
        alarm(AlarmKind::Fault(Fault::SourceSilent), AlarmPriority::High)
    }

    #[test]
    fn the_time_of_an_alarm_is_local_or_says_that_it_is_not() {
        let zone = TimeZone::fixed(jiff::tz::offset(2));
        assert_eq!(time_of_day(Timestamp::UNIX_EPOCH, Some(zone)), "02:00:00");
        assert_eq!(time_of_day(Timestamp::UNIX_EPOCH, None), "00:00:00 UTC");
    }

    #[test]
    fn the_first_fault_stays_first_and_a_more_urgent_one_goes_before_it() {
        let missed = alarm(AlarmKind::Missed, AlarmPriority::Medium);
        let bias = alarm(AlarmKind::BiasMoved, AlarmPriority::Medium);
        let mut log = AlarmLog::default();
        log.update(std::slice::from_ref(&bias), &at(1.0));
        log.update(&[missed.clone(), bias.clone()], &at(2.0));
        let kinds = |log: &AlarmLog| log.live().iter().map(|entry| entry.alarm.kind).collect::<Vec<_>>();
        assert_eq!(kinds(&log), [AlarmKind::BiasMoved, AlarmKind::Missed]);
        log.update(&[fault(), missed, bias], &at(3.0));
        assert_eq!(kinds(&log), [fault().kind, AlarmKind::BiasMoved, AlarmKind::Missed]);
    }

    #[test]
    fn an_acknowledgement_silences_and_never_clears() {
        let mut log = AlarmLog::default();
        log.update(&[fault()], &at(1.0));
        assert_eq!(log.calls(), Some(AlarmPriority::High));
        log.acknowledge();
        log.update(&[fault()], &at(2.0));
        assert_eq!((log.calls(), log.live().len()), (None, 1));
        assert!(log.live()[0].acknowledged);
    }

    #[test]
    fn what_is_new_calls_again_only_when_it_is_as_urgent() {
        let missed = alarm(AlarmKind::Missed, AlarmPriority::Medium);
        let mut log = AlarmLog::default();
        log.update(std::slice::from_ref(&missed), &at(1.0));
        log.acknowledge();
        let bias = alarm(AlarmKind::BiasMoved, AlarmPriority::Medium);
        log.update(&[missed.clone(), bias.clone()], &at(2.0));
        assert_eq!(log.calls(), Some(AlarmPriority::Medium), "the same priority");
        log.acknowledge();
        log.update(&[fault(), missed.clone(), bias.clone()], &at(3.0));
        assert_eq!(log.calls(), Some(AlarmPriority::High), "a higher one");
        let mut log = AlarmLog::default();
        log.update(&[fault()], &at(1.0));
        log.acknowledge();
        log.update(&[fault(), missed], &at(2.0));
        assert_eq!(log.calls(), None, "a lower one is folded under what was acknowledged");
        assert!(log.has_unseen());
    }

    #[test]
    fn a_low_priority_never_flashes_or_sounds() {
        let mut log = AlarmLog::default();
        log.update(&[alarm(AlarmKind::Scheduling, AlarmPriority::Low)], &at(1.0));
        assert_eq!(log.calls(), None);
    }

    #[test]
    fn what_flickers_is_one_alarm_and_what_comes_back_later_a_new_one() {
        let missed = alarm(AlarmKind::Missed, AlarmPriority::Medium);
        let mut log = AlarmLog::default();
        log.update(std::slice::from_ref(&missed), &at(1.0));
        log.acknowledge();
        log.update(&[], &at(2.0));
        assert!(log.live().is_empty() && log.newest_first().next().unwrap().ended == Some(at(2.0)));
        log.update(std::slice::from_ref(&missed), &at(3.0));
        assert_eq!((log.calls(), log.newest_first().count()), (None, 1));
        log.update(&[], &at(4.0));
        log.update(&[missed], &at(20.0));
        assert_eq!((log.calls(), log.newest_first().count()), (Some(AlarmPriority::Medium), 2));
    }

    #[test]
    fn an_active_alarm_is_listed_before_newer_ones_that_have_ended() {
        let mut log = AlarmLog::default();
        let missed = alarm(AlarmKind::Missed, AlarmPriority::Medium);
        log.update(&[fault()], &at(0.0));
        log.update(&[fault(), missed], &at(30.0));
        log.update(&[fault()], &at(60.0));
        let ended: Vec<bool> = log.active_first().map(|entry| entry.ended.is_some()).collect();
        assert_eq!(ended, [false, true]);
    }

    #[test]
    fn the_log_keeps_the_last_and_never_loses_what_lives() {
        let mut log = AlarmLog::default();
        let missed = alarm(AlarmKind::Missed, AlarmPriority::Medium);
        log.update(&[fault()], &at(0.0));
        for i in 1..200 {
            let t_s = f64::from(i) * 20.0;
            log.update(&[fault(), missed.clone()], &at(t_s));
            log.update(&[fault()], &at(t_s + 1.0));
        }
        assert_eq!(log.newest_first().count(), KEPT);
        assert_eq!(log.live()[0].began, at(0.0));
    }
}
