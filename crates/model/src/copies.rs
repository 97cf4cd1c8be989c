//! The copies of a placed solid: their maps, and the name and numbers that a file gives them.

use rayweave_math::Affine;
use std::ops::Deref;
use std::sync::Arc;

/// The copies of a placed solid: one map each, and optionally a name and copy numbers for
/// [occurrence paths](crate::OccurrencePath). Dereferences to the maps.
///
/// Name and numbers affect no answer. Cheap to clone.
#[derive(Clone, Debug, PartialEq)]
pub struct Copies {
    maps: Arc<[Affine]>,
    label: Option<Box<CopyLabel>>,
}

/// The name and the numbers that copies have in a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CopyLabel {
    pub name: Arc<str>,
    pub numbers: Option<Arc<[i64]>>,
    /// For each copy the number of copies before it with the same number, if some of them are elsewhere.
    pub ordinals: Option<Arc<[u32]>>,
}

impl Copies {
    /// Copies that have the name of the placed solid and are counted from 0.
    pub fn new(maps: impl Into<Arc<[Affine]>>) -> Copies {
        Copies { maps: maps.into(), label: None }
    }

    /// Copies with a name of their own, and with copy numbers, one for each map. Without numbers they are
    /// counted from 0, and a single copy has no number. Numbers may repeat; copies without an entry in
    /// `numbers` are counted.
    pub fn labelled(maps: impl Into<Arc<[Affine]>>, name: &str, numbers: Option<Arc<[i64]>>) -> Copies {
        let numbers = numbers.filter(|numbers| !numbers.is_empty());
        let label = CopyLabel { name: name.into(), numbers, ordinals: None };
        Copies { maps: maps.into(), label: Some(Box::new(label)) }
    }

    /// Labelled copies that are some of several: `ordinals` are the numbers of copies with the same number before each of them, which
    /// are otherwise counted among the copies here. Without a label nothing changes.
    #[must_use]
    pub fn with_ordinals(mut self, ordinals: Arc<[u32]>) -> Copies {
        if let Some(label) = &mut self.label {
            label.ordinals = Some(ordinals);
        }
        self
    }

    /// The maps, `world_from_local`.
    pub fn maps(&self) -> &Arc<[Affine]> {
        &self.maps
    }

    /// The name of the copies, if it is not that of the placed solid.
    pub fn name(&self) -> Option<&str> {
        self.label.as_ref().map(|label| &*label.name)
    }

    /// The copy numbers, if they are not counted from 0.
    pub fn numbers(&self) -> Option<&Arc<[i64]>> {
        self.label.as_ref()?.numbers.as_ref()
    }

    pub(crate) fn label(&self) -> Option<&CopyLabel> {
        self.label.as_deref()
    }
}

impl CopyLabel {
    /// The number of a copy; `None` for the only copy of a solid without numbers.
    pub fn number(&self, k: usize, count: usize) -> Option<i64> {
        match self.numbers.as_ref().and_then(|numbers| numbers.get(k)) {
            Some(&number) => Some(number),
            None => (count > 1).then_some(k as i64),
        }
    }

    /// The stated number of copies with the same number before a copy.
    pub fn ordinal(&self, k: usize) -> Option<u32> {
        self.ordinals.as_ref().and_then(|ordinals| ordinals.get(k).copied())
    }
}

impl Deref for Copies {
    type Target = [Affine];

    fn deref(&self) -> &[Affine] {
        &self.maps
    }
}
