//! Why an answer is what it is: the record of every decision, as data and as a story.

use super::evaluator::WatchWalk;
use super::names::Names;
use super::{Next, SingleHit, Step, Verdict, Watch};
use rayweave_model::{
    Crossing, Evaluator, Face, GroupRay, LeafId, Limit, Program, PrototypeId, Query, RegionId,
};
use rayweave_shape::Ray;
use std::fmt;
use std::ops::Range;

/// How the answer for one ray came about. Its `Display` tells it as a story.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// The ray.
    pub ray: Ray,
    /// The region just after the beginning of the window; 0 is the world.
    pub start: RegionId,
    /// The name of that region.
    pub start_name: String,
    /// What the model was asked, in order.
    pub questions: Vec<Question>,
    /// The crossings: the answer.
    pub crossings: Vec<Found>,
    /// How many changes of medium were welded with their neighbours; counted where all crossings are asked
    /// for.
    pub welded: usize,
}

/// One question to the whole model: "what is next after t_min?".
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// The time that is asked from, which may be -inf.
    pub t_min: f64,
    /// Every leaf asked and every decision made, in order.
    pub entries: Vec<Entry>,
    /// The answer: numbers of regions, 0 is the world.
    pub answer: Step,
    /// The same with the names of the regions.
    pub answer_text: String,
    /// True if the medium changes then, within the window.
    pub changes_medium: bool,
}

/// A leaf asked or a decision made.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The node, by its place in the tree's post-order.
    pub node: usize,
    /// Where its sub-tree begins: all nodes from there on, up to itself, are below it.
    pub begin: usize,
    /// What it is called.
    pub name: String,
    /// What happened.
    pub what: What,
}

/// What happened at a node.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// A leaf was asked.
    Leaf {
        /// Its number in the program.
        leaf: LeafId,
        /// The time it was asked from.
        t_min: f64,
        /// What it answered.
        answer: Next,
        /// The face that it crosses next.
        face: Option<Face>,
        /// What the face is called.
        face_name: Option<String>,
    },
    /// A gate decided from the answers of its operands.
    Gate {
        /// The operands.
        operands: [Operand; 2],
        /// The decision, before any complement.
        verdict: Verdict,
        /// The sentence that tells it.
        text: String,
    },
}

impl What {
    /// True if the node was found never to change again.
    pub fn is_settled(&self) -> bool {
        match self {
            What::Leaf { answer, .. } => answer.time() == f64::INFINITY,
            What::Gate { verdict, .. } => matches!(verdict, Verdict::Fixed(_)),
        }
    }

    /// The number of the rule that decided (see [`super::decide`]); `None` for a leaf.
    pub fn rule(&self) -> Option<u8> {
        match self {
            What::Leaf { .. } => None,
            What::Gate { verdict: Verdict::Fixed(_), .. } => Some(1),
            What::Gate { verdict: Verdict::Changes(_), .. } => Some(3),
            What::Gate { verdict: Verdict::AskAgain { .. }, .. } => Some(4),
        }
    }
}

/// An operand of a decision.
#[derive(Clone, Debug, PartialEq)]
pub struct Operand {
    /// The node, by its place in the tree's post-order.
    pub node: usize,
    /// What it is called.
    pub name: String,
    /// True if the gate takes its complement.
    pub complemented: bool,
    /// Its answer, as the gate takes it.
    pub answer: Step,
}

/// A crossing with names.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The crossing.
    pub crossing: Crossing,
    /// The name of the face.
    pub face: String,
    /// The name of the region before.
    pub before: String,
    /// The name of the region after.
    pub after: String,
}

impl Explanation {
    pub(super) fn new(evaluator: &SingleHit, ray: Ray, query: &Query<'_>) -> Explanation {
        let starts = query.starts.map_or(&[][..], |lists| lists.of(0));
        let mut scratch = evaluator.scratch();
        let seen = GroupRay::world(evaluator.program(), ray, starts);
        let mut level = evaluator.gather(PrototypeId(0), &seen, 0, &mut scratch);
        // the faces are looked up while the walk borrows the roots for itself
        let roots = level.roots.clone();
        let mut recorder = Recorder {
            names: Names::new(evaluator),
            next_face: |leaf: u32, t: f64| roots.next_face(leaf, t),
            questions: Vec::new(),
            found: Vec::new(),
            t_max: query.window.t_max(),
        };
        let start = evaluator.walk(ray, query, !starts.is_empty(), &mut level, &mut scratch, &mut recorder);
        let start_name = region_name(evaluator.program(), start).to_owned();
        let (questions, crossings) = (recorder.questions, recorder.found);
        let changes = questions.iter().filter(|question| question.changes_medium).count();
        let welded = if query.limit == Limit::All { changes.saturating_sub(crossings.len()) } else { 0 };
        Explanation { ray, start, start_name, questions, crossings, welded }
    }
}

fn region_name(program: &Program, region: RegionId) -> &str {
    region.index().checked_sub(1).map_or("the world", |k| &program.regions()[k].name)
}

/// Writes a walk down.
struct Recorder<'a, F> {
    names: Names<'a>,
    next_face: F,
    questions: Vec<Question>,
    found: Vec<Found>,
    t_max: f64,
}

impl<F> Recorder<'_, F> {
    fn record(&mut self, node: usize, what: What) {
        let (name, begin) = (self.names.of(node), self.names.node(node).begin as usize);
        if let Some(question) = self.questions.last_mut() {
            question.entries.push(Entry { node, begin, name, what });
        }
    }

    fn face_name(&self, face: Face) -> String {
        let program = self.names.program();
        program.facets()[program.face_number(face.leaf, face.facet) as usize].name.to_string()
    }

    fn operand(&mut self, node: usize, answer: Step) -> Operand {
        let complemented = self.names.node(node).complemented;
        Operand { node, name: self.names.of(node), complemented, answer }
    }
}

impl<F: Fn(u32, f64) -> Option<Face>> Watch for Recorder<'_, F> {
    fn leaf(&mut self, node: usize, t_min: f64, answer: Next) {
        let Some(number) = self.names.leaf(node) else { return };
        let face = (self.next_face)(number, t_min);
        let face_name = face.map(|face| self.face_name(face));
        let leaf = self.names.leaf_id(number);
        self.record(node, What::Leaf { leaf, t_min, answer, face, face_name });
    }

    fn gate(&mut self, node: usize, operands: [Step; 2], verdict: Verdict) {
        let places = self.names.operands(node);
        let operands = [self.operand(places[0], operands[0]), self.operand(places[1], operands[1])];
        let text = self.names.sentence(node, &operands, verdict);
        self.record(node, What::Gate { operands, verdict, text });
    }
}

impl<F: Fn(u32, f64) -> Option<Face>> WatchWalk for Recorder<'_, F> {
    fn question(&mut self, t_min: f64) {
        self.questions.push(Question {
            t_min,
            entries: Vec::new(),
            answer: Step::constant(0),
            answer_text: String::new(),
            changes_medium: false,
        });
    }

    fn answer(&mut self, step: Step) {
        let program = self.names.program();
        let name = |region: u32| region_name(program, RegionId(region));
        let text = match step.settled() {
            Some(region) => format!("in {} from here on", name(region)),
            None => format!("in {} until t = {}, then in {}", name(step.before), step.t, name(step.after)),
        };
        let medium = |region: u32| program.medium_of(RegionId(region));
        let changes_medium = step.t < self.t_max && medium(step.before) != medium(step.after);
        if let Some(question) = self.questions.last_mut() {
            (question.answer, question.answer_text, question.changes_medium) = (step, text, changes_medium);
        }
    }

    fn crossing(&mut self, crossing: &Crossing) {
        let name = |region: RegionId| region_name(self.names.program(), region).to_owned();
        let (before, after) = (name(crossing.before), name(crossing.after));
        self.found.push(Found { crossing: *crossing, face: self.face_name(crossing.face), before, after });
    }
}

/// What has been told to be so for good is not told again.
impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (o, d) = (self.ray.origin, self.ray.direction);
        writeln!(f, "The ray ({}, {}, {}) + t ({}, {}, {}).", o.x, o.y, o.z, d.x, d.y, d.z)?;
        let mut settled: Vec<Range<usize>> = Vec::new();
        for question in &self.questions {
            writeln!(f, "\nWhat is next after t = {}?", question.t_min)?;
            for entry in &question.entries {
                if settled.iter().any(|range| range.contains(&entry.node)) {
                    continue;
                }
                write!(f, "  {entry}")?;
                if entry.what.is_settled() {
                    settled.retain(|range| !(entry.begin..entry.node).contains(&range.start));
                    settled.push(entry.begin..entry.node + 1);
                }
            }
            writeln!(f, "  So the ray is {}.", question.answer_text)?;
        }
        self.summary(f)
    }
}

impl Explanation {
    fn summary(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "\nThe ray starts in {}.", self.start_name)?;
        for found in &self.crossings {
            let Found { crossing, face, before, after } = found;
            writeln!(f, "At t = {} it passes from {before} into {after}, by the face {face}.", crossing.t)?;
        }
        if self.welded > 0 {
            let n = self.welded;
            writeln!(f, "Changes welded because the ray keeps to both surfaces between them: {n}.")?;
        }
        let steps: usize = self.questions.iter().map(|question| question.entries.len()).sum();
        writeln!(f, "({} questions, {steps} steps.)", self.questions.len())
    }
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.what {
            What::Leaf { answer, face_name: Some(face), .. } => {
                writeln!(f, "{} is {answer}, by its face {face}.", self.name)
            }
            What::Leaf { answer, .. } => writeln!(f, "{} is {answer}.", self.name),
            What::Gate { text, .. } => writeln!(f, "{text} (rule {})", self.what.rule().unwrap_or_default()),
        }
    }
}
