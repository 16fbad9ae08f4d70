//! The pages of user studies.

pub(super) mod questionnaires;
pub(super) mod studies;
pub(super) mod study_form;
