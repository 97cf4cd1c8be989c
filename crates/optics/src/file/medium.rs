//! What the media of a model are.

use super::gradient;
use crate::element::Material;
use crate::glass::line_nm;
use crate::medium::Medium;
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Datum, Diagnostic, Document, Scene, Span, Spanned};

/// What regions of a medium are made of.
#[derive(Clone, Debug)]
pub(super) enum Stuff {
    /// Reflects all light.
    Mirror,
    Made(Material),
}

/// The media of a scene by their numbers; `None` where there was a problem, which has been reported.
pub(super) struct Media(Vec<Option<Stuff>>);

impl Media {
    pub(super) fn of(&self, number: u32) -> Option<&Stuff> {
        self.0.get(number as usize)?.as_ref()
    }

    /// The medium around everything.
    pub(super) fn world(&self) -> Option<Medium> {
        self.dispersive_of(self.of(0)?).cloned()
    }

    /// All media with an index.
    pub(super) fn dispersive(&self) -> impl Iterator<Item = &Medium> {
        self.0.iter().flatten().filter_map(|stuff| self.dispersive_of(stuff))
    }

    fn dispersive_of<'s>(&self, stuff: &'s Stuff) -> Option<&'s Medium> {
        match stuff {
            Stuff::Made(Material::Transparent(medium) | Material::Metal(medium)) => Some(medium),
            _ => None,
        }
    }
}

pub(super) fn read(reader: &mut Reader, document: &Document, scene: &Scene, keys: &mut Keys) -> Media {
    let mut said: Vec<Option<Option<Stuff>>> = vec![None; scene.media.len()];
    let place = keys.span();
    let table = keys.take("medium").map(|datum| (datum.span, entries(reader, "optics.medium", datum)));
    let (place, entries) = table.unwrap_or((place, Vec::new()));
    let names = scene.medium_names();
    for (name, datum) in entries {
        match names.iter().position(|own| *own == name.value) {
            Some(number) => said[number] = Some(stuff(reader, &name.value, datum, number == 0)),
            None => reader.unknown("medium", &name, &names),
        }
    }
    let is_used = |number: usize| scene.regions.iter().any(|region| region.medium as usize == number);
    let known = said.into_iter().enumerate().map(|(number, said)| match said {
        Some(stuff) => stuff,
        None if number == 0 || is_used(number) => of_the_model(reader, document, scene, number, place),
        None => None,
    });
    Media(known.collect())
}

/// The entries of a table with names of its own.
pub(super) fn entries(
    reader: &mut Reader,
    what: &str,
    datum: Spanned<Datum>,
) -> Vec<(Spanned<String>, Spanned<Datum>)> {
    match datum.value {
        Datum::Table(table) => table,
        _ => {
            reader.wrong_type(what, &datum, "a table");
            Vec::new()
        }
    }
}

/// What `[medium.NAME]` says.
fn of_the_model(
    reader: &mut Reader,
    document: &Document,
    scene: &Scene,
    number: usize,
    place: Span,
) -> Option<Stuff> {
    let medium = &scene.media[number];
    if let Some(index) = medium.index {
        let made = Medium::constant(&medium.name, index, 0.0);
        return reader.accept(made, place).map(|medium| Stuff::Made(Material::Transparent(medium)));
    }
    if number == 0 {
        return Some(Stuff::Made(Material::Transparent(Medium::vacuum())));
    }
    let uses = document.regions.iter().filter_map(|region| region.medium.as_ref());
    let place = uses.filter(|name| name.value == medium.name).map(|name| name.span).next().unwrap_or(place);
    let problem = Diagnostic::error(format!("the medium `{}` has no index", medium.name));
    let reason = "it stands neither in [optics.medium] nor, with an `index`, in [medium]";
    reader.report(problem.why(reason).suggest(Some("which glass is it?".to_owned())), place);
    None
}

fn stuff(reader: &mut Reader, name: &str, datum: Spanned<Datum>, is_world: bool) -> Option<Stuff> {
    let span = datum.span;
    let stuff = match &datum.value {
        Datum::Text(text) if text == "mirror" => Some(Stuff::Mirror),
        Datum::Text(text) if text == "absorber" => Some(Stuff::Made(Material::Opaque)),
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
    let is_opaque = !matches!(stuff, Stuff::Made(Material::Transparent(_)));
    if is_world && is_opaque {
        let problem = Diagnostic::error("the medium of the world lets no light through");
        reader.report(problem.why("all light begins and ends there"), span);
        return None;
    }
    Some(stuff)
}

fn constant(reader: &mut Reader, name: &str, datum: Spanned<Datum>) -> Option<Stuff> {
    let span = datum.span;
    let index = reader.number(name, datum)?;
    reader.accept(Medium::constant(name, index, 0.0), span).map(made)
}

/// An index or a glass, with a gradient if one is given.
fn described(reader: &mut Reader, name: &str, datum: Spanned<Datum>) -> Option<Stuff> {
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
    reader.refuse_the_rest(keys);
    let base = base?;
    Some(match gradient {
        Some(gradient) => Stuff::Made(Material::Transparent(base.graded(gradient))),
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

/// Where hardly any light goes through a wavelength of it, it is a metal: an extinction above a tenth of the index in
/// yellow light, or in the middle of what is known of it.
fn made(medium: Medium) -> Stuff {
    let [from, to] = medium.range_nm();
    let yellow = line_nm("d").unwrap_or(587.561_8);
    let index = match (from..=to).contains(&yellow) {
        true => medium.index(yellow),
        false => medium.index(0.5 * (from + to)),
    };
    let is_metal = index.im > 0.1 * index.re;
    Stuff::Made(if is_metal { Material::Metal(medium) } else { Material::Transparent(medium) })
}
