//! For whoever sits down for the first time: a tour of four steps, and a glossary. Both stay under the top bar, so that the stop is
//! never covered, and hold nothing up.

use egui::{Align, Align2, Button, Context, Label, Rect, RichText, ScrollArea, Window, vec2};

use super::theme;

/// Heading and words of a step.
const TOUR: [(&str, &str); 4] = [
    (
        "Three views of one loop",
        "Surgeon, Technician and Demo, by a click above or by F1, F2 and F3. They change what is shown, never what the loop does; \
         only the demonstration switches modes, and only on simulated rigs.",
    ),
    (
        "The stop",
        "Always above on the right, and Space or Escape from anywhere. It takes force and motion away at once and stays latched: out \
         of it lead two steps, Release stop and Engage.",
    ),
    (
        "Two forces",
        "Measured at the instrument: a line with one head. Rendered to the hand: a beaded line with two. Arrows in the view, bars \
         against the ceiling, lines in the traces mean the same everywhere.",
    ),
    (
        "Ask the screen",
        "Rest the pointer on any number: it tells its unit, its frame and its meaning. M lets you lead the instrument, E marks a \
         moment in the traces, F4 opens the glossary.",
    ),
];

/// Words of the field.
pub const GLOSSARY: [(&str, &str); 22] = [
    (
        "Anchored",
        "Our mode: the last measured force, corrected for what the hand did since, as far as such corrections have proven themselves.",
    ),
    ("Ceiling", "The largest force that ever reaches the hand, N."),
    ("Clutch", "While it is pressed the hand moves freely and the follower rests."),
    ("Condition", "How hard the columns of a model are to tell apart; 1 is perfect, above 10 000 hardly at all."),
    ("Dead band", "Speed of the hand below which nothing is rendered: at standstill an impedance is unknown."),
    ("Degree", "N of the polynomial between motion and force; 0 means no correction."),
    ("Delay", "Time that a measurement takes from the follower to the hand, one way, ms."),
    ("DFR", "Direct force reflection: the measured force, as late as it comes."),
    ("Excitation", "How much the motion in the window varies. Without motion nothing can be identified."),
    ("Follower", "The robot arm with the instrument."),
    ("Gain", "Factor between the force asked for and the force in the hand, without unit."),
    ("Gate", "A stage between a model and the hand that may take force away, for a reason that it tells."),
    ("Horizon", "The link's delay: how far ahead of its newest data the leader renders."),
    ("IMA, NIMA", "(Nonlinear) impedance matching: the parameters of a law cross the link instead of forces."),
    ("Interlock", "The state machine that alone permits force and motion."),
    (
        "kbf",
        "The frame of the follower's base: z up, the tissue at rest at z = 0. Forces are the tissue's on the instrument.",
    ),
    ("Leader", "The haptic device in the hand."),
    ("Measured", "The force at the tip of the instrument, now, N."),
    ("Missed", "Periods in which the loop was not run in time; counted and skipped, never caught up."),
    ("Rendered", "The force commanded to the hand after all gates, N."),
    ("Trocar", "Where the instrument goes through the wall; the remote centre of its motion."),
    ("Wrench", "Force and torque together, as the wrist sensor reads them."),
];

const KEYS_HEADING: &str = "Keys";
const WORDS_HEADING: &str = "Words";

/// Every key that does something, and what.
pub const KEYS: [(&str, &str); 13] = [
    ("Space, Escape", "Stop. From anywhere; while a name is written, Escape alone."),
    ("F1, F2, F3", "Surgeon, Technician, Demo."),
    ("F4", "Keys and words: this list."),
    ("F5", "The last alarms."),
    ("A", "Acknowledges the alarms."),
    ("E", "Marks this moment in the traces."),
    ("M", "Lets you lead the instrument, or lets it go."),
    ("Arrow keys", "A small step of the instrument while you lead it."),
    ("Page Up, Page Down", "Its height while you lead it."),
    ("Ctrl +, Ctrl -", "Everything larger or smaller."),
    ("Tab, Shift Tab", "To the next control, or back. It gets a frame."),
    ("Enter", "Presses the control that has the frame."),
    ("Ctrl Tab", "The next tab of the group under the pointer."),
];

/// What is open.
#[derive(Clone, Copy, Debug, Default)]
pub struct Help {
    /// The step of the tour that is shown.
    tour: Option<usize>,
    /// The glossary is open.
    pub glossary: bool,
}

impl Help {
    /// Begins the tour.
    pub const fn begin_tour(&mut self) {
        self.tour = Some(0);
    }

    /// Draws what is open into `room`; true in the frame in which the tour ends.
    pub(super) fn ui(&mut self, ctx: &Context, room: Rect) -> bool {
        self.glossary_ui(ctx, room);
        let Some(step) = self.tour else { return false };
        let (heading, words) = TOUR[step];
        let window = Window::new("Tour").title_bar(false).resizable(false).movable(false).constrain_to(room);
        let window = window.anchor(Align2::CENTER_TOP, vec2(0.0, room.top() + 12.0)).fixed_size(vec2(440.0, 0.0));
        window.show(ctx, |ui| {
            ui.label(RichText::new(heading).font(theme::strong(18.0)));
            ui.label(RichText::new(words).font(theme::regular(15.0)));
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                ui.label(super::widgets::small(format!("{} of {}", step + 1, TOUR.len())));
                let size = vec2(96.0, 32.0);
                if ui.add_enabled(step > 0, Button::new("Step back").min_size(size)).clicked() {
                    self.tour = Some(step - 1);
                }
                let last = step + 1 == TOUR.len();
                if ui.add(Button::new(if last { "Begin" } else { "Next step" }).min_size(size)).clicked() {
                    self.tour = if last { None } else { Some(step + 1) };
                }
                if !last && ui.add(Button::new("Skip the tour").min_size(size)).clicked() {
                    self.tour = None;
                }
            });
        });
        self.tour.is_none()
    }

    fn glossary_ui(&mut self, ctx: &Context, room: Rect) {
        let window = Window::new("Glossary").open(&mut self.glossary).constrain_to(room).collapsible(false);
        let height = (room.height() - 90.0).min(560.0);
        window.default_pos(room.center_top() + vec2(-230.0, 16.0)).fixed_size(vec2(460.0, height)).show(ctx, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                ui.label(RichText::new(KEYS_HEADING).font(theme::strong(16.0)));
                for (key, meaning) in KEYS {
                    ui.horizontal(|ui| {
                        ui.add_sized(
                            vec2(150.0, 18.0),
                            Label::new(RichText::new(key).font(theme::strong(14.0))).halign(Align::Min),
                        );
                        ui.add(Label::new(super::widgets::weak(meaning)).wrap());
                    });
                }
                ui.add_space(8.0);
                ui.label(RichText::new(WORDS_HEADING).font(theme::strong(16.0)));
                for (word, meaning) in GLOSSARY {
                    ui.label(RichText::new(word).font(theme::strong(14.0)));
                    ui.label(super::widgets::weak(meaning));
                    ui.add_space(4.0);
                }
            });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_glossary_is_in_order_and_every_meaning_is_a_sentence() {
        assert!(GLOSSARY.is_sorted_by_key(|(word, _)| word.to_lowercase()));
        assert!(GLOSSARY.iter().all(|(word, meaning)| meaning.ends_with('.') && meaning.len() > word.len()));
    }
}
