//! Mapping of a file's columns to quantities: `--map x=px_mm*0.001`, or of three at once: `--map xyz=px_mm,py_mm,pz_mm*0.001`.

use std::collections::BTreeMap;

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ColumnMappingError {
    #[error("--map {text}: not of the form NAME=COLUMN or NAME=COLUMN*SCALE; write for example x=px_mm*0.001")]
    Form { text: String },
    #[error(
        "--map {text}: there is no quantity \"{name}\"; use t, x, y, z, fx, fy, fz, lx, ly or lz (the leader's motion), or xyz, fxyz or lxyz with three columns"
    )]
    Name { text: String, name: String },
    #[error("--map {text}: \"{name}\" takes three columns, not {found}; write for example {name}=A,B,C*0.001")]
    Three { text: String, name: String, found: usize },
    #[error("--map {text}: the scale \"{scale}\" is not a number other than zero; write for example 0.001")]
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

/// Short and full name of every quantity; names with `l` are the leader's motion.
const QUANTITIES: [(&str, &str); 10] = [
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
];
/// Names of three quantities together.
const TRIPLES: [(&str, [&str; 3]); 3] =
    [("xyz", ["x_m", "y_m", "z_m"]), ("fxyz", ["fx_n", "fy_n", "fz_n"]), ("lxyz", ["lx_m", "ly_m", "lz_m"])];

/// Returns the full names of the quantities that a name on the command line selects; empty for an unknown name.
fn quantities(name: &str) -> Vec<&'static str> {
    let one = QUANTITIES.iter().find(|(short, full)| *short == name || *full == name).map(|(_, full)| vec![*full]);
    let three = || TRIPLES.iter().find(|(triple, _)| *triple == name).map(|(_, all)| all.to_vec());
    one.or_else(three).unwrap_or_default()
}

impl ColumnMapping {
    /// Parses any number of texts `NAME=COLUMN[*SCALE]`, or `xyz=A,B,C[*SCALE]` with one scale for all three.
    ///
    /// # Errors
    /// [`ColumnMappingError`] for a text of another form, a quantity that does not exist or is mapped twice, a number of
    /// columns other than three where three are needed, or a scale that is zero or not finite.
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
        let mut sources = BTreeMap::new();
        for text in texts.iter().map(AsRef::as_ref) {
            let owned = || text.to_owned();
            let (name, source) = text.split_once('=').ok_or_else(|| ColumnMappingError::Form { text: owned() })?;
            let name = name.trim();
            let source = source.trim();
            let names = quantities(name);
            if names.is_empty() {
                return Err(ColumnMappingError::Name { text: owned(), name: name.to_owned() });
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
                return Err(ColumnMappingError::Three { text: owned(), name: name.to_owned(), found: columns.len() });
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
        self.sources.get(quantity).cloned().unwrap_or_else(|| ColumnSource { column: quantity.to_owned(), scale: 1.0 })
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
        assert!(matches!(error(&["xyz=a,b"]), ColumnMappingError::Three { found: 2, .. }));
        assert!(matches!(error(&["lxyz=a,b,c,d"]), ColumnMappingError::Three { found: 4, .. }));
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
