//! Catalogues of materials by name, and the built-in catalogue.
//!
//! The data are published facts; every material has its reference. Most glasses come from the
//! AGF catalogues of their makers; other materials, and some glasses, from the papers, books and data
//! sheets listed in `data/materials.yml`. All data were collected by the refractiveindex.info database (M. N.
//! Polyanskiy, Scientific Data 11, 94 (2024); public domain, CC0); `data/make_catalogue.py` reduces
//! its files to those that are compiled in.

use std::collections::HashMap;
use std::sync::OnceLock;

use super::{Glass, GlassError, read_agf, read_refractiveindex};

/// A catalogue of materials by name.
///
/// Names are compared by letters and digits only, without case: `N-BK7`, `n bk7` and `NBK7` are
/// equal. If several makers use a name, the glass added last has precedence; a name with its maker,
/// such as `Hoya F2`, is unique.
///
/// ```
/// use rayweave_optics::glass::{Catalogue, Dispersion, Glass};
/// # fn main() -> Result<(), rayweave_optics::glass::GlassError> {
/// let mut catalogue = Catalogue::built_in().clone();
/// catalogue.add([Glass::new("my oil", Dispersion::Constant(1.515))]);
/// assert_eq!(catalogue.get("My-Oil")?.index(500.0)?, 1.515);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default)]
pub struct Catalogue {
    glasses: Vec<Glass>,
    by_name: HashMap<String, usize>,
}

/// Only letters and digits, in lower case.
fn key(name: &str) -> String {
    name.chars().filter(|character| character.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

impl Catalogue {
    /// An empty catalogue.
    pub fn new() -> Catalogue {
        Catalogue::default()
    }

    /// The built-in catalogue; it is read once, at first use.
    pub fn built_in() -> &'static Catalogue {
        static BUILT_IN: OnceLock<Catalogue> = OnceLock::new();
        BUILT_IN.get_or_init(read_built_in)
    }

    /// Adds materials. Their names take precedence over earlier ones.
    pub fn add(&mut self, glasses: impl IntoIterator<Item = Glass>) {
        for glass in glasses {
            let place = self.glasses.len();
            for name in glass.aliases().iter().map(String::as_str).chain([glass.name()]) {
                self.by_name.insert(key(name), place);
                self.by_name.insert(key(&format!("{} {name}", glass.maker())), place);
            }
            self.glasses.push(glass);
        }
    }

    /// The materials, in the order in which they were added.
    pub fn glasses(&self) -> &[Glass] {
        &self.glasses
    }

    /// The material of this name.
    ///
    /// # Errors
    /// [`GlassError::Unknown`] for an unknown name, with the most similar names.
    pub fn get(&self, name: &str) -> Result<&Glass, GlassError> {
        match self.by_name.get(&key(name)) {
            Some(&place) => Ok(&self.glasses[place]),
            None => Err(GlassError::Unknown {
                name: name.to_owned(),
                count: self.glasses.len(),
                suggestions: self.suggestions(&key(name)),
            }),
        }
    }

    /// The names most similar to a key, at most three.
    fn suggestions(&self, wanted: &str) -> Vec<String> {
        let length = wanted.chars().count();
        // names are short codes: allow a quarter of the letters to differ, and one more
        let most_edits = (1 + length / 4).min(length.saturating_sub(1));
        let mut names: Vec<String> = Vec::new();
        for known in rayweave_error::closest(wanted, self.by_name.keys().map(String::as_str), |_| most_edits)
        {
            let name = self.by_name.get(known).map(|&place| self.glasses[place].name());
            if let Some(name) = name.filter(|name| names.len() < 3 && !names.iter().any(|own| own == name)) {
                names.push(name.to_owned());
            }
        }
        names
    }
}

/// The catalogues of makers, in the order of increasing precedence.
const MAKERS: [(&str, &str); 4] = [
    ("CDGM", include_str!("../../data/cdgm.agf")),
    ("Hoya", include_str!("../../data/hoya.agf")),
    ("Ohara", include_str!("../../data/ohara.agf")),
    ("Schott", include_str!("../../data/schott.agf")),
];

const MATERIALS: &str = include_str!("../../data/materials.yml");

fn read_built_in() -> Catalogue {
    let mut catalogue = Catalogue::new();
    // a test checks that these files have no problems
    for (maker, text) in MAKERS {
        catalogue.add(read_agf(text.as_bytes(), maker).unwrap_or_else(|error| error.into_readable()));
    }
    let materials = read_refractiveindex(MATERIALS, "");
    catalogue.add(materials.unwrap_or_else(|error| error.into_readable()));
    catalogue
}

/// The built-in material of this name: `glass("N-BK7")`, `glass("fused silica")`, `glass("gold")`.
///
/// # Errors
/// [`GlassError::Unknown`] for an unknown name, with the most similar names.
pub fn glass(name: &str) -> Result<Glass, GlassError> {
    Catalogue::built_in().get(name).cloned()
}

/// All built-in materials.
pub fn glasses() -> &'static [Glass] {
    Catalogue::built_in().glasses()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_files_have_no_problems() {
        for (maker, text) in MAKERS {
            assert_eq!(read_agf(text.as_bytes(), maker).map(|_| ()), Ok(()), "{maker}");
        }
        assert_eq!(read_refractiveindex(MATERIALS, "").map(|_| ()), Ok(()));
    }

    #[test]
    fn names_of_a_maker_are_distinct() {
        let mut names = HashMap::new();
        for glass in glasses() {
            for name in glass.aliases().iter().map(String::as_str).chain([glass.name()]) {
                let other = names.insert(key(&format!("{} {name}", glass.maker())), glass.name());
                assert_eq!(other, None, "{name}");
            }
        }
    }
}
