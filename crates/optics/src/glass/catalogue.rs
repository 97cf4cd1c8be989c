//! Materials by name, and the built-in ones.
//!
//! The data are facts that others have published; every material carries its source. Glasses come from the AGF catalogues of their
//! makers, everything else from the papers and books that `data/materials.yml` names. All of it was collected by the
//! refractiveindex.info database (M. N. Polyanskiy, Scientific Data 11, 94 (2024); public domain, CC0);
//! `data/make_catalogue.py` reduces its files to those that are compiled in.

use std::collections::HashMap;
use std::sync::OnceLock;

use super::{Glass, GlassError, read_agf, read_refractiveindex};

/// Materials that are found by name.
///
/// Names are compared without regard to case and to everything but letters and digits: `N-BK7`, `n bk7` and `NBK7` are one. A name
/// that several makers use means the glass that was added last; with its maker before it, as in `Hoya F2`, it means just one.
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

    /// The built-in catalogue; it is read once, when first asked for.
    pub fn built_in() -> &'static Catalogue {
        static BUILT_IN: OnceLock<Catalogue> = OnceLock::new();
        BUILT_IN.get_or_init(read_built_in)
    }

    /// Adds materials. Their names take precedence over those that are there.
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
    /// Nothing has this name; the error tells the names most like it.
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

    /// The names of the materials that differ least from a key, at most three of them.
    fn suggestions(&self, wanted: &str) -> Vec<String> {
        let unlike = |known: &String| Unlikeness::between(wanted, known);
        let mut near: Vec<(Unlikeness, &str)> =
            self.by_name.iter().map(|(known, &place)| (unlike(known), self.glasses[place].name())).collect();
        near.sort_unstable();
        let least = near.first().map_or(0, |(unlikeness, _)| unlikeness.edits);
        let length = wanted.chars().count();
        let alike = least < length && least <= 1 + length / 4;
        near.retain(|(unlikeness, _)| alike && unlikeness.edits == least);
        let mut names: Vec<String> = Vec::new();
        for (_, name) in near {
            if names.len() < 3 && !names.iter().any(|known| known == name) {
                names.push(name.to_owned());
            }
        }
        names
    }
}

/// How much two names differ: by edits first; of equal ones those come first that share most pairs of letters (BK7 means N-BK7
/// rather than K7).
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Unlikeness {
    edits: usize,
    /// Per mille of the pairs of letters (Sørensen, Dice).
    unshared: u32,
}

impl Unlikeness {
    fn between(wanted: &str, known: &str) -> Unlikeness {
        Unlikeness {
            edits: strsim::damerau_levenshtein(wanted, known),
            unshared: (1000.0 * (1.0 - strsim::sorensen_dice(wanted, known))) as u32,
        }
    }
}

/// The catalogues of makers, the one whose names take precedence last.
const MAKERS: [(&str, &str); 4] = [
    ("CDGM", include_str!("../../data/cdgm.agf")),
    ("Hoya", include_str!("../../data/hoya.agf")),
    ("Ohara", include_str!("../../data/ohara.agf")),
    ("Schott", include_str!("../../data/schott.agf")),
];

const MATERIALS: &str = include_str!("../../data/materials.yml");

fn read_built_in() -> Catalogue {
    let mut catalogue = Catalogue::new();
    // a test holds these files to be free of problems
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
/// Nothing has this name; the error tells the names most like it.
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
    fn no_two_names_of_a_maker_are_one() {
        let mut names = HashMap::new();
        for glass in glasses() {
            for name in glass.aliases().iter().map(String::as_str).chain([glass.name()]) {
                let other = names.insert(key(&format!("{} {name}", glass.maker())), glass.name());
                assert_eq!(other, None, "{name}");
            }
        }
    }
}
