//! Rules for optical surfaces: words that Geant4 reads otherwise, surfaces that compete.

use super::state::Lint;
use crate::detector::properties::Owner;
use crate::surface::{OpticalSurface, SurfaceFinish, SurfaceModel, SurfaceType};
use rayweave_error::Message;
use rayweave_scene::Datum;
use std::collections::{HashMap, HashSet};

/// True for a bare interface with a reflectivity like that of a wrapping. A surface that detects or transmits photons is meant to lose
/// some, and with a reflectivity of 0 all of them.
fn is_taken_for_reflector(surface: &OpticalSurface) -> bool {
    let values = surface.reflectivity.as_ref().map(|table| table.values());
    let is_between = values.is_some_and(|values| values.iter().any(|value| (0.5..1.0).contains(value)));
    let is_plain = surface.efficiency.is_none() && surface.transmittance.is_none();
    surface.finish == SurfaceFinish::Polished && is_between && is_plain
}

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
        self.interfaces();
        self.repeated_skins();
        self.competing();
        self.efficiencies();
    }

    /// Interfaces that act otherwise than their properties suggest: a back paint without the index of its gap, one whose polished face
    /// reflects diffusely, and a reflectivity that is no reflector.
    fn interfaces(&mut self) {
        let skins: HashSet<&str> = self.table.list("skin").map(|row| row.text("surface")).collect();
        for surface in self.optics.surfaces.iter().filter(|own| own.kind == SurfaceType::DielectricDielectric)
        {
            let owner = Owner::new("surface", &surface.name);
            if surface.finish.is_back_painted() && surface.index.is_none() {
                let problem = format!("{owner} has a back-painted finish and no `RINDEX`");
                let reason = "all photons end on reaching it (`no_index`; `NoRINDEX` in Geant4), since the gap in front of the \
                              paint has no index";
                let advice = "Add RINDEX, 1 for a gap of air.";
                self.find(&owner, "", Message::new(problem, reason).suggest(advice));
            }
            if surface.finish == SurfaceFinish::PolishedBackPainted
                && surface.model == SurfaceModel::Unified
                && [&surface.spike, &surface.lobe, &surface.backscatter].iter().all(|own| own.is_none())
            {
                let problem = format!("{owner} is polished and reflects diffusely");
                let reason = "without SPECULARSPIKECONSTANT, SPECULARLOBECONSTANT and BACKSCATTERCONSTANT all Fresnel and total \
                              reflections of the unified model are Lambertian, as in Geant4";
                let advice = "Add SPECULARSPIKECONSTANT, 1 for a polished face.";
                self.find(&owner, "", Message::new(problem, reason).suggest(advice));
            }
            if skins.contains(surface.name.as_str()) && is_taken_for_reflector(surface) {
                let problem = format!("`REFLECTIVITY` of {owner} makes no reflector");
                let reason = "at a polished interface of two dielectrics it is 1 minus the loss, as in Geant4: the other photons \
                              are refracted or reflected by Fresnel's equations, and pass";
                let advice =
                    "For a wrapping use the type dielectric_metal, or a front- or back-painted finish.";
                self.find(&owner, "REFLECTIVITY", Message::new(problem, reason).suggest(advice));
            }
        }
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
        // one finding for the borders of a surface beside the same skin: copies of a volume have one each
        let mut found: Vec<([&str; 3], &str, [&str; 2], usize)> = Vec::new();
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
            let Some((volume, skin)) = skin else { continue };
            let kind = [*surface, skin, volume];
            match found.iter_mut().find(|(own, ..)| *own == kind) {
                Some((.., more)) => *more += 1,
                None => found.push((kind, *name, [first, second], 0)),
            }
        }
        let findings = found.into_iter().map(|([_, skin, volume], name, [first, second], more)| {
            let places = match more {
                0 => String::new(),
                more => format!(", and in {more} more place{}", if more == 1 { "" } else { "s" }),
            };
            let problem =
                format!("two optical surfaces lie between placements `{first}` and `{second}`{places}");
            let reason = format!(
                "border surface `{name}` acts on light from `{first}` to `{second}`, skin surface `{skin}` of volume `{volume}` on \
                 light in the other direction"
            );
            let advice = "If one surface is meant for both directions, add a border from the second to the first.";
            (Owner::new("border", name), Message::new(problem, reason).suggest(advice))
        });
        let findings: Vec<(Owner, Message)> = findings.collect();
        findings.into_iter().for_each(|(owner, message)| self.find(&owner, "", message));
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
