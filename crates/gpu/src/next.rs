//! The first crossing of a line after its start, on the device: tables and shader text for kernels that follow light or particles
//! from surface to surface in double precision.

use crate::error::{GpuError, Unsupported};
use crate::flat::{Atom, Flat, FlatFacet, FlatGate, Operand, Tori};
use crate::shader;
use rayweave_math::{Bounds, UNIT_ROUNDOFF};
use rayweave_model::{Face, LeafId, PlacementId, Program, PrototypeId, Rule, Start, SurfaceId};
use rayweave_shape::surface::Surface;
use std::collections::HashMap;

/// The greatest number of atoms and gates: the bits of a word, without that of the operand that is never inside.
const MOST_NODES: usize = 63;

/// A thousand times the factor of the CPU's tolerance, `64 u`: see `shader/next.wgsl`.
const TOLERANCE: f64 = 1e3 * 64.0 * UNIT_ROUNDOFF;

/// Boxes are grown by this part of the size of the model, far more than rounding.
const GROWN: f64 = 1e-8;

const NO_FRAME: u32 = u32::MAX;

/// Kinds of surfaces; the numbers are those in the shader.
const PLANE: u32 = 1;
const SPHERE: u32 = 2;
const CYLINDER: u32 = 3;
const BALL: u32 = 4;

/// The tables of a program for kernels with [`NextTables::shader`], to which the caller adds tables of its own.
#[derive(Clone, Debug, Default)]
pub struct NextTables {
    /// Numbers, `exact` in the shader.
    pub exact: Vec<f64>,
    /// Words, `words` in the shader.
    pub words: Vec<u32>,
    faces: Vec<Face>,
    keys: Vec<(SurfaceId, PlacementId)>,
    sizes: [u32; 3],
    rows: [u32; 6],
    reach: f64,
}

impl NextTables {
    /// The tables of a program.
    ///
    /// # Errors
    ///
    /// [`GpuError::Unsupported`] for a program that is unbounded, or that has too many leaves and gates.
    pub fn new(program: &Program) -> Result<NextTables, GpuError> {
        let edges = program.prototype(PrototypeId(0)).expression.outputs();
        let flat = Flat::new(program, PrototypeId(0), edges, Tori::Opaque).map_err(GpuError::Unsupported)?;
        if flat.nodes() > MOST_NODES {
            return Err(GpuError::Unsupported(Unsupported::Nodes { limit: MOST_NODES }));
        }
        let bounds = program.bounds();
        if !bounds.is_finite() || bounds.is_empty() {
            return Err(GpuError::Unsupported(Unsupported::Unbounded));
        }
        let size = bounds.size().length();
        let reach = 2.0 * (size + bounds.lo.abs().max(bounds.hi.abs()).element_sum());
        let mut builder = Builder::new(program, size);
        flat.atoms.iter().for_each(|atom| builder.atom(atom));
        Ok(builder.finish(&flat, reach))
    }

    /// The text of the functions `next_crossing`, `touch` and `is_alone`, and of those that they need. The caller defines
    /// `params`, whose word `zero` is 0.
    pub fn shader(&self) -> String {
        let [atoms, gates, outputs] = self.sizes;
        let word = |value: u32| format!("{value}u");
        let [atom_rows, facet_rows, frame_rows, gate_rows, output_rows, _] = self.rows;
        let replacements = [
            ("@VECTORS@", format!("{}\n{}", shader::ARITHMETIC, shader::VECTORS)),
            ("@ATOMS@", word(atoms)),
            ("@GATES@", word(gates)),
            ("@OUTPUTS@", word(outputs)),
            ("@ATOM_ROWS@", word(atom_rows)),
            ("@FACET_ROWS@", word(facet_rows)),
            ("@FRAME_ROWS@", word(frame_rows)),
            ("@GATE_ROWS@", word(gate_rows)),
            ("@OUTPUT_ROWS@", word(output_rows)),
            // every event changes at most one atom, and atoms have two events each
            ("@ROUNDS@", word(2 * atoms + 1)),
            ("@DOT_NOISE@", format!("{:?}", shader::DOT_NOISE)),
            ("@SLOW_SQUARE@", format!("{:?}", shader::SLOW_SQUARE)),
            ("@TOLERANCE@", format!("{TOLERANCE:?}")),
            ("@REACH@", format!("{:?}", self.reach)),
        ];
        let text = include_str!("shader/next.wgsl").to_owned();
        replacements.iter().fold(text, |text, (name, value)| text.replace(name, value))
    }

    /// The place in the words where the frame of each facet is.
    pub fn frame_of(&self) -> u32 {
        self.rows[5]
    }

    /// The face of a facet.
    pub fn face(&self, facet: u32) -> Option<Face> {
        self.faces.get(facet as usize).copied()
    }

    /// The surface on which a line starts: `None` for 0, otherwise the number is one more than twice the key of a surface, plus 1
    /// inside of it.
    pub fn start(&self, start: u32) -> Option<Start> {
        let number = start.checked_sub(1)?;
        let &(surface, placement) = self.keys.get(number as usize / 2)?;
        Some(Start { surface, placement, inside: number % 2 == 1 })
    }
}

/// Tables under construction.
struct Builder<'p> {
    program: &'p Program,
    size: f64,
    exact: Vec<f64>,
    atoms: Vec<u32>,
    facets: Vec<u32>,
    frames: Vec<u32>,
    frame_of: Vec<u32>,
    faces: Vec<Face>,
    keys: Vec<(SurfaceId, PlacementId)>,
    known_keys: HashMap<(SurfaceId, PlacementId), u32>,
    known_frames: HashMap<PlacementId, u32>,
    known_surfaces: HashMap<SurfaceId, (u32, u32)>,
}

impl<'p> Builder<'p> {
    fn new(program: &'p Program, size: f64) -> Builder<'p> {
        Builder {
            program,
            size,
            exact: Vec::new(),
            atoms: Vec::new(),
            facets: Vec::new(),
            frames: Vec::new(),
            frame_of: Vec::new(),
            faces: Vec::new(),
            keys: Vec::new(),
            known_keys: HashMap::new(),
            known_frames: HashMap::new(),
            known_surfaces: HashMap::new(),
        }
    }

    fn atom(&mut self, atom: &Atom) {
        let first = self.faces.len() as u32;
        let Some(&leading) = atom.facets.first() else { return };
        let placement = PlacementId(leading.placement);
        let frame = self.frame(placement);
        let is_known = atom
            .facets
            .iter()
            .all(|facet| kind(&self.program.surface(facet.facet.surface()).surface).is_some());
        // the side of a sphere or cylinder where a line is at its ends
        let is_outside = is_known && !is_plane(self.program, &leading) && !leading.facet.inside();
        if is_known {
            for facet in &atom.facets {
                self.facet(facet, placement, frame);
            }
        } else {
            self.ball(leading.leaf, placement, frame);
        }
        let corners = self.world_box(leading.leaf, placement);
        let count = self.faces.len() as u32 - first;
        self.atoms.extend([first, count, frame, u32::from(is_outside), corners]);
    }

    fn facet(&mut self, own: &FlatFacet, placement: PlacementId, frame: u32) {
        let surface = own.facet.surface();
        let (kind, at) = self.surface(surface);
        let next = self.keys.len() as u32;
        let key = *self.known_keys.entry((surface, placement)).or_insert(next);
        if key == next {
            self.keys.push((surface, placement));
        }
        self.facets.extend([kind, u32::from(own.facet.inside()), at, key]);
        self.frame_of.push(frame);
        self.faces.push(Face { leaf: own.leaf, facet: own.number, surface, placement });
    }

    /// A facet in place of those that the device does not know: the ball around the box of their leaf.
    fn ball(&mut self, leaf: LeafId, placement: PlacementId, frame: u32) {
        let bounds = self.program.leaf_bounds(leaf);
        let (centre, radius) = match bounds.is_finite() && !bounds.is_empty() {
            true => (bounds.centre(), 0.5 * bounds.size().length() * (1.0 + GROWN)),
            false => (rayweave_math::Vec3::ZERO, 1e100),
        };
        let at = self.exact.len() as u32;
        self.exact.extend(centre.to_array());
        self.exact.push(radius * radius);
        self.facets.extend([BALL, 1, at, u32::MAX]);
        self.frame_of.push(frame);
        let surface = self.program.leaf(leaf).facets().first().map_or(SurfaceId(0), |facet| facet.surface());
        self.faces.push(Face { leaf, facet: 0, surface, placement });
    }

    /// The kind and the place of the numbers of a surface.
    fn surface(&mut self, surface: SurfaceId) -> (u32, u32) {
        if let Some(&known) = self.known_surfaces.get(&surface) {
            return known;
        }
        let at = self.exact.len() as u32;
        let entry = self.program.surface(surface);
        match &entry.surface {
            Surface::Plane(s) => {
                self.exact.extend(s.normal.to_array());
                self.exact.push(s.offset);
            }
            Surface::Sphere(s) => {
                self.exact.extend(s.centre.to_array());
                self.exact.extend([s.radius * s.radius, s.radius]);
            }
            Surface::Cylinder(s) => {
                self.exact.extend(s.point.to_array());
                self.exact.extend(s.axis.to_array());
                self.exact.extend([s.radius * s.radius, s.radius]);
            }
            _ => {}
        }
        self.exact.push(entry.magnitude);
        let found = (kind(&entry.surface).unwrap_or(BALL), at);
        self.known_surfaces.insert(surface, found);
        found
    }

    /// The number of the frame of a placement.
    fn frame(&mut self, placement: PlacementId) -> u32 {
        if placement == PlacementId(0) {
            return NO_FRAME;
        }
        let next = self.known_frames.len() as u32;
        let frame = *self.known_frames.entry(placement).or_insert(next);
        if frame < next {
            return frame;
        }
        let at = self.exact.len() as u32;
        // the lengths in the frame are `factor` times those in the world, plus `path`
        let (mut count, mut factor, mut path) = (0, 1.0, 0.0);
        for place in self.program.descend(placement) {
            let map = place.local_from_world;
            let columns = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis, map.translation];
            columns.iter().for_each(|column| self.exact.extend(column.to_array()));
            let norm = map.linear_norm();
            path = norm * (path + place.path);
            factor *= norm;
            count += 1;
        }
        let lengths = self.exact.len() as u32;
        self.exact.extend([factor, path]);
        self.frames.extend([at, count, lengths]);
        frame
    }

    /// The place of the box of a leaf in the world.
    fn world_box(&mut self, leaf: LeafId, placement: PlacementId) -> u32 {
        let local = self.program.leaf_bounds(leaf);
        let outer = match local.is_finite() {
            true => local.transformed(&self.program.placement(placement).0).grown(GROWN * self.size),
            false => Bounds::ALL,
        };
        let at = self.exact.len() as u32;
        let number = |x: f64| x.clamp(-1e300, 1e300);
        self.exact.extend(outer.lo.to_array().map(number));
        self.exact.extend(outer.hi.to_array().map(number));
        at
    }

    fn finish(self, flat: &Flat, reach: f64) -> NextTables {
        let mut words = Vec::new();
        let mut put = |rows: &[u32]| {
            let at = words.len() as u32;
            words.extend(rows);
            at
        };
        let [atoms, facets, frames, frame_of] =
            [&self.atoms, &self.facets, &self.frames, &self.frame_of].map(|rows| put(rows));
        let edges = |operands: &[Operand]| -> Vec<u32> {
            operands.iter().map(|&operand| edge(operand, flat.atoms.len())).collect()
        };
        let gates: Vec<u32> = flat
            .gates
            .iter()
            .flat_map(|FlatGate { rule, operands }| {
                let first = put(&edges(operands));
                let rule = match rule {
                    Rule::AtLeast(least) => least << 1,
                    Rule::Odd => 1,
                };
                [rule, first, operands.len() as u32]
            })
            .collect();
        let (gates, outputs) = (put(&gates), put(&edges(&flat.outputs)));
        NextTables {
            exact: self.exact,
            faces: self.faces,
            keys: self.keys,
            sizes: [flat.atoms.len(), flat.gates.len(), flat.outputs.len()].map(|size| size as u32),
            rows: [atoms, facets, frames, gates, outputs, frame_of],
            words,
            reach,
        }
    }
}

/// An operand as twice the number of its node, plus 1 if it is complemented.
fn edge(operand: Operand, atoms: usize) -> u32 {
    let node = |node: usize, complemented: bool| (node as u32) << 1 | u32::from(complemented);
    match operand {
        // this node is never inside
        Operand::Constant(value) => node(MOST_NODES, value),
        Operand::Atom(k, complemented) => node(k, complemented),
        Operand::Gate(k, complemented) => node(atoms + k, complemented),
    }
}

/// The kind of a surface that the device knows.
fn kind(surface: &Surface) -> Option<u32> {
    match surface {
        Surface::Plane(_) => Some(PLANE),
        Surface::Sphere(_) => Some(SPHERE),
        Surface::Cylinder(_) => Some(CYLINDER),
        _ => None,
    }
}

fn is_plane(program: &Program, facet: &FlatFacet) -> bool {
    matches!(program.surface(facet.facet.surface()).surface, Surface::Plane(_))
}
