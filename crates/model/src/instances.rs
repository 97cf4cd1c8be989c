//! Instances of a placed solid, stored compactly; their maps are recomputed bit for bit.

use crate::{CompileProblem, PrototypeId};
use rayweave_math::{Affine, Mat3, SingularError, Vec3};
use std::sync::Arc;

/// The map into the frame of a placed solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// From the frame of the enclosing group to that of the solid.
    pub local_from_world: Affine,
    /// Sum of the lengths of all translations composed in this map, in units of the outer frame. Each of them
    /// was rounded, so tolerances must count them even where they cancel.
    pub path: f64,
}

/// The instances that one `place` makes: consecutive leaves of a group.
///
/// Stores the translation of each copy, and its linear part if these differ. Everything else is recomputed on
/// each use, always in the same way.
#[derive(Clone, Debug)]
pub(crate) struct Instances {
    /// The name of the copies; each one appends its number in brackets.
    pub name: Arc<str>,
    /// The solid that is placed.
    pub prototype: PrototypeId,
    /// The first of the leaves, and the number of instances among the leaves before it.
    pub first_leaf: u32,
    pub before: u32,
    /// The number of the first placement, relative to that of the group, and the number of placements in each
    /// copy.
    pub first_placement: u32,
    pub placements_each: u32,
    /// The map around all copies, and the sum of the lengths of the translations composed into it.
    outer: Affine,
    way: f64,
    /// The translation of each copy, within `outer`.
    translations: Vec<Vec3>,
    linear: Linear,
}

/// The linear parts of the maps of all copies, `outer` composed.
#[derive(Clone, Debug)]
enum Linear {
    /// One for all copies, with the inverse.
    Same { linear: Mat3, inverse: Mat3 },
    /// One for each copy. Its inverse is computed on each use: storing it would nearly double the memory.
    Each(Vec<Mat3>),
}

/// The numbers of the copies in the tables of their group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Numbers {
    pub prototype: PrototypeId,
    pub first_leaf: u32,
    pub before: u32,
    pub first_placement: u32,
    pub placements_each: u32,
}

impl Instances {
    /// The copies under `maps` within `outer`.
    pub fn new(
        name: &Arc<str>,
        numbers: Numbers,
        outer: Affine,
        way: f64,
        maps: &[Affine],
    ) -> Result<Instances, CompileProblem> {
        let Numbers { prototype, first_leaf, before, first_placement, placements_each } = numbers;
        let is_same = maps.windows(2).all(|pair| same_bits(&pair[0].linear, &pair[1].linear));
        let linear = match (is_same, maps.first()) {
            (true, Some(map)) => {
                let linear = outer.linear * map.linear;
                Linear::Same { linear, inverse: Affine::from_linear(linear).inverse()?.linear }
            }
            _ => Linear::Each(maps.iter().map(|map| outer.linear * map.linear).collect()),
        };
        let instances = Instances {
            name: name.clone(),
            prototype,
            first_leaf,
            before,
            first_placement,
            placements_each,
            outer,
            way,
            translations: maps.iter().map(|map| map.translation).collect(),
            linear,
        };
        for k in 0..instances.len() {
            instances.try_place(k)?;
        }
        Ok(instances)
    }

    /// The number of copies.
    pub fn len(&self) -> usize {
        self.translations.len()
    }

    /// The number of the placement of a copy, relative to that of the group.
    #[inline]
    pub fn placement(&self, k: usize) -> u32 {
        self.first_placement + k as u32 * self.placements_each
    }

    /// The map of a copy into the frame of the group.
    pub fn world_from_local(&self, k: usize) -> Affine {
        let linear = match &self.linear {
            Linear::Same { linear, .. } => *linear,
            Linear::Each(each) => each[k],
        };
        Affine { linear, translation: self.outer.point(self.translations[k]) }
    }

    /// The map into the frame of a copy.
    #[inline]
    pub fn place(&self, k: usize) -> Place {
        // `new` has verified that the inverse exists
        self.try_place(k).unwrap_or(Place { local_from_world: Affine::IDENTITY, path: 0.0 })
    }

    fn try_place(&self, k: usize) -> Result<Place, CompileProblem> {
        let translation = self.outer.point(self.translations[k]);
        let path = self.way + self.outer.vector(self.translations[k]).length();
        let local_from_world = match &self.linear {
            Linear::Same { .. } if !translation.is_finite() => return Err(SingularError::NotFinite.into()),
            Linear::Same { inverse, .. } => {
                Affine { linear: *inverse, translation: -(*inverse * translation) }
            }
            Linear::Each(each) => Affine { linear: each[k], translation }.inverse()?,
        };
        Ok(Place { local_from_world, path })
    }

    /// Size in bytes.
    pub fn bytes(&self) -> usize {
        let linear = if let Linear::Each(each) = &self.linear { size_of_val(&each[..]) } else { 0 };
        size_of_val(&self.translations[..]) + linear
    }
}

/// Bitwise equality: distinguishes 0 from -0.
fn same_bits(a: &Mat3, b: &Mat3) -> bool {
    a.to_cols_array().map(f64::to_bits) == b.to_cols_array().map(f64::to_bits)
}
