//! Why a question cannot be answered.

/// Input that cannot be used, or a question that it cannot answer; its text is one sentence for the user.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AnalysisError {
    #[error("{what}: at least {needed} are needed, and there are {found}")]
    TooFew { what: &'static str, needed: usize, found: usize },
    #[error("{what}: at most {most} can be handled, and there are {found}")]
    TooMany { what: &'static str, most: usize, found: usize },
    #[error("value {position} of {what} is not a number that can be used (finite, and smaller than 1e150)")]
    NotFinite { what: String, position: usize },
    #[error("{what} must be as many as {with}: {found} and {expected}")]
    UnequalLengths { what: String, with: &'static str, found: usize, expected: usize },
    #[error("{what} must be {range}, not {value}")]
    OutOfRange { what: &'static str, range: &'static str, value: f64 },
    #[error("{what} are all the same, so there is no variation to judge by")]
    NoVariation { what: &'static str },
    #[error("there is no condition called '{name}'")]
    UnknownCondition { name: String },
    #[error("the column '{column}' follows from the columns before it, so its effect cannot be told from theirs")]
    DependentColumn { column: String },
    #[error("the variances cannot be estimated: {why}")]
    NotEstimable { why: &'static str },
    #[error("the power is {power:.3} with {largest} participants, the most that were allowed, and not {wanted:.3}")]
    NotReached { wanted: f64, power: f64, largest: usize },
}

/// What every function here returns.
pub(crate) type Result<T> = std::result::Result<T, AnalysisError>;
