//! Reader of `[optics.medium]`: the materials of the media of a model.

use super::gradient;
use super::values::entries;
use crate::element::Material;
use crate::glass::line_nm;
use crate::medium::Medium;
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Datum, Diagnostic, Document, Scene, Span, Spanned};

/// The material of the regions of a medium, or an ideal mirror.
#[derive(Clone, Debug)]
pub(super) enum RegionMaterial {
    /// Reflects all light.
    Mirror,
    Material(Material),
}

/// The media of a scene, indexed by their numbers; `None` for an invalid medium, whose problem has
/// been reported.
pub(super) struct Media(Vec<Option<RegionMaterial>>);

impl Media {
    pub(super) fn of(&self, number: u32) -> Option<&RegionMaterial> {
        self.0.get(number as usize)?.as_ref()
    }

    /// The medium of the world.
    pub(super) fn world(&self) -> Option<Medium> {
        self.dispersive_of(self.of(0)?).cloned()
    }

    /// All media with an index.
    pub(super) fn dispersive(&self) -> impl Iterator<Item = &Medium> {
        self.0.iter().flatten().filter_map(|material| self.dispersive_of(material))
    }

    fn dispersive_of<'s>(&self, material: &'s RegionMaterial) -> Option<&'s Medium> {
        match material {
            RegionMaterial::Material(Material::Transparent(medium) | Material::Metal(medium)) => Some(medium),
            _ => None,
        }
    }
}

pub(super) fn read(reader: &mut Reader, document: &Document, scene: &Scene, keys: &mut Keys) -> Media {
    let mut read: Vec<Option<Option<RegionMaterial>>> = vec![None; scene.media.len()];
    let span = keys.span();
    let table = keys.take("medium").map(|datum| (datum.span, entries(reader, "optics.medium", datum)));
    let (span, entries) = table.unwrap_or((span, Vec::new()));
    let names = scene.medium_names();
    for (name, datum) in entries {
        match names.iter().position(|own| *own == name.value) {
            Some(number) => read[number] = Some(material(reader, &name.value, datum, number == 0)),
            None => reader.unknown("medium", &name, &names),
        }
    }
    let is_used = |number: usize| scene.regions.iter().any(|region| region.medium as usize == number);
    let known = read.into_iter().enumerate().map(|(number, read)| match read {
        Some(material) => material,
        None if number == 0 || is_used(number) => medium_of_model(reader, document, scene, number, span),
        None => None,
    });
    Media(known.collect())
}

/// The medium of `[medium.NAME]`.
fn medium_of_model(
    reader: &mut Reader,
    document: &Document,
    scene: &Scene,
    number: usize,
    place: Span,
) -> Option<RegionMaterial> {
    let medium = &scene.media[number];
    if let Some(index) = medium.index {
        let made = Medium::constant(&medium.name, index, 0.0);
        return reader
            .accept(made, place)
            .map(|medium| RegionMaterial::Material(Material::Transparent(medium)));
    }
    if number == 0 {
        return Some(RegionMaterial::Material(Material::Transparent(Medium::vacuum())));
    }
    let uses = document.regions.iter().filter_map(|region| region.medium.as_ref());
    let place = uses.filter(|name| name.value == medium.name).map(|name| name.span).next().unwrap_or(place);
    let problem = Diagnostic::error(format!("the medium `{}` has no index", medium.name));
    let reason = "it is neither in [optics.medium] nor, with an `index`, in [medium]";
    reader.report(problem.why(reason), place);
    None
}

fn material(
    reader: &mut Reader,
    name: &str,
    datum: Spanned<Datum>,
    is_world: bool,
) -> Option<RegionMaterial> {
    let span = datum.span;
    let material = match &datum.value {
        Datum::Text(text) if text == "mirror" => Some(RegionMaterial::Mirror),
        Datum::Text(text) if text == "absorber" => Some(RegionMaterial::Material(Material::Opaque)),
        Datum::Text(text) => match Medium::glass(text) {
            Err(_) if reader.is_arithmetic(text) => constant(reader, name, datum),
            glass => reader.accept(glass, span).map(made),
        },
        Datum::Table(_) => described(reader, name, datum),
        Datum::Number(_) => constant(reader, name, datum),
        _ => {
            let wanted =
                "a material of the catalogue, an index, { n = .., k = .. }, \"mirror\" or \"absorber\"";
            reader.wrong_type(name, &datum, wanted);
            None
        }
    }?;
    let is_opaque = !matches!(material, RegionMaterial::Material(Material::Transparent(_)));
    if is_world && is_opaque {
        let problem = Diagnostic::error("the medium of the world is opaque");
        reader.report(problem.why("all light starts and ends there"), span);
        return None;
    }
    Some(material)
}

fn constant(reader: &mut Reader, name: &str, datum: Spanned<Datum>) -> Option<RegionMaterial> {
    let span = datum.span;
    let index = reader.number(name, datum)?;
    reader.accept(Medium::constant(name, index, 0.0), span).map(made)
}

/// An index or a glass, with an optional gradient.
fn described(reader: &mut Reader, name: &str, datum: Spanned<Datum>) -> Option<RegionMaterial> {
    let mut keys = reader.keys(name, datum)?;
    let base = match keys.take("glass") {
        Some(datum) => {
            let glass = reader.text("glass", datum)?;
            reader.accept(Medium::glass(&glass.value), glass.span)
        }
        None => complex(reader, name, &mut keys),
    };
    let gradient = match keys.take("gradient") {
        Some(datum) => Some(gradient::read(reader, datum, &mut keys)?),
        None => None,
    };
    reader.reject_unknown(keys);
    let base = base?;
    Some(match gradient {
        Some(gradient) => RegionMaterial::Material(Material::Transparent(base.graded(gradient))),
        None => made(base),
    })
}

fn complex(reader: &mut Reader, name: &str, keys: &mut Keys) -> Option<Medium> {
    let span = keys.span();
    let n = reader.need(keys, "n").and_then(|datum| reader.number("n", datum));
    let k = match keys.take("k") {
        Some(datum) => reader.number("k", datum),
        None => Some(0.0),
    };
    reader.accept(Medium::constant(name, n?, k?), span)
}

/// The material of a medium: a metal if its extinction coefficient is above a tenth of its index in
/// yellow light, or in the middle of its range, so that it absorbs light within a wavelength.
fn made(medium: Medium) -> RegionMaterial {
    let [from, to] = medium.range_nm();
    let yellow = line_nm("d").unwrap_or(587.561_8);
    let index = match (from..=to).contains(&yellow) {
        true => medium.index(yellow),
        false => medium.index(0.5 * (from + to)),
    };
    let is_metal = index.im > 0.1 * index.re;
    RegionMaterial::Material(if is_metal { Material::Metal(medium) } else { Material::Transparent(medium) })
}
