//! A rule for skin surfaces that act where another volume begins: a volume without a skin behind the skin of its mother, or of a
//! volume beside it.

use super::state::Lint;
use super::volumes::listed;
use crate::detector::properties::Owner;
use crate::surface::OpticalSurface;
use rayweave_error::Message;
use rayweave_scene::Datum;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// A skin surface with its volume.
#[derive(Clone, Copy)]
struct Skin<'a> {
    name: &'a str,
    /// The number of the optical surface.
    surface: usize,
    volume: &'a str,
}

/// The parts of the file by the names of the volumes.
struct ByVolume<'a> {
    /// The skins: their names and surfaces.
    skins: HashMap<&'a str, (&'a str, &'a str)>,
    /// The rows of the volumes.
    rows: HashMap<&'a str, &'a Datum>,
}

/// The amount of light that passes a closed surface, in words.
fn how_much(surface: &OpticalSurface) -> &'static str {
    if surface.largest_transmittance() > 0.0 { "hardly any" } else { "no" }
}

/// The part of the light that passes a closed surface.
fn passes(surface: &OpticalSurface) -> String {
    match surface.largest_transmittance() {
        most if most > 0.0 => format!("the `TRANSMITTANCE` of `{}` is at most {most}", surface.name),
        _ => format!("nothing passes `{}`", surface.name),
    }
}

impl<'a> Lint<'a> {
    /// Opaque skins that act on volumes without a skin, as in Geant4: on daughters that light can enter or that contain sensors,
    /// and on sensors beside the volume and their windows.
    pub(super) fn closed_volumes(&mut self) {
        let table: &'a Datum = self.table;
        let rows = table.list("volume").map(|row| (row.text("name"), row)).collect();
        let by_volume = ByVolume { skins: self.skins(), rows };
        let mut found = Vec::new();
        for row in self.table.list("skin") {
            let name = row.text("name");
            let named = |own: &OpticalSurface| own.name == row.text("surface");
            let Some(surface) = self.optics.surfaces.iter().position(named) else { continue };
            // what passes between different materials passes between equal ones as well
            if !self.optics.surfaces[surface].is_nearly_opaque(false) {
                continue;
            }
            for volume in row.list("volume").filter_map(Datum::as_text) {
                // of several skins of a volume the first one counts
                if by_volume.skins.get(volume).is_none_or(|(first, _)| *first != name) {
                    continue;
                }
                let skin = Skin { name, surface, volume };
                let mut messages = self.closed_daughters(skin, &by_volume);
                messages.extend(self.closed_neighbours(skin, &by_volume));
                if messages.is_empty() {
                    messages.extend(self.closed_source(skin, &by_volume));
                }
                found.extend(messages.into_iter().map(|message| (Owner::new("skin", name), message)));
            }
        }
        found.into_iter().for_each(|(owner, message)| self.find(&owner, "", message));
    }

    /// Messages about the daughters of a volume that its skin closes.
    fn closed_daughters(&self, skin: Skin<'_>, by_volume: &ByVolume<'_>) -> Vec<Message> {
        let mut messages = Vec::new();
        for (daughter, placements) in self.daughters(skin.volume, by_volume) {
            if by_volume.skins.contains_key(daughter) || !self.is_closed(skin, daughter) {
                continue;
            }
            let open = self.borders_from(skin.volume);
            let closed: BTreeSet<&str> =
                placements.iter().copied().filter(|name| !open.contains(name)).collect();
            let has_sensor = self.contains_sensor(daughter, by_volume);
            if closed.is_empty() || !has_sensor && !self.is_clear_volume(daughter) {
                continue;
            }
            let (volume, paint) = (skin.volume, &self.optics.surfaces[skin.surface]);
            let (surface, passes) = (&paint.name, passes(paint));
            let which = match closed.len() == placements.len() || closed.contains("") {
                true => String::new(),
                false => format!(" at the placements {}", listed(closed.iter().copied())),
            };
            let sensor = if has_sensor { ", which contains a sensor" } else { "" };
            let problem = format!(
                "skin surface `{}` of volume `{volume}` lets {} light from it into its daughter `{daughter}`{sensor}",
                skin.name,
                how_much(paint)
            );
            let reason = format!(
                "`{daughter}` has no skin, so that the skin of its mother acts{which} as well, as in Geant4, and {passes}"
            );
            let advice = format!(
                "If only the outside of `{volume}` is meant, make `{surface}` the skin of a volume around `{volume}` instead, or give \
                 `{daughter}` a skin that is a bare interface (polished, dielectric_dielectric, without properties)."
            );
            messages.push(Message::new(problem, reason).suggest(advice));
        }
        messages
    }

    /// Messages about sensors beside a volume, and windows in front of sensors, which its skin closes.
    fn closed_neighbours(&self, skin: Skin<'_>, by_volume: &ByVolume<'_>) -> Vec<Message> {
        let front = self.regions_of(skin.volume);
        let nested = &self.optics.volumes.nested;
        let closed = self.contacts.iter().filter(|((before, after), surfaces)| {
            let is_beside = !nested.contains(&(*before, *after)) && !nested.contains(&(*after, *before));
            let only = surfaces.len() == 1 && surfaces.contains(&Some(skin.surface));
            front.contains(before) && is_beside && only && self.is_clear(*before)
        });
        let closed: BTreeSet<u32> = closed.map(|((_, after), _)| *after).collect();
        if closed.is_empty() {
            return Vec::new();
        }
        let touches = |regions: &Vec<u32>| regions.iter().any(|region| closed.contains(region));
        let volumes = self.optics.volumes.regions.iter().filter(|(_, regions)| touches(regions));
        let mut volumes: Vec<&str> = volumes.map(|(name, _)| name.as_str()).collect();
        volumes.sort_unstable();
        let mothers = self.around(&front);
        let mut messages = Vec::new();
        for volume in volumes {
            // light that leaves a mother has no sensor before it because other daughters are sensors
            let is_mother = self.regions_of(volume).iter().any(|region| mothers.contains(region));
            if by_volume.skins.contains_key(volume)
                || is_mother && !self.is_sensor(volume)
                || !self.is_clear_volume(volume)
                || !self.is_opaque_before(skin, volume)
            {
                continue;
            }
            // a sensor without an index detects nothing but by a surface: that is another rule
            let what =
                match (self.contains_sensor(volume, by_volume), self.sensor_behind(skin.volume, volume)) {
                    (true, _) => format!("the sensor `{volume}`, which it touches"),
                    (false, Some(sensor)) => {
                        format!(
                            "`{volume}`, which it touches, the only way of light to the sensor `{sensor}`"
                        )
                    }
                    (false, None) => continue,
                };
            let paint = &self.optics.surfaces[skin.surface];
            let problem = format!(
                "skin surface `{}` of volume `{}` lets {} light from it into {what}",
                skin.name,
                skin.volume,
                how_much(paint)
            );
            let reason = format!(
                "between volumes beside each other the skin of the volume in front comes first, as in Geant4, and {}",
                passes(paint)
            );
            let (from, to) = (self.placements_of(skin.volume), self.placements_of(volume));
            let advice = format!(
                "Add a border surface from {from} to {to}, for example a bare interface (polished, dielectric_dielectric, without \
                 properties)."
            );
            messages.push(Message::new(problem, reason).suggest(advice));
        }
        messages
    }

    /// The message about a volume that emits light, of which its skin lets nothing out to a sensor. Light within a volume that emits
    /// none comes from elsewhere, and its skin may be meant as a reflector for that.
    fn closed_source(&self, skin: Skin<'_>, by_volume: &ByVolume<'_>) -> Option<Message> {
        let (volume, surface) = (skin.volume, &self.optics.surfaces[skin.surface]);
        let emits = |region: u32| {
            let own = self.medium(region).and_then(|medium| self.optics.materials.get(medium));
            own.is_some_and(|own| {
                own.index.is_some() && !(own.scintillation.is_empty() && own.shifters.is_empty())
            })
        };
        let is_source = self.regions_of(volume).into_iter().any(emits);
        if !is_source || surface.detects() || self.contains_sensor(volume, by_volume) {
            return None;
        }
        let is_open = |name: &str| {
            let own = self.optics.surfaces.iter().find(|own| own.name == name);
            own.is_none_or(|own| own.detects() || !own.is_nearly_opaque(false))
        };
        let daughters = self.daughters(volume, by_volume);
        let mut skins = daughters.keys().filter_map(|daughter| by_volume.skins.get(daughter));
        if skins.any(|(_, surface)| is_open(surface)) || self.border_surfaces(volume).any(is_open) {
            return None;
        }
        let problem = format!(
            "skin surface `{}` of volume `{volume}`, which emits light, lets {} light out of it, and no sensor lies within",
            skin.name,
            how_much(surface)
        );
        let reason = format!(
            "the skin acts on all of its faces, as in Geant4, also on those beside other volumes, and {}",
            passes(surface)
        );
        let advice = format!(
            "Add a border surface from {} to the volume that the light is meant to enter, for example a bare interface (polished, \
             dielectric_dielectric, without properties).",
            self.placements_of(volume)
        );
        Some(Message::new(problem, reason).suggest(advice))
    }

    /// The surfaces of the borders on the way out of a volume.
    fn border_surfaces(&self, volume: &str) -> impl Iterator<Item = &str> {
        let is_own = move |placement: Option<&str>| {
            let list = placement.and_then(|name| self.optics.volumes.placements.get(name));
            list.into_iter().flatten().any(|own| own.volume == volume)
        };
        let borders = self.table.list("border");
        let from = |row: &Datum| row.list("placements").next().and_then(Datum::as_text).map(str::to_owned);
        borders.filter(move |row| is_own(from(row).as_deref())).map(|row| row.text("surface"))
    }

    /// The name of a sensor that light enters from a volume alone, as far as lines have found contacts: a window or a layer of grease
    /// in front of it. Sensors that touch the volume `front` directly do not count.
    fn sensor_behind(&self, front: &str, volume: &str) -> Option<&str> {
        let (front, own) = (self.regions_of(front), self.regions_of(volume));
        let detects = |after: u32, surfaces: &BTreeSet<Option<usize>>| {
            let is_detecting =
                |surface: &Option<usize>| surface.is_some_and(|k| self.optics.surfaces[k].detects());
            self.optics.sensors.get(after as usize).is_some_and(Option::is_some) && self.is_clear(after)
                || surfaces.iter().any(is_detecting)
        };
        let lit = || self.contacts.iter().filter(|((before, _), _)| self.is_clear(*before));
        let is_alone = |after: u32| {
            let mut into = lit().filter(|((_, own), _)| *own == after);
            into.all(|((before, _), _)| own.contains(before))
        };
        let mut behind = lit().filter(|((before, after), surfaces)| {
            let is_behind = own.contains(before) && !own.contains(after) && !front.contains(after);
            is_behind && detects(*after, surfaces) && is_alone(*after)
        });
        behind.next().map(|((_, after), _)| self.region_name(*after))
    }

    /// True if light from a volume reaches its daughter, and the skin of the volume stops all of it there.
    fn is_closed(&self, skin: Skin<'_>, daughter: &str) -> bool {
        let (outer, inner) = (self.regions_of(skin.volume), self.regions_of(daughter));
        let clear = |region: &&u32| self.is_clear(**region);
        if !self.is_opaque_before(skin, daughter) || !outer.iter().any(|region| clear(&region)) {
            return false;
        }
        // the daughter itself is the detector
        if self.optics.surfaces[skin.surface].detects() && self.is_sensor(daughter) {
            return false;
        }
        let into = || self.contacts.iter().filter(|((_, after), _)| inner.contains(after));
        let mut from_mother = into().filter(|((before, _), _)| outer.contains(before));
        // a daughter that no line has entered counts as touching its mother; one that another daughter surrounds does not
        from_mother.any(|(_, surfaces)| surfaces.contains(&Some(skin.surface))) || into().next().is_none()
    }

    /// True if hardly anything passes a skin between its volume and another one.
    fn is_opaque_before(&self, skin: Skin<'_>, volume: &str) -> bool {
        let media = |volume: &str| -> BTreeSet<Option<usize>> {
            self.regions_of(volume).into_iter().map(|region| self.medium(region)).collect()
        };
        let is_same = media(skin.volume) == media(volume);
        self.optics.surfaces[skin.surface].is_nearly_opaque(is_same)
    }

    /// The regions around some regions.
    fn around(&self, regions: &HashSet<u32>) -> HashSet<u32> {
        let (mut found, mut waiting) = (HashSet::new(), Vec::from_iter(regions.iter().copied()));
        while let Some(region) = waiting.pop() {
            let mothers = self.optics.volumes.nested.iter().filter(|(_, daughter)| *daughter == region);
            waiting.extend(mothers.map(|(mother, _)| *mother).filter(|mother| found.insert(*mother)));
        }
        found
    }

    fn is_clear_volume(&self, volume: &str) -> bool {
        self.regions_of(volume).into_iter().any(|region| self.is_clear(region))
    }

    fn is_sensor(&self, volume: &str) -> bool {
        let is_sensitive =
            |region: u32| self.optics.sensors.get(region as usize).is_some_and(Option::is_some);
        self.regions_of(volume).into_iter().any(is_sensitive)
    }

    /// True if a volume or one within it is sensitive, or has a skin with an efficiency.
    fn contains_sensor(&self, volume: &str, by_volume: &ByVolume<'_>) -> bool {
        let detects = |volume: &str| {
            let surface = by_volume.skins.get(volume).map(|(_, surface)| *surface);
            let mut surfaces = self.optics.surfaces.iter();
            surfaces.any(|own| Some(own.name.as_str()) == surface && own.detects())
        };
        let (mut waiting, mut seen) = (vec![volume.to_owned()], HashSet::new());
        while let Some(volume) = waiting.pop() {
            if self.is_sensor(&volume) || detects(&volume) {
                return true;
            }
            if seen.insert(volume.clone()) {
                waiting.extend(self.daughters(&volume, by_volume).into_keys().map(str::to_owned));
            }
        }
        false
    }

    /// The daughters of a volume with the names of their placements. The daughters of an assembly are those of the volume around it.
    fn daughters<'t>(&self, volume: &str, by_volume: &ByVolume<'t>) -> BTreeMap<&'t str, BTreeSet<&'t str>> {
        let row = |name: &str| by_volume.rows.get(name).copied();
        let mut daughters: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        let (mut waiting, mut seen) = (Vec::from_iter(row(volume)), HashSet::new());
        while let Some(own) = waiting.pop() {
            for daughter in own.list("daughters") {
                let name = daughter.text("volume");
                if self.regions_of(name).is_empty() {
                    waiting.extend(row(name).filter(|_| seen.insert(name)));
                    continue;
                }
                daughters.entry(name).or_default().insert(daughter.text("name"));
            }
        }
        daughters
    }

    /// The placements behind the border surfaces whose first placement is one of a volume.
    fn borders_from(&self, volume: &str) -> HashSet<&'a str> {
        let is_own = |placement: &str| {
            let list = self.optics.volumes.placements.get(placement);
            list.into_iter().flatten().any(|own| own.volume == volume)
        };
        let pairs = self.table.list("border").map(|row| row.list("placements").filter_map(Datum::as_text));
        let pairs = pairs.map(Iterator::collect::<Vec<&str>>);
        pairs.filter(|pair| pair.len() == 2 && is_own(pair[0])).map(|pair| pair[1]).collect()
    }
}
