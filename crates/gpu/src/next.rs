//! The first crossing of a line after its start, on the device: tables and shader text for kernels that follow light or particles
//! from surface to surface in double precision.

use crate::codes::{BALL, CYLINDER, ITEM, NONE, PLANE, SPHERE, declarations};
use crate::error::{GpuError, Unsupported};
use crate::flat::{Atom, Flat, FlatFacet, FlatGate, Operand, Tori};
use crate::shader;
use crate::terms::{Item, Top};
use rayweave_bvh::{ExactBvh, FlatChild, WIDTH};
use rayweave_math::{Bounds, UNIT_ROUNDOFF, Vec3};
use rayweave_model::{Edge, Face, LeafId, Place, PlacementId, Program, PrototypeId, Rule, Start, SurfaceId};
use rayweave_shape::surface::Surface;
use std::collections::HashMap;
use std::rc::Rc;

/// The greatest number of atoms and gates of an item: the bits of a word, without that of the operand that is never inside.
const MOST_NODES: usize = 63;

/// The factor of the CPU's tolerance, and a thousand times it: see `shader/next.wgsl`.
const DELTA: f64 = 64.0 * UNIT_ROUNDOFF;
const TOLERANCE: f64 = 1e3 * DELTA;

/// Boxes are grown by this part of the size of the model, far more than rounding.
const GROWN: f64 = 1e-8;

/// The tables of a program for kernels with [`NextTables::shader`], to which the caller adds tables of its own.
///
/// The model is a union of items, as for rays: parts of it, or placed solids, each a small network over atoms. A point in several
/// items belongs to the region of the one with the highest priority. The items are found through a hierarchy of boxes.
#[derive(Clone, Debug, Default)]
pub struct NextTables {
    /// Numbers, `exact` in the shader.
    pub exact: Vec<f64>,
    /// Words, `words` in the shader.
    pub words: Vec<u32>,
    /// The faces by facet; the placement is relative to that of the item.
    faces: Vec<Face>,
    placements: Vec<u32>,
    keys: Vec<(SurfaceId, PlacementId)>,
    rows: Rows,
    /// The greatest number of atoms of an item, and the length of the stack of the traversal.
    atoms: u32,
    stack: usize,
    reach: f64,
}

/// The first places of the tables.
#[derive(Clone, Copy, Debug, Default)]
struct Rows {
    items: u32,
    groups: u32,
    atoms: u32,
    facets: u32,
    frames: u32,
    gates: u32,
    children: u32,
    region_of: u32,
    boxes: u32,
}

impl NextTables {
    /// The tables of a program.
    ///
    /// # Errors
    ///
    /// [`GpuError::Unsupported`] for a program that is unbounded, or of which a part has too many leaves and gates.
    pub fn new(program: &Program) -> Result<NextTables, GpuError> {
        let bounds = program.bounds();
        if !bounds.is_finite() || bounds.is_empty() {
            return Err(GpuError::Unsupported(Unsupported::Unbounded));
        }
        let top = Top::new(program).map_err(GpuError::Unsupported)?;
        let size = bounds.size().length();
        let reach = 2.0 * (size + bounds.lo.abs().max(bounds.hi.abs()).element_sum());
        let mut builder = Builder::new(program);
        // placed solids first: parts of the model know their keys
        let (placed, own): (Vec<&Item>, Vec<&Item>) =
            top.items.iter().partition(|item| item.instance.is_some());
        for item in placed.into_iter().chain(own) {
            builder.item(item).map_err(GpuError::Unsupported)?;
        }
        Ok(builder.finish(&top.regions, &bounds.grown(GROWN * size), GROWN * size, reach))
    }

    /// The text of the functions `next_crossing`, `touch` and `starts_at`, and of those that they need. The caller defines
    /// `params`, whose word `zero` is 0.
    pub fn shader(&self) -> String {
        let word = |value: u32| format!("{value}u");
        let Rows { items, groups, atoms, facets, frames, gates, children, region_of, boxes } = self.rows;
        let replacements = [
            ("@VECTORS@", format!("{}\n{}", shader::ARITHMETIC, shader::VECTORS)),
            ("@SHARED@", declarations()),
            ("@ITEM_ROWS@", word(items)),
            ("@GROUP_ROWS@", word(groups)),
            ("@ATOM_ROWS@", word(atoms)),
            ("@FACET_ROWS@", word(facets)),
            ("@FRAME_ROWS@", word(frames)),
            ("@GATE_ROWS@", word(gates)),
            ("@CHILDREN@", word(children)),
            ("@REGION_OF@", word(region_of)),
            ("@BOXES@", word(boxes)),
            // every event changes one atom, and atoms have two events each
            ("@EVENTS@", word(2 * self.atoms + 1)),
            ("@STACK@", self.stack.to_string()),
            ("@DOT_NOISE@", format!("{:?}", shader::DOT_NOISE)),
            ("@SLOW_SQUARE@", format!("{:?}", shader::SLOW_SQUARE)),
            ("@DELTA@", format!("{DELTA:?}")),
            ("@TOLERANCE@", format!("{TOLERANCE:?}")),
            ("@REACH@", format!("{:?}", self.reach)),
        ];
        let parts = [
            include_str!("shader/next.wgsl"),
            include_str!("shader/weld.wgsl"),
            include_str!("shader/contact.wgsl"),
        ];
        let text = parts.join("\n");
        replacements.iter().fold(text, |text, (name, value)| text.replace(name, value))
    }

    /// The face of a facet of an item.
    pub fn face(&self, facet: u32, item: u32) -> Option<Face> {
        let face = *self.faces.get(facet as usize)?;
        let placement = PlacementId(self.placements.get(item as usize)? + face.placement.0);
        Some(Face { placement, ..face })
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
    exact: Vec<f64>,
    items: Vec<ItemRow>,
    boxes: Vec<Bounds>,
    placements: Vec<u32>,
    groups: Vec<[u32; 5]>,
    atoms: Vec<u32>,
    /// The operands of all gates, and the gates.
    operands: Vec<u32>,
    gates: Vec<u32>,
    facets: Vec<u32>,
    frames: Vec<u32>,
    faces: Vec<Face>,
    keys: Vec<(SurfaceId, PlacementId)>,
    known_keys: HashMap<(SurfaceId, PlacementId), u32>,
    known_groups: HashMap<PrototypeId, Rc<PlacedGroup>>,
    known_surfaces: HashMap<SurfaceId, (u32, u32)>,
    most_atoms: usize,
}

/// The words of an item: group, first frame, priority, first key, number of its leaf (`NONE` if its atoms have their own).
type ItemRow = [u32; 5];

/// A group that is placed: its number, its network, and its keys with placements relative to its own.
struct PlacedGroup {
    group: u32,
    flat: Flat,
    keys: Vec<(SurfaceId, u32)>,
}

impl<'p> Builder<'p> {
    fn new(program: &'p Program) -> Builder<'p> {
        let mut builder = Builder {
            program,
            exact: Vec::new(),
            items: Vec::new(),
            boxes: Vec::new(),
            placements: Vec::new(),
            groups: Vec::new(),
            atoms: Vec::new(),
            operands: Vec::new(),
            gates: Vec::new(),
            facets: Vec::new(),
            frames: Vec::new(),
            faces: Vec::new(),
            keys: Vec::new(),
            known_keys: HashMap::new(),
            known_groups: HashMap::new(),
            known_surfaces: HashMap::new(),
            most_atoms: 1,
        };
        // frame 0 is that of the model
        builder.frame(std::iter::empty());
        builder
    }

    fn item(&mut self, item: &Item) -> Result<(), Unsupported> {
        let row = match &item.instance {
            Some((place, prototype, placement)) => {
                let placed = self.placed_group(*prototype)?;
                let leaf = item.edge.node().0 - 2;
                let frame = self.frames_of(&[*place], &placed.flat);
                let key = self.keys_of(&placed.keys, *placement);
                self.placements.push(*placement);
                [placed.group, frame, item.priority, key, leaf]
            }
            None => {
                let flat = self.flat(PrototypeId(0), item.edge)?;
                let group = self.group(&flat, None);
                let frame = if flat.frames.is_empty() { 0 } else { self.frames_of(&[], &flat) };
                self.placements.push(0);
                [group, frame, item.priority, 0, NONE]
            }
        };
        self.items.push(row);
        self.boxes.push(item.bounds);
        Ok(())
    }

    fn flat(&self, group: PrototypeId, edge: Edge) -> Result<Flat, Unsupported> {
        let flat = Flat::new(self.program, group, &[edge], Tori::Opaque)?;
        if flat.nodes() > MOST_NODES { Err(Unsupported::Nodes { limit: MOST_NODES }) } else { Ok(flat) }
    }

    fn placed_group(&mut self, prototype: PrototypeId) -> Result<Rc<PlacedGroup>, Unsupported> {
        if let Some(known) = self.known_groups.get(&prototype) {
            return Ok(known.clone());
        }
        let flat = self.flat(prototype, self.program.prototype(prototype).expression.outputs()[0])?;
        let mut keys = Vec::new();
        let group = self.group(&flat, Some(&mut keys));
        let placed = Rc::new(PlacedGroup { group, flat, keys });
        self.known_groups.insert(prototype, placed.clone());
        Ok(placed)
    }

    /// The first key of a placed solid: the keys of its surfaces follow each other.
    fn keys_of(&mut self, own: &[(SurfaceId, u32)], placement: u32) -> u32 {
        let key = |&(surface, offset): &(SurfaceId, u32)| (surface, PlacementId(placement + offset));
        // regions can have a placed solid in common
        if let Some(&known) = own.first().and_then(|first| self.known_keys.get(&key(first))) {
            return known;
        }
        let first = self.keys.len() as u32;
        for (own, number) in own.iter().zip(first..) {
            self.keys.push(key(own));
            self.known_keys.insert(key(own), number);
        }
        first
    }

    /// The words of a group: first atom, number of atoms, first gate, number of gates, output. `local` has the keys of a group that
    /// is placed.
    fn group(&mut self, flat: &Flat, mut local: Option<&mut Vec<(SurfaceId, u32)>>) -> u32 {
        let [atoms, gates] = [self.atoms.len() / 4, self.gates.len() / 3].map(|first| first as u32);
        for atom in &flat.atoms {
            self.atom(atom, local.as_deref_mut());
        }
        for FlatGate { rule, operands } in &flat.gates {
            let rule = match rule {
                Rule::AtLeast(least) => least << 1,
                Rule::Odd => 1,
            };
            self.gates.extend([rule, self.operands.len() as u32, operands.len() as u32]);
            self.operands.extend(operands.iter().map(|&operand| edge(operand, flat.atoms.len())));
        }
        self.most_atoms = self.most_atoms.max(flat.atoms.len());
        let output = edge(flat.outputs[0], flat.atoms.len());
        self.groups.push([atoms, flat.atoms.len() as u32, gates, flat.gates.len() as u32, output]);
        self.groups.len() as u32 - 1
    }

    /// The words of an atom: first facet, number of facets, frame from the first of the item, and twice the number of its leaf, plus
    /// 1 if it is the outside of its facet.
    fn atom(&mut self, atom: &Atom, mut local: Option<&mut Vec<(SurfaceId, u32)>>) {
        let first = self.faces.len() as u32;
        let Some(&leading) = atom.facets.first() else { return };
        let frame = atom.frame.map_or(0, |frame| frame as u32 + 1);
        let is_known = atom
            .facets
            .iter()
            .all(|facet| kind(&self.program.surface(facet.facet.surface()).surface).is_some());
        // the side of a sphere or cylinder where a line is at its ends
        let is_outside = is_known && !is_plane(self.program, &leading) && !leading.facet.inside();
        if is_known {
            for facet in &atom.facets {
                self.facet(facet, frame, local.as_deref_mut());
            }
        } else {
            self.ball(leading.leaf, frame);
        }
        let count = self.faces.len() as u32 - first;
        // its number in the model; without a meaning in a placed solid
        let first_leaf = self.program.prototype(PrototypeId(0)).leaves.start;
        let leaf = atom.instance.checked_sub(1).unwrap_or(leading.leaf.0.wrapping_sub(first_leaf));
        self.atoms.extend([first, count, frame, leaf << 1 | u32::from(is_outside)]);
    }

    fn facet(&mut self, own: &FlatFacet, frame: u32, local: Option<&mut Vec<(SurfaceId, u32)>>) {
        let surface = own.facet.surface();
        let (kind, at) = self.surface(surface);
        let key = match local {
            Some(keys) => {
                let own = (surface, own.placement);
                keys.iter().position(|known| *known == own).unwrap_or_else(|| {
                    keys.push(own);
                    keys.len() - 1
                }) as u32
            }
            None => {
                let (next, own) = (self.keys.len() as u32, (surface, PlacementId(own.placement)));
                let key = *self.known_keys.entry(own).or_insert(next);
                if key == next {
                    self.keys.push(own);
                }
                key
            }
        };
        self.facets.extend([kind, u32::from(own.facet.inside()), at, key, frame]);
        let placement = PlacementId(own.placement);
        self.faces.push(Face { leaf: own.leaf, facet: own.number, surface, placement });
    }

    /// A facet in place of those that the device does not know: the ball around the box of their leaf.
    fn ball(&mut self, leaf: LeafId, frame: u32) {
        let bounds = self.program.leaf_bounds(leaf);
        let (centre, radius) = match bounds.is_finite() && !bounds.is_empty() {
            true => (bounds.centre(), 0.5 * bounds.size().length() * (1.0 + GROWN)),
            false => (Vec3::ZERO, 1e100),
        };
        let at = self.exact.len() as u32;
        self.exact.extend(centre.to_array());
        self.exact.push(radius * radius);
        self.facets.extend([BALL, 1, at, NONE, frame]);
        let surface = self.program.leaf(leaf).facets().first().map_or(SurfaceId(0), |facet| facet.surface());
        self.faces.push(Face { leaf, facet: 0, surface, placement: PlacementId(0) });
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

    /// The first frame of an item: that of the item itself, then those in its group.
    fn frames_of(&mut self, places: &[Place], flat: &Flat) -> u32 {
        let first = self.frames.len() as u32 / 3;
        self.frame(places.iter());
        for frame in &flat.frames {
            self.frame(places.iter().chain(&frame.places));
        }
        first
    }

    /// Adds a frame, by the maps into it, outermost first. Its words: the place of its maps, their number, the place of its lengths.
    fn frame<'a>(&mut self, places: impl Iterator<Item = &'a Place>) {
        let at = self.exact.len() as u32;
        // the lengths in the frame are `factor` times those in the world, plus `path`
        let (mut count, mut factor, mut path) = (0, 1.0, 0.0);
        for place in places {
            let map = place.local_from_world;
            let columns = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis, map.translation];
            columns.iter().for_each(|column| self.exact.extend(column.to_array()));
            let norm = map.linear_norm();
            self.exact.extend([norm, place.path]);
            path = norm * (path + place.path);
            factor *= norm;
            count += 1;
        }
        let lengths = self.exact.len() as u32;
        self.exact.extend([factor, path]);
        self.frames.extend([at, count, lengths]);
    }

    /// The hierarchy over the items, which are put into its order: the children of its nodes and their boxes; the length of the stack
    /// for a traversal.
    fn hierarchy(&mut self, model: &Bounds, margin: f64) -> (Vec<u32>, Vec<f64>, usize) {
        let boxes: Vec<Bounds> = self.boxes.iter().map(|own| own.grown(margin).intersection(model)).collect();
        let (tree, order) = ExactBvh::sorted(&boxes);
        self.items = order.iter().map(|&k| self.items[k as usize]).collect();
        self.placements = order.iter().map(|&k| self.placements[k as usize]).collect();
        let (mut children, mut numbers, mut depths) = (Vec::new(), Vec::new(), vec![1usize]);
        for (number, node) in tree.flat().enumerate() {
            for child in node.children {
                children.push(match child {
                    None => NONE,
                    Some(FlatChild::Item(place)) => ITEM | place,
                    Some(FlatChild::Node(inner)) => {
                        depths.resize(depths.len().max(inner as usize + 1), 0);
                        depths[inner as usize] = depths[number] + 1;
                        inner
                    }
                });
            }
            for corner in [|own: &Bounds| own.lo, |own: &Bounds| own.hi] {
                numbers.extend((0..3).flat_map(|axis| node.bounds.iter().map(move |own| corner(own)[axis])));
            }
        }
        // a node replaces its entry by up to eight
        (children, numbers, (WIDTH - 1) * depths.into_iter().max().unwrap_or(1) + 2)
    }

    fn finish(mut self, regions: &[u32], model: &Bounds, margin: f64, reach: f64) -> NextTables {
        let (children, boxes, stack) = self.hierarchy(model, margin);
        let mut words = std::mem::take(&mut self.operands);
        let mut put = |rows: &[u32]| {
            let at = words.len() as u32;
            words.extend(rows);
            at
        };
        let mut exact = self.exact;
        let rows = Rows {
            items: put(self.items.as_flattened()),
            groups: put(self.groups.as_flattened()),
            atoms: put(&self.atoms),
            facets: put(&self.facets),
            frames: put(&self.frames),
            gates: put(&self.gates),
            children: put(&children),
            region_of: put(regions),
            boxes: exact.len() as u32,
        };
        exact.extend(boxes.iter().map(|x| x.clamp(-1e300, 1e300)));
        NextTables {
            exact,
            words,
            faces: self.faces,
            placements: self.placements,
            keys: self.keys,
            rows,
            atoms: self.most_atoms as u32,
            stack,
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
