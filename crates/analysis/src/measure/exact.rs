//! Exact volumes in closed form.

use rayweave_model::{Node, Solid};

/// The exact volume of a solid that is a single primitive under transforms and names, if the primitive has a
/// closed form (see its manual page); `inf` if it is unbounded. The volume of a mesh is the sum over its triangles. `None`
/// for all other solids, which have to be measured.
pub fn exact_volume(solid: &Solid) -> Option<f64> {
    let (mut solid, mut factor) = (solid, 1.0);
    loop {
        if let Some((map, inner)) = solid.node().single_map() {
            factor *= map.linear.determinant().abs();
            solid = inner;
            continue;
        }
        match solid.node() {
            Node::Empty => return Some(0.0),
            Node::Universe => return Some(f64::INFINITY),
            Node::Primitive(primitive) => return Some(factor * primitive.volume()?),
            Node::Named(_, inner) => solid = inner,
            _ => return None,
        }
    }
}
