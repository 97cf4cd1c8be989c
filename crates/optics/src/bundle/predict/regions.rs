//! The regions of a program in conjunctive normal form over the sides of its surfaces: known sides
//! determine the regions along a ray and at a crossing.

use rayweave_model::{Edge, Expression, Gate, LeafId, LeafKind, Program, PrototypeId, RegionId, Rule};
use std::collections::{HashMap, HashSet};

/// The greatest number of surfaces, and of regions: each has a bit.
pub(super) const MAX_BITS: usize = 64;

/// The known sides of surfaces, the same for all rays of a bundle. Bit k of a mask is surface k; a
/// surface of unknown side is in neither mask.
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

    /// With the side of one surface unknown.
    pub fn without(self, surface: usize) -> Sides {
        let others = !(1 << surface);
        Sides { inside: self.inside & others, outside: self.outside & others }
    }

    /// The sides known in both.
    pub fn and(self, other: Sides) -> Sides {
        Sides { inside: self.inside & other.inside, outside: self.outside & other.outside }
    }

    /// Bit mask of the surfaces of known side.
    pub fn known(self) -> u64 {
        self.inside | self.outside
    }
}

/// A disjunction of sides.
#[derive(Clone, Copy, Debug, Default)]
struct Clause(Sides);

impl Clause {
    /// The truth value; `None` if the known sides do not determine it.
    fn holds(self, sides: Sides) -> Option<bool> {
        let Clause(Sides { inside, outside }) = self;
        match () {
            () if inside & sides.inside | outside & sides.outside != 0 => Some(true),
            () if inside & !sides.outside | outside & !sides.inside == 0 => Some(false),
            () => None,
        }
    }
}

/// A face of a region.
#[derive(Clone, Copy, Debug)]
struct RegionFace {
    surface: usize,
    leaf: LeafId,
    /// The number of the face in the program.
    number: usize,
}

/// A region in conjunctive normal form: the set of points at which all clauses hold.
#[derive(Clone, Debug, Default)]
struct RegionClauses {
    clauses: Vec<Clause>,
    faces: Vec<RegionFace>,
}

impl RegionClauses {
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
    fn face(&self, surface: usize) -> Option<&RegionFace> {
        self.faces.iter().find(|face| face.surface == surface)
    }
}

/// The regions of a program.
#[derive(Clone, Debug)]
pub(super) struct Regions {
    regions: Vec<RegionClauses>,
    media: Vec<u32>,
    /// True if no region has two faces in one surface, and no two regions share a leaf.
    are_disjoint: bool,
}

/// The crossing of a face by all rays of a bundle, with faces by their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FaceCrossing {
    /// The face that the crossing belongs to.
    pub face: usize,
    /// The face of the region that is left.
    pub left: usize,
    /// The face of the region that is entered.
    pub entered: usize,
    pub before: RegionId,
    pub after: RegionId,
}

impl Regions {
    /// `None` if there are more than [`MAX_BITS`], or if one is not a conjunction of disjunctions
    /// of leaves with convex surfaces. `slots` are the numbers of these surfaces.
    pub fn new(program: &Program, slots: &[Option<usize>]) -> Option<Regions> {
        let group = program.prototype(PrototypeId(0));
        let (expression, first, region) = (&group.expression, group.leaves.start, RegionClauses::default());
        let mut reader = RegionReader { program, expression, first, slots, region };
        let outputs = expression.outputs();
        if outputs.len() > MAX_BITS {
            return None;
        }
        let regions = outputs.iter().map(|&edge| reader.region(edge)).collect::<Option<Vec<_>>>()?;
        let media = (0..=outputs.len() as u32).map(|k| program.medium_of(RegionId(k))).collect();
        let are_disjoint = are_disjoint(&regions);
        Some(Regions { regions, media, are_disjoint })
    }

    /// Bit mask of the regions that contain points with these sides; `None` if the sides do not
    /// determine it.
    pub fn containing(&self, sides: Sides) -> Option<u64> {
        let mut containing = 0;
        for (k, region) in self.regions.iter().enumerate() {
            containing |= u64::from(region.holds(sides)?) << k;
        }
        Some(containing)
    }

    /// The region that owns the points of a set of regions: the last one in the set.
    pub fn owner(containing: u64) -> RegionId {
        RegionId(u64::BITS - containing.leading_zeros())
    }

    fn medium(&self, containing: u64) -> u32 {
        self.media[Regions::owner(containing).index()]
    }

    /// The crossing of a single surface, from one set of regions into another; `None` if the medium
    /// stays the same, if no single face makes the difference, or if regions share leaves.
    ///
    /// Same rule as [`rayweave_model::weld::attribute`]: a crossing belongs to the lowest leaf
    /// whose own change makes a difference, in the state before or in the state behind. A region
    /// changes only with its one leaf in the surface.
    pub fn crossing(&self, surface: usize, before: u64, after: u64) -> Option<FaceCrossing> {
        let (left, entered) = (Regions::owner(before), Regions::owner(after));
        if !self.are_disjoint || self.media[left.index()] == self.media[entered.index()] {
            return None;
        }
        let matters = |k: usize| {
            let differs = |regions: u64| self.medium(regions) != self.medium(regions ^ 1 << k);
            differs(before) || differs(after)
        };
        let changed = (0..self.regions.len()).filter(|k| (before ^ after) >> k & 1 == 1);
        let faces = changed.filter(|&k| matters(k)).filter_map(|k| self.regions[k].face(surface));
        let face = faces.min_by_key(|face| face.leaf)?.number;
        let own = |region: RegionId| {
            let k = region.index().checked_sub(1)?;
            let face = self.regions[k].face(surface).filter(|_| (before ^ after) >> k & 1 == 1);
            face.map(|face| face.number)
        };
        let is_inner = left != RegionId(0) && entered != RegionId(0);
        let of = |region: RegionId| own(region).filter(|_| is_inner).unwrap_or(face);
        Some(FaceCrossing { face, left: of(left), entered: of(entered), before: left, after: entered })
    }
}

/// Converts the regions of a program to clauses.
struct RegionReader<'a> {
    program: &'a Program,
    expression: &'a Expression,
    /// The number of the first leaf of the group.
    first: u32,
    slots: &'a [Option<usize>],
    region: RegionClauses,
}

impl<'a> RegionReader<'a> {
    /// A prepared region: complements are at leaves, and chains of one operator are joined.
    fn region(&mut self, edge: Edge) -> Option<RegionClauses> {
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
                for (face, inside) in self.faces(leaf)? {
                    self.add(&[(face, inside)]);
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
            let faces = self.faces(leaf)?;
            if faces.len() > 1 && !edge.is_complemented() {
                return None;
            }
            all.extend(faces.into_iter().map(|(face, inside)| (face, inside != edge.is_complemented())));
        }
        self.add(&all);
        Some(())
    }

    fn add(&mut self, faces: &[(RegionFace, bool)]) {
        let clause = faces.iter().fold(Sides::default(), |clause, (face, inside)| {
            let one = Sides::default().with(face.surface, *inside);
            Sides { inside: clause.inside | one.inside, outside: clause.outside | one.outside }
        });
        self.region.clauses.push(Clause(clause));
        self.region.faces.extend(faces.iter().map(|(face, _)| *face));
    }

    /// The faces of a leaf, and whether the leaf is where f < 0.
    fn faces(&self, leaf: LeafId) -> Option<Vec<(RegionFace, bool)>> {
        let leaf = LeafId(self.first + leaf.0);
        let LeafKind::Shape { facets } = self.program.leaf(leaf).kind() else { return None };
        let face = |number: u32| {
            let facet = self.program.facets()[number as usize];
            let surface = self.slots.get(facet.surface().index()).copied().flatten()?;
            Some((RegionFace { surface, leaf, number: number as usize }, facet.inside()))
        };
        facets.map(face).collect()
    }
}

/// True if no region has two faces in one surface, and no two regions share a leaf.
fn are_disjoint(regions: &[RegionClauses]) -> bool {
    let mut owners = HashMap::new();
    regions.iter().enumerate().all(|(k, region)| {
        let mut seen = HashSet::new();
        region
            .faces
            .iter()
            .all(|face| seen.insert(face.surface) && *owners.entry(face.leaf).or_insert(k) == k)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clauses_hold_on_enough_known_sides() {
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
