//! Transforms (`multmatrix`, `resize`) and colours.

use super::arguments::{Arguments, Refusal, finite};
use super::value::Value;
use rayweave_math::{Affine, Vec3};
use rayweave_scene::Colour;

/// The matrix of `multmatrix(m)`; the identity if `m` is absent.
pub(super) fn matrix(arguments: &Arguments) -> Result<Affine, Refusal> {
    let wanted = "4 rows of 4 finite numbers";
    let given = arguments.get("m", wanted, rows)?;
    let rows = given.unwrap_or(Affine::IDENTITY.to_rows());
    // homogeneous coordinates: OpenSCAD divides by the last entry
    let divided = rows.map(|row| row.map(|number| number / rows[3][3]));
    Affine::from_rows(&divided).filter(Affine::is_finite).ok_or_else(|| {
        arguments.refusal("the map is projective, because its last row is not 0, 0, 0, w with nonzero w")
    })
}

/// The rows of a matrix; missing entries are those of the identity.
fn rows(value: &Value) -> Option<[[f64; 4]; 4]> {
    let mut rows = Affine::IDENTITY.to_rows();
    let given = value.list()?;
    if given.len() > 4 {
        return None;
    }
    for (row, given) in rows.iter_mut().zip(given) {
        *row = finite(given)?;
    }
    Some(without_noise(rows))
}

/// Sets entries that can only be rounding errors to 0, such as the cosine of 90 degrees: linear entries below 10^-14 of the
/// largest linear entry, and translations below 10^-12 (OpenSCAD merges points closer than 2^-20).
fn without_noise(mut rows: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let largest = rows[..3].iter().flat_map(|row| &row[..3]).fold(0f64, |most, x| most.max(x.abs()));
    for row in &mut rows[..3] {
        for (k, x) in row.iter_mut().enumerate() {
            let least = if k < 3 { 1e-14 * largest } else { 1e-12 };
            *x = if x.abs() < least { 0.0 } else { *x };
        }
    }
    rows
}

/// The colour of `color(c)`; `None` if `c` is absent or has a negative channel, as OpenSCAD writes unset colours.
pub(super) fn colour(arguments: &Arguments) -> Result<Option<Colour>, Refusal> {
    let wanted = "4 numbers from 0 to 1";
    let channels: Option<[f64; 4]> = arguments.get("c", wanted, finite)?;
    let byte = |channel: f64| (255.0 * channel.clamp(0.0, 1.0)).round() as u8;
    let colour = |[red, green, blue, alpha]: [f64; 4]| Colour {
        alpha: byte(alpha),
        ..Colour::new(byte(red), byte(green), byte(blue))
    };
    Ok(channels.filter(|channels| channels.iter().all(|c| *c >= 0.0)).map(colour))
}

/// Restriction of a map to the plane z = 0, projected along z.
pub(super) fn restricted_to_xy(map: &Affine) -> Affine {
    let [x, y, _, _] = map.to_rows();
    let rows = [[x[0], x[1], 0.0, x[3]], [y[0], y[1], 0.0, y[3]], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    Affine::from_rows(&rows).unwrap_or(Affine::IDENTITY)
}

/// The map of `resize(newsize, auto)` for a bounding box in two or three dimensions. An axis with new size 0 keeps its size or,
/// with `auto`, takes the scale factor of the axis with the largest new size.
pub(super) fn resizing(arguments: &Arguments, size: &[f64]) -> Result<Affine, Refusal> {
    let new: [f64; 3] = arguments.get("newsize", "3 finite numbers", finite)?.unwrap_or([0.0; 3]);
    let as_number = |value: &Value| match value {
        Value::Boolean(boolean) => Some(f64::from(u8::from(*boolean))),
        other => other.number(),
    };
    let auto = arguments.get("auto", "true or false, or 3 of them", |value| match value {
        Value::List(list) => list.iter().map(as_number).collect::<Option<Vec<f64>>>(),
        value => as_number(value).map(|number| vec![number; 3]),
    })?;
    let auto = auto.unwrap_or_default();
    let largest = (1..size.len()).fold(0, |most, k| if new[k] > new[most] { k } else { most });
    let factor = |k: usize| if new[k] > 0.0 { new[k] / size[k] } else { 1.0 };
    let mut scale = [1.0; 3];
    for k in 0..size.len() {
        let is_auto = new[k] <= 0.0 && auto.get(k).is_some_and(|auto| *auto != 0.0);
        scale[k] = factor(if is_auto { largest } else { k });
    }
    match scale.iter().all(|factor| factor.is_finite() && *factor > 0.0) {
        true => Ok(Affine::scale(Vec3::from_array(scale))),
        false => Err(arguments.refusal("its child has zero extent along a resized axis")),
    }
}
