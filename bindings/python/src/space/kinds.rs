//! Constructors of solids in R^d by name, shared by the Python functions and by unpickling.

use pyo3::prelude::*;
use rayweave::polygon::from_polygons;
use rayweave::rootray::Side;
use rayweave::space::{Point, Solid};

use super::{AnySolid, Holds, in_dimension};
use crate::error::bad_value;

/// The solid that a call makes.
pub fn make(
    call: &str,
    dimension: usize,
    numbers: &[f64],
    name: Option<&str>,
    operands: &[&AnySolid],
) -> PyResult<AnySolid> {
    if call == "extrude" {
        return extruded(dimension, operands);
    }
    in_dimension!(dimension, D => {
        let operands: Option<Vec<Solid<D>>> = operands.iter().map(|&any| any.held().cloned()).collect();
        let operands = operands.ok_or_else(damaged)?;
        make_in::<D>(call, numbers, name, operands).map(AnySolid::hold)
    })
}

fn make_in<const D: usize>(
    call: &str,
    numbers: &[f64],
    name: Option<&str>,
    operands: Vec<Solid<D>>,
) -> PyResult<Solid<D>> {
    let solid = match (call, operands.as_slice()) {
        ("union", _) => Ok(Solid::union(operands)),
        ("intersection", _) => Ok(Solid::intersection(operands)),
        ("difference", [a, b]) => Ok(a - b),
        ("symmetric_difference", [a, b]) => Ok(a ^ b),
        ("complement", [part]) => Ok(!part),
        ("named", [part]) => Ok(part.named(name.ok_or_else(damaged)?)),
        (_, [part]) => return image(call, numbers, part),
        (_, []) => return shape(call, numbers),
        _ => return Err(damaged()),
    };
    solid.map_err(|error: rayweave::space::SpaceError| bad_value(error))
}

fn shape<const D: usize>(call: &str, numbers: &[f64]) -> PyResult<Solid<D>> {
    match (call, numbers) {
        ("empty", []) => Ok(Solid::empty()),
        ("universe", []) => Ok(Solid::universe()),
        ("half_space", [normal @ .., offset]) => Solid::half_space_below(point(normal)?, *offset),
        ("slab", &[axis, lo, hi]) => Solid::slab(axis as usize, lo, hi),
        ("box", corners) if corners.len() == 2 * D => {
            Solid::box_from_corners(point(&corners[..D])?, point(&corners[D..])?)
        }
        ("quadric", &[n, m, bias]) => Solid::quadric(n as usize, m as usize, bias),
        ("ball", &[radius]) => Solid::ball(radius),
        ("cylinder", &[m, radius]) => Solid::cylinder(m as usize, radius),
        ("cone", &[m, slope]) => Solid::cone(m as usize, slope),
        ("prism", points) => Solid::prism(points.as_chunks::<2>().0),
        ("polygons", numbers) => return over_polygons(numbers),
        _ => return Err(damaged()),
    }
    .map_err(bad_value)
}

fn image<const D: usize>(call: &str, numbers: &[f64], part: &Solid<D>) -> PyResult<Solid<D>> {
    match (call, numbers) {
        ("translate", by) => part.translate(point(by)?),
        ("scale", factors) => part.scale(point(factors)?),
        ("rotate", &[from, to, degrees]) => part.rotate(from as usize, to as usize, degrees),
        ("affine", entries) if entries.len() == D * D + D => {
            let mut rows = [[0.0; D]; D];
            for (row, given) in rows.iter_mut().zip(entries.chunks_exact(D)) {
                *row = point(given)?;
            }
            part.affine(rows, point(&entries[D * D..])?)
        }
        _ => return Err(damaged()),
    }
    .map_err(bad_value)
}

/// The solid extruded to a space of more dimensions.
fn extruded(dimension: usize, operands: &[&AnySolid]) -> PyResult<AnySolid> {
    let &[part] = operands else {
        return Err(damaged());
    };
    in_dimension!(dimension, N => {
        super::each!(AnySolid, part, solid => solid.extrude::<N>()).map(AnySolid::hold).map_err(bad_value)
    })
}

/// A region as numbers: the sign of the outside, the number of contours, their lengths, their
/// points.
pub fn polygon_numbers(outside: Side, contours: &[&[Point<2>]]) -> Vec<f64> {
    let sign = if outside.is_inside() { -1.0 } else { 1.0 };
    let lengths = contours.iter().map(|contour| contour.len() as f64);
    let points = contours.iter().copied().flatten().flatten().copied();
    [sign, contours.len() as f64].into_iter().chain(lengths).chain(points).collect()
}

fn over_polygons<const D: usize>(numbers: &[f64]) -> PyResult<Solid<D>> {
    let [sign, count, rest @ ..] = numbers else {
        return Err(damaged());
    };
    let (lengths, points) = rest.split_at_checked(*count as usize).ok_or_else(damaged)?;
    let mut points = points.as_chunks::<2>().0;
    let mut contours = Vec::with_capacity(lengths.len());
    for &length in lengths {
        let (contour, rest) = points.split_at_checked(length as usize).ok_or_else(damaged)?;
        contours.push(contour);
        points = rest;
    }
    let outside = if *sign < 0.0 { Side::Inside } else { Side::Outside };
    let polygons = from_polygons(&contours, outside).map_err(bad_value)?;
    Solid::over_polygons(&polygons).map_err(bad_value)
}

fn point<const D: usize>(numbers: &[f64]) -> PyResult<Point<D>> {
    numbers
        .try_into()
        .map_err(|_| bad_value(format!("a point of R^{D} has {D} numbers, not {}", numbers.len())))
}

fn damaged() -> PyErr {
    bad_value("the pickled bytes are not a solid: they are damaged or come from a different version.")
}
