//! Occurrences: the identity of every leaf at every placement, printable as a path of names and copy numbers.

use crate::trail::{CopyNames, Naming, TrailNode};
use crate::{Face, LeafId, LeafKind, PlacementId, Program, PrototypeId};
use std::fmt;

/// A leaf at one placement in the model: the identity of a shape among all its copies.
///
/// [`Program::occurrence_path`] gives its name. Both ids are those of a [`Face`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Occurrence {
    /// The placement of the leaf.
    pub placement: PlacementId,
    /// The leaf.
    pub leaf: LeafId,
}

impl Occurrence {
    /// The occurrence as one number for columns of tables: the placement in the upper and the leaf in the
    /// lower 32 bits. It is less than 2^63, and stays the same as long as the model does.
    pub fn number(self) -> u64 {
        u64::from(self.placement.0) << 32 | u64::from(self.leaf.0)
    }
}

impl Face {
    /// The leaf of the face at its placement.
    pub fn occurrence(&self) -> Occurrence {
        Occurrence { placement: self.placement, leaf: self.leaf }
    }
}

impl Program {
    /// The path of names and copy numbers that leads to an occurrence, e.g. `tower[3]/brick[12]/hole`.
    ///
    /// Each step is the name of a solid around the leaf; the last one is the name of the leaf, or its kind of
    /// shape. A placed solid has the number of its copy in brackets: the number in the file, where the file
    /// gives one, else counted from 0 in the order of `place`. A placed solid without a name has the name of
    /// its copies, or `place`.
    ///
    /// No two occurrences have the same path: of leaves with equal names in the same place, the second one
    /// ends in `#2`, and so on in the order of declaration; so do solids with equal names, and copies to which
    /// a file gives the same number. (Copies that are [labelled](crate::Copies::labelled) alike in several
    /// solids are meant to be the same copies: within them names should differ.) Names that contain one of
    /// ``/ [ ] # ' "`` or control characters are in single quotes.
    ///
    /// The path is computed from the ids on each call: nothing is stored for each copy.
    ///
    /// ```
    /// use rayweave_math::{Affine, Vec3};
    /// use rayweave_model::{LeafId, Occurrence, PlacementId, Program, Solid};
    /// use rayweave_shape::primitive::{Primitive, Sphere};
    ///
    /// let row = |step: f64| (0..4).map(|k| Affine::translate(Vec3::X * (f64::from(k) * step))).collect::<Vec<_>>();
    /// let ball: Solid = Primitive::from(Sphere::new(1.0)?).into();
    /// let brick = (ball.translate(Vec3::Z) - ball.named("hole")).named("brick");
    /// let tower = brick.place(row(5.0)).named("tower");
    /// let program = Program::compile(&tower.place(row(100.0)).named("world"))?;
    ///
    /// // placement 0 is the model, 1 the first tower, 2 to 5 its bricks
    /// let paths = program.occurrences().map(|occurrence| program.occurrence_path(occurrence).to_string());
    /// let paths: Vec<String> = paths.collect();
    /// assert_eq!(paths.len(), 4 * 4 * 2);
    /// assert_eq!(paths[..2], ["world/tower[0]/brick[0]/sphere", "world/tower[0]/brick[0]/hole"]);
    /// assert_eq!(paths[31], "world/tower[3]/brick[3]/hole");
    ///
    /// let path = program.occurrence_path(program.occurrences().last().unwrap());
    /// assert_eq!(path.steps()[1].copy, Some(3));
    /// assert_eq!(path.placed().to_string(), "world/tower[3]/brick[3]");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn occurrence_path(&self, occurrence: Occurrence) -> OccurrencePath<'_> {
        let (mut path, mut group, mut rest) =
            (OccurrencePath::default(), PrototypeId(0), occurrence.placement.0);
        // the node that names the solid whose copy was entered last: its name is in the path already
        let mut known = None;
        while let Some((run, k)) = self.instance_run_before(group, rest) {
            let copies = &self.trails[group.index()].copies[run];
            path.extend(self.nodes_above(group, copies.node, known));
            path.steps.push(PathStep::of_copy(copies, k));
            let instances = &self.instances_of(group)[run];
            rest -= instances.placement(k);
            group = instances.prototype;
            known = self.trails[group.index()].own.filter(|_| !copies.is_labelled);
        }
        self.leaf_steps(&mut path, group, occurrence.leaf, known);
        path
    }

    /// All occurrences of shapes that can affect an answer, placement by placement.
    pub fn occurrences(&self) -> impl Iterator<Item = Occurrence> {
        let placements = self.prototype(PrototypeId(0)).placements;
        (0..placements).map(PlacementId).flat_map(move |placement| {
            let (_, group) = self.placement(placement);
            let leaves = self.prototype(group).leaves.clone().map(LeafId);
            let is_shape = |&leaf: &LeafId| matches!(self.leaf(leaf).kind(), LeafKind::Shape { .. });
            leaves.filter(is_shape).map(move |leaf| Occurrence { placement, leaf })
        })
    }

    /// The occurrence with a number from [`Occurrence::number`], if the program has it.
    pub fn occurrence(&self, number: u64) -> Option<Occurrence> {
        let (placement, leaf) = (PlacementId((number >> 32) as u32), LeafId(number as u32));
        if placement.0 >= self.prototype(PrototypeId(0)).placements {
            return None;
        }
        let (_, group) = self.placement(placement);
        let is_shape = || matches!(self.leaf(leaf).kind(), LeafKind::Shape { .. });
        let is_known = self.prototype(group).leaves.contains(&leaf.0) && is_shape();
        is_known.then_some(Occurrence { placement, leaf })
    }

    /// The steps from the top of a group to a node, without `known` and what is above it.
    fn nodes_above(&self, group: PrototypeId, node: u32, known: Option<u32>) -> Vec<PathStep<'_>> {
        let above = self.trails[group.index()].above(node).take_while(|(node, _)| Some(*node) != known);
        let mut steps: Vec<_> = above.map(|(_, node)| PathStep::of_node(node)).collect();
        steps.reverse();
        steps
    }

    fn leaf_steps<'p>(
        &'p self,
        path: &mut OccurrencePath<'p>,
        group: PrototypeId,
        leaf: LeafId,
        known: Option<u32>,
    ) {
        let (run, ordinal) = self.trails[group.index()].leaf(leaf.0 - self.prototype(group).leaves.start);
        path.extend(self.nodes_above(group, run.node, known));
        let name = match run.naming {
            Naming::Kind => self.leaf(leaf).shape_name(),
            Naming::Name => self.leaf(leaf).given_name(),
            Naming::Node => None,
        };
        path.steps.extend(name.map(|name| PathStep { name, copy: None, ordinal, is_placed: false }));
    }
}

/// The path to an occurrence: see [`Program::occurrence_path`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OccurrencePath<'p> {
    steps: Vec<PathStep<'p>>,
}

impl<'p> OccurrencePath<'p> {
    /// The steps, outermost first.
    pub fn steps(&self) -> &[PathStep<'p>] {
        &self.steps
    }

    /// The path to the innermost placed solid around the occurrence, e.g. `tower[3]/brick[12]`: the same for all its
    /// leaves. Empty if nothing around the occurrence is placed.
    #[must_use]
    pub fn placed(mut self) -> OccurrencePath<'p> {
        let end = self.steps.iter().rposition(|step| step.is_placed).map_or(0, |last| last + 1);
        self.steps.truncate(end);
        self
    }

    fn extend(&mut self, steps: Vec<PathStep<'p>>) {
        self.steps.extend(steps);
    }
}

impl fmt::Display for OccurrencePath<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, step) in self.steps.iter().enumerate() {
            f.write_str(if k > 0 { "/" } else { "" })?;
            step.fmt(f)?;
        }
        Ok(())
    }
}

/// One step of an [`OccurrencePath`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PathStep<'p> {
    /// The name of the solid, or the kind of the shape.
    pub name: &'p str,
    /// The number of the copy, if the solid is placed.
    pub copy: Option<i64>,
    /// The number of steps before this one that have the same name and copy in the same place.
    pub ordinal: u32,
    /// True if the step is a copy of a placed solid; a single one may have no number.
    pub is_placed: bool,
}

impl<'p> PathStep<'p> {
    fn of_node(node: &'p TrailNode) -> Self {
        let TrailNode { name, copy, ordinal, is_placed, .. } = node;
        PathStep { name, copy: *copy, ordinal: *ordinal, is_placed: *is_placed }
    }

    fn of_copy(copies: &'p CopyNames, k: usize) -> Self {
        let (number, ordinal) = copies.number(k);
        PathStep { name: &copies.name, copy: Some(number), ordinal, is_placed: true }
    }
}

impl fmt::Display for PathStep<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_plain = |c: char| !matches!(c, '/' | '[' | ']' | '#' | '\'' | '"') && !c.is_control();
        match !self.name.is_empty() && self.name.chars().all(is_plain) {
            true => f.write_str(self.name)?,
            false => write!(f, "'{}'", self.name.replace('\'', "''"))?,
        }
        if let Some(copy) = self.copy {
            write!(f, "[{copy}]")?;
        }
        match self.ordinal {
            0 => Ok(()),
            ordinal => write!(f, "#{}", u64::from(ordinal) + 1),
        }
    }
}
