//! Instructions on the screen for the person at the arms, and their form as a line of text.

use std::{fmt, str::FromStr};

use nalgebra::{Quaternion, UnitQuaternion, UnitVector3, Vector3};
use nima_core::calibration::frames::ViewMove;
use nima_machine::rig::{Prompt, Side};

/// The task of the person at the arms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PersonTask {
    /// No calibration: the instrument is in the trocar, and no one touches the arm.
    #[default]
    Surgery,
    /// Gravity: the instrument is out of the trocar, and nothing is near it.
    Gravity,
    /// Correspondence: the tissue is on its sensor, without the body wall.
    Correspondence,
    /// Tip force: through the trocar onto the tissue.
    TipForce,
    /// Tip: the instrument is out of the trocar, with its tip in a dimple.
    Tip,
    /// Hand-eye: the instrument is out of the trocar, with its marker in the tracker's view.
    HandEye,
    /// Trocar: the instrument stays in the trocar, above the tissue.
    Trocar,
    /// Table: its tip touches points of the table, which is empty.
    Table,
    /// View: its tip, then the handle, is moved in the directions of the image.
    View,
}

impl PersonTask {
    const ALL: [(Self, &'static str); 9] = [
        (Self::Surgery, "surgery"),
        (Self::Gravity, "gravity"),
        (Self::Correspondence, "correspondence"),
        (Self::TipForce, "tip-force"),
        (Self::Tip, "tip"),
        (Self::HandEye, "hand-eye"),
        (Self::Trocar, "trocar"),
        (Self::Table, "table"),
        (Self::View, "view"),
    ];
}

/// The content of the screen: the arm being calibrated, the open calibration, and its current instruction.
///
/// As text, `right gravity rest` or `left correspondence push 0 0 -1`:
///
/// ```
/// use nima_machine::rig::{Prompt, Side};
/// use nima_simulation::screen::{Screen, PersonTask};
///
/// let screen = Screen { side: Side::Left, task: PersonTask::TipForce, prompt: Prompt::Work };
/// assert_eq!(screen.to_string(), "left tip-force work");
/// assert_eq!("left tip-force work".parse(), Ok(screen));
/// assert!("left tip-force sing".parse::<Screen>().is_err());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Screen {
    pub side: Side,
    pub task: PersonTask,
    pub prompt: Prompt,
}

impl fmt::Display for Screen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let task = PersonTask::ALL.iter().find(|(task, _)| *task == self.task).map_or("", |(_, word)| word);
        write!(f, "{} {task} ", self.side.word())?;
        match &self.prompt {
            Prompt::Rest => f.write_str("rest"),
            Prompt::Hold { world_from_s1: q } => write!(f, "hold {} {} {} {}", q.w, q.i, q.j, q.k),
            Prompt::Wave => f.write_str("wave"),
            Prompt::Push { direction } => write!(f, "push {} {} {}", direction.x, direction.y, direction.z),
            Prompt::Work => f.write_str("work"),
            Prompt::WorkFree => f.write_str("work-free"),
            Prompt::PivotInDimple => f.write_str("pivot-in-dimple"),
            Prompt::Turn => f.write_str("turn"),
            Prompt::PivotInTrocar => f.write_str("pivot-in-trocar"),
            Prompt::Touch { point } => write!(f, "touch {point}"),
            Prompt::MoveTip(way) => write!(f, "move-tip {}", number_of(*way)),
            Prompt::MoveHandle(way) => write!(f, "move-handle {}", number_of(*way)),
        }
    }
}

/// Returns the index of a move in the order in which moves are requested.
fn number_of(way: ViewMove) -> usize {
    ViewMove::ALL.iter().position(|known| *known == way).unwrap_or_default()
}

/// Parses a whole number from 0 up.
fn whole(x: f64) -> Result<u8, NoScreen> {
    if x.fract() == 0.0 && (0.0..=255.0).contains(&x) { Ok(x as u8) } else { Err(NoScreen) }
}

fn way(x: f64) -> Result<ViewMove, NoScreen> {
    ViewMove::ALL.get(usize::from(whole(x)?)).copied().ok_or(NoScreen)
}

/// A line that is not a valid screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "expected: SIDE TASK PROMPT, with right or left; surgery, gravity, correspondence, tip-force, tip, hand-eye, trocar, table or view; rest, \
     hold W X Y Z, wave, push X Y Z, work, work-free, pivot-in-dimple, turn, pivot-in-trocar, touch POINT, move-tip WAY or move-handle WAY \
     (0 to 5)"
)]
pub struct NoScreen;

impl FromStr for Screen {
    type Err = NoScreen;

    fn from_str(line: &str) -> Result<Self, NoScreen> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [side, task, prompt, numbers @ ..] = &words[..] else { return Err(NoScreen) };
        let side = Side::ALL.into_iter().find(|known| known.word() == *side).ok_or(NoScreen)?;
        let (task, _) = PersonTask::ALL.into_iter().find(|(_, word)| word == task).ok_or(NoScreen)?;
        let numbers: Vec<f64> = numbers.iter().map(|x| x.parse().map_err(|_| NoScreen)).collect::<Result<_, _>>()?;
        let prompt = match (*prompt, &numbers[..]) {
            ("rest", []) => Prompt::Rest,
            ("wave", []) => Prompt::Wave,
            ("work", []) => Prompt::Work,
            ("work-free", []) => Prompt::WorkFree,
            ("pivot-in-dimple", []) => Prompt::PivotInDimple,
            ("turn", []) => Prompt::Turn,
            ("pivot-in-trocar", []) => Prompt::PivotInTrocar,
            ("touch", [point]) => Prompt::Touch { point: whole(*point)? },
            ("move-tip", [number]) => Prompt::MoveTip(way(*number)?),
            ("move-handle", [number]) => Prompt::MoveHandle(way(*number)?),
            ("hold", [w, x, y, z]) => {
                let turn = UnitQuaternion::try_new(Quaternion::new(*w, *x, *y, *z), 1e-6).ok_or(NoScreen)?;
                Prompt::Hold { world_from_s1: turn }
            }
            ("push", [x, y, z]) => {
                let direction = UnitVector3::try_new(Vector3::new(*x, *y, *z), 1e-6).ok_or(NoScreen)?;
                Prompt::Push { direction }
            }
            _ => return Err(NoScreen),
        };
        if prompt.is_finite() { Ok(Self { side, task, prompt }) } else { Err(NoScreen) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_screen_is_the_same_after_it_was_written_and_read() {
        let turn = UnitQuaternion::from_euler_angles(0.3, -1.2, 2.0);
        let direction = UnitVector3::new_normalize(Vector3::new(0.1, -0.7, -0.4));
        let prompts = [
            Prompt::Rest,
            Prompt::Hold { world_from_s1: turn },
            Prompt::Wave,
            Prompt::Push { direction },
            Prompt::Work,
            Prompt::WorkFree,
            Prompt::PivotInDimple,
            Prompt::Turn,
            Prompt::PivotInTrocar,
            Prompt::Touch { point: 3 },
            Prompt::MoveTip(ViewMove::Deeper),
            Prompt::MoveHandle(ViewMove::Back),
        ];
        for (task, _) in PersonTask::ALL {
            for (side, prompt) in Side::ALL.into_iter().flat_map(|side| prompts.map(|prompt| (side, prompt))) {
                let read: Screen = Screen { side, task, prompt }.to_string().parse().unwrap();
                assert_eq!((read.side, read.task), (side, task));
                match (read.prompt, prompt) {
                    (Prompt::Hold { world_from_s1: now }, Prompt::Hold { world_from_s1: was }) => {
                        assert!(now.angle_to(&was) < 1e-7);
                    }
                    (Prompt::Push { direction: now }, Prompt::Push { direction: was }) => {
                        assert!((now.into_inner() - was.into_inner()).norm() < 1e-9);
                    }
                    (now, was) => assert_eq!(now, was),
                }
            }
        }
    }

    #[test]
    fn what_is_no_screen_is_refused() {
        for bad in [
            "",
            "right",
            "right gravity",
            "up gravity rest",
            "right sleep rest",
            "right gravity hold 1 0 0",
            "right gravity hold 0 0 0 0",
            "right gravity hold NaN 0 0 1",
            "right gravity push inf 0 0",
            "right gravity rest 1",
            "right table touch",
            "right table touch -1",
            "right table touch 0.5",
            "right view move-tip 6",
        ] {
            assert_eq!(bad.parse::<Screen>(), Err(NoScreen), "{bad}");
        }
    }
}
