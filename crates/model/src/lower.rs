//! Lowering: from a tree of solids to the boolean formula of each group, before simplification.
//!
//! One traversal with an explicit stack: it composes transforms on the way down and numbers leaves and
//! operators in the order of the traversal. Shared sub-trees are visited once per placement.

use crate::drive::Cancel;
use crate::leaf::MAX_LEAVES;
use crate::number_map::NumberMap;
use crate::simplify::{Formula, Op};
use crate::size::LeafLimit;
use crate::trail::{Naming, TOP, Trail, TrailBuilder};
use crate::{CompileError, CompileProblem, Copies, Edge, LeafId, Node, PrototypeId, Solid};
use rayweave_math::{Affine, CompactAffine};
use rayweave_shape::primitive::Primitive;
use std::sync::Arc;

/// A group of leaves in one frame, with the solids that are its outputs.
pub(crate) struct Group<'a> {
    /// The unsimplified formula, with one output per solid.
    pub formula: Formula,
    /// Names of compound solids, by the node number in the formula.
    pub names: NumberMap<u32, Arc<str>>,
    /// Leaves, or runs of instances, in order.
    pub parts: Vec<Part<'a>>,
    pub leaf_count: usize,
    /// The names around the leaves.
    pub trail: Trail,
    contexts: Vec<Context<'a>>,
    maps: Maps,
}

/// A map into the frame of a group, and the sum of the lengths of the translations composed into it.
type Map = (Affine, f64);

/// The maps of a group, in order: one for each leaf of many models.
#[derive(Default)]
struct Maps(Vec<(CompactAffine, f64)>);

impl Maps {
    fn get(&self, number: u32) -> Map {
        let (map, way) = &self.0[number as usize];
        (map.get(), *way)
    }

    fn push(&mut self, (map, way): Map) {
        self.0.push((map.into(), way));
    }
}

impl Group<'_> {
    /// The formula and the trail, without what only messages need.
    pub fn into_formula(self) -> (Formula, Trail) {
        (self.formula, self.trail)
    }

    /// The path from the root to a leaf, for messages. Computed on demand: the paths to all leaves of a deep
    /// tree have quadratic total length.
    pub fn path(&self, part: &Part<'_>) -> String {
        let what = match &part.content {
            Content::Shape(primitive) => primitive.name(),
            Content::Copies(..) => "place",
        };
        path(&self.contexts, part.context, what)
    }

    /// The map of a part into the frame of the group, and the sum of the lengths of the translations composed
    /// into it.
    pub fn place(&self, part: &Part<'_>) -> Map {
        self.maps.get(self.contexts[part.context as usize].map)
    }

    /// The name of the compound around a leaf's own name, if it is at most [`MAX_NAME_LEVELS`] levels up.
    pub fn outer_name(&self, part: &Part<'_>) -> Option<&str> {
        let above = |&context: &u32| (context != 0).then(|| self.contexts[context as usize].parent);
        let contexts = std::iter::successors(Some(part.context), above).take(MAX_NAME_LEVELS);
        contexts.filter_map(|context| self.contexts[context as usize].name).map(|name| &**name).nth(1)
    }
}

/// Maximum number of maps and names searched for an outer name, so that naming all leaves of a deep tree takes linear
/// time.
const MAX_NAME_LEVELS: usize = 64;

/// A leaf, or the copies of a placed solid, before transformation into the group's frame.
pub(crate) struct Part<'a> {
    /// The name of the leaf; copies append their number.
    pub name: Arc<str>,
    /// The context: composed map and names.
    context: u32,
    /// True if a name of the context is that of this part alone.
    is_named: bool,
    pub content: Content<'a>,
}

/// The content of a part: a shape, or the maps of the copies of a placed solid.
pub(crate) enum Content<'a> {
    Shape(&'a Primitive),
    Copies(PrototypeId, &'a Solid, &'a Copies),
}

/// Lowers solids, and all solids placed in them, to groups. The first group is the model itself.
pub(crate) fn lower<'a>(solids: &[&'a Solid], limit: &LeafLimit) -> Result<Vec<Group<'a>>, CompileError> {
    limit.check(solids)?;
    let cancel = Cancel::current();
    let mut prototypes = Prototypes::default();
    let mut groups = vec![Lowering::new(&mut prototypes, false).run(solids, &cancel)?];
    while groups.len() <= prototypes.solids.len() {
        let solid = prototypes.solids[groups.len() - 1];
        groups.push(Lowering::new(&mut prototypes, true).run(&[solid], &cancel)?);
    }
    Ok(groups)
}

/// The placed solids found so far, each once; number k is group k + 1.
#[derive(Default)]
struct Prototypes<'a> {
    known: NumberMap<usize, PrototypeId>,
    solids: Vec<&'a Solid>,
}

impl<'a> Prototypes<'a> {
    fn of(&mut self, solid: &'a Solid) -> PrototypeId {
        *self.known.entry(solid.address()).or_insert_with(|| {
            self.solids.push(solid);
            PrototypeId::from(self.solids.len())
        })
    }
}

/// A position in the traversal: the composed map and the names on the path.
#[derive(Clone, Copy)]
struct Context<'a> {
    parent: u32,
    name: Option<&'a Arc<str>>,
    /// The labelled single copy that contains this context.
    copy: Option<&'a Copies>,
    /// The innermost context with a name or a copy, this one included; 0 if there is none.
    step: u32,
    /// The innermost context with a name, this one included; 0 if there is none.
    named: u32,
    /// True if only maps and complements lie between that name and this position.
    direct: bool,
    /// The context of the name of the solid around this position that was made as a whole, such as an extruded outline; 0 if there is
    /// none. The names of its faces begin with it.
    whole: u32,
    /// The number of the composed map, which a name shares with the context around it.
    map: u32,
}

/// A node (by address) and the context of its visit.
type Key = (usize, u32);

/// An operator whose operands are being collected.
struct Frame {
    op: Op,
    complemented: bool,
    /// The index of its first operand.
    first: usize,
    name: Option<Arc<str>>,
}

/// A node to be visited.
#[derive(Clone, Copy)]
struct Visit<'a> {
    solid: &'a Solid,
    context: u32,
    complemented: bool,
}

enum Task<'a> {
    Visit(Visit<'a>),
    /// The end of the visit to a node with several handles, whose operand is the last one.
    Record(Visit<'a>),
    Close,
}

struct Lowering<'p, 'a> {
    prototypes: &'p mut Prototypes<'a>,
    formula: Formula,
    names: NumberMap<u32, Arc<str>>,
    parts: Vec<Part<'a>>,
    leaf_count: usize,
    contexts: Vec<Context<'a>>,
    maps: Maps,
    /// True until the first node that is not a map or complement: a name there is that of the whole group.
    at_root: bool,
    /// The context of the name of the whole group; 0 if there is none.
    own: u32,
    leaf_names: LeafNames,
    /// The edges of the nodes with several handles, which may be visited again in the same context. All others are visited once
    /// in each context around them.
    done: NumberMap<Key, Edge>,
    tasks: Vec<Task<'a>>,
    frames: Vec<Frame>,
    /// Stack of operands that no operator has consumed yet.
    operands: Vec<Edge>,
}

impl<'p, 'a> Lowering<'p, 'a> {
    fn new(prototypes: &'p mut Prototypes<'a>, is_placed: bool) -> Self {
        let root =
            Context { parent: 0, name: None, copy: None, step: 0, named: 0, direct: false, whole: 0, map: 0 };
        Lowering {
            prototypes,
            formula: Formula::default(),
            names: NumberMap::default(),
            parts: Vec::new(),
            leaf_count: 0,
            contexts: vec![root],
            maps: Maps(vec![(Affine::IDENTITY.into(), 0.0)]),
            at_root: is_placed,
            own: 0,
            leaf_names: LeafNames::default(),
            done: NumberMap::default(),
            tasks: Vec::new(),
            frames: Vec::new(),
            operands: Vec::new(),
        }
    }

    fn run(mut self, solids: &[&'a Solid], cancel: &Cancel) -> Result<Group<'a>, CompileError> {
        self.visit_all(solids.iter().copied(), 0);
        while let Some(task) = self.tasks.pop() {
            if cancel.is_cancelled() {
                return Err(CompileError::cancelled());
            }
            match task {
                Task::Visit(visit) => self.visit(visit)?,
                Task::Record(visit) => self.record(visit),
                Task::Close => self.close(),
            }
        }
        self.operands.iter().for_each(|&output| self.formula.add_output(output));
        // the trail takes memory too
        self.done = Default::default();
        let Lowering { formula, names, parts, leaf_count, contexts, maps, own, .. } = self;
        let trail = trail(&contexts, &parts, own);
        Ok(Group { formula, names, parts, leaf_count, trail, contexts, maps })
    }

    /// Pushes operands onto the stack in reverse, so that they are visited in order.
    fn visit_all(&mut self, operands: impl DoubleEndedIterator<Item = &'a Solid>, context: u32) {
        let visit = |solid: &'a Solid| Visit { solid, context, complemented: false };
        self.tasks.extend(operands.rev().map(|solid| Task::Visit(visit(solid))));
    }

    /// Visits a node, or reuses the edge of a visit to it in the same context.
    fn visit(&mut self, visit: Visit<'a>) -> Result<(), CompileError> {
        let Visit { solid, context, complemented } = visit;
        let at_root = std::mem::take(&mut self.at_root);
        if solid.is_shared() {
            if let Some(&edge) = self.done.get(&(solid.address(), context)) {
                self.operand(edge, complemented);
                return Ok(());
            }
            self.tasks.push(Task::Record(visit));
        }
        if solid.boundary().is_some() {
            self.enter_whole(context);
        }
        match solid.node() {
            Node::Empty => self.operand(Edge::EMPTY, complemented),
            Node::Universe => self.operand(Edge::UNIVERSE, complemented),
            Node::Primitive(primitive) => self.shape(visit, primitive)?,
            Node::Complement(inner) => {
                self.at_root = at_root;
                self.pass(inner, Visit { complemented: !complemented, ..visit });
            }
            Node::Transformed(map, inner) => {
                self.at_root = at_root;
                let context = self.moved(&visit, &map.get(), None)?;
                self.pass(inner, Visit { context, ..visit });
            }
            Node::Named(name, inner) => {
                let context = self.named(&visit, name);
                self.own = if at_root { context } else { self.own };
                self.pass(inner, Visit { context, ..visit });
            }
            Node::Union(all) => self.join(Op::Union, visit, all.iter()),
            Node::Intersection(all) => self.join(Op::Intersection, visit, all.iter()),
            Node::Difference(a, b) => self.join(Op::Difference, visit, [a, b].into_iter()),
            Node::SymmetricDifference(all) => self.join(Op::SymmetricDifference, visit, all.iter()),
            Node::Placed(inner, maps) => self.placed(visit, inner, maps)?,
        }
        Ok(())
    }

    fn operand(&mut self, edge: Edge, complemented: bool) {
        self.operands.push(if complemented { edge.complement() } else { edge });
    }

    fn record(&mut self, Visit { solid, context, complemented }: Visit<'a>) {
        if let Some(&edge) = self.operands.last() {
            self.done.insert((solid.address(), context), if complemented { edge.complement() } else { edge });
        }
    }

    /// Continues with the only operand of a map, name or complement, which is not a node of the formula.
    fn pass(&mut self, inner: &'a Solid, visit: Visit<'a>) {
        self.tasks.push(Task::Visit(Visit { solid: inner, ..visit }));
    }

    /// Opens a frame for an operator.
    fn join(&mut self, op: Op, visit: Visit<'a>, operands: impl DoubleEndedIterator<Item = &'a Solid>) {
        let Visit { context, complemented, .. } = visit;
        let (name, first) = (self.undirect(context), self.operands.len());
        self.frames.push(Frame { op, complemented, first, name });
        self.tasks.push(Task::Close);
        self.visit_all(operands, context);
    }

    fn close(&mut self) {
        let Some(Frame { op, complemented, first, name }) = self.frames.pop() else {
            return;
        };
        let edge = self.formula.join(op, &self.operands[first..]);
        self.operands.truncate(first);
        if let Some(name) = name {
            self.names.insert(edge.node().0, name);
        }
        self.operand(edge, complemented);
    }

    fn shape(&mut self, visit: Visit<'a>, primitive: &'a Primitive) -> Result<(), CompileError> {
        let Visit { context, complemented, .. } = visit;
        let (name, what) = (self.leaf_name(context, primitive.name()), primitive.name());
        let (is_named, content) = (self.is_named(context), Content::Shape(primitive));
        let leaf = self.part(Part { name, context, is_named, content }, 1, what)?;
        let edge = self.formula.leaf(leaf);
        self.operand(edge, complemented);
        Ok(())
    }

    /// Adds a part with `leaves` leaves and returns the number of the first.
    fn part(&mut self, part: Part<'a>, leaves: usize, what: &str) -> Result<LeafId, CompileError> {
        let first = self.leaf_count;
        if first + leaves > MAX_LEAVES {
            let path = self.path(part.context, what);
            return Err(CompileError { path, problem: CompileProblem::TooLarge { what: "leaves" } });
        }
        self.parts.push(part);
        self.leaf_count += leaves;
        Ok(LeafId::from(first))
    }

    /// The union of instances; a single one is lowered as an ordinary transform.
    fn placed(&mut self, visit: Visit<'a>, inner: &'a Solid, maps: &'a Copies) -> Result<(), CompileError> {
        let Visit { context, complemented, .. } = visit;
        match maps[..] {
            // a solid without placements gets no group: nothing in the program would refer to it
            [] => self.operand(Edge::EMPTY, complemented),
            [ref map] => {
                let context = self.moved(&visit, map, maps.label().map(|_| maps))?;
                self.pass(inner, Visit { context, ..visit });
            }
            _ => {
                let edge = self.instances(context, inner, maps)?;
                self.operand(edge, complemented);
            }
        }
        Ok(())
    }

    fn instances(&mut self, context: u32, inner: &'a Solid, maps: &'a Copies) -> Result<Edge, CompileError> {
        let prototype = self.prototypes.of(inner);
        let name = self.leaf_name(context, "place");
        for (number, map) in maps.iter().enumerate() {
            map.inverse().map_err(|e| {
                let path = self.path(context, &format!("{name}[{number}]"));
                CompileError { path, problem: e.into() }
            })?;
        }
        let (is_named, content) = (self.is_named(context), Content::Copies(prototype, inner, maps));
        let first = self.part(Part { name, context, is_named, content }, maps.len(), "place")?;
        let edges: Vec<Edge> =
            (0..maps.len() as u32).map(|k| self.formula.leaf(LeafId(first.0 + k))).collect();
        Ok(self.formula.join(Op::Union, &edges))
    }

    /// The context under a map. `copy` is set if the map is that of the
    /// only copy of a solid and has a label. The identity makes no context of its own, so that a solid shares
    /// its leaves with its unmoved copies.
    fn moved(
        &mut self,
        visit: &Visit<'a>,
        map: &Affine,
        copy: Option<&'a Copies>,
    ) -> Result<u32, CompileError> {
        if *map == Affine::IDENTITY && copy.is_none() {
            return Ok(visit.context);
        }
        map.inverse()
            .map_err(|e| CompileError { path: self.path(visit.context, "transform"), problem: e.into() })?;
        let Context { map: outer, step, named, direct, whole, .. } = self.contexts[visit.context as usize];
        let next = Context { parent: visit.context, name: None, copy, step, named, direct, whole, map: 0 };
        Ok(self.enter_moved(next, self.composed(map, outer)))
    }

    /// A map, followed by a composed one.
    fn composed(&self, map: &Affine, outer: u32) -> Map {
        let (outer, way) = self.maps.get(outer);
        (map.then(&outer), way + outer.vector(map.translation).length())
    }

    fn named(&mut self, visit: &Visit<'a>, name: &'a Arc<str>) -> u32 {
        let Context { map, step, whole, .. } = self.contexts[visit.context as usize];
        let named = self.contexts.len() as u32;
        let name = Some(name);
        let next = Context { parent: visit.context, name, copy: None, step, named, direct: true, whole, map };
        let composed = self.composed(&Affine::IDENTITY, map);
        let bits = |map: &Affine| map.to_rows().map(|row| row.map(f64::to_bits));
        // the product with the identity may turn -0 into 0
        match bits(&composed.0) == bits(&self.maps.get(map).0) {
            true => self.enter(next),
            false => self.enter_moved(next, composed),
        }
    }

    /// Enters a context with a map of its own.
    fn enter_moved(&mut self, next: Context<'a>, map: Map) -> u32 {
        let number = self.maps.0.len() as u32;
        self.maps.push(map);
        self.enter(Context { map: number, ..next })
    }

    fn enter(&mut self, mut next: Context<'a>) -> u32 {
        let context = self.contexts.len() as u32;
        if next.name.is_some() || next.copy.is_some() {
            next.step = context;
        }
        self.contexts.push(next);
        context
    }

    /// Marks the innermost name as that of a compound, not of one leaf; returns that name the first time.
    fn undirect(&mut self, context: u32) -> Option<Arc<str>> {
        let context = &mut self.contexts[context as usize];
        let (named, direct) = (context.named, std::mem::replace(&mut context.direct, false));
        self.contexts[named as usize].name.filter(|_| direct).cloned()
    }

    /// Marks a position as a solid that was made as a whole, whose parts have names of their own: the name of the solid precedes them.
    /// A direct name has no other operands than this solid.
    fn enter_whole(&mut self, context: u32) {
        let context = &mut self.contexts[context as usize];
        if context.direct {
            context.whole = context.named;
        }
    }

    /// The name given to a leaf, or its kind after the name of the enclosing compound; both after the name of the whole that the leaf
    /// is a part of.
    fn leaf_name(&mut self, context: u32, kind: &'static str) -> Arc<str> {
        let Context { named, direct, whole, .. } = self.contexts[context as usize];
        let own = match self.contexts[named as usize].name {
            Some(name) if direct => name.clone(),
            name => self.leaf_names.of(name, kind),
        };
        match self.contexts[whole as usize].name.filter(|_| whole != named) {
            Some(name) => format!("{name}.{own}").into(),
            None => own,
        }
    }

    /// True if the innermost name or copy around a leaf is a name of the leaf alone.
    fn is_named(&self, context: u32) -> bool {
        let Context { direct, step, .. } = self.contexts[context as usize];
        direct && self.contexts[step as usize].name.is_some()
    }

    fn path(&self, context: u32, what: &str) -> String {
        path(&self.contexts, context, what)
    }
}

/// The names of unnamed leaves, each made once.
#[derive(Default)]
struct LeafNames {
    /// By the addresses of the outer name (which the contexts keep alive) and of the kind.
    known: NumberMap<(usize, usize), Arc<str>>,
}

impl LeafNames {
    /// The kind, after the name of the enclosing compound.
    fn of(&mut self, outer: Option<&Arc<str>>, kind: &'static str) -> Arc<str> {
        let key = (outer.map_or(0, |name| name.as_ptr() as usize), kind.as_ptr() as usize);
        let name = || outer.map_or_else(|| kind.into(), |name| format!("{name}.{kind}").into());
        self.known.entry(key).or_insert_with(name).clone()
    }
}

/// The names around the leaves of a group. `own` is the context of the name of the whole group.
fn trail(contexts: &[Context<'_>], parts: &[Part<'_>], own: u32) -> Trail {
    let mut steps = Steps { contexts, node_of: NumberMap::default(), builder: TrailBuilder::default() };
    let place: Arc<str> = "place".into();
    let mut leaf = 0;
    for part in parts {
        let step = contexts[part.context as usize].step;
        let outer = contexts[contexts[step as usize].parent as usize].step;
        match part.content {
            Content::Shape(primitive) => {
                let (step, naming, name) = match part.is_named {
                    true if step == own => (step, Naming::Node, ""),
                    true => {
                        (outer, Naming::Name, contexts[step as usize].name.map_or(&*part.name, |name| name))
                    }
                    false => (step, Naming::Kind, primitive.name()),
                };
                let node = steps.node(step);
                steps.builder.leaf(leaf, node, naming, name);
                leaf += 1;
            }
            Content::Copies(_, inner, copies) => {
                let (step, name) = match (own_name(inner), part.is_named && step != own) {
                    (Some(name), _) => (step, name),
                    (None, true) if copies.label().is_none() => (outer, &part.name),
                    (None, _) => (step, &place),
                };
                let node = steps.node(step);
                steps.builder.copies(node, copies.len(), copies.label(), name);
                leaf += copies.len() as u32;
            }
        }
    }
    if own != 0 {
        let node = steps.node(own);
        steps.builder.own(node);
    }
    steps.builder.finish()
}

/// The contexts with names, which become nodes of the trail when a part needs them.
struct Steps<'c, 'a> {
    contexts: &'c [Context<'a>],
    node_of: NumberMap<u32, u32>,
    builder: TrailBuilder<'c>,
}

impl Steps<'_, '_> {
    /// The node of a context with a name or a copy; the top for context 0.
    fn node(&mut self, step: u32) -> u32 {
        let contexts = self.contexts;
        let (mut missing, mut at) = (Vec::new(), step);
        while at != 0 && !self.node_of.contains_key(&at) {
            missing.push(at);
            at = contexts[contexts[at as usize].parent as usize].step;
        }
        let mut node = self.node_of.get(&at).copied().unwrap_or(TOP);
        for step in missing.into_iter().rev() {
            let context = &contexts[step as usize];
            node = match (context.name, context.copy.and_then(Copies::label)) {
                (Some(name), _) => self.builder.named(node, name),
                (None, Some(label)) => self.builder.labelled(node, label),
                (None, None) => node,
            };
            self.node_of.insert(step, node);
        }
        node
    }
}

/// The name of a solid as a whole, through maps and complements.
fn own_name(mut solid: &Solid) -> Option<&Arc<str>> {
    loop {
        solid = match solid.node() {
            Node::Named(name, _) => return Some(name),
            Node::Transformed(_, inner) | Node::Complement(inner) => inner,
            _ => return None,
        }
    }
}

/// The names on the way to a part, joined by slashes.
fn path(contexts: &[Context<'_>], mut context: u32, what: &str) -> String {
    let mut names = vec![what];
    while context != 0 {
        names.extend(contexts[context as usize].name.map(|name| &**name));
        context = contexts[context as usize].parent;
    }
    names.reverse();
    names.join("/")
}
