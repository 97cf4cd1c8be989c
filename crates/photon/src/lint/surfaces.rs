//! Rules for optical surfaces: words that Geant4 reads otherwise, surfaces that compete.

use super::state::Lint;
use crate::detector::properties::Owner;
use crate::surface::{SurfaceFinish, SurfaceModel, SurfaceType};
use rayweave_error::Message;
use rayweave_scene::Datum;
use std::collections::HashMap;

impl Lint<'_> {
    /// All rules about surfaces.
    pub(super) fn surfaces(&mut self) {
        for surface in &self.optics.surfaces {
            let owner = Owner::new("surface", &surface.name);
            if surface.kind == SurfaceType::Coated {
                let problem = format!("{owner} has the type `coated`");
                let reason = "Geant4's GDML reader has no such type and reads it as `x_ray`, at which photons pass unchanged";
                let advice = "Rayweave simulates the film; in Geant4 set the type in C++.";
                self.find(&owner, "", Message::new(problem, reason).suggest(advice));
            }
            let has_own_table = matches!(
                surface.kind,
                SurfaceType::DielectricLut
                    | SurfaceType::DielectricLutDavis
                    | SurfaceType::DielectricDichroic
            );
            if has_own_table && matches!(surface.model, SurfaceModel::Glisur | SurfaceModel::Unified) {
                let problem = format!("the model of {owner} does not fit its type");
                let reason =
                    "with the models glisur and unified Geant4 does not read the table that the type needs";
                let advice = "Set the model to LUT, DAVIS or dichroic.";
                self.find(&owner, "", Message::new(problem, reason).suggest(advice));
            }
            let value = surface.value;
            let (is_off, advice) = match surface.model {
                SurfaceModel::Unified => {
                    (!(0.0..=1.0).contains(&value), "The value is sigma_alpha in radians: is it in degrees?")
                }
                SurfaceModel::Glisur => {
                    (!(0.0..=1.0).contains(&value), "The value is the polish, from 0 (rough) to 1 (smooth).")
                }
                _ => (false, ""),
            };
            if is_off && surface.finish != SurfaceFinish::Polished {
                let problem = format!("the value of {owner} is implausible");
                let message = Message::new(problem, format!("it is {value}, and 0 to 1 are usual"));
                self.find(&owner, "", message.suggest(advice));
            }
        }
        self.repeated_skins();
        self.competing();
        self.efficiencies();
    }

    /// Several skins of one volume.
    fn repeated_skins(&mut self) {
        let mut first: HashMap<&str, &str> = HashMap::new();
        for row in self.table.list("skin") {
            for volume in row.list("volume").filter_map(Datum::as_text) {
                let name = row.text("name");
                let known = *first.entry(volume).or_insert(name);
                if known != name {
                    let problem = format!("skin surface `{name}` of volume `{volume}` has no effect");
                    let message = Message::new(problem, format!("the volume has the skin `{known}` already"));
                    self.find_unused(&Owner::new("skin", name), "", message.suggest("Remove one of them."));
                }
            }
        }
    }

    /// The skins by volume: their names and surfaces.
    pub(super) fn skins(&self) -> HashMap<&str, (&str, &str)> {
        let mut skins = HashMap::new();
        for row in self.table.list("skin") {
            for volume in row.list("volume").filter_map(Datum::as_text) {
                skins.entry(volume).or_insert((row.text("name"), row.text("surface")));
            }
        }
        skins
    }

    /// A border in one direction beside a skin that acts in the other.
    fn competing(&mut self) {
        let skins = self.skins();
        let borders: Vec<(&str, &str, Vec<&str>)> = self
            .table
            .list("border")
            .map(|row| {
                let placements = row.list("placements").filter_map(Datum::as_text).collect();
                (row.text("name"), row.text("surface"), placements)
            })
            .collect();
        let mut found = Vec::new();
        for (name, surface, placements) in &borders {
            let [first, second] = placements[..] else { continue };
            let is_reverse = |other: &&(&str, &str, Vec<&str>)| other.2[..] == [second, first];
            if borders.iter().any(|other| is_reverse(&other)) {
                continue;
            }
            let volume = |placement: &str| {
                self.optics
                    .volumes
                    .placements
                    .get(placement)?
                    .first()
                    .map(|placement| placement.volume.as_str())
            };
            // no light returns from an opaque volume
            let regions = volume(second).and_then(|volume| self.optics.volumes.regions.get(volume));
            if !regions.into_iter().flatten().any(|region| self.is_clear(*region)) {
                continue;
            }
            let skin = [first, second].into_iter().filter_map(volume).find_map(|volume| {
                let (skin, own) = skins.get(volume)?;
                (own != surface).then_some((volume, *skin))
            });
            if let Some((volume, skin)) = skin {
                let problem = format!("two optical surfaces lie between placements `{first}` and `{second}`");
                let reason = format!(
                    "border surface `{name}` acts on light from `{first}` to `{second}`, skin surface `{skin}` of volume \
                     `{volume}` on light in the other direction"
                );
                let advice =
                    "If one surface is meant for both directions, add a border from the second to the first.";
                found.push((Owner::new("border", *name), Message::new(problem, reason).suggest(advice)));
            }
        }
        found.into_iter().for_each(|(owner, message)| self.find(&owner, "", message));
    }

    /// Surfaces with an efficiency whose volumes have no sensor.
    fn efficiencies(&mut self) {
        let mut found = Vec::new();
        for surface in &self.optics.surfaces {
            if !surface.detects() {
                continue;
            }
            let regions = self.regions_behind(&surface.name);
            let has_sensor =
                |region: &u32| self.optics.sensors.get(*region as usize).is_some_and(Option::is_some);
            if !regions.is_empty() && !regions.iter().any(has_sensor) {
                let owner = Owner::new("surface", &surface.name);
                let problem = format!("{owner} has an `EFFICIENCY`, but no volume behind it is a sensor");
                let reason = "Geant4 passes a detected photon to the sensitive detector of the volume behind the surface; \
                              Rayweave counts it with `--detect efficiency` or `both`";
                let advice = "Mark the volume with <auxiliary auxtype=\"SensDet\" auxvalue=\"...\"/>.";
                found.push((owner, Message::new(problem, reason).suggest(advice)));
            }
        }
        found.into_iter().for_each(|(owner, message)| self.find(&owner, "EFFICIENCY", message));
    }

    /// The regions that light enters through a surface: behind its borders, and within and around the volumes with it as
    /// their skin.
    pub(super) fn regions_behind(&self, surface: &str) -> Vec<u32> {
        let volumes = &self.optics.volumes;
        let mut regions = self.regions_of_skin(surface);
        for row in self.table.list("border").filter(|row| row.text("surface") == surface) {
            regions.extend(volumes.behind_border(row));
        }
        regions
    }

    /// The regions within and around the volumes with a surface as their skin.
    pub(super) fn regions_of_skin(&self, surface: &str) -> Vec<u32> {
        let volumes = &self.optics.volumes;
        let mut regions = Vec::new();
        for row in self.table.list("skin").filter(|row| row.text("surface") == surface) {
            for volume in row.list("volume").filter_map(Datum::as_text) {
                let own = volumes.regions.get(volume).cloned().unwrap_or_default();
                let beside = |(mother, daughter): &(u32, u32)| match () {
                    () if own.contains(mother) => Some(*daughter),
                    () if own.contains(daughter) => Some(*mother),
                    () => None,
                };
                regions.extend(volumes.nested.iter().filter_map(beside));
                regions.extend(own.iter().copied());
            }
        }
        regions
    }
}
