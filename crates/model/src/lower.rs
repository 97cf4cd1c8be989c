//! From the tree that people build to the boolean expressions of its groups.
//!
//! One walk with an explicit stack: transforms are composed on the way down, complements are pushed to the
//! leaves (De Morgan), and chains of one operator become one n-ary gate, so that a union built in a loop is
//! as flat as one built from a list. Shared sub-trees are walked once per placement.

use crate::{CompileError, CompileProblem, Edge, Expression, LeafId, Node, PrototypeId, Solid};
use rayweave_math::Affine;
use rayweave_shape::primitive::{Lowered, Primitive};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// A group of leaves in one frame, with the solids asked of it.
pub(crate) struct Group {
    pub expression: Expression,
    /// One per solid asked for.
    pub outputs: Vec<Edge>,
    pub leaves: Vec<RawLeaf>,
}

/// A leaf before its surfaces are brought into the group's frame.
pub(crate) struct RawLeaf {
    pub name: Arc<str>,
    /// The way from the root, for messages.
    pub path: String,
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

type Key = (usize, u32, bool);

/// A gate whose operands are being collected.
struct Frame {
    op: Op,
    complemented: bool,
    operands: Vec<Edge>,
    /// Shared nodes already merged into this gate: a union of a solid with itself is the solid.
    merged: HashSet<Key>,
    key: Option<Key>,
}

enum Task<'a> {
    Visit { solid: &'a Solid, context: u32, complemented: bool },
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
        self.visit_all(solids.iter().map(|&solid| (solid, false)), 0);
        while let Some(task) = self.tasks.pop() {
            match task {
                Task::Visit { solid, context, complemented } => self.visit(solid, context, complemented)?,
                Task::Close => self.close(),
            }
        }
        let outputs = self.frames.pop().map(|frame| frame.operands).unwrap_or_default();
        Ok(Group { expression: self.expression, outputs, leaves: self.leaves })
    }

    /// Puts operands on the stack so that they are visited in order.
    fn visit_all(&mut self, operands: impl DoubleEndedIterator<Item = (&'a Solid, bool)>, context: u32) {
        let visits = operands.rev().map(|(solid, complemented)| Task::Visit { solid, context, complemented });
        self.tasks.extend(visits);
    }

    fn visit(&mut self, solid: &'a Solid, context: u32, complemented: bool) -> Result<(), CompileError> {
        let (union, intersection) = if complemented { (Op::All, Op::Any) } else { (Op::Any, Op::All) };
        match solid.node() {
            Node::Vacuum => self.operand(if complemented { Edge::PLENUM } else { Edge::VACUUM }),
            Node::Plenum => self.operand(if complemented { Edge::VACUUM } else { Edge::PLENUM }),
            Node::Primitive(primitive) => self.shape(solid, primitive, context, complemented)?,
            Node::Complement(inner) => self.visit_all([(inner, !complemented)].into_iter(), context),
            Node::Transformed(map, inner) => {
                let context = self.moved(context, solid, map)?;
                self.visit_all([(inner, complemented)].into_iter(), context);
            }
            Node::Named(name, inner) => {
                let context = self.named(context, solid, name);
                self.visit_all([(inner, complemented)].into_iter(), context);
            }
            Node::Union(all) => {
                self.join(union, solid, context, complemented, all.iter().map(|s| (s, complemented)))
            }
            Node::Intersection(all) => {
                self.join(intersection, solid, context, complemented, all.iter().map(|s| (s, complemented)));
            }
            Node::Difference(a, b) => {
                let operands = [(a, complemented), (b, !complemented)].into_iter();
                self.join(intersection, solid, context, complemented, operands);
            }
            Node::SymmetricDifference(all) => {
                self.join(Op::Odd, solid, context, complemented, all.iter().map(|s| (s, false)));
            }
            Node::Placed(inner, maps) => self.placed(solid, inner, maps, context, complemented)?,
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
        self.frames.push(Frame { op, complemented, operands: Vec::new(), merged: HashSet::new(), key });
    }

    /// A gate of the given kind: merged into the gate above where that is of the same kind, looked up where
    /// the node was met before, else opened.
    fn join(
        &mut self,
        op: Op,
        solid: &Solid,
        context: u32,
        complemented: bool,
        operands: impl DoubleEndedIterator<Item = (&'a Solid, bool)>,
    ) {
        self.undirect(context);
        let key = (solid.address(), context, complemented);
        let shared = solid.is_shared();
        let frame = self.top();
        if frame.op == op && (op != Op::Odd || !shared) {
            if op == Op::Odd {
                frame.complemented ^= complemented;
            }
            if !shared || frame.merged.insert(key) {
                self.visit_all(operands, context);
            }
            return;
        }
        if let Some(&edge) = shared.then(|| self.done.get(&key)).flatten() {
            return self.operand(edge);
        }
        self.open(op, complemented && op == Op::Odd, shared.then_some(key));
        self.tasks.push(Task::Close);
        self.visit_all(operands, context);
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
        what: &str,
        content: Content,
    ) -> Result<LeafId, CompileError> {
        let path = self.path(context, what);
        if self.leaves.len() >= LIMIT {
            return Err(CompileError { path, problem: CompileProblem::TooLarge { what: "leaves" } });
        }
        let Context { world_from_local, way, .. } = self.contexts[context as usize];
        self.leaves.push(RawLeaf { name, path, content, world_from_local, way });
        Ok(LeafId::from(self.leaves.len() - 1))
    }

    /// The union of instances; a single one is an ordinary transform.
    fn placed(
        &mut self,
        solid: &'a Solid,
        inner: &'a Solid,
        maps: &'a Arc<[Affine]>,
        context: u32,
        complemented: bool,
    ) -> Result<(), CompileError> {
        if let [map] = maps[..] {
            let context = self.moved(context, solid, &map)?;
            self.visit_all([(inner, complemented)].into_iter(), context);
            return Ok(());
        }
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
            edges.push(self.expression.leaf(leaf));
        }
        let edge = self.expression.any(edges);
        self.operand(if complemented { edge.complement() } else { edge });
        Ok(())
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

    /// The names on the way to a part, joined by slashes.
    fn path(&self, mut context: u32, what: &str) -> String {
        let mut names = vec![what];
        while context != 0 {
            names.extend(self.contexts[context as usize].name.as_deref());
            context = self.contexts[context as usize].parent;
        }
        names.reverse();
        names.join("/")
    }
}
