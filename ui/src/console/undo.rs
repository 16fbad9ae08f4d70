//! Undo and redo of the layout and display settings.
//!
//! A [`ScreenLook`] lists everything that can be undone; nothing else is. Settings of the machine (mode, gain, delay, thresholds,
//! engaging, stopping) are excluded, as are the role, whose demonstration sets modes, the alarm sound, and recording. The
//! history ends with the window.

use nima_panels::{ForcesView, settings::ImageSettings, tiles::PanelLayout};
use nima_screen::{scene3d::extras::Extras, theme::Look};
use nima_words::language::Language;

/// Maximum number of undo steps.
const STEPS: usize = 100;
/// Changes of the same part by a slider or wheel within this time form one step, s.
const SAME_STEP_S: f64 = 0.6;

/// Layout and display settings.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ScreenLook {
    pub(super) layout: PanelLayout,
    pub(super) look: Look,
    pub(super) language: Language,
    pub(super) scale_percent: u16,
    pub(super) image: ImageSettings,
    pub(super) extras: Extras,
    pub(super) traces: ForcesView,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LookChange {
    /// Only slider settings of the endoscope image.
    Picture,
    /// Only the interval of the traces, set by wheel and drag.
    Traces,
    /// A setting that one action changes.
    AtOnce,
}

impl ScreenLook {
    /// Returns the difference between two looks. The front tab does not count: undoing it would hide the changes that
    /// matter.
    fn change(&self, other: &Self) -> Option<LookChange> {
        let Self { layout, look, language, scale_percent, image, extras, traces } = self;
        let at_once = !layout.looks_like(&other.layout)
            || *look != other.look
            || *language != other.language
            || *scale_percent != other.scale_percent
            || *extras != other.extras
            || ForcesView { view_s: other.traces.view_s, ..*traces } != other.traces;
        match (at_once, *image != other.image, *traces != other.traces) {
            (false, false, false) => None,
            (false, true, false) => Some(LookChange::Picture),
            (false, false, true) => Some(LookChange::Traces),
            _ => Some(LookChange::AtOnce),
        }
    }
}

/// Looks before the current one, and undone looks.
#[derive(Debug, Default)]
pub(super) struct LookHistory {
    before: Vec<ScreenLook>,
    after: Vec<ScreenLook>,
    now: Option<ScreenLook>,
    last: Option<(LookChange, f64)>,
}

impl LookHistory {
    /// Records the look at the end of a frame, at this time of the window; a change becomes a step once the pointer is not
    /// `held` down.
    pub(super) fn watch(&mut self, look: ScreenLook, time_s: f64, held: bool) {
        let Some(now) = &mut self.now else {
            self.now = Some(look);
            return;
        };
        if held {
            return;
        }
        let Some(change) = now.change(&look) else {
            now.layout.front = look.layout.front;
            return;
        };
        let goes_on = change != LookChange::AtOnce
            && self.last.is_some_and(|(last, at_s)| last == change && time_s - at_s < SAME_STEP_S);
        let before = std::mem::replace(now, look);
        self.last = Some((change, time_s));
        self.after.clear();
        if !goes_on {
            self.before.push(before);
            if self.before.len() > STEPS {
                self.before.remove(0);
            }
        }
    }

    /// Records the next look without a step: the operator did not make the change.
    pub(super) fn adopt(&mut self) {
        self.now = None;
    }

    pub(super) const fn can_undo(&self) -> bool {
        !self.before.is_empty()
    }

    pub(super) const fn can_redo(&self) -> bool {
        !self.after.is_empty()
    }

    pub(super) fn undo(&mut self) -> Option<ScreenLook> {
        let look = self.before.pop()?;
        self.after.extend(self.now.replace(look.clone()));
        self.last = None;
        Some(look)
    }

    pub(super) fn redo(&mut self) -> Option<ScreenLook> {
        let look = self.after.pop()?;
        self.before.extend(self.now.replace(look.clone()));
        self.last = None;
        Some(look)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nima_panels::{TracesState, tiles::PanelId};

    fn plain() -> ScreenLook {
        ScreenLook {
            layout: PanelLayout::default(),
            look: Look::default(),
            language: Language::English,
            scale_percent: 100,
            image: ImageSettings::default(),
            extras: Extras::default(),
            traces: TracesState::default().view(),
        }
    }

    #[test]
    fn steps_are_taken_back_and_made_again_and_a_new_one_ends_that() {
        let mut history = LookHistory::default();
        let looks: Vec<ScreenLook> =
            [100, 125, 150].map(|scale_percent| ScreenLook { scale_percent, ..plain() }).to_vec();
        for (time_s, look) in looks.iter().enumerate() {
            history.watch(look.clone(), time_s as f64, false);
        }
        assert_eq!(
            [history.undo(), history.undo(), history.undo()],
            [Some(looks[1].clone()), Some(looks[0].clone()), None]
        );
        assert_eq!(history.redo(), Some(looks[1].clone()));
        history.watch(looks[1].clone(), 9.0, false);
        assert!(history.can_undo() && history.can_redo(), "redoing does not add a step");
        history.watch(ScreenLook { look: Look { light: true, ..Look::default() }, ..looks[1].clone() }, 10.0, false);
        assert!(!history.can_redo());
        assert_eq!(history.undo(), Some(looks[1].clone()));
    }

    #[test]
    fn a_drag_is_one_step_and_a_slider_that_goes_on_too() {
        let mut history = LookHistory::default();
        let bright = |brightness_percent| ScreenLook {
            image: ImageSettings { brightness_percent, ..ImageSettings::default() },
            ..plain()
        };
        history.watch(plain(), 0.0, false);
        for percent in 1..=20 {
            history.watch(bright(percent), 1.0 + 0.1 * f64::from(percent), false);
        }
        history.watch(bright(40), 9.0, true);
        history.watch(bright(50), 9.1, false);
        assert_eq!([history.undo(), history.undo(), history.undo()], [Some(bright(20)), Some(plain()), None]);
    }

    #[test]
    fn a_tab_in_front_is_no_step_and_goes_along() {
        let mut history = LookHistory::default();
        history.watch(plain(), 0.0, false);
        let front =
            ScreenLook { layout: PanelLayout { front: vec![PanelId::Link], ..PanelLayout::default() }, ..plain() };
        history.watch(front.clone(), 1.0, false);
        assert!(!history.can_undo());
        history.watch(ScreenLook { look: Look { light: true, ..Look::default() }, ..front.clone() }, 2.0, false);
        assert_eq!(history.undo(), Some(front));
    }

    #[test]
    fn the_history_is_bounded_and_what_nobody_did_is_no_step() {
        let mut history = LookHistory::default();
        for step in 0..3 * STEPS {
            history.watch(
                ScreenLook { look: Look { light: step % 2 == 0, ..Look::default() }, ..plain() },
                step as f64,
                false,
            );
        }
        assert_eq!(std::iter::from_fn(|| history.undo()).count(), STEPS);
        let mut history = LookHistory::default();
        history.watch(plain(), 0.0, false);
        history.adopt();
        history.watch(ScreenLook { look: Look { light: true, ..Look::default() }, ..plain() }, 1.0, false);
        assert!(!history.can_undo());
    }
}
