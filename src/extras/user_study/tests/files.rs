use super::{TWO, file};
use crate::StudyFile;

fn mistakes(text: &str) -> Vec<String> {
    StudyFile::from_toml(text).unwrap_err().0
}

#[test]
fn every_mistake_is_one_line_that_names_the_key() {
    let with = |line: &str| format!("{line}\n{TWO}");
    let ending = |lines: &str| format!("{TWO}\n{lines}");
    for (text, words) in [
        (TWO.replace("name = 'Touching'", ""), "name"),
        (TWO.replace("'Touching'", "''"), "name must be"),
        (TWO.replace("participants = 4", "participants = 0"), "participants = 0"),
        (TWO.replace("participants = 4", "participants = 'many'"), "line 5"),
        (TWO.replace("trials = 3", "trials = 1000"), "trials = 1000"),
        (with("attempts = 11"), "attempts = 11"),
        (with("pilot = true"), "pilot"),
        (with("secondary = ['speed']"), "there is no measure \"speed\""),
        (with("secondary = ['completion_time_s']"), "occurs twice"),
        (with("secondary = ['peak_force_n']"), "_left or _right"),
        (with("reference = 'Gnu'"), "no condition \"Gnu\""),
        (TWO.replace("mode = 'anchored'\n", ""), "mode is missing"),
        (TWO.replace("'anchored'", "'sideways'"), "sideways"),
        (TWO.replace("delay_ms = 137.5", "delay_ms = -1.0"), "delay_ms must be"),
        (TWO.replace("delay_ms = 137.5\n", ""), "delay_ms is missing"),
        (TWO.replace("gain = 0.8125", "gain = 1.5"), "gain must be"),
        (TWO.replace("gain = 0.8125", "gain = nan"), "gain must be"),
        (TWO.replace("no_force = true", "no_force = true\ngain = 0.5"), "no_force"),
        (TWO.replace("'Yak'", "'Zebra'"), "called \"Zebra\""),
        (TWO.replace("'Yak'", "'B'"), "mistaken for a label"),
        (TWO.replace("'Yak'", "'Ya,k'"), "its name must be"),
        (ending("[[conditions]]\nname = 'Gnu'\nno_force = true"), "are the same"),
        (ending("[[exclusion]]\nmeasure = 'drops'\nis = 'above'\nexclude = 'trial'"), "limit is missing"),
        (ending("[[exclusion]]\nmeasure = 'drops'\nis = 'missing'\nexclude = 'trial'\ntimes = 2"), "times"),
        (
            ending("[[exclusion]]\nmeasure = 'peak_rendered_n_right'\nis = 'missing'\nexclude = 'trial'"),
            "reveals the condition, so a blind study cannot use it in an exclusion rule",
        ),
        (ending("[practice]\nunder = 'Gnu'\n[practice.criterion]"), "practice.under"),
        (ending("[practice]\n[practice.criterion]\nmax_trials = 5"), "do not fit"),
        (ending("[practice]\n[practice.criterion]\ntime_s = nan"), "time_s"),
        (with("feedback = 'fades'"), "add [practice.criterion]"),
        (with("feedback = 'sometimes'"), "sometimes"),
        (ending("[questionnaires]\nat_end = ['sus', 'sus']"), "sus occurs twice"),
        (ending("[questionnaires]\nat_end = ['mood']"), "mood"),
        (ending("[breaks]\nafter_trials = 0\nleast_s = 5.0"), "breaks.after_trials"),
        (ending("[breaks]\nafter_trials = 1\nleast_s = inf"), "breaks.least_s"),
    ] {
        let report = mistakes(&text);
        assert_eq!(report.len(), 1, "{words}: {report:?}");
        assert!(report[0].contains(words) && report[0].lines().count() == 1, "{words}: {report:?}");
    }
}

#[test]
fn all_mistakes_are_told_at_once() {
    let text = TWO.replace("participants = 4", "participants = 0").replace("delay_ms = 137.5", "delay_ms = 1e9");
    assert_eq!(mistakes(&text).len(), 2);
}

#[test]
fn the_name_of_a_blind_study_tells_no_condition() {
    for name in ["Zebra against Yak", "Touching, anchored", "Touching over 137.5 ms"] {
        let text = TWO.replace("Touching", name);
        assert!(mistakes(&text)[0].contains("everyone can read it"), "{name}");
        assert!(!file(&format!("blind = false\n{text}")).blind);
    }
}

#[test]
fn the_ready_files_are_in_order() {
    for text in
        [include_str!("../../../../config/studies/paper.toml"), include_str!("../../../../config/studies/short.toml")]
    {
        let study = file(text);
        assert!(study.blind && study.seed.is_none(), "a seed in a file would give the labels away");
        let rows = crate::order::williams(study.conditions.len()).len() as u32;
        assert!(study.participants.is_multiple_of(rows));
    }
}
