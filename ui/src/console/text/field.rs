//! The 3-D view of the operating field.

pub(in crate::console) const OPERATING_FIELD: &str = "Operating field";
pub(in crate::console) const SHOW: &str = "Show";
pub(in crate::console) const SHOW_HOVER: &str = "Choose what else is drawn in the view";
pub(in crate::console) const CEILING: &str = "Force ceiling around the tip";
pub(in crate::console) const CEILING_HOVER: &str =
    "The largest force that can reach the hand (N), drawn as a sphere around each tip, at the scale of the arrows";
pub(in crate::console) const FRAMES: &str = "Coordinate frames";
pub(in crate::console) const FRAMES_HOVER: &str = "World (the frame of all forces and positions), trocar (axes of the world), tip (z along the shaft, \
    away from the tissue) and endoscope (z towards the viewer). Axes are drawn 16 mm long.";
pub(in crate::console) const SHADOWS: &str = "Shadows on the board";
pub(in crate::console) const SHADOWS_HOVER: &str = "What stands between the lamp and the board throws a shadow: it helps to judge height. On tissue the shafts always throw theirs.";
pub(in crate::console) const DEPTH: &str = "Darker with distance";
pub(in crate::console) const DEPTH_HOVER: &str =
    "As under an endoscope, whose light is at the lens: what is farther away is darker. It helps to judge depth.";
pub(in crate::console) const ROUND: &str = "Round picture in the surgeon's view";
pub(in crate::console) const ROUND_HOVER: &str = "The endoscope's picture is a disc with a dark rim";
pub(in crate::console) const FRAME_WORLD: &str = "World";
pub(in crate::console) const ENDOSCOPE: &str = "Endoscope";
pub(in crate::console) const TROCAR: &str = "Trocar";
pub(in crate::console) const TIP: &str = "Tip";
pub(in crate::console) const LEAD: &str = "Drive by mouse (M)";
pub(in crate::console) const LEAD_END: &str = "Let go (M)";
pub(in crate::console) const ARROW_MEASURED: &str = "Measured force";
pub(in crate::console) const ARROW_RENDERED: &str = "Rendered force";
pub(in crate::console) const RESET_VIEW: &str = "Endoscope view";
pub(in crate::console) const VIEW_HOVER: &str = "Drag to turn, wheel to zoom, double-click to reset";

/// How the instrument is led.
pub(in crate::console) fn lead_hover(has_jaws: bool, is_bimanual: bool) -> String {
    let jaws = if has_jaws { "\nG: open or close the jaws" } else { "" };
    let other = match (is_bimanual, has_jaws) {
        (false, _) => "",
        (true, true) => ". H: the other instrument",
        (true, false) => "\nH: the other instrument",
    };
    format!("Drag: move the instrument. Wheel, Page Up, Page Down: height. Arrow keys: small steps{jaws}{other}")
}

/// Name of the hand whose instrument is led.
pub(in crate::console) fn led(side: &str) -> String {
    format!("{side} (led)")
}

/// The view cannot be drawn.
pub(in crate::console) fn not_drawn(problem: &str) -> String {
    format!("This graphics driver cannot draw the 3-D view: {problem}")
}

/// Label of the sphere of the force ceiling.
pub(in crate::console) fn ceiling_sphere(ceiling_n: f32) -> String {
    format!("ceiling {ceiling_n:.1} N")
}

/// Label of the ceiling's mark on the gauges.
pub(in crate::console) fn ceiling_mark(ceiling_n: f64) -> String {
    format!("ceiling\n{ceiling_n:.0} N")
}

/// Addition for the side, if there are two arms.
pub(in crate::console) fn of_hand(side: &str) -> String {
    format!(" of the {side} hand")
}

/// A position in the base's frame, mm.
pub(in crate::console) fn place([x, y, z]: [f32; 3]) -> String {
    format!("x {x:.1}, y {y:.1}, z {z:.1} mm (world)")
}

/// Hover text of the tissue.
pub(in crate::console) fn tissue(place: &str) -> String {
    format!("Tissue at {place}")
}

/// Hover text of an arrow; the force in N, `whose` from [`of_hand`].
pub(in crate::console) fn arrow(name: &str, whose: &str, size_n: f32, [x, y, z]: [f32; 3]) -> String {
    format!("{name}{whose}: {size_n:.2} N\nx {x:+.2}, y {y:+.2}, z {z:+.2} N (world)")
}

/// Depth of the tip in the tissue.
pub(in crate::console) fn depth(depth_mm: f32) -> String {
    format!("\n{depth_mm:.1} mm below the surface at rest")
}

/// Hover text of the tip; `depth` from [`depth`].
pub(in crate::console) fn tip(whose: &str, place: &str, depth: &str) -> String {
    format!("Tip{whose} at {place}{depth}")
}

/// Hover text of a target.
pub(in crate::console) fn target(number: usize, whose: &str, place: &str) -> String {
    format!("Target {number}{whose} at {place}")
}

/// Hover text of the trocar.
pub(in crate::console) fn trocar(whose: &str, place: &str) -> String {
    format!("Trocar{whose}, the remote centre of motion, at {place}")
}
