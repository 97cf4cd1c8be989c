//! From the tree that people build to the boolean expressions of its groups.
//!
//! One walk with an explicit stack: transforms are composed on the way down, complements are pushed to the
//! leaves (De Morgan), and chains of one operator become one n-ary gate, so that a union built in a loop is
//! as flat as one built from a list. Shared sub-trees are walked once per placement.

use crate::{CompileError, CompileProblem, Edge, Expression, LeafId, Node, PrototypeId, Solid};
use rayweave_math::Affine;
use rayweave_shape::primitive::{Lowered, Primitive};
use std::collections::HashMap;
use std::sync::Arc;

/// A group of leaves in one frame, with the solids asked of it.
pub(crate) struct Group {
    pub expression: Expression,
    /// One per solid asked for.
    pub outputs: Vec<Edge>,
    pub leaves: Vec<RawLeaf>,
    contexts: Vec<Context>,
}

impl Group {
    /// The way from the root to a leaf, for messages. Made only when it is asked for: the ways to all leaves
    /// of a deep tree together are of quadratic length.
    pub fn path(&self, leaf: &RawLeaf) -> String {
        path(&self.contexts, leaf.context, leaf.what)
    }
}

/// A leaf before its surfaces are brought into the group's frame.
pub(crate) struct RawLeaf {
    pub name: Arc<str>,
    /// Where it stands, for [`Group::path`].
    context: u32,
    /// What it is, for messages.
    what: &'static str,
    pub content: Content,
    pub world_from_local: Affine,
    /// The lengths of the translations composed into the map.
    pub way: f64,
}

/// What stands at a leaf.
pub(crate) enum Content {
    Shape(Box<(Primitive, Lowered)>),
    Instance(PrototypeId),
}

/// More than this many of anything do not fit the numbers of a program.
const LIMIT: usize = 1 << 31;

/// Lowers solids, and all solids placed in them, to groups; the first group is the model itself.
pub(crate) fn lower(solids: &[&Solid]) -> Result<Vec<Group>, CompileError> {
    let mut prototypes = Prototypes::default();
    let mut groups = vec![Lowering::new(&mut prototypes).run(solids)?];
    while groups.len() <= prototypes.solids.len() {
        let solid = prototypes.solids[groups.len() - 1];
        groups.push(Lowering::new(&mut prototypes).run(&[solid])?);
    }
    Ok(groups)
}

/// The placed solids met so far, each once; number k is group k + 1.
#[derive(Default)]
struct Prototypes<'a> {
    known: HashMap<usize, PrototypeId>,
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

/// Where in the model a walk is: the composed map and the names on the way.
struct Context {
    parent: u32,
    name: Option<Arc<str>>,
    /// The innermost name, and whether only maps and complements lie below it so far.
    leaf_name: Option<Arc<str>>,
    direct: bool,
    world_from_local: Affine,
    way: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Op {
    Any,
    All,
    Odd,
    /// The frame of the whole group, which collects the outputs.
    Root,
}

/// A node, the context of a visit, and whether its complement is meant.
type Key = (usize, u32, bool);

/// A gate whose operands are being collected.
struct Frame {
    op: Op,
    complemented: bool,
    operands: Vec<Edge>,
    key: Option<Key>,
}

/// A node to be walked.
#[derive(Clone, Copy)]
struct Visit<'a> {
    solid: &'a Solid,
    context: u32,
    complemented: bool,
    /// True if the same walk may come by again: the node itself, or a map, name or complement around it, is
    /// used more than once.
    shared: bool,
}

enum Task<'a> {
    Visit(Visit<'a>),
    Close,
}

struct Lowering<'p, 'a> {
    prototypes: &'p mut Prototypes<'a>,
    expression: Expression,
    leaves: Vec<RawLeaf>,
    contexts: Vec<Context>,
    context_of: HashMap<(u32, usize), u32>,
    leaf_of: HashMap<(usize, u32), (LeafId, bool)>,
    done: HashMap<Key, Edge>,
    tasks: Vec<Task<'a>>,
    frames: Vec<Frame>,
}

impl<'p, 'a> Lowering<'p, 'a> {
    fn new(prototypes: &'p mut Prototypes<'a>) -> Self {
        let root = Context {
            parent: 0,
            name: None,
            leaf_name: None,
            direct: false,
            world_from_local: Affine::IDENTITY,
            way: 0.0,
        };
        Lowering {
            prototypes,
            expression: Expression::default(),
            leaves: Vec::new(),
            contexts: vec![root],
            context_of: HashMap::new(),
            leaf_of: HashMap::new(),
            done: HashMap::new(),
            tasks: Vec::new(),
            frames: Vec::new(),
        }
    }

    fn run(mut self, solids: &[&'a Solid]) -> Result<Group, CompileError> {
        self.open(Op::Root, false, None);
        self.visit_all(solids.iter().map(|&solid| (solid, false)), 0, false);
        while let Some(task) = self.tasks.pop() {
            match task {
                Task::Visit(visit) => self.visit(visit)?,
                Task::Close => self.close(),
            }
        }
        let outputs = self.frames.pop().map(|frame| frame.operands).unwrap_or_default();
        Ok(Group { expression: self.expression, outputs, leaves: self.leaves, contexts: self.contexts })
    }

    /// Puts operands on the stack so that they are visited in order.
    fn visit_all(
        &mut self,
        operands: impl DoubleEndedIterator<Item = (&'a Solid, bool)>,
        context: u32,
        shared: bool,
    ) {
        let visits = operands.rev().map(|(solid, complemented)| {
            Task::Visit(Visit { solid, context, complemented, shared: shared || solid.is_shared() })
        });
        self.tasks.extend(visits);
    }

    fn visit(&mut self, visit: Visit<'a>) -> Result<(), CompileError> {
        let Visit { solid, context, complemented, shared } = visit;
        let (union, intersection) = if complemented { (Op::All, Op::Any) } else { (Op::Any, Op::All) };
        match solid.node() {
            Node::Vacuum => self.operand(if complemented { Edge::PLENUM } else { Edge::VACUUM }),
            Node::Plenum => self.operand(if complemented { Edge::VACUUM } else { Edge::PLENUM }),
            Node::Primitive(primitive) => self.shape(solid, primitive, context, complemented)?,
            Node::Complement(inner) => {
                self.visit_all([(inner, !complemented)].into_iter(), context, shared);
            }
            Node::Transformed(map, inner) => {
                let context = self.moved(context, solid, map)?;
                self.visit_all([(inner, complemented)].into_iter(), context, shared);
            }
            Node::Named(name, inner) => {
                let context = self.named(context, solid, name);
                self.visit_all([(inner, complemented)].into_iter(), context, shared);
            }
            Node::Union(all) => self.join(union, visit, all.iter().map(|s| (s, complemented))),
            Node::Intersection(all) => {
                self.join(intersection, visit, all.iter().map(|s| (s, complemented)));
            }
            Node::Difference(a, b) => {
                let operands = [(a, complemented), (b, !complemented)].into_iter();
                self.join(intersection, visit, operands);
            }
            Node::SymmetricDifference(all) => {
                self.join(Op::Odd, visit, all.iter().map(|s| (s, false)));
            }
            Node::Placed(inner, maps) => self.placed(visit, inner, maps)?,
        }
        Ok(())
    }

    fn top(&mut self) -> &mut Frame {
        self.frames.last_mut().expect("the root frame is open for the whole walk")
    }

    fn operand(&mut self, edge: Edge) {
        self.top().operands.push(edge);
    }

    fn open(&mut self, op: Op, complemented: bool, key: Option<Key>) {
        self.frames.push(Frame { op, complemented, operands: Vec::new(), key });
    }

    /// A gate of the given kind: merged into the gate above where that is of the same kind, looked up where
    /// the node was met before, else opened. Shared nodes are never merged: they would be walked, and their
    /// operands counted, once per use, which is quadratic in a chain whose every member is used, and
    /// exponential where uses are nested.
    fn join(
        &mut self,
        op: Op,
        visit: Visit<'a>,
        operands: impl DoubleEndedIterator<Item = (&'a Solid, bool)>,
    ) {
        let Visit { solid, context, complemented, shared } = visit;
        self.undirect(context);
        let frame = self.top();
        if frame.op == op && !shared {
            frame.complemented ^= complemented && op == Op::Odd;
            return self.visit_all(operands, context, false);
        }
        let key = (solid.address(), context, complemented);
        if let Some(&edge) = shared.then(|| self.done.get(&key)).flatten() {
            return self.operand(edge);
        }
        self.open(op, complemented && op == Op::Odd, shared.then_some(key));
        self.tasks.push(Task::Close);
        self.visit_all(operands, context, false);
    }

    fn close(&mut self) {
        let Some(frame) = self.frames.pop() else {
            return;
        };
        let edge = match frame.op {
            Op::Any => self.expression.any(frame.operands),
            Op::All => self.expression.all(frame.operands),
            Op::Odd | Op::Root => self.expression.odd(frame.operands),
        };
        let edge = if frame.complemented { edge.complement() } else { edge };
        if let Some(key) = frame.key {
            self.done.insert(key, edge);
        }
        self.operand(edge);
    }

    fn shape(
        &mut self,
        solid: &Solid,
        primitive: &Primitive,
        context: u32,
        complemented: bool,
    ) -> Result<(), CompileError> {
        let key = (solid.address(), context);
        let (leaf, inverted) = match self.leaf_of.get(&key) {
            Some(&known) => known,
            None => {
                let lowered = primitive.lower();
                let inverted = lowered.complement;
                let name = self.leaf_name(context, primitive.name());
                let leaf = self.leaf(
                    name,
                    context,
                    primitive.name(),
                    Content::Shape(Box::new((primitive.clone(), lowered))),
                )?;
                self.leaf_of.insert(key, (leaf, inverted));
                (leaf, inverted)
            }
        };
        let edge = self.expression.leaf(leaf);
        self.operand(if complemented ^ inverted { edge.complement() } else { edge });
        Ok(())
    }

    fn leaf(
        &mut self,
        name: Arc<str>,
        context: u32,
        what: &'static str,
        content: Content,
    ) -> Result<LeafId, CompileError> {
        if self.leaves.len() >= LIMIT {
            let path = self.path(context, what);
            return Err(CompileError { path, problem: CompileProblem::TooLarge { what: "leaves" } });
        }
        let Context { world_from_local, way, .. } = self.contexts[context as usize];
        self.leaves.push(RawLeaf { name, context, what, content, world_from_local, way });
        Ok(LeafId::from(self.leaves.len() - 1))
    }

    /// The union of instances; a single one is an ordinary transform.
    fn placed(
        &mut self,
        visit: Visit<'a>,
        inner: &'a Solid,
        maps: &'a Arc<[Affine]>,
    ) -> Result<(), CompileError> {
        let Visit { solid, context, complemented, shared } = visit;
        match maps[..] {
            // no group of its own: one that nothing places would have no place in the program
            [] => self.operand(if complemented { Edge::PLENUM } else { Edge::VACUUM }),
            [ref map] => {
                let context = self.moved(context, solid, map)?;
                self.visit_all([(inner, complemented)].into_iter(), context, shared);
            }
            _ => {
                let key = (solid.address(), context, false);
                let edge = match self.done.get(&key) {
                    Some(&edge) => edge,
                    None => self.instances(context, inner, maps)?,
                };
                self.done.insert(key, edge);
                self.operand(if complemented { edge.complement() } else { edge });
            }
        }
        Ok(())
    }

    fn instances(
        &mut self,
        context: u32,
        inner: &'a Solid,
        maps: &'a Arc<[Affine]>,
    ) -> Result<Edge, CompileError> {
        let prototype = self.prototypes.of(inner);
        let mut edges = Vec::with_capacity(maps.len());
        for (number, map) in maps.iter().enumerate() {
            let moved = self.step(context, map);
            let name: Arc<str> = format!("{}[{number}]", self.leaf_name(context, "place")).into();
            map.inverse().map_err(|e| CompileError { path: self.path(context, &name), problem: e.into() })?;
            self.contexts.push(moved);
            let place = (self.contexts.len() - 1) as u32;
            let leaf = self.leaf(name, place, "place", Content::Instance(prototype))?;
            self.contexts.pop();
            self.leaves[leaf.index()].context = context;
            edges.push(self.expression.leaf(leaf));
        }
        Ok(self.expression.any(edges))
    }

    /// The context under a map, the same for each visit of the node.
    fn moved(&mut self, context: u32, solid: &Solid, map: &Affine) -> Result<u32, CompileError> {
        map.inverse()
            .map_err(|e| CompileError { path: self.path(context, "transform"), problem: e.into() })?;
        let next = self.step(context, map);
        Ok(self.enter(context, solid, next))
    }

    fn step(&self, context: u32, map: &Affine) -> Context {
        let outer = &self.contexts[context as usize];
        Context {
            parent: context,
            name: None,
            leaf_name: outer.leaf_name.clone(),
            direct: outer.direct,
            world_from_local: map.then(&outer.world_from_local),
            way: outer.way + outer.world_from_local.vector(map.translation).length(),
        }
    }

    fn named(&mut self, context: u32, solid: &Solid, name: &Arc<str>) -> u32 {
        let mut next = self.step(context, &Affine::IDENTITY);
        (next.name, next.leaf_name, next.direct) = (Some(name.clone()), Some(name.clone()), true);
        self.enter(context, solid, next)
    }

    fn enter(&mut self, parent: u32, solid: &Solid, next: Context) -> u32 {
        let fresh = self.contexts.len() as u32;
        let context = *self.context_of.entry((parent, solid.address())).or_insert(fresh);
        if context == fresh {
            self.contexts.push(next);
        }
        context
    }

    /// From here on the innermost name belongs to a compound, not to one leaf.
    fn undirect(&mut self, context: u32) {
        self.contexts[context as usize].direct = false;
    }

    /// The name of a leaf: the name given to it, or its kind after the name of the compound that it is in.
    fn leaf_name(&self, context: u32, kind: &str) -> Arc<str> {
        let context = &self.contexts[context as usize];
        match &context.leaf_name {
            Some(name) if context.direct => name.clone(),
            Some(name) => format!("{name}.{kind}").into(),
            None => kind.into(),
        }
    }

    fn path(&self, context: u32, what: &str) -> String {
        path(&self.contexts, context, what)
    }
}

/// The names on the way to a part, joined by slashes.
fn path(contexts: &[Context], mut context: u32, what: &str) -> String {
    let mut names = vec![what];
    while context != 0 {
        names.extend(contexts[context as usize].name.as_deref());
        context = contexts[context as usize].parent;
    }
    names.reverse();
    names.join("/")
}
