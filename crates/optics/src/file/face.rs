//! Reader of `[optics.face]`: the regions of a model as elements, with the finishes of their faces.

use super::medium::{Media, RegionMaterial};
use super::values::{Choice, entries, fraction, list, word_or_keyed};
use crate::component::with_prefix;
use crate::element::{Element, Finish, Material};
use crate::interface::Film;
use rayweave_model::Program;
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Datum, Diagnostic, Scene, SceneRegion, Spanned};

/// A finish of a region, or of a face of it.
struct Entry {
    key: Spanned<String>,
    region: usize,
    /// The part of the key after the name of the region.
    face: Option<String>,
    finish: Finish,
}

/// The elements of the regions with valid media.
pub(super) fn read(reader: &mut Reader, scene: &Scene, media: &Media, keys: &mut Keys) -> Vec<Element> {
    let table = keys.take("face").map(|datum| entries(reader, "optics.face", datum)).unwrap_or_default();
    let mut finishes: Vec<Entry> =
        table.into_iter().filter_map(|(key, datum)| entry(reader, scene, key, datum)).collect();
    // later entries have precedence, and longer keys are more specific
    finishes.sort_by_key(|entry| entry.key.value.len());
    let mut elements = Vec::new();
    for (number, region) in scene.regions.iter().enumerate() {
        let own: Vec<&Entry> = finishes.iter().filter(|entry| entry.region == number).collect();
        // report unknown faces even where the medium is invalid
        let faces = faces(reader, region, &own);
        let plain = element(region, media);
        elements.extend(plain.map(|element| faces.into_iter().fold(element, with_finish)));
    }
    elements
}

/// The element with a finish, on one face or on all faces without one of their own.
fn with_finish(element: Element, (face, finish): (Option<String>, Finish)) -> Element {
    match face {
        Some(face) => element.face(&face, finish),
        None => element.finish(finish),
    }
}

fn element(region: &SceneRegion, media: &Media) -> Option<Element> {
    let (name, solid) = (&region.name, region.solid.clone());
    Some(match media.of(region.medium)? {
        RegionMaterial::Mirror => Element::mirror(name, solid),
        RegionMaterial::Material(material) => Element::new(name, solid, Material::clone(material)),
    })
}

/// An entry: the region with the longest name that is a prefix of the key, and the finish.
fn entry(reader: &mut Reader, scene: &Scene, key: Spanned<String>, datum: Spanned<Datum>) -> Option<Entry> {
    let finish = read_finish(reader, datum);
    let rest = |region: &SceneRegion| match key.value.strip_prefix(&region.name)? {
        "" => Some(None),
        rest => rest.strip_prefix('.').map(|face| Some(face.to_owned())),
    };
    let regions = scene.regions.iter().enumerate();
    let found = regions.filter_map(|(number, region)| Some((number, region.name.len(), rest(region)?)));
    let Some((region, _, face)) = found.max_by_key(|(_, length, _)| *length) else {
        let names: Vec<&str> = scene.regions.iter().map(|region| region.name.as_str()).collect();
        let first = key.value.split('.').next().unwrap_or_default().to_owned();
        reader.unknown("region", &Spanned::new(first, key.span), &names);
        return None;
    };
    Some(Entry { finish: finish?, key, region, face })
}

/// The finishes of a region by the full names of its faces.
fn faces(reader: &mut Reader, region: &SceneRegion, own: &[&Entry]) -> Vec<(Option<String>, Finish)> {
    let Some(first) = own.iter().find(|entry| entry.face.is_some()) else {
        return own.iter().map(|entry| (None, entry.finish.clone())).collect();
    };
    let program = Program::compile(&with_prefix(&region.solid, &region.name));
    let Some(program) = reader.accept(program, first.key.span) else { return Vec::new() };
    let mut names: Vec<String> = program.face_names().collect();
    names.dedup();
    own.iter().flat_map(|entry| called(reader, entry, &names)).collect()
}

/// The faces of an entry.
fn called(reader: &mut Reader, entry: &Entry, names: &[String]) -> Vec<(Option<String>, Finish)> {
    let Some(face) = &entry.face else { return vec![(None, entry.finish.clone())] };
    let rest = |name: &str| name.strip_prefix(entry.key.value.as_str()).map(str::to_owned);
    let begins = |name: &str| rest(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    let is_called = |name: &&String| begins(name) || name.split('.').any(|part| part == face);
    let found: Vec<&String> = names.iter().filter(is_called).collect();
    if found.is_empty() {
        reader.unknown("face", &entry.key, &beginnings(names, &entry.key.value));
    }
    found.into_iter().map(|name| (Some(name.clone()), entry.finish.clone())).collect()
}

/// The distinct prefixes of face names with as many parts as a key.
fn beginnings<'n>(names: &'n [String], key: &str) -> Vec<&'n str> {
    let dots = key.matches('.').count();
    let end = |name: &str| name.match_indices('.').nth(dots).map_or(name.len(), |(place, _)| place);
    let mut known: Vec<&str> = names.iter().map(|name| &name[..end(name)]).collect();
    known.dedup();
    known
}

fn read_finish(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Finish> {
    let words = ["polished", "absorber"];
    let keys = ["mirror", "splitter", "diffuse", "rough", "coated"];
    let (key, datum) = match word_or_keyed(reader, "finish", datum, &words, &keys)? {
        Choice::Word(word) if word.value == "polished" => return Some(Finish::Polished),
        Choice::Word(_) => return Some(Finish::Absorber),
        Choice::Keyed(key, datum) => (key.value, datum),
    };
    Some(match key.as_str() {
        "mirror" => Finish::Mirror { reflectance: fraction(reader, "mirror", datum)? },
        "splitter" => Finish::Splitter { reflectance: fraction(reader, "splitter", datum)? },
        "diffuse" => Finish::Diffuse { reflectance: fraction(reader, "diffuse", datum)? },
        "rough" => {
            let holds = |slope: f64| slope >= 0.0 && slope.is_finite();
            Finish::Rough { slope: reader.checked("rough", datum, "finite and at least 0", holds)? }
        }
        _ => Finish::Coated(films(reader, datum)?),
    })
}

fn films(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Vec<Film>> {
    let films = list(reader, "coated", datum, "a list of films, such as [[1.38, 0, 99.6]]")?;
    let films: Vec<_> = films.into_iter().map(|item| film(reader, item)).collect();
    films.into_iter().collect()
}

/// The index, the extinction and the thickness in nanometres.
fn film(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Film> {
    let span = datum.span;
    let [n, k, thickness_nm] = reader.numbers("coated", datum)?;
    let is_film =
        n > 0.0 && k >= 0.0 && thickness_nm >= 0.0 && [n, k, thickness_nm].iter().all(|x| x.is_finite());
    if !is_film {
        let problem = Diagnostic::error(format!("the film is [{n}, {k}, {thickness_nm}]"));
        let reason = "n must be greater than 0, k and the thickness in nm at least 0, all finite";
        reader.report(problem.why(reason), span);
    }
    is_film.then(|| Film::new(n, k, thickness_nm))
}
