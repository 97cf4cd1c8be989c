//! Conversion of a program to its plain view.

use super::{
    GATE_AT_LEAST, GATE_ODD, LEAF_COMPLEMENT, LEAF_INSTANCE, LEAF_SHAPE, LEAF_UNUSED, PlainBox, PlainFacet,
    PlainFrame, PlainGate, PlainGroup, PlainInstance, PlainLeaf, PlainMap, PlainProgram, PlainRegion,
    PlainSurface, SurfaceKind,
};
use crate::{Edge, Leaf, LeafId, LeafKind, Place, Program, Prototype, Rule};
use rayweave_math::{Mat3, Vec3};
use rayweave_shape::surface::Surface;

/// The reason why a program cannot be converted to its plain view.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlainError {
    /// A leaf has a surface without a fixed number of parameters: a mesh or a sag surface.
    #[error(
        "leaf {}, `{name}`, has no plain form: a surface of `{shape}` has no fixed number of parameters. \
         Trace this model on the CPU.",
        leaf.0
    )]
    Surface {
        /// The leaf.
        leaf: LeafId,
        /// Its name.
        name: String,
        /// The name of its primitive.
        shape: &'static str,
    },
    /// A table is longer than a `u32` index can address.
    #[error("the model has 2^32 or more {what}: their indices exceed 32 bits. Split the model.")]
    TooLarge {
        /// The table.
        what: &'static str,
    },
}

impl Program {
    /// The program as tables of plain records, computed in time linear in its size.
    ///
    /// # Errors
    ///
    /// [`PlainError::Surface`] for the first leaf with a mesh or a sag surface, which have no plain form;
    /// [`PlainError::TooLarge`] for a table whose indices exceed `u32`.
    pub fn plain(&self) -> Result<PlainProgram, PlainError> {
        let mut plain = PlainProgram::default();
        for leaf in self.leaves() {
            plain.leaf(self, leaf)?;
        }
        for entry in self.surfaces() {
            // never `None`: every surface belongs to a leaf, and the surfaces of all leaves have a kind
            let Some(kind) = plain_kind(&entry.surface) else { continue };
            let first = index(plain.numbers.len(), "surface parameters")?;
            plain.surfaces.push(PlainSurface { kind: kind as u32, first });
            plain.magnitudes.push(entry.magnitude);
            push_numbers(&entry.surface, &mut plain.numbers);
        }
        for group in self.prototypes() {
            plain.group(group)?;
        }
        plain.regions = self
            .regions()
            .iter()
            .zip(&plain.outputs)
            .map(|(region, &edge)| PlainRegion { medium: region.medium, edge })
            .collect();
        Ok(plain)
    }
}

/// An index or a count as a `u32`.
fn index(value: usize, what: &'static str) -> Result<u32, PlainError> {
    u32::try_from(value).map_err(|_| PlainError::TooLarge { what })
}

/// An edge as `2 * node + complement`.
fn edge_bits(edge: Edge) -> u32 {
    edge.node().0 << 1 | u32::from(edge.is_complemented())
}

impl PlainProgram {
    /// Appends a leaf, with its facets or its instance.
    fn leaf(&mut self, program: &Program, leaf: Leaf<'_>) -> Result<(), PlainError> {
        let mut flags = if leaf.is_complement() { LEAF_COMPLEMENT } else { 0 };
        flags |= if leaf.is_used() { 0 } else { LEAF_UNUSED };
        let (kind, first, count) = match leaf.kind() {
            LeafKind::Shape { facets } => (LEAF_SHAPE, facets.start, facets.end - facets.start),
            LeafKind::Instance { prototype, placement } => {
                let number = index(self.instances.len(), "placed solids")?;
                self.instances.push(PlainInstance { group: prototype.0, placement });
                self.maps.push(plain_map(&leaf.place()));
                (LEAF_INSTANCE, number, 1)
            }
        };
        for facet in leaf.facets() {
            if plain_kind(&program.surface(facet.surface()).surface).is_none() {
                let shape = leaf.shape_name().unwrap_or_default();
                return Err(PlainError::Surface { leaf: leaf.id(), name: leaf.name().into_owned(), shape });
            }
            self.facets.push(PlainFacet { surface: facet.surface().0, inside: u32::from(facet.inside()) });
        }
        let bounds = program.leaf_bounds(leaf.id());
        self.boxes.push(PlainBox { lo: bounds.lo.to_array(), hi: bounds.hi.to_array() });
        self.leaves.push(PlainLeaf { kind, flags, first, count });
        Ok(())
    }

    /// Appends a group, with its gates, outputs and frame.
    fn group(&mut self, group: &Prototype) -> Result<(), PlainError> {
        let (expression, gates) = (&group.expression, index(self.gates.len(), "gates")?);
        for (rule, operands) in expression.joins() {
            let (rule, least) = match rule {
                Rule::AtLeast(least) => (GATE_AT_LEAST, least),
                Rule::Odd => (GATE_ODD, 0),
            };
            let (first, count) =
                (index(self.operands.len(), "operands")?, index(operands.len(), "operands")?);
            self.gates.push(PlainGate { rule, least, first, count });
            self.operands.extend(operands.iter().map(|&edge| edge_bits(edge)));
        }
        self.groups.push(PlainGroup {
            first_leaf: group.leaves.start,
            leaf_count: group.leaves.end - group.leaves.start,
            first_gate: gates,
            gate_count: index(expression.joins().len(), "gates")?,
            first_output: index(self.outputs.len(), "outputs")?,
            output_count: index(expression.outputs().len(), "outputs")?,
            placements: group.placements,
        });
        self.outputs.extend(expression.outputs().iter().map(|&edge| edge_bits(edge)));
        self.frames.push(PlainFrame {
            lo: group.bounds.lo.to_array(),
            hi: group.bounds.hi.to_array(),
            ball_centre: group.ball.centre.to_array(),
            ball_radius: group.ball.radius,
            condition: group.condition,
        });
        Ok(())
    }
}

fn plain_map(place: &Place) -> PlainMap {
    let rows = place.local_from_world.to_rows();
    PlainMap { local_from_world: std::array::from_fn(|k| rows[k / 4][k % 4]), path: place.path }
}

/// The kind of a surface; `None` for a surface without a fixed number of parameters.
fn plain_kind(surface: &Surface) -> Option<SurfaceKind> {
    match surface {
        Surface::Plane(_) => Some(SurfaceKind::Plane),
        Surface::Sphere(_) => Some(SurfaceKind::Sphere),
        Surface::Cylinder(_) => Some(SurfaceKind::Cylinder),
        Surface::Cone(_) => Some(SurfaceKind::Cone),
        Surface::Quadric(_) => Some(SurfaceKind::Quadric),
        Surface::Torus(_) => Some(SurfaceKind::Torus),
        Surface::AffineTorus(_) => Some(SurfaceKind::AffineTorus),
        Surface::Object(_) => None,
    }
}

/// Appends the parameters of a surface, in the order of [`SurfaceKind`].
fn push_numbers(surface: &Surface, numbers: &mut Vec<f64>) {
    let mut vectors = |vectors: &[Vec3], scalars: &[f64]| {
        numbers.extend(vectors.iter().flat_map(|v| v.to_array()));
        numbers.extend(scalars);
    };
    match surface {
        Surface::Plane(s) => vectors(&[s.normal], &[s.offset]),
        Surface::Sphere(s) => vectors(&[s.centre], &[s.radius]),
        Surface::Cylinder(s) => vectors(&[s.point, s.axis], &[s.radius]),
        Surface::Cone(s) => vectors(&[s.apex, s.axis], &[s.slope]),
        Surface::Quadric(s) => {
            vectors(&[s.centre, s.axes[0], s.axes[1], s.axes[2], s.weights, s.linear], &[s.constant]);
        }
        Surface::Torus(s) => vectors(&[s.centre, s.axis], &[s.major, s.minor]),
        Surface::AffineTorus(s) => {
            let ([a, b, c], [d, e, f]) = (rows(&s.local_from_world), rows(&s.world_from_local));
            let torus = &s.torus;
            vectors(&[s.centre, a, b, c, d, e, f, torus.axis], &[torus.major, torus.minor]);
        }
        Surface::Object(_) => {}
    }
}

fn rows(matrix: &Mat3) -> [Vec3; 3] {
    let columns = matrix.transpose();
    [columns.x_axis, columns.y_axis, columns.z_axis]
}
