//! Height maps (`surface`): the solid below a grid of heights, from text or an image.

use super::arguments::{Arguments, Refusal};
use super::import::{file, text_of};
use super::shell::Shell;
use rayweave_math::Vec3;
use rayweave_table::AllowedFiles;
use std::fs::File;
use std::path::Path;

/// Largest height map file in bytes.
const MAX_MAP_BYTES: u64 = 64 << 20;

/// Maximum number of pixels of an image, and of bytes that its decoder may allocate.
const MAX_PIXELS: usize = 4_000_000;
const MAX_BYTES: usize = 256 << 20;

/// The solid below a height map.
pub(super) struct Relief {
    pub shell: Shell,
    /// Number of rows that were padded with zeros to the length of the longest one.
    pub short_rows: usize,
}

/// `surface(file, center, invert)`: the solid below a height map from a text or an image.
pub(super) fn surface(arguments: &Arguments, files: &AllowedFiles) -> Result<Relief, Refusal> {
    let (path, file) = file(arguments, files)?;
    let is_picture = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    let mut rows =
        if is_picture { brightness(arguments, &path, file)? } else { heights(arguments, &path, file)? };
    // the floor is at 0, or at the lowest height minus 1 if that height is below 1
    let lowest = rows.iter().flatten().copied().fold(1.0, f64::min);
    let (width, depth) = (rows.iter().map(Vec::len).max().unwrap_or(0), rows.len());
    // four triangles per cell; short rows are padded with zeros, which do not lower the floor
    arguments.hold(width.saturating_mul(depth).saturating_mul(4))?;
    let short_rows = rows.iter().filter(|row| row.len() < width).count();
    rows.iter_mut().for_each(|row| row.resize(width, 0.0));
    if width < 2 || depth < 2 {
        return Ok(Relief { shell: Shell::default(), short_rows });
    }
    let shift = match arguments.boolean("center", false)? {
        true => Vec3::new(-0.5 * (width - 1) as f64, -0.5 * (depth - 1) as f64, 0.0),
        false => Vec3::ZERO,
    };
    let (vertices, triangles) = relief(&rows, lowest - 1.0);
    let vertices = vertices.into_iter().map(|p| p + shift).collect();
    Ok(Relief { shell: Shell { vertices, triangles, is_convex: false }, short_rows })
}

/// Brightness of an image in percent, lowest row first. With `invert`, a byte b becomes 1 - b, as in OpenSCAD.
fn brightness(arguments: &Arguments, path: &Path, file: File) -> Result<Vec<Vec<f64>>, Refusal> {
    let invert = arguments.boolean("invert", false)?;
    let unreadable =
        |error: &dyn std::fmt::Display| arguments.refusal(&format!("its picture cannot be read: {error}"));
    let mut decoder =
        png::Decoder::new_with_limits(std::io::BufReader::new(file), png::Limits { bytes: MAX_BYTES });
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|error| unreadable(&error))?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    if width.saturating_mul(height) > MAX_PIXELS {
        return Err(arguments.refusal(&format!("it has more than {MAX_PIXELS} pixels")));
    }
    let bytes = std::fs::metadata(path).map_or(0, |data| data.len());
    arguments.limited(arguments.budget().read_file(path, bytes))?;
    arguments.spend(50 * width * height)?;
    let size = reader.output_buffer_size().ok_or_else(|| unreadable(&"it is too large"))?;
    let mut bytes = vec![0; size];
    let frame = reader.next_frame(&mut bytes).map_err(|error| unreadable(&error))?;
    let samples = frame.color_type.samples();
    let height_of = |pixel: &[u8]| {
        let [r, g, b] =
            if samples < 3 { [pixel[0]; 3] } else { [pixel[0], pixel[1], pixel[2]] }.map(f64::from);
        // luma weights of ITU-R BT.709
        let value = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        100.0 / 255.0 * if invert { 1.0 - value } else { value }
    };
    let row = |row: &[u8]| row[..width * samples].chunks_exact(samples).map(height_of).collect();
    Ok(bytes.chunks_exact(frame.line_size).take(height).map(row).rev().collect())
}

/// Rows of a text height map, the first at y = 0, each with its own length.
fn heights(arguments: &Arguments, path: &Path, file: File) -> Result<Vec<Vec<f64>>, Refusal> {
    let text = text_of(arguments, (path, file), MAX_MAP_BYTES)?;
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with('#')) {
        let height = |word: &str| word.parse().ok().filter(|height: &f64| height.is_finite());
        let row: Option<Vec<f64>> = line.split_whitespace().map(height).collect();
        let reason = || {
            arguments.refusal(&format!("line {} of its file has a value that is not a number", number + 1))
        };
        let row = row.ok_or_else(reason)?;
        if !row.is_empty() {
            rows.push(row);
        }
    }
    Ok(rows)
}

/// Triangulation of a height map: four triangles per grid cell around its centre, walls and a floor.
fn relief(rows: &[Vec<f64>], floor: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (width, depth) = (rows[0].len(), rows.len());
    let at = |x: usize, y: usize, z: f64| Vec3::new(x as f64, y as f64, z);
    let mut vertices: Vec<Vec3> =
        (0..depth).flat_map(|y| (0..width).map(move |x| at(x, y, rows[y][x]))).collect();
    let grid = |x: usize, y: usize| (y * width + x) as u32;
    let mut triangles = Vec::new();
    for y in 0..depth - 1 {
        for x in 0..width - 1 {
            let corners = [grid(x, y), grid(x + 1, y), grid(x + 1, y + 1), grid(x, y + 1)];
            let middle = vertices.len() as u32;
            vertices.push(0.25 * corners.iter().map(|k| vertices[*k as usize]).sum::<Vec3>());
            triangles.extend((0..4).map(|k| [corners[k], corners[(k + 1) % 4], middle]));
        }
    }
    let rim: Vec<u32> = ((0..width - 1).map(|x| grid(x, 0)))
        .chain((0..depth - 1).map(|y| grid(width - 1, y)))
        .chain((1..width).rev().map(|x| grid(x, depth - 1)))
        .chain((1..depth).rev().map(|y| grid(0, y)))
        .collect();
    let foot = vertices.len() as u32;
    let below = |k: &u32| Vec3 { z: floor, ..vertices[*k as usize] };
    let feet: Vec<Vec3> = rim.iter().map(below).collect();
    vertices.extend(feet);
    let n = rim.len() as u32;
    for k in 0..n {
        let (a, b) = (rim[k as usize], rim[((k + 1) % n) as usize]);
        let (c, d) = (foot + k, foot + (k + 1) % n);
        triangles.extend([[a, c, d], [a, d, b]]);
    }
    triangles.extend((1..n - 1).map(|k| [foot, foot + k + 1, foot + k]));
    (vertices, triangles)
}
