//! Extrusions and revolutions of outlines: `extrude = { outline = .., height = .. }`, `revolve = { outline = .. }`.

use super::context::Context;
use super::files;
use super::numbers::Numbers;
use super::value::{scalar, wrong_type};
use crate::datum::{Datum, Table};
use crate::diagnostic::Diagnostic;
use crate::drawing;
use crate::source::{Span, Spanned};
use crate::suggestion::did_you_mean;
use rayweave_model::Solid;
use rayweave_polygon::{Corner, Outline, OutlineError, Rim, Vertex};

/// The keys of a contour's point.
const POINT: [&str; 5] = ["at", "fillet", "chamfer", "bulge", "through"];

/// The contours of an outline as they are read, with the place of each contour and point.
#[derive(Default)]
struct Contours {
    vertices: Vec<Vec<Vertex>>,
    places: Vec<(Span, Vec<Span>)>,
}

impl Contours {
    /// The text that an error is about.
    fn place(&self, error: &OutlineError, whole: Span) -> Span {
        let Some((contour, vertex)) = error.place() else { return whole };
        let Some((span, points)) = self.places.get(contour) else { return whole };
        vertex.and_then(|vertex| points.get(vertex)).copied().unwrap_or(*span)
    }
}

/// A table with a fixed set of keys, whose values are numbers and points.
struct Keys<'t, 'c, 'd> {
    context: &'c mut Context<'d>,
    numbers: &'c Numbers,
    table: &'t Table,
    span: Span,
    is_complete: bool,
}

impl<'t, 'c, 'd> Keys<'t, 'c, 'd> {
    /// Reports keys that are not in the list.
    fn new(
        context: &'c mut Context<'d>,
        numbers: &'c Numbers,
        table: &'t Table,
        span: Span,
        known: &[&str],
    ) -> Keys<'t, 'c, 'd> {
        let mut is_complete = true;
        for (key, _) in table.iter().filter(|(key, _)| !known.contains(&key.value.as_str())) {
            let problem = Diagnostic::error(format!("unknown key `{}`", key.value))
                .why(format!("the keys here are {}", known.join(", ")))
                .suggest(did_you_mean(&key.value, known.iter().copied()));
            context.push(problem, key.span);
            is_complete = false;
        }
        Keys { context, numbers, table, span, is_complete }
    }

    fn get(&self, key: &str) -> Option<&'t Spanned<Datum>> {
        self.table.iter().find(|(name, _)| name.value == key).map(|(_, value)| value)
    }

    /// A finite number; `None` if the key is missing or invalid.
    fn number(&mut self, key: &str) -> Option<f64> {
        let datum = self.get(key)?;
        let value = scalar(self.context, self.numbers, key, datum)
            .and_then(|value| self.finite(key, value, datum.span));
        self.is_complete &= value.is_some();
        value
    }

    fn finite(&mut self, key: &str, value: f64, span: Span) -> Option<f64> {
        if value.is_finite() {
            return Some(value);
        }
        self.context.push(Diagnostic::error(format!("`{key}` is {value}")).why("it must be finite"), span);
        None
    }

    /// Two finite numbers; `None` if the key is missing or invalid.
    fn pair(&mut self, key: &str) -> Option<[f64; 2]> {
        let datum = self.get(key)?;
        let pair = pair(self.context, self.numbers, key, datum);
        self.is_complete &= pair.is_some();
        pair
    }

    /// The size and the place of a fillet or chamfer, at most one of which may be given.
    fn corner(&mut self) -> Corner {
        if self.get("fillet").is_some()
            && let Some(chamfer) = self.get("chamfer")
        {
            let problem = Diagnostic::error("`fillet` and `chamfer` are both given");
            self.context.push(problem.why("a corner has one form"), chamfer.span);
            self.is_complete = false;
        }
        // 0 is no treatment, so that a parameter can switch it off
        match (self.number("fillet"), self.number("chamfer")) {
            (Some(0.0), None) | (None, Some(0.0) | None) => Corner::Sharp,
            (Some(radius), _) => Corner::Fillet(radius),
            (None, Some(size)) => Corner::Chamfer(size),
        }
    }

    /// Reports a problem with the whole table.
    fn reject(&mut self, problem: &str, why: &str) {
        self.context.push(Diagnostic::error(problem.to_owned()).why(why), self.span);
        self.is_complete = false;
    }

    /// The treatment of a rim, such as `top = { fillet = 1 }`.
    fn rim(&mut self, key: &'static str) -> Rim {
        let Some(datum) = self.get(key) else { return Rim::Sharp };
        let Datum::Table(table) = &datum.value else {
            let wanted = "a table such as { fillet = 1 } or { chamfer = 1 }";
            self.is_complete &=
                wrong_type::<()>(self.context, key, &datum.value, wanted, datum.span).is_some();
            return Rim::Sharp;
        };
        let mut keys = Keys::new(self.context, self.numbers, table, datum.span, &["fillet", "chamfer"]);
        let rim = match keys.corner() {
            Corner::Sharp => Rim::Sharp,
            Corner::Fillet(size) => Rim::Fillet(size),
            Corner::Chamfer(size) => Rim::Chamfer(size),
        };
        let is_given = keys.get("fillet").is_some() || keys.get("chamfer").is_some();
        if keys.is_complete && (rim.size() < 0.0 || !is_given) {
            keys.reject(&format!("`{key}` is empty"), "it needs a `fillet` or `chamfer` of at least 0");
        }
        self.is_complete &= keys.is_complete;
        rim
    }
}

/// An extruded outline: `outline`, and `height` or `z = [lo, hi]`.
pub(super) fn extrude(context: &mut Context, numbers: &Numbers, table: &Table, span: Span) -> Option<Solid> {
    let known = ["outline", "file", "layer", "scale", "height", "z", "fillet", "chamfer", "top", "bottom"];
    let mut keys = Keys::new(context, numbers, table, span, &known);
    let contours = contours(&mut keys);
    let (height, z) = (keys.number("height"), keys.pair("z"));
    let rims = [keys.rim("bottom"), keys.rim("top")];
    if keys.is_complete && height.is_some() == z.is_some() {
        let problem = if z.is_some() { "`height` and `z` are both given" } else { "there is no `height`" };
        keys.reject(problem, "an extrusion needs either `height = h`, from z = 0 to h, or `z = [lo, hi]`");
    }
    let (is_complete, contours) = (keys.is_complete, contours?);
    let [lo, hi] = z.unwrap_or([0.0, height.unwrap_or(0.0)]);
    if is_complete && lo >= hi {
        let problem = Diagnostic::error(format!("the extrusion reaches from z = {lo} to z = {hi}"));
        let place = table.iter().find(|(key, _)| key.value == "height" || key.value == "z");
        context.push(
            problem.why("its height must be greater than 0"),
            place.map_or(span, |(_, value)| value.span),
        );
        return None;
    }
    let solid =
        is_complete.then(|| Outline::new(&contours.vertices).and_then(|o| o.extrude(lo, hi, rims)))?;
    reported(context, solid, &contours, span)
}

/// A revolved outline: `outline`, and `start` and `angle` for a part of a turn.
pub(super) fn revolve(context: &mut Context, numbers: &Numbers, table: &Table, span: Span) -> Option<Solid> {
    let mut keys = Keys::new(
        context,
        numbers,
        table,
        span,
        &["outline", "file", "layer", "scale", "fillet", "chamfer", "start", "angle"],
    );
    let contours = contours(&mut keys);
    let (start, angle) = (keys.number("start").unwrap_or(0.0), keys.number("angle").unwrap_or(360.0));
    if keys.is_complete && !(angle > 0.0 && angle <= 360.0) {
        keys.reject(&format!("`angle` is {angle}"), "it must be greater than 0 and at most 360 degrees");
    }
    let (is_complete, contours) = (keys.is_complete, contours?);
    let solid =
        is_complete.then(|| Outline::new(&contours.vertices).and_then(|o| o.revolve(start, angle)))?;
    reported(context, solid, &contours, span)
}

fn reported(
    context: &mut Context,
    solid: Result<Solid, OutlineError>,
    contours: &Contours,
    span: Span,
) -> Option<Solid> {
    solid
        .map_err(|error| context.push(Diagnostic::error(error.to_string()), contours.place(&error, span)))
        .ok()
}

/// The contours of `outline`, with the corners that `fillet` or `chamfer` beside it round.
fn contours(keys: &mut Keys) -> Option<Contours> {
    let default = keys.corner();
    if let Some(file) = keys.get("file") {
        return drawn(keys, file, default);
    }
    let Some(outline) = keys.get("outline") else {
        let why =
            "it is a list of points, such as [[0, 0], [4, 0], [0, 3]]; or `file` is the name of a drawing";
        keys.reject("there is no `outline`", why);
        return None;
    };
    let list = match &outline.value {
        Datum::List(list) if list.iter().any(is_contour) => list.as_slice(),
        _ => std::slice::from_ref(outline),
    };
    let mut contours = Contours::default();
    let mut is_complete = true;
    for datum in list {
        match contour(keys, datum, default) {
            Some((vertices, places)) => {
                contours.vertices.push(vertices);
                contours.places.push((datum.span, places));
            }
            None => is_complete = false,
        }
    }
    keys.is_complete &= is_complete;
    Some(contours)
}

/// True for a list of points or a circle, false for a point.
fn is_contour(datum: &Spanned<Datum>) -> bool {
    match &datum.value {
        Datum::List(list) => list.iter().any(|item| matches!(item.value, Datum::List(_) | Datum::Table(_))),
        table => table.get("circle").is_some(),
    }
}

/// The vertices of a contour and their places.
fn contour(keys: &mut Keys, datum: &Spanned<Datum>, default: Corner) -> Option<(Vec<Vertex>, Vec<Span>)> {
    let list = match &datum.value {
        Datum::Table(table) => return circle(keys, table, datum.span),
        Datum::List(list) => list,
        other => {
            let wanted =
                "a list of points, such as [[0, 0], [4, 0], [0, 3]], or a circle, such as { circle = 2 }";
            return wrong_type(keys.context, "outline", other, wanted, datum.span);
        }
    };
    let points: Vec<Option<Given>> = list.iter().map(|item| point(keys, item)).collect();
    let points: Vec<Given> = points.into_iter().collect::<Option<_>>()?;
    let mut vertices: Vec<Vertex> = points.iter().map(|given| given.vertex).collect();
    for (k, given) in points.iter().enumerate() {
        let Some(through) = given.through else { continue };
        let next = points[(k + 1) % points.len()].vertex.at;
        match bulge_through(given.vertex.at, through, next) {
            Some(bulge) => vertices[k].bulge = bulge,
            None => {
                let problem = Diagnostic::error("no arc leads through these points");
                keys.context.push(problem.why("they are in one line, or equal"), list[k].span);
                return None;
            }
        }
    }
    give_corners(&mut vertices, default);
    Some((vertices, list.iter().map(|item| item.span).collect()))
}

/// Gives all sharp corners between straight edges this form.
fn give_corners(vertices: &mut [Vertex], corner: Corner) {
    for k in 0..vertices.len() {
        let before = vertices[(k + vertices.len() - 1) % vertices.len()];
        if vertices[k].corner == Corner::Sharp && vertices[k].bulge == 0.0 && before.bulge == 0.0 {
            vertices[k].corner = corner;
        }
    }
}

/// The contours of a drawing: `file`, with `layer` and `scale`.
fn drawn(keys: &mut Keys, file: &Spanned<Datum>, default: Corner) -> Option<Contours> {
    if keys.get("outline").is_some() {
        keys.reject("`outline` and `file` are both given", "an outline is given by one of them");
        return None;
    }
    let Datum::Text(name) = &file.value else {
        return wrong_type(keys.context, "file", &file.value, "the name of a file", file.span);
    };
    let layer = match keys.get("layer").map(|datum| (&datum.value, datum.span)) {
        None => None,
        Some((Datum::Text(layer), _)) => Some(layer.as_str()),
        Some((other, span)) => return wrong_type(keys.context, "layer", other, "the name of a layer", span),
    };
    let scale = keys.number("scale").unwrap_or(1.0);
    if scale <= 0.0 {
        keys.reject("`scale` is not positive", "lengths of the drawing are multiplied by it");
        return None;
    }
    let text = files::text(keys.context, name);
    match text.and_then(|text| drawing::read(name, &text, layer)) {
        Ok(mut vertices) => {
            for contour in &mut vertices {
                contour.iter_mut().for_each(|vertex| vertex.at = vertex.at.map(|x| scale * x));
                give_corners(contour, default);
            }
            let places = vertices.iter().map(|contour| (file.span, vec![file.span; contour.len()])).collect();
            Some(Contours { vertices, places })
        }
        Err(reason) => {
            let problem = Diagnostic::error(format!("the outline in `{name}` cannot be used"));
            keys.context.push(problem.why(reason), file.span);
            None
        }
    }
}

/// `{ circle = radius, at = [x, y] }`; the centre is the origin by default.
fn circle(keys: &mut Keys, table: &Table, span: Span) -> Option<(Vec<Vertex>, Vec<Span>)> {
    let mut own = Keys::new(keys.context, keys.numbers, table, span, &["circle", "at"]);
    let (radius, centre) = (own.number("circle"), own.pair("at").unwrap_or_default());
    match radius {
        Some(radius) if radius <= 0.0 => {
            own.reject("the circle has no area", "its radius must be greater than 0")
        }
        None if own.is_complete => own.reject("the contour has no `circle`", "it is the radius of a circle"),
        _ => {}
    }
    let is_complete = own.is_complete;
    radius.filter(|_| is_complete).map(|radius| (Vertex::circle(centre, radius).to_vec(), vec![span; 2]))
}

/// A point of a contour as it is given.
struct Given {
    vertex: Vertex,
    /// A point on the arc to the next point.
    through: Option<[f64; 2]>,
}

fn point(keys: &mut Keys, datum: &Spanned<Datum>) -> Option<Given> {
    let Datum::Table(table) = &datum.value else {
        let at = pair(keys.context, keys.numbers, "outline", datum)?;
        return Some(Given { vertex: Vertex::sharp(at), through: None });
    };
    let mut own = Keys::new(keys.context, keys.numbers, table, datum.span, &POINT);
    let (at, through) = (own.pair("at"), own.pair("through"));
    let (corner, bulge) = (own.corner(), own.number("bulge").unwrap_or(0.0));
    if at.is_none() && own.is_complete {
        own.reject("the point has no `at`", "it is a position, such as at = [1, 2]");
    }
    if own.get("bulge").is_some() && through.is_some() {
        own.reject("`bulge` and `through` are both given", "an arc is given by one of them");
    }
    let is_complete = own.is_complete;
    at.filter(|_| is_complete).map(|at| Given { vertex: Vertex { at, bulge, corner }, through })
}

/// Two finite numbers.
fn pair(context: &mut Context, numbers: &Numbers, key: &str, datum: &Spanned<Datum>) -> Option<[f64; 2]> {
    let Datum::List(list) = &datum.value else {
        return wrong_type(context, key, &datum.value, "two numbers, such as [1, 2]", datum.span);
    };
    let [a, b] = list.as_slice() else {
        return wrong_type(context, key, &datum.value, "two numbers, such as [1, 2]", datum.span);
    };
    let mut value = |item: &Spanned<Datum>| {
        let value = scalar(context, numbers, key, item)?;
        if value.is_finite() {
            return Some(value);
        }
        context
            .push(Diagnostic::error(format!("a coordinate is {value}")).why("it must be finite"), item.span);
        None
    };
    let (a, b) = (value(a), value(b));
    Some([a?, b?])
}

/// The bulge of the arc from `p` through `m` to `q`: the cotangent of half the angle at `m` between the chords to `p` and `q`.
fn bulge_through(p: [f64; 2], m: [f64; 2], q: [f64; 2]) -> Option<f64> {
    let (a, b) = ([p[0] - m[0], p[1] - m[1]], [q[0] - m[0], q[1] - m[1]]);
    let (cross, dot) = (a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    let lengths = libm::hypot(a[0], a[1]) * libm::hypot(b[0], b[1]);
    // the arc turns to the left if the point lies to the right of the chord
    (cross != 0.0).then(|| -(lengths + dot) / cross)
}
