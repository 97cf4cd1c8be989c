//! Solids as text: `front & back - ~rim`.
//!
//! The operators and their precedence are those of model files and of Python (`~`, then `-`, `&`, `^`, `|`).
//! A named solid is printed as its name, the outermost one as `name = ...`. Printing takes linear time and no
//! recursion, at any depth.

use crate::{Node, Solid};
use rayweave_math::Affine;
use rayweave_shape::primitive::{Primitive, Value};
use std::borrow::Cow;
use std::fmt;

/// Precedence of a piece of text: it needs parentheses inside anything that binds more tightly.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Union,
    SymmetricDifference,
    Intersection,
    Difference,
    Complement,
    /// A name, a call, or a text in parentheses.
    Atom,
}

enum Task<'a> {
    Text(Cow<'static, str>),
    Solid(&'a Solid, Binding),
}

impl fmt::Display for Solid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut tasks = Vec::new();
        match self.node() {
            Node::Named(name, inner) => {
                write!(f, "{name} = ")?;
                tasks.push(Task::Solid(inner, Binding::Union));
            }
            _ => tasks.push(Task::Solid(self, Binding::Union)),
        }
        while let Some(task) = tasks.pop() {
            match task {
                Task::Text(text) => f.write_str(&text)?,
                Task::Solid(solid, inside) => expand(f, solid, inside, &mut tasks)?,
            }
        }
        Ok(())
    }
}

impl fmt::Debug for Solid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Solid({self})")
    }
}

/// Writes a node without operands, or pushes its parts on the stack, last one first.
fn expand<'a>(
    f: &mut fmt::Formatter<'_>,
    solid: &'a Solid,
    inside: Binding,
    tasks: &mut Vec<Task<'a>>,
) -> fmt::Result {
    match solid.node() {
        Node::Empty => f.write_str("empty"),
        Node::Universe => f.write_str("universe"),
        Node::Primitive(primitive) => f.write_str(&primitive_text(primitive)),
        Node::Named(name, _) => f.write_str(name),
        Node::Complement(inner) => {
            tasks.push(Task::Solid(inner, Binding::Complement));
            f.write_str("~")
        }
        Node::Transformed(map, inner) => {
            tasks.push(Task::Text(transform_text(&map.get()).into()));
            tasks.push(Task::Solid(inner, Binding::Atom));
            Ok(())
        }
        Node::Placed(inner, maps) => {
            tasks.push(Task::Text(format!(", {} times)", maps.len()).into()));
            tasks.push(Task::Solid(inner, Binding::Union));
            f.write_str("place(")
        }
        Node::Union(all) => infix(f, "union", " | ", Binding::Union, all.iter(), inside, tasks),
        Node::Intersection(all) => {
            infix(f, "intersection", " & ", Binding::Intersection, all.iter(), inside, tasks)
        }
        Node::SymmetricDifference(all) => {
            let binding = Binding::SymmetricDifference;
            infix(f, "symmetric_difference", " ^ ", binding, all.iter(), inside, tasks)
        }
        Node::Difference(a, b) => infix(f, "", " - ", Binding::Difference, [a, b].into_iter(), inside, tasks),
    }
}

/// Operands with an operator between them, or a call if there are fewer than two.
fn infix<'a>(
    f: &mut fmt::Formatter<'_>,
    call: &str,
    operator: &'static str,
    binding: Binding,
    operands: impl ExactSizeIterator<Item = &'a Solid> + DoubleEndedIterator,
    inside: Binding,
    tasks: &mut Vec<Task<'a>>,
) -> fmt::Result {
    let count = operands.len();
    let parenthesised = count < 2 || binding < inside;
    if parenthesised {
        f.write_str(if count < 2 { call } else { "" })?;
        f.write_str("(")?;
        tasks.push(Task::Text(")".into()));
    }
    for (k, operand) in operands.enumerate().rev() {
        // a - (b - c) differs from a - b - c; the other operators are associative
        let tighter = binding == Binding::Difference && k > 0;
        let least = match () {
            () if count < 2 => Binding::Union,
            () if tighter => Binding::Complement,
            () => binding,
        };
        tasks.push(Task::Solid(operand, least));
        if k > 0 {
            tasks.push(Task::Text(operator.into()));
        }
    }
    Ok(())
}

/// Longer lists of rows (meshes) are abbreviated to their first row.
const MAX_ROWS: usize = 256;

/// A shape as a call with named arguments, in Python's syntax.
fn primitive_text(primitive: &Primitive) -> String {
    let value = |value: &Value| match value {
        Value::Number(number) => format!("{number}"),
        Value::Vector(list) => format!("{list:?}"),
        Value::Rows(rows) if rows.len() <= MAX_ROWS => format!("{rows:?}"),
        Value::Rows(rows) => format!("[{:?}, ...]", rows[0]),
    };
    let arguments: Vec<_> =
        primitive.arguments().iter().map(|(name, v)| format!("{name}={}", value(v))).collect();
    format!("{}({})", primitive.name(), arguments.join(", "))
}

fn transform_text(map: &Affine) -> String {
    let t = map.translation;
    if *map == Affine::translate(t) {
        return format!(".translate({}, {}, {})", t.x, t.y, t.z);
    }
    let diagonal = map.linear.to_cols_array_2d();
    let factors = rayweave_math::Vec3::new(diagonal[0][0], diagonal[1][1], diagonal[2][2]);
    if *map == Affine::scale(factors) {
        return format!(".scale({}, {}, {})", factors.x, factors.y, factors.z);
    }
    let rows = map.to_rows();
    let row = |r: &[f64; 4]| format!("[{}, {}, {}, {}]", r[0], r[1], r[2], r[3]);
    format!(".transform([{}, {}, {}])", row(&rows[0]), row(&rows[1]), row(&rows[2]))
}
