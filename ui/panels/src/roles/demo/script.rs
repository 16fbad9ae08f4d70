//! The chapters of the demonstration.

use nima_core::impedance::Mode;
use nima_words::{language::Text, text};

/// One step of the script.
#[derive(Debug)]
pub(super) struct ScriptStep {
    pub(super) name: Text,
    /// Explanation.
    pub(super) words: Text,
    pub(super) mode: Mode,
    /// Delay of the link, s.
    pub(super) delay_s: f64,
    /// Whether the hand releases the handle while it presses, and if so, with or without the governor.
    pub(super) lets_go: Option<GovernorAction>,
    /// Whether the audience drives the simulated hand.
    pub(super) is_driven: bool,
    /// Duration, s.
    pub(super) seconds: f64,
}

/// The governor while the hand releases the handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GovernorAction {
    Watches,
    /// Switched off, to show its purpose.
    LeftOut,
}

pub(super) const SCRIPT: [ScriptStep; 9] = [
    ScriptStep {
        name: text::roles::DEMO_START,
        words: text::roles::DEMO_START_CAPTION,
        mode: Mode::Best,
        delay_s: 0.05,
        lets_go: None,
        is_driven: false,
        seconds: 14.0,
    },
    ScriptStep {
        name: text::roles::DEMO_DIRECT,
        words: text::roles::DEMO_DIRECT_CAPTION,
        mode: Mode::Dfr,
        delay_s: 0.3,
        lets_go: None,
        is_driven: false,
        seconds: 14.0,
    },
    ScriptStep {
        name: text::roles::DEMO_LINEAR,
        words: text::roles::DEMO_LINEAR_CAPTION,
        mode: Mode::Linear,
        delay_s: 0.3,
        lets_go: None,
        is_driven: false,
        seconds: 14.0,
    },
    ScriptStep {
        name: text::roles::DEMO_LITERAL,
        words: text::roles::DEMO_LITERAL_CAPTION,
        mode: Mode::Literal,
        delay_s: 0.3,
        lets_go: None,
        is_driven: false,
        seconds: 14.0,
    },
    ScriptStep {
        name: text::roles::DEMO_ANCHORED,
        words: text::roles::DEMO_ANCHORED_CAPTION,
        mode: Mode::Anchored,
        delay_s: 0.3,
        lets_go: None,
        is_driven: false,
        seconds: 14.0,
    },
    ScriptStep {
        name: text::roles::DEMO_MATCHED,
        words: text::roles::DEMO_MATCHED_CAPTION,
        mode: Mode::Matched,
        delay_s: 0.3,
        lets_go: None,
        is_driven: false,
        seconds: 14.0,
    },
    ScriptStep {
        name: text::roles::DEMO_LET_GO,
        words: text::roles::DEMO_LET_GO_CAPTION,
        mode: Mode::Dfr,
        delay_s: 0.3,
        lets_go: Some(GovernorAction::LeftOut),
        is_driven: false,
        seconds: 16.0,
    },
    ScriptStep {
        name: text::roles::DEMO_GOVERNOR,
        words: text::roles::DEMO_GOVERNOR_CAPTION,
        mode: Mode::Dfr,
        delay_s: 0.3,
        lets_go: Some(GovernorAction::Watches),
        is_driven: false,
        seconds: 16.0,
    },
    ScriptStep {
        name: text::roles::DEMO_YOUR_TURN,
        words: text::roles::DEMO_YOUR_TURN_CAPTION,
        mode: Mode::Best,
        delay_s: 0.05,
        lets_go: None,
        is_driven: true,
        seconds: 20.0,
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use nima_words::language::{self, Language};

    #[test]
    fn every_chapter_is_long_enough_to_be_read() {
        for step in &SCRIPT {
            for language in Language::CHOICES {
                let words = language::with(language, || step.words.get().split_whitespace().count() as f64);
                assert!(step.seconds >= words / 4.0, "{}: {words} words in {} s", step.name, step.seconds);
            }
        }
    }

    #[test]
    fn the_modes_of_the_paper_and_ours_are_all_shown() {
        for mode in [Mode::Literal, Mode::Linear, Mode::Dfr, Mode::Anchored, Mode::Matched, Mode::Best] {
            assert!(SCRIPT.iter().any(|step| step.mode == mode), "{mode}");
        }
    }
}
