//! Mapping of a file's columns to quantities: `--map x=px_mm*0.001`, or of three at once: `--map xyz=px_mm,py_mm,pz_mm*0.001`.

use std::collections::BTreeMap;

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ColumnMappingError {
    #[error("--map {text}: this is not NAME=COLUMN or NAME=COLUMN*SCALE; write, for example, x=px_mm*0.001")]
    Form { text: String },
    #[error("--map {text}: there is no quantity \"{name}\"; use one of {known}")]
    Name { text: String, name: String, known: String },
    #[error("--map {text}: \"{name}\" takes {wanted} columns, not {found}; write, for example, {name}=A,B,C*0.001")]
    Several { text: String, name: String, wanted: usize, found: usize },
    #[error("--map {text}: the scale \"{scale}\" must be a number other than zero, such as 0.001")]
    Scale { text: String, scale: String },
    #[error("--map {text}: \"{name}\" is mapped twice; map each quantity once")]
    Twice { text: String, name: String },
}

/// A column and the factor that turns its numbers into SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnSource {
    column: String,
    scale: f64,
}

impl ColumnSource {
    pub(super) fn plain(column: &str) -> Self {
        Self { column: column.to_owned(), scale: 1.0 }
    }

    pub fn column(&self) -> &str {
        &self.column
    }

    /// Returns the factor to SI units.
    pub const fn scale(&self) -> f64 {
        self.scale
    }
}

/// Maps quantities (`x_m`, `fx_n`, `lx_m`, `t_s`, ...) to columns. A quantity that is not mapped has the column of its
/// own name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnMapping {
    sources: BTreeMap<&'static str, ColumnSource>,
}

/// The quantities of a kind of file.
#[derive(Debug)]
pub struct Quantities {
    /// Short and full name of each.
    each: &'static [(&'static str, &'static str)],
    /// Names of several together.
    groups: &'static [(&'static str, &'static [&'static str])],
}

/// Motion and force over time; names with `l` are the leader's motion.
pub(super) const MOTION: Quantities = Quantities {
    each: &[
        ("t", "t_s"),
        ("x", "x_m"),
        ("y", "y_m"),
        ("z", "z_m"),
        ("fx", "fx_n"),
        ("fy", "fy_n"),
        ("fz", "fz_n"),
        ("lx", "lx_m"),
        ("ly", "ly_m"),
        ("lz", "lz_m"),
    ],
    groups: &[
        ("xyz", &["x_m", "y_m", "z_m"]),
        ("fxyz", &["fx_n", "fy_n", "fz_n"]),
        ("lxyz", &["lx_m", "ly_m", "lz_m"]),
    ],
};

/// Still poses of a tool.
pub const POSES: Quantities = Quantities {
    each: &[
        ("fx", "fx_n"),
        ("fy", "fy_n"),
        ("fz", "fz_n"),
        ("tx", "tx_nm"),
        ("ty", "ty_nm"),
        ("tz", "tz_nm"),
        ("ax", "ax"),
        ("ay", "ay"),
        ("az", "az"),
        ("qw", "qw"),
        ("qx", "qx"),
        ("qy", "qy"),
        ("qz", "qz"),
        ("roll", "roll_deg"),
        ("pitch", "pitch_deg"),
        ("yaw", "yaw_deg"),
        ("rx", "rx_rad"),
        ("ry", "ry_rad"),
        ("rz", "rz_rad"),
    ],
    groups: &[
        ("fxyz", &["fx_n", "fy_n", "fz_n"]),
        ("txyz", &["tx_nm", "ty_nm", "tz_nm"]),
        ("axyz", &["ax", "ay", "az"]),
        ("qwxyz", &["qw", "qx", "qy", "qz"]),
        ("qxyzw", &["qx", "qy", "qz", "qw"]),
        ("rpy", &["roll_deg", "pitch_deg", "yaw_deg"]),
        ("rxyz", &["rx_rad", "ry_rad", "rz_rad"]),
    ],
};

/// Pairs of forces.
pub const PAIRS: Quantities = Quantities {
    each: &[
        ("f1x", "f1x_n"),
        ("f1y", "f1y_n"),
        ("f1z", "f1z_n"),
        ("f2x", "f2x_n"),
        ("f2y", "f2y_n"),
        ("f2z", "f2z_n"),
        ("qw", "qw"),
        ("qx", "qx"),
        ("qy", "qy"),
        ("qz", "qz"),
        ("roll", "roll_deg"),
        ("pitch", "pitch_deg"),
        ("yaw", "yaw_deg"),
        ("rx", "rx_rad"),
        ("ry", "ry_rad"),
        ("rz", "rz_rad"),
    ],
    groups: &[
        ("f1xyz", &["f1x_n", "f1y_n", "f1z_n"]),
        ("f2xyz", &["f2x_n", "f2y_n", "f2z_n"]),
        ("qwxyz", &["qw", "qx", "qy", "qz"]),
        ("qxyzw", &["qx", "qy", "qz", "qw"]),
        ("rpy", &["roll_deg", "pitch_deg", "yaw_deg"]),
        ("rxyz", &["rx_rad", "ry_rad", "rz_rad"]),
    ],
};

impl Quantities {
    /// Returns the full names of the quantities that a name on the command line selects; empty for an unknown name.
    fn of(&self, name: &str) -> Vec<&'static str> {
        let one = self.each.iter().find(|(short, full)| *short == name || *full == name).map(|(_, full)| vec![*full]);
        let several = || self.groups.iter().find(|(group, _)| *group == name).map(|(_, all)| all.to_vec());
        one.or_else(several).unwrap_or_default()
    }

    /// Returns the names for a message.
    fn words(&self) -> String {
        let names = self.each.iter().map(|(short, _)| *short);
        let groups = self.groups.iter().map(|(group, _)| *group);
        names.chain(groups).collect::<Vec<_>>().join(", ")
    }
}

impl ColumnMapping {
    /// Parses texts for a recording of motion and force; see [`parse_for`](Self::parse_for).
    ///
    /// # Errors
    /// The errors of [`parse_for`](Self::parse_for).
    ///
    /// ```
    /// use nima_recording::csv::ColumnMapping;
    ///
    /// let mapping = ColumnMapping::parse(&["x=angle", "fx=torque*-1"])?;
    /// assert_eq!(mapping.source("x_m").column(), "angle");
    /// assert_eq!(mapping.source("t_s").column(), "t_s", "what is not mapped keeps its name");
    /// assert!(ColumnMapping::parse(&["height=z"]).is_err());
    /// # Ok::<(), nima_recording::csv::ColumnMappingError>(())
    /// ```
    pub fn parse(texts: &[impl AsRef<str>]) -> Result<Self, ColumnMappingError> {
        Self::parse_for(&MOTION, texts)
    }

    /// Parses any number of texts `NAME=COLUMN[*SCALE]`, or `xyz=A,B,C[*SCALE]` with one scale for all three.
    ///
    /// # Errors
    /// [`ColumnMappingError`] for a text of another form, a quantity that does not exist or is mapped twice, another
    /// number of columns than needed, or a scale that is zero or not finite.
    pub fn parse_for(known: &Quantities, texts: &[impl AsRef<str>]) -> Result<Self, ColumnMappingError> {
        let mut sources = BTreeMap::new();
        for text in texts.iter().map(AsRef::as_ref) {
            let owned = || text.to_owned();
            let (name, source) = text.split_once('=').ok_or_else(|| ColumnMappingError::Form { text: owned() })?;
            let name = name.trim();
            let source = source.trim();
            let names = known.of(name);
            if names.is_empty() {
                return Err(ColumnMappingError::Name { text: owned(), name: name.to_owned(), known: known.words() });
            }
            let (columns, scale) = match source.rsplit_once('*') {
                None => (source, 1.0),
                Some((column, factor)) => {
                    let wrong = || ColumnMappingError::Scale { text: owned(), scale: factor.to_owned() };
                    let scale: f64 = factor.trim().parse().map_err(|_| wrong())?;
                    if !scale.is_finite() || scale == 0.0 {
                        return Err(wrong());
                    }
                    (column.trim(), scale)
                }
            };
            let columns: Vec<&str> =
                if names.len() == 1 { vec![columns] } else { columns.split(',').map(str::trim).collect() };
            if columns.len() != names.len() {
                return Err(ColumnMappingError::Several {
                    text: owned(),
                    name: name.to_owned(),
                    wanted: names.len(),
                    found: columns.len(),
                });
            }
            if columns.iter().any(|column| column.is_empty()) {
                return Err(ColumnMappingError::Form { text: owned() });
            }
            for (full, column) in names.into_iter().zip(columns) {
                if sources.insert(full, ColumnSource { column: column.to_owned(), scale }).is_some() {
                    return Err(ColumnMappingError::Twice { text: owned(), name: name.to_owned() });
                }
            }
        }
        Ok(Self { sources })
    }

    pub fn names(&self, quantity: &str) -> bool {
        self.sources.contains_key(quantity)
    }

    /// Returns the mapped quantities by their full names, with their columns.
    pub fn sources(&self) -> impl Iterator<Item = (&'static str, &ColumnSource)> {
        self.sources.iter().map(|(quantity, source)| (*quantity, source))
    }

    pub fn names_leader(&self) -> bool {
        ["lx_m", "ly_m", "lz_m"].into_iter().any(|quantity| self.names(quantity))
    }

    pub fn source(&self, quantity: &str) -> ColumnSource {
        self.sources.get(quantity).cloned().unwrap_or_else(|| ColumnSource::plain(quantity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms() {
        let mapping = ColumnMapping::parse(&["x=pos_follower_rad", "fx_n = Fe * -2.5", "t=time"]).unwrap();
        assert_eq!(mapping.source("x_m"), ColumnSource { column: "pos_follower_rad".into(), scale: 1.0 });
        assert_eq!(mapping.source("fx_n"), ColumnSource { column: "Fe".into(), scale: -2.5 });
        assert_eq!(mapping.source("z_m").column(), "z_m");
    }

    #[test]
    fn three_axes_at_once_share_their_scale() {
        let mapping = ColumnMapping::parse(&["xyz=px_mm, py_mm,pz_mm*0.001", "fxyz=a,b,c", "lx=handle"]).unwrap();
        assert_eq!(mapping.source("y_m"), ColumnSource { column: "py_mm".into(), scale: 0.001 });
        assert_eq!(mapping.source("fz_n"), ColumnSource { column: "c".into(), scale: 1.0 });
        assert!(mapping.names_leader() && !ColumnMapping::parse(&["x=a"]).unwrap().names_leader());
        let error = |texts: &[&str]| ColumnMapping::parse(texts).unwrap_err();
        assert!(matches!(error(&["xyz=a,b"]), ColumnMappingError::Several { found: 2, .. }));
        assert!(matches!(error(&["lxyz=a,b,c,d"]), ColumnMappingError::Several { found: 4, .. }));
        assert!(matches!(error(&["xyz=a,,c"]), ColumnMappingError::Form { .. }));
        assert!(matches!(error(&["xyz=a,b,c", "y=d"]), ColumnMappingError::Twice { .. }));
    }

    #[test]
    fn nonsense_is_told_apart() {
        let error = |text: &str| ColumnMapping::parse(&[text]).unwrap_err();
        assert!(matches!(error("x"), ColumnMappingError::Form { .. }));
        assert!(matches!(error("x="), ColumnMappingError::Form { .. }));
        assert!(matches!(error("w=a"), ColumnMappingError::Name { .. }));
        assert!(matches!(error("x=a*zero"), ColumnMappingError::Scale { .. }));
        assert!(matches!(error("x=a*0"), ColumnMappingError::Scale { .. }));
        assert!(matches!(ColumnMapping::parse(&["x=a", "x_m=b"]).unwrap_err(), ColumnMappingError::Twice { .. }));
    }
}
