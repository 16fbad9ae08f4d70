//! Words of the room `field`.

pub(in crate::console) const OPERATING_FIELD: &str = "Operating field";
pub(in crate::console) const SHOW: &str = "Show";
pub(in crate::console) const SHOW_MEANING: &str = "What else is drawn into the view.";
pub(in crate::console) const CEILING: &str = "Ceiling around the tip";
pub(in crate::console) const CEILING_MEANING: &str =
    "The largest force that ever reaches the hand (N), as a sphere around each tip, to the scale of the arrows.";
pub(in crate::console) const FRAMES: &str = "Coordinate frames";
pub(in crate::console) const FRAMES_MEANING: &str = "Base (kbf, the frame of all forces and places), trocar (axes of the base), tip (z along the shaft away from \
                                  the tissue) and endoscope (z towards the viewer). Axes are 16 mm long.";
pub(in crate::console) const BASE_FRAME: &str = "Base (kbf)";
pub(in crate::console) const ENDOSCOPE: &str = "Endoscope";
pub(in crate::console) const TROCAR: &str = "Trocar";
pub(in crate::console) const TIP: &str = "Tip";
pub(in crate::console) const YOUR_TURN: &str = "Your turn (M)";
pub(in crate::console) const LET_IT_GO: &str = "Let it go (M)";
pub(in crate::console) const FORCE_MEASURED: &str = "Force measured";
pub(in crate::console) const FORCE_RENDERED: &str = "Force rendered";
pub(in crate::console) const AS_THE_ENDOSCOPE_SEES_IT: &str = "As the endoscope sees it";
pub(in crate::console) const HOW_TO_TURN: &str = "Drag to turn, wheel to zoom, double click to reset";
pub(in crate::console) const HOW_TO_LEAD: &str =
    "Drag to move the instrument, wheel or Page Up and Down for its height, arrow keys for small steps";

/// The view stays empty.
pub(in crate::console) fn not_drawn(problem: &str) -> String {
    format!("The 3-D view cannot be drawn by this graphics driver: {problem}")
}

/// At the sphere of the ceiling.
pub(in crate::console) fn ceiling_sphere(ceiling_n: f32) -> String {
    format!("ceiling {ceiling_n:.1} N")
}

/// At the mark of the gauges.
pub(in crate::console) fn ceiling_mark(ceiling_n: f64) -> String {
    format!("ceiling\n{ceiling_n:.0} N")
}

/// Of which hand, where there are two.
pub(in crate::console) fn of_hand(side: &str) -> String {
    format!(" of the {side} hand")
}

/// A place in the base's frame, mm.
pub(in crate::console) fn place([x, y, z]: [f32; 3]) -> String {
    format!("x {x:.1}, y {y:.1}, z {z:.1} mm (kbf)")
}

/// The tissue is pointed at.
pub(in crate::console) fn tissue(place: &str) -> String {
    format!("Tissue at {place}")
}

/// An arrow is pointed at; the force in N, `whose` as from [`of_hand`].
pub(in crate::console) fn arrow(name: &str, whose: &str, size_n: f32, [x, y, z]: [f32; 3]) -> String {
    format!("{name}{whose}: {size_n:.2} N\nx {x:+.2}, y {y:+.2}, z {z:+.2} N (kbf)")
}

/// How deep the tip is in the tissue.
pub(in crate::console) fn depth(depth_mm: f32) -> String {
    format!("\n{depth_mm:.1} mm below the surface at rest")
}

/// The tip is pointed at; `depth` as from [`depth`].
pub(in crate::console) fn tip(whose: &str, place: &str, depth: &str) -> String {
    format!("Tip{whose} at {place}{depth}")
}

/// A target is pointed at.
pub(in crate::console) fn target(number: usize, whose: &str, place: &str) -> String {
    format!("Target {number}{whose} at {place}")
}

/// The trocar is pointed at.
pub(in crate::console) fn trocar(whose: &str, place: &str) -> String {
    format!("Trocar{whose}, the remote centre of motion, at {place}")
}
