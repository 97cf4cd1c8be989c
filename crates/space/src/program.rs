//! Compiled solid in R^d: its faces in a common frame, and their boolean network.

use crate::affine::Affine;
use crate::curve::Line;
use crate::error::SpaceError;
use crate::point::{dot, is_finite, length, minus};
use crate::shape::Shape;
use crate::solid::{Join, Node};
use crate::surface::Surface;
use crate::{Field, Point, Solid};
use rayweave_math::roots::Crossings;
use rayweave_math::{Bounds, Interval, perturbs_inside};
use rayweave_model::gate::Network;
use rayweave_model::simplify::{Formula, Op, prepare};
use rayweave_model::{Edge, Expression, LeafId};
use rayweave_shape::surface::delta_of;
use std::collections::HashMap;
use std::sync::Arc;

/// A solid compiled for tracing: immutable, shared by any number of threads.
///
/// Leaves have indices in the order of declaration, from left to right in the tree.
#[derive(Debug)]
pub struct Program<const D: usize> {
    pub(crate) leaves: Vec<Leaf>,
    pub(crate) faces: Vec<FaceEntry<D>>,
    pub(crate) expression: Expression,
    pub(crate) output: Edge,
    pub(crate) network: Network,
    ball: Ball<D>,
}

/// An occurrence of a shape.
#[derive(Clone, Debug)]
pub(crate) struct Leaf {
    pub name: Arc<str>,
    /// The index of its first face.
    pub first_face: u32,
}

/// A surface of a leaf, in the frame of the solid.
#[derive(Clone, Debug)]
pub(crate) struct FaceEntry<const D: usize> {
    pub surface: Surface<D>,
    /// The magnitude of the surface plus the lengths of all composed translations.
    pub magnitude: f64,
    pub leaf: u32,
}

/// A ball around everything finite, with twice the radius: the boxes of leaves and, for leaves without a box, the anchors and
/// sizes of surfaces.
#[derive(Clone, Copy, Debug)]
struct Ball<const D: usize> {
    centre: Point<D>,
    radius: f64,
}

impl<const D: usize> Program<D> {
    pub(crate) fn new(solid: &Solid<D>) -> Result<Self, SpaceError> {
        let lowered = Lowering::run(solid)?;
        let formula = prepare(&lowered.formula, &vec![Bounds::ALL; lowered.faces.len()]);
        let expression = Expression::new(&formula, lowered.faces.len());
        let network = Network::new(&expression);
        Ok(Program {
            ball: Ball::around(
                lowered.finite,
                lowered.faces.iter().map(|face| face.magnitude).fold(0.0, f64::max),
            ),
            leaves: lowered.leaves,
            faces: lowered.faces,
            output: expression.outputs()[0],
            expression,
            network,
        })
    }

    /// The number of leaves.
    pub fn leaf_count(&self) -> usize {
        self.leaves.len()
    }

    /// The name of a leaf or, without a name, its kind (`ball`, `slab`, ...); `None` if the index is out of range.
    pub fn leaf_name(&self, leaf: u32) -> Option<&str> {
        self.leaves.get(leaf as usize).map(|leaf| &*leaf.name)
    }

    /// True if a point is inside. A point on a surface, f = 0, counts as moved along [`rayweave_math::perturbation_direction`].
    ///
    /// # Errors
    /// `NotFinite` or `Extreme` for an invalid coordinate.
    pub fn contains(&self, point: Point<D>) -> Result<bool, SpaceError> {
        self.contains_by(point, &mut Vec::new())
    }

    /// Like [`Program::contains`], with a reusable buffer for the values of all nodes.
    pub(crate) fn contains_by(&self, point: Point<D>, values: &mut Vec<bool>) -> Result<bool, SpaceError> {
        crate::error::check::point("point", &point)?;
        let inside = |leaf: LeafId| {
            let (value, gradient) = self.faces[leaf.index()].surface.value_and_gradient(&point);
            if value == 0.0 { perturbs_inside(&gradient) } else { value < 0.0 }
        };
        self.expression.evaluate(inside, values);
        Ok(values[self.output.node().index()] ^ self.output.is_complemented())
    }

    /// The span of a line that is tested for lying in a surface: one radius of the ball before and after its point closest to the
    /// centre.
    pub(crate) fn chord(&self, line: &Line<D>) -> (f64, f64) {
        let from = minus(&self.ball.centre, &line.origin);
        let (speed, direction) = (length(&line.direction), &line.direction);
        let closest = dot(&from, direction) / dot(direction, direction);
        // without a radius, uses the distance of the line from the centre or, at the origin, the unit of time
        let lengths = [self.ball.radius, length(&from), speed];
        let half = lengths.into_iter().find(|&length| length > 0.0).unwrap_or(0.0) / speed;
        (closest - half, closest + half)
    }
}

impl<const D: usize> FaceEntry<D> {
    /// The crossings of a line with the face. A line that lies in the surface over its whole chord counts as moved infinitesimally
    /// along [`rayweave_math::perturbation_direction`].
    pub fn crossings(&self, line: &Line<D>, (a, b): (f64, f64)) -> Crossings<2> {
        match self.surface.may_contain_lines() && self.surface.coincides_along(self.magnitude, line, a, b) {
            true => self.surface.perturbed_crossings(line, 0.5 * (a + b)),
            false => self.surface.crossings(line),
        }
    }
}

impl<const D: usize> Field<D> for FaceEntry<D> {
    fn value_and_gradient(&self, point: &Point<D>) -> (f64, Point<D>) {
        self.surface.value_and_gradient(point)
    }

    fn ranges(&self, cell: &[Interval; D]) -> (Interval, [Interval; D]) {
        self.surface.ranges(cell)
    }

    fn magnitude(&self) -> f64 {
        self.magnitude
    }
}

impl<const D: usize> Ball<D> {
    /// The ball around a box; `magnitude` is the largest of all surfaces. Anchors that differ only by rounding, such as those of
    /// coaxial cylinders, count as one point: a chord of that length would lie in every surface that it crosses.
    fn around(finite: Option<(Point<D>, Point<D>)>, magnitude: f64) -> Self {
        let Some((lo, hi)) = finite else {
            return Ball { centre: [0.0; D], radius: 0.0 };
        };
        let centre: Point<D> = std::array::from_fn(|k| 0.5 * (lo[k] + hi[k]));
        // half of the diagonal, doubled
        let radius = length(&minus(&hi, &lo));
        let mut lengths = [radius, length(&centre)].into_iter();
        Ball { centre, radius: lengths.find(|&size| size > delta_of(magnitude)).unwrap_or(0.0) }
    }
}

/// The context of a node: the composed map and the innermost name.
#[derive(Clone)]
struct Context<const D: usize> {
    map: Affine<D>,
    /// The sum of the lengths of the composed translations.
    path: f64,
    name: Option<Arc<str>>,
}

struct Lowering<'a, const D: usize> {
    formula: Formula,
    leaves: Vec<Leaf>,
    faces: Vec<FaceEntry<D>>,
    /// A box around everything finite.
    finite: Option<(Point<D>, Point<D>)>,
    contexts: Vec<Context<D>>,
    /// The context of a node's operands, by the node's context and address.
    context_of: HashMap<(u32, usize), u32>,
    done: HashMap<(u32, usize), Edge>,
    tasks: Vec<Task<'a, D>>,
    /// Stack of lowered operands.
    made: Vec<Edge>,
}

enum Task<'a, const D: usize> {
    /// Lower a node in a context.
    Visit(&'a Solid<D>, u32),
    /// Join the lowered operands of a node.
    Close(&'a Solid<D>, u32),
}

impl<'a, const D: usize> Lowering<'a, D> {
    fn run(solid: &'a Solid<D>) -> Result<Self, SpaceError> {
        let mut this = Lowering {
            formula: Formula::default(),
            leaves: Vec::new(),
            faces: Vec::new(),
            finite: None,
            contexts: vec![Context { map: Affine::identity(), path: 0.0, name: None }],
            context_of: HashMap::new(),
            done: HashMap::new(),
            tasks: vec![Task::Visit(solid, 0)],
            made: Vec::new(),
        };
        while let Some(task) = this.tasks.pop() {
            match task {
                Task::Visit(solid, context) => this.visit(solid, context)?,
                Task::Close(solid, context) => this.close(solid, context),
            }
        }
        let output = this.made.pop().unwrap_or(Edge::EMPTY);
        this.formula.add_output(output);
        Ok(this)
    }

    fn visit(&mut self, solid: &'a Solid<D>, context: u32) -> Result<(), SpaceError> {
        if let Some(&edge) = self.done.get(&(context, solid.address())) {
            self.made.push(edge);
            return Ok(());
        }
        self.tasks.push(Task::Close(solid, context));
        match solid.node() {
            Node::Shape(shape) => {
                let edge = self.shape(shape, context)?;
                self.made.push(edge);
            }
            node => {
                let inner = self.inner_context(solid, context)?;
                let operands = node.operands().iter().rev();
                self.tasks.extend(operands.map(|operand| Task::Visit(operand, inner)));
            }
        }
        Ok(())
    }

    fn close(&mut self, solid: &'a Solid<D>, context: u32) {
        let operands = match solid.node() {
            Node::Shape(_) => 1,
            node => node.operands().len(),
        };
        let parts = self.made.split_off(self.made.len() - operands);
        let only = parts.first().copied().unwrap_or(Edge::EMPTY);
        let edge = match solid.node() {
            Node::Empty => Edge::EMPTY,
            Node::Universe => Edge::UNIVERSE,
            Node::Shape(_) | Node::Transformed(..) | Node::Named(..) => only,
            Node::Complement(_) => only.complement(),
            Node::Join(join, _) => self.formula.join(operation(*join), &parts),
            Node::Difference(_) => self.formula.join(Op::Difference, &parts),
        };
        self.made.push(edge);
        if solid.is_shared() {
            self.done.insert((context, solid.address()), edge);
        }
    }

    /// The context of a node's operands, computed once for each context of the node.
    fn inner_context(&mut self, solid: &Solid<D>, context: u32) -> Result<u32, SpaceError> {
        let (map, name) = match solid.node() {
            Node::Transformed(map, _) => (Some(map), None),
            Node::Named(name, _) => (None, Some(name.clone())),
            _ => return Ok(context),
        };
        let key = (context, solid.address());
        if let Some(&known) = self.context_of.get(&key) {
            return Ok(known);
        }
        let mut next = self.contexts[context as usize].clone();
        if let Some(map) = map {
            next.path += length(&next.map.vector(map.offset()));
            next.map = map.then(&next.map);
        }
        next.name = name.or(next.name);
        self.contexts.push(next);
        let inner = (self.contexts.len() - 1) as u32;
        self.context_of.insert(key, inner);
        Ok(inner)
    }

    /// One leaf: the intersection of its faces.
    fn shape(&mut self, shape: &Shape<D>, context: u32) -> Result<Edge, SpaceError> {
        let Context { map, path, name } = self.contexts[context as usize].clone();
        let name = name.unwrap_or_else(|| shape.kind.into());
        let inverse = map.inverse()?;
        let (leaf, first_face) = (self.leaves.len() as u32, self.faces.len() as u32);
        let mut edges = Vec::with_capacity(shape.facets.len());
        for facet in &shape.facets {
            let surface = facet.transformed(&map, &inverse);
            let magnitude = surface.magnitude() + path;
            if !surface.is_finite() || !magnitude.is_finite() {
                return Err(SpaceError::Overflow { leaf: name.to_string() });
            }
            if shape.finite.is_none() {
                self.include(&surface.anchor(), &[surface.size(); D]);
            }
            edges.push(self.formula.leaf(LeafId::from(self.faces.len())));
            self.faces.push(FaceEntry { surface, magnitude, leaf });
        }
        if let Some((middle, half)) = &shape.finite {
            let spread = |row: &Point<D>| (0..D).fold(0.0, |sum, k| sum + row[k].abs() * half[k]);
            self.include(&map.point(middle), &map.matrix().each_ref().map(spread));
        }
        self.leaves.push(Leaf { name, first_face });
        Ok(self.formula.join(Op::Intersection, &edges))
    }

    /// Extends the box around everything finite.
    fn include(&mut self, middle: &Point<D>, half: &Point<D>) {
        if !is_finite(middle) || !is_finite(half) {
            return;
        }
        let (lo, hi) = self.finite.get_or_insert(([f64::INFINITY; D], [f64::NEG_INFINITY; D]));
        for k in 0..D {
            lo[k] = lo[k].min(middle[k] - half[k]);
            hi[k] = hi[k].max(middle[k] + half[k]);
        }
    }
}

fn operation(join: Join) -> Op {
    match join {
        Join::Union => Op::Union,
        Join::Intersection => Op::Intersection,
        Join::SymmetricDifference => Op::SymmetricDifference,
    }
}
