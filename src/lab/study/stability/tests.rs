use super::*;

#[test]
fn ours_holds_at_the_extremes() {
    let report = study(&StabilityOptions { ticks: 10_000, quick: true }, |_, _, _| {}).unwrap();
    for extreme in &report.extremes {
        assert!(extreme.identifier_finite, "{}", extreme.name);
        for rendering in &extreme.renderings {
            // The shortest case ends before the first packet has arrived.
            let too_short = extreme.window as f64 / extreme.rate_hz < 0.05;
            assert!(rendering.asked > 0 || too_short, "{}: {rendering:?}", extreme.name);
            assert_eq!(rendering.finite, rendering.asked, "{}: {rendering:?}", extreme.name);
        }
        for entry in extreme.entries.iter().filter(|entry| entry.solver == LeastSquaresSolver::Sliding) {
            let name = format!("{} N={}: {entry:?}", extreme.name, entry.degree);
            assert_eq!(entry.finite, entry.asked, "{name}");
            if entry.condition.unwrap() < ORDINARY_CONDITION {
                assert!(entry.error.unwrap() <= TARGET, "{name}");
                assert!(entry.unit_difference.unwrap() <= TARGET, "{name}");
            }
        }
    }
    assert!(report.verdict.reached, "{:?} {:?}", report.verdict, report.drift);
    let literal = &report.verdict.failures[0];
    assert!(literal.not_finite + literal.wrong > literal.tried / 3, "{literal:?}");
}

#[test]
fn a_long_run_answers_as_one_that_began_later() {
    for endurance in rendering::endurance(Endurance::FRESH + 80_001).unwrap() {
        assert!(endurance.not_finite == 0 && endurance.difference.unwrap() <= TARGET, "{endurance:?}");
    }
}

#[test]
fn too_few_ticks_are_refused() {
    let error = study(&StabilityOptions { ticks: 9, quick: true }, |_, _, _| {}).unwrap_err();
    assert_eq!(error.to_string(), "9 ticks are out of range; use 10000 to 1000000000");
}
