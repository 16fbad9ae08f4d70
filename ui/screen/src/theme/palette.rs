//! The colours, in two palettes and a form of each for colour-blind users.

use egui::Color32;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColourPalette {
    /// Background of the window.
    pub background: Color32,
    /// Bars and side panels.
    pub panel: Color32,
    /// A card on a panel.
    pub card: Color32,
    /// Tooltips and menus.
    pub popup: Color32,
    /// A control at rest.
    pub control: Color32,
    /// A control under the pointer.
    pub control_hover: Color32,
    /// Slider rails, empty bars, plot backgrounds.
    pub groove: Color32,
    /// Thin lines.
    pub line: Color32,
    /// Main text.
    pub text: Color32,
    /// Explanatory text.
    pub text_weak: Color32,
    /// The stop button, which must be found at a glance.
    pub stop: Color32,
    /// Selected, or set by the operator.
    pub selected: Color32,
    /// The one button to press next.
    pub primary: Color32,
    /// The force measured at the instrument.
    pub measured: Color32,
    /// The force rendered to the hand.
    pub rendered: Color32,
    /// Reference for comparisons (delayed DFR, the paper's choice).
    pub reference: Color32,
    /// Several lines in one plot: axes x, y, z, or the members of an ensemble. They also differ in lightness.
    pub series: [Color32; 4],
    /// The names of the right and the left arm.
    pub arms: [Color32; 2],
    /// The frame around recorded data only.
    pub past: Color32,
    /// The frame of a rig at another machine, shown without control.
    pub watching: Color32,
    /// The loop runs and renders force.
    pub engaged: Color32,
    /// The loop is at rest.
    pub at_rest: Color32,
    /// High-priority alarm, flashing.
    pub alarm_high: Color32,
    /// Medium-priority alarm, flashing slowly.
    pub alarm_medium: Color32,
    /// Low-priority alarm, steady.
    pub alarm_low: Color32,
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// For a dark room; also for the 3-D view and for alarms, which are dark in both palettes.
pub const DARK: ColourPalette = ColourPalette {
    background: rgb(0x10_1317),
    panel: rgb(0x15_191f),
    card: rgb(0x1c_2129),
    popup: rgb(0x26_2d37),
    control: rgb(0x2b_333e),
    control_hover: rgb(0x37_414e),
    groove: rgb(0x11_151a),
    line: rgb(0x2d_3540),
    text: rgb(0xe6_eaee),
    text_weak: rgb(0xa4_afba),
    stop: rgb(0xff_ffff),
    selected: rgb(0x3f_5d86),
    primary: rgb(0x24_62c8),
    measured: rgb(0xf3_e9d2),
    rendered: rgb(0x6c_9dff),
    reference: rgb(0x8d_97a3),
    series: [rgb(0xf3_e9d2), rgb(0x6c_9dff), rgb(0x63_c28c), rgb(0xc2_7ddc)],
    arms: [rgb(0xc3_b56e), rgb(0xe0_9cc2)],
    past: rgb(0xd5_73e4),
    watching: rgb(0xe9_8b3a),
    engaged: rgb(0x63_c28c),
    at_rest: rgb(0xc3_cad2),
    alarm_high: rgb(0xff_5c5c),
    alarm_medium: rgb(0xff_d73d),
    alarm_low: rgb(0x41_d6e0),
};

/// For a bright room and for printing.
pub const LIGHT: ColourPalette = ColourPalette {
    background: rgb(0xf4_f6f8),
    panel: rgb(0xe4_e9ee),
    card: rgb(0xfc_fdfe),
    popup: rgb(0xff_ffff),
    control: rgb(0xdc_e2e9),
    control_hover: rgb(0xcb_d4dd),
    groove: rgb(0xe9_edf1),
    line: rgb(0xc2_cad3),
    text: rgb(0x16_1b21),
    text_weak: rgb(0x4b_5764),
    stop: rgb(0x10_1317),
    selected: rgb(0xa8_c4ec),
    primary: rgb(0x2a_5db0),
    measured: rgb(0x5d_4715),
    rendered: rgb(0x1a_5fd8),
    reference: rgb(0x5e_6974),
    series: [rgb(0x5d_4715), rgb(0x1a_5fd8), rgb(0x18_703f), rgb(0x8a_3ba8)],
    arms: [rgb(0x62_5a12), rgb(0x8f_3468)],
    past: rgb(0x93_2fa8),
    watching: rgb(0xa0_4e00),
    engaged: rgb(0x18_703f),
    at_rest: rgb(0x58_626d),
    alarm_high: rgb(0xc9_1f2a),
    alarm_medium: rgb(0x7f_6100),
    alarm_low: rgb(0x00_7280),
};

/// For colour-blind users: green, which looks like red to many of them, is blue or orange here.
const fn safe(of: &ColourPalette, engaged: u32, series: [u32; 2]) -> ColourPalette {
    let [third, fourth] = series;
    ColourPalette { engaged: rgb(engaged), series: [of.series[0], of.series[1], rgb(third), rgb(fourth)], ..*of }
}

pub const DARK_SAFE: ColourPalette = safe(&DARK, 0x56_b4e9, [0xe6_9f00, 0xd7_8fb5]);
pub const LIGHT_SAFE: ColourPalette = safe(&LIGHT, 0x00_5a9c, [0x8a_5200, 0x92_2d6c]);

#[cfg(test)]
mod tests {
    use nima_testing::contrast::MIN;

    use super::*;
    use crate::theme::{FIELD_FAR, FIELD_NEAR, VEIL};

    fn contrast(a: Color32, b: Color32) -> f64 {
        let [a, b] = [a, b].map(|colour| [colour.r(), colour.g(), colour.b()]);
        nima_testing::contrast::contrast(a, b)
    }

    /// Returns the colours of a palette in which words and numbers are written.
    fn inks(palette: &ColourPalette) -> Vec<(&'static str, Color32)> {
        let mut inks = vec![
            ("text", palette.text),
            ("text_weak", palette.text_weak),
            ("measured", palette.measured),
            ("rendered", palette.rendered),
            ("reference", palette.reference),
            ("engaged", palette.engaged),
            ("at_rest", palette.at_rest),
            ("alarm_high", palette.alarm_high),
            ("alarm_medium", palette.alarm_medium),
            ("alarm_low", palette.alarm_low),
            ("past", palette.past),
            ("watching", palette.watching),
        ];
        inks.extend(palette.series.map(|colour| ("series", colour)));
        inks.extend(palette.arms.map(|colour| ("arms", colour)));
        inks
    }

    #[test]
    fn every_colour_is_read_on_every_ground_of_both_palettes() {
        let mut wrong = Vec::new();
        for (name, palette) in
            [("dark", &DARK), ("light", &LIGHT), ("dark safe", &DARK_SAFE), ("light safe", &LIGHT_SAFE)]
        {
            let grounds = [palette.background, palette.panel, palette.card, palette.popup, palette.groove];
            for (ink, colour) in inks(palette) {
                let min = grounds.map(|ground| contrast(colour, ground)).into_iter().fold(f64::INFINITY, f64::min);
                if min < MIN {
                    wrong.push(format!("{name} {ink}: {min:.2}"));
                }
            }
        }
        assert!(wrong.is_empty(), "{wrong:?}");
    }

    /// Returns the colour as a person without red or green cones sees it (Machado et al. 2009, IEEE TVCG 15(6)).
    fn seen(colour: Color32, matrix: &[[f64; 3]; 3]) -> [f64; 3] {
        let linear = [colour.r(), colour.g(), colour.b()].map(|value| (f64::from(value) / 255.0).powf(2.2));
        let row = |row: &[f64; 3]| row.iter().zip(linear).map(|(weight, value)| weight * value).sum::<f64>();
        [0, 1, 2].map(|i| row(&matrix[i]).clamp(0.0, 1.0).powf(1.0 / 2.2))
    }

    #[test]
    fn the_safe_palettes_keep_engaged_and_alarms_apart_for_colour_blind_eyes() {
        const PROTANOPIA: [[f64; 3]; 3] = [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ];
        const DEUTERANOPIA: [[f64; 3]; 3] =
            [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]];
        let apart = |palette: &ColourPalette| {
            let alarms = [palette.alarm_high, palette.alarm_medium];
            let pairs = [PROTANOPIA, DEUTERANOPIA].into_iter().flat_map(|eye| alarms.map(|alarm| (eye, alarm)));
            let distances = pairs.map(|(eye, alarm)| {
                let [one, other] = [palette.engaged, alarm].map(|colour| seen(colour, &eye));
                one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
            });
            distances.fold(f64::INFINITY, f64::min)
        };
        for (safe, usual) in [(&DARK_SAFE, &DARK), (&LIGHT_SAFE, &LIGHT)] {
            assert!(apart(safe) > 0.35 && apart(safe) > 1.5 * apart(usual), "{} {}", apart(safe), apart(usual));
        }
    }

    #[test]
    fn words_on_controls_and_signs_are_read_too() {
        for palette in [&DARK, &LIGHT, &DARK_SAFE, &LIGHT_SAFE] {
            for control in [palette.control, palette.control_hover] {
                assert!(contrast(palette.text, control) > 7.0 && contrast(palette.text_weak, control) > MIN);
            }
            assert!(contrast(palette.text, palette.selected) > MIN);
            assert!(contrast(DARK.text, palette.primary) > MIN, "the next button");
            for sign in [palette.engaged, palette.alarm_high, palette.stop, palette.at_rest, palette.past] {
                assert!(contrast(palette.background, sign) > MIN, "{sign:?}");
            }
            assert!(contrast(palette.stop, palette.panel) > 10.0, "the stop must be found without looking");
            assert!(contrast(palette.measured, palette.rendered) > 1.4, "the forces differ in lightness too");
        }
        // The alarm strip is dark in both palettes.
        assert!(contrast(DARK.text_weak, DARK.card) > MIN);
    }

    #[test]
    fn words_on_the_field_and_on_a_picture_are_read_whatever_is_below() {
        for below in [Color32::WHITE, FIELD_FAR, FIELD_NEAR] {
            let ground = below.blend(VEIL);
            for (ink, colour) in inks(&DARK) {
                assert!(contrast(colour, ground) >= MIN, "{ink} on {below:?}: {:.2}", contrast(colour, ground));
            }
        }
    }
}
