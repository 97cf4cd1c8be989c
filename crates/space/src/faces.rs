//! Numbers and names of the faces of a compiled solid.

use crate::Program;
use crate::trace::Face;

impl<const D: usize> Program<D> {
    /// The number of faces of all leaves.
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The index of a face in a result, counted through all leaves from 0.
    pub fn face_number(&self, face: &Face<D>) -> usize {
        self.leaves[face.leaf as usize].first_face as usize + face.face as usize
    }

    /// The names of all faces by index: the name of the leaf and, if it has several faces, a suffix: `.lo` and `.hi` for a slab,
    /// `.lo0`, `.hi0`, `.lo1`, ... by axis for a box.
    pub fn face_names(&self) -> Vec<String> {
        let mut names = Vec::with_capacity(self.faces.len());
        for (k, leaf) in self.leaves.iter().enumerate() {
            let end = self.leaves.get(k + 1).map_or(self.faces.len(), |next| next.first_face as usize);
            let count = end - leaf.first_face as usize;
            names.extend((0..count).map(|face| format!("{}{}", leaf.name, suffix(face, count))));
        }
        names
    }
}

/// The suffix of a face among those of its leaf, which come in pairs, one pair for each axis.
fn suffix(face: usize, count: usize) -> String {
    let end = ["lo", "hi"][face % 2];
    match count {
        1 => String::new(),
        2 => format!(".{end}"),
        _ => format!(".{end}{}", face / 2),
    }
}

#[cfg(test)]
mod tests {
    use crate::Solid;

    #[test]
    fn faces_are_named_by_leaf_and_axis() {
        let slab = Solid::<2>::slab(1, 0.0, 1.0).unwrap();
        let solid = Solid::ball(1.0).unwrap()
            | slab
            | Solid::box_from_corners([0.0; 2], [1.0; 2]).unwrap().named("b");
        let names = solid.compile().unwrap().face_names();
        assert_eq!(names, ["ball", "slab.lo", "slab.hi", "b.lo0", "b.hi0", "b.lo1", "b.hi1"]);
        let root_ray = crate::trace([-3.0, 0.5], [-2.0, 0.5], &(!&solid & Solid::universe())).unwrap();
        assert!(root_ray.roots().is_empty());
        let program = solid.compile().unwrap();
        let across = crate::trace([0.5, -3.0], [0.5, -2.0], &solid).unwrap();
        let faces: Vec<&str> =
            across.roots().iter().map(|root| names[program.face_number(&root.surface)].as_str()).collect();
        assert_eq!((faces, program.face_count()), (vec!["ball", "slab.hi"], 7));
    }
}
