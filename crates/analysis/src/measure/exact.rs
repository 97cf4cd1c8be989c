//! Volumes by formula.

use rayweave_model::{Node, Solid};

/// The volume of a solid that is one primitive under maps and names, where the primitive's has a closed form (its manual page
/// says which); `inf` where it is unbounded. For all others `None`: they are to be measured.
pub fn exact_volume(solid: &Solid) -> Option<f64> {
    let (mut solid, mut factor) = (solid, 1.0);
    loop {
        match solid.node() {
            Node::Empty => return Some(0.0),
            Node::Universe => return Some(f64::INFINITY),
            Node::Primitive(primitive) => return Some(factor * primitive.volume()?),
            Node::Transformed(map, inner) => {
                factor *= map.linear.determinant().abs();
                solid = inner;
            }
            Node::Named(_, inner) => solid = inner,
            _ => return None,
        }
    }
}
