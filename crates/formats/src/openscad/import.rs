//! `import`: mesh files as solids, SVG and DXF drawings as plane regions.

use super::arguments::{Arguments, Refusal};
use super::drawing::{Drawing, MAX_DRAWING_BYTES, TOLERANCE, shift};
use super::dxf::{self, DxfOptions};
use super::facets::Fineness;
use super::flat::Flats;
use super::operation::Operation;
use super::part::Part;
use super::shell::Shell;
use super::svg::{self, SvgOptions};
use super::value::Value;
use crate::{LossKind, Report};
use rayweave_math::{Affine, Vec3};
use rayweave_mesh_io::{MeshFormat, ReadOptions, read_allowed};
use rayweave_table::{AllowedFiles, RefusedFile};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Opens the file of an item, whose path is relative to the dump. The dump may read the given files.
pub(super) fn file(arguments: &Arguments, files: &AllowedFiles) -> Result<(PathBuf, File), Refusal> {
    let name = word(arguments, "file")?;
    let name =
        name.filter(|name| !name.is_empty()).ok_or_else(|| arguments.refusal("it has no file name"))?;
    let path = files.folder().join(name);
    match files.open(&path) {
        Ok(file) => Ok((path, file)),
        Err(RefusedFile::Folder) => Err(arguments.refusal(&format!("`{name}` is a folder"))),
        Err(RefusedFile::Io(error)) if error.kind() == ErrorKind::NotFound => {
            Err(arguments.refusal(&format!("there is no file `{name}` in the folder of the dump")))
        }
        Err(RefusedFile::Io(error)) => {
            Err(arguments.refusal(&format!("its file `{name}` cannot be read: {error}")))
        }
        Err(refused) => {
            Err(arguments.error(&format!("its file `{name}` may not be used, because {refused}")))
        }
    }
}

/// A string argument.
pub(super) fn word<'a>(arguments: &Arguments<'a>, name: &str) -> Result<Option<&'a str>, Refusal> {
    arguments.get(name, "a string", |value| match value {
        Value::Text(text) => Some(text.as_str()),
        _ => None,
    })
}

/// Text of a file of limited size.
pub(super) fn text_of(
    arguments: &Arguments,
    (path, file): (&Path, File),
    largest: u64,
) -> Result<String, Refusal> {
    let unreadable = |error: std::io::Error| arguments.refusal(&format!("its file cannot be read: {error}"));
    let length = file.metadata().map_err(unreadable)?.len();
    if length > largest {
        return Err(arguments.refusal(&format!("its file is larger than {} MiB", largest >> 20)));
    }
    arguments.limited(arguments.budget().read_file(path, length))?;
    let mut bytes = Vec::new();
    file.take(largest).read_to_end(&mut bytes).map_err(unreadable)?;
    // old drawings have names in other encodings; names do not matter
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Contents of an imported file.
pub(super) enum Imported {
    Drawing(Part),
    Mesh(Shell),
}

/// `import(file, layer, origin, scale, center, dpi)`.
pub(super) fn import(
    arguments: &Arguments,
    files: &AllowedFiles,
    facets: bool,
    flats: &mut Flats,
    report: &mut Report,
) -> Result<Imported, Refusal> {
    let (path, file) = file(arguments, files)?;
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    match ending.to_str() {
        Some("svg") => {
            let dpi = arguments.number("dpi", 72.0)?;
            let dpi = if dpi > 0.0 { dpi } else { 72.0 };
            let options = SvgOptions { facets, dpi, budget: arguments.budget() };
            let drawing = svg::read(&text_of(arguments, (&path, file), MAX_DRAWING_BYTES)?, options);
            drawn(arguments, readable(arguments, drawing)?, flats, report).map(Imported::Drawing)
        }
        Some("dxf") => {
            let layer = word(arguments, "layer")?.unwrap_or_default();
            let scale = arguments.point::<2>("scale", 1.0)?[0];
            // as in OpenSCAD
            let scale = if scale > 0.0 { scale } else { 1.0 };
            let fineness = Fineness::of(arguments)?;
            let options = DxfOptions { facets, fineness, layer, scale, budget: arguments.budget() };
            let drawing = dxf::read(&text_of(arguments, (&path, file), MAX_DRAWING_BYTES)?, &options);
            let mut drawing = readable(arguments, drawing)?;
            let origin: [f64; 2] = arguments.point("origin", 0.0)?;
            let map = shift(origin.map(|x| -x)).then(&Affine::scale(Vec3::new(scale, scale, 1.0)));
            drawing.leaves.iter_mut().for_each(|(_, own)| *own = own.then(&map));
            drawn(arguments, drawing, flats, report).map(Imported::Drawing)
        }
        _ => mesh(arguments, &path, files).map(Imported::Mesh),
    }
}

/// A drawing that could be read.
fn readable(arguments: &Arguments, drawing: Result<Drawing, String>) -> Result<Drawing, Refusal> {
    drawing.map_err(|why| match arguments.spend(0) {
        Ok(()) => arguments.refusal(&why),
        // the budget ran out within the drawing
        Err(limit) => limit,
    })
}

/// The union of the regions of a drawing.
fn drawn(
    arguments: &Arguments,
    drawing: Drawing,
    flats: &mut Flats,
    report: &mut Report,
) -> Result<Part, Refusal> {
    arguments.hold(drawing.leaves.iter().map(|(leaf, _)| leaf.point_count()).sum())?;
    for (what, why, line) in &drawing.refused {
        let problem = arguments.approximation(&format!("leaves out `{what}` in line {line} of its file"));
        report.add(LossKind::Refused, "import()", problem.why(why));
    }
    if drawing.unlisted > 0 {
        let count = drawing.unlisted;
        let problem = arguments.approximation(&format!("leaves out {count} more entities of its file"));
        report.add(LossKind::Refused, "import()", problem.why("no more are listed"));
    }
    if drawing.has_chords {
        let why = format!(
            "has chords instead of curves, which deviate by at most {TOLERANCE:e} of the size of the drawing"
        );
        report.add(LossKind::Approximated, "import()", arguments.approximation(&why));
    }
    if drawing.closed > 0 {
        let why = arguments.approximation("closes open chains with straight lines");
        report.add(LossKind::Approximated, "import()", why);
    }
    let moved = |(leaf, map)| {
        let flat = flats.leaf(leaf);
        if map == Affine::IDENTITY { flat } else { flats.transformed(map, flat) }
    };
    let all: Vec<_> = drawing.leaves.into_iter().map(moved).collect();
    if all.is_empty() {
        return Ok(Part::Empty);
    }
    let flat = flats.join(Operation::Union, all);
    if !arguments.boolean("center", false)? {
        return Ok(flat.into());
    }
    let [lo, hi] = flats.bounds(arguments, flat)?;
    let middle = [0, 1].map(|k| -0.5 * (lo[k] + hi[k]));
    Ok(flats.transformed(shift(middle), flat).into())
}

/// The solid inside a mesh.
fn mesh(arguments: &Arguments, path: &Path, files: &AllowedFiles) -> Result<Shell, Refusal> {
    let format = MeshFormat::from_path(path);
    let format = format.ok_or_else(|| {
        arguments.refusal("only meshes (STL, OFF, 3MF, OBJ, PLY) and drawings (SVG, DXF) can be imported")
    })?;
    let length = std::fs::metadata(path).map_or(0, |data| data.len());
    arguments.limited(arguments.budget().read_file(path, length))?;
    let loaded = read_allowed(path, Some(format), &ReadOptions::default(), files);
    let loaded = loaded.map_err(|error| arguments.refusal(&error.to_string()))?;
    arguments.hold(loaded.mesh.triangles().len())?;
    let (vertices, triangles) = loaded.mesh.into_parts();
    Ok(Shell { vertices, triangles, is_convex: false })
}
