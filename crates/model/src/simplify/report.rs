//! Readable report on the simplification of a model.

use super::bounds::{Beyond, bounds};
use super::formula::{Formula, Op, Term};
use super::positive::keeps_complements;
use super::prune::{PrunedPart, Reason, reason};
use super::{Observer, Pass, balance, height};
use crate::compile::compile_observed;
use crate::lower::{Content, Group};
use crate::number_map::NumberMap;
use crate::{CompileError, Edge, LeafId, Program, PrototypeId, Region};
use rayweave_math::Bounds;
use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

/// Report on the simplification of one group: the model itself, or a placed solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Preparation {
    /// The group.
    pub group: PrototypeId,
    /// The solid, in words: the model, or the name and number of copies of a placed solid.
    pub whose: String,
    /// The passes in order; each starts from the result of the one before.
    pub passes: Vec<PassReport>,
    /// The parts removed because of their bounds.
    pub removals: Vec<Removal>,
    /// The names of the leaves that no output uses any more, for any reason.
    pub unused: Vec<String>,
    /// The size as binary trees, the form that the single-hit evaluator uses.
    pub balanced: FormulaSize,
    /// The formula before simplification, with names of leaves; cut off if it is long.
    pub written: String,
    /// The formula after simplification, likewise.
    pub kept: String,
    /// The union of the boxes of all leaves.
    pub loose: Bounds,
    /// The box that follows from the formula.
    pub tight: Bounds,
}

/// The effect of a pass on the size of the formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassReport {
    /// The pass.
    pub pass: Pass,
    /// The size of the formula before it.
    pub before: FormulaSize,
    /// The size after it.
    pub after: FormulaSize,
}

/// The size of a formula; shared nodes count once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FormulaSize {
    /// The number of different leaves.
    pub leaves: usize,
    /// The number of operators.
    pub operators: usize,
    /// The number of operands that are complements of operators other than symmetric differences.
    pub complements: usize,
    /// The number of operators on the longest path from an output to a leaf.
    pub height: u32,
}

/// A part that was removed because its bounds show that it does not matter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Removal {
    /// The name or description of the part.
    pub part: String,
    /// The reason, in words.
    pub why: String,
    /// The constant that replaces it: universe if true, empty if false.
    pub inside: bool,
}

impl Preparation {
    /// Compiles a model and reports the simplification of each of its groups, the model itself first.
    ///
    /// # Errors
    /// Those of [`crate::Program::compile_regions`].
    pub fn of_regions(regions: &[Region]) -> Result<Vec<Preparation>, CompileError> {
        let reports = RefCell::new(Vec::new());
        let program = compile_observed(regions, |id, group| Reporter::new(id, group, &reports))?;
        let mut reports: Vec<Preparation> = reports.into_inner();
        reports.sort_by_key(|report| report.group);
        reports.iter_mut().skip(1).for_each(|report| report.whose = placed(&program, report.group));
        Ok(reports)
    }

    /// The sizes before and after simplification.
    pub fn sizes(&self) -> (FormulaSize, FormulaSize) {
        let first = self.passes.first().map(|pass| pass.before).unwrap_or_default();
        (first, self.passes.last().map_or(first, |pass| pass.after))
    }

    /// The report as text, with at most `most` removed parts.
    pub fn text(&self, most: usize) -> String {
        let (written, kept) = self.sizes();
        let mut text = format!("preparation of {}\n\n", self.whose);
        if written.operators == 0 {
            return format!("{text}{}: there is nothing to prepare\n", self.kept);
        }
        text += &format!("as written  {}\nas kept     {}\n\n", self.written, self.kept);
        text += &row("pass", "operators", "complements", "height", "property established");
        for PassReport { pass, before, after } in &self.passes {
            text += &sizes(pass.name(), *before, *after, pass.contract());
        }
        text += &sizes("balance", kept, self.balanced, "binary trees, for the single-hit evaluator alone");
        text += &format!("\nleaves  {} of {} are used\n", kept.leaves, kept.leaves + self.unused.len());
        text += &format!("bounds  {} of all leaves\n", bounds_text(&self.loose));
        text += &format!("        {} of the solid they form\n", bounds_text(&self.tight));
        self.removed(most, &mut text);
        text
    }

    fn removed(&self, most: usize, text: &mut String) {
        if self.removals.is_empty() {
            return;
        }
        *text += "\nnot used, as bounds show that they do not matter:\n";
        for Removal { part, why, .. } in self.removals.iter().take(most) {
            *text += &format!("  {part}: {why}\n");
        }
        if self.removals.len() > most {
            *text += &format!("  ... and {} more\n", self.removals.len() - most);
        }
    }
}

impl fmt::Display for Preparation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(20))
    }
}

/// The name of a placed solid and the number of its copies, in words.
fn placed(program: &Program, group: PrototypeId) -> String {
    let runs = program.leaves.instances.iter().filter(|run| run.prototype == group);
    let name = runs.clone().next().map_or("", |run| &run.name);
    format!("the solid placed as {name}, {} times", runs.map(|run| run.len()).sum::<usize>())
}

fn row(pass: &str, operators: &str, complements: &str, height: &str, contract: &str) -> String {
    format!("{pass:<8}  {operators:<14}  {complements:<11}  {height:<8}  {contract}\n")
}

fn sizes(pass: &str, before: FormulaSize, after: FormulaSize, contract: &str) -> String {
    let operators = arrow(before.operators, after.operators);
    let complements = arrow(before.complements, after.complements);
    row(pass, &operators, &complements, &arrow(before.height, after.height), contract)
}

fn arrow<T: PartialEq + fmt::Display>(before: T, after: T) -> String {
    if before == after { before.to_string() } else { format!("{before} -> {after}") }
}

fn bounds_text(bounds: &Bounds) -> String {
    let corner = |p: rayweave_math::Vec3| format!("({}, {}, {})", short(p.x), short(p.y), short(p.z));
    if bounds.is_empty() {
        "nothing".into()
    } else {
        format!("{} to {}", corner(bounds.lo), corner(bounds.hi))
    }
}

/// A number to six digits.
fn short(x: f64) -> f64 {
    // -0 becomes 0
    rayweave_math::round_to_digits(x, 6) + 0.0
}

impl FormulaSize {
    /// The size of the part of a formula that its outputs reach.
    pub fn of(formula: &Formula) -> FormulaSize {
        let uses = formula.uses();
        let mut size = FormulaSize { height: height(formula), ..FormulaSize::default() };
        let mut leaves = Vec::new();
        let sinks = |edge: &&Edge| edge.is_complemented() && !keeps_complements(formula.term(edge.node()));
        let complements = |edges: &[Edge]| edges.iter().filter(sinks).count();
        for (node, term, operands) in formula.nodes() {
            match term {
                _ if uses[node.index()] == 0 => {}
                Term::Leaf(leaf) => leaves.push(leaf),
                Term::Join(_) => {
                    size.operators += 1;
                    size.complements += complements(operands);
                }
                Term::Empty | Term::Universe => {}
            }
        }
        leaves.sort_unstable();
        leaves.dedup();
        FormulaSize {
            leaves: leaves.len(),
            complements: size.complements + complements(formula.outputs()),
            ..size
        }
    }
}

/// Writes the report of a group while it is simplified.
struct Reporter<'r> {
    names: Names,
    report: Preparation,
    reports: &'r RefCell<Vec<Preparation>>,
}

impl<'r> Reporter<'r> {
    fn new(id: usize, group: &Group, reports: &'r RefCell<Vec<Preparation>>) -> Self {
        let report = Preparation {
            group: PrototypeId::from(id),
            whose: "the model".to_owned(),
            passes: Vec::new(),
            removals: Vec::new(),
            unused: Vec::new(),
            balanced: FormulaSize::default(),
            written: String::new(),
            kept: String::new(),
            loose: Bounds::EMPTY,
            tight: Bounds::EMPTY,
        };
        let names = Names { leaves: distinct_names(group), compounds: group.names.clone() };
        Reporter { names, report, reports }
    }
}

impl Observer for Reporter<'_> {
    fn pass(&mut self, pass: Pass, before: &Formula, after: &Formula) {
        self.report.passes.push(PassReport {
            pass,
            before: FormulaSize::of(before),
            after: FormulaSize::of(after),
        });
    }

    fn cuts(&mut self, formula: &Formula, leaves: &[Bounds], cuts: &[PrunedPart]) {
        let nodes = bounds(formula, leaves);
        let removal = |&cut: &PrunedPart| {
            let part = self.names.plain(formula, cut.part);
            Removal { part, why: self.names.why(formula, &nodes, cut), inside: cut.inside }
        };
        self.report.removals = cuts.iter().map(removal).collect();
    }

    fn finish(&mut self, written: &Formula, kept: &Formula, leaves: &[Bounds], tight: Bounds) {
        let mut used = vec![false; leaves.len()];
        let uses = kept.uses();
        for (node, term, _) in kept.nodes() {
            if let Term::Leaf(leaf) = term {
                used[leaf.index()] |= uses[node.index()] > 0;
            }
        }
        let unused = self.names.leaves.iter().zip(&used).filter(|(_, used)| !**used);
        self.report.unused = unused.map(|(name, _)| name.to_string()).collect();
        self.report.balanced = FormulaSize::of(&balance(kept));
        self.report.written = self.names.outputs(written);
        self.report.kept = self.names.outputs(kept);
        self.report.loose = leaves.iter().fold(Bounds::EMPTY, |all, leaf| all.union(leaf));
        self.report.tight = tight;
        self.reports.borrow_mut().push(self.report.clone());
    }
}

/// The names of the leaves, made distinct: by the name of the enclosing compound, or else by a number.
fn distinct_names(group: &Group) -> Vec<Arc<str>> {
    let count = |names: &[Arc<str>]| {
        let mut counts: HashMap<Arc<str>, usize> = HashMap::new();
        names.iter().for_each(|name| *counts.entry(name.clone()).or_default() += 1);
        counts
    };
    let mut names: Vec<Arc<str>> = Vec::with_capacity(group.leaf_count);
    let mut parts = Vec::with_capacity(group.leaf_count);
    for part in &group.parts {
        match &part.content {
            Content::Shape(_) => names.push(part.name.clone()),
            Content::Copies(_, _, maps) => {
                names.extend((0..maps.len()).map(|k| Arc::from(format!("{}[{k}]", part.name))));
            }
        }
        parts.resize(names.len(), part);
    }
    let counts = count(&names);
    for (name, part) in names.iter_mut().zip(parts).filter(|(name, _)| counts[&**name] > 1) {
        if let Some(outer) = group.outer_name(part) {
            *name = format!("{outer}/{name}").into();
        }
    }
    let (counts, mut numbers) = (count(&names), HashMap::<Arc<str>, usize>::new());
    for name in names.iter_mut().filter(|name| counts[&***name] > 1) {
        let number = numbers.entry(name.clone()).or_default();
        *number += 1;
        *name = format!("{name}#{number}").into();
    }
    names
}

/// The names of leaves and compounds.
struct Names {
    leaves: Vec<Arc<str>>,
    /// By tag.
    compounds: NumberMap<u32, Arc<str>>,
}

/// Length in bytes at which formulas are cut off.
const LONG: usize = 160;

/// Length in bytes above which the description of a part is replaced by a count.
const WORDY: usize = 48;

impl Names {
    fn leaf(&self, leaf: LeafId) -> &str {
        self.leaves.get(leaf.index()).map_or("", |name| &**name)
    }

    fn outputs(&self, formula: &Formula) -> String {
        let mut texts = Vec::new();
        let mut left = LONG;
        for &output in formula.outputs() {
            let text = formula.infix(output, |leaf| self.leaf(leaf).to_owned(), left);
            left = left.saturating_sub(text.len());
            texts.push(text);
            if left == 0 {
                break;
            }
        }
        let rest = formula.outputs().len() - texts.len();
        let more = if rest > 0 { format!("; and {rest} more") } else { String::new() };
        format!("{}{more}", texts.join("; "))
    }

    /// The name or text of the node of an edge, ignoring a complement.
    fn plain(&self, formula: &Formula, edge: Edge) -> String {
        let node = edge.node();
        let op = match formula.term(node) {
            Term::Leaf(leaf) => return self.leaf(leaf).to_owned(),
            Term::Empty => return "empty".to_owned(),
            Term::Universe => return "universe".to_owned(),
            Term::Join(op) => op,
        };
        if let Some(name) = self.compounds.get(&formula.tag(node)) {
            return name.to_string();
        }
        let text = formula.infix(Edge::new(node, false), |leaf| self.leaf(leaf).to_owned(), WORDY);
        if text.len() <= WORDY {
            return text;
        }
        let count = formula.operands(node).len();
        match op {
            Op::Union => format!("a union of {count}"),
            Op::Intersection | Op::Difference => format!("an intersection of {count}"),
            Op::SymmetricDifference => format!("a symmetric difference of {count}"),
            Op::AtLeast(least) => format!("at least {least} of {count}"),
        }
    }

    fn why(&self, formula: &Formula, nodes: &[Beyond], cut: PrunedPart) -> String {
        let name = |edge: Edge| self.plain(formula, edge);
        match reason(formula, nodes, cut) {
            Reason::Constant(pair) => {
                let what = if nodes[cut.part.node().index()].inside { "everywhere" } else { "nowhere" };
                let why = |(a, b)| format!(", as the bounds of {} and {} are disjoint", name(a), name(b));
                format!("it is {what}{}", pair.map_or_else(String::new, why))
            }
            Reason::Apart(from) => format!("it lies outside {}: A - B with disjoint bounds.", name(from)),
            Reason::Absorbed(by) => {
                format!("it is absorbed by the complement of {}, which it lies outside of", name(by))
            }
            Reason::Decided => "it lies where the rest decides".to_owned(),
        }
    }
}
