//! Names of leaves and their faces, stored once for all leaves with equal names.

use crate::name_map::{NameMap, NameState};
use crate::number_map::NumberMap;
use std::borrow::Cow;
use std::hash::BuildHasher;
use std::sync::Arc;

/// The names of a shape and of its faces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Label {
    /// The name given to the leaf, or the name of its kind.
    pub name: Arc<str>,
    /// The kind of shape, e.g. `sphere`.
    pub kind: &'static str,
    /// The faces, as the manual page of the kind names them.
    pub faces: Arc<[Cow<'static, str>]>,
}

impl Label {
    /// The name of a face by its number, e.g. `rim.side`.
    pub fn face_name(&self, facet: usize) -> String {
        format!("{}.{}", self.name, self.faces.get(facet).map_or("", |face| face))
    }
}

/// A table of distinct labels.
#[derive(Clone, Debug, Default)]
pub(crate) struct Labels {
    labels: Vec<Label>,
    hasher: NameState,
    /// For each hash the last label with it.
    newest: NumberMap<u64, u32>,
    /// For each label the one before it with the same hash; itself if there is none.
    older: Vec<u32>,
    /// The distinct lists of face names.
    faces: NameMap<Arc<[Cow<'static, str>]>, ()>,
}

impl Labels {
    /// The number of a label. Consecutive leaves often have equal names: those cost no look-up.
    pub fn number(
        &mut self,
        name: &Arc<str>,
        kind: &'static str,
        faces: impl Iterator<Item = Cow<'static, str>> + Clone,
    ) -> u32 {
        let is_last = self.labels.last().is_some_and(|last| {
            Arc::ptr_eq(&last.name, name) && last.kind == kind && faces.clone().eq(last.faces.iter().cloned())
        });
        if is_last {
            return self.labels.len() as u32 - 1;
        }
        let last = self.labels.last().filter(|last| faces.clone().eq(last.faces.iter().cloned()));
        let faces = last.map_or_else(|| faces.clone().collect(), |last| last.faces.clone());
        self.insert(Label { name: name.clone(), kind, faces })
    }

    /// The number of a label, which is added if it is new.
    pub fn insert(&mut self, mut label: Label) -> u32 {
        label.faces = self.faces(label.faces);
        let fresh = self.labels.len() as u32;
        // equal lists of faces are the same list
        let hash = self.hasher.hash_one((&label.name, label.kind, Arc::as_ptr(&label.faces).addr()));
        let newest = self.newest.entry(hash).or_insert(fresh);
        let (mut number, mut next) = (fresh, *newest);
        while number != next {
            number = next;
            if self.labels[number as usize] == label {
                return number;
            }
            next = self.older[number as usize];
        }
        self.older.push(std::mem::replace(newest, fresh));
        self.labels.push(label);
        fresh
    }

    fn faces(&mut self, faces: Arc<[Cow<'static, str>]>) -> Arc<[Cow<'static, str>]> {
        if let Some(last) = self.labels.last().filter(|last| last.faces == faces) {
            return last.faces.clone();
        }
        if let Some((known, ())) = self.faces.get_key_value(&faces) {
            return known.clone();
        }
        self.faces.insert(faces.clone(), ());
        faces
    }

    /// A label by its number.
    pub fn get(&self, number: u32) -> &Label {
        &self.labels[number as usize]
    }

    /// The labels in the order of their numbers.
    pub fn into_labels(self) -> Vec<Label> {
        self.labels
    }
}
