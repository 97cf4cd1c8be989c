//! Evaluation of named solids, each once and after its parts.

use super::context::Context;
use super::files;
use super::numbers::{Numbers, cycle_text};
use crate::datum::{Datum, Table};
use crate::diagnostic::Diagnostic;
use crate::document::*;
use crate::expression::{Expression, ExpressionItem, Operator};
use crate::fault::place_in;
use crate::number::Number;
use crate::source::{Span, Spanned};
use crate::suggestion::did_you_mean;
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Copies, Solid};
use rayweave_shape::primitive::{Primitive, ShapeError, Value, build as build_shape};
use std::collections::HashMap;
use std::sync::Arc;

/// The maximum number of copies of one placement.
const MAX_COPIES: u32 = 1 << 22;

/// All solids.
pub(super) struct Solids<'d> {
    /// The number of each name.
    pub index: HashMap<&'d str, usize>,
    /// In the order of the document; `None` for an invalid solid, whose problem has been reported.
    pub built: Vec<Option<Solid>>,
    /// Whether another solid is made from it.
    pub used: Vec<bool>,
}

impl<'d> Solids<'d> {
    /// The number of a solid; an unknown name is reported.
    pub fn find(&self, context: &mut Context<'d>, name: &str, span: Span) -> Option<usize> {
        let found = self.index.get(name).copied();
        if found.is_none() && !context.is_unreadable(name) {
            let problem = Diagnostic::error(format!("unknown solid `{name}`"))
                .why(format!("there is no [solid.{}]", crate::datum::key(name)))
                .suggest(did_you_mean(name, self.index.keys().copied()));
            context.push(problem, span);
        }
        found
    }
}

/// Builds all solids.
pub(super) fn build<'d>(context: &mut Context<'d>, numbers: &mut Numbers) -> Solids<'d> {
    let document = context.document;
    let count = document.solids.len();
    let names = document.solids.iter().enumerate().map(|(index, entry)| (entry.name.value.as_str(), index));
    let mut builder = Builder {
        solids: Solids { index: names.collect(), built: vec![None; count], used: vec![false; count] },
        parts: Vec::with_capacity(count),
    };
    for entry in &document.solids {
        let parts = builder.parts_of(context, entry);
        builder.parts.push(parts);
    }
    builder.settle_all(context, numbers);
    builder.solids
}

/// Body of a solid.
#[derive(Default)]
struct Parts {
    expression: Option<Expression>,
    /// The numbers of the solids with the places of their names; `None` for unknown ones.
    needs: Vec<(Option<usize>, Span)>,
    failed: bool,
}

struct Builder<'d> {
    solids: Solids<'d>,
    parts: Vec<Parts>,
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    New,
    Open,
    Done,
}

impl<'d> Builder<'d> {
    fn parts_of(&mut self, context: &mut Context<'d>, entry: &'d SolidEntry) -> Parts {
        match &entry.body {
            Body::Shape(..) => Parts::default(),
            Body::Place(place) => {
                let found = self.solids.find(context, &place.solid.value, place.solid.span);
                self.mark(found);
                Parts { needs: vec![(found, place.solid.span)], ..Parts::default() }
            }
            Body::Expression(text) => self.parts_of_expression(context, text),
        }
    }

    fn parts_of_expression(&mut self, context: &mut Context<'d>, text: &Spanned<String>) -> Parts {
        let source = &context.document.source;
        let expression = match Expression::parse(&text.value) {
            Ok(expression) => expression,
            Err(faults) => {
                let problems = faults.into_iter().map(|fault| fault.located(source, &text.value, text.span));
                context.problems.extend(problems);
                return Parts { failed: true, ..Parts::default() };
            }
        };
        let offset = place_in(source, &text.value, text.span, Span::default());
        let exact = offset.start == offset.end;
        let mut needs = Vec::new();
        for (name, part) in expression.names() {
            let span = if exact { part.shifted(offset.start) } else { text.span };
            let found = self.solids.find(context, name, span);
            self.mark(found);
            needs.push((found, span));
        }
        Parts { expression: Some(expression), needs, failed: false }
    }

    fn mark(&mut self, used: Option<usize>) {
        if let Some(index) = used {
            self.solids.used[index] = true;
        }
    }

    /// Resolves all solids by a depth-first traversal with an explicit stack.
    fn settle_all(&mut self, context: &mut Context<'d>, numbers: &mut Numbers) {
        let mut states = vec![State::New; self.parts.len()];
        for root in 0..self.parts.len() {
            // each open solid with the number of its parts that have been visited
            let mut path = vec![(root, 0)];
            while let Some((index, next)) = path.pop() {
                if states[index] == State::Done {
                    continue;
                }
                states[index] = State::Open;
                match self.parts[index].needs.get(next).copied() {
                    None => {
                        self.solids.built[index] = self.build_one(context, numbers, index);
                        states[index] = State::Done;
                    }
                    Some((needed, span)) => {
                        path.push((index, next + 1));
                        match needed {
                            Some(needed) if states[needed] == State::New => path.push((needed, 0)),
                            Some(needed) if states[needed] == State::Open => {
                                self.report_cycle(context, &path, needed, span);
                            }
                            _ => {}
                        }
                    }
                }
            }
        }
    }

    fn report_cycle(&mut self, context: &mut Context<'d>, path: &[(usize, usize)], index: usize, span: Span) {
        let document = context.document;
        let start = path.iter().position(|(other, _)| *other == index).unwrap_or(0);
        let names: Vec<&str> =
            path[start..].iter().map(|(i, _)| document.solids[*i].name.value.as_str()).collect();
        let problem = Diagnostic::error(format!("the solid `{}` is made from itself", names[0]));
        context.push(problem.why(cycle_text(&names)), span);
        path[start..].iter().for_each(|(index, _)| self.parts[*index].failed = true);
    }

    fn build_one(&mut self, context: &mut Context<'d>, numbers: &mut Numbers, index: usize) -> Option<Solid> {
        let document = context.document;
        let entry = &document.solids[index];
        let body = match &entry.body {
            Body::Shape(keyword, arguments) => shape(context, numbers, keyword, arguments),
            Body::Expression(_) => self.combine(index),
            Body::Place(place) => self.place(context, numbers, index, place),
        };
        let steps = steps(context, numbers, &entry.transform);
        let failed = self.parts[index].failed || context.is_unreadable(&entry.name.value);
        let solid = steps?.iter().fold(body?, |solid, step| solid.apply(*step));
        (!failed).then(|| named(entry, solid))
    }

    fn combine(&self, index: usize) -> Option<Solid> {
        let parts = &self.parts[index];
        let mut needs = parts.needs.iter();
        let mut stack: Vec<Solid> = Vec::new();
        for (term, _) in parts.expression.as_ref()?.terms() {
            let operands = stack.split_off(stack.len() - term.arity());
            stack.push(match term {
                ExpressionItem::Name(_) => self.solids.built[needs.next()?.0?].clone()?,
                ExpressionItem::Empty => Solid::empty(),
                ExpressionItem::Universe => Solid::universe(),
                ExpressionItem::Operation(operator, _) => operate(*operator, operands)?,
            });
        }
        stack.pop()
    }

    fn place(
        &self,
        context: &mut Context<'d>,
        numbers: &mut Numbers,
        index: usize,
        place: &Place,
    ) -> Option<Solid> {
        let maps = layout(context, numbers, &place.layout);
        let given = place.numbers.as_ref();
        let given = given.map(|given| copy_numbers(context, numbers, given, maps.as_ref()));
        let needed = self.parts[index].needs[0].0?;
        let solid = self.solids.built[needed].as_ref()?;
        let given = given.map_or(Some(None), |given| given.map(Some))?;
        Some(match &place.name {
            Some(name) => solid.place_copies(Copies::labelled(maps?, &name.value, given)),
            None => solid.place(maps?),
        })
    }
}

fn operate(operator: Operator, operands: Vec<Solid>) -> Option<Solid> {
    let mut operands = operands.into_iter();
    Some(match operator {
        Operator::Union => Solid::union(operands),
        Operator::Intersection => Solid::intersection(operands),
        Operator::SymmetricDifference => Solid::symmetric_difference(operands),
        Operator::Difference => operands.next()? - operands.next()?,
        Operator::Complement => !operands.next()?,
    })
}

/// A solid under its name. Names that begin with `_` are private to the file.
fn named(entry: &SolidEntry, solid: Solid) -> Solid {
    let name = match &entry.label {
        Some(label) => &label.value,
        None if entry.name.value.starts_with('_') => return solid,
        None => &entry.name.value,
    };
    solid.named(name)
}

fn shape(
    context: &mut Context,
    numbers: &Numbers,
    keyword: &Spanned<String>,
    arguments: &Table,
) -> Option<Solid> {
    if let Some((_, file)) =
        arguments.iter().find(|(name, _)| keyword.value == "mesh" && name.value == "file")
    {
        return mesh(context, keyword, arguments, file);
    }
    let mut values = Vec::new();
    let mut complete = true;
    for (name, datum) in arguments {
        match value(context, numbers, &name.value, datum) {
            Some(value) => values.push((name.value.as_str(), value)),
            None => complete = false,
        }
    }
    match build_shape(&keyword.value, &values) {
        Ok(primitive) => complete.then(|| primitive.into()),
        // the missing parameter is given, but invalid
        Err(ShapeError::MissingParameter { .. }) if !complete => None,
        Err(error) => {
            let span = place_of(&error, keyword, arguments);
            context.push(Diagnostic::error(error.to_string()), span);
            None
        }
    }
}

/// A mesh from a file, which replaces all parameters.
fn mesh(
    context: &mut Context,
    keyword: &Spanned<String>,
    arguments: &Table,
    file: &Spanned<Datum>,
) -> Option<Solid> {
    let Datum::Text(name) = &file.value else {
        return wrong_type(context, "file", &file.value, "the name of a file", file.span);
    };
    let mut repair = false;
    for (name, value) in arguments.iter().filter(|(name, _)| name.value != "file") {
        match (name.value.as_str(), &value.value) {
            ("repair", Datum::Boolean(given)) => repair = *given,
            ("repair", other) => return wrong_type(context, "repair", other, "true or false", value.span),
            _ => {
                let problem = Diagnostic::error("the mesh has a file and something else");
                context.push(problem.why("its points and faces stand in the file, or here"), keyword.span);
                return None;
            }
        }
    }
    files::mesh(context, &Spanned::new(name.clone(), file.span), repair)
        .map(|mesh| Primitive::from(mesh).into())
}

/// The span of the argument, or of a part of it, that an error refers to.
fn place_of(error: &ShapeError, keyword: &Spanned<String>, arguments: &Table) -> Span {
    let named = |name: &str| arguments.iter().find(|(own, _)| own.value == name);
    let Some((name, datum)) = error.parameter().and_then(named) else {
        return keyword.span;
    };
    if matches!(error, ShapeError::UnknownParameter { .. }) {
        return name.span;
    }
    let mut place = datum;
    for index in error.index() {
        match &place.value {
            Datum::List(list) if index < list.len() => place = &list[index],
            _ => break,
        }
    }
    place.span
}

fn value(context: &mut Context, numbers: &Numbers, name: &str, datum: &Spanned<Datum>) -> Option<Value> {
    match &datum.value {
        Datum::List(list) if list.iter().any(|item| matches!(item.value, Datum::List(_))) => {
            let rows: Vec<_> = list.iter().map(|row| row_values(context, numbers, name, row)).collect();
            rows.into_iter().collect::<Option<_>>().map(Value::Rows)
        }
        Datum::List(_) => row_values(context, numbers, name, datum).map(Value::Vector),
        _ => scalar(context, numbers, name, datum).map(Value::Number),
    }
}

fn row_values(
    context: &mut Context,
    numbers: &Numbers,
    name: &str,
    datum: &Spanned<Datum>,
) -> Option<Vec<f64>> {
    match &datum.value {
        Datum::List(list) => {
            let values: Vec<_> = list.iter().map(|item| scalar(context, numbers, name, item)).collect();
            values.into_iter().collect()
        }
        other => wrong_type(context, name, other, "a row of numbers", datum.span),
    }
}

fn scalar(context: &mut Context, numbers: &Numbers, name: &str, datum: &Spanned<Datum>) -> Option<f64> {
    match &datum.value {
        Datum::Number(value) => Some(*value),
        Datum::Text(text) => numbers.text(context, text, datum.span),
        other => wrong_type(context, name, other, "a number or arithmetic text", datum.span),
    }
}

fn wrong_type<T>(context: &mut Context, name: &str, found: &Datum, wanted: &str, span: Span) -> Option<T> {
    let problem = Diagnostic::error(format!("`{name}` is {}", found.description()));
    context.push(problem.why(format!("it must be {wanted}")), span);
    None
}

/// The transforms in order; each of them, and their product, must be invertible.
fn steps(context: &mut Context, numbers: &Numbers, steps: &[Spanned<Step>]) -> Option<Vec<Affine>> {
    let mut maps = Vec::with_capacity(steps.len());
    let (mut product, mut complete) = (Affine::IDENTITY, true);
    for step in steps {
        let map = affine(context, numbers, &step.value, step.span);
        let map = map.and_then(|map| invertible(context, map, step.span));
        complete &= map.is_some();
        if let Some(map) = map {
            product = product.then(&map);
            maps.push(map);
        }
    }
    if complete && let Err(error) = product.inverse() {
        let span = steps[0].span.to(steps[steps.len() - 1].span);
        context.push(Diagnostic::error(error.to_string()), span);
        return None;
    }
    complete.then_some(maps)
}

/// The product of transforms; the first is applied first.
pub(crate) fn product(context: &mut Context, numbers: &Numbers, list: &[Spanned<Step>]) -> Option<Affine> {
    let maps = steps(context, numbers, list)?;
    Some(maps.iter().fold(Affine::IDENTITY, |product, map| product.then(map)))
}

fn invertible(context: &mut Context, map: Affine, span: Span) -> Option<Affine> {
    match map.inverse() {
        Ok(_) => Some(map),
        Err(error) => {
            context.push(Diagnostic::error(error.to_string()), span);
            None
        }
    }
}

fn affine(context: &mut Context, numbers: &Numbers, step: &Step, span: Span) -> Option<Affine> {
    Some(match step {
        Step::Translate(by) => Affine::translate(numbers.vector(context, by)?),
        Step::RotateX(degrees) => Affine::rotation(Vec3::X, numbers.finite(context, degrees)?),
        Step::RotateY(degrees) => Affine::rotation(Vec3::Y, numbers.finite(context, degrees)?),
        Step::RotateZ(degrees) => Affine::rotation(Vec3::Z, numbers.finite(context, degrees)?),
        Step::Rotate(axis, degrees) => {
            let axis = direction(context, numbers, axis, "axis")?;
            Affine::rotation(axis, numbers.finite(context, degrees)?)
        }
        Step::Scale(factor) => Affine::scale(Vec3::splat(numbers.finite(context, factor)?)),
        Step::ScaleAxes(factors) => Affine::scale(numbers.vector(context, factors)?),
        Step::Mirror(normal) => Affine::mirror(direction(context, numbers, normal, "normal")?),
        Step::Matrix(rows) => {
            let rows = numbers.matrix(context, rows)?;
            return from_rows(context, &rows, span);
        }
    })
}

/// A vector that is not zero.
pub(super) fn direction(
    context: &mut Context,
    numbers: &Numbers,
    vector: &Vector,
    what: &str,
) -> Option<Vec3> {
    let value = numbers.vector(context, vector)?;
    if value == Vec3::ZERO {
        let problem = Diagnostic::error(format!("the {what} is a vector of length zero"));
        context.push(problem.why("it has no direction"), vector[0].span.to(vector[2].span));
        return None;
    }
    Some(value)
}

fn from_rows(context: &mut Context, rows: &[[f64; 4]; 4], span: Span) -> Option<Affine> {
    let map = Affine::from_rows(rows);
    if map.is_none() {
        let problem = Diagnostic::error("the matrix is not affine");
        context.push(problem.why("its last row must be [0, 0, 0, 1]"), span);
    }
    map
}

fn layout(context: &mut Context, numbers: &Numbers, layout: &Layout) -> Option<Vec<Affine>> {
    match layout {
        Layout::Grid(entry) => grid(context, numbers, entry),
        Layout::Ring { count, radius, start } => {
            let copies = numbers.whole(context, count, 1, MAX_COPIES);
            let radius = numbers.finite(context, radius);
            let start = start.as_ref().map_or(Some(0.0), |start| numbers.finite(context, start));
            Some(ring(copies?, radius?, start?))
        }
        Layout::At(places) => {
            let maps: Vec<_> = places.iter().map(|place| numbers.vector(context, place)).collect();
            maps.into_iter().map(|place| place.map(Affine::translate)).collect()
        }
        Layout::Matrices(matrices) => {
            let maps: Vec<_> = matrices.iter().map(|rows| placed_matrix(context, numbers, rows)).collect();
            maps.into_iter().collect()
        }
        Layout::File(file) => files::transforms(context, file),
    }
}

/// The numbers of copies, one for each map.
fn copy_numbers(
    context: &mut Context,
    numbers: &Numbers,
    given: &Spanned<Vec<Spanned<Number>>>,
    maps: Option<&Vec<Affine>>,
) -> Option<Arc<[i64]>> {
    let count = maps?.len();
    if given.value.len() != count {
        let problem = Diagnostic::error(format!("`place` has {} numbers", given.value.len()));
        context.push(problem.why(format!("there are {count} copies")), given.span);
        return None;
    }
    let is_whole = |value: f64| value.is_finite() && value.fract() == 0.0;
    let each = given.value.iter().map(|number| numbers.checked(context, number, "a whole number", is_whole));
    let values: Vec<Option<f64>> = each.collect();
    values.into_iter().map(|value| value.map(|value| value as i64)).collect()
}

fn placed_matrix(context: &mut Context, numbers: &Numbers, rows: &Matrix) -> Option<Affine> {
    let span = rows[0][0].span.to(rows[3][3].span);
    let values = numbers.matrix(context, rows)?;
    let map = from_rows(context, &values, span)?;
    invertible(context, map, span)
}

fn grid(context: &mut Context, numbers: &Numbers, entry: &Grid) -> Option<Vec<Affine>> {
    let Grid { count, step, origin } = entry;
    let [nx, ny, nz] = count.each_ref().map(|number| numbers.whole(context, number, 1, MAX_COPIES));
    let step = numbers.vector(context, step);
    let origin = origin.as_ref().map_or(Some(Vec3::ZERO), |origin| numbers.vector(context, origin));
    let (nx, ny, nz, step, origin) = (nx?, ny?, nz?, step?, origin?);
    let copies = u128::from(nx) * u128::from(ny) * u128::from(nz);
    if copies > u128::from(MAX_COPIES) {
        let problem = Diagnostic::error(format!("the grid has {copies} copies"));
        let reason = format!("the most is {MAX_COPIES}");
        context.push(problem.why(reason), count[0].span.to(count[2].span));
        return None;
    }
    let at = |i: u32, j: u32, k: u32| origin + step * Vec3::new(f64::from(i), f64::from(j), f64::from(k));
    let cells = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j, k))));
    Some(cells.map(|(i, j, k)| Affine::translate(at(i, j, k))).collect())
}

fn ring(copies: u32, radius: f64, start: f64) -> Vec<Affine> {
    let out = Affine::translate(Vec3::new(radius, 0.0, 0.0));
    let angle = |k: u32| start + 360.0 * f64::from(k) / f64::from(copies);
    (0..copies).map(|k| out.then(&Affine::rotation(Vec3::Z, angle(k)))).collect()
}
