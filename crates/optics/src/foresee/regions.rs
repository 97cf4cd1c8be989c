//! The regions of a program as functions of the sides of its surfaces: enough to tell what happens at a crossing from the
//! sides on which a ray keeps.

use rayweave_model::{Edge, Expression, Gate, LeafId, LeafKind, Program, PrototypeId, RegionId, Rule};
use std::collections::{HashMap, HashSet};

/// Surfaces, and regions, that can be told apart: a bit each.
pub(super) const MOST: usize = 64;

/// The sides on which all of some rays surely are; a bit for each surface, none where that is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sides {
    /// f < 0.
    pub inside: u64,
    /// f > 0.
    pub outside: u64,
}

impl Sides {
    /// With one surface on a side.
    pub fn with(self, surface: usize, inside: bool) -> Sides {
        let Sides { inside: below, outside: above } = self.without(surface);
        let (bit, none) = (1 << surface, 0);
        let (here, there) = if inside { (bit, none) } else { (none, bit) };
        Sides { inside: below | here, outside: above | there }
    }

    /// With nothing known of one surface.
    pub fn without(self, surface: usize) -> Sides {
        let others = !(1 << surface);
        Sides { inside: self.inside & others, outside: self.outside & others }
    }

    /// What both know.
    pub fn and(self, other: Sides) -> Sides {
        Sides { inside: self.inside & other.inside, outside: self.outside & other.outside }
    }

    /// The surfaces of which the side is known.
    pub fn known(self) -> u64 {
        self.inside | self.outside
    }
}

/// Sides of surfaces of which one is enough.
#[derive(Clone, Copy, Debug, Default)]
struct Clause(Sides);

impl Clause {
    /// Whether it holds on some sides, if they tell.
    fn holds(self, sides: Sides) -> Option<bool> {
        let Clause(Sides { inside, outside }) = self;
        match () {
            () if inside & sides.inside | outside & sides.outside != 0 => Some(true),
            () if inside & !sides.outside | outside & !sides.inside == 0 => Some(false),
            () => None,
        }
    }
}

/// A face of a leaf of a region.
#[derive(Clone, Copy, Debug)]
struct Side {
    surface: usize,
    leaf: LeafId,
    /// The number of the face among all.
    face: usize,
}

/// A region that is where all of some clauses hold.
#[derive(Clone, Debug, Default)]
struct Clauses {
    clauses: Vec<Clause>,
    sides: Vec<Side>,
}

impl Clauses {
    fn holds(&self, sides: Sides) -> Option<bool> {
        let mut all = Some(true);
        for clause in &self.clauses {
            match clause.holds(sides) {
                Some(true) => {}
                Some(false) => return Some(false),
                None => all = None,
            }
        }
        all
    }

    /// The face in a surface; there is one at most.
    fn side(&self, surface: usize) -> Option<&Side> {
        self.sides.iter().find(|side| side.surface == surface)
    }
}

/// The regions of a program.
#[derive(Clone, Debug)]
pub(super) struct Regions {
    regions: Vec<Clauses>,
    media: Vec<u32>,
    /// True if no region has two faces in one surface, and no two have the same leaf.
    are_apart: bool,
}

/// What happens where a surface is crossed: faces by their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Step {
    /// The face that the crossing belongs to.
    pub face: usize,
    /// That of the region that is left.
    pub left: usize,
    /// That of the region that is entered.
    pub entered: usize,
    pub before: RegionId,
    pub after: RegionId,
}

impl Regions {
    /// `None` if they are more than can be told apart, or not conjunctions of disjunctions of leaves with convex surfaces.
    /// `slots` are the numbers of the surfaces that are known.
    pub fn new(program: &Program, slots: &[Option<usize>]) -> Option<Regions> {
        let group = program.prototype(PrototypeId(0));
        let (expression, first, region) = (&group.expression, group.leaves.start, Clauses::default());
        let mut reader = Reader { program, expression, first, slots, region };
        let outputs = expression.outputs();
        if outputs.len() > MOST {
            return None;
        }
        let regions = outputs.iter().map(|&edge| reader.region(edge)).collect::<Option<Vec<_>>>()?;
        let media = (0..=outputs.len() as u32).map(|k| program.medium_of(RegionId(k))).collect();
        let are_apart = are_apart(&regions);
        Some(Regions { regions, media, are_apart })
    }

    /// The regions that rays are in which keep to some sides, a bit each; `None` if that is not sure.
    pub fn held(&self, sides: Sides) -> Option<u64> {
        let mut held = 0;
        for (k, region) in self.regions.iter().enumerate() {
            held |= u64::from(region.holds(sides)?) << k;
        }
        Some(held)
    }

    /// The one that wins: the last.
    pub fn winner(held: u64) -> RegionId {
        RegionId(u64::BITS - held.leading_zeros())
    }

    fn medium(&self, held: u64) -> u32 {
        self.media[Regions::winner(held).index()]
    }

    /// What happens where a surface alone is crossed, from some regions into others; `None` if the medium stays the same, if
    /// no face alone makes the difference, or if regions share leaves.
    ///
    /// As [`rayweave_model::weld::attribute`] has it: a crossing belongs to the lowest leaf of those whose own change makes
    /// a difference, from the one state or the other. A region changes with its one leaf in the surface.
    pub fn step(&self, surface: usize, before: u64, after: u64) -> Option<Step> {
        let (left, entered) = (Regions::winner(before), Regions::winner(after));
        if !self.are_apart || self.media[left.index()] == self.media[entered.index()] {
            return None;
        }
        let matters = |k: usize| {
            let differs = |held: u64| self.medium(held) != self.medium(held ^ 1 << k);
            differs(before) || differs(after)
        };
        let changed = (0..self.regions.len()).filter(|k| (before ^ after) >> k & 1 == 1);
        let sides = changed.filter(|&k| matters(k)).filter_map(|k| self.regions[k].side(surface));
        let face = sides.min_by_key(|side| side.leaf)?.face;
        let own = |region: RegionId| {
            let k = region.index().checked_sub(1)?;
            let side = self.regions[k].side(surface).filter(|_| (before ^ after) >> k & 1 == 1);
            side.map(|side| side.face)
        };
        let is_inner = left != RegionId(0) && entered != RegionId(0);
        let of = |region: RegionId| own(region).filter(|_| is_inner).unwrap_or(face);
        Some(Step { face, left: of(left), entered: of(entered), before: left, after: entered })
    }
}

/// Reads the regions of a program.
struct Reader<'a> {
    program: &'a Program,
    expression: &'a Expression,
    /// The number of the first leaf of the group.
    first: u32,
    slots: &'a [Option<usize>],
    region: Clauses,
}

impl<'a> Reader<'a> {
    /// A region as it was prepared: complements stand at leaves, and chains of one operator are one.
    fn region(&mut self, edge: Edge) -> Option<Clauses> {
        match self.gate(edge)? {
            Gate::Join(rule, operands) if rule == Rule::AtLeast(operands.len() as u32) => {
                operands.iter().try_for_each(|&operand| self.clause(operand))?;
            }
            _ => self.clause(edge)?,
        }
        Some(std::mem::take(&mut self.region))
    }

    /// The gate at an edge, which is not complemented unless it is a leaf.
    fn gate(&self, edge: Edge) -> Option<Gate<'a>> {
        let gate = self.expression.node(edge.node());
        (!edge.is_complemented() || matches!(gate, Gate::Leaf(_))).then_some(gate)
    }

    /// One operand of an intersection.
    fn clause(&mut self, edge: Edge) -> Option<()> {
        let operands = match self.gate(edge)? {
            Gate::Leaf(leaf) if !edge.is_complemented() => {
                for (side, inside) in self.sides(leaf)? {
                    self.add(&[(side, inside)]);
                }
                return Some(());
            }
            Gate::Leaf(_) => vec![edge],
            Gate::Join(Rule::AtLeast(1), operands) => operands.into_owned(),
            _ => return None,
        };
        let mut all = Vec::new();
        for edge in operands {
            let Gate::Leaf(leaf) = self.gate(edge)? else { return None };
            let sides = self.sides(leaf)?;
            if sides.len() > 1 && !edge.is_complemented() {
                return None;
            }
            all.extend(sides.into_iter().map(|(side, inside)| (side, inside != edge.is_complemented())));
        }
        self.add(&all);
        Some(())
    }

    fn add(&mut self, sides: &[(Side, bool)]) {
        let clause = sides.iter().fold(Sides::default(), |clause, (side, inside)| {
            let one = Sides::default().with(side.surface, *inside);
            Sides { inside: clause.inside | one.inside, outside: clause.outside | one.outside }
        });
        self.region.clauses.push(Clause(clause));
        self.region.sides.extend(sides.iter().map(|(side, _)| *side));
    }

    /// The faces of a leaf, and whether it is where f < 0.
    fn sides(&self, leaf: LeafId) -> Option<Vec<(Side, bool)>> {
        let leaf = LeafId(self.first + leaf.0);
        let LeafKind::Shape { facets } = self.program.leaf(leaf).kind() else { return None };
        let side = |face: u32| {
            let facet = self.program.facets()[face as usize];
            let surface = self.slots.get(facet.surface().index()).copied().flatten()?;
            Some((Side { surface, leaf, face: face as usize }, facet.inside()))
        };
        facets.map(side).collect()
    }
}

/// True if no region has two faces in one surface, and no two have the same leaf.
fn are_apart(regions: &[Clauses]) -> bool {
    let mut owners = HashMap::new();
    regions.iter().enumerate().all(|(k, region)| {
        let mut seen = HashSet::new();
        region
            .sides
            .iter()
            .all(|side| seen.insert(side.surface) && *owners.entry(side.leaf).or_insert(k) == k)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clauses_hold_where_enough_is_known() {
        let sides = |inside, outside| Sides { inside, outside };
        let clause = Clause(sides(0b01, 0b10));
        assert_eq!(clause.holds(sides(0b01, 0)), Some(true));
        assert_eq!(clause.holds(sides(0, 0b10)), Some(true));
        assert_eq!(clause.holds(sides(0b10, 0b01)), Some(false));
        assert_eq!(clause.holds(sides(0b10, 0)), None);
        assert_eq!(Clause::default().holds(sides(0, 0)), Some(false));
        assert_eq!(sides(0b11, 0b100).with(2, true).with(0, false), sides(0b110, 0b001));
    }
}
