//! Equal differences and intersections, whose facets are combined once: a dump repeats the text of a module for each of its
//! uses.

use super::shell::Shell;
use super::syntax::{Node, Tree};
use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt::{self, Write};
use std::hash::{DefaultHasher, Hasher};

/// A digest of the name, modifiers and arguments of a node, and the classes of its children.
type Key = ([u64; 2], Vec<u32>);

/// Classes of nodes with equal subtrees, and the facets of classes in their own frame.
#[derive(Debug)]
pub(super) struct Shared {
    /// The class of each node; `None` for nodes that no ancestor needs the facets of.
    class: Vec<Option<u32>>,
    /// The number of nodes of each class.
    count: Vec<u32>,
    shells: RefCell<HashMap<u32, Shell>>,
}

impl Shared {
    /// Divides the nodes that are `wanted` into classes.
    pub fn new(tree: &Tree, wanted: &[bool]) -> Shared {
        let mut classes: HashMap<Key, u32> = HashMap::new();
        let (mut class, mut count) = (vec![None; tree.nodes.len()], Vec::new());
        // children have greater indices than their parents
        for (number, node) in tree.nodes.iter().enumerate().rev().filter(|(number, _)| wanted[*number]) {
            let children = node.children.iter().filter_map(|child| class[*child as usize]).collect();
            let next = classes.len() as u32;
            let own = *classes.entry((digest(node), children)).or_insert(next);
            if own == next {
                count.push(0);
            }
            count[own as usize] += 1;
            class[number] = Some(own);
        }
        Shared { class, count, shells: RefCell::default() }
    }

    /// True if other nodes have an equal subtree.
    pub fn is_repeated(&self, number: usize) -> bool {
        self.class[number].is_some_and(|class| self.count[class as usize] > 1)
    }

    /// The facets of a node, if the map has those of an equal node.
    pub fn shell(&self, number: usize) -> Option<Shell> {
        self.shells.borrow().get(&self.class[number]?).cloned()
    }

    /// True if the map has the facets of a node or of an equal one.
    pub fn is_known(&self, number: usize) -> bool {
        self.class[number].is_some_and(|class| self.shells.borrow().contains_key(&class))
    }

    /// Stores the facets of a node for all equal ones.
    pub fn keep(&self, number: usize, shell: Shell) {
        if let Some(class) = self.class[number] {
            self.shells.borrow_mut().insert(class, shell);
        }
    }
}

/// The hash of a text that need not be kept: a list of points may have most of the bytes of a file.
struct Digest([DefaultHasher; 2]);

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.iter_mut().for_each(|hasher| hasher.write(text.as_bytes()));
        Ok(())
    }
}

fn digest(node: &Node) -> [u64; 2] {
    let mut digest = Digest([DefaultHasher::new(), DefaultHasher::new()]);
    // 128 bits in all, so that different texts do not meet
    digest.0[1].write_u8(1);
    // a hasher accepts every text
    let _ = write!(digest, "{} {:?}", node.name, node.modifiers);
    for argument in &node.arguments {
        let _ = write!(digest, " {:?} {:?}", argument.name, argument.value);
    }
    digest.0.map(|hasher| hasher.finish())
}

#[cfg(test)]
mod tests {
    use super::super::syntax::parse;
    use super::*;
    use rayweave_scene::Source;
    use std::sync::Arc;

    #[test]
    fn equal_subtrees_are_one_class() {
        let cut = "difference() { cube(1); sphere(r = 2); }";
        let other = "difference() { cube(1); sphere(r = 3); }";
        let off = "difference() { cube(1); *sphere(r = 2); }";
        let text = format!("group() {{ {cut} {other} multmatrix([[1]]) {cut} {off} }}");
        let source = Arc::new(Source::new(None, text));
        let tree = parse(&source).unwrap();
        let shared = Shared::new(&tree, &vec![true; tree.nodes.len()]);
        let cuts: Vec<usize> =
            (0..tree.nodes.len()).filter(|k| tree.nodes[*k].name == "difference").collect();
        let repeated: Vec<bool> = cuts.iter().map(|k| shared.is_repeated(*k)).collect();
        assert_eq!(repeated, [true, false, true, false]);
        shared.keep(cuts[0], Shell::default());
        assert!(shared.is_known(cuts[2]) && !shared.is_known(cuts[1]) && !shared.is_known(cuts[3]));
    }
}
