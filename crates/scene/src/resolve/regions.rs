//! Evaluation of regions and media.

use super::context::{Context, WORLD};
use super::numbers::Numbers;
use super::solids::Solids;
use crate::colour::Colour;
use crate::datum::{Datum, key};
use crate::diagnostic::Diagnostic;
use crate::document::RegionEntry;
use crate::number::Number;
use crate::scene::{Medium, SceneRegion};
use crate::source::{Span, Spanned};
use crate::suggestion::did_you_mean;
use std::collections::HashMap;

/// Builds the media, that of the world first, and the regions.
pub(super) fn build(
    context: &mut Context<'_>,
    numbers: &mut Numbers,
    solids: &Solids<'_>,
) -> (Vec<Medium>, Vec<SceneRegion>) {
    let mut media = Media::new(context, numbers);
    let document = context.document;
    if document.regions.is_empty() {
        let regions = implied(context, solids, &mut media);
        return (media.list, regions);
    }
    let mut regions = Vec::new();
    let mut seen = HashMap::new();
    for (number, entry) in document.regions.iter().enumerate() {
        let stated = entry.name.as_ref().unwrap_or(&entry.solid);
        if let Some(first) = seen.insert(stated.value.as_str(), stated.span) {
            let problem = Diagnostic::error(format!("there are two regions called `{}`", stated.value))
                .why("results refer to regions by name")
                .suggest(Some("give one of them a different `name`".to_owned()))
                .note(first, "the first one");
            context.push(problem, stated.span);
        }
        regions.extend(region(context, solids, &mut media, entry, number));
    }
    (media.list, regions)
}

/// One region.
fn region(
    context: &mut Context<'_>,
    solids: &Solids<'_>,
    media: &mut Media,
    entry: &RegionEntry,
    number: usize,
) -> Option<SceneRegion> {
    let found = solids.find(context, &entry.solid.value, entry.solid.span);
    let name = &entry.name.as_ref().unwrap_or(&entry.solid).value;
    let medium = match &entry.medium {
        None => {
            let span = entry.name.as_ref().unwrap_or(&entry.solid).span;
            own_medium(context, media, name, span)?
        }
        Some(medium) => match media.find(&medium.value) {
            Some(found) => found,
            None => {
                let problem = Diagnostic::error(format!("unknown medium `{}`", medium.value))
                    .why(format!("there is no [medium.{}]", key(&medium.value)))
                    .suggest(did_you_mean(&medium.value, media.index.keys().map(String::as_str)));
                context.push(problem, medium.span);
                return None;
            }
        },
    };
    let colour = entry.colour.as_ref().map(|colour| colour.value);
    Some(SceneRegion {
        name: name.clone(),
        solid: solids.built[found?].clone()?,
        medium,
        colour: colour.or(media.list[medium as usize].colour).unwrap_or(Colour::numbered(number)),
    })
}

/// The medium of a region that states none: it has the name of the region. Rejects the name of the medium around everything, which
/// would make the region part of its surroundings.
fn own_medium(context: &mut Context<'_>, media: &mut Media, name: &str, span: Span) -> Option<u32> {
    if name == WORLD {
        let problem = Diagnostic::error(format!("the region `{WORLD}` has no medium"))
            .why(format!("a region without `medium` has one of its own name, and `{WORLD}` is the medium around everything"))
            .suggest(Some("rename the solid, or state the `medium` of the region".to_owned()));
        context.push(problem, span);
        return None;
    }
    Some(media.find_or_add(name))
}

/// The regions of a document without `[[region]]`: each solid that no other solid uses, with its
/// own medium.
fn implied(context: &mut Context<'_>, solids: &Solids<'_>, media: &mut Media) -> Vec<SceneRegion> {
    let unused = solids.names.iter().zip(&solids.built).zip(&solids.used).filter(|(_, used)| !**used);
    let mut regions = Vec::new();
    for ((name, solid), _) in unused {
        let Some(solid) = solid.clone() else {
            continue;
        };
        let name = name.clone();
        let Some(medium) = own_medium(context, media, &name, solids.world.unwrap_or_default()) else {
            continue;
        };
        let colour = media.list[medium as usize].colour.unwrap_or(Colour::numbered(regions.len()));
        regions.push(SceneRegion { name, solid, medium, colour });
    }
    regions
}

/// Keys of media with numeric values: density in g/cm3, temperature in K and pressure in Pa. Other keys may have any value.
const PHYSICAL: [&str; 3] = ["density", "temperature", "pressure"];

/// The value of a physical quantity, a number or an arithmetic expression.
fn physical(context: &mut Context, numbers: &Numbers, key: &str, value: &Spanned<Datum>) -> Option<f64> {
    let number = match &value.value {
        Datum::Number(number) => Number::Value(*number),
        Datum::Text(text) => Number::Text(text.clone()),
        other => {
            let problem = Diagnostic::error(format!("`{key}` is {}", other.description()));
            context.push(problem.why("it must be a number or an arithmetic expression"), value.span);
            return None;
        }
    };
    let holds = |value: f64| value >= 0.0 && value.is_finite();
    let found = numbers.checked(
        context,
        &format!("`{key}`"),
        &Spanned::new(number, value.span),
        "finite and at least 0",
        holds,
    );
    if let Some(density) = found.filter(|&found| key == "density" && found > MAX_DENSITY) {
        let problem = Diagnostic::warning(format!("`density` is {density}"))
            .why("a density is in g/cm3, and that of osmium, the densest element, is 22.6")
            .suggest(Some(format!("Did you mean {}?", density / 1000.0)));
        context.push(problem, value.span);
    }
    found
}

/// The density above which there is a warning, in g/cm3: a value in kg/m3 is a thousand times too large.
const MAX_DENSITY: f64 = 25.0;

/// The media by number and by name.
struct Media {
    list: Vec<Medium>,
    index: HashMap<String, u32>,
}

impl Media {
    fn new(context: &mut Context, numbers: &Numbers) -> Media {
        let mut media = Media { list: Vec::new(), index: HashMap::new() };
        media.find_or_add(WORLD);
        for entry in &context.document.media {
            let number = media.find_or_add(&entry.name.value) as usize;
            let positive = |value: f64| value > 0.0 && value.is_finite();
            let index = entry.index.as_ref();
            let index = index.and_then(|index| {
                numbers.checked(context, "`index`", index, "finite and greater than 0", positive)
            });
            let others = entry.others.iter().filter_map(|(key, value)| {
                let number = match (PHYSICAL.contains(&key.value.as_str()), &value.value) {
                    (true, _) => physical(context, numbers, &key.value, value)?,
                    (false, Datum::Number(number)) => *number,
                    (false, _) => return None,
                };
                Some((key.value.clone(), number))
            });
            let others = others.collect();
            media.list[number] = Medium {
                name: entry.name.value.clone(),
                index,
                colour: entry.colour.as_ref().map(|colour| colour.value),
                numbers: others,
            };
        }
        media
    }

    fn find(&self, name: &str) -> Option<u32> {
        self.index.get(name).copied()
    }

    fn find_or_add(&mut self, name: &str) -> u32 {
        if let Some(number) = self.find(name) {
            return number;
        }
        let number = self.list.len() as u32;
        self.index.insert(name.to_owned(), number);
        self.list.push(Medium { name: name.to_owned(), ..Medium::default() });
        number
    }
}
