//! Explanations of answers: a record of every leaf query, gate decision and crossing of one ray, as data.
//! [`super::text`] prints it as text.

use super::evaluator::WalkObserver;
use super::names::Names;
use super::resolved::Resolved;
use super::{Next, Observer, SingleHit, TooLarge, ValueStep, Verdict};
use rayweave_error::{Classified, ErrorKind};
use rayweave_model::{
    Crossing, Evaluator, Face, GroupRay, LeafId, Limit, Program, PrototypeId, Query, RegionId, Window,
};
use rayweave_shape::{Ray, RayError};
use std::sync::Arc;

/// Error of [`explain`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExplainError {
    /// The ray is out of range: see [`Program::check_ray`].
    #[error(transparent)]
    Ray(#[from] RayError),
    /// The model is too large for [`SingleHit`], which records the explanation.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
}

impl Classified for ExplainError {
    fn kind(&self) -> ErrorKind {
        match self {
            ExplainError::Ray(error) => error.kind(),
            ExplainError::TooLarge(error) => error.kind(),
        }
    }
}

/// Explains the crossings of one ray: records every query of a leaf, every decision at a gate of the model's
/// tree with its operands, and the crossings. [`std::fmt::Display`] prints the record as text; the fields
/// hold it as data.
///
/// # Errors
///
/// [`ExplainError`]: the ray is out of range, or the model is too large.
///
/// ```
/// use rayweave_math::Vec3;
/// use rayweave_model::{Program, Solid, Window};
/// use rayweave_shape::{Ray, primitive::build};
/// use rayweave_trace::single_hit::explain;
/// use std::sync::Arc;
///
/// let ball = Solid::from(build("sphere", &[("radius", 2.0.into())])?).named("ball");
/// let left = build("half_space", &[("normal", Vec3::X.into()), ("offset", 0.0.into())])?;
/// let eye = ball - Solid::from(left).named("left");
/// let program = Arc::new(Program::compile(&eye)?);
/// let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
/// let explanation = explain(&program, ray, Window::ALL)?;
/// assert_eq!(explanation.crossings.len(), 2);
/// let line = "ball - left stays outside at 3: ball is entered, but the ray is inside left until 5. So ball is queried again.";
/// assert!(explanation.to_string().contains(line), "{explanation}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn explain(program: &Arc<Program>, ray: Ray, window: Window) -> Result<Explanation, ExplainError> {
    program.check_ray(&ray)?;
    let evaluator = SingleHit::new(program.clone())?;
    Ok(evaluator.explain(ray, &Query { window, ..Query::default() }))
}

/// Largest number of entries kept in an explanation; further ones are only counted. A model of ten thousand
/// leaves makes twice as many for each of its crossings.
pub const MAX_ENTRIES: usize = 100_000;

/// The record of how the answer for one ray was computed. Its `Display` prints it as text.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// The ray.
    pub ray: Ray,
    /// The names of the regions, by number: 0 is "the world".
    pub regions: Vec<Arc<str>>,
    /// The region just after the beginning of the window; 0 is the world.
    pub start: RegionId,
    /// The queries of the model, in order.
    pub questions: Vec<Question>,
    /// The crossings: the answer.
    pub crossings: Vec<Found>,
    /// Number of changes of medium that were welded with their neighbours; computed only if all crossings are
    /// wanted.
    pub welded: usize,
}

/// One query of the whole model: its next change after t_min.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// The start time of the query, which may be -inf.
    pub t_min: f64,
    /// Every leaf query and every decision, in order, except those in sub-trees known to be constant from
    /// here on; at most [`MAX_ENTRIES`] over all queries.
    pub entries: Vec<Entry>,
    /// Number of entries omitted because their sub-tree is known to be constant.
    pub repeated: usize,
    /// Number of entries omitted because the limit was reached.
    pub left_out: usize,
    /// The result, as numbers of regions; 0 is the world.
    pub answer: ValueStep,
    /// True if the medium changes at that time, within the window.
    pub changes_medium: bool,
}

/// A leaf query or a decision.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The node, by its index in the tree's post-order.
    pub node: usize,
    /// The first node of its sub-tree: all nodes from there up to itself are below it.
    pub begin: usize,
    /// Its distance from the root.
    pub depth: u32,
    /// Its name, without its complement.
    pub name: Arc<str>,
    /// The meaning of its values.
    pub meaning: Meaning,
    /// The query or decision.
    pub what: What,
}

/// The meaning of the values of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Inside if not 0.
    Solid,
    /// Number of operands that contain the ray.
    Count,
    /// Number of the owner; 0 is the world.
    Region,
}

/// A leaf query or a gate decision.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// A query of a leaf.
    Leaf {
        /// Its number in the program.
        leaf: LeafId,
        /// The start time of the query.
        t_min: f64,
        /// The result.
        answer: Next,
        /// The face that it crosses next.
        face: Option<Face>,
        /// The name of the face.
        face_name: Option<Arc<str>>,
    },
    /// A decision at a gate.
    Gate {
        /// The operands.
        operands: [ExplainedOperand; 2],
        /// The value just after the start time of the operands' query, before any complement.
        value: u32,
        /// The decision, before any complement.
        verdict: Verdict,
    },
}

impl What {
    /// True if the node was found to be constant from here on.
    pub fn is_resolved(&self) -> bool {
        match self {
            What::Leaf { answer, .. } => answer.time() == f64::INFINITY,
            What::Gate { verdict, .. } => matches!(verdict, Verdict::Fixed(_)),
        }
    }

    /// The number of the rule that was applied (see [`super::decide`]); `None` for a leaf.
    pub fn rule(&self) -> Option<u8> {
        match self {
            What::Leaf { .. } => None,
            What::Gate { verdict: Verdict::Fixed(_), .. } => Some(1),
            What::Gate { verdict: Verdict::Changes(_), .. } => Some(3),
            What::Gate { verdict: Verdict::QueryAgain { .. }, .. } => Some(4),
        }
    }
}

/// An operand of a decision.
#[derive(Clone, Debug, PartialEq)]
pub struct ExplainedOperand {
    /// The node, by its index in the tree's post-order.
    pub node: usize,
    /// Its name, without its complement.
    pub name: Arc<str>,
    /// The meaning of its values.
    pub meaning: Meaning,
    /// True if the gate takes its complement.
    pub complemented: bool,
    /// Its next change, as the gate takes it.
    pub answer: ValueStep,
}

impl ExplainedOperand {
    /// The next change of the operand itself, without the complement and weight with which the gate takes it.
    pub fn own_answer(&self) -> ValueStep {
        self.answer.map(|value| match self.meaning {
            Meaning::Solid => u32::from((value != 0) != self.complemented),
            Meaning::Count | Meaning::Region => value,
        })
    }
}

/// A crossing with the name of its face.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The crossing.
    pub crossing: Crossing,
    /// The name of the face.
    pub face: Arc<str>,
}

impl Explanation {
    pub(super) fn new(evaluator: &SingleHit, ray: Ray, query: &Query<'_>) -> Explanation {
        let starts = query.starts.map_or(&[][..], |lists| lists.of(0));
        let mut scratch = evaluator.scratch();
        let seen = GroupRay::world(evaluator.program(), ray, starts);
        let mut level = evaluator.gather(PrototypeId(0), &seen, 0, &mut scratch);
        // cloned, as the walk borrows the level
        let roots = level.roots.clone();
        let mut recorder = Recorder {
            names: Names::new(evaluator),
            next_face: |leaf: u32, t: f64| roots.next_face(leaf, t),
            questions: Vec::new(),
            found: Vec::new(),
            t_max: query.window.t_max(),
            resolved: Resolved::default(),
            remaining: MAX_ENTRIES,
        };
        let start = evaluator.walk(ray, query, !starts.is_empty(), &mut level, &mut scratch, &mut recorder);
        let (questions, crossings) = (recorder.questions, recorder.found);
        let changes = questions.iter().filter(|question| question.changes_medium).count();
        let welded = if query.limit == Limit::All { changes.saturating_sub(crossings.len()) } else { 0 };
        Explanation { ray, regions: region_names(evaluator.program()), start, questions, crossings, welded }
    }

    /// Number of leaf queries and decisions, those that are not kept included.
    pub fn steps(&self) -> usize {
        let steps = |question: &Question| question.entries.len() + question.repeated + question.left_out;
        self.questions.iter().map(steps).sum()
    }
}

fn region_names(program: &Program) -> Vec<Arc<str>> {
    let names = program.regions().iter().map(|region| region.name.as_str());
    ["the world"].into_iter().chain(names).map(Arc::from).collect()
}

/// Observer that records a ray.
struct Recorder<'a, F> {
    names: Names<'a>,
    next_face: F,
    questions: Vec<Question>,
    found: Vec<Found>,
    t_max: f64,
    resolved: Resolved,
    /// Number of entries that are still accepted.
    remaining: usize,
}

impl<F> Recorder<'_, F> {
    /// Returns false, and counts the entry, if its sub-tree is known to be constant or the limit is reached.
    fn takes(&mut self, node: usize) -> bool {
        let is_known = self.resolved.contains(node);
        match self.questions.last_mut() {
            Some(question) if is_known => question.repeated += 1,
            Some(question) if self.remaining == 0 => question.left_out += 1,
            Some(_) => {
                self.remaining -= 1;
                return true;
            }
            None => {}
        }
        false
    }

    fn record(&mut self, node: usize, what: What) {
        let entry = Entry {
            node,
            begin: self.names.node(node).begin as usize,
            depth: self.names.depth(node),
            name: self.names.of(node),
            meaning: self.names.meaning(node),
            what,
        };
        if entry.what.is_resolved() {
            self.resolved.add(entry.begin, node + 1);
        }
        if let Some(question) = self.questions.last_mut() {
            question.entries.push(entry);
        }
    }

    fn face_name(&self, face: Face) -> Arc<str> {
        let program = self.names.program();
        program.leaf(face.leaf).face_name(face.facet as usize).into()
    }

    fn operand(&mut self, node: usize, answer: ValueStep) -> ExplainedOperand {
        let complemented = self.names.node(node).complemented;
        ExplainedOperand {
            node,
            name: self.names.of(node),
            meaning: self.names.meaning(node),
            complemented,
            answer,
        }
    }
}

impl<F: Fn(u32, f64) -> Option<Face>> Observer for Recorder<'_, F> {
    fn leaf(&mut self, node: usize, t_min: f64, answer: Next) {
        let Some(number) = self.names.leaf(node) else { return };
        if self.takes(node) {
            let face = (self.next_face)(number, t_min);
            let face_name = face.map(|face| self.face_name(face));
            let leaf = self.names.leaf_id(number);
            self.record(node, What::Leaf { leaf, t_min, answer, face, face_name });
        }
    }

    fn gate(&mut self, node: usize, operands: [ValueStep; 2], verdict: Verdict) {
        if self.takes(node) {
            let value = self.names.gate_value(node, operands.map(|step| step.before));
            let places = self.names.operands(node);
            let operands = [self.operand(places[0], operands[0]), self.operand(places[1], operands[1])];
            self.record(node, What::Gate { operands, value, verdict });
        }
    }
}

impl<F: Fn(u32, f64) -> Option<Face>> WalkObserver for Recorder<'_, F> {
    fn question(&mut self, t_min: f64) {
        let answer = ValueStep::constant(0);
        self.questions.push(Question {
            t_min,
            entries: Vec::new(),
            repeated: 0,
            left_out: 0,
            answer,
            changes_medium: false,
        });
    }

    fn answer(&mut self, step: ValueStep) {
        let program = self.names.program();
        let medium = |region: u32| program.medium_of(RegionId(region));
        let changes_medium = step.t < self.t_max && medium(step.before) != medium(step.after);
        if let Some(question) = self.questions.last_mut() {
            (question.answer, question.changes_medium) = (step, changes_medium);
        }
    }

    fn crossing(&mut self, crossing: &Crossing) {
        self.found.push(Found { crossing: *crossing, face: self.face_name(crossing.face) });
    }
}
