//! Differences between the frame calibrations: settings, texts, instructions.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_core::calibration::{
    frames::{
        FrameSample, FrameSession, HandEyeSettings, SensorMount, TableSettings, TipSettings, TrocarSettings,
        ViewSettings,
    },
    gravity::PoseTarget,
};
use nima_machine::rig::Prompt;
use nima_words::text::frames as texts;

use super::{FrameSubject, job::FrameJob};

/// The frame calibrations, in the order of use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum FrameKind {
    /// Mount of the wrist sensor on the flange.
    Mount,
    /// Position of the instrument's tip.
    Tip,
    /// Pose of the marker on the instrument, and of the tracker relative to the arm.
    HandEye,
    /// Origin and plane of the workspace.
    Table,
    /// Rotation of the endoscope image relative to arm and handle.
    View,
    /// The remote centre of motion.
    Trocar,
}

#[derive(Clone, Copy, Debug)]
pub struct Texts {
    /// Instruction before the recording, which starts with the next step.
    pub before: &'static str,
    /// Instruction during the recording.
    pub task: &'static str,
    /// Name of the recorded items.
    pub units: &'static str,
    /// Alternative method, and its meaning.
    pub other_way: Option<[&'static str; 2]>,
}

impl FrameKind {
    /// All kinds, in the order of use.
    pub const ALL: [Self; 6] = [Self::Mount, Self::Tip, Self::HandEye, Self::Table, Self::View, Self::Trocar];

    pub fn name(self) -> &'static str {
        match self {
            Self::Mount => texts::MOUNT.get(),
            Self::Tip => texts::TIP.get(),
            Self::HandEye => texts::HAND_EYE.get(),
            Self::Table => texts::TABLE.get(),
            Self::View => texts::VIEW.get(),
            Self::Trocar => texts::TROCAR.get(),
        }
    }

    pub fn meaning(self) -> &'static str {
        match self {
            Self::Mount => texts::MOUNT_MEANING.get(),
            Self::Tip => texts::TIP_MEANING.get(),
            Self::HandEye => texts::HAND_EYE_MEANING.get(),
            Self::Table => texts::TABLE_MEANING.get(),
            Self::View => texts::VIEW_MEANING.get(),
            Self::Trocar => texts::TROCAR_MEANING.get(),
        }
    }

    pub fn texts(self, other_way: bool) -> Texts {
        let by_tracker = Some([texts::BY_TRACKER.get(), texts::BY_TRACKER_HOVER.get()]);
        let by_handle = Some([texts::BY_HANDLE.get(), texts::BY_HANDLE_HOVER.get()]);
        let (before, task, units, other) = match self {
            Self::Mount => (texts::MOUNT_BEFORE.get(), texts::MOUNT_TASK.get(), texts::POSES.get(), None),
            Self::Tip => (texts::TIP_BEFORE.get(), texts::TIP_TASK.get(), texts::POSES.get(), by_tracker),
            Self::HandEye => (texts::HAND_EYE_BEFORE.get(), texts::HAND_EYE_TASK.get(), texts::POSES.get(), None),
            Self::Table => (texts::TABLE_BEFORE.get(), texts::TABLE_TASK.get(), texts::POINTS.get(), None),
            Self::View if other_way => {
                (texts::VIEW_HANDLE_BEFORE.get(), texts::VIEW_HANDLE_TASK.get(), texts::PLACES.get(), by_handle)
            }
            Self::View => (texts::VIEW_BEFORE.get(), texts::VIEW_TASK.get(), texts::PLACES.get(), by_handle),
            Self::Trocar => (texts::TROCAR_BEFORE.get(), texts::TROCAR_TASK.get(), texts::LINES.get(), by_tracker),
        };
        Texts { before, task, units, other_way: other }
    }

    /// Checks whether the alternative method is available on this rig; the error is the reason.
    pub fn other_way_needs(self, subject: &FrameSubject) -> Result<(), &'static str> {
        match self {
            Self::Tip | Self::Trocar if subject.hand_eye().is_none() => Err(texts::NEEDS_HAND_EYE.get()),
            _ => Ok(()),
        }
    }

    /// Returns a session without poses; `other_way`: by the tracker, or with the handle.
    pub fn job(self, subject: &FrameSubject, other_way: bool) -> Option<Box<dyn FrameJob>> {
        let tip_m = subject.tip_in_flange_m();
        Some(match self {
            Self::Tip if other_way => Box::new(FrameSession::new(TipSettings::by_tracker())),
            Self::Tip => Box::new(FrameSession::new(TipSettings::by_arm())),
            Self::HandEye => Box::new(FrameSession::new(HandEyeSettings::new(tip_m))),
            Self::Trocar if other_way => {
                let [flange_from_m, _] = subject.hand_eye()?;
                Box::new(FrameSession::new(TrocarSettings::by_tracker(&subject.arm()?, &flange_from_m)))
            }
            Self::Trocar => Box::new(FrameSession::new(TrocarSettings::by_arm(&subject.arm()?))),
            Self::Table => Box::new(FrameSession::new(TableSettings::by_arm(tip_m, subject.up_in_base()))),
            Self::View if other_way => Box::new(FrameSession::new(ViewSettings::by_handle())),
            Self::View => Box::new(FrameSession::new(ViewSettings::by_arm(tip_m))),
            Self::Mount => {
                let active = subject.arm.flange_from_s1.rotation;
                Box::new(FrameSession::new(SensorMount::new(active, subject.up_in_base())))
            }
        })
    }

    /// Returns the sample as this calibration uses it.
    pub fn seen(self, sample: &FrameSample, subject: &FrameSubject) -> FrameSample {
        match (self, sample.leader_from_handle, sample.base_from_flange) {
            // A hand never holds a handle without rotation; only the handle's position counts.
            (Self::View, Some(handle), _) => {
                let place_only = FrameSample::from(handle.translation.vector);
                FrameSample { leader_from_handle: place_only.leader_from_handle, ..*sample }
            }
            // Only the tilt counts, because an arm that is held still drifts and rotates about the vertical.
            (Self::Mount, _, Some(flange)) => {
                let up = subject.up_in_base();
                let up_in_flange = flange.rotation.inverse() * up;
                let turn = UnitQuaternion::rotation_between(&up_in_flange, &up).unwrap_or(flange.rotation);
                let tilt_only = Isometry3::from_parts(Vector3::zeros().into(), turn);
                FrameSample { base_from_flange: Some(tilt_only), ..*sample }
            }
            _ => *sample,
        }
    }

    /// Returns the instruction after `taken` records; `target` is the next pose of the list.
    pub fn prompt(self, other_way: bool, taken: usize, target: impl Fn() -> PoseTarget) -> Prompt {
        let asked = ViewSettings::by_arm(Vector3::zeros()).asked(taken);
        match self {
            Self::Mount => Prompt::Hold { world_from_s1: target().world_from_s1() },
            Self::Tip => Prompt::PivotInDimple,
            Self::HandEye => Prompt::Turn,
            Self::Trocar => Prompt::PivotInTrocar,
            Self::Table => Prompt::Touch { point: u8::try_from(taken).unwrap_or(u8::MAX) },
            Self::View if other_way => asked.map_or(Prompt::Rest, Prompt::MoveHandle),
            Self::View => asked.map_or(Prompt::Rest, Prompt::MoveTip),
        }
    }

    /// Returns the text of the current instruction to the person at the arm.
    pub fn asks(prompt: &Prompt, target: &str) -> String {
        match prompt {
            Prompt::Hold { .. } => texts::hold(target),
            Prompt::PivotInDimple => texts::PIVOT.get().to_owned(),
            Prompt::Turn => texts::TURN.get().to_owned(),
            Prompt::PivotInTrocar => texts::PIVOT_IN_TROCAR.get().to_owned(),
            Prompt::Touch { point: 0 } => texts::TOUCH_ORIGIN.get().to_owned(),
            Prompt::Touch { point: 1 } => texts::TOUCH_X.get().to_owned(),
            Prompt::Touch { point: 2 } => texts::TOUCH_Y.get().to_owned(),
            Prompt::Touch { .. } => texts::TOUCH_FURTHER.get().to_owned(),
            Prompt::MoveTip(way) => texts::moved(texts::THE_TIP.get(), nima_words::report_text::ShortText::words(*way)),
            Prompt::MoveHandle(way) => {
                texts::moved(texts::THE_HANDLE.get(), nima_words::report_text::ShortText::words(*way))
            }
            _ => texts::HOLD_STILL.get().to_owned(),
        }
    }
}
