//! Questionnaires and their published scores.
//!
//! - **NASA-TLX**: six ratings from 0 to 100 in steps of 5. Raw: their mean (Hart 2006, NASA-Task Load Index; 20 years
//!   later, Proc. HFES 50:904-908). Weighted: in each of the 15 pairs of scales the one that contributed more to the
//!   workload is chosen; the weight of a scale is the number of times it was chosen, and the score is the sum of weight
//!   times rating over 15 (Hart and Staveland 1988, Advances in Psychology 52:139-183).
//! - **SUS**: ten items from 1 to 5; odd ones count their value minus 1, even ones 5 minus their value, and the sum is
//!   multiplied by 2.5 (Brooke 1996, SUS: a quick and dirty usability scale, in Usability Evaluation in Industry,
//!   189-194).
//! - **Realism**: our own item from 1 to 7, without a published scale.
//! - **Free text**: stored, not scored.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Questionnaire {
    /// NASA-TLX without weights (raw TLX).
    NasaTlx,
    /// NASA-TLX with the comparison of 15 pairs; it also gives the raw score.
    NasaTlxWeighted,
    /// System usability scale.
    Sus,
    /// Perceived realism.
    Realism,
    /// Remarks.
    FreeText,
}

impl Questionnaire {
    pub const ALL: [Self; 5] = [Self::NasaTlx, Self::NasaTlxWeighted, Self::Sus, Self::Realism, Self::FreeText];

    pub const fn name(self) -> &'static str {
        match self {
            Self::NasaTlx => "nasa_tlx",
            Self::NasaTlxWeighted => "nasa_tlx_weighted",
            Self::Sus => "sus",
            Self::Realism => "realism",
            Self::FreeText => "free_text",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TlxScale {
    Mental,
    Physical,
    Temporal,
    /// 0 is perfect, 100 is failure.
    Performance,
    Effort,
    Frustration,
}

/// The scales in the order of the form, each with its question (after Hart and Staveland 1988).
pub const TLX_SCALES: [(TlxScale, &str, &str); 6] = [
    (TlxScale::Mental, "mental", "How mentally demanding was the task? (0 very low, 100 very high)"),
    (TlxScale::Physical, "physical", "How physically demanding was the task? (0 very low, 100 very high)"),
    (TlxScale::Temporal, "temporal", "How hurried or rushed was the pace of the task? (0 very low, 100 very high)"),
    (
        TlxScale::Performance,
        "performance",
        "How successful were you in accomplishing what you were asked to do? (0 perfect, 100 failure)",
    ),
    (
        TlxScale::Effort,
        "effort",
        "How hard did you have to work to accomplish your level of performance? (0 very low, 100 very high)",
    ),
    (
        TlxScale::Frustration,
        "frustration",
        "How insecure, discouraged, irritated, stressed and annoyed were you? (0 very low, 100 very high)",
    ),
];

/// Every pair of scales, in the order in which they are compared.
pub const PAIRS: [(TlxScale, TlxScale); 15] = {
    let mut pairs = [(TlxScale::Mental, TlxScale::Mental); 15];
    let mut at = 0;
    let mut one = 0;
    while one < 6 {
        let mut other = one + 1;
        while other < 6 {
            pairs[at] = (TLX_SCALES[one].0, TLX_SCALES[other].0);
            at += 1;
            other += 1;
        }
        one += 1;
    }
    pairs
};

/// The statements of the SUS (Brooke 1996), from 1, strongly disagree, to 5, strongly agree.
pub const SUS_ITEMS: [&str; 10] = [
    "I think that I would like to use this system frequently",
    "I found the system unnecessarily complex",
    "I thought the system was easy to use",
    "I think that I would need the support of a technical person to be able to use this system",
    "I found the various functions in this system were well integrated",
    "I thought there was too much inconsistency in this system",
    "I would imagine that most people would learn to use this system very quickly",
    "I found the system very cumbersome to use",
    "I felt very confident using the system",
    "I needed to learn a lot of things before I could get going with this system",
];

/// The question of [`Questionnaire::Realism`].
pub const REALISM_ITEM: &str = "How real did touching and holding feel? (1 not at all, 7 like the real thing)";

/// Returns the mean of the six ratings, 0 to 100.
pub fn raw_tlx(ratings: &[u8; 6]) -> f64 {
    ratings.iter().map(|rating| f64::from(*rating)).sum::<f64>() / 6.0
}

/// Returns the sum of weight times rating over 15; the weight is how often the scale was `chosen` from the [`PAIRS`].
///
/// ```
/// use nima_user_study::{PAIRS, weighted_tlx};
///
/// // Choosing the first of each pair gives the weights 5, 4, 3, 2, 1, 0.
/// let chosen = PAIRS.map(|(first, _)| first);
/// assert_eq!(weighted_tlx(&[60, 30, 45, 30, 15, 100], &chosen), (300 + 120 + 135 + 60 + 15) as f64 / 15.0);
/// ```
pub fn weighted_tlx(ratings: &[u8; 6], chosen: &[TlxScale; 15]) -> f64 {
    let weight = |scale: TlxScale| chosen.iter().filter(|one| **one == scale).count() as f64;
    let sum: f64 =
        TLX_SCALES.iter().zip(ratings).map(|((scale, ..), rating)| weight(*scale) * f64::from(*rating)).sum();
    sum / 15.0
}

/// Returns the score of the SUS, 0 to 100, from ten answers of 1 to 5.
///
/// ```
/// // The example of Brooke 1996, whose sum is 22.
/// assert_eq!(nima_user_study::of_sus(&[5, 4, 2, 1, 2, 3, 2, 4, 5, 2]), 55.0);
/// ```
pub fn of_sus(items: &[u8; 10]) -> f64 {
    let counted = items.iter().enumerate().map(|(at, answer)| {
        let answer = f64::from(*answer);
        if at % 2 == 0 { answer - 1.0 } else { 5.0 - answer }
    });
    2.5 * counted.sum::<f64>()
}
