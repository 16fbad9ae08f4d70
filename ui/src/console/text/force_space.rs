//! Words of the room `force_space`.

pub(in crate::console) const MEANING: &str = "Both forces of the last six seconds in force space (N, axes of the workspace): a line each, a dot where they are now or \
                       where a trace points. The three rings are the ellipsoid that holds 95 % of the difference between rendered and \
                       measured, if it were normal, around the force measured now; how much it really holds stands below. The dashed \
                       circle is the ceiling. Drag to turn, double click to reset.";

/// What the canvas shows.
pub(in crate::console) fn canvas(words: &str) -> String {
    format!("Force space. {words}")
}

/// Before there is enough to work the ellipsoid out; two lines, parted by a semicolon.
pub(in crate::console) fn too_short(seconds: f64) -> String {
    format!("Last {seconds:.0} s; the error's ellipsoid needs a second of data")
}

/// The ellipsoid (mean and half axes in N, share that it holds in percent); two lines, parted by a semicolon.
pub(in crate::console) fn error(seconds: f64, mean_n: f64, [a, b, c]: [f64; 3], percent: f64) -> String {
    format!(
        "Error, last {seconds:.0} s: mean {mean_n:.2} N, 95 % half axes; {a:.2}, {b:.2}, {c:.2} N (holds {percent:.0} %)"
    )
}
