//! Prefixes of leaf names, for the component that the leaves belong to.

use rayweave_model::{Node, Solid};

/// A task of the tree traversal.
enum Task<'a> {
    Visit(&'a Solid),
    /// Build a node; all its operands are built.
    Build(&'a Solid),
}

/// The solid with `prefix` and a dot before every name in it: the face `front.side` becomes
/// `objective.front.side`. Leaves without a name get the prefix as the name of the compound that
/// contains them. Shared parts of the tree are copied.
pub fn with_prefix(solid: &Solid, prefix: &str) -> Solid {
    let (mut tasks, mut made) = (vec![Task::Visit(solid)], Vec::new());
    while let Some(task) = tasks.pop() {
        match task {
            Task::Visit(solid) => {
                tasks.push(Task::Build(solid));
                let first = tasks.len();
                tasks.extend(solid.node().operand_refs().map(Task::Visit));
                // the stack reverses the order
                tasks[first..].reverse();
            }
            Task::Build(solid) => {
                let operands = made.len() - solid.node().operand_refs().count();
                let operands = made.split_off(operands);
                made.push(rebuilt(solid, operands, prefix));
            }
        }
    }
    made.pop().unwrap_or_else(|| solid.clone()).named(prefix)
}

/// A node over other operands.
fn rebuilt(solid: &Solid, operands: Vec<Solid>, prefix: &str) -> Solid {
    let mut operands = operands.into_iter();
    match (solid.node(), operands.next()) {
        (Node::Union(_), first) => Solid::union(first.into_iter().chain(operands)),
        (Node::Intersection(_), first) => Solid::intersection(first.into_iter().chain(operands)),
        (Node::SymmetricDifference(_), first) => {
            Solid::symmetric_difference(first.into_iter().chain(operands))
        }
        (Node::Difference(..), Some(first)) => first - operands.next().unwrap_or_else(Solid::empty),
        (Node::Complement(_), Some(inner)) => !inner,
        (Node::Transformed(map, _), Some(inner)) => inner.apply(map.get()),
        (Node::Named(name, _), Some(inner)) => inner.named(&format!("{prefix}.{name}")),
        (Node::Placed(_, maps), Some(inner)) => inner.place_copies(maps.clone()),
        _ => solid.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_model::Program;
    use rayweave_shape::primitive::{Primitive, Sphere};

    fn ball() -> Solid {
        Primitive::from(Sphere::new(1.0).unwrap()).into()
    }

    #[test]
    fn every_operator_is_kept() {
        let moved = ball().translate([0.5, 0.0, 0.0]).named("moved");
        let (a, b) = (ball().named("a"), ball().scale([2.0, 2.0, 2.0]));
        for solid in [&a | &moved, &a & &moved, &b - &moved, &a ^ &moved, !&moved, Solid::empty()] {
            let renamed = with_prefix(&solid, "part");
            let text = |solid: &Solid| solid.to_string();
            assert_eq!(with_prefix(&solid, "part"), renamed);
            let program = |solid: &Solid| Program::compile(solid).unwrap();
            let names = |solid: &Solid| program(solid).face_names().collect::<Vec<_>>();
            assert_eq!(names(&renamed).len(), names(&solid).len());
            assert!(names(&renamed).iter().all(|name| name.starts_with("part.")), "{}", text(&renamed));
        }
        let maps: Vec<_> = [1.0, 5.0].map(|x| rayweave_math::Affine::translate([x, 0.0, 0.0].into())).into();
        let names: Vec<_> =
            Program::compile(&with_prefix(&a.place(maps), "row")).unwrap().face_names().collect();
        assert!(names.contains(&"row.a.side".to_owned()), "{names:?}");
    }

    #[test]
    fn deep_trees() {
        let deep = (0..100_000).fold(ball().named("x"), |solid, _| !solid);
        assert_eq!(with_prefix(&deep, "y"), (0..100_000).fold(ball().named("y.x"), |s, _| !s).named("y"));
    }
}
