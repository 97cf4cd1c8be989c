//! Transposition between rows of vectors, as in NumPy, and columns of components, as in the
//! evaluators; compiled for every SIMD level.

use fearless_simd::{Level, dispatch};

/// Copies rows of vectors into columns; true if `accepts` every one of them.
pub fn deinterleave(rows: &[[f64; 3]], columns: [&mut [f64]; 3], accepts: impl Fn([f64; 3]) -> bool) -> bool {
    dispatch!(Level::new(), _simd => deinterleave_here(rows, columns, accepts))
}

#[inline(always)]
fn deinterleave_here(
    rows: &[[f64; 3]],
    [x, y, z]: [&mut [f64]; 3],
    accepts: impl Fn([f64; 3]) -> bool,
) -> bool {
    // as wide as the components, which avoids conversions of lanes
    let mut refused = 0_u64;
    for (((row, x), y), z) in rows.iter().zip(x).zip(y).zip(z) {
        [*x, *y, *z] = *row;
        refused |= u64::from(!accepts(*row));
    }
    refused == 0
}

/// Copies columns into rows of vectors.
pub fn interleave([x, y, z]: [&[f64]; 3], rows: &mut [[f64; 3]]) {
    dispatch!(Level::new(), _simd => {
        for (((row, x), y), z) in rows.iter_mut().zip(x).zip(y).zip(z) {
            *row = [*x, *y, *z];
        }
    });
}

/// Positions of rays at their times; NaN where a time is infinite.
pub fn points_at(origins: [&[f64]; 3], directions: [&[f64]; 3], times: &[f64], points: &mut [[f64; 3]]) {
    dispatch!(Level::new(), _simd => points_here(origins, directions, times, points));
}

#[inline(always)]
fn points_here([ox, oy, oz]: [&[f64]; 3], [dx, dy, dz]: [&[f64]; 3], times: &[f64], points: &mut [[f64; 3]]) {
    let origins = ox.iter().zip(oy).zip(oz);
    let directions = dx.iter().zip(dy).zip(dz);
    for (((point, &t), ((ox, oy), oz)), ((dx, dy), dz)) in
        points.iter_mut().zip(times).zip(origins).zip(directions)
    {
        // finite times are unchanged; an infinite time becomes NaN
        let t = if t < f64::INFINITY { t } else { f64::NAN };
        *point = [ox + t * dx, oy + t * dy, oz + t * dz];
    }
}
