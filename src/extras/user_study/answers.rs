//! Answers of a participant.

use serde::{Deserialize, Serialize};

use crate::{
    PAIRS, Questionnaire, TLX_SCALES, TlxScale,
    questionnaire::{of_sus, raw_tlx, weighted_tlx},
};

/// Maximum number of characters of a remark.
const TEXT_MAX: usize = 4000;

/// The answers to one questionnaire.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QuestionnaireAnswers {
    /// Six ratings, 0 to 100 in steps of 5.
    NasaTlx(Ratings),
    /// Six ratings, and the scale chosen from each of the [`PAIRS`].
    NasaTlxWeighted {
        #[serde(flatten)]
        ratings: Ratings,
        /// For each pair, the scale that contributed more.
        chosen: [TlxScale; 15],
    },
    /// Ten answers of 1 to 5.
    Sus([u8; 10]),
    /// 1 to 7.
    Realism(u8),
    FreeText(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ratings {
    pub mental: u8,
    pub physical: u8,
    pub temporal: u8,
    pub performance: u8,
    pub effort: u8,
    pub frustration: u8,
}

impl Ratings {
    /// Returns the values in the order of [`TLX_SCALES`].
    pub const fn all(self) -> [u8; 6] {
        let Self { mental, physical, temporal, performance, effort, frustration } = self;
        [mental, physical, temporal, performance, effort, frustration]
    }

    /// Creates the ratings from values in the order of [`TLX_SCALES`].
    pub const fn of([mental, physical, temporal, performance, effort, frustration]: [u8; 6]) -> Self {
        Self { mental, physical, temporal, performance, effort, frustration }
    }
}

/// A file of answers, which may contain those to several questionnaires.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnswerFile {
    nasa_tlx: Option<Ratings>,
    nasa_tlx_weighted: Option<WeightedAnswers>,
    sus: Option<[u8; 10]>,
    realism: Option<u8>,
    free_text: Option<String>,
}

#[derive(Deserialize)]
struct WeightedAnswers {
    #[serde(flatten)]
    ratings: Ratings,
    chosen: [TlxScale; 15],
}

impl QuestionnaireAnswers {
    /// Parses the answers to this questionnaire from a text (TOML), `realism = 5`.
    ///
    /// # Errors
    /// Missing or wrong answers.
    ///
    /// ```
    /// use nima_user_study::{QuestionnaireAnswers, Questionnaire};
    ///
    /// assert_eq!(QuestionnaireAnswers::from_toml("realism = 5", Questionnaire::Realism), Ok(QuestionnaireAnswers::Realism(5)));
    /// assert!(QuestionnaireAnswers::from_toml("realism = 8", Questionnaire::Realism).is_err());
    /// assert!(QuestionnaireAnswers::from_toml("realism = 5", Questionnaire::Sus).is_err());
    /// ```
    pub fn from_toml(text: &str, asked: Questionnaire) -> Result<Self, String> {
        let file: AnswerFile = nima_files::from_toml(text)
            .map_err(|misfit| format!("the answers cannot be read: {}", misfit.message()))?;
        let AnswerFile { nasa_tlx, nasa_tlx_weighted, sus, realism, free_text } = file;
        let answers = match asked {
            Questionnaire::NasaTlx => nasa_tlx.map(Self::NasaTlx),
            Questionnaire::NasaTlxWeighted => {
                nasa_tlx_weighted.map(|WeightedAnswers { ratings, chosen }| Self::NasaTlxWeighted { ratings, chosen })
            }
            Questionnaire::Sus => sus.map(Self::Sus),
            Questionnaire::Realism => realism.map(Self::Realism),
            Questionnaire::FreeText => free_text.map(Self::FreeText),
        };
        let answers = answers.ok_or_else(|| format!("the answers to {} are missing: {}", asked.name(), form(asked)))?;
        answers.check().map(|()| answers)
    }

    /// Returns the questionnaire that they belong to.
    pub const fn questionnaire(&self) -> Questionnaire {
        match self {
            Self::NasaTlx(_) => Questionnaire::NasaTlx,
            Self::NasaTlxWeighted { .. } => Questionnaire::NasaTlxWeighted,
            Self::Sus(_) => Questionnaire::Sus,
            Self::Realism(_) => Questionnaire::Realism,
            Self::FreeText(_) => Questionnaire::FreeText,
        }
    }

    /// Checks that the form allows every answer.
    ///
    /// # Errors
    /// The answer that is not allowed.
    pub fn check(&self) -> Result<(), String> {
        let on_scale = |ratings: Ratings| {
            let wrong = TLX_SCALES.iter().zip(ratings.all()).find(|(_, rating)| *rating > 100 || rating % 5 != 0);
            wrong.map_or(Ok(()), |((_, name, _), rating)| {
                Err(format!("{name} = {rating}: it must be from 0 to 100 in steps of 5"))
            })
        };
        match self {
            Self::NasaTlx(ratings) => on_scale(*ratings),
            Self::NasaTlxWeighted { ratings, chosen } => {
                on_scale(*ratings)?;
                let wrong =
                    PAIRS.iter().zip(chosen).position(|((one, other), chosen)| chosen != one && chosen != other);
                wrong.map_or(Ok(()), |at| Err(format!("chosen: number {} is not a scale of its pair", at + 1)))
            }
            Self::Sus(items) => {
                let wrong = items.iter().position(|answer| !(1..=5).contains(answer));
                wrong.map_or(Ok(()), |at| {
                    Err(format!("sus: answer {} is {}: it must be from 1 to 5", at + 1, items[at]))
                })
            }
            Self::Realism(answer) if !(1..=7).contains(answer) => {
                Err(format!("realism = {answer}: it must be from 1 to 7"))
            }
            Self::FreeText(text) if text.chars().count() > TEXT_MAX => {
                Err(format!("free_text has more than {TEXT_MAX} characters"))
            }
            Self::Realism(_) | Self::FreeText(_) => Ok(()),
        }
    }

    /// Returns the scores, each with the name of its column.
    pub fn scores(&self) -> Vec<(&'static str, f64)> {
        let ratings = |ratings: &Ratings| {
            let names =
                ["tlx_mental", "tlx_physical", "tlx_temporal", "tlx_performance", "tlx_effort", "tlx_frustration"];
            let raw = ("nasa_tlx_raw", raw_tlx(&ratings.all()));
            std::iter::once(raw).chain(names.into_iter().zip(ratings.all().map(f64::from))).collect::<Vec<_>>()
        };
        match self {
            Self::NasaTlx(of) => ratings(of),
            Self::NasaTlxWeighted { ratings: of, chosen } => {
                let weighted = ("nasa_tlx_weighted", weighted_tlx(&of.all(), chosen));
                std::iter::once(weighted).chain(ratings(of)).collect()
            }
            Self::Sus(items) => vec![("sus", of_sus(items))],
            Self::Realism(answer) => vec![("realism", f64::from(*answer))],
            Self::FreeText(_) => Vec::new(),
        }
    }
}

/// Returns the format of the answers.
const fn form(asked: Questionnaire) -> &'static str {
    match asked {
        Questionnaire::NasaTlx => {
            "write nasa_tlx = { mental = 50, physical = 50, temporal = 50, performance = 50, effort = 50, frustration = 50 }"
        }
        Questionnaire::NasaTlxWeighted => {
            "write a table [nasa_tlx_weighted] with the six ratings and chosen = [\"mental\", ...], the scale chosen of each of the 15 pairs"
        }
        Questionnaire::Sus => "write sus = [3, 3, 3, 3, 3, 3, 3, 3, 3, 3]",
        Questionnaire::Realism => "write realism = 4",
        Questionnaire::FreeText => "write free_text = \"...\"",
    }
}
