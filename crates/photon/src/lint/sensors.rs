//! Rules for sensors: surfaces that do not act, placements without a surface that detects.

use super::state::Lint;
use super::volumes::listed;
use crate::detector::gdml::Placement;
use crate::detector::properties::Owner;
use rayweave_error::Message;
use rayweave_scene::Datum;
use std::collections::{BTreeSet, HashMap, HashSet};

impl Lint<'_> {
    /// Skins with an efficiency that do not act, since volumes in front of them have skins as well: nowhere, or at some contacts.
    pub(super) fn covered_skins(&mut self) {
        let skins = self.skins();
        let mut found = Vec::new();
        for row in self.table.list("skin") {
            let (name, surface) = (row.text("name"), row.text("surface"));
            let Some(number) = self.optics.surfaces.iter().position(|own| own.name == surface) else {
                continue;
            };
            if !self.optics.surfaces[number].detects() {
                continue;
            }
            for volume in row.list("volume").filter_map(Datum::as_text) {
                if skins.get(volume).is_none_or(|(first, _)| *first != name) {
                    continue;
                }
                let messages = match self.nowhere(name, (volume, number), &skins) {
                    Some(message) => vec![message],
                    None => self.covered_at_contacts(name, (volume, number), &skins),
                };
                found.extend(messages.into_iter().map(|message| (Owner::new("skin", name), message)));
            }
        }
        found.into_iter().for_each(|(owner, message)| self.find(&owner, "", message));
    }

    /// The message about the skin of a volume that acts nowhere.
    fn nowhere(
        &self,
        name: &str,
        (volume, number): (&str, usize),
        skins: &HashMap<&str, (&str, &str)>,
    ) -> Option<Message> {
        let surface = &self.optics.surfaces[number].name;
        let fronts = self.volumes_in_front(volume, number);
        let covers = fronts.iter().filter_map(|front| Some((front.as_str(), *skins.get(front.as_str())?)));
        let (front, (cover, paint)) = covers.clone().next()?;
        let all = listed(covers.map(|(front, _)| front).collect::<Vec<_>>().into_iter());
        let problem = format!("skin surface `{name}` of volume `{volume}` detects nothing");
        let reason = format!(
            "light arrives from {all}, and the skin `{cover}` of `{front}` acts instead: between volumes beside each other the \
             skin of the volume in front comes first, as in Geant4"
        );
        let advice = format!(
            "Add a border surface with `{surface}` from the placement of `{front}` to each placement of `{volume}`, or make \
             `{paint}` the skin of their mother instead of `{front}`."
        );
        Some(Message::new(problem, reason).suggest(advice))
    }

    /// Messages about the volumes that touch a volume with a detecting skin, and whose own skins act there instead. A border surface
    /// between the two is a choice of the author.
    fn covered_at_contacts(
        &self,
        name: &str,
        (volume, number): (&str, usize),
        skins: &HashMap<&str, (&str, &str)>,
    ) -> Vec<Message> {
        let (regions, own) = (&self.optics.volumes.regions, self.regions_of(volume));
        let surface_of = |front: &str| {
            let (skin, paint) = *skins.get(front)?;
            let paint = self.optics.surfaces.iter().position(|surface| surface.name == paint)?;
            (paint != number && !self.optics.surfaces[paint].detects()).then_some((skin, paint))
        };
        let is_covered = |front: &[u32], paint: usize| {
            self.contacts.iter().any(|((before, after), surfaces)| {
                let only = surfaces.len() == 1 && surfaces.contains(&Some(paint));
                front.contains(before) && own.contains(after) && only && self.is_clear(*before)
            })
        };
        let mut fronts: Vec<(&str, &str)> = regions
            .iter()
            .filter(|(front, _)| front.as_str() != volume)
            .filter_map(|(front, list)| {
                let (skin, paint) = surface_of(front)?;
                is_covered(list, paint).then_some((front.as_str(), skin))
            })
            .collect();
        fronts.sort_unstable();
        let surface = &self.optics.surfaces[number].name;
        let message = |(front, cover): (&str, &str)| {
            let problem = format!(
                "the skin `{name}` (EFFICIENCY) of volume `{volume}` does not act on light from `{front}`, which touches it"
            );
            let reason = format!(
                "the skin `{cover}` of `{front}` comes first, as in Geant4 between volumes beside each other"
            );
            let (from, to) = (self.placements_of(front), self.placements_of(volume));
            let advice = format!("Add a border surface with `{surface}` from {from} to {to}.");
            Message::new(problem, reason).suggest(advice)
        };
        fronts.into_iter().map(message).collect()
    }

    /// The placements of a volume in backquotes, or a description if they have no names.
    pub(super) fn placements_of(&self, volume: &str) -> String {
        let placements = self.optics.volumes.placements.iter();
        let is_own = |list: &Vec<Placement>| list.iter().any(|placement| placement.volume == volume);
        let names: BTreeSet<&str> =
            placements.filter(|(_, list)| is_own(list)).map(|(name, _)| name.as_str()).collect();
        match names.is_empty() || names.contains("") {
            true => format!("the placement of `{volume}`"),
            false => listed(names.into_iter()),
        }
    }

    /// The numbers of the regions of a volume.
    pub(super) fn regions_of(&self, volume: &str) -> HashSet<u32> {
        self.optics.volumes.regions.get(volume).into_iter().flatten().copied().collect()
    }

    /// True if the medium of a region has an index, so that light can come from it.
    pub(super) fn is_clear(&self, region: u32) -> bool {
        self.medium(region).is_some_and(|medium| self.has_index(medium))
    }

    /// The volumes from which light reaches a volume whose skin has a number, if the skin acts at no contact that lines have found.
    fn volumes_in_front(&self, volume: &str, skin: usize) -> BTreeSet<String> {
        let own = self.regions_of(volume);
        // no light comes from an opaque volume
        let is_lit = |(before, after): &(u32, u32)| {
            (own.contains(before) || own.contains(after)) && self.is_clear(*before)
        };
        let contacts = || self.contacts.iter().filter(|(pair, _)| is_lit(pair));
        if contacts().any(|(_, surfaces)| surfaces.contains(&Some(skin))) {
            return BTreeSet::new();
        }
        let inwards = contacts().map(|(pair, _)| *pair).filter(|(_, after)| own.contains(after));
        let fronts: HashSet<u32> = inwards.map(|(before, _)| before).collect();
        let is_front = |regions: &Vec<u32>| regions.iter().any(|region| fronts.contains(region));
        let volumes = self.optics.volumes.regions.iter();
        volumes.filter(|(_, regions)| is_front(regions)).map(|(name, _)| name.clone()).collect()
    }

    /// Sensors at which no photon is detected, by placement.
    pub(super) fn sensors(&mut self) {
        let mut found = Vec::new();
        let mut seen = HashSet::new();
        for (region, sensor) in (0u32..).zip(&self.optics.sensors) {
            let (Some(sensor), Some(medium)) = (sensor, self.medium(region)) else { continue };
            // touching copies of a volume are several regions
            let name = self.region_name(region);
            if self.has_index(medium) || !seen.insert(name) {
                continue;
            }
            let (dark, all) = self.placements_without_efficiency(region);
            if dark.is_empty() && all > 0 || all == 0 && self.has_efficiency(region) {
                continue;
            }
            let material = &self.optics.materials[medium];
            let owner = Owner::new("material", &material.name);
            let (what, it) = match dark.len() {
                0 => (format!("volume `{name}`"), "it"),
                n if n == all => (format!("volume `{name}`"), "it"),
                1 => (format!("placement {} of volume `{name}`", listed(dark.iter().copied())), "it"),
                _ => (format!("placements {} of volume `{name}`", listed(dark.iter().copied())), "them"),
            };
            let verb = if it == "it" { "detects" } else { "detect" };
            let problem = format!("{what} with the sensor `{sensor}` {verb} nothing");
            let reason = format!(
                "its {owner} has no `RINDEX`, and no surface with an `EFFICIENCY` lies in front of {it}"
            );
            let advice = "Give the material an index, or the boundary a surface with an efficiency.";
            found.push((owner, Message::new(problem, reason).suggest(advice)));
        }
        found.into_iter().for_each(|(owner, message)| self.find(&owner, "", message));
    }

    fn has_efficiency(&self, region: u32) -> bool {
        self.with_efficiency().iter().any(|surface| self.regions_behind(surface).contains(&region))
    }

    /// The surfaces with an efficiency in the file: an invalid one is a finding of its own.
    pub(super) fn with_efficiency(&self) -> HashSet<&str> {
        let has = |row: &&Datum| row.get("properties").is_some_and(|own| own.get("EFFICIENCY").is_some());
        self.table.list("surface").filter(has).map(|row| row.text("name")).collect()
    }

    /// The names of the placements of a volume that light reaches through no surface with an efficiency, and the number of all names.
    fn placements_without_efficiency(&self, region: u32) -> (Vec<&str>, usize) {
        let volumes = &self.optics.volumes;
        let is_own =
            |volume: &str| volumes.regions.get(volume).is_some_and(|regions| regions.contains(&region));
        let all: BTreeSet<&str> = volumes
            .placements
            .iter()
            .filter(|(_, list)| list.iter().any(|placement| is_own(&placement.volume)))
            .map(|(name, _)| name.as_str())
            .collect();
        let detecting = self.with_efficiency();
        // a skin is that of all placements
        if detecting.iter().any(|surface| self.regions_of_skin(surface).contains(&region)) {
            return (Vec::new(), all.len());
        }
        let behind = self.table.list("border").filter(|row| detecting.contains(row.text("surface")));
        let behind: HashSet<&str> =
            behind.filter_map(|row| row.list("placements").filter_map(Datum::as_text).nth(1)).collect();
        (all.iter().copied().filter(|name| !behind.contains(name)).collect(), all.len())
    }
}
