//! Printer of the native model file.

use super::VERSION;
use crate::datum::{key, quoted, to_toml};
use crate::document::*;
use crate::number::{Number, written};
use crate::source::Spanned;
use std::fmt::Write;

/// Formats the whole file. Comments are kept at the head and in the tables of other programs.
pub(crate) fn write(document: &Document) -> String {
    let mut text = String::new();
    for line in &document.heading {
        text += format!("# {line}").trim_end();
        text.push('\n');
    }
    text += &format!("rayweave = {}\n", written(VERSION));
    if let Some(unit) = document.unit.as_ref() {
        text += &format!("unit = {}\n", quoted(unit.value.symbol()));
    }
    let (inline, tables): (Vec<_>, Vec<_>) =
        document.foreign.iter().partition(|foreign| !foreign.text.trim_start().starts_with(['[', '#']));
    inline.iter().for_each(|foreign| text += &foreign.text);
    sections(document, &mut text);
    tables.iter().for_each(|foreign| text += &format!("\n{}", foreign.text));
    text
}

fn sections(document: &Document, text: &mut String) {
    if !document.parameters.is_empty() {
        let mut section = Section::new("[parameters]");
        for parameter in &document.parameters {
            section.put(&parameter.name.value, number(&parameter.value));
        }
        *text += &section.text;
    }
    document.solids.iter().for_each(|entry| *text += &solid(entry));
    document.regions.iter().for_each(|entry| *text += &region(entry));
    document.media.iter().for_each(|entry| *text += &medium(entry));
    document.camera.iter().for_each(|entry| *text += &camera(&entry.value));
    document.lights.iter().for_each(|entry| *text += &light(entry));
    document.render.iter().for_each(|entry| *text += &render(entry));
}

/// A header and the keys below it.
struct Section {
    text: String,
}

impl Section {
    fn new(header: &str) -> Section {
        Section { text: format!("\n{header}\n") }
    }

    fn put(&mut self, name: &str, value: String) {
        // writing to a string cannot fail
        let _ = writeln!(self.text, "{} = {value}", key(name));
    }

    fn put_some<T>(&mut self, name: &str, value: &Option<T>, write: impl Fn(&T) -> String) {
        if let Some(value) = value {
            self.put(name, write(value));
        }
    }
}

fn solid(entry: &SolidEntry) -> String {
    let mut section = Section::new(&format!("[solid.{}]", key(&entry.name.value)));
    section.put_some("name", &entry.label, text);
    match &entry.body {
        Body::Shape(keyword, arguments) => {
            section.put(&keyword.value, to_toml(&crate::datum::Datum::Table(arguments.clone())));
        }
        Body::Expression(expression) => section.put("expr", text(expression)),
        Body::Place(entry) => section.put("place", place(entry)),
    }
    if !entry.transform.is_empty() {
        let steps: Vec<String> = entry.transform.iter().map(|entry| step(&entry.value)).collect();
        section.put("transform", format!("[{}]", steps.join(", ")));
    }
    section.text
}

fn step(step: &Step) -> String {
    let (name, value) = match step {
        Step::Translate(by) => ("translate", numbers(by)),
        Step::RotateX(degrees) => ("rotate_x", number(degrees)),
        Step::RotateY(degrees) => ("rotate_y", number(degrees)),
        Step::RotateZ(degrees) => ("rotate_z", number(degrees)),
        Step::Rotate(axis, degrees) => {
            let value = format!("{{ axis = {}, degrees = {} }}", numbers(axis), number(degrees));
            ("rotate", value)
        }
        Step::Scale(factor) => ("scale", number(factor)),
        Step::ScaleAxes(factors) => ("scale", numbers(factors)),
        Step::Mirror(normal) => ("mirror", numbers(normal)),
        Step::Matrix(rows) => ("matrix", matrix(rows)),
    };
    format!("{{ {name} = {value} }}")
}

fn place(place: &Place) -> String {
    let solid = text(&place.solid);
    let layout = match &place.layout {
        Layout::Grid(grid) => {
            let Grid { count, step, origin } = &**grid;
            let origin = origin.as_ref().map(|origin| format!(", origin = {}", numbers(origin)));
            format!("grid = {}, step = {}{}", numbers(count), numbers(step), origin.unwrap_or_default())
        }
        Layout::Ring { count, radius, start } => {
            let start = start.as_ref().map(|start| format!(", start = {}", number(start)));
            format!("ring = {}, radius = {}{}", number(count), number(radius), start.unwrap_or_default())
        }
        Layout::At(places) => format!("at = [{}]", joined(places, numbers)),
        Layout::Matrices(matrices) => format!("matrices = [{}]", joined(matrices, matrix)),
        Layout::File(file) => format!("file = {}", text(file)),
    };
    let name = place.name.as_ref().map(|name| format!(", name = {}", text(name))).unwrap_or_default();
    let numbers = place.numbers.as_ref();
    let numbers = numbers.map(|numbers| format!(", numbers = [{}]", joined(&numbers.value, number)));
    format!("{{ solid = {solid}, {layout}{name}{} }}", numbers.unwrap_or_default())
}

fn region(entry: &RegionEntry) -> String {
    let mut section = Section::new("[[region]]");
    section.put_some("name", &entry.name, text);
    section.put("solid", text(&entry.solid));
    section.put_some("medium", &entry.medium, text);
    section.put_some("colour", &entry.colour, |colour| quoted(&colour.value.to_string()));
    section.text
}

fn medium(entry: &MediumEntry) -> String {
    let mut section = Section::new(&format!("[medium.{}]", key(&entry.name.value)));
    section.put_some("index", &entry.index, number);
    section.put_some("colour", &entry.colour, |colour| quoted(&colour.value.to_string()));
    for (name, value) in &entry.others {
        section.put(&name.value, to_toml(&value.value));
    }
    section.text
}

fn camera(entry: &CameraEntry) -> String {
    let mut section = Section::new("[camera]");
    match &entry.projection {
        ProjectionEntry::Perspective(fov) => {
            section.put("projection", quoted("perspective"));
            section.put_some("fov", fov, number);
        }
        ProjectionEntry::Orthographic(height) => {
            section.put("projection", quoted("orthographic"));
            section.put("height", number(height));
        }
    }
    section.put("position", numbers(&entry.position));
    section.put_some("target", &entry.target, |target| numbers(target));
    section.put_some("up", &entry.up, |up| numbers(up));
    section.put_some("size", &entry.size, |size| numbers(size));
    section.text
}

fn light(entry: &LightEntry) -> String {
    let mut section = Section::new("[[light]]");
    match &entry.kind {
        LightKind::Direction(direction) => section.put("direction", numbers(direction)),
        LightKind::Position(position) => section.put("position", numbers(position)),
    }
    section.put_some("intensity", &entry.intensity, number);
    section.put_some("colour", &entry.colour, |colour| quoted(&colour.value.to_string()));
    section.text
}

fn render(entry: &RenderEntry) -> String {
    let mut section = Section::new("[render]");
    section.put_some("background", &entry.background, |colour| quoted(&colour.value.to_string()));
    section.put_some("shading", &entry.shading, |shading| quoted(shading.value.name()));
    section.put_some("edges", &entry.edges, |boolean| boolean.value.to_string());
    section.put_some("shadows", &entry.shadows, |boolean| boolean.value.to_string());
    section.put_some("samples", &entry.samples, number);
    section.text
}

fn text(text: &Spanned<String>) -> String {
    quoted(&text.value)
}

fn number(number: &Spanned<Number>) -> String {
    match &number.value {
        Number::Value(value) => written(*value),
        Number::Text(text) => quoted(text),
    }
}

fn numbers(list: impl AsRef<[Spanned<Number>]>) -> String {
    format!("[{}]", joined(list.as_ref(), number))
}

fn matrix(rows: &Matrix) -> String {
    format!("[{}]", joined(rows, numbers))
}

fn joined<'a, T>(items: &'a [T], write: impl Fn(&'a T) -> String) -> String {
    let items: Vec<String> = items.iter().map(write).collect();
    items.join(", ")
}
