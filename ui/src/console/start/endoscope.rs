//! The endoscope of the chosen rig: a typed address is tried at once, and written to the rig file.

use std::{
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use egui::{Button, Context, Label, TextEdit, Ui, vec2};
use nima_core::calibration::frames::RigChange;
use nima_endoscope::{Address, DecodedImage, EndoscopeFeed, FeedSnapshot, FrameHealth};
use nima_machine::config::{EndoscopeConfig, RigConfig, change_rig};
use nima_panels::endoscope_view::fault_text;
use nima_screen::{double_buffer::DoubleBuffer, widgets::small};
use nima_words::{report_text::chain, text};

use super::devices::{answer_ui, trouble_ui};

/// Delay between the last key press and the test of an address.
const TYPED: Duration = Duration::from_millis(500);
/// Folder of the user's rigs within the user's data.
const RIGS: &str = "rigs";
/// The key of the address in a rig file, and its table.
const URL: &str = "endoscope.url";
const TABLE: &str = "endoscope";

#[derive(Default)]
pub(super) struct EndoscopeCard {
    /// Endoscope in the file of the chosen rig.
    of_rig: Option<EndoscopeConfig>,
    /// The devices of the chosen rig are emulated, and with them its endoscope.
    is_emulated: bool,
    typed: String,
    /// Time of the last key press, if the address was not tried yet.
    typed_at: Option<Instant>,
    tried: Option<AddressResult>,
    preview: DoubleBuffer,
    number: u64,
}

/// Result of an address.
enum AddressResult {
    /// Open, or being opened.
    Feed(EndoscopeFeed),
    /// Reason why it cannot be used.
    Refused(String),
}

impl std::fmt::Debug for EndoscopeCard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("card").field("typed", &self.typed).finish_non_exhaustive()
    }
}

impl EndoscopeCard {
    /// Call when another rig is chosen, or the page is opened.
    pub(super) fn choose(&mut self, rig: Option<&RigConfig>) {
        let of_rig = rig.and_then(|rig| rig.endoscope.clone());
        let typed = of_rig.as_ref().map(|endoscope| endoscope.url.clone()).unwrap_or_default();
        let typed_at = (!typed.is_empty()).then(Instant::now);
        let is_emulated = rig.and_then(|rig| rig.devices.as_ref()).is_some_and(|devices| devices.emulated);
        *self = Self { of_rig, is_emulated, typed, typed_at, ..Self::default() };
    }

    /// Returns whether the emulator of this endoscope starts with the rig, so that it cannot be tried before.
    fn starts_with_rig(&self, address: &str) -> bool {
        self.is_emulated && self.of_rig.as_ref().is_some_and(|endoscope| endoscope.url == address)
    }

    /// The page is hidden: no camera stays open.
    pub(super) fn close(&mut self) {
        self.tried = None;
        self.typed_at = None;
    }

    /// Draws the card. `running`: state and address of the running rig's endoscope, which is not opened twice. Returns true
    /// when the address is to be written.
    pub(super) fn ui(&mut self, ui: &mut Ui, running: Option<(&str, &[String; 2])>) -> bool {
        let width = ui.available_width();
        let field = TextEdit::singleline(&mut self.typed).hint_text(text::start::ENDOSCOPE_HINT);
        let field = ui.add_sized(vec2(width, 28.0), field);
        field.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::TextInput, true, text::start::ENDOSCOPE_ADDRESS.get())
        });
        if field.changed() {
            self.typed_at = Some(Instant::now());
            self.tried = None;
            self.preview = DoubleBuffer::default();
        }
        let address = self.typed.trim().to_owned();
        match running.filter(|(url, _)| *url == address) {
            Some((_, [report, cure])) => {
                self.close();
                outcome_ui(ui, report, cure);
            }
            None if address.is_empty() => {
                self.close();
                ui.add(Label::new(small(text::start::NO_ENDOSCOPE)).wrap());
            }
            None if self.starts_with_rig(&address) => {
                self.close();
                ui.add(Label::new(small(text::start::ENDOSCOPE_EMULATED)).wrap());
            }
            None => {
                self.try_it(ui.ctx(), &address);
                self.tried_ui(ui, width);
            }
        }
        let before = self.of_rig.as_ref().map_or("", |endoscope| endoscope.url.as_str());
        let words =
            if address.is_empty() { text::start::ENDOSCOPE_REMOVE.get() } else { text::start::ENDOSCOPE_USE.get() };
        let button = ui.add_enabled(address != before, Button::new(words).min_size(vec2(width, 32.0)));
        let why = if address.is_empty() { text::start::ADDRESS_FIRST } else { text::start::ENDOSCOPE_SAME };
        button.on_hover_text(text::start::ENDOSCOPE_USE_HOVER).on_disabled_hover_text(why).clicked()
    }

    /// Tries the typed address after the last key press.
    fn try_it(&mut self, ctx: &Context, address: &str) {
        let Some(typed_at) = self.typed_at else {
            // Try again once the rig that uses the endoscope has ended.
            if self.tried.is_none() {
                self.typed_at = Some(Instant::now());
            }
            return;
        };
        let rest = TYPED.saturating_sub(typed_at.elapsed());
        if !rest.is_zero() {
            return ctx.request_repaint_after(rest);
        }
        self.typed_at = None;
        let wakes = ctx.clone();
        let parsed = address.parse::<Address>().map_err(|error| error.to_string());
        let feed = parsed.and_then(|address| {
            EndoscopeFeed::start(address, None, move || wakes.request_repaint()).map_err(|error| error.to_string())
        });
        self.tried = Some(feed.map_or_else(AddressResult::Refused, AddressResult::Feed));
    }

    fn tried_ui(&mut self, ui: &mut Ui, width: f32) {
        let look = match &self.tried {
            None => return drop(ui.label(small(text::start::ENDOSCOPE_TYPING))),
            Some(AddressResult::Refused(why)) => {
                return outcome_ui(ui, &text::endoscope_view::refused(why), text::start::ENDOSCOPE_FORMS.get());
            }
            Some(AddressResult::Feed(feed)) => feed.look(Instant::now()),
        };
        match &look.standing {
            FrameHealth::Opening => drop(ui.label(small(text::start::ENDOSCOPE_OPENING))),
            FrameHealth::Live | FrameHealth::Still => {
                let size_px = look.image.as_ref().map_or([0; 2], |(_, image)| image.size_px);
                let rate_hz = (look.standing == FrameHealth::Live).then_some(look.rate_hz);
                answer_ui(ui, true, &text::start::endoscope_sends(size_px, rate_hz));
            }
            FrameHealth::Wrong(wrong) => {
                let [report, cure] = fault_text(wrong);
                outcome_ui(ui, &report, &cure);
            }
            FrameHealth::Lost(trouble) => outcome_ui(ui, &trouble.to_string(), trouble.cure()),
        }
        self.preview_ui(ui, &look, width);
    }

    /// Draws a small preview of the image.
    fn preview_ui(&mut self, ui: &mut Ui, look: &FeedSnapshot<Arc<DecodedImage>>, width: f32) {
        let Some((number, image)) = &look.image else { return };
        if self.preview.id().is_none() || self.number != *number {
            self.preview.upload(ui.ctx(), "tried", image);
            self.number = *number;
        }
        let Some(texture) = self.preview.id() else { return };
        let [columns, rows] = image.size_px.map(|side| side.max(1) as f32);
        ui.add(egui::Image::new((texture, vec2(width, width * rows / columns))));
    }

    /// Writes the address to the file of this rig, or of a copy if it is built in; without an address, removes the endoscope.
    /// Returns the path of the file.
    pub(super) fn write(&self, rig: &str, folder: Option<&Path>) -> Result<String, String> {
        let folder = folder.ok_or(text::start::NO_FOLDER.get())?;
        let address = self.typed.trim();
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let before = self.of_rig.as_ref().map(|endoscope| quoted(&endoscope.url));
        let change = match address {
            "" => RigChange { key: TABLE.to_owned(), before, after: None },
            _ => RigChange { key: URL.to_owned(), before, after: Some(quoted(address)) },
        };
        let (path, _) = change_rig(rig, &folder.join(RIGS), &[change]).map_err(|error| chain(&error))?;
        Ok(path.display().to_string())
    }
}

/// Draws problem and remedy; only a state if there is no problem.
fn outcome_ui(ui: &mut Ui, report: &str, cure: &str) {
    if cure.is_empty() {
        answer_ui(ui, true, report);
    } else {
        trouble_ui(ui, text::start::ENDOSCOPE.get(), report, cure);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn card(rig: &str, typed: &str) -> EndoscopeCard {
        let mut card = EndoscopeCard::default();
        card.choose(Some(&RigConfig::load(rig).unwrap()));
        typed.clone_into(&mut card.typed);
        card
    }

    #[test]
    fn an_emulated_endoscope_is_not_tried_before_its_rig_starts() {
        let url = "http://127.0.0.1:47160/";
        assert!(card("emulated", url).starts_with_rig(url));
        assert!(!card("emulated", url).starts_with_rig("/dev/video0"));
        assert!(!card("simulated", url).starts_with_rig(url));
    }

    #[test]
    fn an_address_is_written_into_the_users_own_rig_and_taken_out_again() {
        let folder = tempfile::tempdir().unwrap();
        let url = "http://192.168.10.7:8080/a \"b\"";
        let path = card("simulated", url).write("simulated", Some(folder.path())).unwrap();
        let rig = RigConfig::load(&path).unwrap();
        assert_eq!(rig.endoscope, Some(EndoscopeConfig { url: url.to_owned(), ..EndoscopeConfig::default() }));
        assert_eq!(RigConfig::load("simulated").unwrap().endoscope, None, "what is built in stays");
        // The endoscope's other settings are kept when the address changes.
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text + "mirror = true\n").unwrap();
        assert_eq!(card(&path, "film.mjpeg").write(&path, Some(folder.path())).unwrap(), path);
        let endoscope = RigConfig::load(&path).unwrap().endoscope.unwrap();
        assert!(endoscope.mirror && endoscope.url == "film.mjpeg");
        card(&path, "  ").write(&path, Some(folder.path())).unwrap();
        assert_eq!(RigConfig::load(&path).unwrap().endoscope, None);
        assert_eq!(card(&path, "x").write(&path, None), Err(text::start::NO_FOLDER.get().to_owned()));
    }
}
