//! The tree of a solid as text.

use rayweave::Solid;
use rayweave::model::{Node, expanded_size};

/// The maximum length of the description of a node, in characters; longer ones are shortened in the
/// middle.
const LONGEST: usize = 100;

/// The maximum number of transforms on one line.
const MAX_TRANSFORMS: usize = 8;

/// A line to be printed: a solid and its depth.
struct Branch {
    solid: Solid,
    /// Text before the branch of the line.
    stem: String,
    depth: usize,
    is_last: bool,
}

/// Prints the trees of solids, limited to `depth` levels and `lines` lines. A named solid is
/// printed in full only at its first occurrence. Does not recurse.
pub fn draw(roots: &[Solid], depth: usize, lines: usize) -> String {
    let mut waiting: Vec<Branch> = roots.iter().rev().map(root).collect();
    let mut shown: Vec<Solid> = Vec::new();
    let mut text = String::new();
    let mut drawn = 0;
    while let Some(branch) = waiting.pop() {
        if drawn == lines {
            text += "... (--lines N shows more)\n";
            break;
        }
        drawn += 1;
        let head = Head::of(&branch.solid);
        let is_known = head.is_named && shown.iter().any(|solid| solid.is_same(&branch.solid));
        let operands = operands(&head.inner);
        let (own, below) = branch.twigs();
        text += &format!("{}{own}{}", branch.stem, head.text);
        match () {
            () if operands.is_empty() => {}
            () if is_known => text += " (as above)",
            () if branch.depth == depth => text += " (--depth N shows more)",
            () => grow(&mut waiting, operands, &branch, below),
        }
        text += "\n";
        if head.is_named && !is_known {
            shown.push(branch.solid);
        }
    }
    text
}

fn root(solid: &Solid) -> Branch {
    Branch { solid: solid.clone(), stem: String::new(), depth: 0, is_last: true }
}

/// Pushes the operands of a node, the last one first.
fn grow(waiting: &mut Vec<Branch>, operands: Vec<Solid>, parent: &Branch, below: &str) {
    let count = operands.len();
    for (k, solid) in operands.into_iter().enumerate().rev() {
        waiting.push(Branch {
            solid,
            stem: format!("{}{below}", parent.stem),
            depth: parent.depth + 1,
            is_last: k + 1 == count,
        });
    }
}

impl Branch {
    /// Text before the branch itself, and before its operands.
    fn twigs(&self) -> (&'static str, &'static str) {
        match (self.depth, self.is_last) {
            (0, _) => ("", ""),
            (_, true) => ("\u{2514}\u{2500} ", "   "),
            (_, false) => ("\u{251c}\u{2500} ", "\u{2502}  "),
        }
    }
}

/// A node with its name and the transforms around it.
struct Head {
    text: String,
    is_named: bool,
    inner: Solid,
}

impl Head {
    /// Collects the name, if the solid has one, and the transforms down to the next name.
    fn of(solid: &Solid) -> Head {
        let (mut inner, name) = match solid.node() {
            Node::Named(name, inner) => (inner.clone(), format!("{name} = ")),
            _ => (solid.clone(), String::new()),
        };
        let mut maps = Vec::new();
        while let (Some((map, next)), true) = (inner.node().single_map(), maps.len() < MAX_TRANSFORMS) {
            let image = Solid::empty().apply(map).to_string();
            maps.push(image.trim_start_matches("empty").to_owned());
            inner = next.clone();
        }
        maps.reverse();
        let own = match (is_word(inner.node()), maps.is_empty()) {
            (false, false) => format!("({})", what(&inner)),
            _ => what(&inner),
        };
        let text = shortened(format!("{name}{own}{}", maps.concat()));
        Head { text, is_named: !name.is_empty(), inner }
    }
}

/// True if a transform can be appended to the description without parentheses.
fn is_word(node: &Node) -> bool {
    matches!(
        node,
        Node::Empty | Node::Universe | Node::Primitive(_) | Node::Named(..) | Node::Transformed(..)
    )
}

/// The largest number of shapes of a solid that are counted.
const MAX_SHAPES: u64 = 1 << 20;

/// True if the operators below a solid are not those of the model: a reader or an outline has put its shapes together.
fn is_one_shape(solid: &Solid) -> bool {
    solid.boundary().is_some() && solid.node().operand_refs().next().is_some()
}

/// A short description of the node itself.
fn what(solid: &Solid) -> String {
    if is_one_shape(solid) {
        let count = expanded_size(solid, MAX_SHAPES);
        let at_least = if count >= MAX_SHAPES { "at least " } else { "" };
        return format!("composed of {at_least}{count} shapes");
    }
    match solid.node() {
        Node::Empty | Node::Universe | Node::Primitive(_) => solid.to_string(),
        Node::Complement(_) => "complement".to_owned(),
        Node::Union(all) => format!("union of {}", all.len()),
        Node::Intersection(all) => format!("intersection of {}", all.len()),
        Node::Difference(..) => "difference".to_owned(),
        Node::SymmetricDifference(all) => format!("symmetric difference of {}", all.len()),
        Node::Placed(_, maps) => format!("placed {} times", maps.len()),
        Node::Named(name, _) => name.to_string(),
        Node::Transformed(..) => "...".to_owned(),
    }
}

/// The operands that are printed below a node.
fn operands(solid: &Solid) -> Vec<Solid> {
    match solid.node() {
        Node::Named(..) => vec![solid.clone()],
        _ if is_one_shape(solid) => Vec::new(),
        node => node.operand_refs().cloned().collect(),
    }
}

/// Limits the length of a description: a convex polyhedron may have thousands of planes.
fn shortened(text: String) -> String {
    let count = text.chars().count();
    if count <= LONGEST {
        return text;
    }
    let head: String = text.chars().take(LONGEST / 2).collect();
    let tail: String = text.chars().skip(count - LONGEST / 3).collect();
    format!("{head} ... {tail}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave::shapes::{cylinder, sphere};

    #[test]
    fn a_tree_is_drawn() {
        let ball = sphere(2.0).unwrap().named("ball");
        let hole = cylinder(1.0, f64::INFINITY).unwrap();
        let solid = ((&ball - &hole) | !&ball.translate([1.0, 0.0, 0.0])).named("thing");
        let drawn = "\
thing = union of 2
\u{251c}\u{2500} difference
\u{2502}  \u{251c}\u{2500} ball = sphere(radius=2)
\u{2502}  \u{2514}\u{2500} cylinder(radius=1, height=inf)
\u{2514}\u{2500} complement
   \u{2514}\u{2500} ball.translate(1, 0, 0)
      \u{2514}\u{2500} ball = sphere(radius=2)
";
        assert_eq!(draw(&[solid], 12, 200), drawn);
    }

    #[test]
    fn named_solids_are_shown_once() {
        let pair = (sphere(2.0).unwrap() & sphere(1.0).unwrap()).named("pair");
        let drawn = draw(&[&pair | &pair], 12, 200);
        assert_eq!(drawn.matches("sphere").count(), 2);
        assert_eq!(drawn.matches("(as above)").count(), 1);
    }

    /// An outline that is revolved consists of cones and planes, which are not in the model file.
    #[test]
    fn outlines_are_one_line() {
        let model = "rayweave = 1\n[solid.pawn.revolve]\noutline = [[0, 0], [20, 0], { at = [20, 5], fillet = 2 }, [8, 10], [0, 40]]";
        let (_, scene) = rayweave::scene::parse(model).unwrap();
        let drawn = draw(&[scene.regions[0].solid.clone()], 12, 200);
        assert!(drawn.starts_with("pawn = composed of ") && drawn.lines().count() == 1, "{drawn}");
    }

    #[test]
    fn deep_and_wide_trees_are_cut() {
        let ball = sphere(1.0).unwrap();
        let deep = (0..100_000).fold(ball.clone(), |solid, _| !solid);
        assert_eq!(draw(&[deep], 3, 200).lines().count(), 4);
        let nested = (0..100_000).fold(ball.clone(), |solid, _| solid.rotate_x(1.0));
        assert!(draw(&[nested], 3, 200).len() < 4000);
        let wide = Solid::union(vec![ball; 1000]);
        let drawn = draw(&[wide], 3, 200);
        assert_eq!(drawn.lines().count(), 201);
        assert!(drawn.ends_with("... (--lines N shows more)\n"));
        // a tree of 2^40 occurrences of one leaf
        let doubled = (0..40).fold(sphere(1.0).unwrap(), |solid, _| &solid | &solid);
        assert_eq!(draw(&[doubled], 60, 50).lines().count(), 51);
    }
}
