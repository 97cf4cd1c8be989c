//! Shrinking of failing models: all models with one element removed.

use super::{Part, Tree};

/// The models with one part removed, or one part smaller.
pub fn smaller_models(parts: &[Part]) -> Vec<Vec<Part>> {
    let mut all = Vec::new();
    for k in 0..parts.len() {
        let mut fewer = parts.to_vec();
        fewer.remove(k);
        all.extend((!fewer.is_empty()).then_some(fewer));
        for tree in smaller(&parts[k].tree) {
            let mut other = parts.to_vec();
            other[k].tree = tree;
            all.push(other);
        }
    }
    all
}

/// The trees with one element removed.
fn smaller(tree: &Tree) -> Vec<Tree> {
    let mut all: Vec<Tree> = tree.operands().into_iter().cloned().collect();
    let within = |make: &dyn Fn(Tree) -> Tree, a: &Tree| smaller(a).into_iter().map(make).collect::<Vec<_>>();
    let lists = |trees: &[Tree], make: &dyn Fn(Vec<Tree>) -> Tree| {
        let mut all = Vec::new();
        for k in 0..trees.len() {
            let mut fewer = trees.to_vec();
            fewer.remove(k);
            all.push(make(fewer));
            for other in smaller(&trees[k]) {
                let mut changed = trees.to_vec();
                changed[k] = other;
                all.push(make(changed));
            }
        }
        all
    };
    match tree {
        Tree::Empty | Tree::Universe | Tree::Leaf(_) => {}
        Tree::Not(a) => all.extend(within(&|a| a.complement(), a)),
        Tree::Moved(map, a) => all.extend(within(&|a| a.moved(*map), a)),
        Tree::Placed(maps, a) => {
            all.extend(maps.iter().map(|map| (**a).clone().moved(*map)));
            all.extend(within(&|a| Tree::Placed(maps.clone(), Box::new(a)), a));
        }
        Tree::Any(trees) => all.extend(lists(trees, &Tree::Any)),
        Tree::All(trees) => all.extend(lists(trees, &Tree::All)),
        Tree::Odd(trees) => all.extend(lists(trees, &Tree::Odd)),
        Tree::Minus(a, b) => {
            all.extend(within(&|a| a.minus((**b).clone()), a));
            all.extend(within(&|b| (**a).clone().minus(b), b));
        }
    }
    all
}
