use crate::{
    PAIRS, Questionnaire, QuestionnaireAnswers, Ratings, TlxScale, of_sus, raw_tlx, simulated::SimulatedParticipant,
    weighted_tlx,
};

/// Computed by hand: ratings 30, 15, 60, 40, 40, 30; the scales are chosen 3, 0, 5, 1, 3, 3 times: 90 + 0 + 300 + 40 +
/// 120 + 90 = 640.
#[test]
fn the_weighted_tlx_is_weight_times_rating_over_fifteen() {
    use TlxScale::{Effort, Frustration, Mental, Performance, Temporal};
    let chosen = PAIRS.map(|pair| match pair {
        (TlxScale::Mental, TlxScale::Physical | TlxScale::Performance | TlxScale::Effort) => Mental,
        (TlxScale::Temporal, _) | (_, TlxScale::Temporal) => Temporal,
        (TlxScale::Physical, TlxScale::Performance) => Performance,
        (_, TlxScale::Effort) | (TlxScale::Effort, _) => Effort,
        _ => Frustration,
    });
    let count = |scale: TlxScale| chosen.iter().filter(|one| **one == scale).count();
    let weights = [Mental, TlxScale::Physical, Temporal, Performance, Effort, Frustration].map(count);
    assert_eq!(weights, [3, 0, 5, 1, 3, 3]);
    let ratings = [30, 15, 60, 40, 40, 30];
    assert!((weighted_tlx(&ratings, &chosen) - 640.0 / 15.0).abs() < 1e-12);
    // Equal weights would give the raw score, the mean.
    assert!((raw_tlx(&ratings) - 215.0 / 6.0).abs() < 1e-12);
    assert!((weighted_tlx(&[70; 6], &chosen) - 70.0).abs() < 1e-12, "the weights add up to fifteen");
}

/// Brooke 1996: the example's contributions are 4, 1, 1, 4, 1, 2, 1, 1, 4, 3.
#[test]
fn the_sus_is_that_of_its_authors_example_and_of_its_ends() {
    for (items, score) in [
        ([5, 4, 2, 1, 2, 3, 2, 4, 5, 2], 55.0),
        ([5, 1, 5, 1, 5, 1, 5, 1, 5, 1], 100.0),
        ([1, 5, 1, 5, 1, 5, 1, 5, 1, 5], 0.0),
        ([3; 10], 50.0),
    ] {
        assert!((of_sus(&items) - score).abs() < 1e-12, "{items:?}");
    }
}

#[test]
fn answers_are_read_from_text_and_what_the_form_does_not_allow_is_refused() {
    let tlx =
        "nasa_tlx = { mental = 50, physical = 5, temporal = 100, performance = 0, effort = 50, frustration = 50 }";
    let read = |text: &str, asked| QuestionnaireAnswers::from_toml(text, asked);
    let answers = read(tlx, Questionnaire::NasaTlx).unwrap();
    assert_eq!(answers.scores()[0], ("nasa_tlx_raw", 42.5));
    let (first, _) = PAIRS[0];
    let ratings = Ratings::of([50; 6]);
    let wrong = QuestionnaireAnswers::NasaTlxWeighted { ratings, chosen: [first; 15] };
    assert!(wrong.check().unwrap_err().contains("number 6"), "{:?}", wrong.check());
    for (text, asked, words) in [
        ("realism = 0", Questionnaire::Realism, "from 1 to 7"),
        ("realism = 'good'", Questionnaire::Realism, "cannot be read"),
        ("sus = [3, 3, 3, 3, 3, 3, 3, 3, 3, 6]", Questionnaire::Sus, "answer 10 is 6"),
        ("sus = [3, 3]", Questionnaire::Sus, "cannot be read"),
        ("realism = 4", Questionnaire::Sus, "missing: write sus = "),
        (&tlx.replace("100", "101"), Questionnaire::NasaTlx, "temporal = 101"),
        (&tlx.replace("100", "42"), Questionnaire::NasaTlx, "steps of 5"),
        (&tlx.replace("mental = 50, ", ""), Questionnaire::NasaTlx, "mental"),
        ("realizm = 4", Questionnaire::Realism, "realizm"),
    ] {
        let report = read(text, asked).unwrap_err();
        assert!(report.contains(words) && report.lines().count() == 1, "{text}: {report}");
    }
}

#[test]
fn simulated_people_give_answers_that_the_forms_allow_and_learn_and_tire() {
    for number in 0..20 {
        let person = SimulatedParticipant::new(3, number);
        for (made, asked) in (0..10).zip(Questionnaire::ALL.into_iter().cycle()) {
            let answers = person.answers(asked, made);
            assert_eq!((answers.check(), answers.questionnaire()), (Ok(()), asked));
            assert_eq!(
                answers,
                SimulatedParticipant::new(3, number).answers(asked, made),
                "the same seed, the same answers"
            );
        }
        let hand = |made, since| person.hand(made, since, 1).pace;
        assert!(hand(20, 0) > hand(0, 0), "learning");
        assert!(
            hand(20, 12) < hand(20, 0) && person.hand(20, 12, 1).tremor_m > person.hand(20, 0, 1).tremor_m,
            "fatigue"
        );
        assert!((0.4..=1.3).contains(&hand(0, 0)));
    }
    assert_ne!(SimulatedParticipant::new(3, 0).hand(0, 0, 1), SimulatedParticipant::new(3, 1).hand(0, 0, 1));
    assert_ne!(
        SimulatedParticipant::new(3, 0).hand(0, 0, 1).seed,
        SimulatedParticipant::new(3, 0).hand(0, 0, 2).seed,
        "a repetition is not the same"
    );
}
