# Expected numbers of R: reads the data sets of analysis.py, and writes the results of R. `Rscript analysis.R DATA OUT`
suppressMessages({library(jsonlite); library(lmerTest); library(coin)})
arguments <- commandArgs(trailingOnly = TRUE)
sets <- fromJSON(arguments[1], simplifyVector = TRUE, simplifyDataFrame = FALSE, simplifyMatrix = TRUE)

# Tighter than lme4's own limits, so that its digits can be compared.
control <- lmerControl(optimizer = "nloptwrap", optCtrl = list(algorithm = "NLOPT_LN_BOBYQA", xtol_abs = 1e-13, xtol_rel = 1e-13, ftol_abs = 1e-15, ftol_rel = 1e-15, maxeval = 10000),
                       check.conv.singular = "ignore", check.conv.grad = "ignore", calc.derivs = FALSE)

signed_rank <- function(set) {
  d <- set$differences
  exact <- function(zeros) as.numeric(pvalue(wilcoxsign_test(d ~ rep(0, length(d)), zero.method = zeros, distribution = "exact")))
  normal <- suppressWarnings(wilcox.test(d, exact = FALSE, correct = TRUE))
  out <- list(v = unname(normal$statistic), normal = normal$p.value, t = unlist(t.test(d)[c("statistic", "p.value", "conf.int")]))
  if (length(d) <= 50) { out$exact <- exact("Wilcoxon"); out$pratt <- exact("Pratt") }
  if (!any(duplicated(abs(d))) && !any(d == 0) && length(d) <= 50) {
    r <- suppressWarnings(wilcox.test(d, exact = TRUE, conf.int = TRUE))
    n <- length(d)
    # The attained confidence, which R itself reports only if it is far off.
    out$location <- c(r$estimate, r$conf.int[1:2], 1 - 2 * psignrank(max(qsignrank(0.025, n), 1) - 1, n))
  }
  out
}

mann_whitney <- function(set) {
  a <- set$first; b <- set$second
  normal <- suppressWarnings(wilcox.test(a, b, exact = FALSE, correct = TRUE))
  frame <- data.frame(y = c(a, b), g = factor(rep(1:2, c(length(a), length(b)))))
  out <- list(w = unname(normal$statistic), normal = normal$p.value)
  if (max(length(a), length(b)) <= 50) out$exact <- as.numeric(pvalue(wilcox_test(y ~ g, frame, distribution = "exact")))
  if (!any(duplicated(c(a, b))) && max(length(a), length(b)) <= 50) {
    r <- suppressWarnings(wilcox.test(a, b, exact = TRUE, conf.int = TRUE))
    m <- length(a); n <- length(b)
    out$shift <- c(r$estimate, r$conf.int[1:2], 1 - 2 * pwilcox(max(qwilcox(0.025, m, n), 1) - 1, m, n))
  }
  out
}

friedman <- function(set) {
  r <- friedman.test(set$rows)
  list(chi_square = unname(r$statistic), p = r$p.value)
}

mixed <- function(set) {
  frame <- data.frame(y = set$response, participant = set$participant, condition = relevel(factor(set$condition), set$reference))
  right <- c("condition", names(set$covariates), "(1 | participant)")
  for (name in names(set$covariates)) frame[[name]] <- set$covariates[[name]]
  formula <- as.formula(paste("y ~", paste(right, collapse = " + ")))
  one <- function(reml) {
    fit <- lmer(formula, frame, REML = reml, control = control)
    table <- coef(summary(fit))
    half <- qt(0.975, table[, "df"]) * table[, "Std. Error"]
    variances <- as.data.frame(VarCorr(fit))$vcov
    count <- nlevels(frame$condition) - 1
    joint <- contestMD(fit, diag(nrow(table))[2:(count + 1), , drop = FALSE])
    list(estimate = table[, 1], error = table[, 2], df = table[, 3], t = table[, 4], p = table[, 5], lower = table[, 1] - half, upper = table[, 1] + half,
         variances = variances, log_likelihood = as.numeric(logLik(fit)), joint = unlist(joint[c("F value", "NumDF", "DenDF", "Pr(>F)")]),
         intercepts = ranef(fit)$participant[, 1])
  }
  list(reml = one(TRUE), ml = one(FALSE))
}

kinds <- list(signed_rank = signed_rank, mann_whitney = mann_whitney, friedman = friedman, mixed = mixed)
out <- lapply(sets, function(set) if (set$kind %in% names(kinds)) lapply(kinds[[set$kind]](set), function(x) if (is.list(x)) lapply(x, unname) else unname(x)) else NULL)
versions <- c(R = paste(R.version$major, R.version$minor, sep = "."), sapply(c("lme4", "lmerTest", "coin"), function(name) as.character(packageVersion(name))))
write(toJSON(list(versions = as.list(versions), sets = out), digits = NA, auto_unbox = TRUE, null = "null"), arguments[2])
