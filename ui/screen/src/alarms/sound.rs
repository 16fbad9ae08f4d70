//! Sound of alarms, off by default: bursts of pulses as in IEC 60601-1-8, ten for high priority, three for medium.
//!
//! Played by a program of the system, so that no library is needed. If there is none, or it fails, the menu shows that. Nothing
//! here waits: a burst is a child process that is checked in each frame.

use std::{
    f64::consts::TAU,
    io,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
};

use nima_words::text;
use tempfile::TempDir;

use super::AlarmPriority;

/// Programs that play the file named by their last argument, the most common first.
const PLAYERS: &[&str] = if cfg!(windows) {
    &["powershell.exe"]
} else if cfg!(target_os = "macos") {
    &["afplay"]
} else {
    &["pw-play", "paplay", "aplay"]
};
/// Arguments before the file.
const ARGUMENTS: &[&str] = if cfg!(windows) {
    &["-NoProfile", "-Command", "& { (New-Object Media.SoundPlayer $args[0]).PlaySync() }"]
} else {
    &[]
};
// Enough for the partials up to 2.6 kHz; a higher rate would only enlarge the files.
const RATE_HZ: u32 = 22_050;
/// Interval between the starts of two bursts of high priority, s.
const HIGH_EVERY_S: f64 = 6.0;
const MEDIUM_EVERY_S: f64 = 12.0;

#[derive(Debug, Default)]
pub struct Sound {
    player: Option<PathBuf>,
    looked: bool,
    bursts: Option<TempDir>,
    playing: Option<Child>,
    /// Priority of the last burst, and its time, s on the window's clock.
    last: Option<(AlarmPriority, f64)>,
    failure: Option<String>,
}

impl Sound {
    /// Searches for the players in these folders instead of the search path.
    #[cfg(all(test, unix))]
    fn of(folders: &[&Path]) -> Self {
        let mut sound = Self::default();
        sound.player = find(folders.iter().map(|folder| folder.to_path_buf()));
        sound.looked = true;
        sound
    }

    /// Returns the reason why no sound can be played, for the menu; `None` if it can.
    pub fn trouble(&mut self) -> Option<String> {
        self.look();
        match (&self.player, &self.failure) {
            (None, _) => Some(text::alarms::no_player(&PLAYERS.join(", "))),
            (Some(_), Some(failure)) => Some(failure.clone()),
            (Some(_), None) => None,
        }
    }

    /// Plays a burst when one is due; call in each frame with the priority that requires a sound.
    pub fn step(&mut self, calls: Option<AlarmPriority>, time_s: f64) {
        // This also removes a process that has ended.
        if let Some(Ok(Some(status))) = self.playing.as_mut().map(Child::try_wait) {
            self.playing = None;
            self.failure = (!status.success()).then(|| text::alarms::player_failed(&status));
        }
        let Some(priority) = calls else {
            self.last = None;
            return;
        };
        let every_s = if priority == AlarmPriority::High { HIGH_EVERY_S } else { MEDIUM_EVERY_S };
        // A change of the priority is heard at once.
        let due = self.last.is_none_or(|(last, at_s)| last != priority || time_s - at_s >= every_s);
        // Two bursts at the same time would sound like another priority.
        if !due || self.playing.is_some() {
            return;
        }
        self.last = Some((priority, time_s));
        self.look();
        let Some(player) = self.player.clone() else { return };
        match self.play(&player, priority) {
            Ok(child) => self.playing = Some(child),
            Err(error) => self.failure = Some(text::alarms::player_not_started(&error)),
        }
    }

    fn look(&mut self) {
        if !self.looked {
            self.looked = true;
            self.player = find(std::env::var_os("PATH").iter().flat_map(std::env::split_paths));
        }
    }

    fn play(&mut self, player: &Path, priority: AlarmPriority) -> io::Result<Child> {
        let folder = match self.bursts.take() {
            Some(folder) => folder,
            None => bursts()?,
        };
        let file = self.bursts.insert(folder).path().join(file_of(priority));
        let mut command = Command::new(player);
        command.args(ARGUMENTS).arg(file);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn()
    }
}

impl Drop for Sound {
    fn drop(&mut self) {
        if let Some(child) = &mut self.playing {
            // The player must exit before its file is deleted.
            child.kill().ok();
            child.wait().ok();
        }
    }
}

fn find(mut folders: impl Iterator<Item = PathBuf>) -> Option<PathBuf> {
    folders.find_map(|folder| PLAYERS.iter().map(|player| folder.join(player)).find(|path| path.is_file()))
}

/// Creates the files of both bursts.
fn bursts() -> io::Result<TempDir> {
    let folder = tempfile::tempdir()?;
    for priority in [AlarmPriority::High, AlarmPriority::Medium] {
        std::fs::write(folder.path().join(file_of(priority)), wav(&burst(priority)))?;
    }
    Ok(folder)
}

const fn file_of(priority: AlarmPriority) -> &'static str {
    match priority {
        AlarmPriority::High => "high.wav",
        AlarmPriority::Medium | AlarmPriority::Low => "medium.wav",
    }
}

/// Returns the start of each pulse of a burst, and its duration, s.
fn pulses(priority: AlarmPriority) -> (Vec<f64>, f64) {
    match priority {
        AlarmPriority::High => {
            // Five pulses with a longer pause after the third, twice (IEC 60601-1-8).
            let five = [0.0, 0.2, 0.4, 0.75, 0.95];
            (five.iter().copied().chain(five.iter().map(|t_s| t_s + 1.75)).collect(), 0.12)
        }
        AlarmPriority::Medium | AlarmPriority::Low => (vec![0.0, 0.4, 0.8], 0.2),
    }
}

/// Returns the samples of a burst, -1 to 1: a tone with four harmonics, which is easier to locate than a pure tone.
fn burst(priority: AlarmPriority) -> Vec<f64> {
    let tone_hz = if priority == AlarmPriority::High { 660.0 } else { 440.0 };
    let (starts_s, length_s) = pulses(priority);
    let ends_s = starts_s.last().copied().unwrap_or_default() + length_s + 0.05;
    let samples = (ends_s * f64::from(RATE_HZ)) as usize;
    let mut burst = vec![0.0; samples];
    for start_s in starts_s {
        let first = (start_s * f64::from(RATE_HZ)) as usize;
        let count = (length_s * f64::from(RATE_HZ)) as usize;
        for (i, sample) in burst.iter_mut().skip(first).take(count).enumerate() {
            let t_s = i as f64 / f64::from(RATE_HZ);
            let left_s = (count - i) as f64 / f64::from(RATE_HZ);
            // Ramp the volume, because a step would be heard as a click.
            let loud = (t_s / 0.015).min(left_s / 0.015).min(1.0);
            // Partials make the tone audible on small loudspeakers too.
            let tone: f64 = (1..=4).map(|k| (TAU * tone_hz * f64::from(k) * t_s).sin() / f64::from(k)).sum();
            // The sum of the partials is below 2, so 0.35 stays within the range of a sample.
            *sample = 0.35 * loud * tone;
        }
    }
    burst
}

/// Returns a file of 16-bit samples, mono (RIFF WAVE).
fn wav(samples: &[f64]) -> Vec<u8> {
    let bytes = 2 * samples.len() as u32;
    let mut file = Vec::with_capacity(44 + bytes as usize);
    file.extend(b"RIFF");
    file.extend((36 + bytes).to_le_bytes());
    file.extend(b"WAVEfmt ");
    file.extend(16_u32.to_le_bytes());
    for half in [1_u16, 1] {
        file.extend(half.to_le_bytes());
    }
    file.extend(RATE_HZ.to_le_bytes());
    file.extend((2 * RATE_HZ).to_le_bytes());
    for half in [2_u16, 16] {
        file.extend(half.to_le_bytes());
    }
    file.extend(b"data");
    file.extend(bytes.to_le_bytes());
    file.extend(samples.iter().flat_map(|sample| ((sample * f64::from(i16::MAX)) as i16).to_le_bytes()));
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the number of pulses in a burst: sound separated by at least 30 ms of silence.
    fn pulses_received(samples: &[f64]) -> usize {
        let quiet = (0.03 * f64::from(RATE_HZ)) as usize;
        let mut received = 0;
        let mut silent = quiet;
        for sample in samples {
            if sample.abs() > 0.05 {
                received += usize::from(silent >= quiet);
                silent = 0;
            } else {
                silent += 1;
            }
        }
        received
    }

    #[test]
    fn high_is_ten_pulses_and_medium_three_and_neither_is_clipped() {
        for (priority, expected) in [(AlarmPriority::High, 10), (AlarmPriority::Medium, 3)] {
            let samples = burst(priority);
            assert_eq!(pulses_received(&samples), expected, "{priority:?}");
            let loudest = samples.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
            assert!((0.3..1.0).contains(&loudest), "{loudest}");
            assert_eq!(wav(&samples).len(), 44 + 2 * samples.len());
        }
    }

    // The player is a shell script.
    #[cfg(unix)]
    #[test]
    fn a_burst_is_played_when_due_and_silence_or_failure_is_told() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let player = folder.path().join("aplay");
        let report = folder.path().join("told");
        let set = |script: &str| {
            std::fs::write(&player, script).unwrap();
            std::fs::set_permissions(&player, std::fs::Permissions::from_mode(0o755)).unwrap();
        };
        set(&format!("#!/bin/sh\necho \"$(basename $1) $(wc -c < $1)\" >> {}\n", report.display()));
        let mut sound = Sound::of(&[folder.path()]);
        assert_eq!(sound.trouble(), None);
        let finish = |sound: &mut Sound, calls, time_s| {
            sound.step(calls, time_s);
            sound.playing.iter_mut().for_each(|child| drop(child.wait()));
            sound.step(calls, time_s);
        };
        for (calls, time_s) in [
            (AlarmPriority::Medium, 0.0),
            (AlarmPriority::Medium, 1.0),
            (AlarmPriority::High, 2.0),
            (AlarmPriority::High, 8.5),
        ] {
            finish(&mut sound, Some(calls), time_s);
        }
        let played = std::fs::read_to_string(&report).unwrap();
        let names: Vec<&str> = played.lines().filter_map(|line| line.split(' ').next()).collect();
        assert_eq!(names, ["medium.wav", "high.wav", "high.wav"], "not twice within a burst's period");
        finish(&mut sound, None, 20.0);
        assert_eq!(std::fs::read_to_string(&report).unwrap(), played, "acknowledged: silent");
        set("#!/bin/sh\nexit 3\n");
        finish(&mut sound, Some(AlarmPriority::High), 30.0);
        assert!(sound.trouble().unwrap().contains("could not be played"));
        let empty = tempfile::tempdir().unwrap();
        assert!(Sound::of(&[empty.path()]).trouble().unwrap().contains("No alarm sound: none"));
    }
}
