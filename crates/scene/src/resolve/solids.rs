//! Evaluation of named solids, each once and after its parts.

use super::context::{Context, MAX_COPIES, WORLD};
use super::files;
use super::numbers::{Numbers, cycle_text};
use super::outline;
use super::value::{value, wrong_type};
use crate::datum::{Datum, Table};
use crate::diagnostic::Diagnostic;
use crate::document::*;
use crate::expression::{Expression, ExpressionItem, Operator};
use crate::fault::place_in;
use crate::keys::{EXTRUDE, REVOLVE};
use crate::number::Number;
use crate::source::{Span, Spanned};
use crate::suggestion::did_you_mean;
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Copies, NameMap, Solid};
use rayweave_shape::primitive::{Primitive, ShapeError, Value, build as build_shape, manual};
use std::collections::HashSet;
use std::sync::Arc;

/// Body, transforms and label of a solid.
type PartsOf<'a> = (&'a Body, &'a [Spanned<Step>], Option<&'a str>);

/// The definitions of all solids.
pub(super) enum Entries<'d> {
    /// The entries of a document.
    Kept(&'d [SolidEntry]),
    /// Definitions without their names, each dropped once its solid is built.
    Dropped(Vec<Definition>),
}

/// The solids of a file, in less memory than as entries of a document: solids that depend on nothing else are built at once, so
/// that the text and the definitions of a large model never exist at the same time.
#[derive(Default)]
pub(crate) struct Definitions {
    names: Vec<String>,
    definitions: Vec<Definition>,
    /// What a solid that depends on nothing else is built from.
    nothing: (Document, HashSet<String>),
}

/// The definition of a solid, or the solid itself, with the place of its name.
pub(super) struct Definition {
    name: Span,
    content: Content,
}

enum Content {
    Defined(Box<Parts>),
    Built(Solid),
    Dropped,
}

/// A definition without its name.
struct Parts {
    label: Option<Spanned<String>>,
    body: Body,
    transform: Vec<Spanned<Step>>,
}

impl Definitions {
    /// Adds a solid. It must have been read without problems to be built at once.
    pub fn push(&mut self, entry: SolidEntry, is_readable: bool) {
        let built = if is_readable { independent(&entry, &self.nothing) } else { None };
        let SolidEntry { name, label, body, transform } = entry;
        let defined = || Content::Defined(Box::new(Parts { label, body, transform }));
        let content = built.map_or_else(defined, Content::Built);
        self.names.push(name.value);
        self.definitions.push(Definition { name: name.span, content });
    }

    /// Adds the solids of the next piece of the text.
    pub fn append(&mut self, next: Definitions) {
        self.names.extend(next.names);
        self.definitions.extend(next.definitions);
    }

    /// The names and the definitions.
    pub(super) fn into_entries(self) -> (Vec<String>, Entries<'static>) {
        (self.names, Entries::Dropped(self.definitions))
    }
}

/// The solid of a shape that depends neither on parameters nor on files. `None` for others and for invalid shapes, whose problems
/// are reported when all solids are built.
fn independent(entry: &SolidEntry, nothing: &(Document, HashSet<String>)) -> Option<Solid> {
    let Body::Shape(keyword, arguments) = &entry.body else { return None };
    if keyword.value == "mesh" {
        return None;
    }
    // the positions of problems do not matter
    let mut context = Context::new(&nothing.0, Vec::new(), &nothing.1);
    let numbers = Numbers::known(&[]);
    let solid = shape(&mut context, &numbers, keyword, arguments)?;
    let maps = steps(&mut context, &numbers, &entry.transform)?;
    let solid = maps.iter().fold(solid, |solid, map| solid.apply(*map));
    let label = entry.label.as_ref().map(|label| label.value.as_str());
    context.problems.is_empty().then(|| named(&entry.name.value, label, solid))
}

impl Entries<'_> {
    fn len(&self) -> usize {
        match self {
            Entries::Kept(entries) => entries.len(),
            Entries::Dropped(definitions) => definitions.len(),
        }
    }

    fn name(&self, index: usize) -> Span {
        match self {
            Entries::Kept(entries) => entries[index].name.span,
            Entries::Dropped(definitions) => definitions[index].name,
        }
    }

    /// Body, transforms and label of a solid; `None` if it was built or dropped.
    fn parts(&self, index: usize) -> Option<PartsOf<'_>> {
        let (body, transform, label) = match self {
            Entries::Kept(entries) => {
                let SolidEntry { body, transform, label, .. } = &entries[index];
                (body, transform, label)
            }
            Entries::Dropped(definitions) => match &definitions[index].content {
                Content::Defined(parts) => (&parts.body, &parts.transform, &parts.label),
                Content::Built(_) | Content::Dropped => return None,
            },
        };
        Some((body, transform, label.as_ref().map(|label| label.value.as_str())))
    }

    /// A solid that was built when it was read.
    fn take_built(&mut self, index: usize) -> Option<Solid> {
        let Entries::Dropped(definitions) = self else { return None };
        let content = &mut definitions[index].content;
        match std::mem::replace(content, Content::Dropped) {
            Content::Built(solid) => Some(solid),
            other => {
                *content = other;
                None
            }
        }
    }

    fn release(&mut self, index: usize) {
        if let Entries::Dropped(definitions) = self {
            definitions[index].content = Content::Dropped;
        }
    }
}

/// All solids.
pub(super) struct Solids<'n> {
    /// The names, in the order of the document.
    pub names: &'n [String],
    /// The number of each name.
    pub index: NameMap<&'n str, usize>,
    /// The solids in the order of the document; `None` for an invalid solid, whose problem has been reported.
    pub built: Vec<Option<Solid>>,
    /// Whether another solid uses it.
    pub used: Vec<bool>,
    /// The place of the solid with the name of the medium around everything.
    pub world: Option<Span>,
}

impl Solids<'_> {
    /// The number of a solid; an unknown name is reported.
    pub fn find(&self, context: &mut Context<'_>, name: &str, span: Span) -> Option<usize> {
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
pub(super) fn build<'n>(
    context: &mut Context<'_>,
    numbers: &mut Numbers,
    names: &'n [String],
    entries: Entries<'_>,
) -> Solids<'n> {
    let count = entries.len();
    let index: NameMap<_, _> = names.iter().enumerate().map(|(index, name)| (name.as_str(), index)).collect();
    let world = index.get(WORLD).map(|&index| entries.name(index));
    let mut builder = Builder {
        solids: Solids { names, index, built: vec![None; count], used: vec![false; count], world },
        entries,
        parts: Vec::with_capacity(count),
        failed: HashSet::new(),
    };
    for index in 0..count {
        let parts = builder.parts_of(context, index);
        builder.parts.push(parts.map(Box::new));
    }
    builder.settle_all(context, numbers);
    builder.solids
}

/// The parts of a solid that is defined by others.
struct Joined {
    /// The expression in postfix order; a single part for copies of a solid.
    terms: Vec<Term>,
    /// The numbers of the solids with the places of their names; `None` for unknown ones.
    needs: Vec<(Option<u32>, Span)>,
}

/// A term of an expression, without its text.
enum Term {
    /// The next part.
    Part,
    Empty,
    Universe,
    Operation(Operator, usize),
}

impl From<&ExpressionItem> for Term {
    fn from(item: &ExpressionItem) -> Term {
        match item {
            ExpressionItem::Name(_) => Term::Part,
            ExpressionItem::Empty => Term::Empty,
            ExpressionItem::Universe => Term::Universe,
            ExpressionItem::Operation(operator, count) => Term::Operation(*operator, *count),
        }
    }
}

struct Builder<'n, 'd> {
    solids: Solids<'n>,
    entries: Entries<'d>,
    /// `None` for shapes and for expressions with errors.
    parts: Vec<Option<Box<Joined>>>,
    /// Solids that are themselves invalid; the problem has been reported.
    failed: HashSet<usize>,
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    New,
    Open,
    Done,
}

impl Builder<'_, '_> {
    fn parts_of(&mut self, context: &mut Context<'_>, index: usize) -> Option<Joined> {
        match self.entries.parts(index)?.0 {
            Body::Shape(..) => None,
            Body::Place(place) => {
                let span = place.solid.span;
                let found = need(&mut self.solids, context, &place.solid.value, span);
                Some(Joined { terms: vec![Term::Part], needs: vec![(found, span)] })
            }
            Body::Expression(text) => {
                let parts = parts_of_expression(&mut self.solids, context, text);
                if parts.is_none() {
                    self.failed.insert(index);
                }
                parts
            }
        }
    }
    /// Resolves all solids by a depth-first traversal with an explicit stack.
    fn settle_all(&mut self, context: &mut Context<'_>, numbers: &Numbers) {
        let mut states = vec![State::New; self.parts.len()];
        for root in 0..self.parts.len() {
            // the solids on the current path, each with the number of its parts already visited
            let mut path = vec![(root, 0)];
            while let Some((index, next)) = path.pop() {
                if states[index] == State::Done {
                    continue;
                }
                states[index] = State::Open;
                match self.parts[index].as_ref().and_then(|parts| parts.needs.get(next)).copied() {
                    None => {
                        self.solids.built[index] = self.build_one(context, numbers, index);
                        self.entries.release(index);
                        self.parts[index] = None;
                        states[index] = State::Done;
                    }
                    Some((needed, span)) => {
                        path.push((index, next + 1));
                        match needed.map(|needed| needed as usize) {
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

    fn report_cycle(&mut self, context: &mut Context<'_>, path: &[(usize, usize)], index: usize, span: Span) {
        let start = path.iter().position(|(other, _)| *other == index).unwrap_or(0);
        let names: Vec<&str> = path[start..].iter().map(|(i, _)| self.solids.names[*i].as_str()).collect();
        let problem = Diagnostic::error(format!("the solid `{}` is defined in terms of itself", names[0]));
        context.push(problem.why(cycle_text(&names)), span);
        self.failed.extend(path[start..].iter().map(|(index, _)| *index));
    }

    fn build_one(&mut self, context: &mut Context<'_>, numbers: &Numbers, index: usize) -> Option<Solid> {
        if let Some(built) = self.entries.take_built(index) {
            return Some(built);
        }
        let (body, transform, label) = self.entries.parts(index)?;
        let solid = match body {
            Body::Shape(keyword, arguments) => shape(context, numbers, keyword, arguments),
            Body::Expression(_) => self.combine(index),
            Body::Place(place) => self.place(context, numbers, index, place),
        };
        // problems of the transforms are reported in any case
        let maps = steps(context, numbers, transform);
        let name = &self.solids.names[index];
        let failed = self.failed.contains(&index) || context.is_unreadable(name);
        let solid = maps?.iter().fold(solid?, |solid, map| solid.apply(*map));
        (!failed).then(|| named(name, label, solid))
    }

    fn combine(&self, index: usize) -> Option<Solid> {
        let parts = self.parts[index].as_ref()?;
        let mut needs = parts.needs.iter();
        let mut stack: Vec<Solid> = Vec::new();
        for term in &parts.terms {
            let solid = match term {
                Term::Part => self.solids.built[needs.next()?.0? as usize].clone()?,
                Term::Empty => Solid::empty(),
                Term::Universe => Solid::universe(),
                Term::Operation(operator, count) => {
                    operate(*operator, stack.split_off(stack.len().checked_sub(*count)?))?
                }
            };
            stack.push(solid);
        }
        stack.pop()
    }

    fn place(
        &self,
        context: &mut Context<'_>,
        numbers: &Numbers,
        index: usize,
        place: &Place,
    ) -> Option<Solid> {
        let maps = layout(context, numbers, &place.layout);
        let given = place.numbers.as_ref();
        let given = given.map(|given| copy_numbers(context, numbers, given, maps.as_ref()));
        let needed = self.parts[index].as_ref()?.needs[0].0?;
        let solid = self.solids.built[needed as usize].as_ref()?;
        let given = given.map_or(Some(None), |given| given.map(Some))?;
        Some(match &place.name {
            Some(name) => solid.place_copies(Copies::labelled(maps?, &name.value, given)),
            None => solid.place(maps?),
        })
    }
}

fn parts_of_expression(solids: &mut Solids, context: &mut Context, text: &Spanned<String>) -> Option<Joined> {
    let source = &context.document.source;
    let expression = match Expression::parse(&text.value) {
        Ok(expression) => expression,
        Err(faults) => {
            let problems = faults.into_iter().map(|fault| fault.located(source, &text.value, text.span));
            context.problems.extend(problems);
            return None;
        }
    };
    let offset = place_in(source, &text.value, text.span, Span::default());
    let exact = offset.start() == offset.end();
    let mut needs = Vec::new();
    for (name, part) in expression.names() {
        let span = if exact { part.shifted(offset.start()) } else { text.span };
        needs.push((need(solids, context, name, span), span));
    }
    let terms = expression.terms().map(|(item, _)| item.into()).collect();
    Some(Joined { terms, needs })
}

/// The number of a solid that another one uses.
fn need(solids: &mut Solids, context: &mut Context, name: &str, span: Span) -> Option<u32> {
    let found = solids.find(context, name, span)?;
    solids.used[found] = true;
    Some(found as u32)
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
fn named(name: &str, label: Option<&str>, solid: Solid) -> Solid {
    match label {
        Some(label) => solid.named(label),
        None if name.starts_with('_') => solid,
        None => solid.named(name),
    }
}

/// Words of other programs for a parameter that places a shape about the origin.
const CENTRING: [&str; 4] = ["center", "centre", "centered", "centred"];

fn shape(
    context: &mut Context,
    numbers: &Numbers,
    keyword: &Spanned<String>,
    arguments: &Table,
) -> Option<Solid> {
    if let Some((_, file)) =
        arguments.iter().find(|(name, _)| keyword.value == "mesh" && name.value == "file")
    {
        return mesh(context, arguments, file);
    }
    match keyword.value.as_str() {
        EXTRUDE => return outline::extrude(context, numbers, arguments, keyword.span),
        REVOLVE => return outline::revolve(context, numbers, arguments, keyword.span),
        _ => {}
    }
    let known = manual(&keyword.value).map(|manual| manual.parameters).unwrap_or_default();
    let is_unknown = |name: &str| known.iter().all(|parameter| parameter.name != name);
    // the value of an unknown parameter, or of a parameter of an unknown shape, has no type
    let unknown: Vec<_> = arguments.iter().filter(|(name, _)| is_unknown(&name.value)).collect();
    for (name, _) in unknown.iter().take(if known.is_empty() { 1 } else { MAX_UNKNOWN }) {
        let value = (name.value.as_str(), Value::Number(0.0));
        report(context, numbers, keyword, arguments, build_shape(&keyword.value, &[value]).err()?);
    }
    let mut complete = unknown.is_empty();
    let mut values = Vec::new();
    for (name, datum) in arguments.iter().filter(|(name, _)| !is_unknown(&name.value)) {
        match value(context, numbers, &name.value, datum) {
            Some(value) => values.push((name.value.as_str(), value)),
            None => complete = false,
        }
    }
    match build_shape(&keyword.value, &values) {
        Ok(primitive) => complete.then(|| primitive.into()),
        // the missing parameter is given, but invalid or misspelt; an unknown shape is reported
        Err(ShapeError::MissingParameter { .. } | ShapeError::UnknownShape { .. }) if !complete => None,
        Err(error) => {
            report(context, numbers, keyword, arguments, error);
            None
        }
    }
}

/// The maximum number of unknown parameters of one shape that are reported.
const MAX_UNKNOWN: usize = 20;

/// Reports an error of a shape at the argument that it is about.
fn report(
    context: &mut Context,
    numbers: &Numbers,
    keyword: &Spanned<String>,
    arguments: &Table,
    mut error: ShapeError,
) {
    let (span, datum) = place_of(&error, keyword, arguments);
    let cause = match datum {
        Some(Datum::Text(text)) => numbers.parameters_of(text),
        _ => None,
    };
    if let (ShapeError::OutOfRange { suggestion, .. }, Some(_)) = (&mut error, &cause) {
        // it would replace the expression
        *suggestion = None;
    }
    let cause = cause.map_or_else(String::new, |cause| format!(" It is computed with {cause}."));
    let is_centring =
        matches!(&error, ShapeError::UnknownParameter { name, .. } if CENTRING.contains(&name.as_str()));
    let hint = is_centring.then_some(
        " Shapes are centred about the origin of their frame: leave it out, or move the solid with a `transform`.",
    );
    context.push(Diagnostic::error(error.to_string() + hint.unwrap_or_default() + &cause), span);
}

/// A mesh from a file, which replaces all parameters.
fn mesh(context: &mut Context, arguments: &Table, file: &Spanned<Datum>) -> Option<Solid> {
    let Datum::Text(name) = &file.value else {
        return wrong_type(context, "file", &file.value, "the name of a file", file.span);
    };
    let mut repair = false;
    for (name, value) in arguments.iter().filter(|(name, _)| name.value != "file") {
        match (name.value.as_str(), &value.value) {
            ("repair", Datum::Boolean(given)) => repair = *given,
            ("repair", other) => return wrong_type(context, "repair", other, "true or false", value.span),
            _ => {
                let problem = Diagnostic::error(format!("`{}` cannot be combined with `file`", name.value));
                context.push(problem.why("a mesh from a file takes only `repair`"), name.span);
                return None;
            }
        }
    }
    files::mesh(context, &Spanned::new(name.clone(), file.span), repair)
        .map(|mesh| Primitive::from(mesh).into())
}

/// The span of the argument, or of a part of it, that an error refers to, and its value.
fn place_of<'a>(
    error: &ShapeError,
    keyword: &Spanned<String>,
    arguments: &'a Table,
) -> (Span, Option<&'a Datum>) {
    let named = |name: &str| arguments.iter().find(|(own, _)| own.value == name);
    let Some((name, datum)) = error.parameter().and_then(named) else {
        return (keyword.span, None);
    };
    if matches!(error, ShapeError::UnknownParameter { .. }) {
        return (name.span, None);
    }
    let mut place = datum;
    for index in error.index() {
        match &place.value {
            Datum::List(list) if index < list.len() => place = &list[index],
            _ => break,
        }
    }
    (place.span, Some(&place.value))
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
    if complete
        && maps.len() > 1
        && let Err(error) = product.inverse()
    {
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
        let problem = Diagnostic::error(format!("the {what} is the zero vector"));
        context.push(problem.why("it must have a direction"), vector[0].span.to(vector[2].span));
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
            let copies = numbers.whole(context, "`ring`", count, 1, MAX_COPIES);
            let radius = numbers.finite(context, radius);
            let start = start.as_ref().map_or(Some(0.0), |start| numbers.finite(context, start));
            let (copies, radius, start) = (copies?, radius?, start?);
            context.count_copies(u64::from(copies), count.span).then(|| ring(copies, radius, start))
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
        let problem = Diagnostic::error(format!("`numbers` has {} entries", given.value.len()));
        context.push(problem.why(format!("it needs one for each of the {count} copies")), given.span);
        return None;
    }
    let is_whole = |value: f64| value.is_finite() && value.fract() == 0.0;
    let each = given
        .value
        .iter()
        .map(|number| numbers.checked(context, "a number of `numbers`", number, "a whole number", is_whole));
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
    let [nx, ny, nz] =
        count.each_ref().map(|number| numbers.whole(context, "a number of `grid`", number, 1, MAX_COPIES));
    let step = numbers.vector(context, step);
    let origin = origin.as_ref().map_or(Some(Vec3::ZERO), |origin| numbers.vector(context, origin));
    let (nx, ny, nz, step, origin) = (nx?, ny?, nz?, step?, origin?);
    let copies = u128::from(nx) * u128::from(ny) * u128::from(nz);
    if copies > u128::from(MAX_COPIES) {
        let problem = Diagnostic::error(format!("the grid has {copies} copies"));
        let reason = format!("the maximum is {MAX_COPIES}");
        context.push(problem.why(reason), count[0].span.to(count[2].span));
        return None;
    }
    if !context.count_copies(copies as u64, count[0].span.to(count[2].span)) {
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
