//! Solids as Python expressions: `box(size=[2.0, 2.0, 2.0]) - cylinder(radius=0.5)`.
//!
//! With `from rayweave import *`, the value of the text is an equal solid, bit for bit, unless the text is shortened or copies have
//! names of their own. The text is built with a stack and not by recursion, at any depth.

use std::fmt::Write;

use rayweave::math::{Affine, Vec3};
use rayweave::model::{Copies, Node, Solid};
use rayweave::shape::primitive::{Primitive, Value, manual};

/// The length, in bytes, up to which the text is complete.
const MOST: usize = 2000;

/// The length of a shortened text.
const SHORT: usize = 100;

/// The strength of an operator: a text needs parentheses within one that binds more tightly.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Union,
    SymmetricDifference,
    Intersection,
    Difference,
    Complement,
    /// A call or a text in parentheses.
    Atom,
}

enum Task<'a> {
    Text(String),
    Solid(&'a Solid, Binding),
}

/// The text of a solid; a description in angle brackets if the text is long.
pub fn python_text(solid: &Solid) -> String {
    let mut text = String::new();
    let mut tasks = vec![Task::Solid(solid, Binding::Union)];
    while let Some(task) = tasks.pop() {
        match task {
            Task::Text(piece) => text.push_str(&piece),
            Task::Solid(solid, inside) => expand(&mut text, solid, inside, &mut tasks),
        }
        if text.len() > MOST || tasks.len() > MOST && text.len() > SHORT {
            let start: String = text.chars().take(SHORT).collect();
            return format!("<Solid: {start}...>");
        }
    }
    text
}

/// Writes a node without operands, or puts its parts on the stack, the last one first.
fn expand<'a>(text: &mut String, solid: &'a Solid, inside: Binding, tasks: &mut Vec<Task<'a>>) {
    match solid.node() {
        Node::Empty => text.push_str("empty()"),
        Node::Universe => text.push_str("universe()"),
        Node::Primitive(primitive) => text.push_str(&primitive_text(primitive)),
        Node::Named(name, inner) => {
            tasks.push(Task::Text(format!(".named({})", quoted(name))));
            tasks.push(Task::Solid(inner, Binding::Atom));
        }
        Node::Complement(inner) => {
            let closed = Binding::Complement < inside;
            text.push_str(if closed { "(~" } else { "~" });
            tasks.extend(closed.then(|| Task::Text(")".to_owned())));
            tasks.push(Task::Solid(inner, Binding::Complement));
        }
        Node::Transformed(map, inner) => {
            tasks.push(Task::Text(transform_text(&map.get())));
            tasks.push(Task::Solid(inner, Binding::Atom));
        }
        Node::Placed(inner, copies) => {
            text.push_str("place(");
            tasks.push(Task::Text(copies_text(copies)));
            tasks.push(Task::Solid(inner, Binding::Union));
        }
        Node::Union(all) => join(text, ["union", " | "], Binding::Union, all, inside, tasks),
        Node::Intersection(all) => {
            join(text, ["intersection", " & "], Binding::Intersection, all, inside, tasks);
        }
        Node::SymmetricDifference(all) => {
            chain(text, " ^ ", Binding::SymmetricDifference, all.iter(), inside, tasks);
        }
        Node::Difference(a, b) => chain(text, " - ", Binding::Difference, [a, b].into_iter(), inside, tasks),
    }
}

/// Two operands with an operator between them, or a call of any other number of them: `a | b | c` is a union of two.
fn join<'a>(
    text: &mut String,
    [call, operator]: [&str; 2],
    binding: Binding,
    operands: &'a [Solid],
    inside: Binding,
    tasks: &mut Vec<Task<'a>>,
) {
    if operands.len() == 2 {
        return chain(text, operator, binding, operands.iter(), inside, tasks);
    }
    let _ = write!(text, "{call}([");
    tasks.push(Task::Text("])".to_owned()));
    for (k, operand) in operands.iter().enumerate().rev() {
        tasks.push(Task::Solid(operand, Binding::Union));
        tasks.extend((k > 0).then(|| Task::Text(", ".to_owned())));
    }
}

/// Operands with an operator between them, which Python groups from the left.
fn chain<'a>(
    text: &mut String,
    operator: &str,
    binding: Binding,
    operands: impl DoubleEndedIterator<Item = &'a Solid> + ExactSizeIterator,
    inside: Binding,
    tasks: &mut Vec<Task<'a>>,
) {
    if binding < inside {
        text.push('(');
        tasks.push(Task::Text(")".to_owned()));
    }
    for (k, operand) in operands.enumerate().rev() {
        // the right operand of the same operator needs parentheses
        let least = match (k, binding) {
            (0, _) => binding,
            (_, Binding::Union) => Binding::SymmetricDifference,
            (_, Binding::SymmetricDifference) => Binding::Intersection,
            (_, Binding::Intersection) => Binding::Difference,
            _ => Binding::Complement,
        };
        tasks.push(Task::Solid(operand, least));
        tasks.extend((k > 0).then(|| Task::Text(operator.to_owned())));
    }
}

/// A shape as a call, without the arguments that have their default values.
fn primitive_text(primitive: &Primitive) -> String {
    let parameters = manual(primitive.name()).map_or(&[][..], |manual| manual.parameters);
    let default = |name: &str| parameters.iter().find(|p| p.name == name).and_then(|p| p.default_value());
    let arguments: Vec<String> = (primitive.arguments().iter())
        .filter(|(name, value)| default(name).as_ref() != Some(value))
        .map(|(name, value)| format!("{name}={}", value_text(value)))
        .collect();
    format!("{}({})", primitive.name(), arguments.join(", "))
}

fn value_text(value: &Value) -> String {
    match value {
        Value::Number(number) => number_text(*number),
        Value::Vector(list) => list_text(list),
        Value::Rows(rows) => {
            let rows: Vec<String> = rows.iter().map(|row| list_text(row)).collect();
            format!("[{}]", rows.join(", "))
        }
    }
}

fn list_text(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|&number| number_text(number)).collect();
    format!("[{}]", numbers.join(", "))
}

/// The shortest decimal that gives the same number; infinity is no name of the package.
fn number_text(number: f64) -> String {
    match number {
        f64::INFINITY => "float('inf')".to_owned(),
        f64::NEG_INFINITY => "-float('inf')".to_owned(),
        // whole numbers as such, but keep the sign of -0.0
        _ if number == number.trunc()
            && number.abs() < 1e15
            && (number != 0.0 || number.is_sign_positive()) =>
        {
            format!("{number}")
        }
        _ => format!("{number:?}"),
    }
}

/// A map as the method call that gives it: a translation, scale or rotation about a coordinate axis, or else its matrix.
fn transform_text(map: &Affine) -> String {
    if *map == Affine::translate(map.translation) {
        return format!(".translate({})", list_text(&map.translation.to_array()));
    }
    let factors = Vec3::new(map.linear.x_axis.x, map.linear.y_axis.y, map.linear.z_axis.z);
    if *map == Affine::scale(factors) {
        return match factors == Vec3::splat(factors.x) {
            true => format!(".scale({})", number_text(factors.x)),
            false => format!(".scale({})", list_text(&factors.to_array())),
        };
    }
    let [x, y, z] = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis];
    for (letter, axis, sine, cosine) in
        [('x', Vec3::X, y.z, y.y), ('y', Vec3::Y, z.x, z.z), ('z', Vec3::Z, x.y, x.x)]
    {
        let degrees = sine.atan2(cosine).to_degrees();
        // angles are mostly given with few digits
        let rounded = (degrees * 1e6).round() / 1e6;
        if let Some(angle) =
            [rounded, degrees].into_iter().find(|&angle| Affine::rotation(axis, angle) == *map)
        {
            return format!(".rotate_{letter}({})", number_text(angle));
        }
    }
    format!(".transform({})", matrix_text(map))
}

fn matrix_text(map: &Affine) -> String {
    let rows: Vec<String> = map.to_rows().iter().map(|row| list_text(row)).collect();
    format!("[{}]", rows.join(", "))
}

/// The second argument of `place`, and the end of the call.
fn copies_text(copies: &Copies) -> String {
    let maps = copies.maps();
    // no longer than a text that is complete
    let shown = maps.iter().take(MOST);
    let is_moved = |map: &&Affine| **map == Affine::translate(map.translation);
    let texts: Vec<String> = match shown.clone().all(|map| is_moved(&map)) {
        true => shown.map(|map| list_text(&map.translation.to_array())).collect(),
        false => shown.map(matrix_text).collect(),
    };
    format!(", [{}])", texts.join(", "))
}

/// A text as a Python literal.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("'");
    for character in text.chars() {
        match character {
            '\'' | '\\' => quoted.extend(['\\', character]),
            _ if character.is_control() => {
                let _ = write!(quoted, "\\U{:08x}", u32::from(character));
            }
            _ => quoted.push(character),
        }
    }
    quoted + "'"
}
