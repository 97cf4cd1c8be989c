//! Volume hierarchy of a scene that came from a GDML file.

use super::materials::{auxiliaries, escaped};
use super::writer::{Part, Structure, Writer, place_text};
use crate::gdml::UNSPECIFIED;
use crate::gdml::stated::{Placed, VolumeRecord, list, rows, text};
use crate::write::WriteError;
use crate::write::fold::fold;
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_model::{Program, Solid};
use rayweave_scene::{Datum, Table};
use std::fmt::Write as _;

/// Tolerance of the test for orthogonal maps.
const RIGID: f64 = 1e-9;

/// Margin of the clip box of a volume relative to its size, so that no face of the solid lies in a face of the box.
const MARGIN: f64 = 0.125;

/// True if all placements are rotations or reflections: Geant4 does not scale placements.
pub(super) fn is_rigid(records: &[VolumeRecord]) -> bool {
    let maps = records.iter().flat_map(|record| &record.daughters).flat_map(|daughter| &daughter.maps);
    maps.into_iter().all(|map| is_orthogonal(&map.linear))
}

/// True for a rotation or a reflection.
pub(super) fn is_orthogonal(linear: &Mat3) -> bool {
    let square = linear.transpose() * *linear;
    (square - Mat3::IDENTITY).to_cols_array().iter().all(|entry| entry.abs() <= RIGID)
}

impl Writer<'_, '_> {
    /// The volumes, each after its daughters.
    pub(super) fn tree(
        &mut self,
        records: &[VolumeRecord],
        table: Option<&Table>,
        media: &[String],
    ) -> Result<Structure, WriteError> {
        let rows: Vec<&Table> = table.map(|table| rows(table, "volume")).unwrap_or_default();
        let parts =
            records.iter().map(|record| self.own_frame(record)).collect::<Result<Vec<Option<Part>>, _>>()?;
        let mut volumes = String::new();
        for k in inner_first(records) {
            let one = &records[k];
            let name = escaped(&one.name);
            // the world always has a solid
            let solid = match (&parts[k], k) {
                (Some(part), _) => Some(part.solid.clone()),
                (None, 0) => Some(self.room()),
                (None, _) => None,
            };
            let tag = if solid.is_some() { "volume" } else { "assembly" };
            let _ = writeln!(volumes, "    <{tag} name=\"{name}\">");
            if let Some(solid) = solid {
                let medium = one.region.map_or(0, |region| self.model.scene.regions[region].medium as usize);
                if self.model.scene.media[medium].name != UNSPECIFIED {
                    let _ = writeln!(volumes, "      <materialref ref=\"{}\"/>", media[medium]);
                }
                let _ = writeln!(volumes, "      <solidref ref=\"{solid}\"/>");
            }
            for daughter in &one.daughters {
                placements(&mut volumes, records, &parts, k, daughter);
            }
            volumes += &rows.get(k).map(|row| auxiliaries(row, "      ")).unwrap_or_default();
            let _ = writeln!(volumes, "    </{tag}>");
        }
        volumes += &table.map(links).unwrap_or_default();
        let world = records.first().map(|world| escaped(&world.name)).unwrap_or_default();
        Ok(Structure { volumes, world })
    }

    /// The solid of a volume, clipped to its own box.
    fn own_frame(&mut self, record: &VolumeRecord) -> Result<Option<Part>, WriteError> {
        let (Some(solid), Some(region)) = (&record.solid, record.region) else {
            return Ok(None);
        };
        self.region = region;
        let model_clip = self.clip;
        if let Some(bounds) = bounds(solid)? {
            self.clip = bounds;
        }
        let part = fold(solid, self);
        self.clip = model_clip;
        part
    }
}

/// Indices of the volumes, daughters before mothers, otherwise in the given order.
fn inner_first(records: &[VolumeRecord]) -> Vec<usize> {
    let mut depth = vec![0usize; records.len()];
    for (k, one) in records.iter().enumerate() {
        for daughter in &one.daughters {
            depth[daughter.volume] = depth[daughter.volume].max(depth[k] + 1);
        }
    }
    let mut order: Vec<usize> = (0..records.len()).collect();
    order.sort_by_key(|k| (std::cmp::Reverse(depth[*k]), *k));
    order
}

/// Bounding box of a solid with a margin, if it is finite.
fn bounds(solid: &Solid) -> Result<Option<rayweave_math::Bounds>, WriteError> {
    let bounds = Program::compile(solid)?.region_bounds().into_iter().next();
    let finite = bounds.filter(|bounds| !bounds.is_empty() && bounds.is_finite());
    Ok(finite.map(|bounds| bounds.grown(MARGIN * bounds.size().length())))
}

/// All placements of a daughter. The part of a volume may have its own rotation and translation.
fn placements(
    text: &mut String,
    records: &[VolumeRecord],
    parts: &[Option<Part>],
    mother: usize,
    daughter: &Placed,
) {
    let place = |volume: usize| parts[volume].as_ref().map_or(Affine::IDENTITY, |part| part.place);
    // rotations are invertible
    let into_mother = place(mother).inverse().unwrap_or(Affine::IDENTITY);
    let volume = escaped(&records[daughter.volume].name);
    for (k, map) in daughter.maps.iter().enumerate() {
        let name = match (daughter.name.as_str(), k) {
            ("", _) => String::new(),
            (name, 0) => format!(" name=\"{}\"", escaped(name)),
            (name, _) => format!(" name=\"{}_{k}\"", escaped(name)),
        };
        let copy = daughter.copy.map(|copy| format!(" copynumber=\"{}\"", copy.saturating_add(k as i64)));
        let whole = place(daughter.volume).then(map).then(&into_mother);
        let is_mirror = whole.linear.determinant() < 0.0;
        let scale = if is_mirror { "\n        <scale x=\"1\" y=\"1\" z=\"-1\"/>" } else { "" };
        let linear = if is_mirror {
            whole.linear * Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0))
        } else {
            whole.linear
        };
        let (position, rotation) = place_text(&Affine { linear, ..whole }, true);
        let _ = writeln!(
            text,
            "      <physvol{name}{}>\n        <volumeref ref=\"{volume}\"/>{position}{rotation}{scale}\n      </physvol>",
            copy.unwrap_or_default()
        );
    }
}

/// Skin and border surfaces.
fn links(table: &Table) -> String {
    let mut all = String::new();
    for (key, tag, of, inner) in [
        ("skin", "skinsurface", "volume", "volumeref"),
        ("border", "bordersurface", "placements", "physvolref"),
    ] {
        for row in rows(table, key) {
            let (name, surface) = (escaped(text(row, "name")), escaped(text(row, "surface")));
            let reference = |value: &rayweave_scene::Spanned<Datum>| match &value.value {
                Datum::Text(name) => format!("      <{inner} ref=\"{}\"/>\n", escaped(name)),
                _ => String::new(),
            };
            let references: String = list(row, of).iter().map(reference).collect();
            let _ = writeln!(
                all,
                "    <{tag} name=\"{name}\" surfaceproperty=\"{surface}\">\n{references}    </{tag}>"
            );
        }
    }
    all
}
