//! Flat tables of a program: fixed-size records, for a GPU buffer, a worker or a file.
//!
//! A [`PlainProgram`] holds everything needed to compute crossings: groups, leaves, facets, surfaces, placed
//! solids, the boolean networks, regions and media. It holds no names and no search structures. Every table
//! is a vector of one kind of [`Record`]: `#[repr(C)]`, only `u32` or only `f64` fields, no padding, no
//! pointers. Ids are indices of tables.
//!
//! # Meaning
//!
//! - A **surface** has a `kind` and numbers, which define its f: see [`SurfaceKind`]. Inside is f < 0.
//! - A **facet** is one side of a surface. A leaf of kind [`LEAF_SHAPE`] is inside where f has the
//!   sign that each of its facets states.
//! - A leaf of kind [`LEAF_INSTANCE`] is a placed solid: the map of the instance takes a point of the group
//!   into the frame of another group; the point is inside the leaf if it is inside output 0 of that group.
//! - The **network** of a group has nodes in topological order: node 0 is empty, node 1 is the universe, node
//!   k + 2 is leaf k of the group, and the gates follow. An **edge** (a literal in AIGER) is `2 * node + complement`.
//! - Group 0 is the model. Its output k is region k + 1; a point in several regions belongs to the
//!   last. Region 0 is the world. Every other group has one output.
//!
//! [`DESIGN`](https://github.com/rayweave/rayweave/blob/main/DESIGN.md) defines the crossings that are
//! reported where surfaces coincide; computing them needs no other table.

mod build;
mod record;

pub use build::PlainError;
pub use record::Record;
use record::record;

/// Kind of a leaf that is a shape: `first` and `count` are a range of facets.
pub const LEAF_SHAPE: u32 = 0;
/// Kind of a leaf that is a placed solid: `first` is the number of an instance; `count` is 1.
pub const LEAF_INSTANCE: u32 = 1;

/// Flag of a leaf whose primitive is the complement of the conjunction of its facets. The node of the leaf is still the
/// conjunction, and edges to it are already complemented; the flag only affects the direction of normals.
pub const LEAF_COMPLEMENT: u32 = 1;
/// Flag of a leaf that affects no output.
pub const LEAF_UNUSED: u32 = 2;

/// Rule of a gate that is inside if at least `least` of its operands are: 1 is the union, `count` the
/// intersection.
pub const GATE_AT_LEAST: u32 = 0;
/// Rule of a gate that is inside if an odd number of its operands are; `least` is 0.
pub const GATE_ODD: u32 = 1;

/// Kinds of surfaces, with their numbers in order and f. Unit vectors have length 1 up to rounding; matrices
/// are in row-major order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum SurfaceKind {
    /// Unit normal n (3), offset c: `n . p - c`.
    Plane = 1,
    /// Centre m (3), radius r: `|p - m|^2 - r^2`.
    Sphere = 2,
    /// A point of the axis m (3), unit axis a (3), radius r: `|q - (q . a) a|^2 - r^2` with `q = p - m`.
    Cylinder = 3,
    /// Apex m (3), unit axis a (3), slope s: `|q - h a|^2 - (s h)^2` with `q = p - m` and `h = q . a`.
    Cone = 4,
    /// Centre m (3), orthonormal axes e1, e2, e3 (9), weights w (3), linear factor l (3), constant c:
    /// `sum w_k (e_k . q)^2 + l . q + c` with `q = p - m`.
    Quadric = 5,
    /// Centre m (3), unit axis a (3), major radius R, minor radius r: `(d - R)^2 + z^2 - r^2` with `q = p - m`,
    /// `z = q . a` and `d = |q - z a|`.
    Torus = 6,
    /// Centre m (3), the matrix L into the torus's own frame (9), its inverse (9), then unit axis a (3), major and minor
    /// radius: f of the torus about the origin at `L (p - m)`.
    AffineTorus = 7,
}

impl SurfaceKind {
    /// All kinds.
    pub const ALL: [SurfaceKind; 7] = [
        SurfaceKind::Plane,
        SurfaceKind::Sphere,
        SurfaceKind::Cylinder,
        SurfaceKind::Cone,
        SurfaceKind::Quadric,
        SurfaceKind::Torus,
        SurfaceKind::AffineTorus,
    ];

    /// The number of parameters of a surface of this kind.
    pub const fn count(self) -> usize {
        match self {
            SurfaceKind::Plane | SurfaceKind::Sphere => 4,
            SurfaceKind::Cylinder | SurfaceKind::Cone => 7,
            SurfaceKind::Quadric => 19,
            SurfaceKind::Torus => 8,
            SurfaceKind::AffineTorus => 26,
        }
    }
}

record! {
    /// A group of leaves compiled in one frame: the model (group 0) or a solid that is placed.
    PlainGroup: 28 {
        /// The first of its leaves.
        first_leaf: u32,
        /// The number of its leaves.
        leaf_count: u32,
        /// The first of its gates.
        first_gate: u32,
        /// The number of its gates.
        gate_count: u32,
        /// The first of its outputs.
        first_output: u32,
        /// The number of its outputs: one for each region for group 0, else 1.
        output_count: u32,
        /// 1 plus the number of placements nested in the group.
        placements: u32,
    }
}

record! {
    /// Bounds and error factor of a group.
    PlainFrame: 88 {
        /// The lower corner of a box that holds the group; may be infinite.
        lo: [f64; 3],
        /// The upper corner.
        hi: [f64; 3],
        /// The centre of the ball around the group. A ray lies in a surface if it stays within delta of it along its chord
        /// of this ball.
        ball_centre: [f64; 3],
        /// The radius of the ball.
        ball_radius: f64,
        /// Upper bound of the factor by which a rounding error in this frame grows on the way into a placed
        /// solid and back, >= 1.
        condition: f64,
    }
}

record! {
    /// An occurrence of a shape, or of a placed solid.
    PlainLeaf: 16 {
        /// [`LEAF_SHAPE`] or [`LEAF_INSTANCE`].
        kind: u32,
        /// [`LEAF_COMPLEMENT`] and [`LEAF_UNUSED`], or neither.
        flags: u32,
        /// The first facet, or the instance.
        first: u32,
        /// The number of facets, or 1.
        count: u32,
    }
}

record! {
    /// The box of a leaf, in the frame of its group; may be infinite.
    PlainBox: 48 {
        /// The lower corner.
        lo: [f64; 3],
        /// The upper corner.
        hi: [f64; 3],
    }
}

record! {
    /// A side of a surface that bounds a leaf.
    PlainFacet: 8 {
        /// The surface.
        surface: u32,
        /// 1 if the leaf lies where f < 0, 0 if it lies where f > 0.
        inside: u32,
    }
}

record! {
    /// A surface in the frame of its group.
    PlainSurface: 8 {
        /// A [`SurfaceKind`] as its number.
        kind: u32,
        /// The first of its numbers.
        first: u32,
    }
}

record! {
    /// A placed solid.
    PlainInstance: 8 {
        /// The group that is placed.
        group: u32,
        /// The number of its placement, relative to that of the enclosing group.
        placement: u32,
    }
}

record! {
    /// The map into the frame of a placed solid.
    PlainMap: 104 {
        /// From the frame of the enclosing group to that of the placed group: three rows of a 3x4 matrix that acts on columns.
        local_from_world: [f64; 12],
        /// Sum of the lengths of all translations composed in the map, in units of the outer frame;
        /// tolerances grow with it.
        path: f64,
    }
}

record! {
    /// A boolean function of other nodes of its group.
    PlainGate: 16 {
        /// [`GATE_AT_LEAST`] or [`GATE_ODD`].
        rule: u32,
        /// The least number of operands that must be inside.
        least: u32,
        /// The first of its operands.
        first: u32,
        /// The number of its operands.
        count: u32,
    }
}

record! {
    /// A region of the model; record k is region k + 1.
    PlainRegion: 8 {
        /// Its medium; 0 is that of the world.
        medium: u32,
        /// Its edge in the network of group 0, the same as output k.
        edge: u32,
    }
}

/// A program as tables of records: see the [module](self).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlainProgram {
    /// The groups; the first is the model.
    pub groups: Vec<PlainGroup>,
    /// Bounds and error factors of the groups.
    pub frames: Vec<PlainFrame>,
    /// The leaves, group by group in the order of declaration.
    pub leaves: Vec<PlainLeaf>,
    /// The boxes of the leaves.
    pub boxes: Vec<PlainBox>,
    /// The facets, leaf by leaf; the index is the number of the face.
    pub facets: Vec<PlainFacet>,
    /// The surfaces, group by group.
    pub surfaces: Vec<PlainSurface>,
    /// The size and position of each surface plus the lengths of all translations composed into its map:
    /// tolerances are a multiple of it.
    pub magnitudes: Vec<f64>,
    /// The numbers of all surfaces.
    pub numbers: Vec<f64>,
    /// The placed solids.
    pub instances: Vec<PlainInstance>,
    /// The maps into their frames.
    pub maps: Vec<PlainMap>,
    /// The gates, group by group, operands before users.
    pub gates: Vec<PlainGate>,
    /// The operands of all gates: edges.
    pub operands: Vec<u32>,
    /// The outputs of all groups: edges.
    pub outputs: Vec<u32>,
    /// The regions.
    pub regions: Vec<PlainRegion>,
}

/// A table as bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlainTable {
    /// The name of the field of [`PlainProgram`].
    pub name: &'static str,
    /// The number of bytes of a record.
    pub record_size: usize,
    /// The records one after the other, little-endian.
    pub bytes: Vec<u8>,
}

impl PlainProgram {
    /// The number of media: one more than the greatest medium number; medium 0 is that of the world.
    pub fn medium_count(&self) -> u32 {
        1 + self.regions.iter().map(|region| region.medium).max().unwrap_or(0)
    }

    /// All tables as bytes, in the order of the fields.
    pub fn tables(&self) -> Vec<PlainTable> {
        vec![
            table("groups", &self.groups),
            table("frames", &self.frames),
            table("leaves", &self.leaves),
            table("boxes", &self.boxes),
            table("facets", &self.facets),
            table("surfaces", &self.surfaces),
            table("magnitudes", &self.magnitudes),
            table("numbers", &self.numbers),
            table("instances", &self.instances),
            table("maps", &self.maps),
            table("gates", &self.gates),
            table("operands", &self.operands),
            table("outputs", &self.outputs),
            table("regions", &self.regions),
        ]
    }
}

fn table<R: Record>(name: &'static str, records: &[R]) -> PlainTable {
    let mut bytes = Vec::with_capacity(R::SIZE * records.len());
    records.iter().for_each(|record| record.put(&mut bytes));
    PlainTable { name, record_size: R::SIZE, bytes }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solid;
    use rayweave_math::{Affine, Vec3};
    use rayweave_shape::primitive::{Value, build};

    /// Checks the size in memory and in bytes, the alignment, and that the bytes read back to the same
    /// record.
    fn check<R: Record + Default + PartialEq + std::fmt::Debug>(size: usize, alignment: usize) {
        assert_eq!((size_of::<R>(), R::SIZE, align_of::<R>()), (size, size, alignment));
        let counted: Vec<u8> = (0..size as u8).collect();
        let mut rest = &counted[..];
        let record = R::get(&mut rest).unwrap();
        assert!(rest.is_empty() && record != R::default());
        let mut bytes = Vec::new();
        record.put(&mut bytes);
        assert_eq!(bytes, counted);
        assert_eq!(R::get(&mut &counted[1..]), None);
    }

    #[test]
    fn records_have_fixed_sizes_and_no_padding() {
        check::<PlainGroup>(28, 4);
        check::<PlainFrame>(88, 8);
        check::<PlainLeaf>(16, 4);
        check::<PlainBox>(48, 8);
        check::<PlainFacet>(8, 4);
        check::<PlainSurface>(8, 4);
        check::<PlainInstance>(8, 4);
        check::<PlainMap>(104, 8);
        check::<PlainGate>(16, 4);
        check::<PlainRegion>(8, 4);
    }

    #[test]
    fn bytes_are_little_endian_in_the_order_of_the_fields() {
        let mut bytes = Vec::new();
        PlainLeaf { kind: 1, flags: 2, first: 0x0403_0201, count: 5 }.put(&mut bytes);
        assert_eq!(bytes, [1, 0, 0, 0, 2, 0, 0, 0, 1, 2, 3, 4, 5, 0, 0, 0]);
        bytes.clear();
        (-2.0f64).put(&mut bytes);
        assert_eq!(bytes, [0, 0, 0, 0, 0, 0, 0, 0xc0]);
    }

    fn shape(name: &str, arguments: &[(&str, Value)]) -> Solid {
        build(name, arguments).unwrap().into()
    }

    #[test]
    fn tables_of_a_small_model() {
        let ball = shape("sphere", &[("radius", 2.0.into())]);
        let pair = ball.place([-3.0, 3.0].map(|x| Affine::translate(x * Vec3::X)).to_vec());
        let model = pair - shape("half_space", &[("normal", Vec3::Z.into()), ("offset", 1.0.into())]);
        let plain = crate::Program::compile(&model).unwrap().plain().unwrap();
        let surfaces = [(SurfaceKind::Plane, 0), (SurfaceKind::Sphere, 4)];
        assert_eq!(plain.surfaces, surfaces.map(|(kind, first)| PlainSurface { kind: kind as u32, first }));
        assert_eq!(plain.numbers, [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 2.0]);
        let leaves: Vec<_> = plain.leaves.iter().map(|leaf| (leaf.kind, leaf.first, leaf.count)).collect();
        assert_eq!(
            leaves,
            [(LEAF_INSTANCE, 0, 1), (LEAF_INSTANCE, 1, 1), (LEAF_SHAPE, 0, 1), (LEAF_SHAPE, 1, 1)]
        );
        assert_eq!(plain.instances[1], PlainInstance { group: 1, placement: 2 });
        assert_eq!(plain.maps[1].local_from_world[3], -3.0);
        assert_eq!((plain.regions[0].medium, plain.medium_count()), (1, 2));
        for table in plain.tables() {
            assert_eq!(table.bytes.len() % table.record_size, 0, "{}", table.name);
        }
    }

    #[test]
    fn a_surface_without_plain_form_is_an_error_that_names_the_leaf() {
        let dome = shape("asphere", &[("aperture", 1.0.into()), ("curvature", 0.1.into())]);
        let model = shape("sphere", &[("radius", 1.0.into())]) | dome.named("dome");
        let error = crate::Program::compile(&model).unwrap().plain().unwrap_err();
        assert!(error.to_string().starts_with("leaf 1, `dome`, has no plain form: "), "{error}");
    }
}
