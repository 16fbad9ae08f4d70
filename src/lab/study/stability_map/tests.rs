use super::*;

#[test]
fn the_committed_map_is_whole_and_is_what_it_writes() {
    let map = StabilityMap::committed().unwrap();
    assert_eq!(map.csv(), include_str!("../../../../assets/stability_map.csv"));
    let error = StabilityMap::parse("header\nliteral,0,12,SSSSSSS\n").unwrap_err();
    assert_eq!(error.line, 2);
    assert!(StabilityMap::parse("").is_err());
}

#[test]
fn the_committed_map_is_what_the_simulation_says_now() {
    let map = StabilityMap::committed().unwrap();
    for (mode, gain, delay_s, n_m) in [
        (Mode::Dfr, 0.5, 0.0, 100.0),
        (Mode::Dfr, 1.0, 0.1, 100.0),
        (Mode::Dfr, 3.0, 0.3, 6000.0),
        (Mode::Anchored, 1.0, 0.05, 200.0),
        (Mode::Linear, 1.0, 0.05, 400.0),
        (Mode::Matched, 2.0, 0.05, 400.0),
        (Mode::Nima, 1.0, 0.3, 800.0),
        (Mode::Best, 1.0, 0.1, 2000.0),
    ] {
        assert_eq!(
            trial(mode, gain, delay_s, n_m).unwrap(),
            map.at(mode, gain, delay_s, n_m),
            "{mode} {gain} {delay_s} {n_m}"
        );
    }
}

#[test]
fn soft_contact_is_stable_and_late_reflection_of_a_wall_is_not() {
    let map = StabilityMap::committed().unwrap();
    assert_eq!(map.at(Mode::Dfr, 1.0, 0.0, 12.0), StabilityMapVerdict::Stable);
    assert_eq!(map.at(Mode::Dfr, 1.0, 0.3, 6000.0), StabilityMapVerdict::Unstable);
    assert!(map.greatest_stable_gain(Mode::Dfr, 0.3, 12.0) > map.greatest_stable_gain(Mode::Dfr, 0.3, 6000.0));
}

#[test]
fn late_reflection_is_stable_where_theory_says() {
    // At any delay the loop is stable while gain times stiffness is below the smallest dynamic stiffness of the hand, k
    // 2 z sqrt(1 - z^2) with the damping ratio z = 0.507: 787 N/m. Above that it is unstable for long delays.
    let map = StabilityMap::committed().unwrap();
    for n_m in STIFFNESSES_N_M {
        for gain in GAINS.into_iter().filter(|gain| (gain * n_m / 787.0 - 1.0).abs() > 0.01) {
            let stable = map.at(Mode::Dfr, gain, 0.3, n_m) == StabilityMapVerdict::Stable;
            assert_eq!(stable, gain * n_m < 787.0, "gain {gain}, {n_m} N/m");
        }
    }
}

#[test]
fn between_points_the_worst_neighbour_answers_and_beyond_the_ends_the_last() {
    let mut map = StabilityMap { verdicts: vec![StabilityMapVerdict::Stable; POINTS] };
    map.verdicts[index(Mode::Dfr.index(), 4, 2, 5)] = StabilityMapVerdict::Unstable;
    assert_eq!(map.at(Mode::Dfr, 2.0, 0.1, 100.0), StabilityMapVerdict::Unstable);
    assert_eq!(map.at(Mode::Dfr, 1.9, 0.08, 90.0), StabilityMapVerdict::Unstable);
    assert_eq!(map.at(Mode::Dfr, 1.5, 0.1, 100.0), StabilityMapVerdict::Stable);
    assert!((map.greatest_stable_gain(Mode::Dfr, 0.1, 100.0) - 1.5).abs() < f64::EPSILON);
    assert!((map.greatest_stable_gain(Mode::Dfr, 0.2, 100.0) - 3.0).abs() < f64::EPSILON);
    let last = index(Mode::Dfr.index(), 7, 7, 7);
    map.verdicts[last] = StabilityMapVerdict::Marginal;
    for point in [[9.0, 9.0, 1e9], [f64::NAN; 3]] {
        assert_eq!(map.at(Mode::Dfr, point[0], point[1], point[2]), StabilityMapVerdict::Marginal, "{point:?}");
    }
    assert_eq!(map.at(Mode::Dfr, 0.0, 9.0, 1e9), StabilityMapVerdict::Stable);
}
