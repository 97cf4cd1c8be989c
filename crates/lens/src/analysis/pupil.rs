//! Sample points of a pupil, in units of its semi-diameter.

/// The centre and rings of 6, 12, 18, ... points, the first of each on the x axis, the last ring on the rim.
pub fn hexapolar(rings: usize) -> Vec<[f64; 2]> {
    let ring = |k: usize| {
        (0..6 * k).map(move |i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * i as f64 / (6 * k) as f64);
            let r = k as f64 / rings as f64;
            [r * cos, r * sin]
        })
    };
    [[0.0; 2]].into_iter().chain((1..=rings).flat_map(ring)).collect()
}

/// The points inside the pupil of a square grid with `across` points along the diameter from rim to rim.
pub fn square(across: usize) -> Vec<[f64; 2]> {
    let at = |i: usize| if across < 2 { 0.0 } else { 2.0 * i as f64 / (across - 1) as f64 - 1.0 };
    let all = (0..across).flat_map(|i| (0..across).map(move |k| [at(k), at(i)]));
    all.filter(|[x, y]| x * x + y * y <= 1.0 + 1e-12).collect()
}

/// Points along x, from -1 to 1.
pub fn fan_x(count: usize) -> Vec<[f64; 2]> {
    fan_y(count).into_iter().map(|[x, y]| [y, x]).collect()
}

/// Points along y, from -1 to 1.
pub fn fan_y(count: usize) -> Vec<[f64; 2]> {
    let last = count.saturating_sub(1).max(1) as f64;
    (0..count).map(|i| [0.0, 2.0 * i as f64 / last - 1.0]).collect()
}
