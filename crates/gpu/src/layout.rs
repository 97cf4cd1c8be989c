//! The tables of a program in the memory of the device.

use crate::codes::{ITEM, Kind, NONE};
use crate::error::Unsupported;
use crate::flat::{
    Atom, Flat, FlatFacet, FlatFrame, FlatGate, MOST_NODES, Operand, Tori, has_kernel, is_torus,
};
use crate::frame::Frame;
use crate::terms::{Item, Top};
use rayweave_bvh::{ExactBvh, FlatChild, WIDTH};
use rayweave_math::{Affine, Bounds, Mat3, UNIT_ROUNDOFF, Vec3, any_perpendicular};
use rayweave_model::{Face, LeafId, PlacementId, Program, PrototypeId, Rule};
use rayweave_shape::surface::Surface;
use std::collections::HashMap;

/// A bit of the keys of second chords: they are not crossed at the time of the first.
const SECOND: u32 = 1 << 29;

/// The greatest product of the norms of a map and its inverse, 3 for a similarity, for which the device holds a torus under the map.
/// The CPU's roots have an error of some u times the lengths in the frame of the torus: in the world, times this product at most,
/// and `eo` holds 256 u times them.
const MOST_STRETCH: f64 = 12.0;

/// A row of numbers.
pub(crate) type Row = [f32; 4];

/// First rows of the tables; the same order as `Params` in the shader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Starts {
    pub facets: u32,
    pub atoms: u32,
    pub gates: u32,
    pub outputs: u32,
    pub groups: u32,
    pub items: u32,
    pub media: u32,
    pub nodes: u32,
    pub children: u32,
}

/// The tables, and what the shader is specialised for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layout {
    /// Surfaces, maps and nodes of the hierarchy.
    pub data: Vec<Row>,
    pub tables: Vec<[u32; 4]>,
    pub starts: Starts,
    /// The CPU's face of each facet; its placement is relative to that of the item.
    pub faces: Vec<Face>,
    /// The placed solid of the group that has each facet, counted from 1; 0 if the group itself has it.
    pub instances: Vec<u32>,
    /// The placement of each item.
    pub placements: Vec<u32>,
    /// The region of each number that the device returns.
    pub regions: Vec<u32>,
    /// The kinds of surfaces in use, by [`Kind`].
    pub kinds: [bool; Kind::COUNT],
    /// The greatest number of atoms of a group, at least 1.
    pub atoms: usize,
    /// The greatest number of nodes of a group.
    pub nodes: usize,
    /// True if some atom lies in a frame of its own.
    pub placed_atoms: bool,
    /// True if some atom has a ball around it.
    pub balls: bool,
    /// True if some item lies in a frame of its own.
    pub placed_items: bool,
    /// Entries of the stack of the traversal; 0 if the model is a single group.
    pub stack: usize,
    /// True if every item is a group of a single atom, which is its output.
    pub is_simple: bool,
}

/// A row of the table of groups before it is placed.
struct GroupRow {
    atoms: [u32; 2],
    gates: [u32; 2],
    outputs: [u32; 2],
    is_model: bool,
}

/// Tables under construction, each from row 0.
#[derive(Default)]
struct Builder {
    layout: Layout,
    facets: Vec<[u32; 4]>,
    atoms: Vec<[u32; 4]>,
    gates: Vec<(FlatGate, usize, usize)>,
    outputs: Vec<[u32; 4]>,
    groups: Vec<GroupRow>,
    items: Vec<[u32; 4]>,
    /// Two rows per node of the hierarchy.
    children: Vec<[u32; 4]>,
    media: Vec<u32>,
    /// Rows of data of surfaces, by surface and frame.
    surfaces: HashMap<(u32, [u64; 4]), (u32, Kind)>,
    /// Groups of single facets share their output.
    single: Option<u32>,
}

impl Layout {
    /// The tables of a model that is one small group.
    pub fn small(program: &Program, flat: &Flat, frame: &Frame) -> Layout {
        let mut builder = Builder::default();
        builder.regions(program, (0..=program.regions().len() as u32).collect());
        builder.group(program, flat, frame, true);
        builder.layout.placements.push(0);
        builder.finish()
    }

    /// The tables of a model that is a union of items.
    pub fn large(program: &Program, top: &Top, frame: &Frame) -> Result<Layout, Unsupported> {
        let mut builder = Builder::default();
        builder.regions(program, top.regions.clone());
        let mut prototypes: HashMap<PrototypeId, u32> = HashMap::new();
        for item in &top.items {
            builder.item(program, item, frame, &mut prototypes)?;
        }
        builder.hierarchy(&top.items, frame);
        let single = builder.single;
        builder.layout.is_simple =
            single.is_some_and(|row| builder.groups.iter().all(|group| group.outputs == [row, 1]));
        Ok(builder.finish())
    }

    /// Bytes of the tables.
    pub fn bytes(&self) -> u64 {
        16 * (self.data.len() + self.tables.len()) as u64
    }
}

impl Builder {
    /// The regions that the numbers on the device stand for.
    fn regions(&mut self, program: &Program, regions: Vec<u32>) {
        self.media =
            regions.iter().map(|&region| program.medium_of(rayweave_model::RegionId(region))).collect();
        self.layout.regions = regions;
    }

    fn item(
        &mut self,
        program: &Program,
        item: &Item,
        frame: &Frame,
        prototypes: &mut HashMap<PrototypeId, u32>,
    ) -> Result<(), Unsupported> {
        let (group, map, placement) = match item {
            Item { instance: Some((place, prototype, placement)), .. } => {
                let inner = Frame::of(program.prototype(*prototype));
                let group = match prototypes.get(prototype) {
                    Some(&group) => group,
                    None => {
                        let outputs = program.prototype(*prototype).expression.outputs();
                        let flat = Flat::new(program, *prototype, &outputs[..1], Tori::Chords)?;
                        let group = self.group(program, &flat, &inner, false);
                        prototypes.insert(*prototype, group);
                        group
                    }
                };
                let places = [*place];
                let map = self.map(program, &places, *prototype, frame);
                self.layout.placed_items = true;
                (group, map, *placement)
            }
            Item { edge, .. } => {
                let flat = Flat::new(program, PrototypeId(0), &[*edge], Tori::Chords)?;
                (self.group(program, &flat, frame, false), NONE, 0)
            }
        };
        let first_atom = self.groups[group as usize].atoms[0];
        self.items.push([group, map, item.priority, first_atom]);
        self.layout.placements.push(placement);
        Ok(())
    }

    /// Adds a group; returns its number.
    fn group(&mut self, program: &Program, flat: &Flat, frame: &Frame, is_model: bool) -> u32 {
        let layout = &mut self.layout;
        layout.atoms = layout.atoms.max(flat.atoms.len()).max(1);
        layout.nodes = layout.nodes.max(flat.nodes());
        let frames: Vec<(u32, Frame)> = flat
            .frames
            .iter()
            .map(|FlatFrame { places, group }| {
                (self.map(program, places, *group, frame), Frame::of(program.prototype(*group)))
            })
            .collect();
        let first_atom = self.atoms.len() as u32 / 2;
        let mut keys = HashMap::new();
        for atom in &flat.atoms {
            let (map, own) = atom.frame.map_or((NONE, *frame), |k| frames[k]);
            self.layout.placed_atoms |= map != NONE;
            self.atom(program, atom, map, &own, &mut keys);
            let ball = if flat.atoms.len() > 2 { self.ball(program, atom, flat, frame) } else { NONE };
            self.atoms.push([ball, 0, 0, 0]);
        }
        let first_gate = self.gates.len() as u32;
        let count = flat.atoms.len();
        self.gates.extend(flat.gates.iter().enumerate().map(|(k, gate)| (gate.clone(), count, count + k)));
        let outputs = self.outputs_of(flat);
        self.groups.push(GroupRow {
            atoms: [first_atom, count as u32],
            gates: [first_gate, flat.gates.len() as u32],
            outputs,
            is_model,
        });
        self.groups.len() as u32 - 1
    }

    /// The range of the outputs of a group; constant outputs that are outside are left out.
    fn outputs_of(&mut self, flat: &Flat) -> [u32; 2] {
        let atoms = flat.atoms.len();
        let is_single = flat.outputs == [Operand::Atom(0, false)];
        if let (true, Some(row)) = (is_single, self.single) {
            return [row, 1];
        }
        let first = self.outputs.len() as u32;
        for (k, output) in flat.outputs.iter().enumerate() {
            let edge = match *output {
                Operand::Constant(false) => continue,
                // node MOST_NODES is never inside
                Operand::Constant(true) => (MOST_NODES as u32) << 1 | 1,
                Operand::Atom(atom, c) => (atom as u32) << 1 | u32::from(c),
                Operand::Gate(gate, c) => ((atoms + gate) as u32) << 1 | u32::from(c),
            };
            self.outputs.push([edge, k as u32 + 1, 0, 0]);
        }
        if is_single {
            self.single = Some(first);
        }
        [first, self.outputs.len() as u32 - first]
    }

    /// Adds an atom. `keys` has those of placed facets, by the frame in the group and the surface.
    fn atom(
        &mut self,
        program: &Program,
        atom: &Atom,
        map: u32,
        frame: &Frame,
        keys: &mut HashMap<(usize, u32), u32>,
    ) {
        let first = self.facets.len() as u32;
        for facet in &atom.facets {
            let surface = facet.facet.surface();
            let (row, kind) = match self.surface(program, surface.0, frame) {
                (row, Kind::FirstChord) if facet.second => (row, Kind::SecondChord),
                known => known,
            };
            self.layout.kinds[kind as usize] = true;
            // surfaces with equal numbers in one frame are one surface: a ray has the same roots in it, bit for bit
            let own = 1 << 30 | (self.layout.faces.len() as u32);
            let key = atom.frame.map_or(surface.0, |at| *keys.entry((at, surface.0)).or_insert(own));
            let key = if facet.second { key | SECOND } else { key };
            self.facets.push([row, (kind as u32) << 1 | u32::from(facet.facet.inside()), key, 0]);
            self.layout.instances.push(atom.instance);
            self.layout.faces.push(Face {
                leaf: LeafId(facet.leaf.0),
                facet: facet.number,
                surface,
                placement: PlacementId(facet.placement),
            });
        }
        if let Some(facet) = atom.facets.iter().find(|f| !has_kernel(program, f.facet, Tori::Chords)) {
            self.around(program, facet, frame);
        }
        self.atoms.push([first, self.facets.len() as u32 - first, map, atom.instance]);
    }

    /// Adds a facet in place of those without a kernel: the ball around their leaf, outside of which the leaf is not.
    fn around(&mut self, program: &Program, facet: &FlatFacet, frame: &Frame) {
        let bounds = program.leaf_bounds(facet.leaf);
        if !bounds.is_finite() || bounds.is_empty() {
            return;
        }
        let centre = frame.point(bounds.centre());
        let radius = 0.5 * bounds.size().length() / frame.scale + 1e-4;
        let row_number = self.layout.data.len() as u32;
        self.layout.data.push(row(centre, f64::from(up(radius * radius))));
        self.layout.data.push([up(f64::from(rounding(&centre.to_array())) + 1e-15), 0.0, 0.0, 0.0]);
        self.layout.kinds[Kind::Ball as usize] = true;
        self.facets.push([row_number, (Kind::Ball as u32) << 1 | 1, NONE, 0]);
        let Some(&last) = self.layout.faces.last() else { return };
        self.layout.faces.push(last);
        let instance = self.layout.instances.last().copied().unwrap_or(0);
        self.layout.instances.push(instance);
    }

    /// The row of a ball around an atom, in the frame of its group; `NONE` if the kernels of its facets are as fast as its test,
    /// or if it has none.
    fn ball(&mut self, program: &Program, atom: &Atom, flat: &Flat, frame: &Frame) -> u32 {
        let [first, rest @ ..] = &atom.facets[..] else { return NONE };
        let is_whole = rest.len() + 1 == program.leaf(first.leaf).facets().len();
        let is_fast = rest.is_empty() && atom.frame.is_none() && !is_torus(program, first.facet);
        let bounds = program.leaf_bounds(first.leaf);
        if !is_whole || is_fast || !bounds.is_finite() || bounds.is_empty() {
            return NONE;
        }
        let places = atom.frame.map_or(&[][..], |k| &flat.frames[k].places[..]);
        let Some(outer) = outer_from_inner(places) else { return NONE };
        let centre = frame.point(outer.point(bounds.centre()));
        let corners =
            bounds.corners().into_iter().map(|corner| (frame.point(outer.point(corner)) - centre).length());
        // far more than the rounding of the centre and the CPU's tolerance
        let radius = corners.fold(0.0, f64::max) + 1e-4;
        self.layout.balls = true;
        self.layout.data.push(row(centre, f64::from(up(radius * radius))));
        self.layout.data.len() as u32 - 1
    }

    /// The rows of a surface in a frame.
    fn surface(&mut self, program: &Program, number: u32, frame: &Frame) -> (u32, Kind) {
        let key = (number, [frame.centre.x, frame.centre.y, frame.centre.z, frame.scale].map(f64::to_bits));
        if let Some(&known) = self.surfaces.get(&key) {
            return known;
        }
        let row = self.layout.data.len() as u32;
        let kind = surface_rows(&program.surfaces()[number as usize].surface, frame, &mut self.layout.data);
        self.surfaces.insert(key, (row, kind));
        (row, kind)
    }

    /// The rows of the map from the frame of a group into that of a solid placed in it.
    fn map(
        &mut self,
        program: &Program,
        places: &[rayweave_model::Place],
        group: PrototypeId,
        outer: &Frame,
    ) -> u32 {
        let inner = Frame::of(program.prototype(group));
        let mut map = Affine::IDENTITY;
        // lengths that the CPU's tolerance counts, in the inner frame
        let mut path = 0.0;
        for place in places {
            let down = &place.local_from_world;
            path = down.linear_norm() * (path + place.path + outer.centre.length() + 2.0 * outer.scale);
            map = map.then(down);
        }
        let magnitude = magnitude_of(program, group);
        let tolerance = 4.0 * 64.0 * UNIT_ROUNDOFF * (path + magnitude) / inner.scale;
        let rows = outer.to(&map, &inner).to_rows();
        let at = self.layout.data.len() as u32;
        let error = |x: f64| (x - f64::from(x as f32)).abs();
        let linear = (0..3).flat_map(|k| (0..3).map(move |l| (k, l))).map(|(k, l)| error(rows[k][l]));
        let linear = linear.fold(0.0, f64::max);
        let shift = (0..3).map(|k| error(rows[k][3])).fold(0.0, f64::max) + tolerance;
        self.layout.data.extend((0..3).map(|k| rows[k].map(|x| x as f32)));
        self.layout.data.push([up(linear + 1e-15), up(shift), 0.0, 0.0]);
        at
    }

    /// The hierarchy over the items, which are put into its order.
    fn hierarchy(&mut self, items: &[Item], frame: &Frame) {
        let boxes: Vec<Bounds> = items
            .iter()
            .map(|item| Bounds { lo: frame.point(item.bounds.lo), hi: frame.point(item.bounds.hi) })
            .collect();
        let (tree, order) = ExactBvh::sorted(&boxes);
        self.items = order.iter().map(|&k| self.items[k as usize]).collect();
        self.layout.placements = order.iter().map(|&k| self.layout.placements[k as usize]).collect();
        self.layout.starts.nodes = self.layout.data.len() as u32;
        let mut depths = vec![1usize];
        for (number, node) in tree.flat().enumerate() {
            let mut planes = [[0f32; WIDTH]; 6];
            let mut children = [NONE; WIDTH];
            for (k, child) in node.children.iter().enumerate() {
                let Some(child) = child else { break };
                for axis in 0..3 {
                    planes[axis][k] = grown(node.bounds[k].lo[axis], -1.0);
                    planes[axis + 3][k] = grown(node.bounds[k].hi[axis], 1.0);
                }
                children[k] = match *child {
                    FlatChild::Node(inner) => {
                        depths.resize(depths.len().max(inner as usize + 1), 0);
                        depths[inner as usize] = depths[number] + 1;
                        inner
                    }
                    FlatChild::Item(place) => ITEM | place,
                };
            }
            let [a, b, c, d, e, f, g, h] = children;
            self.children.extend([[a, b, c, d], [e, f, g, h]]);
            let halves = planes.iter();
            self.layout.data.extend(
                halves.flat_map(|row| [[row[0], row[1], row[2], row[3]], [row[4], row[5], row[6], row[7]]]),
            );
        }
        // a node replaces its entry by up to eight
        self.layout.stack = 7 * depths.into_iter().max().unwrap_or(1) + 2;
    }

    /// Places the tables one after the other.
    fn finish(mut self) -> Layout {
        let wide = self.layout.nodes > 32;
        let mut tables: Vec<[u32; 4]> = Vec::new();
        let mut starts = self.layout.starts;
        let mut put = |rows: Vec<[u32; 4]>| {
            let at = tables.len() as u32;
            tables.extend(rows);
            at
        };
        starts.facets = put(std::mem::take(&mut self.facets));
        starts.atoms = put(std::mem::take(&mut self.atoms));
        starts.gates = put(self.gates.iter().flat_map(|gate| gate_rows(gate, wide)).collect());
        starts.outputs = put(std::mem::take(&mut self.outputs));
        let group = |g: &GroupRow| {
            let [[a, b], [c, d], [e, f]] = [g.atoms, g.gates, g.outputs];
            [[a, b, c, d], [e, f, u32::from(!g.is_model), 0]]
        };
        starts.groups = put(self.groups.iter().flat_map(group).collect());
        starts.children = put(std::mem::take(&mut self.children));
        starts.items = put(std::mem::take(&mut self.items));
        let medium = |chunk: &[u32]| std::array::from_fn(|k| chunk.get(k).copied().unwrap_or(0));
        starts.media = put(self.media.chunks(4).map(medium).collect());
        self.layout.starts = starts;
        self.layout.tables = tables;
        self.layout
    }
}

/// The rows of a gate over the nodes of its group: `atoms` atoms, then its gates; it is node `node` itself.
fn gate_rows((gate, atoms, node): &(FlatGate, usize, usize), wide: bool) -> Vec<[u32; 4]> {
    let (mut mask, mut flip) = ([0u32; 4], [0u32; 4]);
    let mut sure = 0;
    for operand in &gate.operands {
        let (place, complemented) = match *operand {
            Operand::Constant(value) => {
                sure += u32::from(value);
                continue;
            }
            Operand::Atom(k, c) => (k, c),
            Operand::Gate(k, c) => (atoms + k, c),
        };
        mask[place / 32] |= 1 << (place % 32);
        flip[place / 32] |= u32::from(complemented) << (place % 32);
    }
    // threshold 0 is odd parity
    let node = *node as u32;
    let threshold = match gate.rule {
        Rule::AtLeast(least) if least > sure => least - sure,
        Rule::AtLeast(_) => return always(node, wide),
        Rule::Odd => 0,
    };
    if gate.rule == Rule::Odd && sure % 2 == 1 {
        // complementing one operand changes the parity; without operands the gate is constant
        match (0..4).find(|&k| mask[k] != 0) {
            Some(k) => flip[k] ^= mask[k] & mask[k].wrapping_neg(),
            None => return always(node, wide),
        }
    }
    if wide { vec![mask, flip, [threshold, node, 0, 0]] } else { vec![[mask[0], flip[0], threshold, node]] }
}

/// A gate that is always inside: the complement of its own node, which is not set yet, is one operand.
fn always(node: u32, wide: bool) -> Vec<[u32; 4]> {
    let mut mask = [0u32; 4];
    mask[node as usize / 32] = 1 << (node % 32);
    if wide { vec![mask, mask, [1, node, 0, 0]] } else { vec![[mask[0], mask[0], 1, node]] }
}

/// The greatest magnitude of a surface of a group.
pub(crate) fn magnitude_of(program: &Program, group: PrototypeId) -> f64 {
    let leaves = program.prototype(group).leaves.clone();
    let facets = leaves.flat_map(|leaf| program.leaf(LeafId(leaf)).facets());
    facets.map(|facet| program.surface(facet.surface()).magnitude).fold(0.0, f64::max)
}

/// A plane of a box, moved outwards by more than the errors of the slab test, about 1e-5: coordinates are at most 8 and times at
/// most 16, so that the difference to the origin is rounded by 1e-6, the time by 6 EPS of itself, and the errors of origin and
/// direction add 2e-6.
fn grown(x: f64, sign: f64) -> f32 {
    let moved = (x + sign * 3e-5).clamp(-1e6, 1e6) as f32;
    if sign > 0.0 { moved.next_up() } else { moved.next_down() }
}

fn up(x: f64) -> f32 {
    crate::frame::above(x)
}

/// The map from the frame of a placed solid to that of the group, given the maps on the way into it.
fn outer_from_inner(places: &[rayweave_model::Place]) -> Option<Affine> {
    let down = places.iter().fold(Affine::IDENTITY, |map, place| map.then(&place.local_from_world));
    down.inverse().ok()
}

/// The error of numbers that are rounded to f32, as a number of f32.
fn rounding(numbers: &[f64]) -> f32 {
    up(numbers.iter().map(|&x| (x - f64::from(x as f32)).abs()).fold(0.0, f64::max))
}

fn row(v: Vec3, w: f64) -> Row {
    [v.x as f32, v.y as f32, v.z as f32, w as f32]
}

/// Appends the rows of a surface: see the functions of the shader for their meaning.
fn surface_rows(surface: &Surface, frame: &Frame, data: &mut Vec<Row>) -> Kind {
    // numbers that single precision cannot square are left to the CPU
    let fits = |numbers: &[f64]| numbers.iter().all(|x| x.abs() < 1e12);
    let scale = frame.scale;
    let kind = match surface {
        Surface::Plane(s) => {
            let offset = (s.offset - s.normal.dot(frame.centre)) / scale;
            let slack = 4.0 * UNIT_ROUNDOFF * (s.offset.abs() + frame.centre.length()) / scale;
            if !fits(&[offset]) {
                return Kind::Other;
            }
            data.push(row(s.normal, offset));
            data.push([rounding(&s.normal.to_array()), up(f64::from(rounding(&[offset])) + slack), 0.0, 0.0]);
            return Kind::Plane;
        }
        Surface::Sphere(s) => (s.centre, s.radius / scale, Kind::Sphere),
        Surface::Cylinder(s) => {
            let (point, square) = (frame.point(s.point), (s.radius / scale) * (s.radius / scale));
            let side = any_perpendicular(s.axis);
            let across = [side, s.axis.cross(side)];
            if !fits(&[point.x, point.y, point.z, square]) {
                return Kind::Other;
            }
            let axes: Vec<f64> = across.iter().flat_map(|v| v.to_array()).collect();
            data.push(row(point, f64::from(rounding(&point.to_array()))));
            data.push(row(across[0], f64::from(up(f64::from(rounding(&axes)) + 1e-15))));
            data.push(row(across[1], square));
            data.push([up(f64::from(rounding(&[square])) + 1e-15 * square), 0.0, 0.0, 0.0]);
            return Kind::Cylinder;
        }
        Surface::Cone(s) => {
            let side = any_perpendicular(s.axis);
            let axes = [side, s.axis.cross(side), s.axis];
            let weights = Vec3::new(1.0, 1.0, -s.slope * s.slope);
            return quadric_rows(frame.point(s.apex), axes, weights, Vec3::ZERO, 0.0, data);
        }
        Surface::Quadric(s) => {
            let linear = Vec3::from_array(s.axes.map(|e| e.dot(s.linear))) / scale;
            return quadric_rows(
                frame.point(s.centre),
                s.axes,
                s.weights,
                linear,
                s.constant / scale / scale,
                data,
            );
        }
        Surface::Torus(s) => {
            let side = any_perpendicular(s.axis);
            let axes = [side, s.axis.cross(side), s.axis];
            return torus_rows(frame.point(s.centre), axes, [s.major / scale, s.minor / scale], data);
        }
        Surface::AffineTorus(s) => {
            let size = |map: &Mat3| Affine::from_linear(*map).linear_norm();
            let stretch = size(&s.local_from_world) * size(&s.world_from_local);
            if stretch.is_nan() || stretch > MOST_STRETCH {
                return Kind::Other;
            }
            let side = any_perpendicular(s.torus.axis);
            let turned = s.local_from_world.transpose();
            let axes = [side, s.torus.axis.cross(side), s.torus.axis].map(|axis| turned * axis);
            let radii = [s.torus.major / scale, s.torus.minor / scale];
            return torus_rows(frame.point(s.centre), axes, radii, data);
        }
        Surface::Object(_) => return Kind::Other,
    };
    let (centre, radius, kind) = kind;
    let (centre, square) = (frame.point(centre), radius * radius);
    if !fits(&[centre.x, centre.y, centre.z, square]) {
        return Kind::Other;
    }
    data.push(row(centre, square));
    let error = up(f64::from(rounding(&[square])) + 1e-15 * square);
    data.push([up(f64::from(rounding(&centre.to_array())) + 1e-15), error, 0.0, 0.0]);
    kind
}

fn torus_rows(centre: Vec3, axes: [Vec3; 3], [major, minor]: [f64; 2], data: &mut Vec<Row>) -> Kind {
    let numbers = [centre.to_array(), [major, minor, minor / major]].concat();
    if !numbers.iter().all(|x| x.abs() < 1e6) {
        return Kind::Other;
    }
    let all: Vec<f64> = axes.iter().flat_map(|v| v.to_array()).collect();
    let error = |numbers: &[f64], size: f64| f64::from(up(f64::from(rounding(numbers)) + 1e-15 * size));
    let size = all.iter().fold(1.0f64, |most, x| most.max(x.abs()));
    data.push(row(centre, error(&centre.to_array(), 1.0)));
    data.push(row(axes[0], error(&all, size)));
    data.push(row(axes[1], major));
    data.push(row(axes[2], minor));
    data.push([error(&[major], major) as f32, error(&[minor], minor) as f32, 0.0, 0.0]);
    Kind::FirstChord
}

fn quadric_rows(
    centre: Vec3,
    axes: [Vec3; 3],
    weights: Vec3,
    linear: Vec3,
    constant: f64,
    data: &mut Vec<Row>,
) -> Kind {
    let numbers = [centre.to_array(), weights.to_array(), linear.to_array(), [constant; 3]].concat();
    if !numbers.iter().all(|x| x.abs() < 1e12) {
        return Kind::Other;
    }
    let all: Vec<f64> = axes.iter().flat_map(|v| v.to_array()).collect();
    let error = |numbers: &[f64], size: f64| f64::from(up(f64::from(rounding(numbers)) + 1e-15 * size));
    let sizes = [weights.abs().max_element(), linear.abs().max_element()];
    data.push(row(centre, error(&centre.to_array(), 1.0)));
    data.push(row(axes[0], error(&all, 1.0)));
    data.push(row(axes[1], error(&weights.to_array(), sizes[0])));
    data.push(row(axes[2], error(&linear.to_array(), sizes[1])));
    data.push(row(weights, constant));
    data.push(row(linear, error(&[constant], constant.abs())));
    Kind::Quadric
}
