//! The 3-D view of the operating field.

use crate::language::{Text, text_format, word};

pub(in crate::console) const OPERATING_FIELD: Text = Text::of("Operating field", "OP-Feld");
pub(in crate::console) const SHOW: Text = Text::of("Show", "Zeigen");
pub(in crate::console) const SHOW_HOVER: Text =
    Text::of("Choose what else is drawn in the view", "Wählen, was außerdem gezeichnet wird");
pub(in crate::console) const CEILING: Text = Text::of("Force ceiling around the tip", "Höchstkraft um die Spitze");
pub(in crate::console) const CEILING_HOVER: Text = Text::of(
    "The largest force that can reach the hand (N), drawn as a sphere around each tip, at the scale of the arrows",
    "Die größte Kraft, die die Hand erreichen kann (N), als Kugel um jede Spitze, im Maßstab der Pfeile",
);
pub(in crate::console) const FRAMES: Text = Text::of("Coordinate frames", "Koordinatensysteme");
pub(in crate::console) const FRAMES_HOVER: Text = Text::of(
    "World (the frame of all forces and positions), trocar (axes of the world), tip (z along the shaft, \
    away from the tissue) and endoscope (z towards the viewer). Axes are drawn 16 mm long.",
    "Welt (System aller Kräfte und Positionen), Trokar (Achsen der Welt), Spitze (z längs des Schafts, vom Gewebe weg) \
     und Endoskop (z zum Betrachter). Achsen sind 16 mm lang gezeichnet.",
);
pub(in crate::console) const SHADOWS: Text = Text::of("Shadows on the board", "Schatten auf dem Brett");
pub(in crate::console) const SHADOWS_HOVER: Text = Text::of(
    "Objects between the lamp and the board cast a shadow, which helps to judge height. On tissue the shafts \
     always cast shadows.",
    "Was zwischen Lampe und Brett steht, wirft Schatten: das hilft, Höhe einzuschätzen. Auf Gewebe werfen die Schäfte \
     immer Schatten.",
);
pub(in crate::console) const DEPTH: Text = Text::of("Darker with distance", "Dunkler mit Abstand");
pub(in crate::console) const DEPTH_HOVER: Text = Text::of(
    "More distant objects are darker, as with an endoscope whose light is at the lens. This helps to judge depth.",
    "Wie unter einem Endoskop mit Licht am Objektiv: Ferneres ist dunkler. Das hilft, Tiefe einzuschätzen.",
);
pub(in crate::console) const ROUND: Text =
    Text::of("Round image in the Surgeon view", "Rundes Bild in der Ansicht Chirurg");
pub(in crate::console) const ROUND_HOVER: Text = Text::of(
    "Shows the endoscope image as a disc with a dark rim",
    "Das Endoskopbild ist eine Scheibe mit dunklem Rand",
);
pub(in crate::console) const FRAME_WORLD: Text = Text::of("World", "Welt");
pub(in crate::console) const ENDOSCOPE: Text = Text::of("Endoscope", "Endoskop");
pub(in crate::console) const TROCAR: Text = Text::of("Trocar", "Trokar");
pub(in crate::console) const TIP: Text = Text::of("Tip", "Spitze");
pub(in crate::console) const LEAD: Text = Text::of("Drive by mouse (M)", "Maussteuerung (M)");
pub(in crate::console) const LEAD_END: Text = Text::of("Stop driving (M)", "Steuerung beenden (M)");
pub(in crate::console) const ARROW_MEASURED: Text = Text::of("Measured force", "Gemessene Kraft");
pub(in crate::console) const ARROW_RENDERED: Text = Text::of("Rendered force", "Dargestellte Kraft");
pub(in crate::console) const RESET_VIEW: Text = Text::of("Endoscope view", "Endoskopsicht");
pub(in crate::console) const VIEW_HOVER: Text = Text::of(
    "Drag to turn, wheel to zoom, double-click to reset",
    "Ziehen dreht, Mausrad zoomt, Doppelklick setzt zurück",
);

pub(in crate::console) fn lead_hover(has_jaws: bool, is_bimanual: bool) -> String {
    let jaws = if has_jaws { word("\nG: open or close the jaws", "\nG: Backen öffnen oder schließen") } else { "" };
    let other = match (is_bimanual, has_jaws) {
        (false, _) => "",
        (true, true) => word(". H: the other instrument", ". H: anderes Instrument"),
        (true, false) => word("\nH: the other instrument", "\nH: anderes Instrument"),
    };
    text_format!(
        "Drag: move the instrument. Wheel, Page Up, Page Down: height. Arrow keys: small steps{jaws}{other}",
        "Ziehen: Instrument bewegen. Mausrad, Bild auf, Bild ab: Höhe. Pfeiltasten: kleine Schritte{jaws}{other}"
    )
}

pub(in crate::console) fn led(side: &str) -> String {
    text_format!("{side} (driven)", "{side} (gesteuert)")
}

pub(in crate::console) fn not_drawn(problem: &str) -> String {
    text_format!(
        "This graphics driver cannot draw the 3-D view: {problem}",
        "Dieser Grafiktreiber kann die 3-D-Ansicht nicht zeichnen: „{problem}“"
    )
}

pub(in crate::console) fn ceiling_sphere(ceiling_n: f32) -> String {
    text_format!("ceiling {ceiling_n:.1} N", "Höchstkraft {ceiling_n:.1} N")
}

pub(in crate::console) fn ceiling_mark(ceiling_n: f64) -> String {
    text_format!("ceiling\n{ceiling_n:.0} N", "max.\n{ceiling_n:.0} N")
}

/// Returns the suffix that names the side of a rig with two arms.
pub(in crate::console) fn of_hand(side: &str) -> String {
    text_format!(" of the {side} hand", " (Hand {side})")
}

/// Returns the position in the base frame, mm.
pub(in crate::console) fn place([x, y, z]: [f32; 3]) -> String {
    text_format!("x {x:.1}, y {y:.1}, z {z:.1} mm (world)", "x {x:.1}, y {y:.1}, z {z:.1} mm (Welt)")
}

pub(in crate::console) fn tissue(place: &str) -> String {
    text_format!("Tissue at {place}", "Gewebe bei {place}")
}

/// Returns the hover text of an arrow; the force in N, `whose` from [`of_hand`].
pub(in crate::console) fn arrow(name: &str, whose: &str, size_n: f32, [x, y, z]: [f32; 3]) -> String {
    text_format!(
        "{name}{whose}: {size_n:.2} N\nx {x:+.2}, y {y:+.2}, z {z:+.2} N (world)",
        "{name}{whose}: {size_n:.2} N\nx {x:+.2}, y {y:+.2}, z {z:+.2} N (Welt)"
    )
}

pub(in crate::console) fn depth(depth_mm: f32) -> String {
    text_format!("\n{depth_mm:.1} mm below the surface at rest", "\n{depth_mm:.1} mm unter der Ruheoberfläche")
}

/// Returns the hover text of the tip; `depth` from [`depth`].
pub(in crate::console) fn tip(whose: &str, place: &str, depth: &str) -> String {
    text_format!("Tip{whose} at {place}{depth}", "Spitze{whose} bei {place}{depth}")
}

pub(in crate::console) fn target(number: usize, whose: &str, place: &str) -> String {
    text_format!("Target {number}{whose} at {place}", "Ziel {number}{whose} bei {place}")
}

pub(in crate::console) fn trocar(whose: &str, place: &str) -> String {
    text_format!(
        "Trocar{whose}, the remote centre of motion, at {place}",
        "Trokar{whose}, ferner Drehpunkt der Bewegung, bei {place}"
    )
}
