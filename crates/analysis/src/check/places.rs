//! Walls and gaps between faces, each once.

use super::facing::Facing;
use super::narrow::MANY_FACETS;
use crate::measure::MeasuredChord;
use crate::survey::{Across, Faces};
use rayweave_model::{LeafId, PlacementId, Program};

/// A face of a leaf; those of meshes and of solids with many sides are one.
type Face = (LeafId, PlacementId, u32);

/// A wall or gap.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub width: f64,
    pub across: Across,
    /// The faces at each end.
    faces: [Vec<Face>; 2],
}

impl Place {
    /// A place between two faces.
    pub fn of_faces(across: &Across) -> Place {
        let face = |k: usize| {
            let own = across.leaves.map(|leaves| leaves[k]);
            own.map(|(leaf, placement)| (leaf, placement, across.facets[k].min(MANY_FACETS)))
                .into_iter()
                .collect()
        };
        Place { width: across.width(Faces::Wall), across: *across, faces: [face(0), face(1)] }
    }

    /// A place at an edge or corner.
    pub fn of_edges(facing: &Facing) -> Place {
        let faces = facing.faces.clone().map(|faces| {
            let mut own: Vec<Face> = faces
                .into_iter()
                .map(|(leaf, placement, facet, _)| (leaf, placement, facet.min(MANY_FACETS)))
                .collect();
            own.sort_unstable();
            own.dedup();
            own
        });
        Place { width: facing.across.chord.length(), across: facing.across, faces }
    }

    /// The names of the faces at each end; several meet at an edge or corner. Empty if they are unknown.
    pub fn face_names(&self, program: &Program) -> Vec<String> {
        let name = |&(leaf, _, facet): &Face| match facet < MANY_FACETS {
            true => program.face_name(program.face_number(leaf, facet)),
            false => program.leaf(leaf).name().into_owned(),
        };
        let names = |faces: &Vec<Face>| faces.iter().map(name).collect::<Vec<_>>().join("/");
        let ends: Vec<String> = self.faces.iter().map(names).collect();
        if ends.iter().any(String::is_empty) { Vec::new() } else { ends }
    }

    /// The same place with another chord, perpendicular to both faces.
    pub fn with_chord(self, chord: MeasuredChord) -> Place {
        Place { width: chord.length(), across: Across { chord, ..self.across }, ..self }
    }

    /// True if both places are between the same faces: those at one end of one place include those of the other.
    fn is_between_faces_of(&self, other: &Place) -> bool {
        let include = |a: &[Face], b: &[Face]| b.iter().all(|face| a.contains(face));
        let same = |a: &[Face], b: &[Face]| include(a, b) || include(b, a);
        let [a, b] = &self.faces;
        let [c, d] = &other.faces;
        (same(a, c) && same(b, d)) || (same(a, d) && same(b, c))
    }
}

/// The narrowest place between each two faces, the narrowest first.
pub(super) fn distinct(mut places: Vec<Place>) -> Vec<Place> {
    places.sort_by(|a, b| a.width.total_cmp(&b.width));
    let mut kept: Vec<Place> = Vec::new();
    for place in places {
        if !kept.iter().any(|known| known.is_between_faces_of(&place)) {
            kept.push(place);
        }
    }
    kept
}
