//! Reasons why an analysis is impossible.

/// Unusable input, or a question that the input cannot answer. The text is one sentence for the user.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    #[error("{what}: {found} are too few; provide at least {needed}")]
    TooFew { what: &'static str, needed: usize, found: usize },
    #[error("{what}: {found} are too many; provide at most {max}")]
    TooMany { what: &'static str, max: usize, found: usize },
    #[error("value {position} of {what} is not a usable number (finite, and smaller than 1e150); correct it")]
    NotFinite { what: String, position: usize },
    #[error("{what} and {with} differ in number: {found} instead of {expected}; provide the same number of both")]
    UnequalLengths { what: String, with: &'static str, found: usize, expected: usize },
    #[error("{what} must be {range}, not {value}")]
    OutOfRange { what: &'static str, range: &'static str, value: f64 },
    #[error("{what} are all the same, so there is no variation to judge by; provide values that differ")]
    NoVariation { what: &'static str },
    #[error("there is no condition called '{name}'")]
    UnknownCondition { name: String },
    #[error(
        "the column '{column}' is a combination of earlier columns, so its effect cannot be separated from theirs; leave it out"
    )]
    DependentColumn { column: String },
    #[error("the variances cannot be estimated: {why}")]
    NotEstimable { why: &'static str },
    #[error(
        "the power is {power:.3} with the maximum of {largest} participants, below the requested {wanted:.3}; allow more participants"
    )]
    NotReached { wanted: f64, power: f64, largest: usize },
}

pub(crate) type Result<T> = std::result::Result<T, AnalysisError>;
