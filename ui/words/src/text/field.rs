//! The 3-D view of the operating field.

use crate::language::{Text, text_format, word};

pub const NAME: Text = Text::of("Field", "Feld");
pub const MEANING: Text =
    Text::of("The operating field in 3-D, with the forces drawn as arrows", "Das OP-Feld in 3-D, Kräfte als Pfeile");

pub const OPERATING_FIELD: Text = Text::of("Operating field", "OP-Feld");
pub const SHOW: Text = Text::of("Show", "Zeigen");
pub const SHOW_HOVER: Text = Text::of("Choose what else is drawn in the view", "Wählen, was außerdem gezeichnet wird");
pub const CEILING: Text = Text::of("Force ceiling around the tip", "Höchstkraft um die Spitze");
pub const CEILING_HOVER: Text = Text::of(
    "The largest force that can reach the hand (N), drawn as a sphere around each tip, at the scale of the arrows",
    "Die größte Kraft, die die Hand erreichen kann (N), als Kugel um jede Spitze, im Maßstab der Pfeile",
);
pub const FRAMES: Text = Text::of("Coordinate frames", "Koordinatensysteme");
pub const FRAMES_HOVER: Text = Text::of(
    "World (the frame of all forces and positions), trocar (axes of the world), tip (z along the shaft, \
    away from the tissue) and endoscope (z towards the viewer). Axes are drawn 16 mm long.",
    "Welt (System aller Kräfte und Positionen), Trokar (Achsen der Welt), Spitze (z längs des Schafts, vom Gewebe weg) \
     und Endoskop (z zum Betrachter). Achsen sind 16 mm lang gezeichnet.",
);
pub const SHADOWS: Text = Text::of("Shadows on the board", "Schatten auf dem Brett");
pub const SHADOWS_HOVER: Text = Text::of(
    "Objects between the lamp and the board cast a shadow, which helps to judge height. On tissue the shafts \
     always cast shadows.",
    "Was zwischen Lampe und Brett steht, wirft Schatten: das hilft, Höhe einzuschätzen. Auf Gewebe werfen die Schäfte \
     immer Schatten.",
);
pub const DEPTH: Text = Text::of("Darker with distance", "Dunkler mit Abstand");
pub const DEPTH_HOVER: Text = Text::of(
    "More distant objects are darker, as with an endoscope whose light is at the lens. This helps to judge depth.",
    "Wie unter einem Endoskop mit Licht am Objektiv: Ferneres ist dunkler. Das hilft, Tiefe einzuschätzen.",
);
pub const ROBOT: Text = Text::of("Robot arm", "Roboterarm");
pub const ROBOT_HOVER: Text = Text::of(
    "The links of the arm, from its joint angles; the Endoscope view does not show them",
    "Die Glieder des Arms aus seinen Gelenkwinkeln; die Endoskopsicht zeigt sie nicht",
);
pub const ROUND: Text = Text::of("Round image in the Surgeon view", "Rundes Bild in der Ansicht Chirurg");
pub const ROUND_HOVER: Text = Text::of(
    "Shows the endoscope image as a disc with a dark rim",
    "Das Endoskopbild ist eine Scheibe mit dunklem Rand",
);
pub const FRAME_WORLD: Text = Text::of("World", "Welt");
pub const ENDOSCOPE: Text = Text::of("Endoscope", "Endoskop");
pub const TROCAR: Text = Text::of("Trocar", "Trokar");
pub const TIP: Text = Text::of("Tip", "Spitze");
pub const LEAD: Text = Text::of("Drive by mouse (M)", "Maussteuerung (M)");
pub const LEAD_END: Text = Text::of("Stop driving (M)", "Maus aus (M)");
pub const ARROW_MEASURED: Text = Text::of("Measured force", "Gemessene Kraft");
pub const ARROW_RENDERED: Text = Text::of("Rendered force", "Dargestellte Kraft");
pub const RESET_VIEW: Text = Text::of("Endoscope view", "Endoskopsicht");
pub const VIEW_HOVER: Text = Text::of(
    "Drag to turn, wheel to zoom, double-click to reset",
    "Ziehen dreht, Mausrad zoomt, Doppelklick setzt zurück",
);

pub fn lead_hover(has_jaws: bool, is_bimanual: bool) -> String {
    let jaws = if has_jaws { word("\nG: open or close the jaws", "\nG: Backen öffnen oder schließen") } else { "" };
    let other = match (is_bimanual, has_jaws) {
        (false, _) => "",
        (true, true) => word(". H: the other instrument", ". H: anderes Instrument"),
        (true, false) => word("\nH: the other instrument", "\nH: anderes Instrument"),
    };
    let again = if has_jaws { word(". N: start again", ". N: neu starten") } else { "" };
    text_format!(
        "Drag: move the instrument. Wheel, Page Up, Page Down: height. Arrow keys: small steps{jaws}{other}{again}",
        "Ziehen: Instrument bewegen. Mausrad, Bild auf, Bild ab: Höhe. Pfeiltasten: kleine Schritte{jaws}{other}{again}"
    )
}

/// Returns the hint of a view with a trial, after its hint about the camera.
pub fn with_restart(camera: &str) -> String {
    text_format!("{camera}. N: start the trial again", "{camera}. N: Versuch neu starten")
}

pub fn led(side: &str) -> String {
    text_format!("{side} (driven)", "{side} (gesteuert)")
}

pub fn not_drawn(problem: &str) -> String {
    text_format!(
        "This graphics driver cannot draw the 3-D view: {problem}",
        "Dieser Grafiktreiber kann die 3-D-Ansicht nicht zeichnen: „{problem}“"
    )
}

pub fn ceiling_sphere(ceiling_n: f32) -> String {
    text_format!("ceiling {ceiling_n:.1} N", "Höchstkraft {ceiling_n:.1} N")
}

pub fn ceiling_mark(ceiling_n: f64) -> String {
    text_format!("ceiling\n{ceiling_n:.0} N", "max.\n{ceiling_n:.0} N")
}

/// Returns the suffix that names the side of a rig with two arms.
pub fn of_hand(side: &str) -> String {
    text_format!(" of the {side} hand", " (Hand {side})")
}

/// Returns the position in the base frame, mm.
pub fn place([x, y, z]: [f32; 3]) -> String {
    text_format!("x {x:.1}, y {y:.1}, z {z:.1} mm (world)", "x {x:.1}, y {y:.1}, z {z:.1} mm (Welt)")
}

pub fn tissue(place: &str) -> String {
    text_format!("Tissue at {place}", "Gewebe bei {place}")
}

/// Returns the hover text of an arrow; the force in N, `whose` from [`of_hand`].
pub fn arrow(name: &str, whose: &str, size_n: f32, [x, y, z]: [f32; 3]) -> String {
    text_format!(
        "{name}{whose}: {size_n:.2} N\nx {x:+.2}, y {y:+.2}, z {z:+.2} N (world)",
        "{name}{whose}: {size_n:.2} N\nx {x:+.2}, y {y:+.2}, z {z:+.2} N (Welt)"
    )
}

pub fn depth(depth_mm: f32) -> String {
    text_format!("\n{depth_mm:.1} mm below the surface at rest", "\n{depth_mm:.1} mm unter der Ruheoberfläche")
}

/// Returns the hover text of the tip; `depth` from [`depth`].
pub fn tip(whose: &str, place: &str, depth: &str) -> String {
    text_format!("Tip{whose} at {place}{depth}", "Spitze{whose} bei {place}{depth}")
}

pub fn target(number: usize, whose: &str, place: &str) -> String {
    text_format!("Target {number}{whose} at {place}", "Ziel {number}{whose} bei {place}")
}

pub fn trocar(whose: &str, place: &str) -> String {
    text_format!(
        "Trocar{whose}, the remote centre of motion, at {place}",
        "Trokar{whose}, ferner Drehpunkt der Bewegung, bei {place}"
    )
}
