//! The numbers of R and `SciPy` (`peers.json`, computed by tests/peers/analysis.py, with their versions). `--nocapture`
//! prints the worst differences.

use crate::mixed::{MixedCriterion, MixedFit, MixedModel};
use crate::signed_rank::{self, Distribution, SignedRankOptions, Zeros};
use crate::{Bootstrap, bootstrap, correction, distribution, effect, friedman, mann_whitney, power, summary, t_test};
use serde_json::Value;
use std::collections::BTreeMap;

/// Maximum deviation of all numbers here, relative to the greater of the number and 1.
const LIMIT: f64 = 1e-6;

/// Differences, grouped by the compared quantity.
#[derive(Default)]
struct Worst(BTreeMap<&'static str, (f64, usize)>);

impl Worst {
    #[track_caller]
    fn compare(&mut self, what: &'static str, found: f64, expected: &Value) {
        let expected = expected.as_f64().unwrap_or(f64::NAN);
        let error = (found - expected).abs() / expected.abs().max(1.0);
        assert!(error <= LIMIT, "{what}: {found}, not {expected}");
        let worst = self.0.entry(what).or_default();
        *worst = (worst.0.max(error), worst.1 + 1);
    }

    #[track_caller]
    fn compare_all(&mut self, what: &'static str, found: impl IntoIterator<Item = f64>, expected: &Value) {
        let found: Vec<f64> = found.into_iter().collect();
        let expected = expected.as_array().unwrap();
        assert_eq!(found.len(), expected.len(), "{what}");
        found.into_iter().zip(expected).for_each(|(found, expected)| self.compare(what, found, expected));
    }

    fn report(&self) {
        for (what, (error, count)) in &self.0 {
            println!("{what}: {count} numbers, worst difference {error:.1e}");
        }
    }
}

fn peers() -> Value {
    serde_json::from_str(include_str!("peers.json")).unwrap()
}

fn sets<'a>(peers: &'a Value, kind: &'a str) -> impl Iterator<Item = &'a Value> {
    peers["sets"].as_array().unwrap().iter().filter(move |set| set["kind"] == kind)
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn words(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect()
}

#[test]
fn the_signed_rank_test_gives_the_numbers_of_r_and_scipy() {
    let peers = peers();
    let mut worst = Worst::default();
    for set in sets(&peers, "signed_rank") {
        let r = &set["r"];
        let python = &set["python"];
        let d = numbers(&set["differences"]);
        let test =
            |zeros, distribution| signed_rank::of_differences(&d, &SignedRankOptions { zeros, distribution }).unwrap();
        worst.compare("W+, R", test(Zeros::Wilcoxon, Distribution::Normal).w_plus, &r["v"]);
        worst.compare("normal p, R", test(Zeros::Wilcoxon, Distribution::Normal).p, &r["normal"]);
        worst.compare("normal p, SciPy", test(Zeros::Wilcoxon, Distribution::Normal).p, &python["normal_wilcox"]);
        worst.compare(
            "normal p with Pratt's rule, SciPy",
            test(Zeros::Pratt, Distribution::Normal).p,
            &python["normal_pratt"],
        );
        if d.len() <= signed_rank::MAX_EXACT {
            worst.compare("exact p, coin", test(Zeros::Wilcoxon, Distribution::Exact).p, &r["exact"]);
            worst.compare("exact p with Pratt's rule, coin", test(Zeros::Pratt, Distribution::Exact).p, &r["pratt"]);
        }
        if !python["exact_wilcox"].is_null() {
            worst.compare("exact p, SciPy", test(Zeros::Wilcoxon, Distribution::Exact).p, &python["exact_wilcox"]);
        }
        if !python["exact_pratt"].is_null() {
            worst.compare(
                "exact p with Pratt's rule, SciPy",
                test(Zeros::Pratt, Distribution::Exact).p,
                &python["exact_pratt"],
            );
        }
        let location = signed_rank::location(&d, 0.95).unwrap();
        let interval = location.interval;
        worst.compare_all(
            "Hodges-Lehmann, NumPy",
            [location.estimate, interval.lower, interval.upper],
            &python["location"],
        );
        if !r["location"].is_null() {
            let found = [location.estimate, interval.lower, interval.upper, interval.confidence];
            worst.compare_all("Hodges-Lehmann, R", found, &r["location"]);
        }
        worst.compare("rank-biserial, NumPy", effect::rank_biserial(&d).unwrap(), &python["rank_biserial"]);
        let t = t_test::of_differences(&d, 0.95).unwrap();
        worst.compare_all("t-test, R", [t.t, t.p, t.interval.lower, t.interval.upper], &r["t"]);
    }
    worst.report();
}

#[test]
fn the_mann_whitney_test_gives_the_numbers_of_r_and_scipy() {
    let peers = peers();
    let mut worst = Worst::default();
    for set in sets(&peers, "mann_whitney") {
        let r = &set["r"];
        let python = &set["python"];
        let first = numbers(&set["first"]);
        let second = numbers(&set["second"]);
        let test = |distribution| mann_whitney::test(&first, &second, distribution).unwrap();
        worst.compare("U, R", test(Distribution::Normal).u, &r["w"]);
        worst.compare("normal p, R", test(Distribution::Normal).p, &r["normal"]);
        worst.compare("normal p, SciPy", test(Distribution::Normal).p, &python["normal"]);
        if !r["exact"].is_null() {
            worst.compare("exact p, coin", test(Distribution::Exact).p, &r["exact"]);
        }
        if !python["exact"].is_null() {
            worst.compare("exact p, SciPy", test(Distribution::Exact).p, &python["exact"]);
        }
        let shift = mann_whitney::shift(&first, &second, 0.95).unwrap();
        worst.compare("shift, NumPy", shift.estimate, &python["shift"]);
        if !r["shift"].is_null() {
            let found = [shift.estimate, shift.interval.lower, shift.interval.upper, shift.interval.confidence];
            worst.compare_all("shift, R", found, &r["shift"]);
        }
    }
    worst.report();
}

#[test]
fn friedmans_test_gives_the_numbers_of_r_and_scipy() {
    let peers = peers();
    let mut worst = Worst::default();
    for set in sets(&peers, "friedman") {
        let rows: Vec<Vec<f64>> = set["rows"].as_array().unwrap().iter().map(numbers).collect();
        let test = friedman::test(&rows).unwrap();
        let python = &set["python"];
        worst.compare("chi-square, R", test.chi_square, &set["r"]["chi_square"]);
        worst.compare("p, R", test.p, &set["r"]["p"]);
        worst.compare("p, SciPy", test.p, &python["p"]);
        worst.compare("F, SciPy", test.f.unwrap(), &python["f"]);
        worst.compare("p of F, SciPy", test.f_p, &python["f_p"]);
        worst.compare("W, SciPy", test.w, &python["w"]);
    }
    worst.report();
}

fn fit(set: &Value, criterion: MixedCriterion) -> MixedFit {
    let participant = words(&set["participant"]);
    let condition = words(&set["condition"]);
    let response = numbers(&set["response"]);
    let mut model = MixedModel::new(&participant, &condition, set["reference"].as_str().unwrap(), &response).unwrap();
    // Follow the script's order, because a JSON map is read in alphabetical order.
    for name in ["trial", "place"] {
        if let Some(values) = set["covariates"].get(name) {
            model = model.covariate(name, &numbers(values)).unwrap();
        }
    }
    model.fit(criterion, 0.95).unwrap()
}

#[test]
fn the_mixed_model_gives_the_numbers_of_lmertest() {
    let peers = peers();
    let mut worst = Worst::default();
    for (set, criterion, name) in
        sets(&peers, "mixed").flat_map(|set| [(set, MixedCriterion::Reml, "reml"), (set, MixedCriterion::Ml, "ml")])
    {
        let fit = fit(set, criterion);
        let r = &set["r"][name];
        let each = |of: fn(&crate::mixed::FixedEffect) -> f64| fit.effects.iter().map(of).collect::<Vec<_>>();
        worst.compare_all("estimates", each(|effect| effect.estimate), &r["estimate"]);
        worst.compare_all("standard errors", each(|effect| effect.standard_error), &r["error"]);
        worst.compare_all("t", each(|effect| effect.t), &r["t"]);
        worst.compare_all("degrees of freedom", each(|effect| effect.df), &r["df"]);
        worst.compare_all("p", each(|effect| effect.p), &r["p"]);
        worst.compare_all("lower ends", each(|effect| effect.interval.lower), &r["lower"]);
        worst.compare_all("upper ends", each(|effect| effect.interval.upper), &r["upper"]);
        worst.compare_all("variances", [fit.participant_variance, fit.residual_variance], &r["variances"]);
        worst.compare("log-likelihood", fit.log_likelihood, &r["log_likelihood"]);
        let joint = fit.conditions.unwrap();
        worst.compare_all("joint test", [joint.f, joint.df, joint.denominator_df, joint.p], &r["joint"]);
        worst.compare_all("intercepts", fit.intercepts.iter().map(|(_, value)| *value), &r["intercepts"]);
    }
    worst.report();
}

/// The standard errors are not compared, because the peer computes them from another information matrix; they agree
/// only for balanced trials.
#[test]
fn the_mixed_model_gives_the_estimates_of_statsmodels() {
    let peers = peers();
    let mut worst = Worst::default();
    for set in sets(&peers, "mixed") {
        let fit = fit(set, MixedCriterion::Reml);
        let python = &set["python"];
        worst.compare_all(
            "estimates, statsmodels",
            fit.effects.iter().map(|effect| effect.estimate),
            &python["estimate"],
        );
        worst.compare_all(
            "variances, statsmodels",
            [fit.participant_variance, fit.residual_variance],
            &python["variances"],
        );
        worst.compare("log-likelihood, statsmodels", fit.log_likelihood, &python["log_likelihood"]);
    }
    worst.report();
}

#[test]
fn the_bootstrap_gives_the_intervals_of_scipy_for_the_same_draws() {
    let peers = peers();
    let mut worst = Worst::default();
    for set in sets(&peers, "bootstrap") {
        let sample = numbers(&set["sample"]);
        for (method, name) in
            [(bootstrap::BootstrapMethod::Percentile, "percentile"), (bootstrap::BootstrapMethod::BiasCorrected, "BCa")]
        {
            let resamples = set["resamples"].as_u64().unwrap() as usize;
            let bootstrap = Bootstrap { resamples, seed: set["seed"].as_u64().unwrap(), confidence: 0.95, method };
            for (of, interval) in [("mean", bootstrap.mean(&sample)), ("median", bootstrap.median(&sample))] {
                let interval = interval.unwrap();
                worst.compare_all(
                    "ends, SciPy",
                    [interval.lower, interval.upper],
                    &set["python"][format!("{of}_{name}")],
                );
            }
        }
    }
    worst.report();
}

#[test]
fn effect_sizes_are_those_of_their_definitions() {
    let peers = peers();
    let mut worst = Worst::default();
    for set in sets(&peers, "effect") {
        let first = numbers(&set["first"]);
        let second = numbers(&set["second"]);
        let python = &set["python"];
        let d = effect::cohens_d(&first, &second).unwrap();
        let dz = effect::cohens_dz(&first).unwrap();
        for (found, name) in [(d.d, "d"), (d.g, "g"), (dz.d, "dz"), (dz.g, "gz")] {
            worst.compare("d, NumPy", found, &python[name]);
        }
        worst.compare("Cliff's delta, NumPy", effect::cliffs_delta(&first, &second).unwrap(), &python["cliff"]);
        worst.compare("A, from the U of SciPy", effect::vargha_delaney(&first, &second).unwrap(), &python["a"]);
    }
    worst.report();
}

#[test]
fn tails_and_quantiles_are_those_of_scipy() {
    let peers = peers();
    let mut worst = Worst::default();
    let rows = |name: &str| peers["distributions"][name].as_array().unwrap().clone();
    let at = |row: &Value, column: usize| row[column].as_f64().unwrap();
    // Tails are compared by their ratio: a small p-value keeps its digits.
    let mut tail = |what, found: f64, row: &Value, column: usize| {
        let expected = at(row, column);
        worst.compare(what, if expected.abs() > 0.0 { found / expected } else { found + 1.0 }, &Value::from(1.0));
    };
    for row in rows("t") {
        tail("t, ratio", distribution::t_two_sided(at(&row, 0), at(&row, 1)), &row, 2);
    }
    for row in rows("f") {
        tail("F, ratio", distribution::f_above(at(&row, 0), at(&row, 1), at(&row, 2)), &row, 3);
    }
    for row in rows("chi_square") {
        tail("chi-square, ratio", distribution::chi_square_above(at(&row, 0), at(&row, 1)), &row, 2);
    }
    for row in rows("normal") {
        tail("normal, ratio", distribution::normal_two_sided(at(&row, 0)), &row, 1);
        tail(
            "normal quantile, ratio",
            distribution::normal_quantile(distribution::normal_below(-at(&row, 0))),
            &row,
            2,
        );
    }
    for row in rows("t_critical") {
        worst.compare("t quantile", distribution::t_critical(at(&row, 0), at(&row, 1)), &row[2]);
    }
    worst.report();
}

#[test]
fn corrections_quantiles_and_wilsons_interval_are_those_of_scipy_and_statsmodels() {
    let peers = peers();
    let mut worst = Worst::default();
    let p = numbers(&peers["corrections"]["p"]);
    worst.compare_all("Holm, statsmodels", correction::holm(&p).unwrap(), &peers["corrections"]["holm"]);
    worst.compare_all(
        "Bonferroni, statsmodels",
        correction::bonferroni(&p).unwrap(),
        &peers["corrections"]["bonferroni"],
    );
    for row in peers["quantiles"].as_array().unwrap() {
        let found = summary::quantile(&[3.0, 1.0, 4.0, 1.5, 9.0, 2.6], row[0].as_f64().unwrap()).unwrap();
        worst.compare("quantile, NumPy", found, &row[1]);
    }
    for row in peers["wilson"].as_array().unwrap() {
        let [successes, runs] = [0, 1].map(|at| row[at].as_f64().unwrap());
        let interval = power::wilson(successes / runs, runs);
        worst.compare("Wilson, SciPy", interval.lower, &row[2]);
        worst.compare("Wilson, SciPy", interval.upper, &row[3]);
    }
    worst.report();
}
