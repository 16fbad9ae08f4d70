"""Expected numbers for `src/extras/analysis`: `python analysis.py` writes src/extras/analysis/tests/peers.json and prints the versions.

Needs scipy, statsmodels and `Rscript` with lme4, lmerTest, coin and jsonlite (Debian: r-base-core r-cran-lmertest r-cran-coin r-cran-jsonlite).
The data are made here from seeds and rounded, so that they are the same wherever they are read.
"""

import itertools
import json
import math
import pathlib
import subprocess
import tempfile
import warnings

import numpy as np
import scipy
import statsmodels
import statsmodels.formula.api as smf
from scipy import stats
from statsmodels.stats.multitest import multipletests

HERE = pathlib.Path(__file__).parent
OUT = HERE.parent.parent / "src" / "analysis" / "tests" / "peers.json"
MASK = 2**64 - 1


class WyRand(np.random.Generator):
    """Draws the indices that the crate's generator (fastrand 2) draws, so that SciPy's bootstrap sees the same samples."""

    def __init__(self, seed):
        super().__init__(np.random.PCG64(0))
        self.state = seed

    def word(self):
        self.state = (self.state + 0x2D358DCCAA6C78A5) & MASK
        product = self.state * (self.state ^ 0x8BB84B93962EACC9)
        return (product & MASK) ^ (product >> 64)

    def below(self, n):
        product = self.word() * n
        if product & MASK < n:
            while product & MASK < -n % 2**64 % n:
                product = self.word() * n
        return product >> 64

    def integers(self, low, high=None, size=None, dtype=np.int64, endpoint=False):
        assert low == 0 and not endpoint
        return np.array([self.below(high) for _ in range(math.prod(size))]).reshape(size)


def differences(rng, n, step, shift=0.3):
    """Rounded to `step`: with a large step there are ties and zeros."""
    return [round(round(value / step) * step, 6) for value in rng.normal(shift, 1.0, n)]


def signed_rank_sets():
    rng = np.random.default_rng(1)
    for n, step in [(5, 1e-3), (8, 1e-3), (12, 1e-3), (20, 1e-3), (45, 1e-4), (6, 0.5), (10, 0.5), (12, 0.25), (25, 0.5), (50, 0.1), (60, 0.5), (80, 1e-4)]:
        yield {"kind": "signed_rank", "differences": differences(rng, n, step)}


def mann_whitney_sets():
    rng = np.random.default_rng(2)
    for m, n, step in [(3, 4, 1e-3), (7, 5, 1e-3), (12, 15, 1e-3), (1, 6, 1e-3), (6, 6, 0.5), (9, 14, 0.5), (20, 11, 0.25), (60, 40, 0.5), (55, 70, 1e-4)]:
        yield {"kind": "mann_whitney", "first": differences(rng, m, step, 0.5), "second": differences(rng, n, step, 0.0)}


def friedman_sets():
    rng = np.random.default_rng(3)
    for n, k, step in [(4, 3, 1e-3), (10, 4, 1e-3), (8, 3, 0.5), (15, 5, 0.5), (6, 3, 1.0)]:
        yield {"kind": "friedman", "rows": [differences(rng, k, step, 0.0) for _ in range(n)]}


def mixed_set(rng, participants, conditions, trials, between, missing=0.0, covariates=(), scale=1.0):
    rows = []
    for p in range(participants):
        intercept = rng.normal(0, between)
        order = rng.permutation(conditions)
        for place, c in enumerate(order):
            for trial in range(trials):
                if rng.random() >= missing:
                    response = scale * round(2 + intercept + 0.4 * c + 0.05 * trial - 0.1 * place + rng.normal(), 4)
                    rows.append((f"p{p:02}", f"c{c}", response, {"trial": float(trial + 1), "place": float(place + 1)}))
    return {
        "kind": "mixed",
        "participant": [row[0] for row in rows],
        "condition": [row[1] for row in rows],
        "reference": "c1" if conditions > 2 else "c0",
        "response": [row[2] for row in rows],
        "covariates": {name: [row[3][name] for row in rows] for name in covariates},
    }


def mixed_sets():
    rng = np.random.default_rng(4)
    yield mixed_set(rng, 8, 2, 1, 1.0)
    yield mixed_set(rng, 10, 3, 1, 1.5)
    yield mixed_set(rng, 12, 3, 4, 0.8)
    yield mixed_set(rng, 6, 2, 3, 0.02)
    yield mixed_set(rng, 9, 4, 3, 1.0, missing=0.25, covariates=["trial"])
    yield mixed_set(rng, 12, 3, 5, 0.6, missing=0.4, covariates=["trial", "place"])
    yield mixed_set(rng, 5, 2, 2, 3.0, missing=0.1, scale=1000.0)
    yield mixed_set(rng, 16, 3, 2, 20.0, missing=0.2, covariates=["place"])
    yield mixed_set(rng, 20, 2, 6, 0.3, missing=0.5, covariates=["trial"])
    # At the edge: no variance of participants is found.
    for seed in [1, 3]:
        yield mixed_set(np.random.default_rng(seed), 7, 3, 2, 0.0, missing=0.2, covariates=["trial"])


def bootstrap_sets():
    rng = np.random.default_rng(5)
    for n, step in [(6, 1e-3), (11, 1e-3), (20, 0.25), (9, 0.5)]:
        yield {"kind": "bootstrap", "sample": [round(math.exp(value), 4) for value in differences(rng, n, step)], "seed": n, "resamples": 999}


def effect_sets():
    rng = np.random.default_rng(6)
    for m, n, step in [(5, 5, 1e-3), (8, 12, 0.5), (20, 7, 0.25)]:
        yield {"kind": "effect", "first": differences(rng, m, step, 0.6), "second": differences(rng, n, step, 0.0)}


def scipy_signed_rank(set):
    d = np.array(set["differences"])
    out = {}
    for rule in ["wilcox", "pratt"]:
        out[f"normal_{rule}"] = stats.wilcoxon(d, zero_method=rule, method="asymptotic", correction=True).pvalue
        if len(d) <= 12:
            out[f"exact_{rule}"] = stats.wilcoxon(d, zero_method=rule, method=stats.PermutationMethod(n_resamples=2**13)).pvalue
    if len(set_of(d)) == len(d) and 0 not in d and len(d) <= 50:
        out["exact_wilcox"] = stats.wilcoxon(d, method="exact").pvalue
    ranks = stats.rankdata(abs(d[d != 0]))
    out["rank_biserial"] = float((ranks * np.sign(d[d != 0])).sum() / ranks.sum())
    # The interval from its definition, with SciPy's distribution where there is one, and the large-sample formula above 50.
    n = len(d)
    averages = sorted((d[i] + d[j]) / 2 for i in range(n) for j in range(i, n))
    if n > 50:
        k = max(1, int(n * (n + 1) / 4 - stats.norm.ppf(0.975) * math.sqrt(n * (n + 1) * (2 * n + 1) / 24)))
    else:
        masses = [1]
        for rank in range(1, n + 1):
            masses = [a + b for a, b in zip(masses + [0] * rank, [0] * rank + masses)]
        below = list(itertools.accumulate(masses))
        k = max(1, next(s for s, count in enumerate(below) if count * 40 >= 2**n))
    out["location"] = [float(np.median(averages)), averages[k - 1], averages[-k]]
    return out


def set_of(d):
    return set(abs(np.asarray(d)))


def scipy_mann_whitney(set):
    a, b = np.array(set["first"]), np.array(set["second"])
    out = {"normal": stats.mannwhitneyu(a, b, method="asymptotic").pvalue, "shift": float(np.median([x - y for x in a for y in b]))}
    if len(np.unique(np.concatenate([a, b]))) == len(a) + len(b) and max(len(a), len(b)) <= 50:
        out["exact"] = stats.mannwhitneyu(a, b, method="exact").pvalue
    return out


def scipy_friedman(set):
    rows = np.array(set["rows"])
    n, k = rows.shape
    chi, p = stats.friedmanchisquare(*rows.T)
    f = (n - 1) * chi / (n * (k - 1) - chi)
    return {"chi_square": chi, "p": p, "f": f, "f_p": stats.f.sf(f, k - 1, (k - 1) * (n - 1)), "w": chi / (n * (k - 1))}


def statsmodels_mixed(set):
    """Estimates, variances and likelihood. It has no degrees of freedom, and takes standard errors from another information matrix."""
    import pandas

    frame = pandas.DataFrame({"y": set["response"], "participant": set["participant"], "condition": set["condition"], **set["covariates"]})
    formula = " + ".join([f"y ~ C(condition, Treatment('{set['reference']}'))", *set["covariates"]])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fit = smf.mixedlm(formula, frame, groups=frame["participant"]).fit(reml=True, method=["bfgs", "powell"], gtol=1e-10)
    return {"estimate": fit.fe_params.tolist(), "variances": [float(fit.cov_re.iloc[0, 0]), float(fit.scale)], "log_likelihood": float(fit.llf)}


def rounded_mean(sample, axis=-1):
    """A permuted sample has the same mean, also in its last bit: SciPy's BCa counts how many are equal."""
    return np.round(np.mean(sample, axis=axis), 12)


def scipy_bootstrap(set):
    out = {}
    for name, statistic in [("mean", rounded_mean), ("median", np.median)]:
        for method in ["percentile", "BCa"]:
            result = stats.bootstrap(
                (set["sample"],), statistic, n_resamples=set["resamples"], method=method, rng=WyRand(set["seed"]), vectorized=True, batch=set["resamples"]
            )
            out[f"{name}_{method}"] = list(result.confidence_interval)
    return out


def numpy_effect(set):
    a, b = np.array(set["first"]), np.array(set["second"])
    exact = lambda df: math.gamma(df / 2) / (math.sqrt(df / 2) * math.gamma((df - 1) / 2))
    pooled = math.sqrt(((len(a) - 1) * a.var(ddof=1) + (len(b) - 1) * b.var(ddof=1)) / (len(a) + len(b) - 2))
    d, dz = (a.mean() - b.mean()) / pooled, a.mean() / a.std(ddof=1)
    delta = float(np.sign(a[:, None] - b[None, :]).mean())
    # The estimator that SciPy's U gives by itself.
    u = stats.mannwhitneyu(a, b, method="asymptotic").statistic / (len(a) * len(b))
    return {"d": d, "g": d * exact(len(a) + len(b) - 2), "dz": dz, "gz": dz * exact(len(a) - 1), "cliff": delta, "a": float(u)}


def distributions():
    """Tails and quantiles far out and with few or many degrees of freedom."""
    t = [[t, df, 2 * stats.t.sf(t, df)] for t in [1e-4, 0.3, 2.0, 8.0, 40.0] for df in [0.7, 1, 2.5, 9, 60, 5000, 9900, 11000, 1e6]]
    q = [[c, df, stats.t.ppf((1 + c) / 2, df)] for c in [0.01, 0.5, 0.9, 0.95, 0.999] for df in [0.7, 1, 2.5, 9, 60, 5000, 9900, 11000, 1e6]]
    f = [[f, a, b, stats.f.sf(f, a, b)] for f in [1e-3, 0.8, 3.0, 30.0] for a in [1, 2, 7] for b in [2, 6.3, 40, 2000, 1e6]]
    x = [[x, df, stats.chi2.sf(x, df)] for x in [1e-3, 0.8, 6.0, 50.0] for df in [1, 2, 5, 30]]
    z = [[z, 2 * stats.norm.sf(z), stats.norm.ppf(stats.norm.cdf(-z))] for z in [1e-3, 0.4, 1.96, 5.0, 9.0]]
    return {"t": t, "t_critical": q, "f": f, "chi_square": x, "normal": z}


def corrections():
    p = [0.011, 0.02, 0.04, 0.012, 0.7, 0.012]
    return {"p": p, "holm": multipletests(p, method="holm")[1].tolist(), "bonferroni": multipletests(p, method="bonferroni")[1].tolist()}


PYTHON = {
    "signed_rank": scipy_signed_rank,
    "mann_whitney": scipy_mann_whitney,
    "friedman": scipy_friedman,
    "mixed": statsmodels_mixed,
    "bootstrap": scipy_bootstrap,
    "effect": numpy_effect,
}


def main():
    makers = [signed_rank_sets, mann_whitney_sets, friedman_sets, mixed_sets, bootstrap_sets, effect_sets]
    sets = [one for make in makers for one in make()]
    with tempfile.TemporaryDirectory() as folder:
        data, answers = pathlib.Path(folder) / "data.json", pathlib.Path(folder) / "answers.json"
        data.write_text(json.dumps(sets))
        subprocess.run(["Rscript", HERE / "analysis.R", data, answers], check=True)
        r = json.loads(answers.read_text())
    versions = {"scipy": scipy.__version__, "statsmodels": statsmodels.__version__, **r["versions"]}
    for one, of_r in zip(sets, r["sets"]):
        one["python"] = PYTHON[one["kind"]](one)
        if of_r:
            one["r"] = of_r
    wilson = [[k, n, *stats.binomtest(k, n).proportion_ci(method="wilson")] for k, n in [(0, 50), (47, 50), (802, 1000)]]
    quantiles = [[q, float(np.quantile([3.0, 1.0, 4.0, 1.5, 9.0, 2.6], q))] for q in [0.0, 0.1, 0.25, 0.5, 0.77, 1.0]]
    whole = {"versions": versions, "distributions": distributions(), "corrections": corrections(), "wilson": wilson, "quantiles": quantiles}
    lines = ",\n".join(json.dumps(one) for one in sets)
    head = ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in whole.items())
    OUT.write_text("{\n" + head + ',\n"sets": [\n' + lines + "\n]\n}\n")
    print(versions)
    print(f"{len(sets)} data sets, {OUT.stat().st_size // 1024} KB")


if __name__ == "__main__":
    main()
